"""Linear elements on triangles, assembled plainly: what blocks of one strain are that nothing lets part."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from scipy.sparse import coo_matrix
from scipy.sparse.linalg import spsolve

from validation.runs.history import Array

Point = tuple[float, float]


def displacements(
    triangles: Sequence[Sequence[Point]],
    forces: Sequence[tuple[Point, Sequence[float]]],
    young: float,
    poisson: float,
    places: Sequence[Point],
) -> Array:
    """Return the displacements of some nodes of a free plate under forces on nodes in balance [m], shape (places, 2).

    Plane stress, unit thickness. The three motions of the whole plate are left out: two nodes keep three places.
    """
    numbers: dict[Point, int] = {}
    for triangle in triangles:
        for point in triangle:
            numbers.setdefault(point, len(numbers))
    elastic = young / (1 - poisson**2) * np.array([[1, poisson, 0], [poisson, 1, 0], [0, 0, (1 - poisson) / 2]])
    rows, columns, values = [], [], []
    for triangle in triangles:
        (x0, y0), (x1, y1), (x2, y2) = triangle
        double = (x1 - x0) * (y2 - y0) - (x2 - x0) * (y1 - y0)
        b = np.array([y1 - y2, y2 - y0, y0 - y1]) / double
        c = np.array([x2 - x1, x0 - x2, x1 - x0]) / double
        strain = np.zeros((3, 6))
        strain[0, ::2] = b
        strain[1, 1::2] = c
        strain[2, ::2] = c
        strain[2, 1::2] = b
        own = np.ravel([[2 * numbers[point], 2 * numbers[point] + 1] for point in triangle])
        rows.append(np.repeat(own, 6))
        columns.append(np.tile(own, 6))
        values.append(np.ravel(double / 2 * strain.T @ elastic @ strain))
    unknowns = 2 * len(numbers)
    force = np.zeros(unknowns)
    for point, (x, y) in forces:
        force[2 * numbers[point]] += x
        force[2 * numbers[point] + 1] += y
    stiffness = coo_matrix((np.concatenate(values), (np.concatenate(rows), np.concatenate(columns)))).tocsc()
    first, second = (numbers[place] for place in places[:2])
    kept = np.setdiff1d(np.arange(unknowns), [2 * first, 2 * first + 1, 2 * second + 1])
    solution = np.zeros(unknowns)
    solution[kept] = spsolve(stiffness[np.ix_(kept, kept)], force[kept])
    moved: Array = solution.reshape(-1, 2)[[numbers[place] for place in places]]
    return moved
