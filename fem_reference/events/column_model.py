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

from flint import arb, arb_mat

from fem_reference.events.column_drive import ANGLE, Drive, still
from fem_reference.events.contacts import STICKS, Contact
from fem_reference.events.enclosure import ZERO
from fem_reference.events.series import System, column
from fem_reference.problem.checks import require, require_numbers

LAWS = ("bonded", "unilateral", "frictional")
BASES = ("rigid", "transmitting", "free")
BASE = -1  # in place of an unknown: the face moves as the base does


@dataclass(frozen=True)
class ColumnBlock:
    """A block of a column, per unit of area."""

    height: float  # h [m]
    density: float  # rho [kg/m3]
    modulus: float = math.inf  # of a plane wave [Pa]; inf: rigid
    velocity: float = 0.0  # at t = 0 [m/s], upwards, or towards + in shear

    def __post_init__(self) -> None:
        require_numbers(self, positive=("height", "density", "modulus"), infinite=("modulus",))


@dataclass(frozen=True)
class ColumnJoint:
    """A spring at the foot of a block, per unit of area."""

    stiffness: float  # k [Pa/m]
    gap: float = 0.0  # of a unilateral joint at t = 0 [m]
    strength: float | None = None  # greatest shear stress s of a frictional joint [Pa]; None: it never slips

    def __post_init__(self) -> None:
        require_numbers(self, positive=("stiffness",), unsigned=("gap", "strength"))


@dataclass(frozen=True)
class ColumnProblem:
    """A column of blocks on a base.

    At t = 0 all blocks are unstrained and at zero displacement, or at rest under their weight. Welded faces, also one
    on the base, get one velocity at once, by impulses on them.
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
        require_numbers(self)
        carried = self.base != "transmitting" or 0 < self.impedance < math.inf
        require(carried, "impedance", "must be positive", self.impedance)
        supported = self.base == "rigid"
        require(supported or not self.at_rest, "at_rest", f"must be False on a base that is {self.base}", True)
        footless = supported or self.joints[0] is None
        require(footless, "joints[0]", f"must be None on a base that is {self.base}", self.joints[0])
        for j, joint in enumerate(self.joints):
            if joint is not None and self.law != "unilateral":
                require(not joint.gap, f"joints[{j}].gap", f"must be 0 in a column that is {self.law}", joint.gap)
            if joint is not None and self.law != "frictional":
                rule = f"must be None in a column that is {self.law}"
                require(joint.strength is None, f"joints[{j}].strength", rule, joint.strength)


class ColumnModel(System):
    """A column in the precision of the current context."""

    angle = ANGLE

    def __init__(self, problem: ColumnProblem) -> None:
        super().__init__()
        self.problem = problem
        self.unilateral = problem.law == "unilateral"
        self.faces = []  # unknowns of foot and top of each block
        joints: list[tuple[int, int, ColumnJoint]] = []  # those with a spring, and their unknowns above and below
        self.contacts = []
        previous = BASE
        count = 0
        for j, (block, joint) in enumerate(zip(problem.blocks, problem.joints, strict=True)):
            foot = previous
            if joint is not None or (j == 0 and problem.base != "rigid"):
                foot = count
                count += 1
            top = foot
            if math.isfinite(block.modulus):
                top = count
                count += 1
            if joint is not None:
                name = f"joint {j}" if j else "base"
                k = arb(joint.stiffness)
                if self.unilateral:
                    contact = Contact(j, name, gap=len(joints), stiffness=k)
                else:
                    strength = None if joint.strength is None else arb(joint.strength)
                    contact = Contact(j, name, slide=len(joints), shear_stiffness=k, cohesion=strength)
                self.contacts.append(contact)
                joints.append((foot, previous, joint))
            self.faces.append((foot, top))
            previous = top
        self.top = previous
        if count == 0:
            raise ValueError("blocks: must have a face that moves of itself, got a column welded to its base")
        self.inputs = self._assemble(count)
        self.rows = arb_mat(len(joints), count)
        self.offsets = arb_mat(len(joints), 1)
        self.on_base = arb_mat(len(joints), 1)
        for row, (above, below, joint) in enumerate(joints):
            self.rows[row, above] = 1
            self.offsets[row, 0] = joint.gap
            if below == BASE:
                self.on_base[row, 0] = 1
            else:
                self.rows[row, below] = -1

    def _assemble(self, count: int) -> arb_mat:
        """Take masses, stiffnesses and loads of the blocks; return the forces of what drives them."""
        problem = self.problem
        base = count  # the last row and column of a matrix are those of the base
        mass = arb_mat(count + 1, count + 1)
        stiffness = arb_mat(count + 1, count + 1)
        load = arb_mat(count + 1, 1)
        for faces, block in zip(self.faces, problem.blocks, strict=True):
            m = arb(block.density) * arb(block.height)
            k = arb(block.modulus) / arb(block.height) if math.isfinite(block.modulus) else ZERO
            sides = [(face % (count + 1), sign) for face, sign in zip(faces, (-1, 1), strict=True)]
            for i, sign in sides:
                load[i, 0] -= m * arb(problem.gravity) / 2
                for j, other in sides:
                    mass[i, j] += m * (3 + sign * other) / 12
                    stiffness[i, j] += k * (sign * other)
        own = range(count)
        self.mass = arb_mat([mass.tolist()[i][:count] for i in own])
        self.stiffness = arb_mat([stiffness.tolist()[i][:count] for i in own])
        self.load = arb_mat([[load[i, 0]] for i in own])
        self.mobility = self.mass.inv()
        self.base_coupling = mass[0, base] if problem.base == "rigid" else ZERO  # of the base and the first unknown
        inputs = arb_mat(count, 4)
        for i in own:
            inputs[i, 0] = -stiffness[i, base]
        inputs[0, 2] = -self.base_coupling
        if self.top != BASE:
            inputs[self.top, 3] = -1
        if problem.base == "transmitting":
            damping = arb_mat(count, count)
            damping[0, 0] = arb(problem.impedance)
            self.damping = damping
            inputs[0, 1] = 2 * damping[0, 0]
        return inputs

    def velocities(self, base: arb) -> arb_mat:
        """Velocity of each unknown just after t = 0, of the blocks' momentum and the velocity of the base."""
        blocks = self.problem.blocks
        by_face = {BASE: [base]}
        for (foot, top), block in zip(self.faces, blocks, strict=True):
            for face in {foot, top}:
                by_face.setdefault(face, []).append(arb(block.velocity))
        if all(speed == speeds[0] for speeds in by_face.values() for speed in speeds):
            return column([by_face[i][0] for i in range(self.size)])
        momentum = arb_mat(self.size, 1)
        momentum[0, 0] = -self.base_coupling * base
        for faces, block in zip(self.faces, blocks, strict=True):
            for face in faces:
                if face != BASE:
                    half = arb(block.density) * arb(block.height) * arb(block.velocity) / 2
                    momentum[face, 0] += half
        return self.mobility * momentum

    def displacements(self, base: arb) -> arb_mat:
        """Displacement of each unknown at t = 0, where the base is."""
        u = arb_mat(self.size, 1)
        if not self.problem.at_rest:
            return u
        closed = self.motion((STICKS,) * len(self.contacts))
        return closed.A.solve((closed.f + closed.E * column([base, *[ZERO] * 3])) * -1)
