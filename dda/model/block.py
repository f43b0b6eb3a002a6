"""One block of discontinuous deformation analysis: a polygon with six unknowns.

The unknowns are D = (u, v, r, ex, ey, gxy) about the centroid (x0, y0), eq. (1).
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import ArrayLike

from dda.model.arrays import Array, ArrayPair
from dda.model.checks import check_number
from dda.model.material import Material
from dda.model.polygon import Section, checked_polygon, section


def displacement_rows(x: float, y: float) -> Array:
    """Return the 2 x 6 matrix of eq. (3) at a place from the centroid [m]."""
    return np.array([[1.0, 0.0, -y, x, 0.0, y / 2], [0.0, 1.0, x, 0.0, y, x / 2]])


@dataclass(frozen=True, eq=False)
class Block:
    """A homogeneous polygonal block of unit thickness.

    Raises
    ------
    ValueError
        If the corners do not form a simple counter-clockwise polygon.
    """

    vertices: ArrayLike  # (n, 2) corners, counter-clockwise [m]
    material: Material

    def __post_init__(self) -> None:
        object.__setattr__(self, "vertices", checked_polygon(self.vertices))

    @classmethod
    def rectangle(cls, width: float, height: float, material: Material) -> Block:
        """Return the upright rectangle with its lower left corner at the origin (sides in m)."""
        return cls([[0.0, 0.0], [width, 0.0], [width, height], [0.0, height]], material)

    @property
    def corners(self) -> Array:
        """The corners as a read-only (n, 2) array [m]."""
        return np.asarray(self.vertices)

    @property
    def turns(self) -> Array:
        """Cross product of every edge and the next one, positive where they turn left [m^2]."""
        edges = np.roll(self.corners, -1, axis=0) - self.corners
        following = np.roll(edges, -1, axis=0)
        return edges[:, 0] * following[:, 1] - edges[:, 1] * following[:, 0]

    @cached_property
    def section(self) -> Section:
        """Area, centroid and central moments."""
        return section(self.corners)

    @property
    def total_mass(self) -> float:
        """Density times area [kg]."""
        return self.material.density * self.section.area

    def edge(self, index: int) -> ArrayPair:
        """Return the two ends of edge `index`, from corner `index` to the next [m]; a ValueError if there is none."""
        n = len(self.corners)
        check_number("edge", index, n)
        return self.corners[index], self.corners[(index + 1) % n]

    def T(self, x: float, y: float) -> Array:
        """Return the 2 x 6 displacement matrix of eq. (3) at the point (x, y) [m]."""
        X = x - self.section.centroid[0]
        Y = y - self.section.centroid[1]
        return displacement_rows(X, Y)

    def mass(self) -> Array:
        """Return the 6 x 6 inertia matrix, eq. (15), (16) with (3,6) and (6,6) corrected.

        Entry (3,6) is rho (s1 - s2)/2 and (6,6) is rho (s1 + s2)/4.
        """
        s = self.section.area
        s1 = self.section.s1
        s2 = self.section.s2
        s3 = self.section.s3
        M = np.zeros((6, 6))
        M[0, 0] = M[1, 1] = s
        M[2:, 2:] = [
            [s1 + s2, -s3, s3, (s1 - s2) / 2],
            [-s3, s1, 0.0, s3 / 2],
            [s3, 0.0, s2, s3 / 2],
            [(s1 - s2) / 2, s3 / 2, s3 / 2, (s1 + s2) / 4],
        ]
        return self.material.density * M

    def elastic(self) -> Array:
        """Return the 6 x 6 elastic matrix s E, eq. (21) with its missing modulus [N/m, N, N m]."""
        K = np.zeros((6, 6))
        K[3:, 3:] = self.section.area * self.material.elasticity()
        return K

    def segment_load(self, start: Array, end: Array, traction: tuple[float, float]) -> Array:
        """Return the 6 loads of a uniform traction (Fx, Fy) [Pa] between two points [m], eq. (29)."""
        x, y = start + (end - start) / 2
        force = float(np.hypot(*(end - start))) * np.array(traction)
        return self.T(x, y).T @ force
