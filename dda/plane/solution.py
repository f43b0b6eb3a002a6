"""Histories of blocks in the plane: a model is put into numbers, the steps are made, what comes out is named."""

from __future__ import annotations

import math
from collections.abc import Mapping
from copy import deepcopy
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from dda.contact.rows import INSIDE, LOWER, laws_of, work_for
from dda.contact.unilateral import Unilateral
from dda.march.compiled import ANEW, run_loop
from dda.march.energy import energies_of
from dda.march.step import Body, Course, History, March, history_of, march_of, state_of
from dda.model.arrays import Array
from dda.model.checks import check_count
from dda.plane.bodies import Blocks, as_complex, blocks_of, increments, poses_of, set_poses
from dda.plane.detect import detection_of
from dda.plane.many import many_of
from dda.plane.model import ContactSprings, PlaneModel
from dda.plane.outcomes import PlaneContact, found_contact, sentence, stated_contacts, unsettled_contacts
from dda.plane.places import Places, place_contacts, push_contacts, write_rows
from dda.plane.step import STATE, Plane, PointLoads, make_steps, push_loads
from dda.plane.taken import PlaneState, Springs, write_laws
from dda.scheme.newmark import Scheme, late_momentum

TOGETHER = 6  # solves with all states updated at once
ROOM = 8  # contacts found of a block for which there is room
DENSE = 24  # contacts up to which the equations are those of their forces
TOUCH = 1e-12  # of a block's size, by which a corner that lies on an edge at t = 0 may be beside it
STICKS, SLIPS = 1, 2


@dataclass(frozen=True, eq=False)
class PlaneResult:
    """Histories of the steps that were kept and reached; row 0 is t = 0. Forces act on the block of the corner."""

    time: Array  # (k,) [s]
    centroid: Array  # (k, b, 2) [m]
    displacement: Array  # (k, b, 2) of the centroid since t = 0, to all digits [m]
    angle: Array  # (k, b) rotation since t = 0, counter-clockwise [rad]
    strain: Array  # (k, b, 3) ex, ey, gxy in axes that turn with the block
    velocity: Array  # (k, b, 6) rates of all these; of a driven block in the middle of the last step
    contacts: tuple[PlaneContact, ...]
    normal: Array  # (k, c) N [N], positive in compression
    shear: Array  # (k, c) T along (n_y, -n_x), n the edge's outward normal [N]
    gap: Array  # (k, c) [m]
    slip: Array  # (k, c) way by which a contact slipped since t = 0 [m]
    state: NDArray[np.int8]  # (k, c) 0 open, 1 sticks, 2 and -2 slips along and against T's direction
    bond: Array  # (k, bonds, 2, 2) forces of glue: of either end of a bond N and T [N]
    energy: Mapping[str, Array]  # [J], (k,) each: those of `dda.march.energy`, and the balance that their sum leaves
    momentum: Array  # (k, 3) linear in x and y [N s], angular about the origin [N m s]
    outcome: str  # "completed", or why the history ends early and by which contacts, in words
    unsettled: tuple[PlaneContact, ...]  # the contacts that ended it: whose states come and go, or whose corner is deep
    reached: int  # steps
    solves: NDArray[np.int64]  # (k,) solves of the open-close iteration since the row before
    cuts: NDArray[np.int64]  # (k,) cuts since the row before
    note: str  # how the steps were made


