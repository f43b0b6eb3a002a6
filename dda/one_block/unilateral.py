r"""Histories of one block on corners that open: pressed, dropped or thrown against its base.

The block is that of `dda.TwoBlockModel`; its two base corners carry pressure only (`dda.contact.unilateral`).
A step whose contacts have no single state is cut, from the state in which it began; the rest of the interval
follows, so that every interval ends at its own time.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from functools import cached_property
from time import perf_counter

import numpy as np
from numpy.typing import NDArray

from dda.contact.springs import base_directions
from dda.contact.unilateral import Unilateral
from dda.model.block import Block
from dda.model.load import Load, pressed_part
from dda.one_block.solution import Result, check_request, step_times
from dda.one_block.unilateral_energy import ENERGIES, Ledger
from dda.one_block.unilateral_form import UnilateralForm, unilateral_form
from dda.one_block.unilateral_step import IMPLICIT, State, StepLength, advance, start_state
from dda.scheme.newmark import Scheme

Array = NDArray[np.float64]

RULES = ("newmark", IMPLICIT)
COMPLETED = "completed"
OVERFLOW = "overflow"
FLOOR = 0.01  # shortest step that a cut may leave, over the scheme's step
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

    def __post_init__(self) -> None:
        """Check the numbers and the edges."""
        n = len(self.block.corners)
        for field in ("base", "top"):
            if not 0 <= getattr(self, field) < n:
                raise ValueError(f"{field}: must be an edge between 0 and {n - 1}, got {getattr(self, field)!r}")
        if self.base == self.top:
            raise ValueError(f"top: must differ from base, got {self.top!r}")
        if not math.isfinite(self.velocity):
            raise ValueError(f"velocity: must be finite, got {self.velocity!r}")
        pressed_part(*self.block.edge(self.top), self.applied.eccentricity)

    @cached_property
    def applied(self) -> Load:
        """All loads."""
        return Load(self.pressure, self.eccentricity, self.traction, self.gravity)

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

    rule: str = "newmark"  # or "implicit contact": average acceleration with the contact force of the step's end
    solve_limit: int = 6  # solves of the open-close iteration before all states are tried
    cut: float = 0.3  # length of a cut step over that of the failed one
    energies: bool = False  # keep the energies of every step
    full: bool = False  # keep all six unknowns and both corners, also where the motion is symmetric

    def __post_init__(self) -> None:
        """Check the ranges."""
        if self.rule not in RULES:
            raise ValueError(f"rule: must be among {', '.join(RULES)}, got {self.rule!r}")
        if isinstance(self.solve_limit, bool) or not isinstance(self.solve_limit, int) or self.solve_limit < 1:
            raise ValueError(f"solve_limit: must be a positive integer, got {self.solve_limit!r}")
        if not 0 < self.cut < 1:
            raise ValueError(f"cut: must be between 0 and 1, got {self.cut!r}")


@dataclass(frozen=True, eq=False)
class UnilateralResult(Result):
    """Histories of the steps that were reached; element 0 is step 1. Forces act on the block.

    `solves` counts the small systems of the open-close iteration, the confirming one of each step included.
    """

    outcome: str  # "completed", or why the history ends early, in words
    normal_force_m: Array  # N at M [N], away from the base
    normal_force_n: Array  # N at N [N]
    shear_force_m: Array  # T at M [N], along the base from M to N
    shear_force_n: Array  # T at N [N]
    gap_m: Array  # w at M [m], negative when pressed
    gap_n: Array  # w at N [m]
    shear_m: Array  # stretch s - r of the shear spring at M [m], 0 where open
    shear_n: Array  # stretch s - r at N [m]
    closed_m: NDArray[np.bool_]  # state of M
    closed_n: NDArray[np.bool_]  # state of N
    velocity: Array  # of the centroid, upwards [m/s]
    horizontal_velocity: Array  # of the centroid [m/s]
    step_solves: NDArray[np.int_]  # solves of each step, repeated and cut ones included
    step_cuts: NDArray[np.int_]  # times that a step was cut
    energies: dict[str, Array] | None  # by `ENERGIES` [J], losses summed from t = 0 on; None if not asked for


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
    rows = list(stepping.run(steps))
    ended = perf_counter()
    return _result(stepping, rows, columns, (ready - began, ended - ready))


def check_combination(model: UnilateralModel, scheme: Scheme, options: UnilateralOptions) -> None:
    """Raise ValueError where rule, scheme and contact exclude each other."""
    if options.rule == IMPLICIT and (scheme.alpha, scheme.delta) != (0.25, 0.5):
        given = (scheme.alpha, scheme.delta)
        raise ValueError(f"rule: implicit contact needs average acceleration, alpha = 1/4, delta = 1/2, got {given}")
    if math.isinf(model.contact.stiffness) and scheme.alpha == 0:
        raise ValueError(f"stiffness: must be finite in an explicit scheme (alpha = 0), got {model.contact.stiffness}")


@dataclass(frozen=True)
class Row:
    """One reached step."""

    state: State
    solves: int
    cuts: int
    energies: tuple[float, ...]


class Stepping:
    """The history of one block, step by step."""

    def __init__(self, model: UnilateralModel, scheme: Scheme, options: UnilateralOptions) -> None:
        self.model, self.scheme, self.options = model, scheme, options
        self.law, self.form = model.contact, model.form(options.full)
        self.outcome, self.factorisations = COMPLETED, 0
        self.lengths: dict[float, StepLength] = {}
        self.ledger = Ledger(self.form, self.law, scheme.step) if options.energies else None

    def run(self, steps: int) -> Iterator[Row]:
        """Yield the steps that are reached; `outcome` says how it ended."""
        state = start_state(self.form, self.law, self.scheme, self.model.velocity)
        for _ in range(steps):
            reached, solves, cuts = self._interval(state)
            if reached is None:
                return
            if not math.isfinite(sum(reached.D)):
                self.outcome = OVERFLOW
                return
            state = reached
            yield Row(state, solves, cuts, self.ledger.row(state) if self.ledger else ())

    def _interval(self, state: State) -> tuple[State | None, int, int]:
        """Return the state after one step of the scheme, whole or in parts, with solves and cuts."""
        left = ratio = 1.0
        solves = cuts = 0
        while True:
            length = self._length(ratio)
            after, found = advance(self.law, length, state, self.options.solve_limit)
            solves += found.solves
            if after is None:
                if ratio <= FLOOR:
                    self.outcome = str(found.failure)
                    return None, solves, cuts
                ratio, cuts = max(self.options.cut * ratio, FLOOR), cuts + 1
                continue
            if self.ledger:
                self.ledger.add(length, state, after)
            state = after
            if ratio == left:
                return state, solves, cuts
            left -= ratio
            ratio = left

    def _length(self, ratio: float) -> StepLength:
        """Return what depends on the step's length, factorised once for each."""
        if ratio not in self.lengths:
            if len(self.lengths) >= _LENGTHS:
                self.lengths = {1.0: self.lengths[1.0]}
            self.lengths[ratio] = StepLength.of(self.form, self.scheme, ratio, self.options.rule)
            self.factorisations += 1
        return self.lengths[ratio]


