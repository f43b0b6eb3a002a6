"""Blocks in the plane on contacts that a scene states: closed forms, invariants, accounts."""

import math
from dataclasses import replace

import numpy as np
import pytest
from conftest import thinned
from oracles.plane_scenes import CONSTANT, GRAVITY, SCHEMES, rectangle, scheme, slope

from dda import (
    BaseMotion,
    ContactSprings,
    CornerOnEdge,
    EdgeBond,
    PlaneBlock,
    PlaneModel,
    solve_plane,
)
from dda.contact.rows import FOUND, INSIDE, LOWER, NONE, OUTCOMES
from dda.march.step import steps_by
from dda.plane import outcomes, solution, step
from dda.plane.outcomes import contact_name, stated_contacts
from dda.plane.solution import PlaneContact


@pytest.mark.parametrize(("friction", "speed"), thinned([((0.3, 0.6), 0.28998), ((0.7, 0.6), 0.0)], 2))
def test_two_blocks_on_a_slope_slide_together(friction, speed, held):
    result = solve_plane(slope(*friction), scheme(CONSTANT, 2e-3), 100, every=25, compiled=False)
    assert result.outcome == "completed"
    # a = g (sin b - cos b mean tan(phi)) of equal masses; the first steps stress the springs
    since = [len(result.time) // 2, -1]
    gained = np.diff(result.velocity[since, 1:, 0], axis=0)
    assert 2 * gained / np.diff(result.time[since]) == pytest.approx(speed, abs=1e-5)
    assert np.abs(result.energy["balance"]).max() <= 1e-10 * max(result.energy["kinetic"].max(), 1.0)
    assert np.abs(result.angle).max() < 1e-3
    held(f"slope {friction}", result)


def test_glue_closes_a_ring_of_blocks_and_carries_what_a_part_of_it_weighs(held):
    """Two halves of a bar, glued at one end to a wall: the joint carries the weight of what hangs on it."""
    wall = PlaneBlock(rectangle(-1, 0, 1, 1), 2000.0, fixed=True)
    halves = [PlaneBlock(rectangle(x, 0, 1, 1), 2000.0) for x in (0, 1)]
    bonds = [EdgeBond(i, i + 1, (i, 0.0), (i, 1.0), 1e10, 1e10) for i in (0, 1)]
    damped = scheme((0.5, 1.0, 0.6), 1e-3)
    result = solve_plane(PlaneModel([wall, *halves], bonds=bonds, gravity=(0.0, -GRAVITY)), damped, 120)
    weight = 2000.0 * GRAVITY
    forces = result.bond[-1].sum(axis=1)
    assert forces[:, 0] == pytest.approx(0.0, abs=1e-4 * weight)  # the bar sags
    assert np.abs(forces[:, 1]) == pytest.approx([2 * weight, weight], rel=1e-5)
    held("glued ring", result)
    moments = result.bond[-1, :, 1, 0] - result.bond[-1, :, 0, 0]  # of a couple of unit arm, by half of it
    assert np.abs(moments / 2) == pytest.approx([2 * weight, weight / 2], rel=1e-4)


def test_a_driven_floor_gives_its_work_to_what_stands_on_it(held):
    time = np.linspace(0, 0.5, 51)
    motion = BaseMotion(time, np.column_stack([0.02 * np.sin(12 * time), 0.005 * (1 - np.cos(20 * time))]))
    base = PlaneBlock(rectangle(-5, -1, 10, 1), 2000.0, motion=motion)
    block = PlaneBlock(rectangle(0, 0, 1, 0.5), 2000.0, 1e8, 0.2)
    springs = ContactSprings(1e8, 4e7, 0.5)
    model = PlaneModel([base, block], [CornerOnEdge(1, k, 0, 2, springs) for k in (0, 1)], gravity=(0.0, -GRAVITY))
    result = solve_plane(model, scheme((0.3025, 0.6, 0.999), 2e-3), 35)
    assert result.outcome == "completed" and set(result.state.ravel()) >= {1, 2}
    assert np.abs(result.energy["balance"]).max() <= 1e-10 * result.energy["kinetic"].max()
    assert result.energy["friction"][-1] > 0
    held("driven floor", result)


@pytest.mark.parametrize("young", thinned([1e8, math.inf], 2))
def test_two_free_blocks_that_meet_off_centre_keep_their_momentum(young, held):
    """The edge belongs to a block that turns: its turn is part of every row."""
    struck = PlaneBlock([(-1, -0.5), (1, -0.5), (1, 0.44), (-1, 0.84)], 2000.0, young, 0.2, spin=0.5)
    corner = PlaneBlock([(0.7, 0.502), (1.3, 1.2), (0.2, 1.3)], 2000.0, young, 0.2, velocity=(0.2, -2.0))
    contacts = [CornerOnEdge(1, 0, 0, 2, ContactSprings(1e7, 4e6, 0.3))]
    result = solve_plane(PlaneModel([struck, corner], contacts), scheme(CONSTANT, 6e-4), 50, compiled=False)
    held(f"two free blocks of {young}", result)
    assert result.normal.max() > 0 and not result.normal[-1].any()
    drift = np.ptp(result.momentum, axis=0)
    assert drift[:2].max() <= 1e-11 * np.abs(result.momentum[:, :2]).max()
    assert drift[2] <= 1e-6 * np.abs(result.momentum[0, 2])
    assert np.abs(result.energy["balance"]).max() <= 1e-11 * result.energy["kinetic"][0]


@pytest.mark.parametrize("name", ["composite", pytest.param("average", marks=pytest.mark.long)])
def test_a_step_that_fails_is_made_in_parts_and_keeps_its_accounts(name, monkeypatch, held):
    """Parts of 0.3 and 0.7 of every third step move what touches as whole steps do, but for their error."""

    def stubborn(march, stage, start, before, after, course, part):
        outcome, solves = step.make_stage(march, stage, start, before, after, course, part)
        return (NONE if part.ratio == 1 and part.begun % 3 == 1 else outcome), solves

    model = slope(0.3, 0.6, 1e8)
    whole = solve_plane(model, SCHEMES[name], 6)
    monkeypatch.setattr(solution, "make_steps", steps_by(stubborn, step.account, step.keep, step.keep_rows))
    parts = solve_plane(model, SCHEMES[name], 6)
    held("parts of steps", parts)
    assert parts.outcome == OUTCOMES[FOUND] and parts.cuts.tolist() == [0, *(0, 1, 0) * 2]
    assert np.abs(parts.energy["balance"]).max() <= 1e-10 * parts.energy["kinetic"].max()
    assert parts.displacement == pytest.approx(whole.displacement, abs=0.02 * np.abs(whole.displacement).max())


def test_contacts_whose_states_go_round_are_named(monkeypatch):
    """The search comes back after two states, in which one of six contacts opens and closes."""
    monkeypatch.setattr(step, "find", lambda *_: (NONE, 7))
    monkeypatch.setattr(step, "find_many", lambda *_: (NONE, 7))
    solved = []
    monkeypatch.setattr(outcomes, "solve", lambda *given: solved.append(len(given)))

    def turned(laws, flexible, after, work, together):
        work.tried[3] = LOWER if work.tried[3] == INSIDE else INSIDE

    monkeypatch.setattr(outcomes, "update", turned)
    monkeypatch.setattr(solution, "make_steps", steps_by(step.make_stage, step.account, step.keep, step.keep_rows))
    result = solve_plane(slope(0.3, 0.6), scheme(CONSTANT, 1e-3), 3, compiled=False)
    assert result.reached == 0 and result.outcome.startswith(OUTCOMES[NONE])
    assert result.unsettled == (PlaneContact(2, 1, 0, 2),) and solved == [5, 5]


def test_contacts_are_named_by_their_blocks():
    base = PlaneBlock(rectangle(0, -1, 1, 1), 1000.0, fixed=True, name="base")
    model = PlaneModel([base, PlaneBlock(rectangle(0, 0, 1, 1), 1000.0, name="upper")])
    assert contact_name(model, PlaneContact(1, 2, 0, 3)) == "corner 2 of upper on edge 3 of base"
    joined = replace(model, bonds=[EdgeBond(1, 0, (0, 0), (1, 0), 1.0, 1.0)])
    assert stated_contacts(joined) == [PlaneContact(1, -1, 0, -1)] * 2
    assert contact_name(model, PlaneContact(1, -1, 0, -1)) == "glue of upper and base"