def solve_plane(
    model: PlaneModel,
    scheme: Scheme,
    steps: int,
    *,
    every: int = 1,
    compiled: bool | None = None,
    cut: float = 0.3,
) -> PlaneResult:
    """Step blocks in the plane.

    A numerical failure is an outcome: the history then ends with the last step that was reached. A step whose contacts
    have no single state is repeated, shorter.

    Parameters
    ----------
    every
        How many steps lie between two that are kept.
    compiled
        Whether the steps are compiled; None: where the history is long enough for it.
    cut
        Length of a cut step over that of the failed one.

    Raises
    ------
    ValueError
        If a number is out of its range, or scheme and model exclude each other.
    """
    check_count(steps=steps, every=every)
    if not 0 < cut < 1:
        raise ValueError(f"cut: must be between 0 and 1, got {cut!r}")
    check_scheme(model, scheme)
    with np.errstate(all="ignore"):  # overflow is an outcome
        march = plane_march(model, scheme, every)
        course = course_of(model)
        start = start_of(model, scheme, march, course)
    kept = steps // every
    c = len(march.method.places.law)
    b = len(model.blocks)
    each = history_of(steps, 0, 0, 0, True)  # what is kept of every step
    numbers = STATE * b + (1 + c) * march.method.finds  # of blocks, and which contacts are found
    history = history_of(kept, numbers, c, 2 * c, False)
    history = history._replace(slip=each.slip, solves=each.solves, cuts=each.cuts, sums=each.sums)
    touching = len(model.contacts) + len(model.bonds) if model.found is None else 3 * b
    # 200,000 steps of a block or a contact in plain Python, some 20 s, pay for compiling
    weight = steps * (b + touching) // 10 if compiled is None else compiled * ANEW
    arguments = (march, start, deepcopy(start), course), (history, steps, cut)
    (reached, outcome), left, how = run_loop(make_steps, (), *arguments, weight)
    with np.errstate(all="ignore"):
        unsettled = unsettled_contacts(model, left[0], history, reached, outcome)
    kept = reached // every + 1
    motion = history.motion[:kept, : STATE * b].reshape(kept, b, STATE)
    q = motion[:, :, :6]
    centroid = np.array([part.block.section.centroid for part in model.blocks]) + q[:, :, :2]
    velocity, kinetic, momentum = rates_of(march, q, motion[:, :, 6:], centroid)
    time = scheme.step * every * np.arange(kept)
    for i, part in enumerate(model.blocks):
        if part.motion is not None:
            velocity[:, i, :2] = part.motion.velocity(time - scheme.step / 2)
    columns, springs = contact_columns(model, march, history, kept)
    stored = kinetic, strain_energy(model, q), springs, load_energy(model, q)
    energy = energies_of(stored, history.sums[: reached + 1 : every].copy(), scheme.table is not None)
    total = np.sum(list(energy.values()), axis=0)
    starts = np.concatenate([[0], 1 + every * np.arange(kept - 1)]).astype(int)
    return PlaneResult(
        time=time,
        centroid=centroid,
        displacement=q[:, :, :2],
        angle=q[:, :, 2],
        strain=q[:, :, 3:],
        velocity=velocity,
        **columns,
        energy=energy | {"balance": total - total[0]},
        momentum=momentum,
        outcome=sentence(model, reached, outcome, unsettled),
        unsettled=unsettled,
        reached=reached,
        solves=np.add.reduceat(history.solves[: every * (kept - 1) + 1], starts),
        cuts=np.add.reduceat(history.cuts[: every * (kept - 1) + 1], starts),
        note=f"stepped, {how}",
    )


def check_scheme(model: PlaneModel, scheme: Scheme) -> None:
    """Raise ValueError where model and scheme exclude each other."""
    if scheme.damped:
        damping = f"{scheme.mass_damping:g}, {scheme.stiffness_damping:g}"
        raise ValueError(f"mass_damping, stiffness_damping: must be 0 of blocks in the plane, got {damping}")
    stiffness = [contact.springs.stiffness for contact in model.contacts]
    stiffest = max(stiffness + [bond.stiffness for bond in model.bonds], default=0.0)
    if scheme.explicit and math.isinf(stiffest):
        raise ValueError("stiffness: must be finite in an explicit scheme (alpha = 0), got inf")


# ---- a model in numbers ----


