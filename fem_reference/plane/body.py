"""The body: its outline, material, clamps and loads, and the mesh.

A body is given by polygons that tile it, or by a mesh. Each polygon is cut into triangles from the middle of its
corners and refined, or, where the body is an upright rectangle, meshed by a tensor product of quadrilaterals that is
graded towards the corners of its clamped sides: there stresses are singular, and elements of one size would converge
with that singularity.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from scipy.spatial import cKDTree
from skfem import Mesh, MeshQuad, MeshTri

from fem_reference.mesh.files import read_mesh
from fem_reference.problem.checks import require, require_numbers
from fem_reference.problem.material import Elastic
from fem_reference.problem.problem import Array

Point = tuple[float, float]
Segment = tuple[Point, Point]
Traction = tuple[float, float] | Callable[[Array], Array]
LAYERS = 8  # elements that halve towards a clamped corner: 12 change a cantilever's tip by less than 1e-6
SAME_PLACE = 1e-9  # of the body's extent


@dataclass(frozen=True)
class PlaneBody(Elastic):
    """An elastic body under constant loads that come on at t = 0."""

    polygons: tuple[tuple[Point, ...], ...]  # that tile the body, corners counter-clockwise [m]; () with a mesh
    density: float  # [kg/m3]
    young: float  # E [Pa]
    poisson: float  # [-]
    hypothesis: str = "plane stress"  # or "plane strain"
    rectangle: bool = False  # whether they tile an upright rectangle, which is meshed as one
    clamps: tuple[Segment, ...] = ()  # parts of the outline that do not move [m]
    rollers: tuple[tuple[Segment, str], ...] = ()  # parts of the outline, "x" or "y" along which they do not move
    tractions: tuple[tuple[Segment, Traction], ...] = ()  # parts of the outline, traction in x and y [Pa], or that of x
    stress: tuple[float, float, float] = (0.0, 0.0, 0.0)  # whose tractions act on all that is not clamped [Pa]
    gravity: tuple[float, float] = (0.0, 0.0)  # acceleration in x and y [m/s2]
    forces: tuple[tuple[Point | None, tuple[float, float]], ...] = ()  # place, or all over the body; x and y [N]
    velocity: tuple[float, float] = (0.0, 0.0)  # of the centre of mass at t = 0 [m/s]
    spin: float = 0.0  # about it, counter-clockwise [rad/s]
    elements: int = 16  # along the shorter side of a rectangle, or of each polygon's sides [-]
    degree: int = 2  # of the elements [-], 1 or 2
    mesh: Mesh | str | None = None  # of straight triangles or quadrilaterals, or a file of such, in place of polygons

    def __post_init__(self) -> None:
        require_numbers(self, ("density", "young"), ())
        require(self.hypothesis in ("plane stress", "plane strain"), "hypothesis", "must be known", self.hypothesis)
        require(-1 < self.poisson < 0.5, "poisson", "must be above -1 and below 0.5", self.poisson)
        require(self.elements >= 1, "elements", "must be at least 1", self.elements)
        require(self.degree in (1, 2), "degree", "must be 1 or 2", self.degree)
        is_held = bool(self.clamps or self.rollers)
        is_moving = any(self.velocity) or self.spin != 0
        require(not (is_held and is_moving), "velocity", "must be zero of a body with clamps or rollers", self.velocity)
        one_outline = bool(self.polygons) != (self.mesh is not None)
        require(one_outline, "mesh", "must be given where there are no polygons, and only there", self.mesh)

    @cached_property
    def extent(self) -> tuple[Array, Array]:
        """Lowest and highest coordinates, each of shape (2,) [m]."""
        corners = np.vstack([np.array(polygon) for polygon in self.polygons]) if self.polygons else mesh_of(self).p.T
        return corners.min(axis=0), corners.max(axis=0)

    @property
    def slack(self) -> float:
        """Distance below which two places are one [m]."""
        return SAME_PLACE * float(np.max(self.extent[1] - self.extent[0]))


def mesh_of(body: PlaneBody) -> Mesh:
    """The mesh of a body; a `ValueError` if its file cannot be read."""
    if body.mesh is not None:
        return read_mesh(body.mesh) if isinstance(body.mesh, str) else body.mesh
    return _tensor_mesh(body) if body.rectangle else _fan_mesh(body)


def _tensor_mesh(body: PlaneBody) -> MeshQuad:
    low, high = body.extent
    size = float(np.min(high - low)) / body.elements
    clamped = np.array([point for clamp in body.clamps for point in clamp]).reshape(-1, 2)
    axes = []
    halves = 0.5 ** np.arange(1, LAYERS + 1)
    for axis, length in enumerate((high - low).tolist()):
        places = np.linspace(low[axis], high[axis], max(1, round(length / size)) + 1)
        for end, inner in ((0, 1), (-1, -2)):  # the first and the last step are halved again and again at a clamp
            if np.any(abs(clamped[:, axis] - places[end]) <= body.slack):
                places = np.union1d(places, places[end] + (places[inner] - places[end]) * halves)
        axes.append(places)
    return MeshQuad.init_tensor(*axes)


def _fan_mesh(body: PlaneBody) -> MeshTri:
    """Triangles from the middle of each polygon, all corners that lie on its sides among its own."""
    polygons = [np.array(polygon, float) for polygon in body.polygons]
    places = np.vstack(polygons)
    first = [min(near) for near in cKDTree(places).query_ball_point(places, body.slack)]
    corners = places[np.unique(first)]
    points = [*corners]
    triangles = []
    for polygon in polygons:
        ring = _ring(polygon, corners, body.slack)
        points.append(np.mean(polygon, axis=0))
        triangles += [[len(points) - 1, ring[i - 1], ring[i]] for i in range(len(ring))]
    a, b, c = np.moveaxis(np.array(points)[np.array(triangles)], 1, 0)
    turns = (b - a)[:, 0] * (c - a)[:, 1] - (b - a)[:, 1] * (c - a)[:, 0]
    require(bool(np.all(turns > 0)), "polygons", "must be seen whole from the middle of their corners", body.polygons)
    mesh = MeshTri(np.array(points).T, np.array(triangles).T)
    return mesh.refined(max(0, int(np.ceil(np.log2(body.elements)))))


def _ring(polygon: Array, corners: Array, slack: float) -> list[int]:
    """The numbers of the corners that lie on a polygon's sides, in its order."""
    ring = []
    for start, end in zip(polygon, np.roll(polygon, -1, axis=0), strict=True):
        along = end - start
        length = float(np.hypot(*along))
        places = (corners - start) @ along / length
        offsets = abs((corners - start) @ np.array([-along[1], along[0]]) / length)
        on_side = np.flatnonzero((offsets <= slack) & (places >= -slack) & (places < length - slack))
        ring += [int(i) for i in on_side[np.argsort(places[on_side])]]
    return ring
