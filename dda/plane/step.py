r"""One time step of blocks in the plane.

Without contact the modes of every block move as those of any body (`dda.march.step`), whatever its angle. The rest of a
stage depends on where it ends: the directions of contacts and of loads at a place, the inertia forces of blocks that
spin and strain. So it is made again with the end that it found until nothing changes (`ROUNDS`), which takes two to
four rounds; each finds the contacts anew by their rows (`dda.contact.rows`), from the bodies' own flexibility: bodies
are eliminated before contacts, and neither a stiff spring nor a rigid block costs a digit.
"""

from __future__ import annotations

import math
from typing import Any, NamedTuple

from dda.contact.dense import Matrix, Vector, copy, copy_matrix
from dda.contact.rows import FOUND, INSIDE, NONE, find
from dda.march.account import add_bulk_loss, add_contact_losses, add_damping, half_square, over_stages
from dda.march.energy import ALGORITHMIC, GIVEN, SWITCHING
from dda.march.step import (
    Course,
    History,
    Length,
    March,
    Part,
    StageRoom,
    coast,
    end_modes,
    free_modes,
    kept_discount,
    prescribe,
    set_modes,
    steps_by,
)
from dda.model.arrays import Array
from dda.plane.bodies import (
    RIGID,
    Blocks,
    Points,
    Poses,
    by_modes,
    direction,
    increments,
    inertia_forces,
    moved,
    set_poses,
)
from dda.plane.detect import Detection, keep_contacts
from dda.plane.many import Many, find_many
from dda.plane.places import Places, contact_displacement, flexibility_of, place_contacts, push_contacts, write_rows
from dda.plane.taken import (
    PlaneState,
    Springs,
    dropped_energy,
    laws_for,
    place_corners,
    take_found,
    take_memory,
    write_laws,
)

ROUNDS = 40  # of a stage
SETTLED = 1e-12  # last change of an increment over the size of a block; the next would be this times the step's turn
SETTLED_FORCE = 1e-9  # last change of the inertia forces over the largest; that of short steps moves no increment
FAR = 1e300  # m, gap of a corner that is not over its edge
STATE = 12  # numbers that are kept of a block: D from t = 0, and the rates of its modes


class PointLoads(NamedTuple):
    """Dead forces on material points."""

    block: Any  # (l,)
    at: Points  # (l,) from the centroid, unstrained
    force: Points  # (l,) [N]
    share: Any  # (l,) column of what is prescribed that has its share


class Plane(NamedTuple):
    """What blocks in the plane have beside their march, and room for a stage."""

    blocks: Blocks
    places: Places
    loads: PointLoads
    late: float  # weight of the directions at the end of a step, beside those of its chord
    size: float  # of the smallest block [m]
    every: int  # how many steps lie between two that are kept
    chords: Poses
    ends: Poses
    D: Matrix  # (b, 6) increments of the present round
    new: Matrix  # (b, 6)
    loaded: Vector  # (n,) forces on the modes but for those of contacts
    last: Vector  # (n,) the same in the round before
    x: Vector  # (n,) increments of the modes
    row: Matrix  # (3, 6) room for a row over D
    spin: Vector  # (4,) r', e'
    ground: Matrix  # (2c, 2) zero: no base is common to all blocks
    springs: Springs
    begun: PlaneState  # whose contacts are those with which a step begins
    made: Any  # (1,) 0, or 1 where the stage that was made last is the second
    dropped: Vector  # (1,) energy of contacts that are no more [J]
    dense: int  # contacts up to which the equations are those of their forces
    many: Many
    strained: int  # whether a block has strains
    finds: int  # whether contacts are found
    detection: Detection


# ---- one stage ----


