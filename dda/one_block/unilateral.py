r"""Histories of one block on corners that open: pressed, dropped or thrown against its base.

The block is that of `dda.TwoBlockModel`; its two base corners carry pressure only (`dda.contact.unilateral`).
A step whose contacts have no single state is cut, from the state in which it began; the rest of the interval
follows, so that every interval ends at its own time.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from time import perf_counter

import numpy as np
from numpy.typing import NDArray

from dda.contact.springs import base_directions
from dda.contact.unilateral import SLIP, Unilateral
from dda.model.block import Block
from dda.model.load import BaseMotion, Load, pressed_part
from dda.one_block.contact_result import ContactResult, early_end
from dda.one_block.solution import check_request, step_times
from dda.one_block.two_block import carried
from dda.one_block.unilateral_energy import energies
from dda.one_block.unilateral_form import UnilateralForm, unilateral_form
from dda.one_block.unilateral_step import (
    CONSERVING,
    NEWMARK,
    RULES,
    BlockHistory,
    block_equations,
    history_of,
    make_steps,
    start_state,
)
from dda.scheme.newmark import Scheme
from dda.stepping.compiled import run_loop
from dda.stepping.driver import OUTCOMES, base_record, counts_of, reached_rows

Array = NDArray[np.float64]

PLAIN_STEP = 4e-6  # seconds of plain Python for each unknown and step, and for each unknown force


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
    full: bool = False  # keep all six unknowns and both corners where the motion is symmetric

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
) -> ContactResult:
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
    law = model.contact
    if options.rule == CONSERVING:  # no corner slides, even if `full` keeps the unknowns that could
        law = replace(law, shear=0.0)
        model = replace(model, contact=law)
    form = model.form(True) if options.full else model.reduced
    block = block_equations(form, law, scheme, options.rule, options.solve_limit, model.motion is not None)
    state = start_state(form, law, scheme, model.velocity, options.rule)
    history, counts = history_of(block, steps), counts_of(steps, options.energies)
    seconds = steps * PLAIN_STEP * (len(form.unknowns) + len(form.B))
    ready = perf_counter()
    (reached, outcome), left, how = run_loop(
        make_steps, (block, state, state), (base_record(model.motion),), (history, counts, steps, options.cut), seconds
    )
    history = BlockHistory(*reached_rows(history, reached))
    with np.errstate(all="ignore"):
        values = observed(form, history, base_directions(model.block, model.base)[2], columns)
    for name, moved in carried(model.motion, step_times(scheme, reached)).items():
        if name in values:
            values[name] = values[name] + moved
    saved = (f"both corners as one, unknowns {', '.join(form.unknowns)}",) if len(form.unknowns) < 6 else ()
    losses = counts.losses[:reached]
    mass = model.block.material.density * model.block.section.area
    return ContactResult(
        time=step_times(scheme, reached),
        columns=values,
        unknowns=len(form.unknowns),
        nonzeros=int(np.count_nonzero(form.M)),
        factorisations=int(left[0].made[0]),
        solves=int(counts.solves[:reached].sum()),
        notes=(*saved, f"stepped, {how}: contact opens and closes", *early_end(outcome, reached)),
        setup_seconds=ready - began,
        stepping_seconds=perf_counter() - ready,
        outcome=OUTCOMES[outcome],
        step_solves=counts.solves[:reached],
        step_cuts=counts.cuts[:reached],
        base_contacts=(0, 1),
        parts=_parts(form, law, history, form.translation.T / (mass * scheme.step)),
        balance=(lambda: energies(form, law, scheme.step, model.motion, history, losses)) if options.energies else None,
    )


def observed(form: UnilateralForm, history: BlockHistory, a: float, names: Sequence[str]) -> dict[str, Array]:
    """Return the asked columns; `a` is the length of the base [m]."""
    values = {}
    for name in names:
        if name == "contact_pressure":
            values[name] = history.normal.sum(axis=1) * (2 / form.contacts / a) + 0.0
        else:
            row = form.observers[name]
            values[name] = history.D @ row - row @ form.start + 0.0
    return values


def _parts(
    form: UnilateralForm, law: Unilateral, history: BlockHistory, momentum: Array
) -> dict[str, Callable[[], Array]]:
    """Return what makes the properties of a result; a contact that stands for both corners is N.

    Parameters
    ----------
    momentum : (2, n) array
        Horizontal and vertical velocity of the centroid by P [1/(kg s)].
    """
    both, mirror = [0, -1], np.array([[1.0 if form.contacts == 2 else -1.0], [1.0]])

    def states() -> Array:
        state = history.state.T[both].astype(int)
        turned = np.array([[form.contacts == 1], [False]]) & (np.abs(state) == SLIP)
        return np.where(turned, -state, state)

    return {
        "normal": lambda: history.normal.T[both],
        "shear": lambda: mirror * history.shear.T[both] + 0.0,
        "gap": lambda: history.gap.T[both],
        "stretch": lambda: 0.0 - mirror * history.shear.T[both] / law.shear if law.shear else 0 * history.gap.T[both],
        "slide": lambda: form.slide @ history.D.T,
        "slipped": lambda: mirror * history.slipped.T[both] + 0.0,
        "states": states,
        "velocity": lambda: history.P @ momentum[1],
        "horizontal_velocity": lambda: history.P @ momentum[0],
    }


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
