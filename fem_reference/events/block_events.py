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

With dashpots, or with an impact law on rigid contact, the laws of `block_model` hold, and the same proof does: a
dashpot changes G and what is watched, an impact maps the state. Impacts that accumulate are named in `cascades`, with
the instant at which the contact comes to rest enclosed (`block_impacts`).
"""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np
from flint import arb, arb_mat
from numpy.typing import ArrayLike

from fem_reference.events.block_flow import to_floats
from fem_reference.events.block_march import March, Node
from fem_reference.events.block_model import OPEN, RELEASED, RIGHT, BlockModel, BlockProblem, Course
from fem_reference.events.block_switching import Flows
from fem_reference.events.enclosure import bits_of, check_request, precision, radius_of
from fem_reference.events.switches import Cascade, Impact, ProvenMotion, Switch, with_enough_digits
from fem_reference.problem.instants import instants
from fem_reference.problem.problem import Array

DIGITS = 50
"""Decimal digits of the first computation."""
MOST_DIGITS = 240
"""Decimal digits of the last one, where switches cost those of the ones before."""
PROMISED = 1e-20
"""Part of the end of the motion to which the instant of each switch is enclosed; more digits are taken for it."""
_UNKNOWNS = np.zeros((6, 6))
"""From (u, v, r, ex, ey, gxy) to (u, v, ux, uy, vx, vy)."""
_UNKNOWNS[range(6), [0, 1, 3, 5, 5, 4]] = [1, 1, 1, 0.5, 0.5, 1]
_UNKNOWNS[[3, 4], 2] = -1, 1
REPORT_DIGITS = 40
"""Decimal digits in which the motion is evaluated where it is reported."""
ROUNDING = 4 * np.finfo(float).eps
"""Part of a displacement by which floats round it."""


@dataclass(frozen=True)
class BlockHistory:
    """The motion at given instants; forces act on the block."""

    time: Array  # instants [s], shape (times,)
    displacement: Array  # (u, v, r, ex, ey, gxy) of the centroid [m, rad, -], shape (6, times)
    velocity: Array  # their rates [m/s, 1/s], shape (6, times)
    gap: Array  # gap w at M and N [m], negative when pressed, shape (2, times)
    gap_velocity: Array  # rate of the gap, which is the normal velocity of the base corner [m/s], shape (2, times)
    normal_force: Array  # N at M and N [N], upwards, without impulses, shape (2, times)
    shear_force: Array  # T of the closed corners [N], towards +x, shape (2, times)
    slide: Array  # slide s at M and N over the base [m], shape (2, times)
    slipped: Array  # movement of the shear reference r by slipping until then, at M and N [m], shape (2, times)
    states: Array  # 0 open or released, 1 sticks, 2 slips towards +x, -2 slips towards -x, at M and N, shape (2, times)
    closed: Array  # 1 where a corner is closed, else 0, shape (2, times)
    contact_pressure: Array  # (N_M + N_N) / a [Pa], shape (times,)
    kinetic: Array  # kinetic energy [J], shape (times,)
    strain: Array  # strain energy [J], shape (times,)
    springs: Array  # energy of the normal and shear springs, of released ones too [J], shape (times,)
    load: Array  # potential energy of pressure, traction and weight, -F x, less the base's work [J], shape (times,)
    released: Array  # energy of the shear springs lost by opening until then [J], shape (times,)
    friction: Array  # energy lost by friction until then [J], shape (times,)
    damped: Array  # energy lost in dashpots and by impacts until then [J], shape (times,)
    displacement_radius: Array  # greatest distance of each displacement from the true one, shape (6, times)

    @property
    def energy(self) -> Array:
        """Sum of all energies, which the motion conserves [J]."""
        return self.kinetic + self.strain + self.springs + self.load + self.released + self.friction + self.damped


@dataclass(frozen=True)
class BlockMotion(ProvenMotion):
    """Exact motion of a block from t = 0 to `end`."""

    problem: BlockProblem
    end: float  # last instant [s]
    digits: int  # decimal digits of the computation
    closed_at_start: tuple[bool, bool]  # whether M and N are closed just after t = 0
    switches: tuple[Switch, ...]  # changes of the corners in the order of time; together: M, then N
    touches: tuple[float, ...]  # instants at which a switch was neither proven nor excluded, and none was taken [s]
    nodes: tuple[Node, ...]  # beginnings of the steps in the order of time
    flows: Flows = field(repr=False, compare=False)  # of the states of the corners
    impacts: tuple[Impact, ...] = ()  # impacts on a rigid contact in the order of time, but for those of cascades
    cascades: tuple[Cascade, ...] = ()  # infinitely many impacts that end in rest, in the order of time

    def at(self, times: ArrayLike) -> BlockHistory:
        """The motion at instants in any order.

        Raises
        ------
        ValueError
            If an instant is not from 0 to `end`.
        """
        t = instants(times, self.end)
        order = np.argsort(t, kind="stable")
        begun = np.searchsorted([float(node.start) for node in self.nodes], t, side="right") - 1
        reports = np.empty((41, len(t)))
        with precision(bits_of(min(self.digits, REPORT_DIGITS))):
            last = -1
            for i in order.tolist():
                if begun[i] != last:
                    last = begun[i]
                    node = self.nodes[last]
                    time = node.start
                    z = node.z
                flow = self.flows[node.states]
                instant = arb(float(t[i]))
                time, z = instant, flow.advance(z, instant - time)
                reports[:, i] = self._report(node, time, z)
        x, rate, _, N, radius, slipped, losses, states = np.split(reports, [12, 24, 26, 28, 34, 36, 39])
        released, dissipated, work = losses
        slips = self.problem.friction is not None
        p = 0.0 if self.problem.rigid_contact else self.problem.stiffness
        ps = self.problem.shear_stiffness
        closed = np.asarray(states != OPEN, dtype=float)
        if not self.problem.locked:
            N = np.maximum(0.0, N)
        pressed = x[6:8] if self.problem.locked else np.minimum(0.0, x[6:8])
        T = 0.0 - ps * x[8:10]
        model = self.flows.model
        mass, load = (to_floats(arb_mat([part]))[0] for part in (model.mass, model.load))
        strains = x[3:6]
        elastic = to_floats(arb_mat(model.elastic))[np.ix_([2, 5, 3], [2, 5, 3])]
        return BlockHistory(
            time=t,
            displacement=x[:6],
            velocity=rate[:6],
            gap=x[6:8],
            gap_velocity=rate[6:8],
            normal_force=N,
            shear_force=T,
            slide=x[10:12],
            slipped=slipped,
            states=states,
            closed=closed,
            contact_pressure=N.sum(axis=0) / self.problem.width,
            kinetic=mass @ (_UNKNOWNS @ rate[:6]) ** 2 / 2,
            strain=(strains * (elastic @ strains)).sum(axis=0) / 2,
            springs=(p * pressed**2 - T * x[8:10]).sum(axis=0) / 2,
            load=-load @ (_UNKNOWNS @ x[:6]) - work,
            released=released,
            friction=dissipated if slips else np.zeros_like(t),
            damped=np.zeros_like(t) if slips else dissipated,
            displacement_radius=radius,
        )

    def _report(self, node: Node, time: arb, z: arb_mat) -> list[float]:
        """What is reported at an instant that follows a node.

        `Flow.outputs`, radii of the displacements, slips, energies released, lost by friction and gained from the base,
        and the states.
        """
        flow = self.flows[node.states]
        base = node.base
        passed = time - node.start
        after = time - node.row_time
        outputs = (flow.outputs * z).entries()
        for i, (place, rate) in enumerate(((base.x, base.vx), (base.y - self.problem.gap, base.vy))):
            outputs[i] += place + rate * after
            outputs[12 + i] += rate
        radius = flow.growth(node.radius, flow.rate * float(passed))
        radius += [radius_of(value) + ROUNDING * abs(float(value)) for value in outputs[:6]]
        slipped = list(node.slipped)
        for c in (0, 1):
            if abs(node.states[c]) == RIGHT:
                slipped[c] += outputs[24 + c] - node.z[12 + c, 0]
        dissipated = node.dissipated
        if flow.dissipates:
            dissipated = dissipated + flow.energy(node.z) - flow.energy(z)
        states = [OPEN if state == RELEASED else state for state in node.states]
        work = node.work + flow.model.base_work(base, node.z, z, passed)
        numbers = [*map(float, outputs)], radius, [*map(float, (*slipped, node.released, dissipated, work))]
        return [*numbers[0], *numbers[1], *numbers[2], *states]


def solve(problem: BlockProblem, end: float, digits: int = DIGITS, limit: int = 100_000) -> BlockMotion:
    """The exact motion of a block from t = 0 to `end` [s].

    Parameters
    ----------
    problem
        The block, its corners and its loads.
    end
        Last instant [s].
    digits
        Decimal digits of the computation, at least 30; more are taken, up to `MOST_DIGITS`, where the instants of
        the switches are not enclosed to `PROMISED`.
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
    AccumulationError
        If impacts follow each other ever faster, and that they accumulate is not proven.
    NoContactStateError
        If no state of the corners agrees with the motion that follows from it.
    """
    check_request(end, digits)

    def motion_in(digits: int) -> BlockMotion:
        with precision(bits_of(digits)):
            march = March(BlockModel(problem), Course(problem.base), problem.gap, float(end), limit)
            march.run(problem.velocity)
        start = march.closed_at_start[0], march.closed_at_start[1]
        switches = tuple(march.switches)
        touches = tuple(march.touches)
        nodes = tuple(march.nodes)
        impacts = tuple(march.impacts)
        cascades = tuple(march.cascades)
        return BlockMotion(problem, float(end), digits, start, switches, touches, nodes, march.flows, impacts, cascades)

    return with_enough_digits(motion_in, float(end), digits, MOST_DIGITS, PROMISED)
