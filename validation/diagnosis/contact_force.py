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


def linear_force(method: str, contact: Contact, rows: tuple[Array, Array, Array, Array]) -> Array:
    """Return the force of locked contact as a row by the state, (variants, size).

    Parameters
    ----------
    rows
        Those of w0, w0', w_f and w_f', (variants, size) each.
    """
    k, c, C, C_rate = (values[:, None] for values in (contact.stiffness, contact.dashpot, contact.C, contact.C_rate))
    start, _, free, free_rate = rows
    if method == "dashpot":
        return np.asarray(-(k * free + c * free_rate) / (1 + k * C + c * C_rate))
    if method == "implicit":
        return np.asarray(-k * free / (1 + k * C))
    if method == "energy-conserving":
        return np.asarray(-k * (free + start) / (2 + k * C))
    raise ValueError(f"{method} has no locked contact")


def force_of(method: str, contact: Contact, gaps: tuple[Array, Array, Array, Array]) -> tuple[Array, Flags]:
    """Return the forces of contact that opens, and where it is closed at the end of the step.

    Parameters
    ----------
    gaps
        w0, w0', w_f and w_f' [m], (variants,) each.
    """
    k, C = contact.stiffness, contact.C
    start, rate, free, free_rate = gaps
    if method == "impact":
        force = np.maximum(-(free_rate + contact.restitution * rate) / contact.C_rate, 0.0)
        force = np.where(start + rate / 2 <= 0, force, 0.0)
        return force, force > 0
    closed = free < 0
    if method == "energy-conserving":
        force = _conserving(k, C, start, free)
        return force, free + C * force < 0
    if method == "dashpot":
        force = -(k * free + contact.dashpot * free_rate) / (1 + k * C + contact.dashpot * contact.C_rate)
        closed = closed & ((force > 0) | ~contact.clipped)
    elif method == "implicit":
        force = -k * free / (1 + k * C)
    else:
        force = -free / C
    return np.where(closed, force, 0.0), closed


def _conserving(k: Array, C: Array, start: Array, free: Array) -> Array:
    """Return the force of a spring that does exactly the work of its energy, by the signs of both gaps."""
    pressed = -k * (free + start) / (2 + k * C)
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
