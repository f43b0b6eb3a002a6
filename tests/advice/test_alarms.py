"""Alarms are raised where they should be, stay silent where not, and reach verdicts."""

import json
from pathlib import Path

import numpy as np
import pytest
from conftest import beside

from validation.advice.alarms import AGREEMENT, RINGING, TENSION, Alarm, alarms, removed_motion
from validation.engine.run import finish, run_study
from validation.gates.gate import Gate
from validation.scenes.scene import Scene, load_scene
from validation.suite.declaration import Study

STIFFNESS = load_scene("figures-5-6")
STEPS = load_scene("model-form")


def raised(scene: Scene, finished_cases: Path, directory: Path, *solvers: str) -> dict[str, Alarm]:
    study = Study("test", "", "", [scene], solvers or ("dda", "bar", "continuum"))
    return {
        alarm.kind: alarm for alarm in alarms([scene], finish(study.cases(), study, beside(finished_cases, directory)))
    }


def test_agreement_by_damping_is_agreement_beside_what_it_cost(tmp_path: Path, finished_cases: Path) -> None:
    coarse = STEPS.expand()[0]
    alarm = raised(coarse, finished_cases, tmp_path)[AGREEMENT]
    assert alarm.values["agreement"] == pytest.approx(0.0081, abs=5e-5)
    assert alarm.values["removed"] > 0.9 and alarm.values["time error"] > 0.5
    light = load_scene("figure-9").expand()[3]  # damped by gg, which the continuum has as well
    assert AGREEMENT not in raised(light, finished_cases, tmp_path)


def test_what_damping_removes_is_algorithmic() -> None:
    scene = STEPS.expand()[1]
    n = np.arange(1, 101)
    assert removed_motion(scene, 0.9) == pytest.approx(1 - np.sqrt(np.mean(0.9 ** (2 * n))))
    assert removed_motion(scene, 1.0) == 0.0
    kinetic = scene.with_values({"time.gg": 0.81})
    assert removed_motion(kinetic, 0.9) == pytest.approx(0.0, abs=1e-12)


def test_contact_ringing_is_a_root_next_to_minus_one(tmp_path: Path, finished_cases: Path) -> None:
    soft, stiff, stiffest = STIFFNESS.expand()
    assert raised(stiffest, finished_cases, tmp_path)[RINGING].values["root"] == pytest.approx(-0.9733, abs=5e-5)
    assert RINGING not in raised(soft, finished_cases, tmp_path) and RINGING not in raised(
        stiff, finished_cases, tmp_path
    )


def test_alarms_reach_verdicts_and_the_manifest(tmp_path: Path, finished_cases: Path) -> None:
    scenes = STIFFNESS.expand()[1:]
    gates = tuple(Gate(scene.name, ("dda", "bar"), "displacement.l2", 0.0, 1.0, "any") for scene in scenes)
    study = Study("two", "", "", scenes, ("dda", "bar", "continuum"), gates=lambda: gates)
    run_study(study, beside(finished_cases, tmp_path))
    verdicts = json.loads((tmp_path / "verdicts.json").read_text())
    ringing = {v["scene"] for v in verdicts if RINGING in v["alarms"]}
    assert ringing == {"figures-5-6[contact.stiffness=1e+11]"}
    assert len(verdicts) == 2 and all(AGREEMENT in v["alarms"] for v in verdicts)
    kinds = {alarm["kind"] for alarm in json.loads((tmp_path / "studies/two.json").read_text())["alarms"]}
    assert kinds == {AGREEMENT, RINGING, TENSION}
