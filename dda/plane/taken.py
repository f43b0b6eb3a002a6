"""Contacts of a step that are found: what they take from the step before, and where their points are."""

from __future__ import annotations

import math
from typing import Any, NamedTuple

from dda.contact.dense import Matrix, Vector
from dda.contact.rows import FOUND, INSIDE, LOWER, Laws, Rows
from dda.plane.bodies import Blocks, Points, Poses, place_of
from dda.plane.detect import NONE, Detection, find_contacts, pair_of
from dda.plane.places import Places


class PlaneState(NamedTuple):
    """Where the blocks are: what `dda.march.step.State` has, and their places."""

    z: Vector
    p: Vector
    a: Vector
    R: Vector
    path: Vector
    rows: Rows
    q: Matrix  # (b, 6) increments from t = 0: of the centroid [m], rotation [rad], strains in axes that turn
    slid: Vector  # (c,) way by which contacts slipped since t = 0 [m]
    driven: Vector  # (2c,) what driven blocks added to the rows in the stage [m]


class Springs(NamedTuple):
    """Laws of contacts, (laws,) each."""

    across: Vector  # 1/p [m/N]
    along: Vector  # 1/p_s; zero of what is smooth
    friction: Vector  # tan(phi)
    limit: Vector  # cohesion; infinite of what never slips [N]
    tension: Vector  # infinite of glue [N]
    opens: Any  # 0 of glue


def laws_for(laws: Laws, count: int) -> Laws:
    """Return the laws of the first contacts."""
    return Laws(
        count,
        2 * count,
        laws.compliance,
        laws.lower,
        laws.upper,
        laws.opens,
        laws.friction,
        laws.slips,
        laws.lagged,
        laws.paired,
        laws.banded,
        laws.closing,
        laws.retardation,
        laws.together,
        laws.most,
    )


def write_laws(springs: Springs, places: Places, laws: Laws) -> None:
    """Write the laws of all present contacts into rows."""
    n = places.count[0]
    for k in range(n):
        law = places.law[k]
        laws.compliance[k] = springs.across[law]
        laws.compliance[n + k] = springs.along[law]
        laws.friction[k] = springs.friction[law]
        laws.lower[k] = 0.0 - springs.tension[law]
        laws.upper[k] = math.inf
        laws.lower[n + k] = 0.0 - springs.limit[law]
        laws.upper[n + k] = springs.limit[law]
        laws.opens[k] = springs.opens[law]
        laws.opens[n + k] = 0


def place_corners(blocks: Blocks, q: Matrix, D: Matrix, ends: Poses, out: Points) -> None:
    """Write where all corners are after increments D, for the poses there."""
    for i in range(len(blocks.root_mass)):
        for corner in range(blocks.start[i], blocks.start[i + 1]):
            out[corner] = place_of(blocks, q, D, ends, i, blocks.xi[corner])


def take_found(detection: Detection, blocks: Blocks, places: Places) -> int:
    """Find the contacts of a step and write their points after those that are stated; return the outcome."""
    found = find_contacts(detection)
    if found < 0:
        return -found
    contacts = detection.contacts
    corners = detection.corners
    stated = places.count[1]
    places.count[0] = stated + found
    for f in range(found):
        k = stated + f
        corner = contacts.corner[f]
        edge = contacts.edge[f]
        places.sides[k][0] = corners.block[corner]
        places.sides[k][1] = corners.block[edge]
        places.law[k] = detection.law[pair_of(detection, corner, edge)]
        places.at[k] = blocks.xi[corner]
        places.start[k] = blocks.xi[edge]
        places.side[k] = blocks.xi[corners.after[edge]] - blocks.xi[edge]
    return FOUND


def take_memory(detection: Detection, places: Places, before: PlaneState, out: PlaneState) -> None:
    """Write the contacts with which a step begins: each takes what is left of that from which it goes on."""
    n = places.count[0]
    stated = places.count[1]
    old = stated + detection.count[1]
    for r in range(len(out.path)):
        clear_row(out, r)
    for k in range(n):
        origin = k
        if k >= stated:
            f = k - stated
            origin = stated + detection.contacts.origin[f] if detection.contacts.origin[f] >= 0 else NONE
        out.slid[k] = 0.0
        if origin >= 0:
            take_row(before, origin, out, k)
            take_row(before, old + origin, out, n + k)
            out.slid[k] = before.slid[origin]
        if k >= stated and (origin < 0 or detection.contacts.same[k - stated] == 0):
            gap = detection.contacts.gap[k - stated]
            out.rows.opening[k] = gap
            if origin < 0 and gap > 0:
                out.rows.state[k] = LOWER


def clear_row(out: PlaneState, r: int) -> None:
    """Write a row that is closed and carries nothing."""
    out.rows.state[r] = INSIDE
    out.rows.opening[r] = 0.0
    out.rows.force[r] = 0.0
    out.rows.slip[r] = 0.0
    out.path[r] = 0.0


def take_row(before: PlaneState, r: int, out: PlaneState, to: int) -> None:
    """Write a row of a state as another one with which a step begins."""
    out.rows.state[to] = before.rows.state[r]
    out.rows.opening[to] = before.rows.opening[r]
    out.rows.force[to] = before.rows.force[r]
    out.path[to] = before.path[r]


def dropped_energy(detection: Detection, springs: Springs, places: Places, rows: Rows) -> float:
    """Return what was stored in contacts of the step before from which none of this step goes on [J]."""
    previous = detection.previous
    stated = places.count[1]
    old = detection.count[1]
    total = 0.0
    for o in range(old):
        if previous.heir[o] >= 0:
            continue
        law = detection.law[pair_of(detection, previous.corner[o], previous.edge[o])]
        normal = rows.force[stated + o]
        shear = rows.force[stated + old + stated + o]
        total += (springs.across[law] * normal * normal + springs.along[law] * shear * shear) / 2
    return total
