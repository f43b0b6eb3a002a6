"""Sub-blocks that rub on their base: one of them is the block, and of many every point obeys the law."""

from dataclasses import replace

import numpy as np
import pytest
from conftest import thinned
from oracles.frictional import KNOWN, rubbing_model, shaken
from oracles.unilateral_checks import DT, apart

from dda import Scheme, UnilateralOptions, opening_subdivided, solve_opening_system, solve_unilateral
from dda.contact import rubbing_points
from dda.contact.iteration import NONE, SEVERAL
from dda.contact.points import FreePoints, Points
from dda.contact.rubbing_points import find_points, states
from dda.contact.unilateral import OPEN, SLIP, STICK, Unilateral

ENERGIES = UnilateralOptions(energies=True)
SCHEMES = [(0.5, 1.0, 1.0, "zero"), (0.25, 0.5, 0.99, "consistent")]
FIELDS = ("normal", "shear", "gap", "slide", "slip")


@pytest.mark.parametrize(("name", "moving"), thinned([("rubbing", True), ("incline", True), ("pulled", False)], 3))
def test_one_sub_block_is_the_block(name, moving):
    model, scheme = KNOWN[name].model, Scheme(0.5, 1.0, 1.0, 2e-4)
    model = replace(model, motion=shaken(np.random.default_rng(0), 1e-4) if moving else None)
    block = solve_unilateral(model, scheme, 150, options=ENERGIES)
    one = solve_opening_system(opening_subdivided(model, 1, 1, 1e15), scheme, 150, options=ENERGIES)
    assert np.array_equal(one.states, block.states) and np.any(np.abs(one.states) == 2)
    for field in FIELDS:
        assert apart(getattr(one, field), getattr(block, field)) < 1e-10, field
    for name in ("friction", "load", "springs"):
        assert one.energies[name] == pytest.approx(block.energies[name], rel=1e-9, abs=1e-9 * np.max(block.normal))
    assert np.ptp(sum(one.energies.values())) < 1e-9 * np.max(np.abs(one.energies["load"]))
    assert one.columns["displacement"] == pytest.approx(block.columns["displacement"], rel=1e-9, abs=1e-12)


@pytest.mark.parametrize("seed", thinned(range(24), 12))
@pytest.mark.parametrize("scheme", SCHEMES)
def test_every_point_obeys_the_law(seed, scheme):
    alpha, delta, gg, start = scheme
    opening = opening_subdivided(rubbing_model(seed), 3, 2, 1e13)
    law = opening.law
    result = solve_opening_system(opening, Scheme(alpha, delta, gg, DT, start), 60, options=ENERGIES)
    assert result.outcome == "completed"
    limit, size = np.where(result.closed, law.friction * result.normal + law.cohesion, 0.0), np.max(result.normal)
    assert np.all(result.normal >= 0) and np.all(result.gap[~result.closed] >= 0)
    assert np.max(np.abs(result.shear) - limit) <= 2e-12 * size
    slips = np.abs(result.states) == 2
    assert np.max(np.abs(np.abs(result.shear) - limit)[slips], initial=0.0) <= 1e-13 * size
    whole = result.step_cuts == 0
    assert np.all((result.slipped * result.states)[:, whole] >= 0)
    assert np.min(np.diff(result.energies["friction"])) >= 0
    total = sum(result.energies.values())
    assert np.ptp(total) < 1e-11 * np.max(np.abs(list(result.energies.values())))
    stored = sum(result.energies[name] for name in ("kinetic", "strain", "springs", "load"))
    assert delta < 1 or np.max(np.diff(stored)) < 1e-11 * np.max(np.abs(total))


def test_cohesion_is_shared_among_the_points():
    model = KNOWN["incline"].model
    law = replace(model.contact, cohesion=6e3)
    opening = opening_subdivided(replace(model, contact=law), 4, 1, 1e12)
    assert opening.law.cohesion * len(opening.normals) == pytest.approx(2 * law.cohesion)
    assert opening.law.friction == law.friction


def three(slope=1.0):
    """Return a law, three points that were pressed, and a step that pushes them along."""
    law = Unilateral(1e9, 4e8, friction=0.5)
    pressed = np.full(3, 1e5)
    before = Points(np.ones(3, dtype=bool), -pressed / 1e9, np.zeros(3), pressed, np.zeros(3))
    soft = 1e-9 * (np.eye(6) + 0.1)
    return law, before, FreePoints(np.array([-1e-4, -2e-4, 5e-4]), np.full(3, slope * 1e-3), soft)


def test_points_stick_slip_and_open_at_once():
    law, before, free = three()
    found = find_points(law, before, free, 6)
    assert states(found.points).tolist() == [SLIP, SLIP, OPEN]
    back = find_points(law, before, three(-1.0)[2], 6).points
    assert states(back).tolist() == [-SLIP, -SLIP, OPEN]
    held = find_points(replace(law, cohesion=1e6), before, free, 6).points
    assert states(held).tolist() == [STICK, STICK, OPEN]


def test_what_does_not_end_is_set_one_point_at_a_time_then_tried_then_cut(monkeypatch):
    law, before, free = three()
    found = find_points(law, before, free, 6)
    singly = rubbing_points._one_by_one.__name__
    one = getattr(rubbing_points, singly)(law, before, free, states(before), 0)
    assert np.array_equal(states(one.points), states(found.points)) and one.solves > found.solves
    monkeypatch.setattr(rubbing_points, "agreeing", lambda law, tried: np.where(states(tried) == OPEN, STICK, OPEN))
    assert find_points(law, before, free, 2).failure == NONE
    calls = []

    def agreeing(law, tried):
        calls.append(1)
        return states(tried) if len(calls) > 20 else np.where(states(tried) == OPEN, STICK, OPEN)

    monkeypatch.setattr(rubbing_points, "agreeing", agreeing)
    assert find_points(law, before, free, 2).failure == SEVERAL
    monkeypatch.setattr(rubbing_points, "TRIED", 2)
    monkeypatch.setattr(rubbing_points, "agreeing", lambda law, tried: np.where(states(tried) == OPEN, STICK, OPEN))
    assert find_points(law, before, free, 2).failure == NONE


def test_what_points_cannot_do_is_refused():
    model, scheme = KNOWN["incline"].model, Scheme(0.5, 1.0, 1.0, 1e-3)
    late = replace(model, contact=replace(model.contact, rules="lagged"))
    with pytest.raises(ValueError, match=r"^rules: sub-blocks take consistent friction alone"):
        solve_opening_system(opening_subdivided(late, 2, 1, 1e12), scheme, 5)