def _result(
    stepping: Stepping, rows: Sequence[Row], columns: Sequence[str], seconds: tuple[float, float]
) -> UnilateralResult:
    form, steps = stepping.form, len(rows)
    corners = [row.state.corners for row in rows]
    normal, gap, shear, stretch = (
        _per_corner([getattr(c, name) for c in corners]) for name in ("normal", "gap", "shear", "stretch")
    )
    if form.multiplicity == 2:  # the one contact is N, M moves and is held in the opposite direction
        shear[0], stretch[0] = -shear[0] + 0.0, -stretch[0] + 0.0
    closed = _per_corner([c.closed for c in corners]).astype(bool)
    velocity = _centroid_velocity(stepping, rows)
    kept = np.array([row.energies for row in rows]).reshape(steps, len(ENERGIES) if stepping.ledger else 0)
    return UnilateralResult(
        time=step_times(stepping.scheme, steps),
        columns=_columns(stepping, rows, normal, columns),
        unknowns=len(form.unknowns),
        nonzeros=int(np.count_nonzero(form.M)),
        factorisations=stepping.factorisations,
        solves=sum(row.solves for row in rows),
        notes=_notes(stepping, steps),
        setup_seconds=seconds[0],
        stepping_seconds=seconds[1],
        outcome=stepping.outcome,
        normal_force_m=normal[0],
        normal_force_n=normal[1],
        shear_force_m=shear[0],
        shear_force_n=shear[1],
        gap_m=gap[0],
        gap_n=gap[1],
        shear_m=stretch[0],
        shear_n=stretch[1],
        closed_m=closed[0],
        closed_n=closed[1],
        velocity=velocity[1],
        horizontal_velocity=velocity[0],
        step_solves=np.array([row.solves for row in rows], dtype=int),
        step_cuts=np.array([row.cuts for row in rows], dtype=int),
        energies=dict(zip(ENERGIES, kept.T, strict=True)) if stepping.ledger else None,
    )


def _per_corner(values: Sequence[Sequence[float]]) -> Array:
    """Return one row for M and one for N; a contact that stands for both gives both."""
    if not len(values):
        return np.zeros((2, 0))
    array = np.array(values, dtype=float).T
    return np.array([array[0], array[-1]])


def _centroid_velocity(stepping: Stepping, rows: Sequence[Row]) -> Array:
    """Return the horizontal and vertical velocity of the centroid, momentum over mass, (2, steps) [m/s]."""
    form, block = stepping.form, stepping.model.block
    mass = block.material.density * block.section.area
    P = np.array([row.state.P for row in rows]).reshape(len(rows), len(form.unknowns))
    velocity: Array = form.translation.T @ P.T / (mass * stepping.scheme.step)
    return velocity


def _columns(stepping: Stepping, rows: Sequence[Row], normal: Array, names: Sequence[str]) -> dict[str, Array]:
    form, model = stepping.form, stepping.model
    moved = np.array([row.state.D for row in rows]).reshape(len(rows), len(form.unknowns)) - form.start
    a = base_directions(model.block, model.base)[2]
    pressure = (normal[0] + normal[1]) / a
    return {name: pressure if name == "contact_pressure" else moved @ form.observers[name] + 0.0 for name in names}


def _notes(stepping: Stepping, steps: int) -> tuple[str, ...]:
    """Say what was saved and how the history ended, if early."""
    names = stepping.form.unknowns
    saved = (f"both corners as one, unknowns {', '.join(names)}",) if len(names) < 6 else ()
    ended = () if stepping.outcome == COMPLETED else (f"{stepping.outcome} at step {steps + 1}",)
    return (*saved, "stepped: contact opens and closes", *ended)
