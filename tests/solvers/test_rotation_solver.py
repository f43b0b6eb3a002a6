"""Scenes with updated geometry: columns, alarms and a base that moves."""

import math

import numpy as np
import pytest

from validation import load_scene, solve
from validation.runs.run import Outcome
from validation.solvers.registry import get_solver

TOPPLING = """\
title = "A tower on its corner"

[block]
width = 1.0
height = 2.5
density = 2700.0
young = 1.0e9
tilt = 35.0

[contact]
law = "unilateral"
stiffness = 1.0e9

[load]
gravity = 9.81

[time]
step = 1.0e-2
steps = 300

[run]
solvers = ["dda"]
geometry = "updated"
columns = ["displacement", "contact_pressure", "rotation", "gap_m", "gap_n", "normal_force_m", "normal_force_n", "area"]
"""


@pytest.fixture(scope="module")
def scene(tmp_path_factory):
    path = tmp_path_factory.mktemp("rotation") / "tower.toml"
    path.write_text(TOPPLING)
    return load_scene(path)


@pytest.fixture(scope="module")
def prepared(scene):
    ready = get_solver("dda").prepare(scene)
    return ready, ready.run()


@pytest.mark.long
def test_a_tower_tilted_beyond_its_diagonal_lies_down(prepared, scene):
    ready, run = prepared
    columns = run.history.columns
    assert run.outcome is Outcome.COMPLETED
    assert columns["rotation"][-1] == pytest.approx(math.radians(90 - 35), abs=0.02)
    assert columns["gap_n"][-1] == pytest.approx(1.0, abs=0.02) and columns["gap_m"][-1] < 0
    weight = 2.5 * 2700.0 * 9.81
    assert np.mean(columns["contact_pressure"][-50:]) == pytest.approx(weight, rel=0.1)
    assert columns["normal_force_n"][-1] == 0 and np.max(np.abs(columns["area"] - 1)) < 0.02
    switches = ready.switches()
    assert {switch.corner for switch in switches} >= {"corner 3"}


def test_a_base_that_moves_goes_with_updated_geometry(scene, tmp_path):
    (tmp_path / "push.csv").write_text("time,x\n0,0\n0.1,0.02\n")
    path = tmp_path / "pushed.toml"
    path.write_text(TOPPLING.replace("gravity = 9.81", 'gravity = 9.81\nbase_motion = "push.csv"').replace("300", "20"))
    still, moved = solve(scene.with_values({"time.steps": 20}), "dda"), solve(load_scene(path), "dda")
    assert not np.allclose(still.history.columns["rotation"], moved.history.columns["rotation"])
