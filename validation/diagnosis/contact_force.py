"""Contact forces over a step that are not linear in its start: those of energy, and impulses.

Of the step that the block would make without contact force; rates are times the step, as velocities are.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from validation.diagnosis.variant import Array


def impact(restitution: Array, gap: Array, rates: Sequence[Array]) -> Array:
    """Return N = -(w_f' + e w0') / C' >= 0 of an impact, where w0 + w0' / 2 <= 0 (Moreau 1999, Jean 1999).

    Parameters
    ----------
    restitution
        e.
    gap
        w0 at the start.
    rates
        Of the gap, w0' at the start and w_f' at the end without contact force, and C' that a unit force adds.
    """
    before, free, flexible = rates
    force = np.maximum(-(free + restitution * before) / flexible, 0.0)
    return np.asarray(np.where(gap + before / 2 <= 0, force, 0.0))


def conserving(k: Array, C: Array, start: Array, free: Array, pressed: Array) -> Array:
    """Return N = -(E(w1) - E(w0)) / (w1 - w0), E = k min(w, 0)^2 / 2, by the signs of both gaps (Armero, Petocz 1998).

    Parameters
    ----------
    k, C
        Stiffness, and the gap that a unit force adds.
    start, free
        w0, and w_f at the end without contact force.
    pressed
        The force where both gaps are closed [N].
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