def plane_march(model: PlaneModel, scheme: Scheme, every: int) -> March:
    """Return the march of a model."""
    parts = model.blocks
    ramps = ramps_of(model)
    driven = [i for i, part in enumerate(parts) if part.motion is not None]
    columns = [2 + len(ramps) + 2 * driven.index(i) if i in driven else -1 for i in range(len(parts))]
    blocks, k = blocks_of([p.block for p in parts], [p.rigid for p in parts], [p.held for p in parts], columns)
    outlines = [as_complex(part.block.corners) for part in parts]
    size = math.sqrt(min(part.block.section.area for part in parts if not part.held))
    loads, point_loads = loads_of(model, blocks, len(ramps) + 2 * len(driven))
    b = len(parts)
    most = 0 if model.found is None else ROOM * b + ROOM
    places = places_of(model, blocks, most)
    springs, pairs = springs_of(model)
    c = len(places.law)
    m = 2 * c
    dense = c if np.any(springs.across == 0) else min(c, DENSE)  # contacts whose flexibility there is room for
    detection = detection_of(outlines, [not part.held for part in parts], pairs, max(most, 1), size)
    body = Body(
        k=k,
        loads=loads,
        stored=np.ones(len(loads)),
        first=np.zeros(2 * dense, dtype=np.int64),
        weight=np.zeros((2 * dense, 0)),
        ground=np.zeros((2 * dense, 2)),
        mobility=np.ones(len(k)),
    )
    plane = Plane(
        blocks=blocks,
        places=places,
        loads=point_loads,
        late=2 - 2 * (scheme.delta if scheme.table is None else 0.5),
        size=size,
        every=every,
        chords=poses_of(b),
        ends=poses_of(b),
        D=np.zeros((b, 6)),
        new=np.zeros((b, 6)),
        row=np.zeros((3, 6)),
        spin=np.zeros(4),
        ground=np.zeros((m, 2)),
        springs=springs,
        begun=at_rest(len(k), b, c),
        made=np.zeros(1, dtype=np.int64),
        dropped=np.zeros(1),
        dense=dense,
        many=many_of(blocks, places, size),
        strained=int(np.any(k > 0)),
        finds=int(model.found is not None),
        detection=detection,
        **{name: np.zeros(len(k)) for name in ("loaded", "last", "x")},
    )
    march = march_of(body, laws_of(Unilateral(1.0), dense, 2 * dense, TOGETHER), scheme, np.zeros(2 * dense), plane)
    slips = bool(np.any(np.isfinite(springs.limit)))
    stated = int(places.count[1])
    laws = laws_of(Unilateral(1.0), c, m, TOGETHER)
    laws = laws._replace(contacts=stated, rows=2 * stated, slips=slips, paired=False)
    write_laws(springs, places, laws)
    room = march.room._replace(free=np.zeros(m))
    of_equations = ("A", "right", "slope", "newton", "newton_right")
    work = work_for(c, m, banded=True)._replace(**{name: getattr(march.work, name) for name in of_equations})
    return march._replace(between=at_rest(len(k), b, c), room=room, laws=laws, work=work)


def at_rest(modes: int, blocks: int, contacts: int) -> PlaneState:
    """Return a state at rest, without contact forces."""
    none = np.zeros(2 * contacts)
    return PlaneState(*state_of(modes, none, none), np.zeros((blocks, 6)), np.zeros(contacts), none)


def ramps_of(model: PlaneModel) -> list[float]:
    """Return the times in which loads rise, each once; weight does at once."""
    return sorted({0.0, *(load.ramp for load in model.loads)})


def loads_of(model: PlaneModel, blocks: Blocks, columns: int) -> tuple[Array, PointLoads]:
    """Return the loads on centroids by their modes, a row for all that is prescribed, and those at other places."""
    ramps = ramps_of(model)
    rows = np.zeros((columns, blocks.modes.sum()))
    for i, part in enumerate(model.blocks):
        if not part.held:
            rows[0, blocks.first[i] :][:2] = blocks.root_mass[i] * np.array(model.gravity)
    elsewhere = []
    for load in model.loads:
        force, place = load.resultant
        i = load.block
        if place is None:
            rows[ramps.index(load.ramp), blocks.first[i] :][:2] += force / blocks.root_mass[i]
        else:
            elsewhere.append((i, complex(*place) - blocks.centroid[i], complex(*force), 2 + ramps.index(load.ramp)))
    block, at, force, share = np.array(elsewhere, dtype=complex).reshape(-1, 4).T.copy()
    return rows, PointLoads(block.real.astype(np.int64), at, force, share.real.astype(np.int64))


