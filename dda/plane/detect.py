r"""Which corners may touch which edges in a step, and from which contacts of the step before they go on.

Two convex parts are apart while one edge of either has the other part in front of it. Of all their edges one is taken,
by the first of these rules that holds:

a. the edge through which they are really pressed, however deep, as long as its corner lies over it;
b. of the edges at which they touch, that which the step without contact presses least, as they slide along it, unless
   nothing of the other part lies over it and another edge is crossed in this step;
c. of the edges that have the other part in front, that which this step crosses last: through it they come to touch;
d. where none has, the one with the least penetration.

(The least penetration alone pushes a corner that came in beside a corner out through the wrong edge, with energy from
nowhere. The edge crossed last alone stops a corner that slides over a seam at the side of the next block.)

At that edge the other part's lowest corner is a contact if it lies over the edge; and, where the edge that this corner
belongs to is nearly parallel, the other end of it and those ends of the first edge that lie strictly inside. So of
corners that coincide one is taken. Cuts of a polygon that is not convex, and corners into which it turns, carry none.

A corner that is behind that edge came there in the last step, or is as deep as springs let the two blocks be pressed.
One that is deeper than both together was inside before and nothing held it: the history ends by name.

Numbers of corners, sides and parts are those of `dda.plane.polygons`. All is written for arrays or lists, as
`dda.march.compiled` takes them.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Any, NamedTuple

import numpy as np

from dda.contact.dense import Vector, copy
from dda.contact.rows import INSIDE, TOO_DEEP, TOO_MANY
from dda.plane.bodies import Points
from dda.plane.polygons import Corners, Parts, Sides, outlines

REACH = 0.02  # of the size of the smallest block, within which contacts are kept
SAME = 1e-9  # of that size: what rounding leaves of a touch
SOFT = 1e-4  # of that size: what the springs of parts that touch at an edge may give, where they give no more now
PRESSED = 2.0  # times as deep as a block is pressed now it may be pressed where it comes to the next one
NEAR = 1e-3  # of that size, within which a contact inherits from one of other features
DEEP = 0.25  # of that size: a corner that is deeper has lost its block, even if a step brought it there
PARALLEL = -0.95  # cosine between opposite edges (18 degrees), above which one corner alone may touch
NONE = -1


class FoundContacts(NamedTuple):
    """Contacts of a step, (most,) each."""

    corner: Any  # numbers among all corners
    edge: Any
    gap: Vector  # at the start of the step, along the edge's outward normal [m]
    origin: Any  # contact of the step before from which it goes on, -1: none
    same: Any  # 1 where that is the same corner at the same edge
    normal: Vector  # force, as the step leaves it [N]
    closed: Any  # 1 where it is, as the step leaves it
    chain: Any  # work: next contact of a list
    heir: Any  # work: contact of the next step that goes on from it; one only, lest forces double


class Detection(NamedTuple):
    """What contacts are found among, and where they are written."""

    corners: Corners
    sides: Sides
    parts: Parts
    moves: Any  # (b,) 0 of blocks that cannot
    head: Any  # (b * b,) first contact of the step before of two blocks, NONE but while contacts are looked for
    spread: Vector  # (4,) work: where the parts that move begin, as a box
    depth: Vector  # (b,) work: how deep each is pressed into others, or these into it [m]
    before: Points  # (n,) where the corners were when the last step that was accepted began
    travel: Vector  # (b,) how far the corners of each moved in it, at most [m]
    law: Any  # (b * b,) number of the law of two blocks, -1 where no contact is looked for
    contacts: FoundContacts
    previous: FoundContacts
    count: Any  # (2,) how many contacts and previous ones there are
    size: float  # of the smallest block that moves [m]


def detection_of(polygons: Sequence[Points], moves: Any, law: Any, most: int, size: float) -> Detection:
    """Return what finds contacts of blocks with these corners, at most so many.

    The number of the law of two blocks, (b, b), is -1 where they are not looked at; if neither moves they are not.
    """
    movable = np.array(moves, dtype=np.int64)
    looked_at = np.where(np.logical_or.outer(movable, movable), law, NONE)
    np.fill_diagonal(looked_at, NONE)
    return Detection(
        *outlines(polygons),
        moves=movable,
        head=np.full(len(polygons) ** 2, NONE),
        spread=np.zeros(4),
        depth=np.zeros(len(polygons)),
        before=np.full(sum(map(len, polygons)), complex(math.inf)),
        travel=np.zeros(len(polygons)),
        law=looked_at.ravel(),
        contacts=found_contacts(most),
        previous=found_contacts(most),
        count=np.zeros(2, np.int64),
        size=size,
    )


def found_contacts(most: int) -> FoundContacts:
    """Return room for so many contacts."""
    numbers = ("gap", "normal")
    return FoundContacts(*(np.zeros(most, float if name in numbers else np.int64) for name in FoundContacts._fields))


def keep_contacts(detection: Detection, force: Vector, state: Any, stated: int) -> None:
    """Take the contacts of a step that was accepted for those of the step before.

    Force and state are those of the rows after it, of which so many stated contacts come first.
    """
    contacts = detection.contacts
    previous = detection.previous
    copy(detection.corners.now, detection.before)
    detection.count[1] = detection.count[0]
    for number in range(detection.count[0]):
        previous.corner[number] = contacts.corner[number]
        previous.edge[number] = contacts.edge[number]
        previous.normal[number] = force[stated + number]
        previous.closed[number] = 1 if state[stated + number] == INSIDE else 0


def find_contacts(detection: Detection) -> int:
    """Write the contacts of a step; return how many there are, or minus an outcome of `dda.contact.rows`.

    The corners are where the step begins, `now`, and where it would end without contact, `then`.
    """
    corners = detection.corners
    parts = detection.parts
    previous = detection.previous
    blocks = len(detection.moves)
    along = place_parts(detection)
    for block in range(blocks):
        detection.depth[block] = 0.0
        detection.travel[block] = 0.0
    for corner in range(len(corners.block)):
        block = corners.block[corner]
        distance = abs(corners.now[corner] - detection.before[corner])
        if distance == math.inf:  # before the first step
            distance = REACH * detection.size / 2
        detection.travel[block] = max(detection.travel[block], distance)
    for number in range(detection.count[1] - 1, -1, -1):
        corner = previous.corner[number]
        start = previous.edge[number]
        if previous.closed[number] != 0:
            _, _, gap = foot(corners.now, corner, start, corners.after[start])
            for block in (corners.block[corner], corners.block[start]):
                if detection.moves[block] != 0:
                    detection.depth[block] = max(detection.depth[block], 0.0 - gap)
        previous.heir[number] = NONE
        pair = pair_of(detection, corner, start)
        previous.chain[number] = detection.head[pair]
        detection.head[pair] = number
    detection.count[0] = 0
    for place in range(len(parts.order)):
        p = parts.order[place]
        box = parts.box[p]
        for later in range(place + 1, len(parts.order)):
            r = parts.order[later]
            other = parts.box[r]
            if other[2 * along] > box[2 * along + 1]:
                break
            across = 2 - 2 * along
            apart = other[across] > box[across + 1] or box[across] > other[across + 1]
            if apart or detection.law[parts.block[p] * blocks + parts.block[r]] == NONE:
                continue
            count = touch_parts(detection, min(p, r), max(p, r))
            if count < 0:
                return count
            detection.count[0] = count
    inherit(detection)
    for number in range(detection.count[1]):
        detection.head[pair_of(detection, previous.corner[number], previous.edge[number])] = NONE
    return int(detection.count[0])


def pair_of(detection: Detection, corner: int, other: int) -> int:
    """Return the number of the two blocks that have these corners, in either order."""
    i = detection.corners.block[corner]
    j = detection.corners.block[other]
    return int(min(i, j) * len(detection.moves) + max(i, j))


def place_parts(detection: Detection) -> int:
    """Write the boxes that hold the parts at both ends of the step, and sort them; return along which axis.

    It is that along which the parts that move are spread more.
    """
    corners = detection.corners
    sides = detection.sides
    parts = detection.parts
    margin = REACH * detection.size / 2
    for number in range(len(parts.order)):
        box = parts.box[number]
        clear_box(box)
        for side in range(parts.first[number], parts.last[number]):
            grow_box(box, corners.now[sides.corner[side]], margin)
            grow_box(box, corners.then[sides.corner[side]], margin)
    clear_box(detection.spread)
    for number in range(len(parts.order)):
        if detection.moves[parts.block[number]] != 0:
            grow_box(detection.spread, complex(parts.box[number][0], parts.box[number][2]), 0.0)
    along = 1 if detection.spread[3] - detection.spread[2] > detection.spread[1] - detection.spread[0] else 0
    for number in range(1, len(parts.order)):  # nearly sorted from the step before
        p = parts.order[number]
        place = number - 1
        while place >= 0 and parts.box[parts.order[place]][2 * along] > parts.box[p][2 * along]:
            parts.order[place + 1] = parts.order[place]
            place -= 1
        parts.order[place + 1] = p
    return along


def clear_box(box: Vector) -> None:
    """Take out all that a box holds."""
    for axis in range(2):
        box[2 * axis] = math.inf
        box[2 * axis + 1] = -math.inf


def grow_box(box: Vector, place: complex, margin: float) -> None:
    """Let a box hold a place too."""
    box[0] = min(box[0], place.real - margin)
    box[1] = max(box[1], place.real + margin)
    box[2] = min(box[2], place.imag - margin)
    box[3] = max(box[3], place.imag + margin)


def touch_parts(detection: Detection, p: int, r: int) -> int:
    """Add the contacts of two convex parts; return how many contacts there are then, or minus an outcome."""
    corners = detection.corners
    sides = detection.sides
    parts = detection.parts
    previous = detection.previous
    size = detection.size
    same = SAME * size
    margin = REACH * size
    i = parts.block[p]
    j = parts.block[r]
    pressed = max(SOFT * size, PRESSED * max(detection.depth[i], detection.depth[j]))
    soft = min(pressed, margin)
    deepest = min(pressed + detection.travel[i] + detection.travel[j], DEEP * size)
    # a. the edge through which they are pressed; of several that with the greatest force
    kept = NONE
    greatest = 0.0
    old = detection.head[pair_of(detection, sides.corner[parts.first[p]], sides.corner[parts.first[r]])]
    while old >= 0:
        number = previous.corner[old]
        start = previous.edge[old]
        on = corners.block[start]
        if previous.closed[old] != 0:
            edge = side_from(sides, parts, p if on == i else r, start)
            if edge >= 0 and sides.real[edge] != 0 and side_from(sides, parts, r if on == i else p, number) >= 0:
                end = sides.end[edge]
                length, along, gap = foot(corners.now, number, start, end)
                over = is_over(corners, start, end, length, along, same, margin)
                if previous.normal[old] >= greatest and gap < -same and over:
                    kept = edge
                    greatest = previous.normal[old]
        old = previous.chain[old]
    edge = NONE
    point = NONE
    best = -math.inf
    touching = NONE
    touching_point = NONE
    slowest = -math.inf
    for turn in range(2):
        part = p if turn == 0 else r
        opposite = r if turn == 0 else p
        for side in range(parts.first[part], parts.last[part]):
            if kept >= 0 and side != kept:
                continue
            before, lowest = front(corners.now, sides, parts, side, opposite)
            if kept >= 0:
                edge = side
                point = lowest
                break
            after, lowest_then = front(corners.then, sides, parts, side, opposite)
            if min(before, after) >= margin:
                return int(detection.count[0])
            if before <= same:
                key = before / size
            elif after < 0:
                key = 1 + before / (before - after)
            else:
                key = 2 + min(before, after) / size
            nearest = lowest_then if after < before else lowest
            if sides.real[side] == 0 or corners.convex[sides.corner[nearest]] == 0:
                continue  # what lies there is another part of one of the two blocks
            if -soft < before <= same and after - before > slowest + same:
                touching = side
                touching_point = nearest
                slowest = after - before
            if key > best + SAME:
                best = key
                edge = side
                point = nearest
    count = int(detection.count[0])
    for choice in range(2):
        chosen = touching if choice == 0 else edge
        # a corner that has left the edge at which they touch may cross another one in this very step
        if chosen < 0 or (choice == 1 and touching >= 0 and not 1 < best < 2):
            continue
        found = add_points(detection, p, r, chosen, touching_point if choice == 0 else point, deepest)
        if found != count:
            return found
    return count


def add_points(detection: Detection, p: int, r: int, edge: int, point: int, deepest: float) -> int:
    """Add the contacts of two parts at an edge; return how many contacts there are then, or minus an outcome.

    `edge` and `point` are sides: the edge's, and the one that starts from the other part's lowest corner; a corner may
    be `deepest` [m].
    """
    corners = detection.corners
    sides = detection.sides
    parts = detection.parts
    contacts = detection.contacts
    same = SAME * detection.size
    margin = REACH * detection.size
    # the other part's edge that is most opposite to this one
    prior = sides.prior[point]
    cosine = cosine_between(corners.now, sides, edge, point)
    cosine_prior = cosine_between(corners.now, sides, edge, prior)
    opposite_edge = point if cosine < cosine_prior else prior
    other_end = sides.after[point] if opposite_edge == point else prior
    parallel = min(cosine, cosine_prior) < PARALLEL and sides.real[opposite_edge] != 0
    count = int(detection.count[0])
    found = count
    for late in range(2):  # over the edge at the start of the step, or else at its end
        for attempt in range(4 if parallel else 1):  # the corner, its edge's other end, the ends of the edge it meets
            corner = sides.corner[point]
            against = edge
            slack = same
            if attempt == 1:
                corner = sides.corner[other_end]
            elif attempt > 1:
                corner = sides.corner[edge] if attempt == 2 else sides.end[edge]
                against = opposite_edge
                slack = -same
            start = sides.corner[against]
            end = sides.end[against]
            length, along, gap = foot(corners.now, corner, start, end)
            length_then, along_then, gap_then = foot(corners.then, corner, start, end)
            if late == 1:
                length = length_then
                along = along_then
            over = is_over(corners, start, end, length, along, slack, margin)
            if corners.convex[corner] == 0 or min(gap, gap_then) >= margin or not over:
                continue
            if gap < -deepest:
                if attempt == 0 and late == 0:
                    contacts.corner[0] = corner
                    contacts.edge[0] = start
                    contacts.gap[0] = gap
                    return -TOO_DEEP
                continue
            if (parts.alone[p] == 0 or parts.alone[r] == 0) and is_known(detection, found, corner, start):
                continue
            if found >= len(contacts.corner):
                return -TOO_MANY
            contacts.corner[found] = corner
            contacts.edge[found] = start
            contacts.gap[found] = gap
            found += 1
        if found > count:
            break
    return found


def is_over(corners: Corners, start: int, end: int, length: float, along: float, slack: float, margin: float) -> bool:
    """Tell whether a corner lies over an edge, also over what goes on from it where its outline turns inwards.

    A corner in a notch that is pressed into one of its edges has left the other by as much, and is still held by it.
    """
    before = slack if corners.convex[start] != 0 else margin
    beyond = slack if corners.convex[end] != 0 else margin
    return -before <= along <= length + beyond


def is_known(detection: Detection, found: int, corner: int, edge: int) -> bool:
    """Tell whether other parts of two blocks have that contact already, or one of the other's corners at its place."""
    corners = detection.corners
    contacts = detection.contacts
    near = 2 * SAME * detection.size
    for number in range(found):
        known = contacts.corner[number]
        against = contacts.edge[number]
        if known == corner and against == edge:
            return True
        turned = corners.block[known] == corners.block[edge] and corners.block[against] == corners.block[corner]
        if turned and abs(corners.now[corner] - corners.now[known]) <= near:
            return True
    return False


