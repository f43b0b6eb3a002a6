"""Contact methods with a force of their own in a step: what it is, of the step that the block would make without it.

With w0 and w0' the gap and its rate at the start, w_f and w_f' those at the end without contact force, and C, C' what a
unit force adds to them (rates are times the step, as U is), the force is

    dashpot            N = -(k w_f + c w_f') / (1 + k C + c C'), closed where w_f < 0, clipped to N >= 0 or not
    implicit           N = -k w_f / (1 + k C), closed where w_f < 0                      (Kane et al. 1999)
    energy-conserving  N = -(E(w1) - E(w0)) / (w1 - w0), E = k min(w, 0)^2 / 2           (Armero and Petocz 1998)
    rigid              N = -w_f / C, closed where w_f < 0: complementarity, to which an augmented Lagrangian comes
    impact             N = -(w_f' + e w0') / C' >= 0, where w0 + w0' / 2 <= 0            (Moreau 1999, Jean 1999)

In locked contact the first three always act, and are linear in the state.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from validation.diagnosis.variant import Array, Flags

FORCED = frozenset({"dashpot", "implicit", "energy-conserving", "rigid", "impact"})


class Contact(NamedTuple):
    """What a contact force follows from, one of each for every variant."""

    stiffness: Array  # k [N/m]
    dashpot: Array  # c over the time step [N/m]
    restitution: Array  # e [-]
    clipped: Flags
    C: Array  # [m/N]
    C_rate: Array  # C' [m/N]


class Gaps(NamedTuple):
    """Gaps and their rates [m], or the rows by which they follow from a state."""

    start: Array  # w0
    start_rate: Array  # w0'
    free: Array  # w_f
    free_rate: Array  # w_f'


def closed_force(method: str, contact: Contact, gaps: Gaps) -> Array:
    """Return the force of contact that stays closed; of rows of the gaps the row of the force."""
    k = contact.stiffness
    C = contact.C
    if method == "energy-conserving":
        return np.asarray(-k * (gaps.free + gaps.start) / (2 + k * C))
    if method == "rigid":
        return np.asarray(-gaps.free / C)
    c = contact.dashpot  # none of an implicit contact
    return np.asarray(-(k * gaps.free + c * gaps.free_rate) / (1 + k * C + c * contact.C_rate))


def force_of(method: str, contact: Contact, gaps: Gaps) -> tuple[Array, Flags]:
    """Return the forces of contact that opens, and where it is closed at the end of the step."""
    if method == "impact":
        force = np.maximum(-(gaps.free_rate + contact.restitution * gaps.start_rate) / contact.C_rate, 0.0)
        force = np.where(gaps.start + gaps.start_rate / 2 <= 0, force, 0.0)
        return force, force > 0
    force = closed_force(method, contact, gaps)
    if method == "energy-conserving":
        force = _conserving(contact.stiffness, contact.C, gaps.start, gaps.free, force)
        return force, gaps.free + contact.C * force < 0
    closed = (gaps.free < 0) & ((force > 0) | ~contact.clipped)
    return np.where(closed, force, 0.0), closed


def _conserving(k: Array, C: Array, start: Array, free: Array, pressed: Array) -> Array:
    """Return the force of a spring that does exactly the work of its energy, by the signs of both gaps.

    `pressed` is the force where both are closed [N].
    """
    # opening: C N^2 + (w_f - w0) N = k w0^2 / 2, the root that presses
    lifted = free - start
    opening = k * start**2 / (lifted + np.sqrt(lifted**2 + 2 * C * k * start**2))
    # closing by u = -w1: (k C + 2) u^2 + 2 (w0 + w_f) u = -2 w_f w0
    a = k * C + 2
    b = start + free
    depth = (-b + np.sqrt(b * b - 2 * a * np.minimum(free * start, 0.0))) / a
    closing = k * depth**2 / (2 * (start + depth))
    was_pressed = start <= 0
    stays = free + C * pressed < 0
    force = np.where(was_pressed, np.where(stays, pressed, opening), np.where(free < 0, closing, 0.0))
    return np.asarray(np.where((start == 0) & (free >= 0), 0.0, force))
