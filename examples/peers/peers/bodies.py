"""Rigid polygons of a scene of blocks in the plane for programs of contact: what each is, in convex parts."""

import math
from dataclasses import dataclass

import numpy as np

from validation.models.plane.blocks import centroid
from validation.models.plane.geometry import triangles_of
from validation.models.plane.tables import PlaneSection
from validation.runs.history import Array
from validation.scenes.outline import area


@dataclass(frozen=True)
class PolygonBody:
    """A rigid polygon of unit depth where it is at t = 0."""

    name: str
    held: bool  # nothing moves it, but a record
    density: float  # kg/m3
    place: tuple[float, float]  # of the centroid [m]
    angle: float  # rad
    velocity: tuple[float, float]  # m/s
    spin: float  # rad/s
    corners: Array  # about the centroid, before it is turned by the angle, shape (n, 2) [m]

    @property
    def mass(self):
        """Mass [kg]."""
        return self.density * area(tuple(map(tuple, self.corners)))

    @property
    def inertia(self):
        """Moment of inertia about the centroid [kg m2]: of the triangles from it to each edge."""
        ahead = np.roll(self.corners, -1, axis=0)
        double = self.corners[:, 0] * ahead[:, 1] - self.corners[:, 1] * ahead[:, 0]
        squares = np.sum(self.corners**2 + self.corners * ahead + ahead**2, axis=1)
        return self.density * float(double @ squares) / 12

    @property
    def parts(self):
        """Convex polygons that it is made of: itself, or triangles."""
        points = [(float(x), float(y)) for x, y in self.corners]
        before, ahead = (
            self.corners - np.roll(self.corners, 1, axis=0),
            np.roll(self.corners, -1, axis=0) - self.corners,
        )
        if np.all(before[:, 0] * ahead[:, 1] >= before[:, 1] * ahead[:, 0]):
            return [points]
        return [[points[number] for number in corners] for corners in triangles_of(tuple(points))]


def refuse_springs(plane, why):
    """Raise NotImplementedError where contact in the plane is of given stiffness, which a program has none of."""
    if any(math.isfinite(law.stiffness) for law in (plane.contact, *plane.pair) if law and law.stiffness):
        raise NotImplementedError(f"contact of given stiffness: {why}")


def bodies_of(scene):
    """Return the blocks of a scene, those that are held among them.

    Raises
    ------
    NotImplementedError
        It is of something else than rigid polygons that touch where they meet, under their weight.
    """
    if "plane" not in scene.tables():
        raise NotImplementedError(f"it must be of blocks in the plane, got {scene.kind_in_words}")
    plane = scene.table(PlaneSection)
    if others := [name for name in ("observe", "bond", "load", "touch", "ramp") if getattr(plane, name)]:
        raise NotImplementedError(f"rigid polygons and their weight alone are taken, got {others[0]}")
    contact = plane.contact
    if contact is None or contact.cohesion or contact.tension:
        raise NotImplementedError("contact must be of friction alone, got none, or cohesion, or tension")
    if elastic := [block.name for block in plane.assembly.blocks if not block.held and math.isfinite(block.young)]:
        raise NotImplementedError(f"blocks must be rigid, got {elastic[0]} of finite young")
    return [_body(block) for block in plane.assembly.blocks]


def _body(block):
    middle = centroid(block.vertices)
    turned = np.array(block.vertices) - middle
    cosine = math.cos(block.angle)
    sine = math.sin(block.angle)
    corners = turned @ np.array([[cosine, -sine], [sine, cosine]])
    return PolygonBody(block.name, block.held, block.density, middle, block.angle, block.velocity, block.spin, corners)


def friction_between(scene, first, second):
    """Return tan(phi) between two blocks; that of 90 degrees where nothing slips."""
    springs = scene.table(PlaneSection).assembly.springs_between(first, second)
    coefficient = springs.friction_coefficient if springs else 0.0
    return math.tan(math.pi / 2) if coefficient is None else coefficient


def moving_names(scene):
    """Return the names of the blocks that move."""
    return [block.name for block in scene.table(PlaneSection).assembly.blocks if not block.held]