def course_of(model: PlaneModel) -> Course:
    """Return what is prescribed: no common base, the shares of the loads, the displacements of driven blocks."""
    motions = [part.motion for part in model.blocks if part.motion is not None]
    ramps = ramps_of(model)
    instants = np.unique(np.concatenate([[0.0], ramps, *(motion.time for motion in motions)]))
    none = np.zeros((len(instants), 2))
    shares = [np.clip(instants / ramp, 0.0, 1.0) if ramp else np.ones(len(instants)) for ramp in ramps]
    value = np.column_stack([none, *shares, *(motion.at(instants) for motion in motions)])
    return Course(instants, value, np.zeros(1, dtype=np.int64))


def springs_of(model: PlaneModel) -> tuple[Springs, Array]:
    """Return the laws of stated contacts, of bonds and of found contacts, and the number of the law of two blocks."""
    rows = [law_of(contact.springs) for contact in model.contacts]
    rows += [(1 / bond.stiffness, 1 / bond.shear, 0.0, math.inf, math.inf, 0.0) for bond in model.bonds]
    known: dict[ContactSprings, int] = {}
    numbers = np.full((len(model.blocks), len(model.blocks)), -1)
    for i, j in np.argwhere(np.tri(len(numbers), k=-1)).tolist():
        springs = model.found(i, j) if callable(model.found) else model.found
        if springs is not None:
            numbers[i, j] = numbers[j, i] = known.setdefault(springs, len(rows) + len(known))
    pairs = [(part.block, part.on) for part in model.contacts] + [(part.first, part.second) for part in model.bonds]
    for i, j in pairs:  # which have contacts of their own
        numbers[i, j] = numbers[j, i] = -1
    rows += [law_of(springs) for springs in known]
    across, along, friction, limit, tension, opens = np.array(rows, dtype=float).reshape(-1, 6).T.copy()
    return Springs(across, along, friction, limit, tension, opens.astype(np.int64)), numbers


def law_of(springs: ContactSprings) -> tuple[float, ...]:
    """Return the numbers of a law, as `Springs` has them."""
    slips = springs.shear == 0 or springs.friction is not None
    limit = springs.cohesion if slips else math.inf
    softness = 1 / springs.shear if springs.shear else 0.0
    return 1 / springs.stiffness, softness, springs.friction or 0.0, limit, springs.tension, 1.0


def places_of(model: PlaneModel, blocks: Blocks, most: int) -> Places:
    """Return contacts, then both ends of every bond, as points of their blocks, and room for so many that are found."""
    rows = []
    for k, contact in enumerate(model.contacts):
        at = blocks.xi[blocks.start[contact.block] + contact.corner]
        rows.append((k, contact.block, contact.on, 0, at, 0, *edge_of(blocks, contact.on, contact.edge)))
    for k, bond in enumerate(model.bonds, len(rows)):
        edge = edge_of(blocks, bond.second, model.edge_of(bond.second, bond.start, bond.end))
        for place in (bond.start, bond.end):
            points = [complex(*place) - blocks.centroid[block] for block in (bond.first, bond.second)]
            rows.append((k, bond.first, bond.second, 1, *points, *edge))
    stated = len(rows)
    n = stated + most
    table = np.zeros((8, n), dtype=complex)
    table[:, :stated] = np.array(rows, dtype=complex).reshape(-1, 8).T
    law, first, second, bonded = table[:4].real.astype(np.int64)
    at, foot, start, side = table[4:]
    return Places(
        count=np.array([stated, stated]),
        law=law,
        sides=np.column_stack([first, second]),
        bonded=bonded,
        at=at,
        start=start,
        side=side,
        foot=foot,
        normal=np.zeros(n, dtype=complex),
        gap=np.zeros(n),
        over=np.ones(n, dtype=np.int64),
        B=np.zeros((2 * n, 2, 6)),
        F=np.zeros((2 * n, 2, 6)),
        driven=np.zeros(2 * n),
        row=np.zeros((2, 6)),
    )


def edge_of(blocks: Blocks, block: int, edge: int) -> tuple[complex, complex]:
    """Return where an edge of a block starts, from its centroid, and the way from there to its end [m]."""
    corners = blocks.xi[blocks.start[block] : blocks.start[block + 1]]
    return corners[edge], corners[(edge + 1) % len(corners)] - corners[edge]


