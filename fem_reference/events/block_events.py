"""The block of one strain with no-tension corners and friction, exact in time: from switch to switch.

A corner is closed while it presses, N = -p w >= 0, and open while its gap w is positive; closed, it sticks, or slips
at |T| = tan(phi) N + C. How it gets from switch to switch, and what is proven of each, is told in `march`.

A corner at zero gap goes the way of the first derivative of its gap that is not zero: a block that touches
at rest when a pressure is switched on lifts off at once, since its base accelerates upwards. In the same way a corner
that closes slips at once where p_s |s'| > tan(phi) p |w'|, unless it has cohesion. What opens with a shear force T
releases the energy T^2 / (2 p_s) of its spring.

With dashpots, or with an impact law on rigid contact, the laws of `block_model` hold, and the same proof does: a
dashpot changes the matrices and what is watched, an impact the rates. Impacts that accumulate are named in `cascades`,
with the instant at which the contact comes to rest enclosed (`block_impacts`).
"""

from __future__ import annotations

import itertools
from dataclasses import dataclass, field
from functools import cached_property
from typing import NamedTuple

import numpy as np
from flint import arb, arb_poly
from numpy.typing import ArrayLike

from fem_reference.events.block_march import BlockMarch
from fem_reference.events.block_model import BlockModel, BlockProblem
from fem_reference.events.contacts import CARRIES_NOTHING, OPEN, RELEASED, RIGHT, STICKS, States, direction
from fem_reference.events.enclosure import bits_of, check_request, precision
from fem_reference.events.march import Node
from fem_reference.events.report import ROUNDING, Part, sampled
from fem_reference.events.series import column, floats
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
_OUTPUTS = np.linalg.inv(_UNKNOWNS)
REPORT_DIGITS = 40
"""Decimal digits in which the motion is evaluated where it is reported."""


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
    model: BlockModel = field(repr=False, compare=False)
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
        problem = self.problem
        model = self.model
        contact = model.contacts[0]  # both have the same numbers
        report = sampled(model, self.nodes, t, min(self.digits, REPORT_DIGITS), self._reported)
        node = report.node
        x = report.series[0, :6]
        rate = report.series[1, :6]
        gap, slide = np.split(report.rows[0, :4], 2)
        gap_velocity = report.rows[1, :2]
        states = np.where(report.states == RELEASED, OPEN, report.states)
        closed = states != OPEN
        p = float(contact.stiffness)
        N = -p * gap - float(contact.damping) * gap_velocity
        if problem.rigid_contact:
            N = np.tile(report.rows[0, 4] / 2, (2, 1))
        N = np.where(closed, N, 0.0)
        pressed = gap
        if not problem.locked:
            N = np.maximum(0.0, N)
            pressed = np.minimum(0.0, gap)
        # the spring of one that slips keeps the friction, and its reference moves by the rest
        sign = np.sign(states) * (np.abs(states) == RIGHT)
        limit = (float(contact.cohesion or 0) - float(contact.friction * contact.stiffness) * gap) * sign
        ps = problem.shear_stiffness
        stretch = np.where(
            states == STICKS, report.held, np.divide(limit, ps, out=np.zeros_like(limit), where=sign != 0)
        )
        slips = np.where(sign == 0, 0.0, report.held - stretch)
        T = 0.0 - ps * stretch
        ledgers = np.array(self._ledgers)[node].T
        mass = np.array([float(m) for m in model.masses])
        load = floats(model.load)[:, 0]
        work = ledgers[4].copy()
        for i in np.unique(node).tolist():
            here = np.flatnonzero(node == i)
            begun = self.nodes[i]
            for axis, speed in enumerate(self._base_velocity(begun)):
                gained = mass[0] * (rate[axis, here] - float(begun.start.v[axis, 0] + speed))
                work[here] += float(speed) * (gained - load[axis] * report.passed[here])
        dissipated = ledgers[3] + report.series[0, 6]
        nothing = np.zeros_like(t)
        has_friction = problem.friction is not None
        strains = x[3:6]
        elastic = floats(model.stiffness)[np.ix_([2, 5, 3], [2, 5, 3])]
        return BlockHistory(
            time=t,
            displacement=x,
            velocity=rate,
            gap=gap,
            gap_velocity=gap_velocity,
            normal_force=N,
            shear_force=T,
            slide=slide,
            slipped=ledgers[:2] + slips,
            states=states.astype(float),
            closed=closed.astype(float),
            contact_pressure=N.sum(axis=0) / problem.width,
            kinetic=mass @ (_UNKNOWNS @ rate) ** 2 / 2,
            strain=(strains * (elastic @ strains)).sum(axis=0) / 2,
            springs=(p * pressed**2 - T * stretch).sum(axis=0) / 2,
            load=-load @ (_UNKNOWNS @ x) - work,
            released=ledgers[2],
            friction=dissipated if has_friction else nothing,
            damped=nothing if has_friction else dissipated,
            displacement_radius=np.abs(_OUTPUTS) @ report.radius + ROUNDING * np.abs(x),
        )

    def _reported(self, part: Part) -> list[arb_poly]:
        """Series of (u, v, r, ex, ey, gxy), and of the energy lost in a step by friction and in dashpots."""
        node = part.node
        model = self.model
        u, v, ux, uy, vx, vy = part.segment.unknowns()
        span = arb(part.segment.length)
        along, upwards = (arb_poly(piece.series(part.start.time, part.segment.length, 2)) for piece in node.drives)
        lost = arb_poly([])
        if self._dissipates(node.states):
            lost += model.energy(node.states, node.start) - model.energy(node.states, part.start)
        for c, (contact, state) in enumerate(zip(model.contacts, node.states, strict=True)):
            gap = part.rows[c]
            if state == RELEASED:
                lost += (gap(arb(0)) ** 2 - gap * gap) * (contact.stiffness / 2)
            if state in CARRIES_NOTHING:
                continue
            rate = gap.derivative() * (1 / span)
            lost += (rate * rate).integral() * (contact.damping * span)
            if direction(state):
                stretch = model.stretch(c, state, part.rows, node.start.references[c])
                slip_rate = contact.reference(state, part.rows).derivative()
                lost += (stretch * slip_rate).integral() * contact.shear_stiffness
        upwards -= arb(self.problem.gap)
        return [u + along, v + upwards, (vx - uy) * (arb(1) / 2), ux, vy, uy + vx, lost]

    @staticmethod
    def _base_velocity(node: Node) -> list[arb]:
        """Rates of the base along itself and upwards."""
        return [piece.series(node.start.time, 1.0, 2)[1] for piece in node.drives]

    @cached_property
    def _ledgers(self) -> list[Ledger]:
        """What has slipped and been lost until each node."""
        model = self.model
        ledgers = [Ledger(0.0, 0.0, 0.0, 0.0, 0.0)]
        slipped = [arb(0), arb(0)]
        released = dissipated = work = arb(0)
        with precision(bits_of(min(self.digits, REPORT_DIGITS))):
            for node, following in itertools.pairwise(self.nodes):
                # its end as seen from the base of this step, whose velocity jumps between two rows of its record
                base = self._base_velocity(node)
                jump = [later - speed for later, speed in zip(self._base_velocity(following), base, strict=True)]
                v = following.start.v + column([*jump, *[arb(0)] * 4])
                end = following.start._replace(v=v, references=node.start.references)
                span = end.time - node.start.time
                gained = [model.masses[0] * (v[i, 0] - node.start.v[i, 0]) - model.load[i, 0] * span for i in (0, 1)]
                work += base[0] * gained[0] + base[1] * gained[1]
                if self._dissipates(node.states):
                    dissipated += model.energy(node.states, node.start) - model.energy(node.states, end)
                rows = model.values(end.u)
                for c, (contact, state) in enumerate(zip(model.contacts, node.states, strict=True)):
                    if direction(state):
                        slipped[c] += contact.reference(state, rows) - node.start.references[c]
                    if state not in CARRIES_NOTHING and following.states[c] in CARRIES_NOTHING:
                        stretch = model.stretch(c, state, rows, end.references[c])
                        released += contact.shear_stiffness * stretch * stretch / 2
                ledgers.append(Ledger(*map(float, (*slipped, released, dissipated, work))))
        return ledgers

    def _dissipates(self, states: States) -> bool:
        """Whether energy is lost in a step or at its end."""
        restitution = self.problem.restitution
        if restitution is not None:
            return restitution < 1 and states[0] == OPEN
        if self.problem.damping:
            return any(state != OPEN for state in states)
        return any(direction(state) for state in states)


class Ledger(NamedTuple):
    """What has slipped and been lost until a node."""

    slipped_m: float  # movement of the reference of M by slipping [m]
    slipped_n: float  # of that of N
    released: float  # energy of the shear springs lost by opening [J]
    dissipated: float  # energy lost by friction, in dashpots or by impacts [J]
    work: float  # work of the base [J]


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
            march = BlockMarch(problem, float(end), limit)
            march.run()
        first = march.nodes[0].states
        return BlockMotion(
            problem,
            float(end),
            digits,
            (first[0] != OPEN, first[1] != OPEN),
            tuple(march.switches),
            tuple(march.touches),
            tuple(march.nodes),
            march.block,
            tuple(march.impacts),
            tuple(march.cascades),
        )

    return with_enough_digits(motion_in, float(end), digits, MOST_DIGITS, PROMISED)
