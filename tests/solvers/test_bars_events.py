"""The adapters of elastic bars and of line elements whose contacts open or slip: the elements tend to the bars."""

import numpy as np
import pytest

from fem_reference.events.bars_model import BONDED, BarJoint
from validation.runs.run import Outcome
from validation.scenes.scene import parse_scene
from validation.solvers.columns.bars import BarsOfColumn, bars_of
from validation.solvers.registry import get_solver, solve

LAYERS = [
    {"thickness": 2.0, "density": 2400.0, "young": 1e9, "blocks": 2, "velocity": -0.5},
    {"thickness": 1.5, "density": 2000.0, "young": 5e8, "blocks": 1, "velocity": -0.5},
]
OPENS = {"motion": "pressure", "law": "unilateral", "stiffness": 1e9, "gap": 1e-3, "gravity": 9.81, "layer": LAYERS}
HEIGHTS = [0.0, 0.5, 1.0, 2.0, 2.75]
PULSE = {"at": "top", "shape": "half-sine", "pressure": 3e5, "duration": 0.006}


def scene_of(column, columns, elements=4, **tables):
    time = {"step": 1e-4, "steps": 200, "alpha": 0.25, "delta": 0.5, "start": "consistent"} | tables.pop("time", {})
    run = {"solvers": ["bars-events", "fem"], "columns": columns}
    fem = {"elements": elements, "degree": 1}
    return parse_scene({"column": {"heights": HEIGHTS} | column, "time": time, "run": run, "fem": fem} | tables, "made")


def history(scene, solver):
    run = solve(scene, solver)
    assert run.outcome is Outcome.COMPLETED and run.history is not None, run.notes
    return dict(run.history.columns)


def test_a_motion_that_outgrows_the_work_ends_at_a_horizon_and_is_that_of_elements_in_full(monkeypatch):
    columns = ["displacement", "contact_pressure", "displacement_3", "velocity_5", "stress_2", "force_1", "gap_1"]
    scene = scene_of(OPENS, columns, 16, input=PULSE, time={"steps": 80})
    monkeypatch.setattr(BarsOfColumn, "most_terms", 2e3)
    run = solve(scene, "bars-events")
    assert run.outcome is Outcome.HORIZON
    bars = solve(scene, "bars-events", full=True).history.columns
    for name, values in history(scene, "fem").items():
        assert values == pytest.approx(bars[name], abs=0.08 * np.abs(bars[name]).max()), name
    monkeypatch.setattr(BarsOfColumn, "most_terms", 10.0)  # less than it takes for certain
    early = solve(scene, "bars-events")
    assert early.outcome is Outcome.HORIZON and early.notes != run.notes


def test_layers_of_one_material_are_one_bar():
    layer = LAYERS[0] | {"blocks": 1}
    joint = {"height": 0.9, "stiffness": 3e8, "gap": 1e-3}
    layers = [layer, layer | {"thickness": 1.5}, layer | {"velocity": 0.3}]
    column = {"motion": "pressure", "law": "unilateral", "base": "free", "joint": [joint], "layer": layers}
    problem, feet = bars_of(scene_of(column, ["displacement"]))
    assert feet.tolist() == pytest.approx([0.0, 0.9, 3.5])
    assert [bar.length for bar in problem.bars] == pytest.approx([0.9, 2.6, 2.0])
    heavy = column | {"gravity": 0.7, "layer": 2 * [layer | {"velocity": 0.0}]}
    assert scene_of(heavy, ["displacement"]).stated_input is None  # its weight moves it
    assert problem.joints == (None, BarJoint("unilateral", 3e8, 1e-3), BONDED)


def test_the_elements_count_their_solves_and_end_at_their_limit():
    thrown = OPENS | {"gap": 0.0, "layer": [LAYERS[0] | {"thickness": 6.0, "blocks": 6}]}
    time = {"step": 2e-3, "steps": 20, "alpha": 0.5, "delta": 1.0}
    prepared = get_solver("fem").prepare(scene_of(thrown, ["displacement"], 1, time=time))
    assert prepared.run().outcome is Outcome.COMPLETED
    record = prepared.contact_record()
    assert record.solves is not None and record.solves[0] == 7 and record.cuts is not None and not record.cuts.any()
    assert record.start_velocity == -0.5 and record.force.max() > 0 == record.gap[0]
    limited = solve(scene_of(thrown | {"solve_limit": 6}, ["displacement"], 1, time=time), "fem")
    assert limited.outcome is Outcome.NO_CONTACT_STATE and "6 solves" in limited.notes[0]
