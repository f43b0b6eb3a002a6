"""Moving blocks in the plane by `fem`: elastic bodies on the same springs, with the normals of t = 0.

Each corner spring acts over a strip of `fem.patch_width` from its corner, along the face that its block turns to the
edge, with `fem.foundation = "corner"` at the corner itself, which has no limit of fine elements.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np

from validation.models.plane.assembly import Assembly, StatedContact
from validation.models.plane.blocks import PlacedBlock
from validation.models.plane.history import ENERGY, OF_MOMENTUM, numbers_of, place_of
from validation.models.plane.tables import PlaneSection, Point
from validation.runs.history import Array
from validation.runs.run import Run
from validation.scenes.scene import Scene
from validation.solvers.contract import Prepared
from validation.solvers.plane.mesh import ELEMENTS
from validation.solvers.translation import naming, to_run

if TYPE_CHECKING:
    from fem_reference import BodiesResult, PatchContact, PlaneBody, PlaneModel, Scheme

FACING = 1e-6  # sine of the angle of face and edge, below which a strip lies on both
TOUCHING = 1e-12  # gap over the thinnest block that rounding leaves of a corner on an edge
OF_BODIES = ("density", "young", "poisson", "hypothesis", "velocity", "spin")
RATES = {"vx": "x", "vy": "y", "spin": "angle"}
MEANS = ("x", "y", "angle", "ex", "ey", "gxy")  # of a body, in the order of `PlaneModel.means`
OF_ENERGY = {
    "kinetic": "kinetic_energy",
    "strain": "strain_energy",
    "springs": "spring_energy",
    "load": "load_energy",
    "friction": "friction_loss",
    "algorithmic": "algorithmic_loss",
    "kinetic_damping": "kinetic_damping_loss",
    "switching": "switching_loss",
}


def refusal_of(scene: Scene, plane: PlaneSection) -> str | None:
    """Return why moving blocks are no elastic bodies on patches, None where they are."""
    assembly = plane.assembly
    if plane.contact is not None and not plane.touch:
        return "contacts must be stated by [[plane.touch]]"
    if scene.fem.foundation not in ("patch", "corner"):
        return "corner springs need a patch: fem.foundation = 'patch' with patch_width (or 'corner')"
    if plane.ramp or any(load.ramp for load in assembly.loads):
        return "loads must come on at once"
    if any(np.isinf(block.young) for block in assembly.blocks if not block.held):
        return "blocks must be elastic, got young = inf"
    if any(block.motion is not None for block in assembly.blocks):
        return "blocks must be fixed or move by themselves, got one that is driven"
    if any(math.isinf(contact.springs.stiffness) for contact in assembly.contacts):
        return "contacts must have springs of finite stiffness"
    if any(contact.springs.tension for contact in assembly.contacts):
        return "contacts must carry no tension"
    return None


class MovingMesh(Prepared):
    """Elastic bodies that touch each other."""

    def __init__(self, scene: Scene, plane: PlaneSection, scheme: Scheme) -> None:
        from fem_reference import PlaneModel

        self.scene = scene
        self.scheme = scheme
        self.assembly = plane.assembly
        self.moving = [i for i, block in enumerate(self.assembly.blocks) if not block.held]
        width = scene.fem.patch_width or 0.0
        with naming(scene):
            bodies = [self._body(i, plane) for i in self.moving]
            contacts = [_contact(self.assembly, self.moving, contact, width) for contact in self.assembly.contacts]
            self.model: PlaneModel = PlaneModel(bodies, [*contacts, *_glue(self.assembly, self.moving, width)])

    def history_run(self) -> Run:
        """Step the bodies from their velocities."""
        rows = np.vstack([self.model.means(body) for body in range(len(self.moving))])
        result = self.model.history(self.scheme, self.scene.time.steps, rows)
        columns = {name: self._column(result, name) for name in self.scene.run.columns}
        return to_run(self.scene, result, columns)

    def highest_frequency(self) -> float:
        """Return the highest natural frequency with all contacts closed [rad/s]."""
        return float(self.model.highest_frequency())

    def _body(self, number: int, plane: PlaneSection) -> PlaneBody:
        from fem_reference import PlaneBody

        block = self.assembly.blocks[number]
        loads = [load for load in self.assembly.loads if load.block == number]
        return PlaneBody(
            polygons=(block.vertices,),
            rectangle=_is_upright(block),
            tractions=tuple((load.edge, load.vector) for load in loads if load.edge is not None),
            forces=tuple((load.place, load.vector) for load in loads if load.edge is None),
            gravity=plane.gravity,
            elements=ELEMENTS if self.scene.fem.elements is None else self.scene.fem.elements,
            degree=self.scene.fem.degree,
            **{name: getattr(block, name) for name in OF_BODIES},
        )

    def _column(self, result: BodiesResult, column: str) -> Array:
        place = place_of(column)
        names = [block.name for block in self.assembly.blocks]
        if place.whole == ENERGY:
            total = np.asarray(sum(result.energy.values()))
            return total - total[0] if place.part == "balance" else result.energy[OF_ENERGY[place.part]]
        if place.whole:
            return np.asarray(result.momentum[:, [*OF_MOMENTUM].index(place.part)])
        if place.pair is not None:
            pair = {names.index(name) for name in place.pair}
            between = [k for k, one in enumerate(self.assembly.contacts) if {one.block, one.on} == pair]
            return np.asarray(result.normal[:, between].sum(axis=1))
        if place.contact is not None:
            contact = numbers_of(place.contact, names)
            contacts = [one[:4] for one in self.assembly.contacts]
            return np.asarray(getattr(result, place.part)[:, contacts.index(contact)])
        return self._of_block(result, names.index(place.block), place.part)

    def _of_block(self, result: BodiesResult, number: int, part: str) -> Array:
        """Return what a block does; a fixed one nothing."""
        block = self.assembly.blocks[number]
        start = dict(zip(MEANS, (*block.centroid, block.angle), strict=False)).get(part, 0.0)
        if block.held:
            return np.full(len(result.time), start)
        row = str(len(MEANS) * self.moving.index(number) + MEANS.index(RATES.get(part, part)))
        return np.asarray(result.rates[row] if part in RATES else start + result.columns[row])


def _is_upright(block: PlacedBlock) -> bool:
    """Whether a block is a rectangle with sides along the axes."""
    sides = np.roll(block.corners, -1, axis=0) - block.corners
    return len(sides) == 4 and bool(np.all(np.min(abs(sides), axis=1) == 0))


def _pair(place: complex) -> Point:
    return place.real, place.imag


def _contact(assembly: Assembly, moving: list[int], contact: StatedContact, width: float) -> PatchContact:
    """Return the springs of a corner over the strip of its block's face, seen from the block that moves."""
    from fem_reference import PatchContact

    ring, others = ([complex(*corner) for corner in assembly.blocks[k].vertices] for k in (contact.block, contact.on))
    along = others[(contact.edge + 1) % len(others)] - others[contact.edge]
    normal = -1j * along / abs(along)
    corner = ring[contact.corner]
    end = corner
    for neighbour in (ring[contact.corner - 1], ring[(contact.corner + 1) % len(ring)]):
        side = (neighbour - corner) / abs(neighbour - corner)
        if abs((side * normal.conjugate()).real) < FACING:
            end = corner + width * side
    gap = ((corner - others[contact.edge]) * normal.conjugate()).real
    if abs(gap) <= TOUCHING * assembly.thinnest:
        gap = 0.0
    first, second = contact.block, contact.on
    if assembly.blocks[first].held:
        corner, end = corner - gap * normal, end - gap * normal
        first, second = second, first
        normal = -normal
    springs = contact.springs
    return PatchContact(
        moving.index(first),
        None if assembly.blocks[second].held else moving.index(second),
        _pair(corner),
        _pair(end),
        _pair(normal),
        springs.stiffness,
        springs.shear,
        springs.friction_coefficient if springs.shear else None,
        springs.cohesion if springs.shear else 0.0,
        gap=gap,
    )


def _glue(assembly: Assembly, moving: list[int], width: float) -> list[PatchContact]:
    """Return the springs at both ends of glued edges, over parts as wide as a patch."""
    from fem_reference import PatchContact

    contacts = []
    for bond in assembly.bonds:
        first, second = (bond.second, bond.first) if assembly.blocks[bond.first].held else (bond.first, bond.second)
        below = None if assembly.blocks[second].held else moving.index(second)
        start, end = (complex(*place) for place in bond.edge)
        along = (start - end) / abs(start - end)
        sides = moving.index(first), below
        springs = bond.stiffness, bond.shear
        for place, inwards in ((start, -along), (end, along)):
            strip = _pair(place), _pair(place + width * inwards)
            contacts.append(PatchContact(*sides, *strip, _pair(1j * along), *springs, bonded=True))
    return contacts
