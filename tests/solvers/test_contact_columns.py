"""The adapter of `dda` for columns whose contacts open or slip: columns, switches, record and outcomes of a scene."""

import math

import numpy as np
import pytest
from conftest import thinned

from validation.engine.case import Case
from validation.engine.measure import execute
from validation.scenes.scene import load_scene, parse_scene
from validation.solvers.columns.blocks import ContactColumn
from validation.solvers.registry import get_solver

LAYER = {"thickness": 5.0, "density": 2500.0, "young": math.inf, "blocks": 5, "velocity": -1.0}


def scene_of(column, columns, step=1e-4, steps=400, **tables):
    whole = {"motion": "pressure", "law": "unilateral", "stiffness": 1e9, "layer": [LAYER]} | column
    time = {"step": step, "steps": steps, "alpha": 0.25, "delta": 0.5, "start": "consistent"}
    data = {"column": whole, "time": time, "run": {"solvers": ["dda"], "columns": columns}}
    return parse_scene(data | tables, "column.toml")


def dropped(**column):
    """Return the five blocks of case A2, which land and leave their base."""
    joint = {"height": 0.0, "stiffness": 1e9, "gap": 0.005}
    heights = [0.5, 1.5, 2.5, 3.5, 4.5, 0.0, 3.0]
    names = [f"{part}_{k}" for part in ("displacement", "velocity") for k in range(1, 6)]
    names += ["force_6", "gap_6", "gap_7", "contact_pressure", "stress_1"]
    whole = {"gap": 0.0005, "joint": [joint], "gravity": 9.81, "heights": heights} | column
    return scene_of(whole, names, step=1.5e-5, steps=4000)


@pytest.mark.parametrize(("only", "kept"), [(None, True), (frozenset({"displacement_1.peak"}), False)])
def test_the_engine_keeps_what_the_metrics_of_a_case_are_measured_from(monkeypatch, only, kept):
    asked = []
    sound = ContactColumn.solved
    monkeypatch.setattr(ContactColumn, "solved", lambda self, energies: asked.append(energies) or sound(self, energies))
    scene = dropped().with_values({"time.steps": 5})
    execute(Case(scene, "dda", measures=("history",), only=only), "key", "study")
    assert asked[0] is kept


@pytest.mark.parametrize(
    ("case", "lowest", "highest"),
    thinned([(0, -23.765, -1.320), (1, -22.386, 2.107), (2, -24.06, -1.71), pytest.param(3, -17.92, -0.013)], 4),
)
def test_residual_slips_of_a_site_are_those_of_an_independent_program(case, lowest, highest):
    scene = load_scene("columns-slips-steps").expand()[case]
    prepared = get_solver("dda").prepare(scene)
    history = prepared.run().history
    digits = 6e-4 if case < 2 else 6e-3
    assert 1e3 * history.columns["slip_1"][-1] == pytest.approx(lowest, abs=digits)
    assert 1e3 * history.columns["slip_5"][-1] == pytest.approx(highest, abs=digits)
    record = prepared.contact_record()
    assert record.slip is not None
    assert record.slip[-1] == np.abs([history.columns[f"slip_{k}"][-1] for k in range(1, 6)]).max()
    assert record.energies["friction"][-1] > 0
    assert not record.open_share.any() and not record.gap.any()
    switches = prepared.switches()
    assert {switch.opens for switch in switches} == {None}
    assert {switch.slips for switch in switches} == {True, False}
