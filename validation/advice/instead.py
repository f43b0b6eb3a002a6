"""What else gives the damping that one parameter cannot give: the nearest that can be had, and what to change."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from functools import partial

from validation.advice.search import Search
from validation.scenes.scene import Scene

OPTIONS = {"gg": "discount", "scheme": "scheme", "dt": "time step"}  # the step last: it changes what a run costs
PERIOD = 20  # steps of a period that is resolved
UNDAMPED = {"time.alpha": 0.25, "time.delta": 0.5, "time.gg": 1.0}  # average acceleration: what gg adds is all there is
Make = Callable[[Scene], Search]


@dataclass(frozen=True)
class Instead:
    """The nearest damping ratio that the asked parameter gives, and settings that give the wanted one."""

    nearest: float | None = None  # xi [1]; None where none is defined
    nearest_at: float | None = None  # dt [s], gg [1] or delta [1] there
    settings: Mapping[str, float] | None = None  # for Scene.with_values; None where nothing here gives it
    words: str = ""


def instead(scene: Scene, solve_for: str, target: float, makes: Mapping[str, Make], frequency: float) -> Instead:
    """Return what can be had where no value of a parameter gives the target.

    Parameters
    ----------
    scene, solve_for, target
        As for `advise`, which has found nothing.
    makes
        The search of each parameter.
    frequency
        Of the first axial mode [rad/s].
    """
    searches = {kind: makes[kind](scene) for kind in OPTIONS}
    own = searches[solve_for]
    near = min(own.ends(), key=lambda s: abs(own.at(s) - target), default=None)
    found = Instead() if near is None else Instead(own.at(near), own.value(near))
    for kind, search in searches.items():
        if kind != solve_for and (values := search.solutions(target)):
            settings = search.settings(min(values, key=partial(change, scene, kind, search)))
            words = f"Change the {OPTIONS[kind]} instead: {said(settings)} gives it (--solve-for {kind})."
            return replace(found, settings=settings, words=words)
    step = min(scene.time.step, 2 * math.pi / (PERIOD * frequency))
    for changed in (UNDAMPED, UNDAMPED | {"time.step": step}):
        plain = makes["gg"](scene.with_values(dict(changed)))
        if values := plain.solutions(target):
            settings = changed | plain.settings(min(values))
            return replace(found, settings=settings, words=f"Change more than one: {said(settings)} together give it.")
    return replace(found, words="No other dt, gg or scheme gives it either, nor does average acceleration with any gg.")


def change(scene: Scene, kind: str, search: Search, s: float) -> float:
    """Return by how much the scene's own value would change, as a logarithm: of two ways the smaller change."""
    own = {"dt": scene.time.step, "gg": scene.time.discount, "scheme": scene.time.delta}[kind]
    value = search.value(s)
    return abs(math.log(value / own)) if value > 0 and own > 0 else math.inf


def said(settings: Mapping[str, float]) -> str:
    """Return settings as ``--set`` takes them."""
    return ", ".join(f"{key} = {value:.6g}" for key, value in settings.items())
