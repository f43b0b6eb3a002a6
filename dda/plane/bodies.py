r"""Blocks in the plane that turn by any angle: their modes, and where a step brings their points.

With the centroid c, the angle r and the strain E = (ex, gxy/2; gxy/2, ey) in axes that turn with the block, the point
xi of the unstrained outline (from its centroid) lies at x = c + Q U xi, Q = Q(r) the turn and U = I + E. With the
second moments S of the outline, times the density, and W a quarter turn, the kinetic energy is

    T = m |c'|^2 / 2 + J r'^2 / 2 + r' (gamma e') + e' M e' / 2,
    J = tr(U S U),    gamma_i = tr(W U S E_i),    M_ij = tr(S E_i E_j),

E_i the unit strains. So the angular momentum H = J r' + gamma e' changes by the moments of forces alone, and the
strains obey, with j_i = tr(S E_i) and G_ki = tr(W E_k S E_i),

    M e'' + K e + r'' gamma + 2 r' G' e' - r'^2 (j + M e) = forces.

The last term is the centrifugal one. What carries a block is therefore not r' but H: its modes are those of the block
at rest and unstrained (inertia one, k = 0 of the rigid motions), the third one of the velocity H / sqrt(J0), and what
the strained block adds to the equations of the strain modes is a force, `inertia_forces`. A step moves

    r by  (sqrt(J0) dz - gamma de) / J  in the strain of its middle,

so that momentum and angular momentum are kept to rounding, and a block that spins has its exact mean strain.

Points and vectors are complex numbers x + i y: a turn is a product, conj(a) b is a . b + i (a x b).

A point moves by exactly B D of the increments D = (c, r, ex, ey, gxy) of a step, with the chord B of the step,

    B = ( I,  (Q1 - Q0)/dr U' xi,  (Q1 + Q0)/2 E_k xi ),     U' the mean of the ends.
"""

from __future__ import annotations

import math
from typing import Any, NamedTuple

import numpy as np

from dda.bodies.gap_form import free_block
from dda.contact.dense import Matrix, Vector
from dda.model.arrays import Array
from dda.model.block import Block

STRAINS = np.array([[[1.0, 0.0], [0.0, 0.0]], [[0.0, 0.0], [0.0, 1.0]], [[0.0, 0.5], [0.5, 0.0]]])  # E of unit strains
QUARTER_TURN = np.array([[0.0, -1.0], [1.0, 0.0]])
Points = Any  # (n,) complex numbers x + i y [m], an array or a list
RIGID = 3  # modes of a rigid block; a fixed one has none, a strained one three more


class Blocks(NamedTuple):
    """Constant numbers of all blocks."""

    first: Any  # (b,) first mode of each: the centroid's two, that of H, those of the strains
    modes: Any  # (b,) how many it has
    root_mass: Vector  # (b,) sqrt(m); of a fixed block one
    root_inertia: Vector  # (b,) sqrt(J0)
    j: Matrix  # (b, 3)
    M: Any  # (b, 3, 3) inertia of the strains
    gamma: Matrix  # (b, 3) gamma of the unstrained block
    G: Any  # (b, 3, 3)
    shapes: Any  # (b, 3, 3) strains by strain modes
    centroid: Points  # (b,) at t = 0
    motion: Any  # (b,) column of what is prescribed that has its displacement in x, -1 of one that is not driven
    start: Any  # (b + 1,) first corner of each
    xi: Points  # (corners,) from the centroid, unstrained


class Poses(NamedTuple):
    """Of every block, what makes the directions in which its points move: of the chord of a step, or of its end."""

    turn: Points  # (b,) exp(i r) of the angle in the middle of the step, or at its end
    spin: Vector  # (b,) |dQ/dr|: sin(dr/2) / (dr/2) of the chord, one of the end
    stretch: Vector  # (b,) cos(dr/2) of the chord, one of the end
    e: Matrix  # (b, 3) strains
    J: Vector  # (b,)
    gamma: Matrix  # (b, 3)


