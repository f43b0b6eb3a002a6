"""The block of one strain with no-tension corners and friction, exact in time: from switch to switch.

A corner is closed while it presses, N = -p w >= 0, and open while its gap w is positive; closed, it sticks, or slips
at |T| = tan(phi) N + C. Between switches the block obeys M x'' + K x = F with the springs of its closed corners, whose
power series is summed in ball arithmetic. The next switch is the first instant at which a gap or a normal force falls
through zero, the shear force of a corner that sticks reaches its limit, or the reference of one that slips comes to
rest. That it is the first is proven: up to it Bernstein's form of each of these functions, or Taylor's formula with a
bound on the third derivative, is positive (`block_flow.Step.doubtful`, `enclosure.first_fall`), and the interval Newton
operator proves that one root lies in the ball of its instant. Where two corners switch in one ball both switch in it;
where a function comes so near to zero that a crossing is neither proven nor excluded, its instant is in `touches`.

A corner at zero gap goes the way of the first derivative of its gap that is not zero: a block that touches
at rest when a pressure is switched on lifts off at once, since its base accelerates upwards. In the same way a corner
that closes slips at once where p_s |s'| > tan(phi) p |w'|, unless it has cohesion. What opens with a shear force T
releases the energy T^2 / (2 p_s) of its spring.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import ArrayLike, NDArray

from fem_reference.events.block_flow import ANGLE, FLOAT_TERMS, ROUNDING
from fem_reference.events.block_march import March, Node
from fem_reference.events.block_model import OPEN, RIGHT, STICKS, BlockModel, BlockProblem, Course
from fem_reference.events.block_switching import Flows
from fem_reference.events.enclosure import working
from fem_reference.events.switches import LostDigitsError, Switch
from fem_reference.problem.instants import instants
from fem_reference.problem.problem import Array

DIGITS = 60
"""Decimal digits of the first computation."""
MOST_DIGITS = 240
"""Decimal digits of the last one, where switches cost those of the ones before."""
PROMISED = 1e-20
"""Part of the end of the motion to which the instant of each switch is enclosed; more digits are taken for it."""
CHUNK = 2000
"""Instants that are computed together."""
Places = NDArray[np.intp]


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
    displacement_radius: Array  # greatest distance of each displacement from the true one, shape (6, times)

    @property
    def energy(self) -> Array:
        """Sum of all energies, which the motion conserves [J]."""
        return self.kinetic + self.strain + self.springs + self.load + self.released + self.friction


@dataclass(frozen=True)
class BlockMotion:
    """Exact motion of a block from t = 0 to `end`."""

    problem: BlockProblem
    end: float  # last instant [s]
    digits: int  # decimal digits of the computation
    closed_at_start: tuple[bool, bool]  # whether M and N are closed just after t = 0
    switches: tuple[Switch, ...]  # changes of the corners in the order of time; together: M, then N
    touches: tuple[float, ...]  # instants at which a switch was neither proven nor excluded, and none was taken [s]
    nodes: tuple[Node, ...]  # beginnings of the steps in the order of time

    @property
    def radius(self) -> float:
        """Greatest proven radius of the instant of a switch, 0 without one [s]."""
        return max((switch.radius for switch in self.switches), default=0.0)

    @property
    def simultaneous(self) -> tuple[float, ...]:
        """Instants at which both corners switch within one ball [s]."""
        corners: dict[str, set[str]] = {}
        for switch in self.switches:
            corners.setdefault(switch.midpoint, set()).add(switch.corner)
        return tuple(float(time) for time, both in corners.items() if len(both) == 2)

    @cached_property
    def _flows(self) -> Flows:
        with working(DIGITS):
            return Flows(BlockModel(self.problem))

    @cached_property
    def _matrices(self) -> tuple[Array, Array, Array]:
        model = self._flows.model
        mass, load = (np.array([float(x) for x in part]) for part in (model.mass, model.load))
        return mass, np.array([[float(x) for x in row] for row in model.elastic]), load

    @cached_property
    def _starts(self) -> Array:
        return np.array([node.start[0] for node in self.nodes])

    @cached_property
    def _gathered(self) -> Stacked:
        return Stacked(self.nodes)

    @cached_property
    def _spent(self) -> Array:
        """Energy lost by friction and work of the base until each node [J], shape (2, nodes)."""
        lengths = np.append(self._starts[1:], self.end) - self._starts
        gains = np.zeros((2, len(self.nodes)))
        for part in self._series(np.arange(len(self.nodes))):
            gains[:, part.index] = part.spent(lengths[part.index])
        return np.hstack([np.zeros((2, 1)), np.cumsum(gains, axis=1)[:, :-1]])

    def _series(self, nodes: Places) -> Iterator[StepSeries]:
        """The series of some nodes, those of one state of the corners together, at most `CHUNK` at once."""
        gathered = self._gathered
        keys = gathered.keys[nodes]
        for key in np.unique(keys):
            places = np.flatnonzero(keys == key)
            for first in range(0, len(places), CHUNK):
                chunk = places[first : first + CHUNK]
                with working(DIGITS):
                    yield StepSeries(self._flows, gathered, nodes[chunk], chunk)

    def at(self, times: ArrayLike) -> BlockHistory:
        """The motion at instants in any order.

        Raises
        ------
        ValueError
            If an instant is not from 0 to `end`.
        """
        t = instants(times, self.end)
        x, rate, rest, radius = (np.empty((count, len(t))) for count in (12, 12, 7, 6))
        nodes = np.searchsorted(self._starts, t, side="right") - 1
        for part in self._series(nodes):
            here = part.index
            s = (t[here] - part.start[0]) - part.start[1]
            x[:, here], rate[:, here], radius[:, here] = part.values(s)
            rest[:5, here] = part.contacts(x[:, here])
            rest[5:, here] = self._spent[:, nodes[here]] + part.spent(s)
        return self._history(t, x, rate, rest, radius)

    def _history(self, t: Array, x: Array, rate: Array, rest: Array, radius: Array) -> BlockHistory:
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
            displacement_radius=radius,
        )


def _unknowns(x: Array) -> Array:
    """(u, v, r, ex, ey, gxy) of the first six rows u, v, ux, uy, vx, vy."""
    u, v, ux, uy, vx, vy = x[:6]
    return np.array([u, v, (vx - uy) / 2, ux, vy, uy + vx])


class Stacked:
    """The nodes of a motion as arrays, one column a node."""

    def __init__(self, nodes: tuple[Node, ...]) -> None:
        self.states = np.array([node.states for node in nodes], dtype=float).T
        self.keys = 10 * self.states[0] + self.states[1]
        self.start = np.array([node.start for node in nodes]).T
        self.values = np.array([node.values for node in nodes]).T
        self.radius = np.array([node.radius for node in nodes]).T
        self.base = np.array([node.base for node in nodes]).T
        self.references = np.array([node.references for node in nodes]).T
        self.slipped = np.array([node.slipped for node in nodes]).T
        self.released = np.array([node.released for node in nodes])


class StepSeries:
    """Power series of what is reported, in floats, from nodes in one state of the corners."""

    def __init__(self, flows: Flows, stacked: Stacked, nodes: Places, index: Places) -> None:
        self.index = index  # places of the nodes among those that were asked for
        states = stacked.states[:, nodes[0]]
        self.flow = flows[int(states[0]), int(states[1])]
        self.scale = ANGLE / self.flow.rate
        self.start, self.states = stacked.start[:, nodes], stacked.states[:, nodes]
        self.slipped, self.released = stacked.slipped[:, nodes], stacked.released[nodes]
        self.references, self.base = stacked.references[:, nodes], stacked.base[:, nodes]
        table = np.einsum("ij,kjl->kil", self.flow.outputs, self.flow.powers(self.scale))
        self.c = table @ stacked.values[:, nodes]  # over (s / scale)^k, shape (terms, 12, nodes)
        # Where vx is zero throughout, w_M is w_N to the last bit. Zero rates at the node are not enough: a base that
        # begins to move, or a slope, turns the block by its third and higher derivatives.
        level = ~self.c[:, 4].any(axis=0)
        self.c[:, 7, level] = self.c[:, 6, level]
        self.c[0, 8:10] += self.flow.stretched[:, None]
        for corner in (0, 1):
            if self.states[corner, 0] == STICKS:
                self.c[0, 10 + corner] += self.references[corner]
        for row, (place, speed) in enumerate(((0, 2), (1, 3))):
            self.c[0, row] += self.base[place]
            self.c[1, row] += self.base[speed] * self.scale
        J = np.abs(self.flow.jacobian(self.scale))[:6] + np.eye(14)[:6]
        self.radius = J @ stacked.radius[:, nodes]

    def values(self, s: Array) -> tuple[Array, Array, Array]:
        """Unknowns, gaps, stretches s - r and slides, their rates, and radii of the displacements."""
        z = s / self.scale
        value, rate, size = self.c[-1].copy(), np.zeros_like(self.c[0]), np.abs(self.c[-1, :6])
        for k in range(FLOAT_TERMS - 2, -1, -1):
            rate = rate * z + value
            value = value * z + self.c[k]
            size = size * z + np.abs(self.c[k, :6])
        u, v, ux, uy, vx, vy = self.radius + ROUNDING * size
        return value, rate / self.scale, np.array([u, v, (vx + uy) / 2, ux, vy, uy + vx])

    def contacts(self, values: Array) -> Array:
        """States, movements of the references, energies lost by opening, shape (5, nodes)."""
        slipping = np.abs(self.states) == RIGHT
        moved = slipping * (values[10:12] - values[8:10] - self.references)
        return np.vstack([self.states, self.slipped + moved, self.released])

    def spent(self, s: Array) -> Array:
        """Energy lost by friction and work of the base from the nodes on [J], shape (2, nodes)."""
        z, count = s / self.scale, 2 * FLOAT_TERMS
        total = np.zeros((2, count, len(z)))
        k = np.arange(1, FLOAT_TERMS)[:, None]
        p, ps = float(self.flow.model.p), float(self.flow.model.ps)
        for c in (0, 1):
            stretch, gap = self.c[:, 8 + c], self.c[:, 6 + c]
            if abs(self.flow.states[c]) == RIGHT:  # the integral of -T r', T = -p_s (s - r)
                moved = (self.c[:, 10 + c] - stretch)[1:] * k
                for i in range(FLOAT_TERMS):
                    total[0, i + 1 : i + FLOAT_TERMS] += ps * stretch[i] * moved
            if self.flow.states[c] != OPEN:  # the integral of N y' + T x'
                power = -p * gap * self.base[3] - ps * stretch * self.base[2]
                total[1, 1 : FLOAT_TERMS + 1] += power * self.scale
        result, power = np.zeros((2, len(z))), np.ones_like(z)
        for i in range(1, count):
            power = power * z
            result += total[:, i] * power / i
        return result


def solve(problem: BlockProblem, end: float, digits: int = DIGITS, limit: int = 100_000) -> BlockMotion:
    """The exact motion of a block from t = 0 to `end` [s].

    Parameters
    ----------
    problem
        The block, its corners and its loads.
    end
        Last instant [s].
    digits
        Decimal digits of the computation, at least 30; twice as many are taken, up to `MOST_DIGITS`, where the instants
        of the switches are not enclosed to `PROMISED`.
    limit
        Greatest number of switches.

    Raises
    ------
    ValueError
        If `end` is not positive and finite or `digits` is below 30.
    TooManySwitchesError
        If there are more switches than `limit`.
    TooMuchWorkError
        If the motion takes more steps than are allowed; the contact oscillates too fast for its length.
    LostDigitsError
        If switches amplify what the motion may be off until nothing can be decided.
    NoContactStateError
        If no state of the corners agrees with the motion that follows from it.
    """
    if not (np.isfinite(end) and end > 0):
        raise ValueError(f"end: must be positive and finite, got {end!r}")
    if digits < 30:
        raise ValueError(f"digits: must be at least 30, got {digits!r}")
    while True:
        try:
            with working(digits):
                march = March(BlockModel(problem), Course(problem.base), problem.gap, float(end), limit)
                march.run(problem.velocity)
        except LostDigitsError:
            if digits >= MOST_DIGITS:
                raise
        else:
            if max((switch.radius for switch in march.switches), default=0.0) <= PROMISED * end:
                break
            if digits >= MOST_DIGITS:
                raise LostDigitsError(_last_good(march), f"{len(march.switches)} switches have cost the digits")
        digits = min(2 * digits, max(digits, MOST_DIGITS))
    start = (march.closed_at_start[0], march.closed_at_start[1])
    touches, nodes = tuple(march.touches), tuple(march.nodes)
    return BlockMotion(problem, float(end), digits, start, tuple(march.switches), touches, nodes)


def _last_good(march: March) -> float:
    """The last switch that is enclosed as promised [s]."""
    good = [switch.time for switch in march.switches if switch.radius <= PROMISED * march.end]
    return good[-1] if good else 0.0
