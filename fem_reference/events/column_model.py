"""The column of blocks of one strain, or rigid, on contacts that open or slip: its data, and its matrices in balls.

Block i has a foot and a top face per unit of area, the consistent mass rho h / 6 [[2, 1], [1, 2]] and the stiffness
E / h [[1, -1], [-1, 1]]; a rigid one has one unknown. Joint j is at the foot of block j, joint 0 at the base. Faces
without a spring share an unknown. A joint has the displacement y = u_above - u_below + gap of its upper face over its
lower one, and acts on the upper face with

    unilateral:  N = k max(0, -y)                      frictional:  T = -k (y - r),  |T| <= s,

where the reference r moves as the joint slips.

All unknowns are numbered from the base upwards, so that the mass is tridiagonal.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from flint import arb, ctx

from fem_reference.events.column_drive import Drive, still
from fem_reference.events.enclosure import precision
from fem_reference.problem.checks import require
from fem_reference.problem.problem import Array

LAWS = ("bonded", "unilateral", "frictional")
BASES = ("rigid", "transmitting", "free")
BASE = -1  # in place of an unknown: the face moves as the base does
BOUND_BITS = 96  # of matrices that only bound
# Part of the highest rate that the metric of the error gives to an unknown without a spring: the error grows with it,
# and the less by each contact that closes the higher it is, while contacts that slip make no error grow.
SOFT_PART = {"unilateral": 1 / 8, "frictional": 1 / 256, "bonded": 1 / 256}


@dataclass(frozen=True)
class ColumnBlock:
    """A block of a column, per unit of area."""

    height: float  # h [m]
    density: float  # rho [kg/m3]
    modulus: float = math.inf  # of a plane wave [Pa]; inf: rigid
    velocity: float = 0.0  # at t = 0 [m/s], upwards, or towards + in shear


@dataclass(frozen=True)
class ColumnJoint:
    """A spring at the foot of a block, per unit of area."""

    stiffness: float  # k [Pa/m]
    gap: float = 0.0  # of a unilateral joint at t = 0 [m]
    strength: float | None = None  # greatest shear stress s of a frictional joint [Pa]; None: it never slips


@dataclass(frozen=True)
class ColumnProblem:
    """A column of blocks on a base.

    At t = 0 all blocks are unstrained and at zero displacement, or at rest under their weight. Welded faces, also one
    on the base, get one velocity at once, by impulses on them.

    Raises
    ------
    ValueError
        For a value out of its range, naming field, rule and value.
    """

    blocks: tuple[ColumnBlock, ...]  # from the base upwards
    joints: tuple[ColumnJoint | None, ...]  # at the foot of each block; None: faces move alike, or there is no base
    law: str = "unilateral"
    base: str = "rigid"  # with prescribed motion, ``"transmitting"``: a half-space, ``"free"``: nothing below
    impedance: float = 0.0  # z of the half-space [Pa s/m]
    gravity: float = 0.0  # weight of the blocks, half of each on its foot and half on its top [m/s2]
    at_rest: bool = False  # whether the blocks begin where they are in equilibrium under their weight
    base_motion: Drive = still  # displacement of the base, or of the wave that comes up [m]
    pressure: Drive = still  # on the top, towards - [Pa]

    def __post_init__(self) -> None:
        require(self.law in LAWS, "law", f"must be one of {LAWS}", self.law)
        require(self.base in BASES, "base", f"must be one of {BASES}", self.base)
        alike = 0 < len(self.blocks) == len(self.joints)
        require(alike, "joints", f"must be one for each of {len(self.blocks)} blocks", len(self.joints))
        for i, block in enumerate(self.blocks):
            for name in ("height", "density", "modulus"):
                value = getattr(block, name)
                finite = name == "modulus" or value < math.inf
                require(value > 0 and finite, f"blocks[{i}].{name}", "must be positive", value)
            require(math.isfinite(block.velocity), f"blocks[{i}].velocity", "must be finite", block.velocity)
        require(math.isfinite(self.gravity), "gravity", "must be finite", self.gravity)
        carried = self.base != "transmitting" or 0 < self.impedance < math.inf
        require(carried, "impedance", "must be positive", self.impedance)
        supported = self.base == "rigid"
        require(supported or not self.at_rest, "at_rest", f"must be False on a base that is {self.base}", True)
        footless = supported or self.joints[0] is None
        require(footless, "joints[0]", f"must be None on a base that is {self.base}", self.joints[0])
        for j, joint in enumerate(self.joints):
            if joint is not None:
                self._check_joint(f"joints[{j}]", joint)

    def _check_joint(self, name: str, joint: ColumnJoint) -> None:
        require(0 < joint.stiffness < math.inf, f"{name}.stiffness", "must be positive and finite", joint.stiffness)
        require(0 <= joint.gap < math.inf, f"{name}.gap", "must not be negative", joint.gap)
        opens = self.law == "unilateral"
        require(opens or not joint.gap, f"{name}.gap", f"must be 0 in a column that is {self.law}", joint.gap)
        strength = joint.strength
        if strength is not None:
            require(0 <= strength < math.inf, f"{name}.strength", "must not be negative", strength)
            slips = self.law == "frictional"
            require(slips, f"{name}.strength", f"must be None in a column that is {self.law}", strength)


@dataclass(frozen=True)
class Strut:
    """The stiffness and consistent mass of an elastic block between two neighbouring unknowns."""

    below: int  # unknown of the foot, or `BASE`
    above: int
    stiffness: arb  # E / h [Pa/m]
    mass: arb  # rho h [kg/m2]


@dataclass(frozen=True)
class Contact:
    """A joint with a spring."""

    joint: int
    above: int  # unknown of the upper face
    below: int  # unknown of the lower face, or `BASE`
    stiffness: arb  # k [Pa/m]
    gap: arb  # [m]
    strength: arb | None  # s [Pa]; None: it does not slip
    reach: arb  # s / k [m], 0 without strength


class ColumnModel:
    """A column in the precision of the current context."""

    def __init__(self, problem: ColumnProblem) -> None:
        self.problem = problem
        self.unilateral = problem.law == "unilateral"
        self.faces: list[tuple[int, int]] = []  # unknowns of foot and top of each block
        self.struts: list[Strut] = []
        self.contacts: list[Contact] = []
        self.rigid_masses: list[tuple[int, arb]] = []
        weights: dict[int, arb] = {}
        previous = BASE
        count = 0
        for j, (block, joint) in enumerate(zip(problem.blocks, problem.joints, strict=True)):
            foot = previous
            if joint is not None or (j == 0 and problem.base != "rigid"):
                foot = count
                count = count + 1
            top = foot
            mass = arb(block.density) * arb(block.height)
            if math.isfinite(block.modulus):
                top = count
                count = count + 1
                self.struts.append(Strut(foot, top, arb(block.modulus) / arb(block.height), mass))
            elif foot != BASE:
                self.rigid_masses.append((foot, mass))
            for face in (foot, top):
                weights[face] = weights.get(face, arb(0)) - mass * arb(problem.gravity) / 2
            if joint is not None:
                k = arb(joint.stiffness)
                s = None if joint.strength is None else arb(joint.strength)
                reach = arb(0) if s is None else s / k
                self.contacts.append(Contact(j, foot, previous, k, arb(joint.gap), s, reach))
            self.faces.append((foot, top))
            previous = top
        self.size = count
        self.top = previous
        if count == 0:
            raise ValueError("blocks: must have a face that moves of itself, got a column welded to its base")
        self.weights = [weights[i] for i in range(count)]
        self.impedance = arb(problem.impedance) if problem.base == "transmitting" else None
        self._factorise()

    def velocities(self, base: arb) -> list[arb]:
        """Velocity of each unknown just after t = 0, of the blocks' momentum and the velocity of the base."""
        blocks = self.problem.blocks
        by_face: dict[int, list[arb]] = {BASE: [base]}
        for (foot, top), block in zip(self.faces, blocks, strict=True):
            for face in {foot, top}:
                by_face.setdefault(face, []).append(arb(block.velocity))
        if all(speed == speeds[0] for speeds in by_face.values() for speed in speeds):
            return [by_face[i][0] for i in range(self.size)]
        momentum = [arb(0)] * self.size
        for (foot, top), block in zip(self.faces, blocks, strict=True):
            share = arb(block.density) * arb(block.height) * arb(block.velocity) / 2
            for face in (foot, top):
                if face != BASE:
                    momentum[face] = momentum[face] + share
        if self.base_coupling is not None:
            momentum[0] = momentum[0] - self.base_coupling * base
        return self.accelerations(momentum)

    def displacements(self, base: arb) -> list[arb]:
        """Displacement of each unknown at t = 0, where the base is."""
        u = [arb(0)] * self.size
        if not self.problem.at_rest:
            return u
        joints = {contact.joint: contact for contact in self.contacts}
        struts = {strut.above: strut for strut in self.struts}
        load = -sum(self.weights, arb(0))
        if self.struts and self.struts[0].below == BASE:
            load += self.struts[0].mass * arb(self.problem.gravity) / 2
        level = base
        for i, (foot, top) in enumerate(self.faces):
            if i in joints:
                level = level - load / joints[i].stiffness - joints[i].gap
            if foot != BASE:
                u[foot] = level
            block = self.problem.blocks[i]
            weight = arb(block.density) * arb(block.height) * arb(self.problem.gravity)
            if top != foot:
                level = level - (load - weight / 2) / struts[top].stiffness
                u[top] = level
            if foot != BASE or top != foot:
                load = load - weight
        return u

    def _factorise(self) -> None:
        """Mass M = L D L' of the unknowns."""
        zero = arb(0)
        self.diagonal = [zero] * self.size
        self.coupling: list[arb | None] = [None] * self.size  # of an unknown to the next one
        self.base_coupling: arb | None = None  # mass between the base and the first unknown
        for i, mass in self.rigid_masses:
            self.diagonal[i] = self.diagonal[i] + mass
        for strut in self.struts:
            self.diagonal[strut.above] += strut.mass / 3
            if strut.below == BASE:
                self.base_coupling = strut.mass / 6
            else:
                self.diagonal[strut.below] += strut.mass / 3
                self.coupling[strut.below] = strut.mass / 6
        self.inverse_pivots: list[arb] = []
        self.factors: list[arb | None] = []  # entry of L below each unknown
        carried = zero
        for i in range(self.size):
            inverse = 1 / (self.diagonal[i] - carried)
            self.inverse_pivots.append(inverse)
            coupling = self.coupling[i]
            factor = None if coupling is None else coupling * inverse
            self.factors.append(factor)
            carried = zero if factor is None or coupling is None else factor * coupling

    def accelerations(self, forces: list[arb]) -> list[arb]:
        """Solve M a = f; overwrites the forces."""
        factors = self.factors
        last = self.size - 1
        for i in range(last):
            factor = factors[i]
            if factor is not None:
                forces[i + 1] = forces[i + 1] - factor * forces[i]
        a = [force * inverse for force, inverse in zip(forces, self.inverse_pivots, strict=True)]
        for i in range(last - 1, -1, -1):
            factor = factors[i]
            if factor is not None:
                a[i] = a[i] - factor * a[i + 1]
        return a

    @cached_property
    def inverse_mass(self) -> Array:
        """Inverse of the mass, rounded to floats [m2/kg]."""
        columns = []
        for i in range(self.size):
            unit = [arb(int(i == j)) for j in range(self.size)]
            columns.append([float(x) for x in self.accelerations(unit)])
        return np.array(columns).T

    @cached_property
    def directions(self) -> Array:
        """Rows b of the contacts, y = b u + ..., shape (contacts, unknowns)."""
        rows = np.zeros((len(self.contacts), self.size))
        for row, contact in zip(rows, self.contacts, strict=True):
            row[contact.above] = 1.0
            if contact.below != BASE:
                row[contact.below] = -1.0
        return rows

    @cached_property
    def bounds(self) -> Bounds:
        """What bounds the motion and its error."""
        with precision(min(ctx.prec, BOUND_BITS)):
            return Bounds(self)