def blocks_of(outlines: list[Block], rigid: list[bool], fixed: list[bool], motion: list[int]) -> tuple[Blocks, Array]:
    """Return the numbers of blocks, and the squares of the frequencies of all modes."""
    b = len(outlines)
    modes = np.array([0 if held else RIGID if stiff else 2 * RIGID for held, stiff in zip(fixed, rigid, strict=True)])
    corners = [len(block.corners) for block in outlines]
    root_mass, root_inertia = np.ones((2, b))
    j, gamma = np.zeros((2, b, 3))
    M, G, shapes = np.zeros((3, b, 3, 3))
    k: list[Array] = []
    for i, block in enumerate(outlines):
        if modes[i] == 0:
            continue
        inertia = block.mass()
        root_mass[i] = np.sqrt(inertia[0, 0])
        root_inertia[i] = np.sqrt(inertia[2, 2])
        k.append(np.zeros(RIGID))
        if modes[i] == RIGID:
            continue
        natural, unknowns = free_block(inertia, block)  # strains come first there
        shapes[i] = unknowns[3:, :3]
        k.append(natural[:3])
        section = block.section
        S = block.material.density * np.array([[section.s1, section.s3], [section.s3, section.s2]])
        M[i] = inertia[3:, 3:]
        gamma[i] = inertia[2, 3:]
        j[i] = np.einsum("ab,iba->i", S, STRAINS)
        G[i] = np.einsum("ab,kbc,cd,ida->ki", QUARTER_TURN, STRAINS, S, STRAINS)
    return Blocks(
        first=np.cumsum(modes) - modes,
        modes=modes,
        root_mass=root_mass,
        root_inertia=root_inertia,
        j=j,
        M=M,
        gamma=gamma,
        G=G,
        shapes=shapes,
        centroid=as_complex([block.section.centroid for block in outlines]),
        motion=np.array(motion, dtype=np.int64),
        start=np.cumsum([0, *corners]),
        xi=as_complex(np.vstack([block.corners - block.section.centroid for block in outlines])),
    ), np.concatenate(k)


def as_complex(points: Any) -> Points:
    """Return points (n, 2) as complex numbers."""
    x, y = np.asarray(points, dtype=float).reshape(-1, 2).T
    return x + 1j * y


def poses_of(blocks: int) -> Poses:
    """Return room for the poses of blocks."""
    spin, stretch, J = np.ones((3, blocks))
    return Poses(spin + 0j, spin, stretch, np.zeros((blocks, 3)), J, np.zeros((blocks, 3)))


# ---- inertia of a strained block ----


def row_times(row: Vector, x: Vector, first: int, n: int) -> float:
    """Return the sum of the first n products of a row and a part of a vector."""
    total = 0.0
    for e in range(n):
        total += row[e] * x[first + e]
    return total


def inertia_of(blocks: Blocks, i: int, e: Vector, poses: Poses) -> None:
    """Write J and gamma of a block with strains e."""
    poses.J[i] = blocks.root_inertia[i] * blocks.root_inertia[i]
    for k in range(3):
        poses.J[i] += (2 * blocks.j[i][k] + row_times(blocks.M[i][k], e, 0, 3)) * e[k]
        poses.gamma[i][k] = blocks.gamma[i][k]
        for m in range(3):
            poses.gamma[i][k] += e[m] * blocks.G[i][m][k]


def inertia_forces(
    blocks: Blocks, i: int, p: Vector, a: Vector, step: float, poses: Poses, spin: Vector, out: Vector
) -> float:
    """Add what a strained block adds to the equations of its strain modes; write (r', e') into `spin`.

    Returns its kinetic energy less that of the modes alone, p' p / 2 [J]. p and a are dt v and dt^2 a of all modes, the
    poses have strains, J and gamma of the instant.
    """
    first = blocks.first[i]
    root = blocks.root_inertia[i]
    J = poses.J[i]
    turning = 0.0  # gamma e'' less what the modes have of it
    carried = 0.0
    moving = 0.0
    unstrained = 0.0
    for k in range(3):
        spin[1 + k] = row_times(blocks.shapes[i][k], p, first + 3, 3) / step
        faster = row_times(blocks.shapes[i][k], a, first + 3, 3) / (step * step)
        turning += poses.gamma[i][k] * faster
        carried += blocks.gamma[i][k] * faster
        moving += poses.gamma[i][k] * spin[1 + k]
        unstrained += blocks.gamma[i][k] * spin[1 + k]
    H = root * p[first + 2] / step
    omega = (H - moving) / J
    spin[0] = omega
    growth = 0.0
    for k in range(3):
        growth += 2 * pull_of(blocks, i, k, poses.e[i]) * spin[1 + k]
    for k in range(3):
        force = poses.gamma[i][k] * (turning + growth * omega) / J - blocks.gamma[i][k] * carried / (root * root)
        force += omega * omega * pull_of(blocks, i, k, poses.e[i])
        for m in range(3):
            force -= 2 * omega * blocks.G[i][m][k] * spin[1 + m]
        for m in range(3):
            out[first + 3 + m] += blocks.shapes[i][k][m] * force
    excess: float = ((H * H - moving * moving) / J - (H * H - unstrained * unstrained) / (root * root)) / 2
    return excess


def pull_of(blocks: Blocks, i: int, k: int, e: Vector) -> float:
    """Return j + M e, the centrifugal force on a strain over r'^2."""
    pull: float = blocks.j[i][k] + row_times(blocks.M[i][k], e, 0, 3)
    return pull


# ---- where a step goes ----


