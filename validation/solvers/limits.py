"""Stability limits of conditionally stable schemes: a step beyond is refused unless the scene allows it."""

from __future__ import annotations

import math
from collections.abc import Callable

from validation.errors import InputError
from validation.scenes.scene import Scene


def check_step(scene: Scene, critical: Callable[[float, float, float], float], fastest: Callable[[], float]) -> None:
    """Refuse a step beyond the limit of a conditionally stable scheme.

    Parameters
    ----------
    scene
        The scene with its scheme.
    critical
        The solver package's own function of (alpha, delta, gg): the critical w dt, infinite where there is none.
    fastest
        Returns the largest natural frequency [rad/s]; called for conditionally stable schemes only.

    Raises
    ------
    InputError
        w dt exceeds the critical value of the scheme and the scene does not allow it.
    """
    t = scene.time
    omega = critical(t.alpha, t.delta, t.discount)
    if math.isinf(omega):
        return
    frequency = fastest()
    limit = omega / frequency
    if t.step > limit * (1 + 1e-12) and not t.allow_unstable:
        raise InputError(
            f"{scene.name}: time.step: must not exceed {limit:.6g} s, the stability limit of "
            f"alpha = {t.alpha:g}, delta = {t.delta:g} at the largest frequency {frequency:.6g} rad/s, "
            f"got {t.step:g}; make it smaller, choose 2 alpha >= delta, or set allow_unstable = true"
        )
