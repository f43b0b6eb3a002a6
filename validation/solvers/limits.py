"""Stability limits of conditionally stable schemes."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from validation.errors import InputError
from validation.scenes.scene import Scene

if TYPE_CHECKING:
    pass


def check_step(scene: Scene, frequency: float) -> None:
    """Refuse a step beyond the limit of a conditionally stable scheme.

    Raises
    ------
    InputError
        w dt exceeds the critical value of the scheme and the scene does not allow it.
    """
    from dda.scheme.spectral import critical_omega

    t = scene.time
    limit = critical_omega(t.alpha, t.delta, t.discount) / frequency
    if t.step > limit * (1 + 1e-12) and not t.allow_unstable:
        raise InputError(
            f"{scene.name}: time.step: must not exceed {limit:.6g} s, the stability limit of "
            f"alpha = {t.alpha:g}, delta = {t.delta:g} at the largest frequency {frequency:.6g} rad/s, "
            f"got {t.step:g}; make it smaller, choose 2 alpha >= delta, or set allow_unstable = true"
        )


def conditional(scene: Scene) -> bool:
    """Whether the scheme of a scene has a stability limit."""
    from dda.scheme.spectral import critical_omega

    return bool(np.isfinite(critical_omega(scene.time.alpha, scene.time.delta, scene.time.discount)))