def make_stage(
    march: March, stage: StageRoom, start: PlaneState, before: PlaneState, after: PlaneState, course: Course, part: Part
) -> tuple[int, int]:
    """Go from the end of the stage before, or the start of the step, to the end of a stage."""
    plane = march.method
    blocks = plane.blocks
    room = march.room
    places = plane.places
    memory = memory_of(plane, stage, before)
    plane.made[0] = 0 if stage.numbers.begin == 0 else 1
    length = length_in_plane(march, stage, part.ratio)
    prescribe(march, course, stage, part)
    free_modes(march, length, start, before)
    for i in range(len(plane.D)):
        column = blocks.motion[i]
        if column >= 0:
            for k in range(2):
                plane.new[i][k] = room.end[column + k] - room.start[column + k]
    if stage.numbers.begin == 0:
        outcome = take_contacts(march, before)
        if outcome != FOUND:
            return outcome, 0
    laws = laws_for(march.laws, places.count[0])
    stand(plane, before.q)
    place_contacts(blocks, before.q, plane.ends, places)
    coast(stage, length, start, plane.x)
    copy(before.p, after.p)
    copy(before.a, after.a)
    increments(blocks, before.q, plane.x, plane.chords, plane.new)
    solves = 0
    for turn in range(ROUNDS):
        copy_matrix(plane.new, plane.D)
        set_poses(blocks, before.q, plane.D, plane.chords, plane.ends)
        forces_change = push_loads(march, after)
        for i in range(len(plane.x)):
            plane.x[i] = room.x[i] + length.numbers[3] * length.inverse[i] * plane.loaded[i]
            room.pushed[i] = plane.loaded[i]
        if places.count[0] > 0:
            write_rows(blocks, plane.D, plane.chords, plane.ends, memory.rows, plane.late, places)
            free_contacts(march, memory)
            outcome = NONE
            again = turn > 0
            if places.count[0] <= plane.dense:
                write_contact_flexibility(march, length)
                outcome, spent = find(laws, memory.rows, length.flexible, after.rows, march.work)
                solves += spent
                again = False
            if outcome == NONE:  # of few contacts too: some that neither press nor part, whose signs are rounding's
                outcome, spent = find_many(plane.many, laws, memory.rows, length, after.rows, march.work, again)
                solves += spent
            if outcome != FOUND:
                return outcome, solves
            push_contacts(blocks, places, after.rows.force, room.pushed)
        end_modes(march, length, start, before, after, len(march.body.k))
        for i in range(len(plane.x)):
            plane.x[i] = room.x[i] + length.numbers[3] * length.inverse[i] * room.pushed[i]
        increments(blocks, before.q, plane.x, plane.chords, plane.new)
        if forces_change > 0 and (turn == 0 or forces_change > SETTLED_FORCE):
            continue
        if largest_change(plane) <= SETTLED * plane.size:
            accept(march, memory, before, after)
            return FOUND, solves
    return NONE, solves


def length_in_plane(march: March, stage: StageRoom, ratio: float) -> Length:
    """Return what belongs to a length, over dt; the flexibility of the contacts is written anew in each round."""
    if ratio == 1.0:
        return stage.whole
    if stage.part.numbers[0] != ratio:
        set_modes(march, stage, ratio, stage.part)
    return stage.part


def memory_of(plane: Plane, stage: StageRoom, before: PlaneState) -> PlaneState:
    """Return the state with whose contacts a stage begins."""
    return plane.begun if stage.numbers.begin == 0 else before


def take_contacts(march: March, before: PlaneState) -> int:
    """Find the contacts of a step and write what they begin with; return the outcome."""
    plane = march.method
    blocks = plane.blocks
    detection = plane.detection
    outcome = FOUND
    if plane.finds != 0:
        stand(plane, before.q)
        place_corners(blocks, before.q, plane.D, plane.ends, detection.corners.now)
        increments(blocks, before.q, march.room.x, plane.chords, plane.new)
        set_poses(blocks, before.q, plane.new, plane.chords, plane.ends)
        place_corners(blocks, before.q, plane.new, plane.ends, detection.corners.then)
        outcome = take_found(detection, blocks, plane.places)
    if outcome == FOUND:
        plane.dropped[0] = dropped_energy(detection, plane.springs, plane.places, before.rows)
        take_memory(detection, plane.places, before, plane.begun)
        write_laws(plane.springs, plane.places, march.laws)
    return outcome


def stand(plane: Plane, q: Matrix) -> None:
    """Write no increments, and the poses of where the blocks are."""
    for i in range(len(plane.D)):
        for k in range(6):
            plane.D[i][k] = 0.0
    set_poses(plane.blocks, q, plane.D, plane.chords, plane.ends)


def largest_change(plane: Plane) -> float:
    """Return how far the increments of a round are from those that it was made with [m]."""
    largest = 0.0
    for i in range(len(plane.D)):
        for k in range(6):
            change = abs(plane.new[i][k] - plane.D[i][k])
            if k > 1:
                change *= plane.size
            if not change <= largest:
                largest = change
    return largest


