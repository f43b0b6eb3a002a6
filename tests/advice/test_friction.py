"""Advice and alarms of blocks with friction: true of runs, raised where they should be, silent where not."""

import pytest

from validation import load_scene
from validation.advice import friction as advice
from validation.advice.alarms import alarms
from validation.engine.run import finish
from validation.engine.study import Study
from validation.runs.results import Results
from validation.runs.row import Row
from validation.runs.run import Outcome

SLIDES = load_scene("slope-drag").expand()[0]
STANDS = load_scene("creep-steps").expand()[1]  # 2 ms, constant acceleration


def raised(scene, directory):
    study = Study("test", "", "", [scene], ("dda",))
    found = alarms([scene], finish(study.cases(), study, Results(directory)))
    return {alarm.kind for alarm in found if alarm.kind in advice.KINDS}


@pytest.mark.parametrize(
    ("scene", "values", "expected"),
    [
        (STANDS, {"time.steps": 100}, {advice.HIDES}),
        (STANDS, {"time.step": 2e-4, "time.steps": 1000}, {advice.CREEPS}),  # still slipping after 0.1 s
        pytest.param(STANDS, {"time.step": 2e-4, "time.steps": 5000}, set(), marks=pytest.mark.long),  # it has stopped
        (STANDS, {"time.step": 2e-4, "time.steps": 800, "time.alpha": 0.25, "time.delta": 0.5}, {advice.CREEPS}),
        (STANDS, {"contact.rules": "lagged", "contact.friction": 22.0}, {advice.CREEPS, advice.HIDES, advice.LAGS}),
        (STANDS, {"load.slope": 0.0, "time.steps": 50}, set()),
        (SLIDES, {}, {advice.BRAKES}),
        (SLIDES, {"time.gg": 1.0}, set()),
        (SLIDES, {"contact.law": "unilateral", "load.pressure": 1e6, "time.steps": 20}, set()),  # no formula
    ],
)
def test_each_alarm_is_raised_where_it_should_be(scene, values, expected, tmp_path):
    assert raised(scene.with_values(values), tmp_path) == expected


def test_a_run_without_states_is_told_what_to_do():
    row = Row("", "", STANDS.name, "dda", Outcome.NO_CONTACT_STATE, {})
    (alarm, *_) = advice.friction_alarms(STANDS, {"dda": row})
    assert alarm.kind == advice.STATELESS
    assert "smaller time.step" in alarm.sentence
