"""Meshes of the block: structured quadrilaterals, or a file with tagged edges.

Coordinates are relative to the start of the base, so that a block far from the origin keeps its digits.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike
from skfem import Mesh, MeshQuad, MeshTri

from fem_reference.mesh.files import read_mesh
from fem_reference.problem.checks import require
from fem_reference.problem.problem import Array, Indices, Problem


@dataclass(frozen=True)
class TaggedMesh:
    """A mesh and the facets of its base and top."""

    mesh: Mesh  # [m]
    base: Indices
    top: Indices


def block_mesh(problem: Problem) -> TaggedMesh:
    """Mesh the whole block, from its file if it names one.

    Raises
    ------
    ValueError
        If the block has no file and is not a convex quadrilateral, or its file cannot be read, lacks the tags ``base``
        and ``top``, or has another outline.
    """
    return structured(problem) if problem.mesh is None else from_file(problem)


def structured(problem: Problem, half: bool = False) -> TaggedMesh:
    """Map a tensor mesh of the unit square onto a convex quadrilateral block bilinearly.

    `half`: that of the half next to the start of the base only, where ``elements`` must be even.
    """
    corners = problem.outline
    sides = np.roll(corners, -1, axis=0) - corners
    following = np.roll(sides, -1, axis=0)
    turns = sides[:, 0] * following[:, 1] - sides[:, 1] * following[:, 0]
    if len(corners) != 4 or not np.all(turns > 0):
        raise ValueError(
            "vertices: only convex quadrilaterals are meshed without a file, "
            f"got {len(corners)} corners; give a mesh file: [fem] mesh = ..."
        )
    n = problem.elements
    eta = np.arange(n + 1) / n
    xi = eta[: n // 2 + 1] if half else eta
    # triangles are cut from the lower left to the upper right corner of each cell
    square = (MeshTri if problem.cells == "triangles" else MeshQuad).init_tensor(xi, eta)
    axis, value = ((1, 0.0), (0, 1.0), (1, 1.0), (0, 0.0))[(problem.top - problem.base) % 4]
    base = square.facets_satisfying(lambda x: x[1] == 0.0, boundaries_only=True)
    top = square.facets_satisfying(lambda x: x[axis] == value, boundaries_only=True)
    x, y = square.p
    points = corners.T @ np.array([(1 - x) * (1 - y), x * (1 - y), x * y, (1 - x) * y])
    return TaggedMesh(type(square)(points, square.t), base, top)


def from_file(problem: Problem) -> TaggedMesh:
    """Read a mesh of triangles or quadrilaterals and check it against the block."""
    mesh = read_mesh(str(problem.mesh))
    if mesh.dim() != 2 or mesh.t.shape[0] not in (3, 4) or mesh.p.shape[1] != mesh.nvertices:
        kind = type(mesh).__name__
        raise ValueError(f"mesh: must hold straight triangles or quadrilaterals, got {kind} in {problem.mesh!r}")
    origin = np.asarray(problem.vertices[problem.base], float)
    mesh = type(mesh)(mesh.p - origin[:, None], mesh.t).with_boundaries(mesh.boundaries or {})
    tags = mesh.boundaries or {}
    require({"base", "top"} <= set(tags), "mesh", f"must tag 'base' and 'top' in {problem.mesh!r}", sorted(tags))
    tagged = TaggedMesh(mesh, np.asarray(tags["base"]), np.asarray(tags["top"]))
    _check_outline(problem, tagged)
    return tagged


def _check_outline(problem: Problem, tagged: TaggedMesh) -> None:
    """Raise unless edges of elements make up each edge of the polygon, all of them, and base and top have their own."""
    corners = problem.outline
    slack = 1e-9 * float(np.ptp(corners, axis=0).max())
    tags = {0: ("base", tagged.base), (problem.top - problem.base) % len(corners): ("top", tagged.top)}
    count = 0
    for number, (start, end) in enumerate(zip(corners, np.roll(corners, -1, axis=0), strict=True)):
        try:
            facets = facets_between(tagged.mesh, start, end, slack)
        except ValueError as error:
            raise ValueError(f"mesh: outline must be the block's, {problem.mesh!r} differs: {error}") from None
        count += len(facets)
        name, own = tags.get(number, ("", facets))
        if set(own.tolist()) != set(facets.tolist()):
            raise ValueError(f"mesh: tag {name!r} must cover edge {getattr(problem, name)} of the block exactly")
    if count != len(tagged.mesh.boundary_facets()):
        raise ValueError(f"mesh: outline must be the block's, {problem.mesh!r} has a boundary off the polygon")


def facets_along(mesh: Mesh, start: Array, end: Array, slack: float) -> tuple[Indices, Array]:
    """The boundary facets that lie on a straight piece of the outline, wholly or in part, and the places of their ends.

    These are arc lengths from the start [m], lower first, shape (2, facets). Facets that do not cover the piece are a
    `ValueError`.
    """
    along = end - start
    length = float(np.hypot(*along))
    facets = mesh.boundary_facets()
    ends = mesh.p[:, mesh.facets[:, facets]] - start[:, None, None]
    offsets = abs(along[0] * ends[1] - along[1] * ends[0]) / length
    places = np.sort((along[0] * ends[0] + along[1] * ends[1]) / length, axis=0)
    on_line = np.all(offsets <= slack, axis=0)
    on_piece = on_line & (places[1] > slack) & (places[0] < length - slack)
    covered = float(np.sum(np.ptp(np.clip(places[:, on_piece], 0.0, length), axis=0)))
    if abs(covered - length) > slack * len(facets):
        raise ValueError(
            f"edge: must be covered by edges of the outline, got {tuple(start.tolist())!r} to {tuple(end.tolist())!r}"
        )
    return np.asarray(facets[on_piece], np.int64), places[:, on_piece]


def facets_between(mesh: Mesh, start: ArrayLike, end: ArrayLike, slack: float) -> Indices:
    """The boundary facets that make up a straight piece of the outline; a `ValueError` if they do not cover it."""
    facets, places = facets_along(mesh, np.array(start, float), np.array(end, float), slack)
    if places.min() < -slack or places.max() > float(np.hypot(*np.subtract(end, start))) + slack:
        raise ValueError(f"edge: must begin and end at corners of elements, got {np.array([start, end]).tolist()}")
    return facets
