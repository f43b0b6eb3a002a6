"""The exact motion with friction as a solver: its columns, switches, slip and energies, and who refuses it."""

import pytest

from fem_reference.events import block_events, block_march
from fem_reference.events.switches import NoContactStateError
from validation import load_scene
from validation.runs.run import Outcome
from validation.solvers.events import BarMotion
from validation.solvers.registry import get_solver

INCLINE = """
title = "block on an incline"
[block]
side = 2.0
density = 2700.0
young = 1.0e9
[contact]
law = "unilateral"
stiffness = 1.0e9
shear_stiffness = 4.0e8
friction = 30.0
[load]
gravity = 9.81
slope = 20.0
[time]
step = 0.001
steps = 30
[run]
solvers = ["block-events"]
columns = ["displacement", "slide_m", "slide_n", "state_m", "state_n", "shear_force_m", "normal_force_m"]
"""


def scene(tmp_path, text=INCLINE):
    path = tmp_path / "incline.toml"
    path.write_text(text)
    return load_scene(path)


def test_a_motion_that_cannot_go_on_is_a_named_outcome(tmp_path, monkeypatch):
    def stuck(*_args):
        raise NoContactStateError("no state of the corners agrees with the motion at 0.5 s")

    monkeypatch.setattr(block_events, block_events.solve.__name__, stuck)
    run = get_solver("block-events").prepare(scene(tmp_path)).run()
    assert run.outcome is Outcome.NO_CONTACT_STATE
    assert run.history is None
    assert "at 0.5 s" in run.notes[0]


GRANITE = """
title = "a light block of granite on stiff springs"
[block]
side = 2.0
density = 2650.0
young = 4.0e10
[contact]
law = "unilateral"
stiffness = 4.0e12
[load]
gravity = 9.81
pressure = 5.0e6
[time]
step = 1.0e-4
steps = 125
[run]
solvers = ["bar-events"]
"""


@pytest.mark.parametrize(
    ("name", "module", "limit", "most", "horizon"),
    [
        pytest.param("bar-events", BarMotion, "most_terms", 7e5, 0.0088, marks=pytest.mark.long),
        ("block-events", block_march, "STEPS", 27, 0.0049),
    ],
)
def test_a_motion_of_too_much_work_ends_at_a_named_horizon(tmp_path, monkeypatch, name, module, limit, most, horizon):
    monkeypatch.setattr(module, limit, most)
    run = get_solver(name).prepare(scene(tmp_path, GRANITE)).run()
    assert run.outcome is Outcome.HORIZON
    assert run.history is None
    told = float(run.notes[0].split("exact up to ")[1].split(" s")[0])
    assert told == pytest.approx(horizon, rel=0.3)
