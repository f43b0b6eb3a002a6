"""What else gives the damping that one parameter cannot give."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from functools import partial

from validation.advice.search import Search
from validation.scenes.scene import Scene

OPTIONS = {"gg": "discount", "scheme": "scheme", "dt": "time step"}  # the step last: it changes what a run costs
PERIOD = 20  # steps of a period that is resolved
UNDAMPED = {"time.alpha": 0.25, "time.delta": 0.5, "time.gg": 1.0}  # average acceleration: what gg adds is all there is
Make = Callable[[Scene], Search]


def alternative(
    scene: Scene, solve_for: str, target: float, makes: Mapping[str, Make], frequency: float
) -> tuple[dict[str, float] | None, str]:
    """Return settings that give the target where no value of a parameter does, None if nothing here does, and words.

    Parameters
    ----------
    scene, solve_for, target
        As for `advise`, which has no solution.
    makes
        The search of each parameter.
    frequency
        Of the first axial mode [rad/s].
    """
    for kind in OPTIONS:
        search = makes[kind](scene)
        if kind != solve_for and (values := search.solutions(target)):
            settings = search.settings(min(values, key=partial(change, scene, kind, search)))
            words = f"Change the {OPTIONS[kind]} instead: {settings_text(settings)} gives it (--solve-for {kind})."
            return settings, words
    step = min(scene.time.step, 2 * math.pi / (PERIOD * frequency))
    for undamped in (UNDAMPED, UNDAMPED | {"time.step": step}):
        search = makes["gg"](scene.with_values(dict(undamped)))
        if values := search.solutions(target):
            settings = undamped | search.settings(min(values))
            return settings, f"Change more than one: {settings_text(settings)} together give it."
    return None, "No other dt, gg or scheme gives it either, nor does average acceleration with any gg."


def change(scene: Scene, kind: str, search: Search, s: float) -> float:
    """Return by how much the scene's present value would change, as a logarithm whatever its sign."""
    present = {"dt": scene.time.step, "gg": scene.time.discount, "scheme": scene.time.delta}[kind]
    value = search.value(s)
    return abs(math.log(value / present)) if value > 0 and present > 0 else math.inf


def settings_text(settings: Mapping[str, float]) -> str:
    """Return settings as ``--set`` takes them."""
    return ", ".join(f"{key} = {value:.6g}" for key, value in settings.items())
