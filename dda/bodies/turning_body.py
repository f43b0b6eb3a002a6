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
from typing import Any, NamedTuple

import numpy as np

from dda.bodies.gap_form import free_block
from dda.contact.dense import Matrix, Vector
from dda.contact.springs import base_axes
from dda.model.arrays import Array
from dda.model.block import Block

EXACT = "exact"
FIRST_ORDER = "first-order"


def turned(angle: float) -> Array:
    """Return R of an angle [rad]."""
    return np.array([[math.cos(angle), -math.sin(angle)], [math.sin(angle), math.cos(angle)]])


class Turn(NamedTuple):
    """What a step does to Q."""

    end: Matrix  # Q1
    chord: Matrix  # (Q1 - Q0) / r
    mean: Matrix  # (Q1 + Q0) / 2


def turned_by(Q: Matrix, a: float, b: float, out: Matrix) -> None:
    """Write (a + b W) Q."""
    for j in range(2):
        out[0][j] = a * Q[0][j] - b * Q[1][j]
        out[1][j] = b * Q[0][j] + a * Q[1][j]


def turn(Q: Matrix, r: float, exact: bool, out: Turn) -> None:
    """Write the turn of a step by r [rad], exact or of first order."""
    if not math.isfinite(r):
        r = math.nan
    if not exact:
        turned_by(Q, 0.0, 1.0, out.chord)
        turned_by(Q, 1.0, r, out.end)
        turned_by(Q, 1.0, r / 2, out.mean)
        return
    sine = math.sin(r / 2)
    cosine = math.cos(r / 2)
    half = sine / (r / 2) if r != 0 else 1.0
    turned_by(Q, 1.0 - 2 * sine * sine, 2 * sine * cosine, out.end)
    turned_by(Q, -half * sine, half * cosine, out.chord)  # (R - I) / r = half W R(r/2)
    for i in range(2):
        for j in range(2):
            out.mean[i][j] = (out.end[i][j] + Q[i][j]) / 2


def strained(q: Vector, x: Any, y: Any) -> tuple[Any, Any]:
    """Return (I + E) xi of a point of the unstrained outline."""
    return x + (x * q[3] + y * q[5] / 2), y + (x * q[5] / 2 + y * q[4])


def place(q: Vector, Q: Matrix, x: Any, y: Any) -> tuple[Any, Any]:
    """Return where a point of the unstrained outline is, or several are, for the unknowns q = (c, r, e) [m]."""
    across, up = strained(q, x, y)
    return q[0] + (across * Q[0][0] + up * Q[0][1]), q[1] + (across * Q[1][0] + up * Q[1][1])


def directions(spin: Matrix, stretch: Matrix, q: Vector, x: float, y: float, across: Vector, up: Vector) -> None:
    """Write B of a point of the unstrained outline, its rows of x and of y.

    Parameters
    ----------
    spin, stretch
        The matrices that stand for dQ/dr and Q.
    q
        Unknowns with whose strain the point turns.
    """
    turning_x, turning_y = strained(q, x, y)
    for axis in range(2):
        row = across if axis == 0 else up
        row[0] = 1.0 - axis
        row[1] = 0.0 + axis
        row[2] = turning_x * spin[axis][0] + turning_y * spin[axis][1]
        row[3] = stretch[axis][0] * x
        row[4] = stretch[axis][1] * y
        row[5] = stretch[axis][0] / 2 * y + stretch[axis][1] / 2 * x


class RollingMotion(NamedTuple):
    """Where a block is at some instants."""

    c: Array  # (k, 2) centroid [m]
    r: Array  # (k,) sum of the steps' rotations [rad]
    e: Array  # (k, 3) strains in axes that turn with the block
    V: Array  # (k, 6) velocities of c, r, e
    Q: Array  # (k, 2, 2) turn of the outline

    def points(self, xi: Array) -> Array:
        """Return points of the unstrained outline where they are, (k, points, 2) [m]."""
        q = np.column_stack([self.c, self.r, self.e]).T[:, :, None]
        return np.stack(place(q, self.Q.transpose(1, 2, 0)[:, :, :, None], *xi.T), axis=-1)


def motion_of(rows: Array) -> RollingMotion:
    """Return the motion of rows that hold q, V and Q."""
    return RollingMotion(rows[:, :2], rows[:, 2], rows[:, 3:6], rows[:, 6:12], rows[:, 12:].reshape(-1, 2, 2))


def strain_matrices(e: Array) -> Array:
    """Return E of (ex, ey, gxy), (k, 2, 2)."""
    return np.array([[e[:, 0], e[:, 2] / 2], [e[:, 2] / 2, e[:, 1]]]).transpose(2, 0, 1)


@dataclass(frozen=True, eq=False)
class Body:
    """Outline and matrices of a block in the frame of its base."""

    xi: Array  # (n, 2) outline about its centroid [m]; the base edge runs along +x
    centroid: Array  # (2,) above the start of the base edge [m]
    to_base: Array  # (2, 2) components along and away from the base, from those of the block's coordinates
    M: Array  # (6, 6) inertia
    K: Array  # (3, 3) elastic stiffness of (ex, ey, gxy) [N m]
    base: tuple[int, int]  # corners M and N
    k: Array  # (6,) squares of the frequencies of its free modes [1/s^2]; 0 of rigid motions
    shapes: Array  # (6, 6) unknowns (c, r, ex, ey, gxy) of each, one column a mode, of unit inertia


def body(block: Block, base: int) -> Body:
    """Return outline and matrices of a block in the frame of its base edge.

    Raises
    ------
    ValueError
        If the outline is not convex.
    """
    frame = base_axes(block, base)
    start = block.edge(base)[0]
    placed = Block((block.corners - start) @ frame.T, block.material)
    if np.any(placed.turns < 0):
        raise ValueError(
            f"vertices: must be those of a convex polygon to roll over a plane, got {block.corners.tolist()}"
        )
    c = np.array(placed.section.centroid)
    ends = base, (base + 1) % len(placed.corners)
    M = placed.mass()
    return Body(placed.corners - c, c, frame, M, placed.elastic()[3:, 3:], ends, *free_block(M, placed))
