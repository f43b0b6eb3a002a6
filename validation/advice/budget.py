"""The damping budget of a scene: the damping of its modes over dt.

The curves are computed when a study runs and stored in its manifest, so that the report draws them without a solver.
"""

from __future__ import annotations

import contextlib
import itertools
from collections.abc import Iterable, Iterator

import numpy as np

from validation.advice.spectra import CONTACT, FIRST, dda_modes, mode_damping
from validation.errors import InputError
from validation.runs.case_name import scene_of
from validation.runs.history import Array
from validation.runs.modes import contact_index
from validation.runs.numbers import significant
from validation.runs.records import BudgetRecord
from validation.scenes.scene import Scene
from validation.theory import spectra

POINTS = 121
LOWEST = 1e-3  # w dt of the first axial mode at which the range of dt begins
HIGHEST = 30.0  # and at which it ends
VARIANTS = 10  # panels of a scene, at most
DIGITS = 5


def budgets(scenes: Iterable[Scene]) -> Iterator[BudgetRecord]:
    """Yield one budget for each setting of a scene apart from its time steps and meshes."""
    settings: dict[str, dict[str, list[Scene]]] = {}
    for scene in scenes:
        data = scene.definition()
        time = {key: value for key, value in data["time"].items() if key not in ("step", "steps", "start")}
        setting = repr((data["block"], data["contact"], data.get("damping"), time))
        settings.setdefault(scene_of(scene.name), {}).setdefault(setting, []).append(scene)
    for group in settings.values():
        for cases in itertools.islice(group.values(), VARIANTS):
            with contextlib.suppress(InputError, ValueError):  # a scene that DDA cannot take has no budget
                yield budget(cases)


def budget(cases: list[Scene]) -> BudgetRecord:
    """Return the curves of one setting, as plain data."""
    scene = cases[0]
    modes = dda_modes(scene)
    first = modes[0].frequency
    steps = sorted({case.time.step for case in cases})
    dt = np.geomspace(min(LOWEST / first, steps[0] / 2), max(HIGHEST / first, steps[-1] * 2), POINTS)
    frequencies = {FIRST: first}
    if (index := contact_index(modes)) is not None:
        frequencies[CONTACT] = modes[index].frequency
    return {
        "scene": scene.name,
        "steps": steps,
        "gg": scene.time.discount,
        "gg_rate": scene.time.gg_rate,
        "dt": [significant(step, DIGITS) for step in dt.tolist()],
        "modes": {name: _curves(scene, w, dt) for name, w in frequencies.items()},
        "transit": significant(spectra.transit(scene), DIGITS),
        "floor": _floor(scene, first),
    }


def _curves(scene: Scene, frequency: float, dt: Array) -> dict[str, list[float | None]]:
    """Return the damping ratio of a mode over dt, total and by its parts, None where a root is not positive.

    A discount stays fixed per step, or at its rate.
    """
    at_steps = []
    for step in dt.tolist():
        time = scene.time.model_copy(update={"step": step})
        at_steps.append(mode_damping(scene.model_copy(update={"time": time}), FIRST, frequency))
    parts = {"total": "damping", "algorithmic": "algorithmic", "kinetic": "kinetic"}
    if scene.damping.present:
        parts["viscous"] = "viscous"
    curves = {}
    for part, name in parts.items():
        values = [getattr(mode, name) for mode in at_steps]
        curves[part] = [None if value is None else significant(value, DIGITS) for value in values]
    return curves


def _floor(scene: Scene, first: float) -> float | None:
    """First frequency of DDA over that of the exact bar; None for a block that is no rectangle or not at mu = 0."""
    if scene.block.vertices is not None or scene.block.poisson != 0:
        return None
    return significant(first / spectra.bar_frequency(scene), DIGITS + 1)
