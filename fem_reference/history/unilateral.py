"""Histories of the block on a base that carries no tension."""

from __future__ import annotations

import math
import time
from collections.abc import Callable
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from fem_reference.contact.points import ContactModel, build
from fem_reference.contact.shear import Friction
from fem_reference.contact.stepper import ContactState, ContactStepper
from fem_reference.history.opening_columns import COUNTS, LOSSES, UNILATERAL_COLUMNS, Observer, observers
from fem_reference.history.opening_losses import Losses
from fem_reference.problem.digits import front
from fem_reference.problem.problem import Array, Problem, Scheme

COMPLETED, OVERFLOW = "completed", "overflow"
POINTWISE = ("normal", "gap", "shear", "states", "slid")
"""What is kept of every point where it is asked for."""


@dataclass(frozen=True)
class Unilateral:
    """How the block stands on its base, and how its contact is solved.

    Raises
    ------
    ValueError
        For a value out of its range, naming field, rule and value.
    """

    gap: float = 0.0  # gap g0 under the whole base at t = 0 [m], at least 0
    velocity: float = 0.0  # velocity of the block at t = 0 [m/s], upwards positive: an impact has a negative one
    shear: str = "frictionless"  # or "glued": shear springs of the problem's shear stiffness hold closed points
    limit: int = 6  # greatest number of solutions of the open-close iteration before its fallback [-]
    cut: float = 0.3  # factor on a step whose contact has no solution [-], between 0 and 1
    rule: str = "newmark"  # or "implicit": the contact force of the step's end, under average acceleration
    shortest: float = 0.01  # shortest step over the scheme's own [-], above 0 and at most 1
    friction: Friction | None = None  # limit of the forces of glued points; none if absent

    def __post_init__(self) -> None:
        for name, rule, good in (
            ("friction", "goes with shear = 'glued' only", self.friction is None or self.shear == "glued"),
            ("gap", "must be finite and not negative", math.isfinite(self.gap) and self.gap >= 0),
            ("velocity", "must be a finite number", math.isfinite(self.velocity)),
            ("shear", "must be 'frictionless' or 'glued'", self.shear in ("frictionless", "glued")),
            ("rule", "must be 'newmark' or 'implicit'", self.rule in ("newmark", "implicit")),
            ("limit", "must be at least 1", self.limit >= 1),
            ("cut", "must be between 0 and 1", 0 < self.cut < 1),
            ("shortest", "must be above 0 and at most 1", 0 < self.shortest <= 1),
        ):
            if not good:
                raise ValueError(f"{name}: {rule}, got {getattr(self, name)!r}")


@dataclass(frozen=True)
class UnilateralResult:
    """A history with its outcome and work counts; row 0 is step 1."""

    time: Array  # time of each row [s], shape (rows,): fewer than steps asked for where the outcome is not completed
    columns: dict[str, Array]  # one array of shape (rows,) for each column that was asked for
    outcome: str  # ``"completed"``, or why it ended early
    unknowns: int  # number of unknowns that were integrated [-]
    points: int  # number of contact points of the base [-]
    nonzeros: int  # stored entries of the matrix that was factorised last [-]
    factorisations: int  # number of factorisations [-]: one for each length of step, one of M for a consistent start
    solves: int  # number of solutions with a factorised matrix [-]
    notes: tuple[str, ...]  # savings used and warnings, in words
    setup_seconds: float  # time for assembly, factorisation and the forces' responses [s]
    stepping_seconds: float  # time for the steps [s]
    normal: Array | None = None  # normal force of each point at each step [N], shape (rows, points), where asked for
    gap: Array | None = None  # gap of each point at each step [m], shape (rows, points), where asked for
    shear: Array | None = None  # tangential force of each point at each step [N], where asked for
    states: Array | None = None  # 0 open, 1 held, 2 or -2 sliding towards +x or -x, of each point, where asked for
    slid: Array | None = None  # way that each point has slid while closed [m], where asked for


def solve_unilateral(
    problem: Problem,
    scheme: Scheme,
    steps: int,
    contact: Unilateral | None = None,
    full: bool = False,
    every_point: bool = False,
    columns: tuple[str, ...] = UNILATERAL_COLUMNS,
) -> UnilateralResult:
    """Integrate the block on a base that carries no tension, unstrained at t = 0 with all loads switched on.

    Parameters
    ----------
    problem, scheme
        What is solved and how it is integrated. A base that moves begins where the block stands.
    steps
        Number of steps, at least 1.
    contact
        How the block stands on its base; touching, at rest and without friction if None.
    full
        Solve the whole block where one column of elements would do.
    every_point
        Keep forces, gap, state and sliding of every point.
    columns
        Columns of the history, among `fem_reference.history.opening_columns.UNILATERAL_COLUMNS`.

    Raises
    ------
    ValueError
        If the block cannot be meshed, its base is displaced at t = 0, `steps` is below one or a column is unknown.
    """
    if steps < 1:
        raise ValueError(f"steps: must be at least 1, got {steps!r}")
    contact = contact or Unilateral()
    began = time.perf_counter()
    model = build(problem, full)
    stepper = ContactStepper(model, scheme, contact.shear, contact.limit, contact.rule, contact.friction)
    state = stepper.start(contact.gap, contact.velocity)
    ready = time.perf_counter()
    watched = _Watched(stepper, tuple(dict.fromkeys(columns)), every_point)
    rows, outcome = _run(stepper, state, steps, contact, watched)
    ended = time.perf_counter()
    return UnilateralResult(
        time=np.asarray(scheme.step * np.arange(1, len(rows) + 1), dtype=np.float64),
        columns=watched.table(rows),
        outcome=outcome,
        unknowns=len(model.F),
        points=len(model.share),
        **vars(stepper.work),
        notes=(*_saving(model), *front(problem, scheme.step), *_ramp(problem)),
        setup_seconds=ready - began,
        stepping_seconds=ended - ready,
        **_of_points(rows, len(model.share) if every_point else 0),
    )


