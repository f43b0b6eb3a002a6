"""Stability limits of conditionally stable schemes, beyond which a step must be allowed by the scene."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import replace

from validation.errors import InputError
from validation.scenes.keys import is_fulfilled
from validation.scenes.scene import Scene
from validation.theory.stepping import Stepping

DASHPOTS = {  # what tables state to what then grows where delta is below 1/2
    'column.base = "transmitting"': "a transmitting base",
    "contact.has_dashpots": "contact dashpots",
    "damping.present": "damping tables",
}


def check_step(scene: Scene, highest_frequency: Callable[[], float | None]) -> None:
    """Refuse a step beyond the limit of a conditionally stable scheme.

    A contact that opens or slips only softens the model, so the limit of the closed, sticking contact is the least of
    all. `highest_frequency` gives the model's [rad/s], None where nothing limits its step; only those schemes ask it.

    Raises
    ------
    InputError
        w dt exceeds the critical value of the scheme, or a dashpot grows, and the scene does not allow it.
    """
    t = scene.time
    stepping = Stepping.of(scene)
    check_dampers(scene)
    omega = min(replace(stepping, gg=gg).critical_omega for gg in discounts(scene))
    if math.isinf(omega) or t.allow_unstable:
        return
    frequency = highest_frequency()
    if not frequency:  # not known, or nothing that is not a rigid stop has a stiffness: no step is too long for it
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


def check_dampers(scene: Scene) -> None:
    """Refuse delta below 1/2 beside a dashpot, which critical frequencies of undamped motion know nothing of.

    A mass m on a dashpot c alone, A = -(c / m) V, has V1 / V0 = (gg - (1 - delta) x) / (1 + delta x) with
    x = c dt / m: it grows from x = (1 + gg) / (1 - 2 delta) on. The mass beside the dashpot is that of an element.
    An `InputError`, unless the scene allows it.
    """
    t = scene.time
    if t.scheme != "newmark" or t.delta >= 0.5 or t.allow_unstable:
        return
    tables = scene.tables()
    dashpots = next((words for stated, words in DASHPOTS.items() if is_fulfilled(stated, "", tables)), None)
    if dashpots is None:
        return
    raise InputError(
        f"must be at least 1/2 beside {dashpots}, which grow below it",
        source=scene.name,
        field="time.delta",
        value=f"{t.delta:g}",
        advice="set allow_unstable = true to run it all the same",
    )


def discounts(scene: Scene) -> tuple[float, ...]:
    """Return the kinetic discounts gg between which the critical w dt lies.

    Its square is a ratio of two linear functions of gg, bounded by the ends of the range of an adaptive gg.
    """
    if scene.damping.kinetic == "adaptive":
        return scene.damping.floor, 1.0
    return (scene.time.discount,)
