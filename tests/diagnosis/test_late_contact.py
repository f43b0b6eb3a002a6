"""Contact that switches late, or bears a tension, in a program of someone else's: named by what has an effect."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from oracles.program_scenes import scene_of
from oracles.sliding_block import Plain, run

from validation.diagnosis.judgement import compare
from validation.diagnosis.reading import Foreign

OPENS = Plain(steps=36, dt=0.001, p=3e9, alpha=0.25, delta=0.5, consistent=True, opens=True)


@pytest.mark.long
@pytest.mark.parametrize(
    ("slip", "cause"),
    [
        ({"lags": "opening"}, "late-opening"),
        ({"lags": "switching"}, "late-contact"),
        ({"tension": 1e6}, "opening-tension"),
        ({"band": 1e-3}, "dead-band"),
    ],
    ids=str,
)
def test_what_switches_a_contact_is_named(slip, cause):
    displacement, pressure = run(replace(OPENS, **slip))
    assert np.any(pressure == 0)
    time = OPENS.dt * np.arange(1, OPENS.steps + 1)
    scene = scene_of(OPENS).with_values({"contact.law": "unilateral"})
    answer = compare(scene, Foreign(time, displacement, pressure))
    assert answer.causes == [cause]
    if cause == "opening-tension":
        low, high = answer.intervals[cause]
        assert low <= slip["tension"] * 2 / OPENS.side <= high  # two corners, over the length of the base
