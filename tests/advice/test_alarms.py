"""Alarms are raised where they should be, stay silent where not, and reach verdicts."""

import pytest
from conftest import beside

from validation.advice.alarms import alarms
from validation.advice.coarse import AGREEMENT, SAMPLED
from validation.engine.run import finish
from validation.scenes.scene import load_scene
from validation.suite.declaration import Study

STEPS = load_scene("model-form")


def raised(scene, finished_cases, directory, *solvers):
    study = Study("test", "", "", [scene], solvers or ("dda", "bar", "continuum"))
    return {
        alarm.kind: alarm for alarm in alarms([scene], finish(study.cases(), study, beside(finished_cases, directory)))
    }


@pytest.mark.long  # pages of `run` name this alarm
def test_agreement_by_damping_is_told_beside_what_agrees(tmp_path, finished_cases):
    coarse, *_, fine = sorted(STEPS.expand(), key=lambda scene: -scene.time.step)
    alarms_of_coarse = raised(coarse, finished_cases, tmp_path)
    assert alarms_of_coarse[AGREEMENT].values["damping"] == pytest.approx(0.3722, abs=1e-4)
    assert "0.81 %" in alarms_of_coarse[AGREEMENT].sentence and SAMPLED in alarms_of_coarse
    assert not {AGREEMENT, SAMPLED} & raised(fine, finished_cases, tmp_path).keys()
    light = load_scene("figure-9").expand()[3]  # damped by gg, which is meant
    assert AGREEMENT not in raised(light, finished_cases, tmp_path)
