"""Histories of sub-blocks over a base that carries no tension."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from time import perf_counter
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from dda.contact.points import Found
from dda.contact.rubbing_points import states
from dda.contact.unilateral import CONSISTENT, LAGGED
from dda.one_block.solution import Result, at_corner, check_request, step_times
from dda.one_block.unilateral import COMPLETED, OVERFLOW, UnilateralOptions, check_scheme
from dda.one_block.unilateral_energy import ENERGIES
from dda.one_block.unilateral_step import NEWMARK
from dda.scheme.cutting import Interval, Lengths, in_parts
from dda.scheme.newmark import Scheme
from dda.system.opening import Length, OpeningSystem, SystemState, start_state
from dda.system.opening_energy import SystemLedger

Array = NDArray[np.float64]
_LENGTHS = 16  # step lengths whose factors are kept


@dataclass(frozen=True, eq=False)
class OpeningResult(Result):
    """Histories of the steps that were reached; element 0 is step 1. Forces act on the sub-blocks.

    The points of the base are in their order from M to N, two for each sub-block on it.
    """

    outcome: str  # "completed", or why the history ends early, in words
    normal: Array  # (points, steps) N, away from the base [N]
    shear: Array  # (points, steps) T, along the base from M to N [N]
    gap: Array  # (points, steps) w, negative when pressed [m]
    closed: NDArray[np.bool_]  # (points, steps)
    states: NDArray[np.int_]  # (points, steps) 0 open, 1 closed and not slipping, 2 and -2 slipping towards N and M
    slide: Array  # (points, steps) displacement along the base [m]
    slipped: Array  # (points, steps) change of the shear reference by slip in the step [m]
    velocity: Array  # of the centre of mass, upwards [m/s]
    horizontal_velocity: Array  # of the centre of mass [m/s]
    step_solves: NDArray[np.int_]  # solves of each step, repeated and cut ones included
    step_cuts: NDArray[np.int_]  # times that a step was cut
    energies: dict[str, Array] | None  # by `ENERGIES` [J], losses summed from t = 0 on; None if not asked for

    @property
    def slip(self) -> Array:
        """Largest sum of what the reference of a point moved while it was pressed, (steps,) [m]."""
        return np.asarray(np.abs(np.cumsum(self.slipped, axis=1)).max(axis=0))

    # of the first and the last point alone
    normal_force_m, normal_force_n = at_corner("normal", 0), at_corner("normal", -1)  # N, away from the base [N]
    shear_force_m, shear_force_n = at_corner("shear", 0), at_corner("shear", -1)  # T, from M to N [N]
    gap_m, gap_n = at_corner("gap", 0), at_corner("gap", -1)  # w, negative when pressed [m]
    slide_m, slide_n = at_corner("slide", 0), at_corner("slide", -1)  # s [m]
    closed_m, closed_n = at_corner("closed", 0), at_corner("closed", -1)
    state_m, state_n = at_corner("states", 0), at_corner("states", -1)


class Row(NamedTuple):
    """What is kept of a step."""

    columns: Array
    normal: Array
    shear: Array
    gap: Array
    closed: NDArray[np.bool_]
    states: NDArray[np.int_]
    slide: Array
    slipped: Array
    momentum: Array  # dt times the momentum in x and y
    solves: int
    cuts: int
    energies: tuple[float, ...]


def solve_opening_system(
    opening: OpeningSystem,
    scheme: Scheme,
    steps: int,
    columns: Sequence[str] = ("displacement", "contact_pressure"),
    options: UnilateralOptions | None = None,
) -> OpeningResult:
    """Step sub-blocks on points that open, from rest or from their starting velocity.

    Parameters and outcomes are those of `dda.solve_unilateral`; the rule is "newmark", and all unknowns are kept.

    Raises
    ------
    ValueError
        If the number of steps is not positive, a column is unknown, or rule, scheme and contact exclude each other.
    """
    import scipy.sparse.linalg  # noqa: F401  (before the clock starts)

    check_request(steps, columns)
    options = options or UnilateralOptions()
    if options.rule != NEWMARK:
        raise ValueError(f"rule: sub-blocks take {NEWMARK} alone, got {options.rule!r}")
    if opening.law.rules == LAGGED:
        raise ValueError(f"rules: sub-blocks take {CONSISTENT} friction alone, got {LAGGED!r}")
    check_scheme(opening.law, scheme)
    began = perf_counter()
    stepping = SystemStepping(opening, scheme, options, columns)
    stepping.length(1.0)
    ready = perf_counter()
    with np.errstate(all="ignore"):
        rows = list(stepping.run(steps))
    return _result(stepping, rows, (ready - began, perf_counter() - ready))


class SystemStepping:
    """The history of the sub-blocks, step by step."""

    def __init__(
        self, opening: OpeningSystem, scheme: Scheme, options: UnilateralOptions, columns: Sequence[str]
    ) -> None:
        self.opening, self.scheme, self.options, self.names = opening, scheme, options, tuple(columns)
        self.outcome = COMPLETED
        self.length = Lengths(lambda ratio: Length(opening, scheme, ratio), _LENGTHS)
        self.observers = opening.equations.rows(columns)[0]
        self.pressed = (
            np.array([name == "contact_pressure" for name in columns], dtype=float)[:, None]
            / opening.system.base_length
        )
        self.ledger = SystemLedger(opening, scheme.step) if options.energies else None

    def run(self, steps: int) -> Iterator[Row]:
        """Yield the steps that are reached; `outcome` says how it ended."""
        state = start_state(self.opening, self.scheme)
        for number in range(steps):
            made = self._interval(state, number)
            if made.failure is not None:
                self.outcome = made.failure
                return
            state = made.parts[-1][2]
            if not np.isfinite(state.D).all():
                self.outcome = OVERFLOW
                return
            slipped = sum((after.points.slipped for _, _, after in made.parts if after.points.slipped is not None), 0.0)
            slide = self.opening.tangents @ state.D - self._base(number + 1)[1]
            yield self._row(state, slide, slipped + np.zeros(len(slide)), made.solves, made.cuts)

    def _base(self, steps: float) -> Array:
        """Return the displacement of the base after so many steps, along its normal and its tangent [m]."""
        moved: Array = self.opening.base([steps * self.scheme.step])[0]
        return moved

    def _row(self, state: SystemState, slide: Array, slipped: Array, solves: int, cuts: int) -> Row:
        p = state.points
        seen = self.observers @ state.D + self.pressed @ np.array([np.sum(p.normal)])
        momentum = state.P.reshape(-1, 6)[:, :2].sum(axis=0)
        kept = self.ledger.row(state) if self.ledger else ()
        contact = (p.normal, p.shear, p.gap, p.closed, states(p), slide, slipped)
        return Row(seen, *contact, momentum, solves, cuts, kept)

    def _interval(self, state: SystemState, number: int) -> Interval[SystemState]:
        """Return one step of the scheme, whole or in parts, after `number` others."""

        def carried(begun: float, ratio: float) -> list[float]:
            if self.opening.motion is None:
                return [0.0, 0.0]
            way: list[float] = (self._base(number + begun + ratio) - self._base(number + begun)).tolist()
            return way

        def attempt(state: SystemState, begun: float, ratio: float) -> tuple[SystemState | None, Found]:
            return self.length(ratio).advance(state, self.options.solve_limit, carried(begun, ratio))

        made, begun = in_parts(attempt, state, self.options.cut), 0.0
        if self.ledger is None:
            return made
        for ratio, before, after in made.parts:
            self.ledger.add(self.length(ratio), before, after, carried(begun, ratio))
            begun += ratio
        return made


def _result(stepping: SystemStepping, rows: Sequence[Row], seconds: tuple[float, float]) -> OpeningResult:
    opening, steps = stepping.opening, len(rows)
    points, blocks = len(opening.normals), opening.system.blocks
    mass = math.fsum(block.material.density * block.section.area for block in blocks)

    def history(name: str, width: int) -> Array:
        return np.array([getattr(row, name) for row in rows], dtype=float).reshape(steps, width).T

    velocity = history("momentum", 2) / (mass * stepping.scheme.step)
    kept = history("energies", len(ENERGIES)) if stepping.ledger else None
    ended = () if stepping.outcome == COMPLETED else (f"{stepping.outcome} at step {steps + 1}",)
    return OpeningResult(
        time=step_times(stepping.scheme, steps),
        columns=dict(zip(stepping.names, history("columns", len(stepping.names)) + 0.0, strict=True)),
        unknowns=len(opening.equations.F),
        nonzeros=stepping.length(1.0).stepper.factor.nonzeros,
        factorisations=stepping.length.made,
        solves=sum(row.solves for row in rows),
        notes=("stepped: contact opens and closes", *ended),
        setup_seconds=seconds[0],
        stepping_seconds=seconds[1],
        outcome=stepping.outcome,
        normal=history("normal", points),
        shear=history("shear", points),
        gap=history("gap", points),
        closed=history("closed", points) > 0,
        states=history("states", points).astype(int),
        slipped=history("slipped", points),
        slide=history("slide", points),
        velocity=velocity[1],
        horizontal_velocity=velocity[0],
        step_solves=np.array([row.solves for row in rows], dtype=int),
        step_cuts=np.array([row.cuts for row in rows], dtype=int),
        energies=None if kept is None else dict(zip(ENERGIES, kept, strict=True)),
    )
