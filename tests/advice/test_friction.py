"""Advice and alarms of blocks with friction: true of runs, raised where they should be, silent where not."""

import tomllib
from pathlib import Path

import pytest

from validation import load_scene
from validation.advice import friction as advice
from validation.advice.alarms import alarms
from validation.engine.run import finish
from validation.engine.study import Study
from validation.runs.results import Results
from validation.runs.row import Row
from validation.runs.run import Outcome

ROWS = tomllib.loads(Path(__file__).with_name("raised.toml").read_text(encoding="utf-8"))["friction"]
SLIDES = load_scene("slope-drag").expand()[0]
STANDS = load_scene("creep-steps").expand()[1]  # 2 ms, constant acceleration


def raised(scene, directory):
    study = Study("test", "", "", [scene], ("dda",))
    found = alarms([scene], finish(study.cases(), study, Results(directory)))
    return {alarm.kind for alarm in found if alarm.kind in advice.KINDS}


@pytest.mark.parametrize(
    "row", [pytest.param(row, id=str(row), marks=[pytest.mark.long] * ("long" in row)) for row in ROWS]
)
def test_each_alarm_is_raised_where_it_should_be(row, tmp_path):
    scene = {"slides": SLIDES, "stands": STANDS}[row["scene"]].with_values(row["set"])
    assert raised(scene, tmp_path) == {getattr(advice, name) for name in row["raised"]}


def test_a_run_without_states_is_told_what_to_do():
    row = Row("", "", STANDS.name, "dda", Outcome.NO_CONTACT_STATE, {})
    (alarm, *_) = advice.friction_alarms(STANDS, {"dda": row})
    assert alarm.kind == advice.STATELESS
    assert "smaller time.step" in alarm.sentence
