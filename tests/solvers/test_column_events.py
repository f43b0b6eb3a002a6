"""The adapter of the exact motion of columns whose contacts open or slip."""

import math

import numpy as np
import pytest

from validation.runs.run import Outcome
from validation.scenes.drive import motion_at
from validation.scenes.scene import parse_scene
from validation.solvers.columns.events import ColumnEventMotion, drive_of
from validation.solvers.registry import get_solver, solve

LAYERS = [
    {"thickness": 2.0, "density": 2400.0, "young": 1e9, "poisson": 0.2, "blocks": 2, "velocity": -0.5},
    {"thickness": 1.5, "density": 2000.0, "young": math.inf, "blocks": 1, "velocity": -0.5},
]
OPENS = {"motion": "pressure", "law": "unilateral", "stiffness": 1e9, "gap": 1e-3, "gravity": 9.81, "layer": LAYERS}
HEIGHTS = [0.0, 0.5, 1.0, 2.0, 2.75]


def scene_of(column, columns, steps=200, **tables):
    time = {"step": 5e-5, "steps": steps, "alpha": 0.25, "delta": 0.5, "start": "consistent"} | tables.pop("time", {})
    run = {"solvers": ["dda", "column-events"], "columns": columns}
    return parse_scene({"column": {"heights": HEIGHTS} | column, "time": time, "run": run, **tables}, "made")


@pytest.mark.parametrize(
    "drive",
    [
        {"at": "base", "shape": "ricker", "velocity": 0.3, "frequency": 60.0},
        {"at": "base", "shape": "half-sine", "velocity": 0.3, "duration": 0.01},
        {"at": "base", "shape": "triangle", "velocity": 0.3, "duration": 0.01},
        {"at": "base", "shape": "sine", "velocity": 0.3, "frequency": 40.0},
        {"at": "base", "shape": "cosine", "velocity": 0.3, "frequency": 40.0},
        {"at": "top", "shape": "ricker", "pressure": 3e5, "frequency": 60.0},
        {"at": "top", "shape": "triangle", "pressure": 3e5, "duration": 0.01},
        {"at": "base", "record": "velocity"},
        {"at": "base", "record": "acceleration"},
        {"at": "top", "record": "pressure"},
        {},
    ],
    ids=str,
)
def test_the_drive_is_that_of_the_scene(drive, tmp_path):
    from flint import arb

    if "record" in drive:
        record = tmp_path / "record.csv"
        record.write_text(f"time,{drive['record']}\n0.002,0.5\n0.005,-1\n0.012,3\n0.03,0\n")
        drive = drive | {"record": str(record)}
    scene = scene_of(OPENS, ["displacement"], **({"input": drive} if drive else {}))
    times = np.array([0.0, 0.001, 0.0033, 0.009, 0.0151, 0.02])
    motion = motion_at(scene, times)
    for at, integral, expected in (("base", True, motion.displacement), ("top", False, motion.pressure)):
        course = drive_of(scene, at, integral)()
        values = [float(course.piece_at(t).series(arb(t), 1.0, 1)[0]) for t in times.tolist()]
        np.testing.assert_allclose(values, expected, atol=1e-12 * max(np.abs(expected).max(), 1e-3))
    before, after = (motion_at(scene, times[1:] + shift) for shift in (-1e-6, 1e-6))
    for name, rate in (("displacement", motion.velocity[1:]), ("velocity", motion.acceleration[1:])):
        slopes = (getattr(after, name) - getattr(before, name)) / 2e-6
        np.testing.assert_allclose(slopes, rate, atol=1e-6 * max(np.abs(rate).max(), 1e-3))


def test_notes_name_switches_and_the_proven_radius():
    run = solve(scene_of(OPENS, ["displacement"], 100), "column-events")
    assert run.notes[1].startswith("0 m ")
    assert sum(note.startswith("proven: ") for note in run.notes) == 2
    assert not run.notes[-1].endswith(" m")
    touching = OPENS | {"gap": 0.0, "joint": [{"height": 0.0, "stiffness": 1e9, "gap": 0.01}]}
    run = solve(scene_of(touching, ["displacement"], 40), "column-events")
    assert run.notes[-1].endswith(" 1, 2 m")


def test_digits_that_do_not_do_end_at_a_horizon(monkeypatch):
    from fem_reference.events import report

    monkeypatch.setattr(report, "MOST_DIGITS", 30)
    monkeypatch.setattr(report, "PROMISED", 1e-70)
    run = solve(scene_of(OPENS, ["displacement"]), "column-events")
    assert run.outcome is Outcome.HORIZON


def test_a_motion_of_too_much_work_ends_at_a_horizon_and_shows_how_far_it_is(monkeypatch):
    scene = scene_of(OPENS, ["displacement"])
    shares = []
    said = []
    for limit in (3e3, 10.0):
        monkeypatch.setattr(ColumnEventMotion, "most_terms", limit)
        prepared = get_solver("column-events").prepare(scene)
        prepared.progress = shares.append
        run = prepared.run()
        assert run.outcome is Outcome.HORIZON
        said.append(run.notes[0])
        assert "column-events:full" in run.notes[0]
    assert [float(words.split()[3]) for words in said] == pytest.approx([0.00761436, 7.25176e-5], rel=1e-5)
    assert "may have 152 steps" in said[0]
    assert shares == sorted(shares) and 0 < shares[-1] < 1
