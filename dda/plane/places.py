r"""Where contacts are: a corner of one block on an edge of another, or two points of edges that are glued.

The gap of a contact is y = n . (x_i - x_j), x_i the corner, x_j any point of the edge, n the outward normal of the edge
as the block turned and strained it; its way along the edge is t . (x_i - x_j), t = (n_y, -n_x), of the point of the
edge that lies under the corner when a step begins. Both change in a step by exactly B D (`dda.plane.bodies`): with the
angle psi of the edge and means of start and end marked by a bar,

    (n . d)1 - (n . d)0 = n' . (d1 - d0) + (n1 - n0) . d',       n1 - n0 = sin(dpsi/2)/(dpsi/2) W n(psi/2) dpsi.

So openings are carried as increments, and no force is the small difference of two places.

Forces act in the directions (2 delta - 1) B + (2 - 2 delta) B_1, B_1 the derivative at the end of the step, as in
`dda.bodies.turning_step`: average acceleration stays of second order, and at delta = 1 contact does not gain energy.
"""

from __future__ import annotations

import math
from typing import Any, NamedTuple

from dda.contact.dense import Matrix, Vector
from dda.contact.rows import Rows
from dda.march.step import Length
from dda.plane.bodies import Blocks, Points, Poses, by_modes, direction, moved, point, row_times, strained, stretched

AT_END = 1e-9  # of an edge's length, by which a corner may lie beyond its end


class Places(NamedTuple):
    """Which points are in contact, and where they are when a stage begins."""

    count: Any  # (2,) how many there are, and how many of these are stated
    law: Any  # (c,) number of its springs
    sides: Any  # (c, 2) blocks: that of the corner, and that of the edge
    bonded: Any  # (c,) 1 of two points that are glued
    at: Points  # (c,) the corner, from the centroid of its block, unstrained
    start: Points  # (c,) where the edge starts, from the centroid of its block
    side: Points  # (c,) from there to its end
    foot: Points  # (c,) point of the edge under the corner
    normal: Points  # (c,) of the edge
    gap: Vector  # (c,) when the stage begins, by the places of the blocks [m]
    over: Any  # (c,) whether the corner is over the edge
    B: Any  # (2c, 2, 6) what the modes of either block add to a row
    F: Any  # (2c, 2, 6) what a unit force of a row does to them
    driven: Vector  # (2c,) what driven blocks add to a row [m]
    row: Matrix  # (2, 6) room for a row over D: of the chord and of the force


def place_contacts(blocks: Blocks, q: Matrix, ends: Poses, places: Places) -> None:
    """Write feet, normals and gaps of contacts for where the blocks are."""
    for k in range(places.count[0]):
        i = places.sides[k][0]
        j = places.sides[k][1]
        along = point(ends, j, places.side[k])
        length = abs(along)
        normal = complex(along.imag / length, -along.real / length)
        places.normal[k] = normal
        if places.bonded[k] == 1:
            continue
        apart = blocks.centroid[i] - blocks.centroid[j] + complex(q[i][0] - q[j][0], q[i][1] - q[j][1])
        apart += point(ends, i, places.at[k]) - point(ends, j, places.start[k])
        share = (along.conjugate() * apart).real / (length * length)
        places.foot[k] = places.start[k] + share * places.side[k]
        places.gap[k] = (normal.conjugate() * apart).real
        places.over[k] = 1 if -AT_END <= share <= 1 + AT_END else 0


