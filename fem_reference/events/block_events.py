"""The block of one strain with no-tension corners, exact in time: from switch to switch in closed form.

A corner is closed while it presses, N = -p w >= 0, and open while its gap w is positive. Between switches
the block obeys M x'' + K x = F with the springs of its closed corners; its modes are sums of sines, cosines
and parabolas. The next switch is the first instant at which a closed corner's gap rises through zero or an
open corner's gap falls through it. Everything is computed in decimal arithmetic, so that the many switches
of a stiff contact, each of which amplifies the errors before it, leave all digits of a float.

A corner at zero gap goes the way of the first derivative of its gap that is not zero: a block that touches
at rest when a pressure is switched on lifts off at once, since its base accelerates upwards. With glued
shear an opening releases the energy T^2 / (2 p_s) of the shear spring.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace
from decimal import Decimal, getcontext
from functools import cached_property
from itertools import product

import numpy as np
from numpy.typing import ArrayLike

from fem_reference.events.block_model import CORNERS, BlockModel, BlockProblem
from fem_reference.events.block_pieces import Closed, FloatPiece, Modes, Piece, State
from fem_reference.events.decimals import ZERO, Vector, dot, working
from fem_reference.events.switches import NoContactStateError, Switch, TooManySwitchesError
from fem_reference.problem.problem import Array

DIGITS = 50
"""Decimal digits of the computation."""
SPAN = 60
"""Longest piece as an angle of its fastest mode [rad]; the sines of longer pieces would lose digits in floats."""
DERIVATIVES = 8
"""Derivatives of a gap after which it counts as zero for ever."""


@dataclass(frozen=True)
class BlockHistory:
    """The motion at given instants; forces act on the block."""

    time: Array  # instants [s], shape (times,)
    displacement: Array  # (u, v, r, ex, ey, gxy) of the centroid [m, rad, -], shape (6, times)
    velocity: Array  # their rates [m/s, 1/s], shape (6, times)
    gap: Array  # gap w at M and N [m], negative when pressed, shape (2, times)
    gap_velocity: Array  # rate of the gap, which is the normal velocity of the base corner [m/s], shape (2, times)
    normal_force: Array  # N = p max(0, -w) at M and N [N], upwards, shape (2, times)
    shear_force: Array  # T = -p_s (s - r) of the closed corners [N], towards +x, shape (2, times)
    closed: Array  # 1 where a corner is closed, else 0, shape (2, times)
    contact_pressure: Array  # (N_M + N_N) / a [Pa], shape (times,)
    kinetic: Array  # kinetic energy [J], shape (times,)
    strain: Array  # strain energy [J], shape (times,)
    springs: Array  # energy of the normal and shear springs [J], shape (times,)
    load: Array  # potential energy of pressure, traction and weight, -F x [J], shape (times,)
    released: Array  # energy of the shear springs lost by opening until then [J], shape (times,)

    @property
    def energy(self) -> Array:
        """Sum of all energies, which the motion conserves [J]."""
        return self.kinetic + self.strain + self.springs + self.load + self.released


@dataclass(frozen=True)
class BlockMotion:
    """Exact motion of a block from t = 0 to `end`."""

    problem: BlockProblem
    end: float  # last instant [s]
    closed_at_start: Closed  # whether M and N are closed just after t = 0
    switches: tuple[Switch, ...]  # changes of the corners in the order of time; together: M, then N
    pieces: tuple[FloatPiece, ...]  # the pieces of the motion in the order of time

    @cached_property
    def _matrices(self) -> tuple[Array, Array, Array]:
        with working(DIGITS):
            model = BlockModel.of(self.problem)
        mass, elastic, load = (np.array(x, dtype=float) for x in (model.mass, model.elastic, model.load))
        return mass, elastic, load

    def at(self, times: ArrayLike) -> BlockHistory:
        """The motion at instants in any order.

        Raises
        ------
        ValueError
            If an instant is not from 0 to `end`.
        """
        t: Array = np.atleast_1d(np.asarray(times, dtype=float))
        if t.ndim != 1 or not np.all((t >= 0) & (t <= self.end)):
            raise ValueError(f"times: must be a list of instants from 0 to the end {self.end!r}, got {times!r}")
        starts = np.array([piece.start[0] for piece in self.pieces])
        index = np.searchsorted(starts, t, side="right") - 1
        x, rate = np.empty((10, len(t))), np.empty((10, len(t)))
        closed, released = np.empty((2, len(t))), np.empty(len(t))
        for i in np.unique(index):
            here, piece = index == i, self.pieces[i]
            x[:, here], rate[:, here] = piece.values(t[here])
            closed[:, here], released[here] = piece.closed[:, None], piece.released
        return self._history(t, x, rate, closed, released)

    def _history(self, t: Array, x: Array, rate: Array, closed: Array, released: Array) -> BlockHistory:
        mass, elastic, load = self._matrices
        p, ps = self.problem.stiffness, self.problem.shear_stiffness
        N = closed * np.maximum(0.0, -p * x[6:8])
        T = -ps * closed * x[8:10]
        return BlockHistory(
            time=t,
            displacement=_unknowns(x),
            velocity=_unknowns(rate),
            gap=x[6:8],
            gap_velocity=rate[6:8],
            normal_force=N,
            shear_force=T,
            closed=closed,
            contact_pressure=N.sum(axis=0) / self.problem.width,
            kinetic=mass @ rate[:6] ** 2 / 2,
            strain=np.einsum("it,ij,jt->t", x[:6], elastic, x[:6]) / 2,
            springs=(N**2 / p - T * closed * x[8:10]).sum(axis=0) / 2,
            load=-load @ x[:6],
            released=released,
        )


def _unknowns(x: Array) -> Array:
    """(u, v, r, ex, ey, gxy) of the first six rows u, v, ux, uy, vx, vy."""
    u, v, ux, uy, vx, vy = x[:6]
    return np.array([u, v, (vx - uy) / 2, ux, vy, uy + vx])


def solve(problem: BlockProblem, end: float, digits: int = DIGITS, limit: int = 100_000) -> BlockMotion:
    """The exact motion of a block from t = 0 to `end` [s].

    Parameters
    ----------
    problem
        The block, its corners and its loads.
    end
        Last instant [s].
    digits
        Decimal digits of the computation, at least 30.
    limit
        Greatest number of switches.

    Raises
    ------
    ValueError
        If `end` is not positive and finite or `digits` is below 30.
    TooManySwitchesError
        If there are more switches than `limit`.
    NoContactStateError
        If no state of the corners agrees with the motion that follows from it.
    """
    if not (np.isfinite(end) and end > 0):
        raise ValueError(f"end: must be positive and finite, got {end!r}")
    if digits < 30:
        raise ValueError(f"digits: must be at least 30, got {digits!r}")
    pieces: list[FloatPiece] = []
    switches: list[Switch] = []
    with working(digits):
        for piece, changes in _march(BlockModel.of(problem), Decimal(end)):
            pieces.append(FloatPiece(piece))
            switches += changes
            if len(switches) > limit:
                raise TooManySwitchesError(f"more than {limit} switches by {float(piece.state.time):g} s")
    start = tuple(bool(x) for x in pieces[0].closed)
    return BlockMotion(problem, float(end), (start[0], start[1]), tuple(switches), tuple(pieces))


def _march(model: BlockModel, end: Decimal) -> Iterator[tuple[Piece, list[Switch]]]:
    """The pieces one after another, each with the switches at its start."""
    modes: dict[Closed, Modes] = {}
    rest = State(ZERO, [ZERO] * 6, model.velocity, (model.gap == 0, model.gap == 0), (ZERO, ZERO), ZERO)
    state, changes = _settled(model, rest), list[Switch]()
    while state.time < end:
        if state.closed not in modes:
            modes[state.closed] = Modes.of(model, state.closed)
        piece = Piece(model, modes[state.closed], state)
        yield piece, changes
        before, state = state, _next(piece, end)
        changes = _changes(before, state)


def _changes(before: State, after: State) -> list[Switch]:
    kinds = {(True, False): "opens", (False, True): "closes"}
    pairs = zip(CORNERS, zip(before.closed, after.closed, strict=True), strict=True)
    return [Switch(float(after.time), corner, kinds[pair]) for corner, pair in pairs if pair in kinds]


def _next(piece: Piece, end: Decimal) -> State:
    """The state at the next switch, or where the piece has become long enough."""
    gaps = [piece.gap(c) for c in (0, 1)]
    left = end - piece.state.time
    fastest = max(q.fastest for q in piece.coordinates)
    s = min(left, SPAN / fastest) if fastest else left
    switched = False
    for gap, shut in zip(gaps, piece.state.closed, strict=True):
        found = (gap.negative() if shut else gap).first_fall(s)
        if found is not None:
            s, switched = found, True
    x, rate = piece.after(s)
    time = piece.state.time + s if switched or s < left else end
    state = replace(piece.state, time=time, displacement=x, velocity=rate)
    if not switched:
        return state
    settled = _settled(piece.model, state)
    if settled.closed == piece.state.closed and s <= left * Decimal(10) ** (-getcontext().prec // 2):
        raise NoContactStateError(f"the state of the corners contradicts the motion at {float(time)!r} s")
    return settled


def _settled(model: BlockModel, state: State) -> State:
    """The state with those corners open or closed that stand at zero gap."""
    half = Decimal(10) ** (-getcontext().prec // 2)
    touching = [abs(_gap(model, state.displacement, c)) <= half * _size(model, state, c) for c in (0, 1)]
    choices = [(True, False) if tie else (shut,) for tie, shut in zip(touching, state.closed, strict=True)]
    for first, second in product(*choices):
        tried = _switched(model, state, (first, second))
        if all(_agrees(model, tried, c) for c in (0, 1) if touching[c]):
            return tried
    raise NoContactStateError(f"no state of the corners agrees with the motion at {float(state.time)!r} s")


def _gap(model: BlockModel, x: Vector, corner: int) -> Decimal:
    return model.gap + dot(model.normal[corner], x)


def _size(model: BlockModel, state: State, corner: int) -> Decimal:
    """Sum of the absolute values that make up a gap."""
    return model.gap + dot(map(abs, model.normal[corner]), map(abs, state.displacement))


def _switched(model: BlockModel, state: State, closed: Closed) -> State:
    """The state with its corners closed as given: new references where they close, energy lost where they open."""
    references, released = list(state.references), state.released
    for c, (was, now) in enumerate(zip(state.closed, closed, strict=True)):
        stretch = dot(model.shear[c], state.displacement)
        if now and not was:
            references[c] = stretch
        if was and not now:
            released += model.ps * (stretch - references[c]) ** 2 / 2
    return replace(state, closed=closed, references=(references[0], references[1]), released=released)


def _agrees(model: BlockModel, state: State, corner: int) -> bool:
    """Whether a touching corner's gap falls or stays zero if it is closed, rises if it is open."""
    for value, size in _derivatives(model, state, corner):
        if abs(value) > Decimal(10) ** (-getcontext().prec // 2) * size:
            return (value < 0) == state.closed[corner]
    return state.closed[corner]


def _derivatives(model: BlockModel, state: State, corner: int) -> Iterator[tuple[Decimal, Decimal]]:
    """Derivatives of a gap from the first on, each with the sum of the absolute values of its terms."""
    row, K = model.normal[corner], model.stiffness(state.closed)
    F = model.force(state.closed, state.references)
    x, rate = state.displacement, state.velocity
    for _ in range(DERIVATIVES // 2):
        yield dot(row, rate), dot(map(abs, row), map(abs, rate))
        forces = [f - dot(line, x) for f, line in zip(F, K, strict=True)]
        sizes = [abs(f) + dot(map(abs, line), map(abs, x)) for f, line in zip(F, K, strict=True)]
        bend = [f / m for f, m in zip(forces, model.mass, strict=True)]
        yield dot(row, bend), dot(map(abs, row), [f / m for f, m in zip(sizes, model.mass, strict=True)])
        jerk = [-dot(line, rate) / m for line, m in zip(K, model.mass, strict=True)]
        x, rate, F = bend, jerk, [ZERO] * 6
