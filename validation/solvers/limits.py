"""Stability limits of conditionally stable schemes: a step beyond is refused unless the scene allows it."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import replace

from validation.errors import InputError
from validation.scenes.scene import Scene
from validation.theory.stepping import Stepping


def check_step(scene: Scene, highest_frequency: Callable[[], float | None]) -> None:
    """Refuse a step beyond the limit of a conditionally stable scheme.

    A contact that opens or slips only softens the model, so the limit of the closed, sticking contact is the
    least of all.

    Parameters
    ----------
    scene
        The scene with its scheme.
    highest_frequency
        Of the solver's model [rad/s], None where nothing limits its step; asked for by conditionally stable schemes
        only.

    Raises
    ------
    InputError
        w dt exceeds the critical value of the scheme and the scene does not allow it.
    """
    t = scene.time
    stepping = Stepping.of(scene)
    omega = min(replace(stepping, gg=gg).critical_omega for gg in discounts(scene))
    if math.isinf(omega) or t.allow_unstable:
        return
    frequency = highest_frequency()
    if frequency is None:
        return
    largest_step = omega / frequency
    if t.step <= largest_step * (1 + 1e-12):
        return
    scheme = stepping.numbers
    advice = "choose 2 alpha >= delta >= 1/2, or set allow_unstable = true"
    if t.scheme != "newmark":
        advice = "choose an implicit scheme (dda-validate list schemes), or set allow_unstable = true"
    if largest_step == 0:
        where = "on a rigid stop (stiffness = inf)" if math.isinf(frequency) else "without damping"
        raise InputError(
            f"no step of {scheme} is stable {where}",
            source=scene.name,
            field="time.step",
            value=f"{t.step:g}",
            advice=advice,
        )
    raise InputError(
        f"must not exceed {largest_step:.6g} s, the stability limit of {scheme} at the largest frequency "
        f"{frequency:.6g} rad/s",
        source=scene.name,
        field="time.step",
        value=f"{t.step:g}",
        advice=f"make it smaller, {advice}",
    )


def discounts(scene: Scene) -> tuple[float, ...]:
    """Return the kinetic discounts gg between which the critical w dt lies.

    Its square is a ratio of two linear functions of gg, so that the ends of the range of an adaptive gg bound it.
    """
    if scene.damping.kinetic == "adaptive":
        return scene.damping.floor, 1.0
    return (scene.time.discount,)
