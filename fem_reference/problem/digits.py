"""How many digits a history of the mesh keeps, and where that is not promised.

Against its own double matrices taken as exact, in both columns and from both starts, the step keeps nine digits for
1e-3 <= p/E <= 1e12 and lam <= 1e4 G: a softer spring is lost in the rounding of the elastic forces, which are p/E
times larger than its own for a rigid motion, and so is shear in a nearly incompressible material.
"""

from __future__ import annotations

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


def front(problem: Problem, step: float) -> tuple[str, ...]:
    """Say how many elements the wave passes in a step where they are too coarse for its front, fewer than one."""
    if problem.mesh is not None:
        return ()
    modulus = problem.lame + 2 * problem.shear_modulus
    height = float(np.ptp(problem.outline[:, 1]))
    passed = float(np.sqrt(modulus / problem.density)) * step * problem.elements / height
    return (
        (f"mesh too coarse for the wave: {passed:.3g} elements per c dt, its front needs about 40",)
        if passed < 1
        else ()
    )


def bounded(history: Array, pressure: float) -> Array:
    """Return the history of a unit pressure times the pressure, infinite from its first overflow on.

    Parameters
    ----------
    history
        Shape (columns, steps).
    pressure
        Pressure [Pa]; nothing moves without it, whatever an unstable scheme makes of a unit load.
    """
    if pressure == 0:
        return np.zeros_like(history)
    with np.errstate(over="ignore", invalid="ignore"):
        scaled: Array = pressure * history
    scaled[~np.logical_and.accumulate(np.isfinite(scaled), axis=1)] = np.inf
    return scaled
