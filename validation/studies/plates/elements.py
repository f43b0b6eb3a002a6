"""Linear elements on triangles, assembled plainly, with springs between them or without: blocks of one strain."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence

import numpy as np
from scipy.sparse import coo_matrix
from scipy.sparse.linalg import spsolve

from validation.runs.history import Array
from validation.theory.statics import elasticity

Point = tuple[float, float]
Node = tuple[int, Point]  # the triangle whose own it is, or 0, and its place
Load = tuple[Point, Point, Sequence[float], Sequence[float]]  # both ends of an edge [m], and the forces on them [N]


def displacements(
    triangles: Sequence[Sequence[Point]],
    loads: Sequence[Load],
    young: float,
    poisson: float,
    places: Sequence[Point],
    glue: float = math.inf,
) -> Array:
    """Return the displacements of some nodes of a free plate under loads in balance [m], shape (places, 2).

    Plane stress, unit thickness. The three motions of the whole plate are left out: two nodes keep three places. With
    glue, in N/m, each triangle has nodes of its own, which springs of that stiffness join at both ends of every shared
    edge, in all directions alike.
    """
    parts = range(len(triangles)) if math.isfinite(glue) else [0] * len(triangles)
    nodes = []
    for part, triangle in zip(parts, triangles, strict=True):
        nodes.append([(part, point) for point in triangle])
    numbers: dict[Node, int] = {}
    at_point: dict[Point, set[int]] = {}
    on_edge = {}
    for corners in nodes:
        own_numbers = [numbers.setdefault(node, len(numbers)) for node in corners]
        for k, number in enumerate(own_numbers):
            following = (k + 1) % 3
            at_point.setdefault(corners[k][1], set()).add(number)
            on_edge[corners[k][1], corners[following][1]] = number, own_numbers[following]
    elastic = elasticity(young, poisson)
    rows = []
    columns = []
    values = []
    for triangle, own_nodes in zip(triangles, nodes, strict=True):
        strain, double = _strain(triangle)
        own = np.ravel([[2 * numbers[node], 2 * numbers[node] + 1] for node in own_nodes])
        rows.append(np.repeat(own, 6))
        columns.append(np.tile(own, 6))
        values.append(np.ravel(double / 2 * strain.T @ elastic @ strain))
    for first, second in _joined(nodes) if math.isfinite(glue) else ():
        for axis in range(2):
            i = 2 * numbers[first] + axis
            j = 2 * numbers[second] + axis
            rows.append(np.array([i, i, j, j]))
            columns.append(np.array([i, j, i, j]))
            values.append(glue * np.array([1.0, -1.0, -1.0, 1.0]))
    unknowns = 2 * len(numbers)
    force = np.zeros(unknowns)
    for start, end, *forces in loads:
        for number, (x, y) in zip(on_edge[start, end], forces, strict=True):
            force[2 * number] += x
            force[2 * number + 1] += y
    stiffness = coo_matrix((np.concatenate(values), (np.concatenate(rows), np.concatenate(columns)))).tocsc()
    pin, roller = (min(at_point[place]) for place in places[:2])
    kept = np.setdiff1d(np.arange(unknowns), [2 * pin, 2 * pin + 1, 2 * roller + 1])
    solution = np.zeros(unknowns)
    solution[kept] = spsolve(stiffness[np.ix_(kept, kept)], force[kept])
    by_node = solution.reshape(-1, 2)
    return np.array([by_node[sorted(at_point[place])].mean(axis=0) for place in places])


def stress(triangle: Sequence[Point], corners: Array, young: float, poisson: float) -> Array:
    """Return the stress of a triangle whose corners are displaced [m], shape (3, 2), as [Pa], shape (3,)."""
    strain, _ = _strain(triangle)
    return elasticity(young, poisson) @ strain @ corners.ravel()


def _strain(triangle: Sequence[Point]) -> tuple[Array, float]:
    """Return the strains of a triangle per displacement of its corners, shape (3, 6), and twice its area."""
    (x0, y0), (x1, y1), (x2, y2) = triangle
    double = (x1 - x0) * (y2 - y0) - (x2 - x0) * (y1 - y0)
    b = np.array([y1 - y2, y2 - y0, y0 - y1]) / double
    c = np.array([x2 - x1, x0 - x2, x1 - x0]) / double
    strain = np.zeros((3, 6))
    strain[0, ::2] = b
    strain[1, 1::2] = c
    strain[2, ::2] = c
    strain[2, 1::2] = b
    return strain, double


def _joined(nodes: Sequence[Sequence[Node]]) -> Iterator[tuple[Node, Node]]:
    """Yield the nodes of two triangles that meet at an end of an edge which they share."""
    edges = {}
    for corners in nodes:
        for start, end in zip(corners, (*corners[1:], corners[0]), strict=True):
            edge = frozenset((start[1], end[1]))
            if edge not in edges:
                edges[edge] = [start, end]
                continue
            first, second = edges[edge]  # the neighbour runs along the edge the other way
            yield first, end
            yield second, start
