"""The block of one strain with no-tension corners and friction, exact in time: from switch to switch.

A corner is closed while it presses, N = -p w >= 0, and open while its gap w is positive; closed, it sticks, or slips
at |T| = tan(phi) N + C. Between switches the block obeys M x'' + K x = F with the springs of its closed corners, in
closed form. The next switch is the first instant at which a gap or a normal force falls through zero, the shear force
of a corner that sticks reaches its limit, or the reference of one that slips comes to rest. Everything is computed in
decimal arithmetic, so that the many switches of a stiff contact, each of which amplifies the errors before it, leave
all digits of a float.

A corner at zero gap goes the way of the first derivative of its gap that is not zero: a block that touches
at rest when a pressure is switched on lifts off at once, since its base accelerates upwards. In the same way a corner
that closes slips at once where p_s |s'| > tan(phi) p |w'|, unless it has cohesion. What opens with a shear force T
releases the energy T^2 / (2 p_s) of its spring.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace
from decimal import Decimal, getcontext
from functools import cached_property

import numpy as np
from numpy.typing import ArrayLike

from fem_reference.events.block_model import OPEN, STICKS, Base, BlockModel, BlockProblem, Course
from fem_reference.events.block_pieces import FloatPiece, Piece, Pieces
from fem_reference.events.block_rows import State
from fem_reference.events.block_switching import Beginning, arrived, changes, settled
from fem_reference.events.decimals import ZERO, working
from fem_reference.events.switches import NoContactStateError, Switch, TooManySwitchesError
from fem_reference.problem.instants import by_pieces, instants
from fem_reference.problem.problem import Array

DIGITS = 50
"""Decimal digits of the computation."""


@dataclass(frozen=True)
class BlockHistory:
    """The motion at given instants; forces act on the block."""

    time: Array  # instants [s], shape (times,)
    displacement: Array  # (u, v, r, ex, ey, gxy) of the centroid [m, rad, -], shape (6, times)
    velocity: Array  # their rates [m/s, 1/s], shape (6, times)
    gap: Array  # gap w at M and N [m], negative when pressed, shape (2, times)
    gap_velocity: Array  # rate of the gap, which is the normal velocity of the base corner [m/s], shape (2, times)
    normal_force: Array  # N = p max(0, -w) at M and N, of locked corners -p w [N], upwards, shape (2, times)
    shear_force: Array  # T of the closed corners [N], towards +x, shape (2, times)
    slide: Array  # slide s at M and N over the base [m], shape (2, times)
    slipped: Array  # movement of the shear reference r by slipping until then, at M and N [m], shape (2, times)
    states: Array  # 0 open, 1 sticks, 2 slips towards +x, -2 slips towards -x, at M and N, shape (2, times)
    closed: Array  # 1 where a corner is closed, else 0, shape (2, times)
    contact_pressure: Array  # (N_M + N_N) / a [Pa], shape (times,)
    kinetic: Array  # kinetic energy [J], shape (times,)
    strain: Array  # strain energy [J], shape (times,)
    springs: Array  # energy of the normal and shear springs [J], shape (times,)
    load: Array  # potential energy of pressure, traction and weight, -F x, less the base's work [J], shape (times,)
    released: Array  # energy of the shear springs lost by opening until then [J], shape (times,)
    friction: Array  # energy lost by friction until then [J], shape (times,)

    @property
    def energy(self) -> Array:
        """Sum of all energies, which the motion conserves [J]."""
        return self.kinetic + self.strain + self.springs + self.load + self.released + self.friction


@dataclass(frozen=True)
class BlockMotion:
    """Exact motion of a block from t = 0 to `end`."""

    problem: BlockProblem
    end: float  # last instant [s]
    closed_at_start: tuple[bool, bool]  # whether M and N are closed just after t = 0
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
        t = instants(times, self.end)
        x, rate, rest = np.empty((12, len(t))), np.empty((12, len(t))), np.empty((7, len(t)))
        for i, here in by_pieces(t, [piece.start[0] for piece in self.pieces]):
            piece = self.pieces[i]
            x[:, here], rate[:, here] = piece.values(t[here])
            rest[:, here] = piece.contacts(t[here], x[:, here])
        return self._history(t, x, rate, rest)

    def _history(self, t: Array, x: Array, rate: Array, rest: Array) -> BlockHistory:
        mass, elastic, load = self._matrices
        p, ps = self.problem.stiffness, self.problem.shear_stiffness
        closed = np.asarray(rest[:2] != OPEN, dtype=float)
        N = -p * x[6:8] if self.problem.locked else closed * np.maximum(0.0, -p * x[6:8])
        T = 0.0 - ps * x[8:10]
        return BlockHistory(
            time=t,
            displacement=_unknowns(x),
            velocity=_unknowns(rate),
            gap=x[6:8],
            gap_velocity=rate[6:8],
            normal_force=N,
            shear_force=T,
            slide=x[10:12],
            slipped=rest[2:4],
            states=rest[:2],
            closed=closed,
            contact_pressure=N.sum(axis=0) / self.problem.width,
            kinetic=mass @ rate[:6] ** 2 / 2,
            strain=np.einsum("it,ij,jt->t", x[:6], elastic, x[:6]) / 2,
            springs=(N**2 / p - T * x[8:10]).sum(axis=0) / 2,
            load=-load @ x[:6] - rest[6],
            released=rest[4],
            friction=rest[5],
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
        for piece, found in _march(BlockModel.of(problem), Course.of(problem.base), Decimal(end)):
            pieces.append(FloatPiece(piece, pieces[-1] if pieces else None))
            switches += found
            if len(switches) > limit:
                raise TooManySwitchesError(f"more than {limit} switches by {float(piece.state.time):g} s")
    start = [bool(state != OPEN) for state in pieces[0].states]
    return BlockMotion(problem, float(end), (start[0], start[1]), tuple(switches), tuple(pieces))


def _march(model: BlockModel, course: Course, end: Decimal) -> Iterator[tuple[Piece, list[Switch]]]:
    """The pieces one after another, each with the switches at its start."""
    pieces = Pieces(model)
    state, found = _first(model, course.base(ZERO)), list[Switch]()
    if not model.locked:
        state = settled(pieces, state)
    while state.time < end:
        piece = pieces(state)
        yield piece, found
        before, state = state, _next(pieces, piece, course, end)
        found = changes(before, state)


def _first(model: BlockModel, base: Base) -> State:
    """The state at t = 0; the shear springs are relaxed."""
    states = (OPEN, OPEN) if model.gap > base.y else (STICKS, STICKS)
    return State(ZERO, [ZERO] * 6, model.velocity, states, (-base.x, -base.x), ZERO, (ZERO, ZERO), base)


def _next(pieces: Pieces, piece: Piece, course: Course, end: Decimal) -> State:
    """The state at the next switch, at the next row of the base's record, or where the piece has become long enough."""
    state = piece.state
    following = course.following(state.time)
    row = end if following is None else min(end, following)
    left = row - state.time
    s = left if piece.longest is None else min(left, piece.longest)
    beginning, switched = Beginning(pieces, state), False
    corners = () if pieces.model.locked else (0, 1)
    for watched in (one for c in corners for one in piece.corner(c).watched()):
        lead = beginning.lead(watched)
        found = ZERO if lead.sign < 0 else None
        if lead.sign > 0 and lead.clear < s:
            found = piece.first_fall(watched, s, lead.clear)
        if found is not None:
            s, switched = found, True
    x, rate = piece.after(s)
    time = row if s == left else state.time + s
    base = course.base(time) if s == left else state.base.after(s)
    there = arrived(pieces.model, replace(state, time=time, displacement=x, velocity=rate, base=base))
    if pieces.model.locked or (not switched and s < left):
        return there
    return _settled(pieces, there, s / end)


def _settled(pieces: Pieces, state: State, share: Decimal) -> State:
    """The state with its corners as they agree with the motion, which cannot be as they were a moment before."""
    found = settled(pieces, state)
    if found.states == state.states and share <= Decimal(10) ** (-getcontext().prec // 2):
        raise NoContactStateError(f"the state of the corners contradicts the motion at {float(state.time)!r} s")
    return found
