r"""A block of one strain that may turn by any angle: its outline, and where a step brings the points of it.

The frame is that of the base: x along the base edge, y away from the base, the plane at y = 0. With the centroid c,
the turn Q and the strain E = (ex, gxy/2; gxy/2, ey), which is measured in axes that turn with the block, the point xi
of the unstrained outline (from its centroid) lies at

    x = c + Q (I + E) xi.

A step with the increments D = (u, v, r, dex, dey, dgxy) turns the block by

    exact          Q1 = R(r) Q0,         R(r) = (cos r, -sin r; sin r, cos r)
    first-order    Q1 = (I + r W) Q0,    W = (0, -1; 1, 0),

the second as older programs do: every length grows by sqrt(1 + r^2) in each step, and the outline turns by atan r.

A point moves by exactly B D, with the chord B of the step, whose columns are those of x with the means of its ends,

    B = ( I,  (Q1 - Q0)/r (I + E') xi,  (Q1 + Q0)/2 dE/d(ex, ey, gxy) xi ),    E' = (E0 + E1)/2.

In these axes inertia and stiffness are those of the unstrained outline, whatever the angle, as strains are small:
without contact the motion is linear, and keeps momentum, angular momentum and shape.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from dda.contact.springs import base_directions
from dda.model.block import Block

Array = NDArray[np.float64]

EXACT, FIRST_ORDER = "exact", "first-order"


def turned(angle: float) -> Array:
    """Return R of an angle [rad]."""
    return np.array([[math.cos(angle), -math.sin(angle)], [math.sin(angle), math.cos(angle)]])


def quarter(Q: Array) -> Array:
    """Return W Q: Q, turned on by a right angle."""
    return np.array([-Q[1], Q[0]])


class Turn(NamedTuple):
    """What a step does to Q."""

    end: Array  # Q1
    chord: Array  # (Q1 - Q0) / r
    mean: Array  # (Q1 + Q0) / 2


def turn(Q: Array, r: float, rotation: str) -> Turn:
    """Return the turn of a step by r [rad]."""
    if rotation == FIRST_ORDER:
        chord = quarter(Q)
        return Turn(Q + r * chord, chord, Q + r / 2 * chord)
    c, s = math.cos(r), math.sin(r)
    half = math.sin(r / 2) / (r / 2) if r else 1.0
    middle = half * math.cos(r / 2), -half * math.sin(r / 2)  # (R - I) / r = half W R(r/2)
    chord = np.array([[middle[1], -middle[0]], [middle[0], middle[1]]])
    R = np.array([[c, -s], [s, c]])
    return Turn(R @ Q, chord @ Q, (R @ Q + Q) / 2)


def strain_matrix(e: Array) -> Array:
    """Return E of (ex, ey, gxy)."""
    return np.array([[e[0], e[2] / 2], [e[2] / 2, e[1]]])


def positions(c: Array, Q: Array, e: Array, xi: Array) -> Array:
    """Return the points of the block, (n, 2) [m]."""
    placed: Array = c + (xi + xi @ strain_matrix(e)) @ Q.T
    return placed


def directions(spin: Array, stretch: Array, e: Array, xi: Array) -> Array:
    """Return B of n points, (2n, 6), the rows of y before those of x.

    Parameters
    ----------
    spin, stretch
        The matrices that stand for dQ/dr and Q.
    e
        Strain with which the points turn.
    """
    n = len(xi)
    B = np.zeros((2 * n, 6))
    B[:n, 1] = B[n:, 0] = 1.0
    turning = (xi + xi @ strain_matrix(e)) @ spin.T
    x, y = xi[:, 0], xi[:, 1]
    for rows, axis in ((slice(0, n), 1), (slice(n, None), 0)):
        a, b = stretch[axis].tolist()
        B[rows, 2] = turning[:, axis]
        B[rows, 3], B[rows, 4], B[rows, 5] = a * x, b * y, (a / 2) * y + (b / 2) * x
    return B


@dataclass(frozen=True, eq=False)
class Body:
    """Outline and matrices of a block in the frame of its base."""

    xi: Array  # (n, 2) outline about its centroid [m]; the base edge runs along +x
    centroid: Array  # (2,) above the start of the base edge [m]
    tangent: Array  # (2,) base edge in the axes of the block's own coordinates
    M: Array  # (6, 6) inertia
    K: Array  # (3, 3) elastic stiffness of (ex, ey, gxy) [N m]
    base: tuple[int, int]  # corners M and N

    @property
    def size(self) -> float:
        """Greatest distance of a corner from the centroid [m]."""
        return float(np.sqrt(np.max(np.sum(self.xi**2, axis=1))))

    @property
    def to_base(self) -> Array:
        """Components along and across the base from those of the block's coordinates, (2, 2)."""
        tx, ty = self.tangent
        return np.array([[tx, ty], [-ty, tx]])

    def grown(self, Q: Array) -> tuple[Array, Array]:
        """Return M and K of an outline whose area has grown by det Q, of the same density and moduli."""
        growth = float(Q[0, 0] * Q[1, 1] - Q[0, 1] * Q[1, 0])
        M = self.M * growth
        M[2:, 2:] *= growth
        return M, growth * self.K


def body(block: Block, base: int) -> Body:
    """Return outline and matrices of a block in the frame of its base edge.

    Raises
    ------
    ValueError
        If the outline is not convex.
    """
    tangent, normal, _ = base_directions(block, base)
    frame = np.array([tangent, normal])
    start = block.edge(base)[0]
    placed = Block((block.corners - start) @ frame.T, block.material)
    edges = np.roll(placed.corners, -1, axis=0) - placed.corners
    following = np.roll(edges, -1, axis=0)
    if np.any(edges[:, 0] * following[:, 1] - edges[:, 1] * following[:, 0] < 0):
        raise ValueError(
            f"vertices: must be those of a convex polygon to roll over a plane, got {block.corners.tolist()}"
        )
    c = np.array(placed.section.centroid)
    ends = base, (base + 1) % len(placed.corners)
    return Body(placed.corners - c, c, tangent, placed.mass(), placed.elastic()[3:, 3:], ends)
