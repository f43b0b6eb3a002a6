"""How many digits a history of the mesh keeps, and where that is not promised.

Against its own double matrices taken as exact, in both columns and from both starts, the step keeps nine digits for
1e-3 <= p/E <= 1e12 and lam <= 1e4 G: a softer spring is lost in the rounding of the elastic forces, which are p/E
times larger than its own for a rigid motion, and so is shear in a nearly incompressible material.
"""

from __future__ import annotations

import math

import numpy as np

from fem_reference.problem.problem import Array, Problem

SOFTEST = 1e-3
STIFFEST = 1e12
"""Bounds of p/E within which nine digits are kept [-]."""
INCOMPRESSIBLE = 1e4
"""Largest lam / G for which nine digits are kept [-]."""


def warnings(problem: Problem) -> tuple[str, ...]:
    """Say in words where nine correct digits are not promised."""
    messages = []
    ratio = problem.stiffness / problem.young
    if not SOFTEST <= ratio <= STIFFEST:
        messages.append(f"nine digits are kept only for p/E from {SOFTEST:g} to {STIFFEST:g}, here p/E = {ratio:.3g}")
    if problem.lame > INCOMPRESSIBLE * problem.shear_modulus:
        messages.append(
            f"nine digits are kept only for lam/G up to {INCOMPRESSIBLE:g}, here lam/G = "
            f"{problem.lame / problem.shear_modulus:.3g}: nearly incompressible"
        )
    return tuple(messages)


def coarse(problem: Problem, step: float, opens: bool = False) -> tuple[str, ...]:
    """Say where the elements are too coarse for the front of a wave, or for the ramp of a base that opens.

    The front passes fewer than one of them in a step. They are longer than the way 1/kappa of a wave in which the
    base's pressure changes: a wave of modulus lam + 2 G meets springs of 2 p / a for each length of the base, kappa =
    2 p / (a (lam + 2 G)).
    """
    if problem.mesh is not None:
        return ()
    messages = []
    size = float(np.ptp(problem.outline[:, 1])) / problem.elements
    passed = math.sqrt(problem.wave_modulus / problem.density) * step / size
    if passed < 1:
        messages.append(f"mesh too coarse for the wave: {passed:.3g} elements per c dt, its front needs about 40")
    ramp = 2 * problem.stiffness / problem.base_length / problem.wave_modulus * size
    if opens and ramp > 1:
        messages.append(f"too coarse for the base spring: h kappa is {ramp:.3g}, at most 1 shows its ramp")
    return tuple(messages)


def bounded(history: Array, pressure: float) -> Array:
    """The history of a unit pressure, (columns, steps), times the pressure [Pa], infinite from its first overflow on.

    Nothing moves without it, whatever an unstable scheme makes of a unit load.
    """
    if pressure == 0:
        return np.zeros_like(history)
    with np.errstate(over="ignore", invalid="ignore"):
        scaled = pressure * history
    scaled[~np.logical_and.accumulate(np.isfinite(scaled), axis=1)] = np.inf
    return scaled
