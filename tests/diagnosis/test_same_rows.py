"""Histories of which the rows tell less, or more, than a name: what else gives them is told, and nothing is guessed.

Each is made by a program of someone else's, and held to what can be known of it.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from oracles.few_moves import only
from oracles.program_scenes import scene_of
from oracles.sliding_block import Plain, run

from validation.diagnosis.fits.fit import fit_one
from validation.diagnosis.fits.target import Target
from validation.diagnosis.judgement import compare
from validation.diagnosis.moves import Move
from validation.diagnosis.reading import Foreign
from validation.diagnosis.search import Explanation, is_determined
from validation.diagnosis.stepping import histories
from validation.diagnosis.variant import Rectangle, Variant

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


@pytest.mark.parametrize(("factor", "determined"), [(1e5, False), (1.3, True)])
def test_a_factor_that_may_as_well_be_ten_times_as_large_is_no_number(factor, determined):
    """Five digits of a block that is a hundred thousand times as stiff do not tell it from a rigid one."""
    rectangle = Rectangle(2.0, 2.0, 2700.0, 1e9, 0.0, False, 2e9, 2e9, 5e6)
    own = Variant(0.5, 1.0, 1.0)
    steps = np.full(60, 2e-3)
    made = histories(rectangle, [replace(own, young=factor, softness=0.3)], steps).displacement[:, 0]
    rounded = np.array([float(f"{value:.4e}") for value in made])
    target = Target(rectangle, steps, np.arange(60), rounded[None])
    free = ("young", "softness")
    causes = (Move("young-factor", {}, free[:1]), Move("springs-factor", {}, free[1:]))
    explanation = Explanation(causes, fit_one(target, replace(own, young=factor, softness=0.3), free))
    assert is_determined(target, fit_one(target, own), explanation) is determined