def side_from(sides: Sides, parts: Parts, part: int, corner: int) -> int:
    """Return the side of a part that starts from a corner, -1 where there is none."""
    for side in range(parts.first[part], parts.last[part]):
        if sides.corner[side] == corner:
            return side
    return NONE


def front(places: Points, sides: Sides, parts: Parts, side: int, part: int) -> tuple[float, int]:
    """Return how far a part is in front of the edge of a side [m], and from which of its sides' corners."""
    start = places[sides.corner[side]]
    along = (places[sides.end[side]] - start).conjugate()
    least = math.inf
    lowest = NONE
    for number in range(parts.first[part], parts.last[part]):
        gap = -(along * (places[sides.corner[number]] - start)).imag
        if gap < least:
            least = gap
            lowest = number
    return least / abs(along), lowest


def foot(places: Points, corner: int, start: int, end: int) -> tuple[float, float, float]:
    """Return the length of an edge, how far along it a corner is, and its gap [m]."""
    along = places[end] - places[start]
    apart = along.conjugate() * (places[corner] - places[start])
    length = abs(along)
    return length, apart.real / length, -apart.imag / length


def cosine_between(places: Points, sides: Sides, first: int, second: int) -> float:
    """Return the cosine between two sides."""
    one = places[sides.end[first]] - places[sides.corner[first]]
    other = places[sides.end[second]] - places[sides.corner[second]]
    return float((one.conjugate() * other).real / (abs(one) * abs(other)))


def inherit(detection: Detection) -> None:
    """Write from which contact of the step before each goes on: the same corner and edge, or else the same place."""
    corners = detection.corners
    contacts = detection.contacts
    previous = detection.previous
    for number in range(detection.count[0]):
        contacts.origin[number] = NONE
        contacts.same[number] = 0
    for attempt in range(2):
        for number in range(detection.count[0]):
            if contacts.same[number] != 0:
                continue
            corner = contacts.corner[number]
            nearest = NEAR * detection.size
            old = detection.head[pair_of(detection, corner, contacts.edge[number])]
            while old >= 0:
                if attempt == 0:
                    if previous.corner[old] == corner and previous.edge[old] == contacts.edge[number]:
                        contacts.origin[number] = old
                        contacts.same[number] = 1
                elif previous.closed[old] != 0 and previous.heir[old] == NONE:
                    distance = abs(corners.now[previous.corner[old]] - corners.now[corner])
                    if distance < nearest:
                        nearest = distance
                        contacts.origin[number] = old
                old = previous.chain[old]
            if contacts.origin[number] >= 0:
                previous.heir[contacts.origin[number]] = number