def start_of(model: PlaneModel, scheme: Scheme, march: March, course: Course) -> PlaneState:
    """Return the state at t = 0: unstrained; a corner that lies behind its edge is pressed by its spring.

    Behind an edge that is rigid it is a ValueError.
    """
    plane = march.method
    blocks = plane.blocks
    places = plane.places
    state = at_rest(len(march.body.k), len(model.blocks), len(places.law))
    set_poses(blocks, state.q, plane.D, plane.chords, plane.ends)
    place_contacts(blocks, state.q, plane.ends, places)
    touching = np.where(np.abs(places.gap) <= TOUCH * plane.size, 0.0, places.gap)
    gap = np.where(places.over == 1, touching, np.maximum(places.gap, 0.0))[: len(model.contacts)]
    state.rows.opening[: len(gap)] = gap
    state.rows.state[: len(gap)] = np.where(gap > 0, LOWER, INSIDE)
    for k in np.flatnonzero(gap < 0).tolist():
        contact = model.contacts[k]
        if math.isinf(contact.springs.stiffness):
            where = f"{gap[k]} m of {model.name_of(contact.block)}, corner {contact.corner}"
            raise ValueError(f"contacts[{k}]: must not begin behind an edge that is rigid, got {where}")
        state.rows.force[k] = -gap[k] * contact.springs.stiffness
    p = np.zeros(len(march.body.k))
    for i, part in enumerate(model.blocks):
        first = blocks.first[i]
        if part.held:
            continue
        p[first : first + 2] = scheme.step * blocks.root_mass[i] * np.array(part.velocity)
        p[first + 2] = scheme.step * blocks.root_inertia[i] * part.spin
    state.p[:] = p
    march.room.end[:] = course.value[0]
    increments(blocks, state.q, 0 * p, plane.chords, plane.D)
    set_poses(blocks, state.q, plane.D, plane.chords, plane.ends)
    write_rows(blocks, plane.D, plane.chords, plane.ends, state.rows, plane.late, places)
    push_loads(march, state._replace(a=0 * p))
    R = plane.loaded + course.value[0][2 : 2 + len(march.body.loads)] @ march.body.loads
    push_contacts(plane.blocks, plane.places, state.rows.force, R)
    state.R[:] = scheme.step**2 * R
    if scheme.start == "consistent":
        state.a[:] = state.R
    state.p[:] = late_momentum(scheme, p, state.a)
    return state


# ---- what comes out ----


def contact_columns(model: PlaneModel, march: March, history: History, kept: int) -> tuple[dict[str, Any], Array]:
    """Return the fields of a result that tell of contacts and glue, and the energy stored in these, (k,) [J].

    Contacts are those that are stated, and those that were found and closed at an instant that is kept.
    """
    plane = march.method
    corners = len(plane.blocks.xi)
    stated = int(plane.places.count[1])
    identity = history.motion[:kept, STATE * len(model.blocks) :].astype(np.int64)
    present = identity[:, :1] if plane.finds else np.full((kept, 1), stated)
    k = np.arange(history.path.shape[1])
    # a contact's number: those that are stated, then by corner and edge those that are found
    number = np.hstack([np.tile(k[:stated], (kept, 1)), stated + identity[:, 1 : 1 + len(k) - stated]])
    closed = history.state[:kept, : len(k)] == INSIDE
    is_reported = (k < present) & (closed | (k < stated))
    numbers, first = np.unique(number[is_reported], return_index=True)
    begins = np.flatnonzero(is_reported)[first]  # from where on it is reported
    row, place = np.nonzero(np.isin(number, numbers) & (k < present))
    rank = np.searchsorted(numbers, number[row, place])
    since = row * len(k) + place >= begins[rank]
    row, place, rank = (part[since] for part in (row, place, rank))
    order = np.argsort(begins)
    column = np.argsort(order)[rank]
    along = present[row, 0] + place
    shear_state = history.state[row, along]
    found = (numbers[order][stated:] - stated).tolist()
    contacts = stated_contacts(model) + [found_contact(march, *divmod(pair, corners)) for pair in found]
    pairs = [contact.block * len(model.blocks) + contact.on for contact in contacts[stated:]]
    laws = [*plane.places.law[:stated], *plane.detection.law[pairs]]
    table: dict[str, Array] = {}
    for name, values in (
        ("normal", history.force[row, place]),
        ("shear", history.force[row, along]),
        ("gap", history.opening[row, place]),
        ("slip", history.path[row, place]),
        ("state", closed[row, place] * np.where(shear_state == INSIDE, STICKS, -SLIPS * shear_state).astype(np.int8)),
    ):
        table[name] = np.full((kept, len(contacts)), np.nan if name == "gap" else 0, dtype=values.dtype)
        table[name][row, column] = values
    stored = table["normal"] ** 2 @ plane.springs.across[laws] + table["shear"] ** 2 @ plane.springs.along[laws]
    glued = np.array([contact.corner < 0 for contact in contacts], dtype=bool)
    bonds = np.stack([table["normal"][:, glued], table["shear"][:, glued]], axis=-1)
    fields: dict[str, Any] = {name: values[:, ~glued] for name, values in table.items()}
    fields["contacts"] = tuple(contact for contact in contacts if contact.corner >= 0)
    return fields | {"bond": bonds.reshape(kept, -1, 2, 2)}, stored / 2


