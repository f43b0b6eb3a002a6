r"""Histories of one block on corners that open: pressed, dropped or thrown against its base.

The block is that of `dda.TwoBlockModel`; its two base corners carry pressure only (`dda.contact.unilateral`).
A step whose contacts have no single state is cut, from the state in which it began; the rest of the interval
follows, so that every interval ends at its own time.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from time import perf_counter

import numpy as np
from numpy.typing import NDArray

from dda.contact.iteration import Iteration
from dda.contact.springs import base_directions
from dda.contact.unilateral import LAGGED, SLIP, Unilateral
from dda.model.block import Block
from dda.model.load import BaseMotion, Load, pressed_part
from dda.one_block.solution import check_request, step_times
from dda.one_block.two_block import carried
from dda.one_block.unilateral_energy import CutStep, Ledger, energies
from dda.one_block.unilateral_form import UnilateralForm, unilateral_form
from dda.one_block.unilateral_history import (
    SHORTEST,
    History,
    Step,
    UnilateralResult,
    glide,
    observed,
    state_of,
    vector,
)
from dda.one_block.unilateral_phase import Phase, phase_of
from dda.one_block.unilateral_step import CONSERVING, IMPLICIT, NEWMARK, Jump, State, StepLength, advance, start_state
from dda.scheme.cutting import Lengths, in_parts
from dda.scheme.newmark import Scheme

Array = NDArray[np.float64]

RULES = (NEWMARK, IMPLICIT, CONSERVING)
COMPLETED = "completed"
OVERFLOW = "overflow"
_LENGTHS = 64  # step lengths whose factors are kept


@dataclass(frozen=True, eq=False)
class UnilateralModel:
    """One block over corners that carry no tension, at both ends of its base edge.

    Raises
    ------
    ValueError
        If a number is not finite, the eccentricity leaves nothing of the top edge, or base and top are not
        two edges of the block.
    """

    block: Block
    contact: Unilateral
    pressure: float = 0.0  # q, downwards on the top edge from t = 0 on [Pa]
    base: int = 0  # edge over the corners M (its start) and N (its end)
    top: int = 2  # edge under pressure
    eccentricity: float = 0.0  # shift of the middle of the pressed part towards +x [m]
    traction: float = 0.0  # towards +x, on the whole top edge [Pa]
    gravity: float = 0.0  # downwards [m/s^2]
    velocity: float = 0.0  # of the block at t = 0, upwards positive [m/s]
    slope: float = 0.0  # by which gravity is turned, to g (sin, -cos) [deg]
    motion: BaseMotion | None = None  # of the base, from where the block stands at t = 0

    def __post_init__(self) -> None:
        """Check the numbers and the edges."""
        self.block.check_edges(self.base, self.top)
        if not math.isfinite(self.velocity):
            raise ValueError(f"velocity: must be finite, got {self.velocity!r}")
        pressed_part(*self.block.edge(self.top), self.applied.eccentricity)
        if self.motion is not None and np.any(start := self.motion.at([0.0])[0]):
            raise ValueError(f"motion: must be zero at t = 0 where contact opens, got {tuple(start.tolist())}")

    @cached_property
    def applied(self) -> Load:
        """All loads."""
        return Load(self.pressure, self.eccentricity, self.traction, self.gravity, self.motion, self.slope)

    @cached_property
    def reduced(self) -> UnilateralForm:
        """Matrices and load in the unknowns that move."""
        return self.form()

    def form(self, full: bool = False) -> UnilateralForm:
        """Return matrices and load in the unknowns that move; in all six if `full`."""
        return unilateral_form(self.block, self.contact, self.base, self.top, self.applied, self.velocity, full)


@dataclass(frozen=True)
class UnilateralOptions:
    """How the contacts are found and what is kept.

    Raises
    ------
    ValueError
        If a value is out of its range.
    """

    rule: str = NEWMARK  # or "implicit", "energy-conserving": the block by average acceleration, contact of its own
    solve_limit: int = 6  # solves of the open-close iteration before all states are tried
    cut: float = 0.3  # length of a cut step over that of the failed one
    energies: bool = False  # keep what the energies of every step are made of
    full: bool = False  # keep all six unknowns and both corners where the motion is symmetric, make every step singly

    def __post_init__(self) -> None:
        """Check the ranges."""
        if self.rule not in RULES:
            raise ValueError(f"rule: must be among {', '.join(RULES)}, got {self.rule!r}")
        if isinstance(self.solve_limit, bool) or not isinstance(self.solve_limit, int) or self.solve_limit < 1:
            raise ValueError(f"solve_limit: must be a positive integer, got {self.solve_limit!r}")
        if not 0 < self.cut < 1:
            raise ValueError(f"cut: must be between 0 and 1, got {self.cut!r}")


def solve_unilateral(
    model: UnilateralModel,
    scheme: Scheme,
    steps: int,
    columns: Sequence[str] = ("displacement", "contact_pressure"),
    options: UnilateralOptions | None = None,
) -> UnilateralResult:
    """Step a block on corners that open, from rest or from its starting velocity.

    Displacements count from t = 0. A numerical failure is an outcome, not an exception: the history then
    ends with the last step that was reached.

    Parameters
    ----------
    model, scheme
        What moves and how it is stepped. The start "consistent" means M A0 = F, since no contact presses at t = 0.
    steps : int
        Number of steps.
    columns : sequence of str
        Any of `dda.COLUMNS`.
    options
        How the contacts are found; the defaults if absent.

    Raises
    ------
    ValueError
        If the number of steps is not positive, a column is unknown, or rule, scheme and contact exclude each other.
    """
    check_request(steps, columns)
    options = options or UnilateralOptions()
    check_combination(model, scheme, options)
    began = perf_counter()
    stepping = Stepping(model, scheme, options)
    ready = perf_counter()
    with np.errstate(all="ignore"):
        stepping.run(steps)
        return _result(stepping, columns, began, ready)


def check_combination(model: UnilateralModel, scheme: Scheme, options: UnilateralOptions) -> None:
    """Raise ValueError where rule, scheme and contact exclude each other."""
    if options.rule != NEWMARK and (scheme.alpha, scheme.delta) != (0.25, 0.5):
        given = (scheme.alpha, scheme.delta)
        raise ValueError(
            f"rule: {options.rule} contact needs average acceleration, alpha = 1/4, delta = 1/2, got {given}"
        )
    law = model.contact
    if options.rule == CONSERVING and (math.isinf(law.stiffness) or any(law.band)):
        raise ValueError(
            f"rule: {CONSERVING} contact needs a finite stiffness and no band, "
            f"got stiffness = {law.stiffness:g} and band = {law.band}"
        )
    if options.rule == CONSERVING and model.motion is not None:
        raise ValueError(f"rule: {CONSERVING} contact needs a base at rest, got one that moves")
    if options.rule == CONSERVING and len((form := model.reduced).B) > form.contacts:
        raise ValueError(f"rule: {CONSERVING} contact needs shear = 0 where the base can slide, got {law.shear:g}")
    check_scheme(law, scheme)


def check_scheme(law: Unilateral, scheme: Scheme) -> None:
    """Raise ValueError where an explicit scheme meets a rigid stop."""
    if math.isinf(law.stiffness) and scheme.alpha == 0:
        raise ValueError(f"stiffness: must be finite in an explicit scheme (alpha = 0), got {law.stiffness}")


class Carry:
    """What a moving base does to a block whose unknowns count from it."""

    def __init__(self, form: UnilateralForm, motion: BaseMotion, step: float) -> None:
        self.MR, self.motion, self.step = form.M @ form.translation, motion, step

    def momentum(self, begun: float, ratio: float) -> list[float]:
        """Return M R (y1 - y) of a part of a step, `begun` in steps [kg m]."""
        y, y1 = self.motion.at([begun * self.step, (begun + ratio) * self.step])
        moved: list[float] = (self.MR @ (y1 - y)).tolist()
        return moved


class Stepping:
    """The history of one block: step by step where contacts switch, many at once between."""

    def __init__(self, model: UnilateralModel, scheme: Scheme, options: UnilateralOptions) -> None:
        self.model, self.scheme, self.options = model, scheme, options
        if options.rule == CONSERVING:  # no corner slides, even if `full` keeps the unknowns that could
            model = replace(model, contact=replace(model.contact, shear=0.0))
        self.law, self.form = model.contact, model.form(True) if options.full else model.reduced
        self.outcome = COMPLETED
        self.length = Lengths(lambda ratio: StepLength.of(self.form, scheme, ratio, options.rule), _LENGTHS)
        self.phases: dict[tuple[bool, ...], Phase | str] = {}
        self.history = History(self.form.layout)
        self.cut_steps: dict[int, CutStep] = {}  # for their energies
        self.carry = None if model.motion is None else Carry(self.form, model.motion, scheme.step)
        self.start = start_state(self.form, self.law, scheme, model.velocity, options.rule)

    def run(self, steps: int) -> None:
        """Make the steps that are reached; `outcome` says how it ended."""
        state, waiting = self.start, 1  # steps to be made singly: of the first one A0 may be any
        while self.history.steps < steps:
            if waiting <= 0:
                state, waiting = self._ahead(state, steps)
                continue
            reached = self._interval(state)
            if reached is None:
                return
            state, made = reached
            if not math.isfinite(sum(state.D)):
                self.outcome = OVERFLOW
                return
            self.history.add(made)
            waiting -= 1

    def _ahead(self, state: State, steps: int) -> tuple[State, int]:
        """Return the state after some steps that are made at once, and how many to make singly then."""
        if any(abs(now) == SLIP for now in state.corners.state):
            return state, 1
        history, v, closed = self.history, np.array(vector(state)), state.corners.closed
        began = history.steps
        while history.steps < steps and not isinstance(phase := self.phase_of(closed, steps), str):
            made = glide(phase, v, closed, history.steps, steps - history.steps)
            if made:
                v = made[1]
                history.add(made[0])
            if history.steps == steps or self.jump is None:
                break
            after, found = self.jump.step(v, closed, self.options.solve_limit)
            if found.corners is None or not math.isfinite(after.dot(after)):
                break
            v, closed = after, found.corners.closed
            history.add(Step(v, closed, found.solves, 0))
        if history.steps == began:
            return state, 1
        waiting = 1 if history.steps - began >= SHORTEST else SHORTEST
        return state_of(self.form, self.law, self.scheme.step, state.corners._replace(closed=closed), v), waiting

    @cached_property
    def jump(self) -> Jump | None:
        """Single steps of frictionless contacts; None where they are glued."""
        return None if len(self.form.B) > self.form.contacts else Jump(self.form, self.law, self.length(1.0))

    def phase_of(self, closed: tuple[bool, ...], steps: int) -> Phase | str:
        """Return the steps of a contact state, or why they are made singly."""
        if closed not in self.phases:
            if self.options.full:
                return "all savings off"
            if self.options.rule != NEWMARK:
                return f"the rule {self.options.rule}"
            if self.model.motion is not None:
                return "the base moves"
            if self.law.rules == LAGGED:
                return f"{LAGGED} friction"
            self.phases[closed] = phase_of(self.form, self.law, self.scheme, closed, steps.bit_length())
        return self.phases[closed]

    def _interval(self, state: State) -> tuple[State, Step] | None:
        """Return the state after one step of the scheme, whole or in parts, and what is kept of it."""
        begins = self.history.steps

        def attempt(state: State, begun: float, ratio: float) -> tuple[State | None, Iteration]:
            carried = None if self.carry is None else self.carry.momentum(begins + begun, ratio)
            return advance(self.law, self.length(ratio), state, self.options.solve_limit, carried)

        made = in_parts(attempt, state, self.options.cut)
        if made.failure is not None:
            self.outcome = made.failure
            return None
        if made.cuts and self.options.energies:
            self.cut_steps[begins] = [(self.length(ratio), x, y) for ratio, x, y in made.parts]
        slipped = made.parts[0][2].corners.slipped
        for _, _, after in made.parts[1:]:
            slipped = tuple(map(sum, zip(slipped, after.corners.slipped, strict=True)))
        state = made.parts[-1][2]
        corners = state.corners
        return state, Step(vector(state), corners.closed, made.solves, made.cuts, corners.state, slipped)


def _result(stepping: Stepping, columns: Sequence[str], began: float, ready: float) -> UnilateralResult:
    form, model, history = stepping.form, stepping.model, stepping.history
    values = observed(form, history, base_directions(model.block, model.base)[2], columns)
    for name, way in carried(model.motion, step_times(stepping.scheme, history.steps)).items():
        if name in values:
            values[name] = values[name] + way

    def balance() -> dict[str, Array]:
        ledger = Ledger(form, stepping.law, stepping.scheme, stepping.options.rule, model.motion)
        return energies(ledger, history, stepping.start, stepping.cut_steps)

    ended = perf_counter()
    return UnilateralResult(
        time=step_times(stepping.scheme, history.steps),
        columns=values,
        unknowns=len(form.unknowns),
        nonzeros=int(np.count_nonzero(form.M)),
        factorisations=stepping.length.made + sum(isinstance(p, Phase) for p in stepping.phases.values()),
        solves=sum(part.solves if isinstance(part, Step) else part.steps for part in history.parts),
        notes=_notes(stepping),
        setup_seconds=ready - began,
        stepping_seconds=ended - ready,
        outcome=stepping.outcome,
        balance=balance if stepping.options.energies else None,
        history=history,
        form=form,
        law=stepping.law,
        momentum=form.translation.T / (model.block.material.density * model.block.section.area * stepping.scheme.step),
    )


def _notes(stepping: Stepping) -> tuple[str, ...]:
    """Say what was saved and how the history ended, if early."""
    names, history = stepping.form.unknowns, stepping.history
    saved = (f"both corners as one, unknowns {', '.join(names)}",) if len(names) < 6 else ()
    ended = () if stepping.outcome == COMPLETED else (f"{stepping.outcome} at step {history.steps + 1}",)
    made = "blocked between switches" if history.glides else "stepped"
    return (*saved, f"{made}: contact opens and closes", *ended)