def write_rows(
    blocks: Blocks, D: Matrix, chords: Poses, ends: Poses, before: Rows, late: float, places: Places
) -> None:
    """Write what the modes add to the rows of all contacts in a step by D, and what forces do to these.

    Parameters
    ----------
    late
        Weight of the directions at the end of a step in those of the forces.
    """
    n = places.count[0]
    chord = places.row[0]
    force = places.row[1]
    for k in range(n):
        i = places.sides[k][0]
        j = places.sides[k][1]
        side = places.side[k]
        # the edge as it is strained, in the axes of its block, in the middle of the step and at its end
        middle = strained(chords, j, side)
        psi = D[j][2]
        has_strains = blocks.modes[j] > 3
        if has_strains:  # |t0| |t1| is |middle|^2 but for the square of a strain's increment
            crossed = middle.conjugate() * stretched(D[j], 3, side)
            psi += crossed.imag / square(middle)
        half = psi / 2
        half_turn = complex(math.cos(half), math.sin(half))
        spin = half_turn.imag / half if half != 0 else 1.0
        normal = half_turn * places.normal[k]
        end_normal = half_turn * normal
        # the corner from its foot
        stretch = before.opening[n + k] if places.bonded[k] == 1 else 0.0
        apart = places.normal[k] * complex(before.opening[k], -stretch)
        way = moved(chords, i, D[i], places.at[k]) - moved(chords, j, D[j], places.foot[k])
        mean = complex(apart.real + way.real / 2, apart.imag + way.imag / 2)
        apart += way
        for axis in range(2):
            r = k if axis == 0 else n + k
            places.driven[r] = 0.0
            for own in range(2):
                block = places.sides[k][own]
                place = places.at[k] if own == 0 else places.foot[k]
                sign = 1.0 if own == 0 else -1.0
                is_driven = blocks.motion[block] >= 0
                if not is_driven and blocks.modes[block] == 0:
                    continue
                scale = sign * half_turn.real
                direction(chords, block, complex(scale * normal.real, scale * normal.imag), place, chord)
                if own == 1:
                    turn_with(chord, spin * (normal.conjugate() * mean).imag, has_strains, middle, side)
                if is_driven:
                    places.driven[r] += chord[0] * D[block][0] + chord[1] * D[block][1]
                if late != 0:
                    direction(ends, block, complex(sign * end_normal.real, sign * end_normal.imag), place, force)
                    if own == 1:
                        turned = (end_normal.conjugate() * apart).imag
                        turn_with(force, turned, has_strains, strained(ends, j, side), side)
                for m in range(6):
                    force[m] = (1 - late) * chord[m] + (late * force[m] if late != 0 else 0.0)
                by_modes(blocks, block, chords, chord, False, places.B[r][own])
                by_modes(blocks, block, chords, force, True, places.F[r][own])
            normal = complex(normal.imag, -normal.real)  # the direction along the edge
            end_normal = complex(end_normal.imag, -end_normal.real)


def contact_displacement(x: Vector, blocks: Blocks, places: Places, r: int) -> float:
    """Return B x of a row [m]."""
    n = places.count[0]
    k = r if r < n else r - n
    total = 0.0
    for side in range(2):
        i = places.sides[k][side]
        total += row_times(places.B[r][side], x, blocks.first[i], blocks.modes[i])
    return total


def push_contacts(blocks: Blocks, places: Places, force: Vector, out: Vector) -> None:
    """Add F' lambda to the forces on the modes."""
    n = places.count[0]
    for r in range(2 * n):
        if force[r] == 0.0:
            continue
        k = r if r < n else r - n
        for side in range(2):
            i = places.sides[k][side]
            first = blocks.first[i]
            F = places.F[r][side]
            for e in range(blocks.modes[i]):
                out[first + e] += F[e] * force[r]


def flexibility_of(blocks: Blocks, places: Places, length: Length, r: int, s: int) -> float:
    """Return what a unit force of a row s adds to the opening of a row r, weight B s^-1 F', by the blocks of both."""
    n = places.count[0]
    of = places.sides[r if r < n else r - n]
    by = places.sides[s if s < n else s - n]
    total = 0.0
    for side in range(2):
        i = of[side]
        first = blocks.first[i]
        for opposite in range(2):
            if by[opposite] == i:
                B = places.B[r][side]
                F = places.F[s][opposite]
                shared = 0.0
                for e in range(blocks.modes[i]):
                    shared += B[e] * length.inverse[first + e] * F[e]
                total += length.numbers[3] * shared
    return total


def square(z: complex) -> float:
    """Return |z|^2."""
    return z.real * z.real + z.imag * z.imag


def turn_with(row: Vector, turned: float, has_strains: bool, strained_side: complex, side: complex) -> None:
    """Add what the turn of the edge, by rotation and by strain, adds to a row."""
    row[2] += turned
    if has_strains:
        across = square(strained_side)
        row[3] -= turned * strained_side.imag * side.real / across
        row[4] += turned * strained_side.real * side.imag / across
        row[5] += turned * (strained_side.real * side.real - strained_side.imag * side.imag) / (2 * across)
