r"""Closed forms and derived rows of beams that are cut into blocks.

Squares of side w/n, glued by springs of g E at each end of a shared edge (E the modulus, unit thickness). In bending
each row of squares turns as a rigid body, and the square at x_i (in sides, from the middle) takes the axial strain e_i
that minimises, for unit curvature and modulus,

    U = sum [ e_i^2/2 + g (x_i - e_i)^2 + g/4 ] + (g/4) sum (e_{i+1} - e_i)^2,      EI(g, n) / EI = 24 U / n^3.

Under tension the modulus is E / (1 + 1/(2 g)), in shear 1/G becomes 1/G + 1/(g E). The end of a cantilever moves by
P L^3 / (3 EI) + P L (1/G + 1/(g E)) / w, since squares keep plane rows.
"""

from __future__ import annotations

from collections.abc import Sequence
from itertools import starmap

import numpy as np

from validation.models.plane.tables import PlaneSection
from validation.runs.row import Metrics, Row
from validation.scenes.scene import Scene
from validation.suite.bands import Band

READ = ("displacement.static", *(f"frequency.{number}" for number in (1, 2, 3, 4)))


def blocks(case: Scene) -> Metrics:
    """Return the blocks across the beam, and the glue over n / sqrt(24)."""
    plane = case.table(PlaneSection)
    across = min(plane.subdivide or (1, 1))
    return {"across": float(across), "over n": plane.glue * np.sqrt(24) / across}


def ratios(case: Scene, row: Row, elements: Row) -> dict[str, float]:
    """Return the ratios of static displacement and frequencies to those of elements on the same outline."""
    ratios: dict[str, float] = {}
    for metric, value in row.metrics.items():
        other = elements.metrics.get(metric)
        if metric in READ and isinstance(value, float) and isinstance(other, float):
            ratios[metric] = value / other
    return ratios


def orders(levels: Sequence[tuple[Scene, Row, Row]]) -> Metrics:
    """Return the order of the last halving, by metric."""
    coarse, fine = starmap(ratios, levels[-2:])
    return {metric: float(np.log2((coarse[metric] - 1) / (ratio - 1))) for metric, ratio in fine.items()}


def bending_ratio(squares: int, glue: float) -> float:
    """Return EI(g, n) / EI of a beam of n squares across.

    Example
    -------
    >>> round(bending_ratio(8, 2.0), 10), round(bending_ratio(2, 1.0), 10)
    (1.0748753965, 2.25)
    """
    x = np.arange(squares) - (squares - 1) / 2
    neighbours = np.diff(np.eye(squares), axis=0)  # e_{i+1} - e_i
    stiffness = (1 + 2 * glue) * np.eye(squares) + glue / 2 * neighbours.T @ neighbours
    e = np.linalg.solve(stiffness, 2 * glue * x)
    steps = neighbours @ e
    energy = e @ e / 2 + glue * (x - e) @ (x - e) + squares * glue / 4 + glue / 4 * steps @ steps
    return float(24 * energy / squares**3)


def tip_of_squares(case: Scene) -> Band:
    """Return bounds of the end's displacement of a cantilever of squares that are glued with finite stiffness [m].

    Rows turn against each other in joints at j h: the integral of (L - z)^2 is a sum, without the clamp from below and
    with it from above.
    """
    shear, bending, rows = _parts(case)
    places = np.arange(rows + 1) / rows
    above = 3 * float(np.sum((1 - places[:-1]) ** 2)) / rows
    below = 3 * float(np.sum((1 - places[1:]) ** 2)) / rows
    return shear + below * bending, shear + above * bending


def locked_tip(case: Scene) -> Band:
    """Return bounds of the same where the glue is firm: t L / G, and up to twice what the glue gives in bending [m]."""
    shear, bending, _ = _parts(case)
    return shear * (1 - 1e-9), shear + 2 * bending


def _parts(case: Scene) -> tuple[float, float, int]:
    """Return shear and bending of the end of a cantilever of squares [m], and its number of rows."""
    plane = case.table(PlaneSection)
    across, rows = plane.subdivide or (1, 1)
    width, length = plane.rectangle or (1.0, 1.0)
    force = plane.tractions[0][1][0] * width
    stiffness = plane.young * width**3 / 12 * bending_ratio(across, plane.glue)
    compliance = 2 * (1 + plane.poisson) / plane.young + 1 / (plane.glue * plane.young)
    return force * length * compliance / width, force * length**3 / (3 * stiffness), rows
