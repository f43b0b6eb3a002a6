"""The column of blocks of one strain, or rigid, whose contacts open or slip, exact in time: from switch to switch.

How it gets from switch to switch, and what is proven of each, is told in `march`.

By its settling joint j of a stack that touches at rest when its weight is switched on closes in the derivative 2 j + 2.
Joints whose gap is zero in all derivatives, as those of blocks in common flight, carry no force; they are in `resting`.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, field
from functools import cached_property
from typing import Any

import numpy as np
from flint import arb, arb_mat
from numpy.typing import ArrayLike

from fem_reference.events.column_drive import ANGLE
from fem_reference.events.column_model import ColumnModel, ColumnProblem
from fem_reference.events.contacts import OPEN, STICKS, States, direction
from fem_reference.events.enclosure import ZERO, bits_of, precision, term_count
from fem_reference.events.march import March
from fem_reference.events.report import ROUNDING, Instant, ProvenMotion, with_enough_digits
from fem_reference.events.series import Start
from fem_reference.events.switches import Work
from fem_reference.problem.problem import Array

DIGITS = 60  # decimal digits of the first computation
REPORT_DIGITS = 28  # decimal digits in which the series are summed where the motion is reported


@dataclass(frozen=True)
class ColumnHistory:
    """The motion at given instants; arrays over blocks or joints from the base upwards, and over the instants."""

    time: Array  # [s], shape (times,)
    foot: Array  # displacement of the foot of each block [m], shape (blocks, times)
    top: Array  # of its top [m]
    foot_velocity: Array  # [m/s]
    top_velocity: Array  # [m/s]
    force: Array  # N, or T on the block above, of each joint, 0 where there is none [Pa], shape (blocks, times)
    stretch: Array  # y of each joint, positive where it is open [m]; 0 where there is none
    slip: Array  # r of each joint [m]
    states: Array  # of each joint: 0 open, 1 closed or sticks, 2 and -2 slips towards + and -
    face_force: Array  # force of what is below each block on it, then that on the top [Pa], shape (blocks + 1, times)
    kinetic: Array  # energy [J/m2], shape (times,)
    strain: Array  # energy of the blocks [J/m2]
    springs: Array  # energy of the joints [J/m2]
    potential: Array  # energy of the weight [J/m2]
    friction: Array  # energy lost until then [J/m2]
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
    states_at_start: tuple[int, ...]  # of the joints with a spring just after t = 0
    resting: tuple[int, ...]  # joints that were at zero gap without force for a while
    model: ColumnModel = field(repr=False, compare=False)

    def at(self, times: ArrayLike) -> ColumnHistory:
        """The motion at instants from 0 to the end, in any order."""
        problem = self.problem
        motion = self.columns(self.model, times, REPORT_DIGITS)
        u = motion["displacement"]
        v = motion["velocity"]
        a = motion["acceleration"]
        force = motion["force"]
        feet, tops = np.transpose(self.model.faces)
        mass = np.array([block.density * block.height for block in problem.blocks])
        moduli = [block.modulus / block.height if math.isfinite(block.modulus) else 0.0 for block in problem.blocks]
        stiffness = [float(contact.stiffness + contact.shear_stiffness) for contact in self.model.contacts]
        cohesion = [float(contact.cohesion or 0) for contact in self.model.contacts]
        numbers = [contact.number for contact in self.model.contacts]
        squares = v[feet] ** 2 + v[feet] * v[tops] + v[tops] ** 2
        inertia = mass[:, None] * ((a[feet] + a[tops]) / 2 + problem.gravity)
        # the force on the foot of each block, by the law of its joint or else by the momentum of what is above it
        faces = np.vstack([force, motion["pressure"]])
        for i in range(len(problem.blocks) - 1, -1, -1):
            if problem.joints[i] is None:
                faces[i] = faces[i + 1] + inertia[i]
        if problem.base == "free":
            faces[0] = 0.0
        elif problem.base == "transmitting":
            faces[0] = problem.impedance * (2 * v[-1] - v[0])
        return ColumnHistory(
            time=motion["time"],
            foot=u[feet],
            top=u[tops],
            foot_velocity=v[feet],
            top_velocity=v[tops],
            force=force,
            stretch=motion["stretch"],
            slip=motion["slip"],
            states=motion["states"],
            face_force=faces,
            kinetic=mass @ squares / 6,
            strain=moduli @ (u[tops] - u[feet]) ** 2 / 2,
            springs=(force[numbers] ** 2 / (2 * np.array(stiffness)[:, None])).sum(axis=0),
            potential=problem.gravity * mass @ (u[feet] + u[tops]) / 2,
            friction=cohesion @ motion["way"],
            displacement_radius=motion["radius"] + ROUNDING * np.abs(u[:-1]).max(axis=0),
        )

    @cached_property
    def _ways(self) -> list[list[float]]:
        """Lengths of the ways that the references have gone until each node [m], shape (nodes, contacts)."""
        slips = np.array([[float(r) for r in node.start.references] for node in self.nodes])
        ways: list[list[float]] = np.cumsum(np.abs(np.diff(slips, axis=0, prepend=slips[:1])), axis=0).tolist()
        return ways

    def _at(self, instant: Instant) -> dict[str, Any]:
        """What `at` reads of an instant; the last of the faces is where `BASE` points to."""
        model = self.model
        start = instant.start
        states = instant.node.states
        base, pressure = (piece.series(start.time, 1.0, 3) for piece in instant.node.pieces)
        accelerations = model.accelerations(states, start, instant.node.pieces)
        forces = [0.0] * len(self.problem.blocks)
        stretches = [*forces]
        slips = [*forces]
        states_of_joints = [0] * len(forces)
        ways = []
        for c, (contact, state, reference) in enumerate(zip(model.contacts, states, start.references, strict=True)):
            slip = contact.reference(state, instant.rows) if direction(state) else reference
            force = float(instant.forces[c])
            if model.unilateral:
                force = max(force, 0.0)
            forces[contact.number] = force
            stretches[contact.number] = float(instant.rows[c])
            slips[contact.number] = float(slip)
            states_of_joints[contact.number] = state
            ways.append(self._ways[instant.number][c] + abs(float(slip - reference)))
        return {
            "displacement": [*map(float, start.u.entries()), float(base[0])],
            "velocity": [*map(float, start.v.entries()), float(base[1])],
            "acceleration": [*map(float, accelerations.entries()[::2]), 2 * float(base[2])],
            "force": forces,
            "stretch": stretches,
            "slip": slips,
            "states": states_of_joints,
            "way": ways,
            "pressure": float(pressure[0]),
            "radius": instant.radius.max(),
        }


class ColumnMarch(March):
    """The motion of a column from switch to switch."""

    def __init__(self, problem: ColumnProblem, end: float, limit: int, work: Work) -> None:
        self.column = ColumnModel(problem)
        super().__init__(self.column, end, limit, work)
        self.courses = problem.base_motion(), problem.pressure()

    def initial(self) -> tuple[Start, States]:
        """Where the column begins; its joints count as open as long as they carry nothing."""
        column = self.column
        base, rate = self.pieces[0].series(ZERO, 1.0, 2)
        count = len(column.contacts)
        start = Start(ZERO, column.displacements(base), column.velocities(rate), [ZERO] * count)
        return start, (OPEN if column.unilateral else STICKS,) * count

    def jump(self, rates: Sequence[arb]) -> arb_mat:
        """What a base that the lowest block is welded to passes on of a jump."""
        impulse = arb_mat(self.column.size, 1)
        impulse[0, 0] = self.column.base_coupling * rates[0]
        return self.column.mobility * impulse


def least_terms(problem: ColumnProblem, end: float) -> tuple[float, float]:
    """How many terms of series a motion takes with its contacts open throughout, and closed throughout.

    Those of switches, and of computations in more digits, come on top.
    """
    with precision(bits_of(DIGITS)):
        model = ColumnModel(problem)
        rate = model.rate((STICKS,) * len(model.contacts))
        open_rate = model.rate((OPEN,) * len(model.contacts))
        terms = term_count(1.0) * model.size
    return end * open_rate / ANGLE * terms, end * rate / ANGLE * terms


def solve(
    problem: ColumnProblem, end: float, digits: int = DIGITS, limit: int = 100_000, work: Work | None = None
) -> ColumnMotion:
    """The exact motion of a column from t = 0 to `end` [s]; `work` bounds terms of series.

    All else is as in `block_events.solve`, but for the `AccumulationError` of impacts.
    """
    counted = work or Work()

    def motion_in(digits: int) -> ColumnMotion:
        march = ColumnMarch(problem, float(end), limit, counted)
        march.run()
        return ColumnMotion(
            march.end,
            digits,
            tuple(march.switches),
            tuple(march.touches),
            tuple(march.nodes),
            problem,
            march.nodes[0].states,
            tuple(sorted(march.column.contacts[c].number for c in march.resting)),
            march.column,
        )

    return with_enough_digits(motion_in, float(end), digits)
