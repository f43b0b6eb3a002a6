"""Random columns whose contacts open or slip, and their histories as a file holds them."""

from __future__ import annotations

import math

import numpy as np

from validation import solve
from validation.diagnosis.reading import Foreign
from validation.errors import InputError
from validation.scenes.scene import parse_scene


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
