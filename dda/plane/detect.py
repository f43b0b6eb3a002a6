r"""Which corners may touch which edges in a step, and from which contacts of the step before they go on.

Two convex parts are apart while one edge of either has the other part in front of it. Of all their edges one is taken,
by the first of these rules that holds:

a. the edge through which they are really pressed, however deep, as long as its corner lies over it;
b. of the edges at which they touch, that which the step without contact leaves farthest in front;
c. of the edges that have the other part in front, that which this step crosses last: through it they come to touch;
d. where none has, the one with the least penetration.

(The least penetration alone pushes a corner that came in beside a corner out through the wrong edge, with energy from
nowhere. The edge crossed last alone stops a corner that slides over a seam at the side of the next block.)

At that edge the other part's lowest corner is a contact if it lies over the edge; and, where the edge that this corner
belongs to is nearly parallel, the other end of it and those ends of the first edge that lie strictly inside. So of
corners that coincide one is taken. Cuts of a polygon that is not convex carry no contact, but tell when the other
part came in through another part of the block.

The functions take arrays of records, compiled, or lists of objects with the same attributes, in plain Python.
"""

from __future__ import annotations

from typing import Any

import numpy as np

REACH = 0.02  # of the size of the smallest block, within which contacts are kept
SAME = 1e-9  # of that size: what rounding leaves of a touch
SOFT = 1e-4  # of that size: what the springs of parts that touch at an edge may give
NEAR = 1e-3  # of that size, within which a contact inherits from one of other features
DEEP = 0.25  # of that size: a corner that is pressed deeper has lost its block
PARALLEL = -0.95  # cosine between opposite edges (18 degrees), above which one corner alone may touch
CROSSED_EARLIER = 1e-6  # of a step, by which a cut must be crossed later than every edge
NONE = -1
TOO_MANY = -2  # contacts, for the records that were given
TOO_DEEP = -3  # a corner lies deeper in a block than a step can have brought it

FOUND_CONTACT = np.dtype(
    [
        ("corner", np.int64),  # numbers among all corners
        ("edge", np.int64),
        ("share", float),  # of the edge, at which the corner's foot is
        ("gap", float),  # at the start of the step, along the edge's outward normal [m]
        ("law", np.int64),
        ("origin", np.int64),  # contact of the step before from which it goes on, -1: none
        ("same", np.int64),  # 1 where that is the same corner at the same edge
        ("normal", float),  # force, by the step [N]
        ("closed", np.int64),  # 1 where it is, by the step
        ("chain", np.int64),  # work: next contact of a list
        ("heir", np.int64),  # work: contact of the next step that goes on from it; one only, lest forces double
    ]
)


def find_contacts(
    corners: Any, sides: Any, parts: Any, blocks: Any, pairs: Any, previous: Any, known: int, contacts: Any, size: float
) -> int:
    """Write the contacts of a step; return how many there are, or TOO_MANY or TOO_DEEP.

    Parameters
    ----------
    corners, sides, parts
        Records of `dda.plane.polygons.outlines`, the corners at their places of this step.
    blocks
        Records with `moves`, 0 of those that cannot, and room for `head`.
    pairs
        Number of the law of two blocks i and j at i * blocks + j, -1 where no contact is looked for.
    previous, known
        Contacts of the step before, as it left them, and how many of the records are.
    contacts
        Records with the fields of `FOUND_CONTACT`, which are filled.
    size
        Length of the smallest block [m].
    """
    margin = REACH * size
    place_boxes(corners, sides, parts, margin / 2)
    along_x = sort_parts(parts, blocks)
    for block in range(len(blocks)):
        blocks[block].head = NONE
    for number in range(known - 1, -1, -1):
        old = previous[number]
        keeper = keeper_of(blocks, corners[old.corner].block, corners[old.edge].block)
        old.heir = NONE
        old.chain = blocks[keeper].head
        blocks[keeper].head = number
    for corner in range(len(corners)):
        corners[corner].found = NONE
    count = 0
    for place in range(len(parts)):
        p = parts[place].order
        for later in range(place + 1, len(parts)):
            r = parts[later].order
            if along_x:
                if parts[r].left > parts[p].right:
                    break
                apart = parts[r].low > parts[p].high or parts[p].low > parts[r].high
            else:
                if parts[r].low > parts[p].high:
                    break
                apart = parts[r].left > parts[p].right or parts[p].left > parts[r].right
            if apart or pairs[parts[p].block * len(blocks) + parts[r].block] == NONE:
                continue
            count = touch_parts(
                corners, sides, parts, blocks, min(p, r), max(p, r), pairs, previous, contacts, count, size
            )
            if count < 0:
                return count
    inherit(corners, blocks, previous, contacts, count, NEAR * size)
    return count


def keeper_of(blocks: Any, i: int, j: int) -> int:
    """Return that of two blocks whose list holds their contacts: one that moves, as a floor has very many."""
    if blocks[i].moves == 0:
        return j
    if blocks[j].moves == 0:
        return i
    return min(i, j)


