"""The column of blocks of one strain, or rigid, whose contacts open or slip, exact in time: from switch to switch.

Between switches the column is linear, and its Taylor series is summed in ball arithmetic (`column_flow`). The next
switch is the first instant at which a gap or a normal force falls through zero, the shear force of a joint that sticks
reaches its strength, or the rate of one that slips comes to zero. That it is the first is proven: up to it Bernstein's
form of each of these functions, or Taylor's formula with a bound on the third derivative, is positive; and the interval
Newton operator proves that one root lies in the ball of its instant. What switches in one ball switches together. Where
a function comes so near to zero that a crossing is neither proven nor excluded, its instant is in `touches`.

A joint at zero gap, or a shear force at its strength, goes the way of the first derivative that is not zero: in a
stack that touches at rest when its weight is switched on, joint j closes in the derivative 2 j + 2. Joints whose gap
is zero in all derivatives, as those of blocks in common flight, carry no force; they are in `resting`.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, field

import numpy as np
from flint import arb, arb_poly
from numpy.typing import ArrayLike

from fem_reference.events.block_flow import term_count
from fem_reference.events.column_drive import ANGLE
from fem_reference.events.column_flow import OPEN, SLIPS, expand, rate_of, step_length
from fem_reference.events.column_march import JointSwitch, March, Node
from fem_reference.events.column_model import ColumnModel, ColumnProblem
from fem_reference.events.enclosure import bits_of, check_request, precision
from fem_reference.events.switches import ProvenMotion, Work, with_enough_digits
from fem_reference.problem.instants import instants
from fem_reference.problem.problem import Array

DIGITS = 60
"""Decimal digits of the first computation."""
MOST_DIGITS = 960
"""Decimal digits of the last one, where switches cost those of the ones before."""
PROMISED = 1e-20
"""Part of the end of the motion to which the instant of each switch is enclosed; more digits are taken for it."""
REPORT_DIGITS = 28
"""Decimal digits in which the series are summed where the motion is reported."""
REPORT_ANGLE = 1.5
"""Angle over which floats sum a series [rad]."""
REPORT_TERMS = 32
"""Terms that they sum: 1.5^32 / 32! is 2e-30."""
ROUNDING = 4 * np.finfo(float).eps
"""Part of a displacement by which floats round it."""


@dataclass(frozen=True)
class ColumnHistory:
    """The motion at given instants; arrays over blocks or joints from the base upwards, and over the instants."""

    time: Array  # instants [s], shape (times,)
    foot: Array  # displacement of the foot of each block [m], shape (blocks, times)
    top: Array  # of its top [m]
    foot_velocity: Array  # [m/s]
    top_velocity: Array  # [m/s]
    force: Array  # N, or T on the block above, of each joint, 0 where there is none [Pa], shape (blocks, times)
    stretch: Array  # y of each joint, positive where it is open [m]; 0 where there is none
    slip: Array  # r of each joint [m]
    states: Array  # of each joint: 0 open, 1 closed or sticks, 2 and -2 slips towards + and -
    face_force: Array  # force of what is below each block on it, then that on the top [Pa], shape (blocks + 1, times)
    kinetic: Array  # kinetic energy [J/m2], shape (times,)
    strain: Array  # strain energy of the blocks [J/m2]
    springs: Array  # energy of the joints [J/m2]
    potential: Array  # potential energy of the weight [J/m2]
    friction: Array  # energy lost by friction until then [J/m2]
    displacement_radius: Array  # greatest distance of a displacement from the true one [m], shape (times,)

    @property
    def displacement(self) -> Array:
        """Mean of the faces of each block [m]."""
        return (self.foot + self.top) / 2

    @property
    def velocity(self) -> Array:
        """Mean of the rates of the faces of each block [m/s]."""
        return (self.foot_velocity + self.top_velocity) / 2

    @property
    def base_force(self) -> Array:
        """Force of the base on the column [Pa]; in shear minus the shear stress."""
        return np.asarray(self.face_force[0])

    @property
    def gap(self) -> Array:
        """Open gap of each joint [m]."""
        return np.maximum(self.stretch, 0.0)

    @property
    def energy(self) -> Array:
        """Sum of all energies, which a column conserves that nothing drives and no half-space damps [J/m2]."""
        return self.kinetic + self.strain + self.springs + self.potential + self.friction


@dataclass(frozen=True)
class ColumnMotion(ProvenMotion):
    """Exact motion of a column from t = 0 to `end`."""

    problem: ColumnProblem
    end: float  # last instant [s]
    digits: int  # decimal digits of the computation
    states_at_start: tuple[int, ...]  # of the joints with a spring just after t = 0
    switches: tuple[JointSwitch, ...]  # changes of the joints in the order of time; together: from the base upwards
    touches: tuple[float, ...]  # instants at which a switch was neither proven nor excluded, and none was taken [s]
    resting: tuple[int, ...]  # joints that were at zero gap without force for a while
    nodes: tuple[Node, ...] = field(repr=False)  # beginnings of the steps in the order of time
    model: ColumnModel = field(repr=False, compare=False)

    def at(self, times: ArrayLike) -> ColumnHistory:
        """The motion at instants in any order.

        Raises
        ------
        ValueError
            If an instant is not from 0 to `end`.
        """
        t = instants(times, self.end)
        begun = np.searchsorted([float(node.start.time) for node in self.nodes], t, side="right") - 1
        model = self.model
        u = np.empty((model.size, len(t)))
        v = np.empty((model.size, len(t)))
        a = np.empty((model.size, len(t)))
        base = np.empty((3, len(t)))
        pressure = np.empty(len(t))
        contacts = len(model.contacts)
        stretch = np.empty((contacts, len(t)))
        reference = np.zeros((contacts, len(t)))
        travel = np.zeros((contacts, len(t)))
        states = np.zeros((contacts, len(t)), dtype=int)
        radius = np.empty(len(t))
        reach = float(model.bounds.displacement_reach().max(initial=0.0))
        with precision(bits_of(min(self.digits, REPORT_DIGITS))):
            for index in np.unique(begun).tolist():
                node = self.nodes[index]
                rows = np.flatnonzero(begun == index)
                last = float(arb(float(t[rows].max())) - node.start.time)
                longest = step_length(model, node.states, node.forces)
                length = min(longest, max(last, 1e-30) * (1 + 1e-9))
                segment = expand(model, node.states, node.start, node.forces, length)
                passed = np.array([float(arb(moment) - node.start.time) for moment in t[rows].tolist()]) / length
                series = [segment.polynomial(i) for i in range(model.size)]
                series += [arb_poly(part) for part in (segment.base, segment.pressure, *segment.stretches)]
                values, rates, bends = _evaluated(series, passed, length, ANGLE * length / longest)
                u[:, rows] = values[: model.size]
                v[:, rows] = rates[: model.size]
                a[:, rows] = bends[: model.size]
                base[:, rows] = [part[model.size] for part in (values, rates, bends)]
                pressure[rows] = values[model.size + 1]
                stretch[:, rows] = values[model.size + 2 :]
                for c, contact in enumerate(model.contacts):
                    state = node.states[c]
                    states[c, rows] = state
                    travel[c, rows] = float(node.travels[c])
                    if abs(state) == SLIPS:
                        ahead = float(contact.reach) if state > 0 else -float(contact.reach)
                        reference[c, rows] = stretch[c, rows] - ahead
                        begin = float(segment.stretches[c][0]) - ahead
                        travel[c, rows] += np.abs(reference[c, rows] - begin)
                    else:
                        reference[c, rows] = float(node.start.references[c])
                error = float(node.error.upper()) * np.exp(model.bounds.soft * length / 2)
                radius[rows] = error * reach + ROUNDING * np.abs(u[:, rows]).max(axis=0)
        motion = u, v, a
        return self._history(t, motion, base, pressure, (stretch, reference, travel), states, radius)

    def _history(
        self,
        t: Array,
        motion: tuple[Array, Array, Array],
        base: Array,
        pressure: Array,
        joints: tuple[Array, Array, Array],
        states: Array,
        radius: Array,
    ) -> ColumnHistory:
        """Put what the unknowns do into faces and joints."""
        model = self.model
        problem = self.problem
        stretch, reference, travel = joints
        shape = len(problem.blocks), len(t)
        # the last row is where `BASE` points to
        u, v, a = (np.vstack([part, of_base]) for part, of_base in zip(motion, base, strict=True))
        feet, tops = ([face[side] for face in model.faces] for side in (0, 1))
        foot = u[feet]
        top = u[tops]
        foot_velocity = v[feet]
        top_velocity = v[tops]
        force, y, slip, joint_states = (np.zeros(shape) for _ in range(4))
        springs = np.zeros(len(t))
        friction = np.zeros(len(t))
        for c, contact in enumerate(model.contacts):
            k = float(contact.stiffness)
            j = contact.joint
            y[j] = stretch[c]
            slip[j] = reference[c]
            joint_states[j] = states[c]
            force[j] = np.where(states[c] == OPEN, 0.0, -k * (stretch[c] - reference[c]))
            if model.unilateral:
                force[j] = np.maximum(force[j], 0.0)
            springs += force[j] ** 2 / (2 * k)
            if contact.strength is not None:
                slips = np.abs(states[c]) == SLIPS
                force[j] = np.where(slips, -np.sign(states[c]) * float(contact.strength), force[j])
                friction += float(contact.strength) * travel[c]
        mass = np.array([block.density * block.height for block in problem.blocks])[:, None]
        moduli = np.array([block.modulus / block.height for block in problem.blocks])[:, None]
        stretched = top - foot
        strain = np.where(np.isinf(moduli), 0.0, moduli) * stretched**2 / 2
        kinetic = mass / 6 * (foot_velocity**2 + foot_velocity * top_velocity + top_velocity**2)
        potential = mass * problem.gravity * (foot + top) / 2
        return ColumnHistory(
            time=t,
            foot=foot,
            top=top,
            foot_velocity=foot_velocity,
            top_velocity=top_velocity,
            force=force,
            stretch=y,
            slip=slip,
            states=joint_states,
            face_force=self._face_force(force, (a[feet] + a[tops]) / 2, pressure, 2 * base[1] - v[0]),
            kinetic=kinetic.sum(axis=0),
            strain=strain.sum(axis=0),
            springs=springs,
            potential=potential.sum(axis=0),
            friction=friction,
            displacement_radius=radius,
        )

    def _face_force(self, force: Array, acceleration: Array, pressure: Array, outflow: Array) -> Array:
        """Force on the foot of each block, by the law of its joint or else by the momentum of what is above it [Pa]."""
        problem = self.problem
        faces = np.empty((len(problem.blocks) + 1, len(pressure)))
        faces[-1] = pressure
        for i in range(len(problem.blocks) - 1, -1, -1):
            block = problem.blocks[i]
            if problem.joints[i] is not None:
                faces[i] = force[i]
            else:
                faces[i] = faces[i + 1] + block.density * block.height * (acceleration[i] + problem.gravity)
        if problem.base == "free":
            faces[0] = 0.0
        elif problem.base == "transmitting":
            faces[0] = problem.impedance * outflow
        return faces


def _evaluated(series: Sequence[arb_poly], shares: Array, length: float, angle: float) -> tuple[Array, Array, Array]:
    """Values, rates and second derivatives in time of series in the share of a step, shape (series, shares).

    Floats sum a series over a small angle without loss; over more than that its terms cancel. So the step is cut into
    parts, and balls move the series to the beginning of each.
    """
    results = np.empty((3, len(series), len(shares)))
    parts = max(1, math.ceil(angle / REPORT_ANGLE))
    numbers = np.clip(np.floor(shares * parts), 0, parts - 1).astype(int)
    for part in np.unique(numbers).tolist():
        rows = np.flatnonzero(numbers == part)
        moved = arb_poly([arb(part) / parts, arb(1) / parts])
        terms = [[float(c) for c in polynomial(moved).coeffs()[:REPORT_TERMS]] for polynomial in series]
        coefficients = np.zeros((len(series), max(3, *map(len, terms))))
        for row, line in zip(coefficients, terms, strict=True):
            row[: len(line)] = line
        powers = (shares[rows] * parts - part) ** np.arange(coefficients.shape[1])[:, None]
        for order in range(3):
            results[order][:, rows] = coefficients @ powers[: coefficients.shape[1]] * (parts / length) ** order
            coefficients = coefficients[:, 1:] * np.arange(1, coefficients.shape[1])
    return results[0], results[1], results[2]


def least_terms(problem: ColumnProblem, end: float) -> tuple[float, float]:
    """Return how many terms of series a motion takes with its contacts open throughout, and closed throughout.

    Those of switches, and of computations in more digits, come on top.
    """
    with precision(bits_of(DIGITS)):
        model = ColumnModel(problem)
        rate = model.bounds.rate
        open_rate = max(rate_of(model, [OPEN] * len(model.contacts)), model.bounds.soft)
        terms = term_count(1.0) * model.size
    return end * open_rate / ANGLE * terms, end * rate / ANGLE * terms


def solve(
    problem: ColumnProblem, end: float, digits: int = DIGITS, limit: int = 100_000, work: Work | None = None
) -> ColumnMotion:
    """The exact motion of a column from t = 0 to `end` [s].

    Parameters
    ----------
    problem
        The column and its drives.
    end
        Last instant [s].
    digits
        Decimal digits of the first computation, at least 30; more are taken, up to `MOST_DIGITS`, where the instants of
        the switches are not enclosed to `PROMISED`.
    limit
        Greatest number of switches.
    work
        Counts the terms of series, and bounds them; None: without a bound.

    Raises
    ------
    ValueError
        If `end` is not positive and finite or `digits` is below 30.
    TooManySwitchesError
        If there are more switches than `limit`.
    TooMuchWorkError
        If the motion takes more work than is allowed.
    LostDigitsError
        If switches amplify what the motion may be off until nothing can be decided.
    NoContactStateError
        If no state of the joints agrees with the motion that follows from it.
    """
    check_request(end, digits)
    work = Work() if work is None else work

    def motion_in(digits: int) -> ColumnMotion:
        with precision(bits_of(digits)):
            model = ColumnModel(problem)
            march = March(model, problem.base_motion(), problem.pressure(), float(end), limit, work)
            march.run()
        return ColumnMotion(
            problem,
            float(end),
            digits,
            march.states_at_start,
            tuple(march.switches),
            tuple(march.touches),
            tuple(sorted(march.resting)),
            tuple(march.nodes),
            model,
        )

    return with_enough_digits(motion_in, float(end), digits, MOST_DIGITS, PROMISED)
