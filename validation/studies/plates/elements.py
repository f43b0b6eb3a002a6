"""Linear elements on triangles, assembled plainly, with springs between them or without: blocks of one strain."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np
from scipy.sparse import coo_matrix, identity, kron
from scipy.sparse.linalg import spsolve

from validation.runs.history import Array
from validation.theory.statics import elasticity

Point = tuple[float, float]
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

    Plane stress, unit thickness. To leave out the three motions of the whole plate, two nodes keep three places. With
    glue [N/m] each triangle has nodes of its own, which springs of that stiffness join at both ends of every shared
    edge, in all directions alike.
    """
    points: Array = np.reshape(triangles, (-1, 2))
    numbers = np.arange(len(points))
    if math.isinf(glue):
        points, numbers = np.unique(points, axis=0, return_inverse=True)
    own = numbers.reshape(-1, 3)
    on_edge: dict[tuple[Point, Point], list[int]] = {}
    matrices = []
    elastic = elasticity(young, poisson)
    for triangle, nodes in zip(triangles, own.tolist(), strict=True):
        strain, double = _strain(triangle)
        matrices.append(double / 2 * strain.T @ elastic @ strain)
        on_edge |= {(triangle[k], triangle[k - 2]): [nodes[k], nodes[k - 2]] for k in range(3)}
    unknowns = np.stack([2 * own, 2 * own + 1], axis=2).reshape(-1, 6)
    places_of = np.repeat(unknowns, 6, axis=1).ravel(), np.tile(unknowns, 6).ravel()
    stiffness = coo_matrix((np.ravel(matrices), places_of)).tocsc()
    if math.isfinite(glue):
        shared = [(edge, edge[::-1]) for edge in on_edge if edge[0] < edge[1] and edge[::-1] in on_edge]
        # The neighbour runs along the edge the other way.
        joined = np.array([[on_edge[edge], on_edge[other][::-1]] for edge, other in shared])
        rows = np.arange(joined.size // 2).reshape(-1, 1, 2).repeat(2, axis=1)
        signs = np.broadcast_to([[1.0], [-1.0]], joined.shape)
        jumps = coo_matrix((signs.ravel(), (rows.ravel(), joined.ravel())))
        stiffness += glue * kron(jumps.T @ jumps, identity(2))
    force = np.zeros((len(points), 2))
    for start, end, *forces in loads:
        force[on_edge[start, end]] += forces
    nodes_at = [np.flatnonzero((points == place).all(axis=1)) for place in places]
    pin, roller = (of_place[0] for of_place in nodes_at[:2])
    kept = np.setdiff1d(np.arange(force.size), [2 * pin, 2 * pin + 1, 2 * roller + 1])
    solution = np.zeros(force.size)
    solution[kept] = spsolve(stiffness[np.ix_(kept, kept)], force.ravel()[kept])
    return np.array([solution.reshape(-1, 2)[of_place].mean(axis=0) for of_place in nodes_at])


def stress(triangle: Sequence[Point], corners: Array, young: float, poisson: float) -> Array:
    """Return the stress [Pa], shape (3,), of a triangle whose corners are displaced [m], shape (3, 2)."""
    strain, _ = _strain(triangle)
    return elasticity(young, poisson) @ strain @ corners.ravel()


def _strain(triangle: Sequence[Point]) -> tuple[Array, float]:
    """Return a triangle's strains per displacement of its corners, shape (3, 6), and twice its area."""
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