def push_loads(march: March, after: PlaneState) -> float:
    """Write the forces on the modes of loads at a place and of inertia, for the present end of the stage.

    Returns their largest change since they were written last, over the largest of them.
    """
    plane = march.method
    blocks = plane.blocks
    loads = plane.loads
    loaded = plane.loaded
    for i in range(len(loaded)):
        plane.last[i] = loaded[i]
        loaded[i] = 0.0
    add_inertia(march, after)
    chord = plane.row[0]
    end = plane.row[1]
    weights = plane.row[2]
    for k in range(len(loads.block)):
        i = loads.block[k]
        force = march.room.end[loads.share[k]] * loads.force[k]
        direction(plane.chords, i, force, loads.at[k], chord)
        direction(plane.ends, i, force, loads.at[k], end)
        for m in range(6):
            chord[m] = (1 - plane.late) * chord[m] + plane.late * end[m]
        by_modes(blocks, i, plane.chords, chord, True, weights)
        first = blocks.first[i]
        for m in range(blocks.modes[i]):
            loaded[first + m] += weights[m]
    largest = 0.0
    change = 0.0
    for i in range(len(loaded)):
        largest = max(largest, abs(loaded[i]))
        change = max(change, abs(loaded[i] - plane.last[i]))
    return change / largest if largest > 0 else 0.0


def add_inertia(march: March, state: PlaneState) -> float:
    """Write the forces of inertia on the modes of strained blocks at a state, whose poses are those of the ends.

    Returns the kinetic energy less that of the modes alone [J].
    """
    plane = march.method
    blocks = plane.blocks
    for i in range(len(plane.x)):
        plane.x[i] = state.p[i] + march.scheme.lag * state.a[i]
    excess = 0.0
    for i in range(len(blocks.modes)):
        if blocks.modes[i] > RIGID:
            excess += inertia_forces(
                blocks, i, plane.x, state.a, march.scheme.step, plane.ends, plane.spin, plane.loaded
            )
    return excess


def write_contact_flexibility(march: March, length: Length) -> None:
    """Write W = weight B s^-1 F' of all pairs of rows."""
    plane = march.method
    W = length.flexible.W
    rows = 2 * plane.places.count[0]
    for r in range(rows):
        for s in range(rows):
            W[r][s] = flexibility_of(plane.blocks, plane.places, length, r, s)


def free_contacts(march: March, memory: PlaneState) -> None:
    """Write the openings at the end of a stage without contact forces, which end in the modes' increments `plane.x`."""
    plane = march.method
    places = plane.places
    free = march.room.free
    q = march.work.q
    opening = memory.rows.opening
    n = places.count[0]
    for r in range(2 * n):
        free[r] = displacement_of(plane, r)
        q[r] = opening[r] + free[r]
    for k in range(n):
        if places.over[k] == 0:
            q[k] = FAR


def displacement_of(plane: Plane, r: int) -> float:
    """Return by how much the opening of a row changes in the stage by `plane.x` and by driven blocks [m]."""
    displacement: float = plane.places.driven[r] + contact_displacement(plane.x, plane.blocks, plane.places, r)
    return displacement


def accept(march: March, memory: PlaneState, before: PlaneState, after: PlaneState) -> None:
    """Write where the stage ends."""
    plane = march.method
    places = plane.places
    rows = after.rows
    n = places.count[0]
    for i in range(len(plane.new)):
        for k in range(6):
            after.q[i][k] = before.q[i][k] + plane.new[i][k]
    for k in range(n):
        r = n + k
        after.slid[k] = memory.slid[k] + rows.slip[r]
        after.path[k] = memory.path[k] + rows.slip[k]
        after.path[r] = memory.path[r] + rows.slip[r]
        if places.over[k] == 0:
            rows.opening[k] = memory.rows.opening[k] + displacement_of(plane, k)
        if rows.state[k] != INSIDE or memory.rows.state[k] != INSIDE:  # what is open takes its reference along
            after.path[r] = memory.path[r] + memory.rows.opening[r] + displacement_of(plane, r) - rows.opening[r]
    for r in range(2 * n, len(rows.force)):
        rows.force[r] = 0.0
        rows.slip[r] = 0.0
    copy(places.driven, after.driven)


# ---- what is kept ----


def kinetic_excess(march: March, state: PlaneState) -> float:
    """Return the kinetic energy less that of the modes alone, p' p / 2, which a strained block has [J]."""
    if march.method.strained == 0:
        return 0.0
    stand(march.method, state.q)
    return add_inertia(march, state)


def account(march: March, state: PlaneState, after: PlaneState, course: Course, part: Part, sums: Vector) -> None:
    """Add what an accepted part of a step loses and what loads and driven blocks give [J]."""
    scheme = march.scheme
    excess = kinetic_excess(march, state)
    add_damping(march, part, half_square(state.p) / (scheme.step * scheme.step) + excess, sums)
    account_stages(march, state, after, course, part, sums)
    if scheme.newmark:
        add_bulk_loss(march, state, after, part, sums)
        discount = scheme.gg**part.ratio
        sums[ALGORITHMIC] += discount * discount * excess - kinetic_excess(march, after)
    if march.method.finds != 0:
        sums[SWITCHING] += march.method.dropped[0]
        stated = march.method.places.count[1]
        keep_contacts(march.method.detection, after.rows.force, after.rows.state, stated)


