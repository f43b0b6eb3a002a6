r"""Bands of the patch tests.

A joint of length l and unit normal n under the stress s opens by d = s n l / (2 kappa) at both ends, kappa = g E.
Blocks of one strain keep that stress if, and only if, the openings around each inner corner close: with equal springs
across and along, where the edge vectors that leave the corner sum to zero. So two blocks, strips and regular crossings
are exact at every glue.
"""

from __future__ import annotations

import numpy as np

from validation.models.plane.tables import PlaneSection
from validation.scenes.scene import Scene
from validation.suite.bands import Band
from validation.theory.spectra import EPS


def rounding(case: Scene) -> float:
    """Return what rounding may leave of a stress over the largest: 1e3 eps, and as much times the glue."""
    return 1e3 * EPS * (1 + case.table(PlaneSection).glue)


def rounding_of_joints(case: Scene) -> Band:
    """Return the band of a stress error that is rounding."""
    return 0.0, rounding(case)


def elongation_of_the_continuum(case: Scene) -> Band | None:
    """Return how much the elastic rectangle lengthens in x [m], None where it does not: a zero judges nothing."""
    return _about(_elastic(case), case)


def elongation(case: Scene) -> Band | None:
    """Return the same of glued blocks, with the openings of joints between its ends [m]."""
    # The mean opening in x of the joints on a way from the left to the right end: at a height between the ends it
    # crosses one joint of two blocks, two of four blocks about a crossing, and n - 1 of a strip of n.
    plane = case.table(PlaneSection)
    s_xx, _, s_xy = plane.stress
    opening = 0.0
    for (x0, y0), (x1, y1) in _joints(plane):
        # s n l, n from the left to the right: (y1 - y0, x0 - x1) of a joint that runs upwards
        force = s_xx * (y1 - y0) + s_xy * (x0 - x1)
        height = y1 - y0
        opening += force / (2 * plane.glue * plane.young) * height
    return _about(_elastic(case) + opening, case)


def _about(value: float, case: Scene) -> Band | None:
    if value == 0:
        return None
    plane = case.table(PlaneSection)
    slack = 1e5 * EPS * float(np.max(np.abs(plane.stress))) / plane.young * (1 + plane.glue)
    return value - slack, value + slack


def _elastic(case: Scene) -> float:
    plane = case.table(PlaneSection)
    length = float(np.ptp([x for polygon in plane.polygons for x, _ in polygon]))
    s_xx, s_yy, _ = plane.stress
    modulus = plane.young
    ratio = plane.poisson
    if plane.hypothesis == "plane strain":
        modulus /= 1 - ratio**2
        ratio /= 1 - ratio
    return length * (s_xx - ratio * s_yy) / modulus


def _joints(plane: PlaneSection) -> list[tuple[tuple[float, float], tuple[float, float]]]:
    """Return the shared edges that are not level, each from below."""
    edges = set()
    joints = []
    for polygon in plane.polygons:
        for start, end in zip(polygon, (*polygon[1:], polygon[0]), strict=True):
            if (end, start) in edges:
                low, high = sorted((start, end), key=lambda point: point[1])
                if high[1] > low[1]:
                    joints.append((low, high))
            edges.add((start, end))
    return joints
