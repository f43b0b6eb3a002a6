"""Contact that switches late, or bears a tension, in a program of someone else's: named by what has an effect."""

from dataclasses import replace

import numpy as np
import pytest
from oracles.program_scenes import scene_of
from oracles.sliding_block import Plain, run

from validation.diagnosis import search
from validation.diagnosis.judgement import compare
from validation.diagnosis.reading import Foreign

OPENS = Plain(dt=0.001, p=3e9, alpha=0.25, delta=0.5, consistent=True, opens=True)


@pytest.mark.long
@pytest.mark.parametrize(
    ("slip", "cause"),
    [({"lags": "opening"}, "late-opening"), ({"lags": "switching"}, "late-contact"), ({"band": 1e-3}, "dead-band")],
    ids=str,
)
def test_what_switches_a_contact_is_named(slip, cause):
    assert judged(36, **slip).causes == [cause]


def judged(steps, **slip):
    displacement, pressure = run(replace(OPENS, steps=steps, **slip))
    assert np.any(pressure == 0)
    time = OPENS.dt * np.arange(1, steps + 1)
    return compare(scene_of(OPENS).with_values({"contact.law": "unilateral"}), Foreign(time, displacement, pressure))


@pytest.mark.parametrize("steps", [20, pytest.param(36, marks=pytest.mark.long)])
def test_a_tension_that_a_contact_bears_is_told_with_what_gives_the_same_rows(steps, monkeypatch):
    if steps == 20:
        monkeypatch.setattr(search, "moves", lambda *given: [])
    answer = judged(steps, tension=1e6)
    assert answer.causes == ["opening-tension"]
    low, high = answer.intervals["opening-tension"]
    assert low <= 1e6 * 2 / OPENS.side <= high  # two corners, over the length of the base
    assert f"({low:.3g} to {high:.3g} Pa" in answer.sentence