def place_boxes(corners: Any, sides: Any, parts: Any, margin: float) -> None:
    """Write the boxes that hold the parts at both ends of the step, and a margin."""
    for number in range(len(parts)):
        part = parts[number]
        first = corners[sides[part.first].corner]
        left = first.x0
        right = first.x0
        low = first.y0
        high = first.y0
        for side in range(part.first, part.last):
            corner = corners[sides[side].corner]
            left = min(left, corner.x0, corner.x1)
            right = max(right, corner.x0, corner.x1)
            low = min(low, corner.y0, corner.y1)
            high = max(high, corner.y0, corner.y1)
        part.left = left - margin
        part.right = right + margin
        part.low = low - margin
        part.high = high + margin


def sort_parts(parts: Any, blocks: Any) -> bool:
    """Sort the parts along the axis on which those that move are spread more; return whether that is x."""
    left = np.inf
    right = -np.inf
    low = np.inf
    high = -np.inf
    for number in range(len(parts)):
        part = parts[number]
        if blocks[part.block].moves != 0:
            left = min(left, part.left)
            right = max(right, part.right)
            low = min(low, part.low)
            high = max(high, part.high)
    along_x = right - left >= high - low
    for number in range(1, len(parts)):  # nearly sorted from the step before
        p = parts[number].order
        start = parts[p].left if along_x else parts[p].low
        place = number - 1
        while place >= 0:
            r = parts[place].order
            if (parts[r].left if along_x else parts[r].low) <= start:
                break
            parts[place + 1].order = r
            place -= 1
        parts[place + 1].order = p
    return along_x


def touch_parts(
    corners: Any,
    sides: Any,
    parts: Any,
    blocks: Any,
    p: int,
    r: int,
    pairs: Any,
    previous: Any,
    contacts: Any,
    count: int,
    size: float,
) -> int:
    """Add the contacts of two convex parts; return how many contacts there are then, or TOO_MANY or TOO_DEEP."""
    same = SAME * size
    margin = REACH * size
    # a. the edge through which they are pressed; of several that with the greatest force
    i = parts[p].block
    j = parts[r].block
    kept = NONE
    greatest = 0.0
    deepest = margin
    number = blocks[keeper_of(blocks, i, j)].head
    while number >= 0:
        old = previous[number]
        number = old.chain
        block = corners[old.corner].block
        on = corners[old.edge].block
        if old.closed == 0 or not ((block == i and on == j) or (block == j and on == i)):
            continue
        deepest = DEEP * size  # they touched: what they have come to since, they were pressed to
        own = p if on == i else r
        opposite = r if on == i else p
        edge = side_from(sides, parts[own], old.edge)
        if edge < 0 or old.normal < greatest or side_from(sides, parts[opposite], old.corner) < 0:
            continue
        _, length, along, gap = foot(corners, old.corner, old.edge, sides[edge].end, False)
        if sides[edge].real != 0 and gap < -same and -same <= along <= length + same:
            kept = edge
            greatest = old.normal
    edge = NONE
    point = NONE
    best = -np.inf
    best_cut = -np.inf
    touching = NONE
    touching_point = NONE
    farthest = -np.inf
    for turn in range(2):
        own = p if turn == 0 else r
        opposite = r if turn == 0 else p
        for side in range(parts[own].first, parts[own].last):
            if kept >= 0 and side != kept:
                continue
            start, lowest, end, lowest_then = front(corners, sides, side, parts[opposite])
            if kept >= 0:
                edge = side
                point = lowest
                break
            if min(start, end) >= margin:
                return count
            if start <= same:
                key = start / size
            elif end < 0:
                key = 1 + start / (start - end)
            else:
                key = 2 + min(start, end) / size
            if sides[side].real == 0:
                best_cut = max(best_cut, key)
                continue
            nearest = lowest_then if end < start else lowest
            if -SOFT * size < start <= same and end > farthest + same:
                touching = side
                touching_point = nearest
                farthest = end
            if key > best + SAME:
                best = key
                edge = side
                point = nearest
    if touching >= 0:
        edge = touching
        point = touching_point
    elif edge < 0 or best_cut > best + CROSSED_EARLIER:
        return count
    # the other part's edge that is most opposite to this one
    before = sides[point].prior
    cosine = between(corners, sides, edge, point)
    cosine_before = between(corners, sides, edge, before)
    opposite_edge = point if cosine < cosine_before else before
    other_end = sides[point].after if opposite_edge == point else before
    parallel = min(cosine, cosine_before) < PARALLEL and sides[opposite_edge].real != 0
    law = pairs[i * len(blocks) + j]
    found = count
    for late in range(2):  # over the edge at the start of the step, or else at its end
        for attempt in range(4 if parallel else 1):  # the corner, its edge's other end, the ends of the edge it meets
            corner = point
            against = edge
            slack = same
            if attempt == 1:
                corner = other_end
            elif attempt > 1:
                corner = edge if attempt == 2 else sides[edge].after
                against = opposite_edge
                slack = -same
            number = sides[corner].corner
            first = sides[against].corner
            end_corner = sides[against].end
            share, length, along, gap = foot(corners, number, first, end_corner, False)
            _, length_then, along_then, gap_then = foot(corners, number, first, end_corner, True)
            if late == 1:
                length = length_then
                along = along_then
            if corners[number].convex == 0 or min(gap, gap_then) >= margin or not -slack <= along <= length + slack:
                continue
            if gap < -deepest:
                if attempt == 0 and late == 0:
                    return TOO_DEEP
                continue
            earlier = corners[number].found
            while earlier >= 0 and contacts[earlier].edge != first:
                earlier = contacts[earlier].chain
            if earlier >= 0:  # by another part of a block that is not convex
                continue
            if found >= len(contacts):
                return TOO_MANY
            contact = contacts[found]
            contact.corner = number
            contact.edge = first
            contact.share = min(max(share, 0.0), 1.0)
            contact.gap = gap
            contact.law = law
            contact.chain = corners[number].found
            corners[number].found = found
            found += 1
        if found > count:
            break
    return found


