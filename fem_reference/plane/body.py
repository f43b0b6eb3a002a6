"""The body: its cells, material, clamps and loads, and the mesh.

A body is given by polygons that tile it. Each is cut into triangles from the centroid of its corners and refined, or,
where the body is an upright rectangle, meshed by a tensor product of quadrilaterals that is graded towards the corners
of its clamped sides: there stresses are singular, and elements of one size would converge with that singularity.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray
from skfem import Mesh, MeshQuad, MeshTri

from fem_reference.problem.checks import require, require_numbers
from fem_reference.problem.problem import Array

Point = tuple[float, float]
Segment = tuple[Point, Point]
LAYERS = 8  # elements that halve towards a clamped corner: 12 change a cantilever's tip by less than 1e-6
SAME_PLACE = 1e-9  # of the body's extent


@dataclass(frozen=True)
class PlaneBody:
    """An elastic body under constant loads that come on at t = 0.

    Raises
    ------
    ValueError
        For a value out of its range, naming field, rule and value.
    """

    polygons: tuple[tuple[Point, ...], ...]  # that tile the body, corners counter-clockwise [m]
    density: float  # [kg/m3]
    young: float  # Young's modulus E [Pa]
    poisson: float  # Poisson's ratio [-]
    hypothesis: str = "plane stress"  # or "plane strain"
    rectangle: bool = False  # whether they tile an upright rectangle, which is meshed as one
    clamps: tuple[Segment, ...] = ()  # parts of the outline that do not move [m]
    tractions: tuple[tuple[Segment, tuple[float, float]], ...] = ()  # parts of the outline, traction in x and y [Pa]
    stress: tuple[float, float, float] = (0.0, 0.0, 0.0)  # whose tractions act on all that is not clamped [Pa]
    gravity: tuple[float, float] = (0.0, 0.0)  # acceleration in x and y [m/s2]
    elements: int = 16  # along the shorter side of a rectangle, or of each polygon's sides [-]
    degree: int = 2  # of the elements [-], 1 or 2

    def __post_init__(self) -> None:
        require_numbers(self, ("density", "young"), ())
        require(self.hypothesis in ("plane stress", "plane strain"), "hypothesis", "must be known", self.hypothesis)
        require(-1 < self.poisson < 0.5, "poisson", "must be above -1 and below 0.5", self.poisson)
        require(self.elements >= 1, "elements", "must be at least 1", self.elements)
        require(self.degree in (1, 2), "degree", "must be 1 or 2", self.degree)

    @property
    def shear_modulus(self) -> float:
        """Shear modulus G [Pa]."""
        return self.young / (2 * (1 + self.poisson))

    @property
    def lame(self) -> float:
        """Lame's parameter of the plane problem [Pa]: E mu / ((1 + mu)(1 - mu)) in plane stress."""
        last = 1 - 2 * self.poisson if self.hypothesis == "plane strain" else 1 - self.poisson
        return self.young * self.poisson / ((1 + self.poisson) * last)

    @cached_property
    def extent(self) -> tuple[Array, Array]:
        """Lowest and highest coordinates, each of shape (2,) [m]."""
        corners = np.vstack([np.array(polygon) for polygon in self.polygons])
        return corners.min(axis=0), corners.max(axis=0)

    @property
    def slack(self) -> float:
        """Distance below which two places are one [m]."""
        return SAME_PLACE * float(np.max(self.extent[1] - self.extent[0]))


def mesh_of(body: PlaneBody) -> Mesh:
    """Return the mesh of a body."""
    return _tensor_mesh(body) if body.rectangle else _fan_mesh(body)


def _tensor_mesh(body: PlaneBody) -> MeshQuad:
    low, high = body.extent
    size = float(np.min(high - low)) / body.elements
    clamped = np.array([point for clamp in body.clamps for point in clamp]).reshape(-1, 2)
    axes = []
    for axis in (0, 1):
        ends = [bool(np.any(abs(clamped[:, axis] - end) <= body.slack)) for end in (low[axis], high[axis])]
        axes.append(_graded(float(low[axis]), float(high[axis]), size, ends))
    return MeshQuad.init_tensor(*axes)


def _graded(low: float, high: float, size: float, graded: Sequence[bool]) -> Array:
    """Return equal steps from low to high, the first and the last halved again and again where they are graded."""
    count = max(1, round((high - low) / size))
    places = np.linspace(low, high, count + 1)
    halves = 0.5 ** np.arange(1, LAYERS + 1)
    if graded[0]:
        places = np.union1d(places, low + (places[1] - places[0]) * halves)
    if graded[1]:
        places = np.union1d(places, high - (places[-1] - places[-2]) * halves)
    return places


def _fan_mesh(body: PlaneBody) -> MeshTri:
    """Return triangles from the middle of each polygon, all corners that lie on its sides among its own."""
    corners: list[Array] = []
    for polygon in body.polygons:
        for corner in np.array(polygon, float):
            if all(np.hypot(*(corner - other)) > body.slack for other in corners):
                corners.append(corner)
    points = [*corners]
    triangles = []
    for polygon in body.polygons:
        ring = _ring(np.array(polygon, float), np.array(corners), body.slack)
        points.append(np.mean(np.array(polygon, float), axis=0))
        triangles += [[len(points) - 1, ring[i - 1], ring[i]] for i in range(len(ring))]
    mesh = MeshTri(np.array(points).T, np.array(triangles).T)
    return mesh.refined(max(0, int(np.ceil(np.log2(body.elements)))))


def _ring(polygon: Array, corners: Array, slack: float) -> list[int]:
    """Return the numbers of the corners that lie on a polygon's sides, in its order."""
    ring = []
    for start, end in zip(polygon, np.roll(polygon, -1, axis=0), strict=True):
        along = end - start
        length = float(np.hypot(*along))
        places = (corners - start) @ along / length
        offsets = abs((corners - start) @ np.array([-along[1], along[0]]) / length)
        on_side = np.flatnonzero((offsets <= slack) & (places >= -slack) & (places < length - slack))
        ring += [int(i) for i in on_side[np.argsort(places[on_side])]]
    return ring


def facets_between(mesh: Mesh, start: Point, end: Point, slack: float) -> NDArray[np.int64]:
    """Return the boundary facets that lie on a straight piece of the outline.

    Raises
    ------
    ValueError
        They do not cover it.
    """
    a = np.array(start, float)
    along = np.array(end, float) - a
    length = float(np.hypot(*along))
    facets = mesh.boundary_facets()
    ends = mesh.p[:, mesh.facets[:, facets]] - a[:, None, None]
    offsets = abs(along[0] * ends[1] - along[1] * ends[0]) / length
    places = (along[0] * ends[0] + along[1] * ends[1]) / length
    inside = np.all((offsets <= slack) & (places >= -slack) & (places <= length + slack), axis=0)
    covered = float(np.sum(np.ptp(places[:, inside], axis=0)))
    if abs(covered - length) > slack * len(facets):
        raise ValueError(f"edge: must be covered by edges of the outline's polygons, got {start!r} to {end!r}")
    return np.asarray(facets[inside], np.int64)
