"""Moving blocks by `dda`: friction, motions of bases, fields, contacts that are found or do not settle."""

import math
import re

import meshio
import numpy as np
import pytest

from validation.models.plane.motion import forces_at
from validation.runs.run import Outcome
from validation.scenes.scene import parse_scene
from validation.solvers.registry import get_solver, solve

STIFFNESS = 1e8
MASS = 2500.0
SLOPE = 20.0
SINK = MASS * 9.81 * math.cos(math.radians(SLOPE)) / (2 * STIFFNESS)
TOUCH = {"block": "slope_1", "on": "slope_ground", "edge": 2}


def sliding(columns=(), **changes):
    """Return a square that slides down a slope at mu = tan(10 deg), standing on its springs from t = 0 on."""
    slope = {"name": "slope", "angle": SLOPE, "length": 9.0, "rectangles": [[1.0, 1.0]], "gaps": [1.0], "sinks": [SINK]}
    plane = {
        "young": "inf",
        "density": MASS,
        "gravity": [0.0, -9.81],
        "contact": {"stiffness": STIFFNESS, "shear_stiffness": 1e3 * STIFFNESS, "friction": 10.0},
        "block": [{"name": "wall", "rectangle": [1.0, 1.0], "at": [-5.0, 0.0], "fixed": True}],
        "slope": [slope | {"speeds": [1.0]}],
        "touch": [TOUCH | {"corner": 0}, TOUCH | {"corner": 1}],
    }
    kept = [f"slope_1.{part}" for part in ("x", "y", "angle", "vx")]
    kept += [f"slope_1.{corner}-slope_ground.2.{part}" for corner in (0, 1) for part in ("normal", "shear")]
    time = {"step": 1e-3, "steps": 200, "alpha": 0.25, "delta": 0.5, "start": "consistent"}
    run = {"columns": columns or [*kept, "energy.balance", "energy.friction", "momentum.x"]}
    return parse_scene({"plane": plane | changes, "time": time, "run": run}, "sliding")


def test_a_block_slides_by_its_friction_and_its_fields_and_columns_hold_the_forces(tmp_path):
    scene = sliding()
    history = get_solver("dda").prepare(scene).run(tmp_path / "fields.vtu").history
    mu, slope = math.tan(math.radians(10)), math.radians(SLOPE)
    acceleration = 9.81 * (math.sin(slope) - mu * math.cos(slope))
    columns = history.columns
    # The speed is that of a rigid block but for the pitch that friction excites, which is bounded.
    speed = columns["slope_1.vx"] / math.cos(slope)
    assert np.max(np.abs(speed - 1 - acceleration * history.time)) < 2e-3
    assert np.max(np.abs(columns["energy.balance"])) < 1e-8 * MASS
    assert columns["momentum.x"] == pytest.approx(MASS * columns["slope_1.vx"])
    places, forces = zip(*forces_at(scene.plane.assembly, history, 199), strict=True)
    normal = sum(columns[f"slope_1.{corner}-slope_ground.2.normal"][199] for corner in (0, 1))
    uphill, outward = (-math.cos(slope), math.sin(slope)), (math.sin(slope), math.cos(slope))
    assert sum(forces) @ outward == pytest.approx(normal) == pytest.approx(MASS * 9.81 * math.cos(slope), rel=1e-3)
    assert sum(forces) @ uphill == pytest.approx(mu * normal)
    mesh = meshio.read(tmp_path / "fields.vtu")
    points = mesh.points + mesh.point_data["displacement"]
    assert points[4:6, :2] == pytest.approx(np.array(places))
    assert mesh.point_data["contact force"][4:6, :2] == pytest.approx(np.array(forces))


def test_a_free_block_turns_from_where_it_was_put():
    block = {"name": "free", "sides": 5, "radius": 1.0, "turned": 30.0, "spin": 2.0, "velocity": [1.0, 0.0]}
    names = ["free.angle", "free.x", "momentum.angular"]
    run = solve(sliding(names, slope=[], touch=[], contact=None, block=[block], gravity=[0.0, 0.0]), "dda")
    angle, x, momentum = (run.history.columns[name] for name in names)
    assert angle == pytest.approx(math.radians(30) + 2 * run.history.time)
    assert x == pytest.approx(run.history.time) and momentum == pytest.approx(momentum[0])


@pytest.mark.long
def test_a_step_that_does_not_end_names_the_contacts_that_flip():
    """Stones on springs whose period is a hundredth of the step land with friction: no state of one corner agrees."""
    floor = {"name": "floor", "rectangle": [9.0, 1.0], "at": [2.0, -0.5], "fixed": True}
    stones = {"name": "stone", "count": 4, "seed": 7, "radii": [0.4, 0.5], "across": 4, "at": [0.0, 0.02]}
    contact = {"stiffness": 1e12, "shear_stiffness": 4e11, "friction": 60.0}
    plane = {"young": "inf", "density": MASS, "gravity": [0.0, -9.81], "contact": contact}
    tables = {"plane": plane | {"block": [floor], "random": [stones]}, "time": {"step": 0.03, "steps": 20}}
    run = solve(parse_scene(tables, "stones"), "dda")
    assert run.outcome is Outcome.NO_CONTACT_STATE and 0 < len(run.history.time) < 20
    flipping = re.findall(r"corner (\d+) of (\w+) on edge (\d+) of (\w+)", run.notes[-1])
    assert flipping and all(block.startswith("stone_") for _, block, _, _ in flipping)