def rates_of(march: March, q: Array, modes: Array, centroid: Array) -> tuple[Array, Array, Array]:
    """Return velocities (k, b, 6), kinetic energy (k,) and momentum (k, 3) of a history, by the rates of the modes."""
    blocks = march.method.blocks
    e = q[:, :, 3:]
    strained = np.einsum("bij,kbj->kbi", blocks.M, e)
    J = blocks.root_inertia**2 + np.einsum("kbi,kbi->kb", 2 * blocks.j + strained, e)
    gamma = blocks.gamma + np.einsum("kbm,bmi->kbi", e, blocks.G)
    strain_rate = np.einsum("bij,kbj->kbi", blocks.shapes, modes[:, :, 3:])
    turning = np.einsum("kbi,kbi->kb", gamma, strain_rate)
    x, y = np.moveaxis(centroid, 2, 0)
    linear = blocks.root_mass[:, None] * modes[:, :, :2]
    angular = blocks.root_inertia * modes[:, :, 2]  # about the centroid
    omega = (angular - turning) / J
    deformed = np.einsum("kbi,bij,kbj->kb", strain_rate, blocks.M, strain_rate)
    turned = J * omega**2 + 2 * omega * turning + deformed
    kinetic = np.sum(np.sum(modes[:, :, :2] ** 2, axis=2) + turned, axis=1) / 2
    about_origin = x * linear[:, :, 1] - y * linear[:, :, 0] + angular
    momentum = np.column_stack([linear.sum(axis=1), about_origin.sum(axis=1)])
    translation = modes[:, :, :2] / blocks.root_mass[:, None]
    return np.concatenate([translation, omega[:, :, None], strain_rate], axis=2), kinetic, momentum


def strain_energy(model: PlaneModel, q: Array) -> Array:
    """Return that of all blocks, (k,) [J]."""
    total = np.zeros(len(q))
    for i, part in enumerate(model.blocks):
        if not (part.held or part.rigid):
            total += np.einsum("ki,ij,kj->k", q[:, i, 3:], part.block.elastic()[3:, 3:], q[:, i, 3:]) / 2
    return total


def load_energy(model: PlaneModel, q: Array) -> Array:
    """Return minus the work that the whole loads do by the ways since t = 0, (k,) [J]."""
    mass = np.array([0.0 if part.held else part.block.total_mass for part in model.blocks])
    total: Array = -(q[:, :, :2] @ np.array(model.gravity)) @ mass
    for load in model.loads:
        force, place = load.resultant
        section = model.blocks[load.block].block.section
        at = np.zeros(2) if place is None else place - section.centroid
        total -= (complex(*force).conjugate() * way_of(q[:, load.block], complex(*at))).real
    return total


def way_of(q: Array, at: complex) -> NDArray[np.complex128]:
    """Return the displacement of a material point of a block from t = 0, (k,) [m]."""
    shear = q[:, 5] / 2
    stretch = q[:, 3] * at.real + shear * at.imag + 1j * (shear * at.real + q[:, 4] * at.imag)
    turned: NDArray[np.complex128] = np.expm1(1j * q[:, 2]) * (at + stretch)
    return q[:, 0] + 1j * q[:, 1] + stretch + turned
