"""Alarms and advice of contact that opens or slips: raised where they should be, silent where not, and true of runs."""

import math
import tomllib
from pathlib import Path

import numpy as np
import pytest

from validation import load_scene
from validation.advice import contact, contact_alarms, friction
from validation.advice.alarms import alarms
from validation.engine.case import Case
from validation.engine.measure import execute
from validation.engine.run import finish
from validation.engine.study import Study
from validation.runs.results import Results
from validation.runs.row import Row
from validation.runs.run import Outcome

PAPER = load_scene("unlocked-constant").expand()[0].with_values({"time.step": 1e-3, "time.steps": 25})
STANDS = load_scene("creep-steps").expand()[1]  # 2 ms, constant acceleration
SCENES = {"paper": PAPER, "slides": load_scene("slope-drag").expand()[0], "stands": STANDS}
ROWS = tomllib.loads(Path(__file__).with_name("raised.toml").read_text(encoding="utf-8"))["row"]
AVERAGE = {"time.alpha": 0.25, "time.delta": 0.5}


@pytest.mark.parametrize(
    "row", [pytest.param(row, id=str(row), marks=[pytest.mark.long] * ("long" in row)) for row in ROWS]
)
def test_each_alarm_is_raised_where_it_should_be(row, tmp_path):
    kinds = contact_alarms if row["scene"] == "paper" else friction
    expected = {getattr(kinds, name) for name in row["raised"]}
    scene = SCENES[row["scene"]].with_values(row["set"])
    study = Study("test", "", "", [scene], ("dda", "bar-events") if "PENALTY" in row["raised"] else ("dda",))
    found = alarms([scene], finish(study.cases(), study, Results(tmp_path)))
    assert {alarm.kind for alarm in found if alarm.kind in kinds.KINDS} == expected


def test_a_run_without_states_is_told_what_to_do():
    row = Row("", "", STANDS.name, "dda", Outcome.NO_CONTACT_STATE, {})
    (alarm, *_) = friction.friction_alarms(STANDS, {"dda": row})
    assert alarm.kind == friction.STATELESS and "time.step" in alarm.sentence


@pytest.mark.parametrize("gg", [0.98, 0.5, 0.0])
def test_the_time_constant_of_the_drag_is_that_of_a_free_flight_of_dda(gg):
    """Speeds fall to 1/e in -dt / ln(gg): 28 % less than dt / (1 - gg) at gg = 0.5, and at once at gg = 0."""
    flight = {"load.pressure": 0.0, "block.velocity": 1.0, "contact.gap": 1.0, "time.gg": gg, "time.steps": 40}
    scene = PAPER.with_values(flight | {"run.columns": ["displacement"]})
    row, history = execute(Case(scene, "dda"), "", "")
    found = {alarm.kind: alarm for alarm in contact_alarms.contact_alarms(scene, {"dda": row})}
    first, later = np.diff(history.displacement)[[0, 10]]
    constant = 0.0 if later == 0 else -10 * scene.time.step / math.log(later / first)
    assert found[contact_alarms.DRAG].values["constant"] == pytest.approx(constant, rel=1e-9)


def test_a_landing_is_not_known_for_every_scene():
    assert friction.sliding(SCENES["slides"].with_values({"load.gravity": 0.0, "load.slope": 0.0})) is None
    found = contact.restitution(PAPER)
    assert found.low < found.mean < found.high < found.own
    rules = {rule: PAPER.with_values(AVERAGE | {"contact.rule": rule}) for rule in ("implicit", "energy-conserving")}
    assert contact.restitution(rules["implicit"]).mean > 0
    assert contact.restitution(rules["energy-conserving"]) is None
    assert contact.restitution(PAPER.with_values({"block.vertices": [[0, 0], [2, 0], [2.2, 2], [0, 2]]})) is None
    rigid = PAPER.with_values({"contact.stiffness": math.inf, "contact.shear_stiffness": 0.0})
    assert contact.restitution(rigid).own == pytest.approx(0.8913, abs=1e-4)
