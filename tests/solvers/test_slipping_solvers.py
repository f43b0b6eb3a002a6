"""The exact motion with friction as a solver: its columns, switches, slip and energies, and who refuses it."""

from fem_reference.events import block_events
from fem_reference.events.switches import NoContactStateError
from validation import load_scene
from validation.runs.run import Outcome
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