def account_stage(
    march: March, stage: StageRoom, before: PlaneState, after: PlaneState, course: Course, part: Part, sums: Vector
) -> None:
    """Add what contacts lose in a stage, and what loads and driven blocks give.

    Forces act in directions that change in a step: by how much their work on the modes differs from that on their own
    ways, the algorithm takes.
    """
    plane = march.method
    loads = plane.loads
    room = march.room
    dt2 = march.scheme.step * march.scheme.step
    prescribe(march, course, stage, part)
    late = stage.numbers.delta if march.scheme.newmark else 0.5
    length = march.scheme.step * part.ratio * (stage.numbers.end - stage.numbers.begin)
    memory = memory_of(plane, stage, before)
    laws = laws_for(march.laws, plane.places.count[0])
    add_contact_losses(march, laws, plane.ground, memory, after, late, length, sums)
    rows = after.rows
    old = memory.rows
    own_work = 0.0  # work of forces along their own directions
    for r in range(2 * plane.places.count[0]):
        force = (1 - late) * old.force[r] + late * rows.force[r]
        if force != 0.0:
            sums[GIVEN] -= force * after.driven[r]
            own_work += force * (rows.opening[r] - old.opening[r] + (after.path[r] - memory.path[r]) - after.driven[r])
    for j in range(len(march.body.loads)):
        share = (1 - late) * room.start[2 + j] + late * room.end[2 + j]
        work = 0.0
        for i in range(len(after.z)):
            work += march.body.loads[j][i] * (after.z[i] - before.z[i])
        own_work += share * work
        sums[GIVEN] += (share - march.body.stored[j]) * work
    for i in range(len(plane.D)):
        for k in range(6):
            plane.D[i][k] = after.q[i][k] - before.q[i][k]
            if k > 2:
                plane.chords.e[i][k - 3] = (after.q[i][k] + before.q[i][k]) / 2
    set_poses(plane.blocks, before.q, plane.D, plane.chords, plane.ends)
    for k in range(len(loads.block)):
        i = loads.block[k]
        share = (1 - late) * room.start[loads.share[k]] + late * room.end[loads.share[k]]
        work = (loads.force[k].conjugate() * moved(plane.chords, i, plane.D[i], loads.at[k])).real
        own_work += share * work
        sums[GIVEN] += (share - 1) * work
    if march.scheme.newmark:
        for i in range(len(after.z)):
            at_start = before.R[i] / dt2 + march.body.k[i] * before.z[i]
            at_end = after.R[i] / dt2 + march.body.k[i] * after.z[i]
            own_work -= ((1 - late) * at_start + late * at_end) * (after.z[i] - before.z[i])
        sums[ALGORITHMIC] += own_work


def keep(march: March, state: PlaneState, rows: Array, number: int) -> bool:
    """Write where the blocks are and the rates of their modes, at the steps that are kept; tell if all is finite."""
    plane = march.method
    discount = kept_discount(march.scheme, number)
    total = 0.0
    for i in range(len(plane.x)):
        plane.x[i] = (discount * state.p[i] + march.scheme.lag * state.a[i]) / march.scheme.step
        total += state.z[i] + plane.x[i]
    if number % plane.every == 0:
        for i in range(len(state.q)):
            for k in range(6):
                rows[number // plane.every, STATE * i + k] = state.q[i][k]
                rows[number // plane.every, STATE * i + 6 + k] = (
                    plane.x[plane.blocks.first[i] + k] if k < plane.blocks.modes[i] else 0.0
                )
    return math.isfinite(total)


def keep_rows(march: March, state: PlaneState, history: History, number: int) -> None:
    """Write the rows of contact at the steps that are kept."""
    plane = march.method
    if number % plane.every != 0:
        return
    row = number // plane.every
    rows = state.rows
    n = plane.places.count[1]
    if plane.finds != 0:
        n += plane.detection.count[1]
        identity = STATE * len(plane.D)
        history.motion[row, identity] = n
        for k in range(plane.detection.count[1]):
            corner = plane.detection.previous.corner[k]
            history.motion[row, identity + 1 + k] = corner * len(plane.blocks.xi) + plane.detection.previous.edge[k]
    for r in range(2 * n):
        history.force[row, r] = rows.force[r]
        history.opening[row, r] = rows.opening[r]
        history.state[row, r] = rows.state[r]
    for k in range(n):
        history.path[row, k] = state.slid[k]


account_stages = over_stages(account_stage)
make_steps = steps_by(make_stage, account, keep, keep_rows)
