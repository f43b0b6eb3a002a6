"""The damping budget of a scene: the damping of its modes over dt, and where the limits lie.

The curves are computed when a study runs and stored in its manifest, so that the report draws them without a solver.
"""

from __future__ import annotations

import contextlib
import itertools
import math
from collections.abc import Iterable, Iterator

import numpy as np

from dda.scheme.spectral import damping_ratio, spectral_radius
from validation.advice.spectra import CONTACT, FIRST, dda_modes, mode_damping
from validation.errors import InputError
from validation.runs.case_name import scene_of
from validation.runs.history import Array
from validation.runs.modes import contact_index
from validation.runs.numbers import significant
from validation.runs.records import BudgetRecord
from validation.scenes.scene import Scene
from validation.theory import spectra
from validation.theory.stepping import Stepping

POINTS = 161
LOWEST = 1e-3  # w dt of the first axial mode at which the range of dt begins
HIGHEST = 30.0  # and at which it ends
VARIANTS = 10  # panels of a scene, at most


def budgets(scenes: Iterable[Scene]) -> Iterator[BudgetRecord]:
    """Yield one budget for each setting of a scene apart from its time steps and meshes."""
    settings: dict[str, dict[str, list[Scene]]] = {}
    for scene in scenes:
        settings.setdefault(scene_of(scene.name), {}).setdefault(_setting(scene), []).append(scene)
    for group in settings.values():
        for cases in itertools.islice(group.values(), VARIANTS):
            with contextlib.suppress(InputError, ValueError):  # a scene that DDA cannot take has no budget
                yield budget(cases)


def _setting(scene: Scene) -> str:
    data = scene.definition()
    time = {key: value for key, value in data["time"].items() if key not in ("step", "steps", "start")}
    return repr((data["block"], data["contact"], data.get("damping"), time))


def budget(cases: list[Scene]) -> BudgetRecord:
    """Return curves and limits of one setting, as plain data.

    Keys: `scene` (name of the first case), `steps` (dt of the cases [s]), `dt` [s], `modes` (name -> total,
    algorithmic, kinetic and, with damping tables, viscous xi, None where a root is not positive), `limits` (dt [s]
    where the first axial mode's roots turn real, below which it is overdamped, wave transit), `real roots at` (w dt of
    the first of these), `floor` (first frequency of DDA over that of the bar).
    """
    scene = cases[0]
    modes = dda_modes(scene)
    first = modes[0].frequency
    steps = sorted({case.time.step for case in cases})
    dt = np.geomspace(min(LOWEST / first, steps[0] / 2), max(HIGHEST / first, steps[-1] * 2), POINTS)
    frequencies = {FIRST: first}
    if (index := contact_index(modes)) is not None:
        frequencies[CONTACT] = modes[index].frequency
    curves = {name: _curves(scene, w, dt) for name, w in frequencies.items()}
    limits = _limits(scene, first, dt)
    return {
        "scene": scene.name,
        "steps": steps,
        "gg": scene.time.discount,
        "gg_rate": scene.time.gg_rate,
        "dt": _listed(dt),
        "modes": curves,
        "limits": limits,
        "real roots at": significant(limits.get("real roots", 0.0) * first, 4),
        "floor": _floor(scene, first),
    }


def discounts(scene: Scene, dt: Array) -> Array:
    """Return gg over dt: fixed per step, or at a fixed rate."""
    rate = scene.time.gg_rate
    return np.full_like(dt, scene.time.discount) if rate is None else np.exp(-rate * dt)


def _curves(scene: Scene, frequency: float, dt: Array) -> dict[str, list[float | None]]:
    t = scene.time
    total = _ratios(scene, frequency, dt)
    algorithmic = _ratios(scene.with_values({"time.gg": 1.0}), frequency, dt)
    if t.scheme == "newmark":
        radius = spectral_radius(frequency * dt, t.alpha, t.delta, discounts(scene, dt))
    else:
        stepping = Stepping.of(scene)
        radius = np.array([stepping.at(float(step)).spectral_radius(frequency * float(step)) for step in dt])
    parts = {"algorithmic": _listed(algorithmic), "kinetic": _listed(total - algorithmic)}
    if scene.damping.present:
        numerical = total
        total, radius = _viscous(scene, frequency, dt)
        parts["viscous"] = _listed(total - numerical)
    return {"total": _listed(total), **parts, "spectral_radius": _listed(radius)}


def _ratios(scene: Scene, frequency: float, dt: Array) -> Array:
    """Return the damping ratio of a mode over dt, without damping tables."""
    t = scene.time
    if t.scheme == "newmark":
        return np.asarray(damping_ratio(frequency * dt, t.alpha, t.delta, discounts(scene, dt)))
    stepping = Stepping.of(scene)
    return np.array([stepping.at(float(step)).damping_ratio(frequency * float(step)) for step in dt])


def _viscous(scene: Scene, frequency: float, dt: Array) -> tuple[Array, Array]:
    """Return xi and spectral radius over dt with the damping tables."""
    gg = discounts(scene, dt)
    modes = [
        mode_damping(scene.with_values({"time.step": float(step), "time.gg": float(g)}), FIRST, frequency)
        for step, g in zip(dt, gg, strict=True)
    ]
    total = np.array([math.nan if mode.damping is None else mode.damping for mode in modes])
    return total, np.array([mode.spectral_radius for mode in modes])


def _limits(scene: Scene, first: float, dt: Array) -> dict[str, float]:
    """Return the dt of the limits that exist within the range [s]."""
    fine = dt
    if scene.damping.present:
        total, _ = _viscous(scene, first, dt)
    else:
        if scene.time.scheme == "newmark":  # by a closed form, which is quick
            fine = np.geomspace(dt[0], dt[-1], 20_001)
        total = _ratios(scene, first, fine)
    limits = {}
    if np.isnan(total).any() and np.isfinite(total[0]):
        limits["real roots"] = float(fine[int(np.argmax(np.isnan(total)))])
    if total[0] >= 1 and (total < 1).any():
        limits["overdamped below"] = float(fine[int(np.argmax(total < 1))])
    limits["wave transit"] = spectra.transit(scene)
    return {name: significant(value, 4) for name, value in limits.items()}


def _floor(scene: Scene, first: float) -> float | None:
    """First frequency of DDA over that of the exact bar; None for a block that is no rectangle or not at mu = 0."""
    if scene.block.vertices is not None or scene.block.poisson != 0:
        return None
    return significant(first / spectra.bar_frequency(scene), 6)


def _listed(values: Array) -> list[float | None]:
    return [significant(value, 5) if math.isfinite(value) else None for value in values]
