"""Histories of random columns whose contacts open or slip: what `compare` says of them.

One thing is changed, or two, or what is in no catalogue, or noise is added. A verdict is right, names causes that give
the same rows and the made one among them, is silent, or is wrong.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from validation import solve
from validation.diagnosis.answer import Answer
from validation.diagnosis.causes import UNEXPLAINED
from validation.diagnosis.judgement import compare
from validation.diagnosis.reading import Foreign
from validation.errors import InputError
from validation.scenes.scene import parse_scene

RIGHT, ALIKE, SILENT, WRONG = "right", "alike", "silent", "wrong"
SAME_NUMBER = 2e-3  # relative, of a factor that was named
KINDS = ("dropped", "weight", "spall", "shaken", "slips", "site")


def around(random, value, times=2.0):
    """Return a number around another one, up to so many times larger or smaller, with three digits."""
    return float(f"{value * times ** random.uniform(-1, 1):.3g}")


def random_scene(kind, random):
    """Return a random column of a kind, stepped finely enough that contacts are resolved."""
    blocks = int(random.integers(2, 9))
    height = around(random, 1.0)
    density = around(random, 2500.0, 1.3)
    young = around(random, 1e9)
    stiffness = around(random, 1e9 / height)
    layer = {"thickness": blocks * height, "density": density, "young": young, "blocks": blocks}
    column = {"motion": "pressure", "law": "unilateral", "stiffness": stiffness, "layer": [layer]}
    data = {"title": kind, "column": column}
    crossing = height * math.sqrt(density / young)  # of a wave through a block [s]
    beat = crossing + 1.0 / math.sqrt(stiffness / (density * height))
    duration = beat * blocks * random.uniform(2.0, 6.0)
    if kind == "dropped":
        layer["velocity"] = -around(random, 1.0)
        if random.random() < 0.5:
            layer["young"] = math.inf
        column["gap"] = around(random, 0.1 * beat * abs(layer["velocity"]))
        column["gravity"] = 9.81
        column["joint"] = [{"height": 0.0, "stiffness": around(random, stiffness), "gap": 2 * column["gap"]}]
    elif kind == "weight":
        column["gravity"] = 9.81
        duration *= 2
    elif kind == "spall":
        column |= {"gravity": 9.81, "settled": True}
        pulse = around(random, 2 * crossing)
        data["input"] = {"at": "top", "shape": "half-sine", "pressure": around(random, 2e6), "duration": pulse}
    elif kind == "shaken":
        column |= {"gravity": 9.81, "settled": True}
        frequency = around(random, 0.2 / duration)
        size = 9.81 * random.uniform(1.2, 2.5) / (2 * math.pi * frequency)
        data["input"] = {"at": "base", "shape": "sine", "velocity": float(f"{size:.3g}"), "frequency": frequency}
        duration = 1.0 / frequency
    else:
        column |= {"motion": "shear", "law": "frictional"}
        pulse = around(random, 4 * beat)
        speed = around(random, 0.4)
        data["input"] = {"at": "base", "shape": "half-sine", "velocity": speed, "duration": pulse}
        if kind == "slips":
            column["strength"] = float(f"{random.uniform(0.1, 0.5) * density * height * speed / beat:.3g}")
        else:
            column |= {"friction": around(random, 20.0, 1.5), "gravity": 9.81}
            column |= {"base": "transmitting", "base_density": 2200.0, "base_speed": around(random, 800.0)}
        duration = 2 * pulse + duration
    step = float(f"{beat / random.uniform(8.0, 20.0):.2g}")
    schemes = [(0.25, 0.5), (0.5, 1.0), (0.3025, 0.6)]
    alpha, delta = schemes[int(random.integers(0, 3))]
    start = ("zero", "consistent")[int(random.integers(0, 2))]
    steps = int(min(max(duration / step, 60), 1500))
    data["time"] = {"step": step, "steps": steps, "alpha": alpha, "delta": delta, "start": start}
    data["run"] = {"solvers": ["dda"], "columns": ["displacement", "contact_pressure"]}
    return parse_scene(data, kind)


def factor(random):
    """Return a factor that people would notice."""
    return float(f"{math.exp(random.choice([-1.0, 1.0]) * random.uniform(0.03, 0.8)):.3g}")


def steeper(angle, times):
    """Return an angle whose tangent is larger."""
    return math.degrees(math.atan(times * math.tan(math.radians(angle))))


@dataclass(frozen=True)
class Made:
    """What was changed: the cause with its number, and the keys."""

    id: str
    value: float | None
    values: dict[str, Any]


def changes(scene, random):
    """Return what may be changed in a scene."""
    data = scene.definition()
    column = data["column"]
    layer = column["layer"][0]
    made = []
    for key, name in (("density", "density-factor"), ("young", "young-factor"), ("velocity", "velocity-factor")):
        if layer.get(key) and math.isfinite(float(layer[key])):  # what is infinite is a word in plain data
            f = factor(random)
            made.append(Made(name, f, {"column.layer": [layer | {key: layer[key] * f}]}))
    for key, name in (("stiffness", "springs-factor"), ("gap", "gap-factor"), ("strength", "strength-factor")):
        if column.get(key):
            f = factor(random)
            made.append(Made(name, f, {f"column.{key}": column[key] * f}))
    if column.get("friction"):
        f = factor(random)
        made.append(Made("friction-factor", f, {"column.friction": steeper(column["friction"], f)}))
        made.append(Made("friction-factor", 0.9, {"column.gravity": 0.9 * column["gravity"]}))
    elif column.get("gravity"):
        f = factor(random)
        made.append(Made("gravity-factor", f, {"column.gravity": f * column["gravity"]}))
        if not column.get("settled"):
            made.append(Made("gravity-factor", 0.0, {"column.gravity": 0.0}))
    if column.get("gap"):
        made.append(Made("gap-factor", 0.0, {"column.gap": 0.0}))
    if column.get("settled"):
        made.append(Made("settled", None, {"column.settled": False}))
    if column.get("base_speed"):
        made.append(Made("base-factor", 1.2, {"column.base_speed": 1.2 * column["base_speed"]}))
    sizes = {"velocity": "load-factor", "pressure": "load-factor", "frequency": "frequency-factor"}
    for key, name in (sizes | {"duration": "duration-factor"}).items():
        if data.get("input", {}).get(key):
            f = factor(random)
            made.append(Made(name, f, {f"input.{key}": f * data["input"][key]}))
    gg = float(f"{random.uniform(0.9, 0.999):.4g}")
    made.append(Made("gg", gg, {"time.gg": gg}))
    t = scene.time
    other = "zero" if t.start == "consistent" else "consistent"
    made.append(Made("start", None, {"time.start": other}))
    pairs = [pair for pair in ((0.25, 0.5), (0.5, 1.0)) if pair != (t.alpha, t.delta)]
    alpha, delta = pairs[int(random.integers(0, len(pairs)))]
    made.append(Made("scheme", None, {"time.alpha": alpha, "time.delta": delta}))
    made.append(Made("substeps", 2.0, {"time.step": t.step / 2, "time.steps": 2 * t.steps}))
    if column["law"] == "frictional":
        stuck = [key for key in ("strength", "friction") if column.get(key)]
        made.append(Made("no-slip", None, {f"column.{key}": None for key in stuck}))
    made.append(Made("", None, {}))
    return made


def written(values, digits):
    """Return values as a file with so many significant digits holds them."""
    return np.array([float(f"{value:.{digits - 1}e}") for value in values])


def history(scene, values, digits, every=1):
    """Return the history of a scene with other values, as a file holds it."""
    run = solve(scene.with_values(values), "dda").history
    if run is None:
        raise InputError("must run", source=scene.name)
    rows = slice(every - 1, None, every)
    columns = (written(run.columns[name][rows], digits) for name in ("displacement", "contact_pressure"))
    return Foreign(run.time[rows], *columns)


def outside(scene, random, digits):
    """Return a history that departs by what is in no catalogue, with its name."""
    layer = scene.definition()["column"]["layer"][0]
    t = scene.time
    half = layer | {"thickness": layer["thickness"] / layer["blocks"], "blocks": 1}
    others = layer | {"thickness": half["thickness"] * (layer["blocks"] - 1), "blocks": layer["blocks"] - 1}
    which = int(random.integers(0, 6))
    if which == 0:
        plain = history(scene, {"time.steps": t.steps + 1}, digits)
        time = plain.time[:-1]
        return "rows late", Foreign(plain.time[1:], plain.displacement[:-1], plain.pressure[:-1] + 0 * time)
    if which == 1:
        finer = {"time.step": t.step / 32, "time.steps": 32 * t.steps, "time.alpha": 0.25, "time.delta": 0.5}
        return "exact in time, about", history(scene, finer | {"time.start": "consistent"}, digits, 32)
    if which == 2:
        height = half["thickness"] / 2
        values = {"column.heights": [height], "run.columns": ["displacement_1", "contact_pressure"]}
        run = solve(scene.with_values(values), "dda").history
        columns = (written(run.columns[name], digits) for name in values["run.columns"])
        return "another point", Foreign(run.time, *columns)
    if which == 3:
        return "an unnamed scheme", history(scene, {"time.alpha": 0.36, "time.delta": 0.66}, digits)
    if which == 4:
        two = [half | {"density": 1.3 * half["density"]}, others]
        return "one block denser", history(scene, {"column.layer": two}, digits)
    plain = history(scene, {}, digits)
    return "pressure by 1.1", replace(plain, pressure=written(1.1 * plain.pressure, digits))


def noisy(foreign, random, size):
    """Return a history with noise, of a share of the largest value."""

    def with_noise(values):
        return written(values + size * float(np.max(np.abs(values))) * random.standard_normal(len(values)), 10)

    pressure = None if foreign.pressure is None else with_noise(foreign.pressure)
    return replace(foreign, displacement=with_noise(foreign.displacement), pressure=pressure)


def verdict(answer, made):
    """Return what a verdict is worth, for a history in which things were changed."""
    if UNEXPLAINED in answer.causes:
        if not answer.alike:
            return SILENT
        listed = [one for one in answer.alike if len(made) == 1 and _names(one["causes"], one["values"], made[0])]
        return ALIKE if listed else WRONG
    if not made or made[0].id == "":
        return RIGHT if not answer.causes else WRONG
    if len(made) == 1 and _names(answer.causes, answer.values, made[0]):
        return RIGHT
    return WRONG


def _names(causes, values, made):
    if causes != [made.id]:
        return False
    return made.value is None or math.isclose(values[made.id], made.value, rel_tol=SAME_NUMBER, abs_tol=1e-6)


def is_visible(scene, foreign, made, digits):
    """Whether a change leaves the rows of a history with one thing changed, or with none, by more than digits."""
    plain = history(scene, made.values, digits, _every(scene, foreign))
    pairs = [(foreign.displacement, plain.displacement)]
    if foreign.pressure is not None and plain.pressure is not None:
        pairs.append((foreign.pressure, plain.pressure))
    return any(bool(np.any(np.abs(x - y) > 2 * 10.0**-digits * np.max(np.abs(y)))) for x, y in pairs)


def _every(scene, foreign):
    return max(1, round(scene.time.steps / len(foreign.time)))


@dataclass(frozen=True)
class Trial:
    """One history and what was said of it."""

    seed: int
    kind: str
    what: str
    verdict: str
    answer: Answer
    made: list[Made]


def trial(seed, judge=compare):
    """Return one random history with its verdict; None where what was drawn excludes itself."""
    random = np.random.default_rng(seed)
    kind = KINDS[seed % len(KINDS)]
    scene = random_scene(kind, random)
    possible = changes(scene, random)
    digits = int(random.integers(6, 13))
    number = (1, 1, 1, 1, 2, 1)[seed // len(KINDS) % 6]
    made = [possible[int(i)] for i in random.permutation(len(possible))[:number]]
    if number == 2 and ({*made[0].values} & {*made[1].values} or "" in (made[0].id, made[1].id)):
        return None
    what = "two changed" if number == 2 else (made[0].id or "same")
    every = 2 if made[0].id == "substeps" else 1
    try:
        values = {key: value for one in made for key, value in one.values.items()}
        if number == 2 and any(one.id == "substeps" for one in made):
            return None
        foreign = history(scene, values, digits, every)
    except InputError:
        return None
    if number == 1 and seed // len(KINDS) % 6 == 5:
        foreign = noisy(foreign, random, 1e-3)
        what = "noise of 1e-3"
    if seed // len(KINDS) % 6 == 3:
        what, foreign = outside(scene, random, digits)
        made = [Made("outside", None, {})]
    if random.random() < 0.3 and what != "pressure by 1.1":
        foreign = replace(foreign, pressure=None)
    answer = judge(scene, foreign)
    worth = verdict(answer, made)
    if worth == WRONG and made[0].id != "outside":  # what cannot be seen is no change
        visible = [one for one in made if is_visible(scene, foreign, one, digits)]
        if len(visible) < len(made) or (
            not answer.causes and not is_visible(scene, foreign, Made("", None, {}), digits)
        ):
            seen = [one for one in made if one not in visible]
            worth = verdict(answer, seen if answer.causes else [])
    return Trial(seed, kind, what, worth, answer, made)