def increments(blocks: Blocks, q: Matrix, x: Vector, chords: Poses, out: Matrix) -> None:
    """Write the increments D of all blocks that move, for increments of the modes, and J and gamma of the middle."""
    for i in range(len(blocks.root_mass)):
        first = blocks.first[i]
        modes = blocks.modes[i]
        if modes == 0:
            continue
        D = out[i]
        root = blocks.root_inertia[i]
        for axis in range(2):
            D[axis] = x[first + axis] / blocks.root_mass[i]
        D[2] = x[first + 2] / root
        if modes == RIGID:
            continue
        for k in range(3):
            D[3 + k] = row_times(blocks.shapes[i][k], x, first + 3, 3)
            chords.e[i][k] = q[i][3 + k] + D[3 + k] / 2
        inertia_of(blocks, i, chords.e[i], chords)
        D[2] = (root * x[first + 2] - row_times(chords.gamma[i], D, 3, 3)) / chords.J[i]


def set_poses(blocks: Blocks, q: Matrix, D: Matrix, chords: Poses, ends: Poses) -> None:
    """Write the poses of the chords and of the ends of a step by D; J and gamma of the chords are there."""
    for i in range(len(blocks.root_mass)):
        half = D[i][2] / 2
        if not math.isfinite(half):
            half = math.nan
        middle = q[i][2] + half
        end = q[i][2] + D[i][2] if math.isfinite(half) else half
        chords.turn[i] = complex(math.cos(middle), math.sin(middle))
        chords.spin[i] = math.sin(half) / half if half != 0 else 1.0
        chords.stretch[i] = math.cos(half)
        ends.turn[i] = complex(math.cos(end), math.sin(end))
        if blocks.modes[i] > RIGID:
            for k in range(3):
                ends.e[i][k] = q[i][3 + k] + D[i][3 + k]
            inertia_of(blocks, i, ends.e[i], ends)


def stretched(e: Vector, first: int, z: complex) -> complex:
    """Return E z of the strains that begin at a place of a vector [m]."""
    half = e[first + 2] / 2
    return complex(e[first] * z.real + half * z.imag, half * z.real + e[first + 1] * z.imag)


def strained(poses: Poses, i: int, z: complex) -> complex:
    """Return U z of a block, in its axes [m]."""
    return z + stretched(poses.e[i], 0, z)


def point(poses: Poses, i: int, z: complex) -> complex:
    """Return where a point of a block is from its centroid, for the poses of an end [m]."""
    turned: complex = poses.turn[i] * strained(poses, i, z)
    return turned


def place_of(blocks: Blocks, q: Matrix, D: Matrix, ends: Poses, i: int, z: complex) -> complex:
    """Return where a point of a block is after increments D, for the poses there [m]."""
    centroid: complex = blocks.centroid[i] + complex(q[i][0] + D[i][0], q[i][1] + D[i][1])
    return centroid + point(ends, i, z)


def moved(poses: Poses, i: int, D: Vector, z: complex) -> complex:
    """Return how far a step by D moves a point, for the poses of its chord [m]."""
    turn = poses.spin[i] * D[2]
    stretch = poses.stretch[i]
    U = strained(poses, i, z)
    dU = stretched(D, 3, z)
    way: complex = poses.turn[i] * complex(stretch * dU.real - turn * U.imag, stretch * dU.imag + turn * U.real)
    return complex(D[0], D[1]) + way


def direction(poses: Poses, i: int, a: complex, z: complex, out: Vector) -> None:
    """Write a . dx/dD of a point, for a direction a in space."""
    own = poses.turn[i].conjugate() * a  # in the axes of the block
    stretch = poses.stretch[i]
    out[0] = a.real
    out[1] = a.imag
    out[2] = poses.spin[i] * (strained(poses, i, z).conjugate() * own).imag
    out[3] = stretch * own.real * z.real
    out[4] = stretch * own.imag * z.imag
    out[5] = stretch * (own.real * z.imag + own.imag * z.real) / 2


def by_modes(blocks: Blocks, i: int, poses: Poses, row: Vector, force: bool, out: Vector) -> None:
    """Write a row over D as one over the modes of a block: of what its modes move, or as that of a force."""
    modes = blocks.modes[i]
    if modes == 0:
        return
    root = blocks.root_inertia[i]
    out[0] = row[0] / blocks.root_mass[i]
    out[1] = row[1] / blocks.root_mass[i]
    if modes == RIGID:
        out[2] = row[2] / root
        return
    J = poses.J[i]
    out[2] = row[2] / root if force else row[2] * root / J
    for m in range(3):
        total = 0.0
        for k in range(3):
            total += blocks.shapes[i][k][m] * (row[3 + k] - row[2] * poses.gamma[i][k] / J)
        out[3 + m] = total
