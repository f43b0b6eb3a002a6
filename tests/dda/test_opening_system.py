"""Sub-blocks on a base that opens: one is the block, a base that stays closed is locked; invariants of each step."""

from dataclasses import replace

import numpy as np
import pytest
from conftest import thinned

import dda.bodies.glued_step as step
from dda import (
    Block,
    Contact,
    Material,
    Scheme,
    TwoBlockModel,
    Unilateral,
    UnilateralModel,
    UnilateralOptions,
    opening_subdivided,
    solve_system,
    solve_unilateral,
    subdivided,
)
from dda.bodies.glued_step import make_stage
from dda.contact.rows import NONE
from dda.march.step import steps_by

MATERIAL = Material(2700.0, 1e9, 0.2)
PAPER = UnilateralModel(Block.rectangle(2.0, 2.0, MATERIAL), Unilateral(1e9, 1e9), 5e6)
ENERGIES = UnilateralOptions(energies=True)
GLUE = 1e15
CONSTANT = Scheme(0.5, 1.0, 1.0, 3e-4)


def run(model, counts=(3, 2), scheme=CONSTANT, steps=150, glue=GLUE, pattern="squares", options=ENERGIES):
    return solve_unilateral(opening_subdivided(model, *counts, glue, pattern), scheme, steps, options=options)


@pytest.mark.parametrize(("eccentricity", "pattern"), thinned([(0.2, "triangles"), (0.0, "squares")], 2))
def test_a_base_that_never_opens_is_the_locked_one(eccentricity, pattern):
    scheme, columns = Scheme(0.5, 1.0, 0.98, 1e-2), ("displacement", "contact_pressure", "rotation")
    locked = TwoBlockModel(PAPER.block, Contact(1e9, 0.4e9), 3.1e6, eccentricity=eccentricity)
    opens = replace(PAPER, contact=Unilateral(1e9, 0.4e9), pressure=3.1e6, eccentricity=eccentricity)
    one = solve_system(subdivided(locked, 3, 2, 1e12, pattern), scheme, 20, columns)
    other = solve_unilateral(opening_subdivided(opens, 3, 2, 1e12, pattern), scheme, 20, columns)
    assert np.all(other.closed) and np.all(other.step_solves == 1)
    for name in columns:
        assert np.max(np.abs(one.columns[name] - other.columns[name])) <= 1e-10 * np.max(
            np.abs(one.columns[name]), initial=1e-4
        ), name


def test_a_cut_step_begins_from_the_saved_state(monkeypatch):
    given = []

    def stubborn(march, stage, start, before, after, course, part):
        given.append((part.ratio, start, [np.copy(part) for part in (start.z, start.p, start.a, start.glue)]))
        outcome, solves = make_stage(march, stage, start, before, after, course, part)
        return (NONE if len(given) <= 2 else outcome), solves

    monkeypatch.setattr(step, "make_steps", steps_by(stubborn, step.account, step.keep))
    model = replace(PAPER, contact=Unilateral(1e9, gap=1.0), pressure=0.0, velocity=-0.8)
    result = run(model, (2, 1), replace(CONSTANT, gg=0.9), 3)
    assert [ratio for ratio, *_ in given[:4]] == pytest.approx([1.0, 0.3, 0.09, 0.91])
    for _, state, copy in given[:3]:
        assert state is given[0][1]
        assert all(np.array_equal(one, other) for one, other in zip(given[0][2], copy, strict=True))
    assert result.step_cuts.tolist() == [2, 0, 0]
    assert result.velocity == pytest.approx(-0.8 * 0.9 ** np.arange(1, 4), rel=1e-12)
