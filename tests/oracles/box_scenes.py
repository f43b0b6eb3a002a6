"""Boxes on a ground as scenes of the plane: box_1, box_2, ... from below, each by its size and where it is at t = 0."""

import atexit
import math
import tempfile
from pathlib import Path

import numpy as np

from validation.models.plane.boxes import boxes_of, reach_of
from validation.scenes.scene import parse_scene

BOX = {"width": 1.0, "height": 1.0, "density": 1000.0}
GROUND = {"name": "ground", "rectangle": [200.0, 1.0], "at": [0.0, -0.5], "fixed": True}
ROWS_A_SECOND = 8640  # of a record: steps of 1/540, 1/1000 s and their like begin on or near a row
RECORDS = tempfile.TemporaryDirectory()
atexit.register(RECORDS.cleanup)


def blocks(*boxes, ground=None):
    """Return the tables of a ground and of boxes that differ from `BOX` as they say.

    A box is stated by width, height, density, x, lift (of its lowest corner above what is below), tilt [deg], velocity
    and spin.
    """
    tables = [ground or GROUND]
    top = 0.0
    for number, stated in enumerate(boxes or ({},), start=1):
        box = {"x": 0.0, "lift": 0.0, "tilt": 0.0, **BOX, **stated}
        reach = reach_of(box["width"], box["height"], math.radians(box["tilt"]))
        y = top + box["lift"] + reach
        table = {"name": f"box_{number}", "rectangle": [box["width"], box["height"]], "at": [box["x"], y]}
        table |= {name: box[name] for name in ("density", "velocity", "spin") if name in box}
        tables.append(table | ({"turned": box["tilt"]} if box["tilt"] else {}))
        top = y + reach
    return tables


def box_scene(
    *boxes,
    step=0.01,
    steps=100,
    gravity=9.81,
    slope=0.0,
    stiffness=math.inf,
    base=None,
    time=None,
    **contact,
):
    """Return a scene of boxes with all columns, rows every `step` seconds.

    Parameters
    ----------
    stiffness
        Of a box on the ground, by two corners [N/m].
    base
        A [m] and f [Hz] of the ground's motion A (1 - cos(2 pi f t)).
    contact
        friction [deg], 0 by default, and restitution.
    """
    lean = math.radians(slope)
    ground = GROUND if base is None else {**GROUND, "motion": record(*base, step * steps)}
    ground = {name: value for name, value in ground.items() if base is None or name != "fixed"}
    plane = {
        "young": math.inf,
        "density": BOX["density"],
        "gravity": [gravity * math.sin(lean), -gravity * math.cos(lean)],
        "contact": {"friction": 0.0, "stiffness": stiffness / 2, **contact},
        "block": blocks(*boxes, ground=ground),
    }
    data = {"name": "boxes", "plane": plane, "time": {"step": step, "steps": steps} | (time or {})}
    scene = parse_scene(data, "boxes")
    return scene.with_values({"run.columns": list(boxes_of(scene).columns)})


def record(amplitude, frequency, duration):
    """Return the file of a record of A (1 - cos(2 pi f t)) over a duration [s] and a tenth of a second more."""
    time = np.arange(round(ROWS_A_SECOND * (duration + 0.1)) + 1) / ROWS_A_SECOND
    path = Path(RECORDS.name) / f"{amplitude}-{frequency}-{duration}.csv"
    rows = np.column_stack([time, amplitude * (1 - np.cos(2 * np.pi * frequency * time))])
    np.savetxt(path, rows, "%.17g", ",", header="time,x", comments="")
    return str(path)
