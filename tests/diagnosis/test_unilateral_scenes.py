"""Histories beside scenes whose contact opens, which candidate changes step as the suite's own solver does."""

from __future__ import annotations

import numpy as np
import pytest

from validation import load_scene, solve
from validation.diagnosis.judgement import compare
from validation.diagnosis.reading import Foreign
from validation.errors import InputError

SCENE = load_scene("figures-3-4").with_values(
    {"time.step": 5e-4, "time.steps": 30, "contact.law": "unilateral", "run.solvers": ["dda"]}
)


def judged(**changes):
    run = solve(SCENE.with_values({key.replace("__", "."): value for key, value in changes.items()}), "dda")
    return compare(SCENE, Foreign(run.time, run.displacement, run.contact_pressure))


@pytest.mark.parametrize(
    ("changes", "causes"),
    [
        ({}, []),
        ({"contact__law": "locked"}, ["contact-locked"]),
        pytest.param({"block__young": 0.8e9}, ["young-factor"], marks=pytest.mark.long),
        pytest.param({"time__gg": 0.97}, ["gg"], marks=pytest.mark.long),
        pytest.param({"load__gravity": 9.81}, ["own-weight"], marks=pytest.mark.long),
        pytest.param({"time__alpha": 0.25, "time__delta": 0.5}, ["scheme"], marks=pytest.mark.long),
    ],
)
def test_a_history_of_opening_contact(changes, causes):
    answer = judged(**changes)
    assert answer.causes == causes
    assert (answer.opened is None) == (causes == ["contact-locked"])
    assert answer.departs == bool(causes)
    assert (answer.departure is None) == (set(causes) <= {"own-weight"})


@pytest.mark.long
def test_a_dead_band_between_two_closings_is_named():
    """Wider than what the springs carry at rest; from 0.93 to 1.07 mm the rows are the same."""
    stiff = {"contact.stiffness": 3e10, "block.young": 3e9, "block.density": 2900.0, "load.pressure": 6e6}
    plain = SCENE.with_values(stiff | {"time.step": 2e-4, "time.steps": 80})
    banded = solve(plain.with_values({"contact.band": [1e-3, 1e-6]}), "dda")
    answer = compare(plain, Foreign(banded.time, banded.displacement))
    assert answer.causes == ["dead-band"]
    low, high = answer.intervals["dead-band"]
    assert low < 1e-3 < high


def test_a_scene_with_a_gap_is_refused_for_its_gap_and_not_for_its_weight():
    scene = SCENE.with_values({"contact.gap": 1e-3, "load.gravity": 9.81})
    with pytest.raises(InputError, match=r"contact\.gap = 0\.001$"):
        compare(scene, Foreign(np.arange(1, 9) * 5e-4, -np.ones(8)))
