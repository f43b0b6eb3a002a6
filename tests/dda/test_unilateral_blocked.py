"""Steps at once between switches: equal to steps one by one, with the digits of these, and where they are not used."""

from dataclasses import replace
from itertools import product

import numpy as np
import pytest
from conftest import thinned
from oracles import unilateral_mp
from oracles.unilateral_checks import apart, random_model

import dda.one_block.unilateral_phase as phases
from dda import Block, Material, Scheme, Unilateral, UnilateralModel, UnilateralOptions, solve_unilateral
from dda.one_block.unilateral import Stepping

BLOCK = Block.rectangle(2.0, 2.0, Material(2700.0, 1e9, 0.25))
PAPER = UnilateralModel(BLOCK, Unilateral(1e9), 5e6)
CONSTANT, AVERAGE = Scheme(0.5, 1.0, 1.0, 3e-5), Scheme(0.25, 0.5, 1.0, 3e-5, "consistent")
NAMES = ("normal_force_m", "normal_force_n", "shear_force_m", "shear_force_n", "gap_m", "gap_n", "shear_n", "velocity")


def singly(model, scheme, steps, monkeypatch, **options):
    """Make the same steps one by one."""
    with monkeypatch.context() as patch:
        patch.setattr(Stepping, "phase_of", lambda stepping, closed, steps: "asked for")
        result = solve_unilateral(model, scheme, steps, options=UnilateralOptions(**options))
    assert not result.history.glides
    return result


def differences(one, other):
    """Return the greatest difference of each quantity over its greatest value, and whether all states agree."""
    pairs = [(getattr(one, name), getattr(other, name)) for name in NAMES]
    pairs += list(zip(one.columns.values(), other.columns.values(), strict=True))
    off = [apart(a, b) for a, b in pairs]
    same = np.array_equal(one.closed_m, other.closed_m) and np.array_equal(one.closed_n, other.closed_n)
    return max(off), same and np.array_equal(one.step_cuts, other.step_cuts)


# Rounding of a few thousand steps, multiplied by each landing: of two glued corners by up to some thousand at p = 100E.
@pytest.mark.parametrize(
    ("eccentricity", "shear", "scheme"),
    thinned(product([0.0, 0.3], [0.0, 0.4], [CONSTANT, AVERAGE, Scheme(0.3025, 0.6, 0.9998, 3e-5)]), 5),
)
@pytest.mark.parametrize("p", [1e9, pytest.param(1e11, marks=pytest.mark.long)])
def test_steps_at_once_are_the_steps_one_by_one(p, eccentricity, shear, scheme, monkeypatch):
    model = replace(PAPER, contact=Unilateral(p, shear * p), eccentricity=eccentricity, gravity=3.0)
    result = solve_unilateral(model, scheme, 1100)
    off, same = differences(result, singly(model, scheme, 1100, monkeypatch))
    assert same and off < (1e-11 if p == 1e9 else 1e-7)
    assert 1 < len(result.history.glides) < 200
    assert np.count_nonzero(np.diff(result.closed_n)) > 1
    assert result.notes[-1] == "blocked between switches: contact opens and closes"


@pytest.mark.parametrize("seed", [0, 2, 5, *(pytest.param(seed, marks=pytest.mark.long) for seed in (1, 3, 4, 6, 7))])
def test_random_blocks_bands_and_shapes_too(seed, monkeypatch):
    model, scheme = random_model(seed), Scheme(0.5, 1.0, 0.999, 5e-5)
    if seed > 4:
        model = replace(model, contact=replace(model.contact, band=(1e-6, 2e-6)))
    result = solve_unilateral(model, scheme, 700)
    off, same = differences(result, singly(model, scheme, 700, monkeypatch))
    assert same and off < 1e-9 and result.history.glides


def test_all_unknowns_are_stepped_singly_if_all_are_asked_for():
    full = solve_unilateral(PAPER, CONSTANT, 200, options=UnilateralOptions(full=True))
    assert not full.history.glides and full.notes == ("stepped: contact opens and closes",)


# First landing after 32 steps of flight. The force of the landing step is p times what is left of the gap,
# a few roundings of the flight's length over the overshoot.
@pytest.mark.parametrize(
    "p", [pytest.param(1e13, marks=pytest.mark.long), 1e16, pytest.param(1e19, marks=pytest.mark.long)]
)
def test_no_digit_is_lost_with_stiff_corners(p, monkeypatch):
    block = Block.rectangle(2.0, 2.0, Material(2700.0, 1e9, 0.0))
    model, scheme = replace(PAPER, block=block, contact=Unilateral(p, 0.0)), Scheme(0.5, 1.0, 1.0, 1e-4)
    exact = unilateral_mp.history(model, scheme, 36)
    result, one = solve_unilateral(model, scheme, 36), singly(model, scheme, 36, monkeypatch)
    assert result.history.glides and result.closed_m.any()
    lost = [unilateral_mp.lost(r.normal_force_m, [row[1][0] for row in exact]) for r in (result, one)]
    assert lost[0] < 1e-12 and lost[1] < 1e-12
    assert unilateral_mp.lost(result.columns["displacement"], [row[0] for row in exact]) < 1e-14


def reason(scheme=CONSTANT, **contact):
    form = PAPER.form()
    law = Unilateral(**({"stiffness": 1e9} | contact))
    return phases.phase_of(form, law, scheme, (True,), 12)


def test_where_it_would_not_be_the_same_steps_are_made_singly():
    assert reason(stiffness=np.inf) == "the corners are rigid stops"
    assert reason(stiffness=1e50) == "w dt is outside 1e-15 to 1e+15"
    assert reason(Scheme(0.0, 0.5, 1.0, 1e-2)) == "a mode grows"
    assert not isinstance(reason(), str)


def test_a_table_is_made_of_every_number_of_steps():
    """Any number of steps leads where one step after the other does."""
    made = phases.phase_of(PAPER.form(), PAPER.contact, CONSTANT, (True,), 12)
    z = np.linspace(0.3, 1.0, made.maps.shape[1])
    here = z
    for steps in range(1, phases.BLOCK + 1):
        here = made.maps[0] @ here
        assert np.allclose(made.after(z, steps), here, rtol=0, atol=1e-12), steps


@pytest.mark.parametrize("gg", [1.0, 0.9])
def test_a_rigid_motion_is_that_of_its_steps(gg):
    linear, constant = phases.rigid_maps(gg, 0.3, 6)
    x, v = 0.7, 0.2
    for steps in range(1, 33):
        x, v = x + gg * v + 0.15, gg * v + 0.3
        if steps & (steps - 1) == 0:
            level = steps.bit_length() - 1
            assert linear[level] @ [0.7, 0.2] + constant[level] == pytest.approx([x, v], rel=1e-14)


def test_a_history_that_overflows_ends_where_single_steps_end(monkeypatch):
    model = replace(PAPER, pressure=-1e306)
    ends = [len(solve_unilateral(model, Scheme(0.5, 1.0, 1.0, 1.0), 500).time)]
    ends.append(len(singly(model, Scheme(0.5, 1.0, 1.0, 1.0), 500, monkeypatch).time))
    assert ends[0] == ends[1] < 500


def test_only_what_is_asked_for_is_made():
    result = solve_unilateral(PAPER, CONSTANT, 3000)
    kept = sum(part.blocks.size for part in result.history.glides)
    assert kept < 3000 and not {"_contacts", "closed_m", "_velocities"} & set(vars(result))
    assert result.gap_m.shape == (3000,) and "_contacts" in vars(result)