def _of_points(rows: list[_Row], points: int) -> dict[str, Any]:
    """What is kept of every point, shape (rows, points) each."""
    if not points:
        return {}
    kept = [[getattr(row.state, name) for row in rows] for name in POINTWISE]
    return {name: np.array(values, float).reshape(-1, points) for name, values in zip(POINTWISE, kept, strict=True)}


def _saving(model: ContactModel) -> tuple[str, ...]:
    return ("one column of elements",) if model.kind == "column" else ()


def _ramp(problem: Problem) -> tuple[str, ...]:
    """Say where the elements are longer than the way 1/kappa of a wave in which the base's pressure changes.

    A wave of modulus lam + 2 G meets springs of 2 p / a for each length of the base: kappa = 2 p / (a (lam + 2 G)).
    """
    if problem.mesh is not None:
        return ()
    spring = 2 * problem.stiffness / problem.base_length
    kappa = spring / (problem.lame + 2 * problem.shear_modulus)
    passed = kappa * float(np.ptp(problem.outline[:, 1])) / problem.elements
    return (f"too coarse for the base spring: h kappa is {passed:.3g}, at most 1 shows its ramp",) if passed > 1 else ()


@dataclass(frozen=True)
class _Row:
    observed: list[float]
    state: ContactState | None  # where every point is kept


class _Watched:
    """What is kept of every step."""

    def __init__(self, stepper: ContactStepper, asked: tuple[str, ...], every_point: bool) -> None:
        self.observers: list[Observer] = observers(stepper.model, asked)
        self.counted = [name for name in COUNTS if name in asked]
        lost = any(name in asked for name in LOSSES)
        self.losses = Losses(stepper.model, stepper.scheme.start == "consistent", stepper.rule) if lost else None
        seen = [name for name in asked if name not in (*LOSSES, *COUNTS)]
        self.columns = (*seen, *(LOSSES if lost else ()), *self.counted)
        self.every_point = every_point

    def table(self, rows: list[_Row]) -> dict[str, Array]:
        """Return the columns, shape (rows,) each."""
        observed = np.array([row.observed for row in rows]).reshape(len(rows), len(self.columns)).T
        return dict(zip(self.columns, observed, strict=True))

    def row(self, step: CutStep, state: ContactState) -> _Row:
        """Return what is kept of a step that ends in a state."""
        observed = [watch(state) for watch in self.observers]
        observed += [] if self.losses is None else self.losses.values.tolist()
        observed += [float(getattr(step, name)) for name in self.counted]
        return _Row(observed, state if self.every_point else None)


def _run(
    stepper: ContactStepper, state: ContactState, steps: int, contact: Unilateral, watched: _Watched
) -> tuple[list[_Row], str]:
    """Rows of the steps, and the outcome."""
    rows: list[_Row] = []
    accepted = None if watched.losses is None else watched.losses.add
    # A scheme beyond its limit grows until it overflows; the outcome says so.
    with np.errstate(over="ignore", invalid="ignore"):
        for _ in range(steps):
            step = advance_with_cuts(stepper, state, contact, accepted)
            if step.state is None:
                return rows, step.failure
            state = step.state
            row = watched.row(step, state)
            if not all(map(math.isfinite, row.observed)):
                return rows, OVERFLOW
            rows.append(row)
    return rows, COMPLETED


Accepted = Callable[[Scheme, ContactState, ContactState], None]


@dataclass
class CutStep:
    """One step of the scheme, in one piece or in several."""

    state: ContactState | None  # state at the end; None where even the shortest step has no contact
    solves: int = 0  # solutions of the open-close iteration in all pieces, tried and accepted [-]
    cuts: int = 0  # pieces that were tried without success [-]; the next step is tried in one piece again
    pieces: list[float] = field(default_factory=list)  # lengths of the accepted pieces over the step [-]
    failure: str = ""  # why there is no state, in words


def advance_with_cuts(
    stepper: ContactStepper, state: ContactState, contact: Unilateral, accepted: Accepted | None = None
) -> CutStep:
    """One step; a piece without a contact is repeated shorter, from the state at its start, as are those after it.

    Parameters
    ----------
    stepper
        The block and the scheme.
    state
        State at the start of the step; it is not changed.
    contact
        Factor and limit of the cuts.
    accepted
        Called with the scheme of each accepted piece and the states before and after it.
    """
    result = CutStep(state)
    left = trial = 1.0
    while left > 0:
        length = stepper.scheme.step * trial
        new, found = stepper.advance(state, length)
        result.solves += found.solves
        if new is None:
            result.cuts += 1
            if trial <= contact.shortest:
                result.state, result.failure = None, found.failure
                return result
            trial = max(contact.cut * trial, contact.shortest)
            continue
        if accepted is not None:
            accepted(stepper.scheme_of(length), state, new)
        state = new
        result.pieces.append(trial)
        # What rounding leaves over is no piece.
        left = left - trial if left - trial > 1e-9 else 0.0
        trial = min(trial, left)
    result.state = state
    return result
