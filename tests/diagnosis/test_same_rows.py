"""Histories of which the rows tell less, or more, than a name: what else gives them is told, and nothing is guessed.

Each is made by a program of someone else's, and held to what can be known of it.
"""

from dataclasses import replace

import numpy as np
import pytest
from oracles.few_moves import only
from oracles.program_scenes import scene_of
from oracles.sliding_block import Plain, run

from validation.diagnosis.judgement import compare
from validation.diagnosis.reading import Foreign

PLAIN = Plain(steps=60)


def judged(base, columns):
    time = base.dt * np.arange(1, len(columns[0]) + 1)
    return compare(scene_of(base).with_values({"time.steps": len(columns[0])}), Foreign(time, *columns))


@pytest.mark.parametrize("discount", [1.0, pytest.param(0.98, marks=pytest.mark.long)])
def test_stiffness_damping_and_a_scheme_are_told_as_two(discount, monkeypatch):
    only(monkeypatch, "stiffness-damping", "viscous-damping", "scheme", "gg", "start")
    base = replace(PLAIN, gg=discount)
    answer = judged(base, run(replace(base, structural=1e-4)))
    assert answer.causes == ["unexplained"]
    assert {one["causes"][0] for one in answer.alike} == {"stiffness-damping", "scheme"}