def side_from(sides: Any, part: Any, corner: int) -> int:
    """Return the side of a part that starts from a corner, -1 where there is none."""
    for side in range(part.first, part.last):
        if sides[side].corner == corner:
            return side
    return NONE


def front(corners: Any, sides: Any, side: int, part: Any) -> tuple[float, int, float, int]:
    """Return how far a part is in front of an edge, and its lowest side's number, at the start and at the end."""
    a = corners[sides[side].corner]
    b = corners[sides[side].end]
    tx = b.x0 - a.x0
    ty = b.y0 - a.y0
    ux = b.x1 - a.x1
    uy = b.y1 - a.y1
    start = np.inf
    end = np.inf
    lowest = part.first
    lowest_then = part.first
    for number in range(part.first, part.last):
        c = corners[sides[number].corner]
        gap = ty * (c.x0 - a.x0) - tx * (c.y0 - a.y0)
        if gap < start:
            start = gap
            lowest = number
        gap = uy * (c.x1 - a.x1) - ux * (c.y1 - a.y1)
        if gap < end:
            end = gap
            lowest_then = number
    return start / (tx * tx + ty * ty) ** 0.5, lowest, end / (ux * ux + uy * uy) ** 0.5, lowest_then


def foot(corners: Any, corner: int, start: int, end: int, late: bool) -> tuple[float, float, float, float]:
    """Return share, length and distance along an edge at which a corner is, and its gap, at an end of the step."""
    a = corners[start]
    b = corners[end]
    c = corners[corner]
    if late:
        tx = b.x1 - a.x1
        ty = b.y1 - a.y1
        x = c.x1 - a.x1
        y = c.y1 - a.y1
    else:
        tx = b.x0 - a.x0
        ty = b.y0 - a.y0
        x = c.x0 - a.x0
        y = c.y0 - a.y0
    length = (tx * tx + ty * ty) ** 0.5
    along = (tx * x + ty * y) / length
    return along / length, length, along, (ty * x - tx * y) / length


def between(corners: Any, sides: Any, first: int, second: int) -> float:
    """Return the cosine between two sides at the start of the step."""
    a = corners[sides[first].corner]
    b = corners[sides[first].end]
    c = corners[sides[second].corner]
    d = corners[sides[second].end]
    tx = b.x0 - a.x0
    ty = b.y0 - a.y0
    ux = d.x0 - c.x0
    uy = d.y0 - c.y0
    return float((tx * ux + ty * uy) / ((tx * tx + ty * ty) * (ux * ux + uy * uy)) ** 0.5)


def inherit(corners: Any, blocks: Any, previous: Any, contacts: Any, count: int, near: float) -> None:
    """Write from which contact of the step before each goes on: the same corner and edge, or else the same place."""
    for attempt in range(2):
        for number in range(count):
            contact = contacts[number]
            if attempt == 0:
                contact.origin = NONE
                contact.same = 0
            elif contact.same != 0:
                continue
            corner = corners[contact.corner]
            i = corner.block
            j = corners[contact.edge].block
            nearest = near
            candidate = blocks[keeper_of(blocks, i, j)].head
            while candidate >= 0:
                old = previous[candidate]
                place = corners[old.corner]
                if attempt == 0:
                    if old.corner == contact.corner and old.edge == contact.edge:
                        contact.origin = candidate
                        contact.same = 1
                elif old.closed != 0 and old.heir == NONE:
                    on = corners[old.edge].block
                    distance = ((place.x0 - corner.x0) ** 2 + (place.y0 - corner.y0) ** 2) ** 0.5
                    if min(place.block, on) == min(i, j) and max(place.block, on) == max(i, j) and distance < nearest:
                        nearest = distance
                        contact.origin = candidate
                candidate = old.chain
            if contact.origin >= 0:
                previous[contact.origin].heir = number
