"""Histories beside scenes whose contact opens, which candidate changes step as the suite's own solver does."""

import numpy as np
import pytest
from oracles.few_moves import only

from validation import load_scene, solve
from validation.diagnosis.judgement import compare
from validation.diagnosis.reading import Foreign
from validation.errors import InputError

SCENE = load_scene("figures-3-4").with_values(
    {"time.step": 5e-4, "time.steps": 30, "contact.law": "unilateral", "run.solvers": ["dda"]}
)


@pytest.mark.parametrize(
    ("changes", "causes"),
    [
        ({}, []),
        pytest.param({"contact.law": "locked"}, ["contact-locked"], marks=pytest.mark.long),
        pytest.param({"block.young": 0.8e9}, ["young-factor"], marks=pytest.mark.long),
        pytest.param({"time.gg": 0.97}, ["gg"], marks=pytest.mark.long),
        pytest.param({"load.gravity": 9.81}, ["own-weight"], marks=pytest.mark.long),
        pytest.param({"time.alpha": 0.25, "time.delta": 0.5}, ["scheme"], marks=pytest.mark.long),
    ],
)
def test_a_history_of_opening_contact(changes, causes, monkeypatch):
    only(monkeypatch, "contact-locked", "gg", "young-factor", "own-weight", "scheme")
    run = solve(SCENE.with_values(changes), "dda")
    answer = compare(SCENE, Foreign(run.time, run.displacement, run.contact_pressure))
    assert answer.causes == causes
    assert (answer.opened is None) == (causes == ["contact-locked"])
    assert answer.departs == bool(causes)
    assert (answer.departure is None) == (set(causes) <= {"own-weight"})


def test_a_scene_with_a_gap_is_refused_for_its_gap_and_not_for_its_weight():
    scene = SCENE.with_values({"contact.gap": 1e-3, "load.gravity": 9.81})
    with pytest.raises(InputError, match=r"contact\.gap = 0\.001$"):
        compare(scene, Foreign(np.arange(1, 9) * 5e-4, -np.ones(8)))


def test_a_motion_that_rounding_changes_is_judged_up_to_there():
    values = {"time.step": 1e-3, "time.steps": 160, "time.alpha": 0.25, "time.delta": 0.5, "time.start": "consistent"}
    theirs, own = (SCENE.with_values({**values, "contact.stiffness": k}) for k in (1e11 + 1e-3, 1e11))
    run = solve(theirs, "dda")
    answer = compare(own, Foreign(run.time, run.displacement, run.contact_pressure))
    assert answer.causes == [] and "two correct codes agree up to" in answer.notes[-1]