class Bounds:
    """Upper bounds in floats, rounded up by `MARGIN`, which covers the rounding of so short sums."""

    MARGIN = 1 + 1e-9

    def __init__(self, model: ColumnModel) -> None:
        W = np.abs(model.inverse_mass)
        elastic = np.zeros((model.size, model.size))
        for strut in model.struts:
            c = float(strut.stiffness)
            elastic[strut.above, strut.above] += c
            if strut.below != BASE:
                elastic[strut.below, strut.below] += c
                elastic[strut.below, strut.above] -= c
                elastic[strut.above, strut.below] -= c
        signed = model.inverse_mass
        k = np.array([float(contact.stiffness) for contact in model.contacts])
        B = model.directions
        self.stiffness = k
        # |M^-1 K| row by row, of the blocks and of each contact, so that they bound every choice of closed contacts
        self.elastic_rows = np.abs(signed @ elastic).sum(axis=1) * self.MARGIN
        self.contact_rows = (np.abs(signed @ B.T) * k * np.abs(B).sum(axis=1)).T * self.MARGIN
        self.damping = 0.0
        if model.impedance is not None:
            self.damping = float((W[:, 0] * float(model.impedance)).max()) * self.MARGIN
        self.compliance = np.einsum("ji,ik,jk->j", B, signed, B) * self.MARGIN  # b M^-1 b'
        self.mobility = np.diag(signed) * self.MARGIN  # diagonal of M^-1
        highest = self.squared_rate(np.ones(len(k), dtype=bool))
        self.rate = math.sqrt(highest) + self.damping  # of the motion and of its error, greatest [rad/s]
        # the metric e' M e' + e (K + soft^2 M) e gives each unknown a spring, also where its contacts are open
        self.soft = self.rate * SOFT_PART[model.problem.law] or 1.0
        K = np.abs(elastic) + np.abs(B.T) @ (k[:, None] * np.abs(B))
        mass = np.zeros(model.size)
        for i in range(model.size):
            mass[i] = float(model.diagonal[i]) + sum(
                float(c) for c in (model.coupling[i], model.coupling[i - 1] if i else None) if c is not None
            )
        # of a displacement and of a velocity of one in each unknown, in that metric
        self.displacement_norm = math.sqrt((K.sum(axis=1) + self.soft**2 * mass).sum()) * self.MARGIN
        self.velocity_norm = math.sqrt(mass.sum()) * self.MARGIN

    def squared_rate(self, active: Array) -> float:
        """Norm of M^-1 K with some of the contacts [1/s2]."""
        rows = self.elastic_rows
        if len(self.stiffness):
            rows = rows + self.contact_rows[active].sum(axis=0)
        return float(rows.max()) * self.MARGIN

    def displacement_reach(self) -> Array:
        """Greatest displacement of each unknown of an error of norm one [m]."""
        return np.sqrt(self.mobility) / self.soft
