"""Contacts in the plane that are found: what they give equals what is stated, and the smallest cases of their rule."""

import math
from itertools import product

import numpy as np
import pytest
from conftest import thinned
from oracles.plane_scenes import CONSTANT, GRAVITY, SCHEMES, floor, rectangle, scheme

from dda import ContactSprings, CornerOnEdge, PlaneBlock, PlaneModel, solve_plane
from dda.contact.rows import OUTCOMES, TOO_DEEP
from dda.plane import solution

SPRINGS = ContactSprings(1e8, 4e7, 0.4)


def drop(height=0.05, young=math.inf):
    return PlaneModel(
        [floor(), PlaneBlock(rectangle(0, height, 2, 1), 2700.0, young, 0.2)], gravity=(0, -GRAVITY), found=SPRINGS
    )


@pytest.mark.long
def test_a_block_that_is_dropped_comes_to_rest_on_its_springs():
    result = solve_plane(drop(height=0.02, young=1e9), scheme((0.5, 1.0, 0.93), 1e-3), 300, every=5, compiled=False)
    weight = 5400.0 * GRAVITY
    assert result.outcome == "completed" and len(result.contacts) == 2
    assert {contact[2:] for contact in result.contacts} == {(0, 2)}
    for gap, first in zip(result.gap.T, np.argmax(result.state != 0, axis=0), strict=True):
        assert first > 3 and np.all(np.isnan(gap[:first])) and gap[first] < 0  # told of from the first touch on
    size = weight * 0.02
    assert np.abs(result.energy["balance"]).max() <= 1e-10 * size
    assert result.normal[-1].sum() == pytest.approx(weight, rel=0.02)
    # no corner deeper than weight and impact give: W/p and v sqrt(m/p) of half of the block
    speed = math.sqrt(2 * GRAVITY * 0.02)
    assert -np.nanmin(result.gap) < weight / 2e8 + speed * math.sqrt(5400.0 / 2e8) * 1.05


@pytest.mark.parametrize(("name", "dense"), thinned(product(SCHEMES, [solution.DENSE, 0]), 5))
def test_contacts_that_are_found_give_the_numbers_of_those_that_are_stated(name, dense, monkeypatch):
    """Few contacts by their forces, or as many are by the blocks."""
    monkeypatch.setattr(solution, "DENSE", dense)
    block = PlaneBlock(rectangle(0, 0.002, 2, 1), 2700.0, 1e9, 0.2, velocity=(3.0, -1.0), spin=-0.01)
    corners = [CornerOnEdge(1, corner, 0, 2, SPRINGS) for corner in (0, 1)]
    stated = solve_plane(PlaneModel([floor(), block], corners, gravity=(0, -GRAVITY)), SCHEMES[name], 25)
    free = PlaneModel([floor(), block], gravity=(0, -GRAVITY), found=SPRINGS)
    found = solve_plane(free, SCHEMES[name], 25, compiled=False)
    assert np.abs(found.displacement - stated.displacement).max() <= 1e-9 * np.abs(stated.displacement).max()
    columns = [found.contacts.index((1, corner, 0, 2)) for corner in (0, 1)]
    assert found.normal[:, columns] == pytest.approx(stated.normal, abs=1e-7 * stated.normal.max())
    assert np.array_equal(found.state[:, columns], stated.state)
    if name in ("average", "constant"):
        assert np.abs(found.energy["balance"]).max() <= 1e-10 * found.energy["kinetic"].max()


@pytest.mark.long
@pytest.mark.parametrize("young", [math.inf, 1e9])
def test_a_wall_without_gaps_stands(young):
    blocks = [PlaneBlock(rectangle(-1, -1, 4, 1), 2000.0, fixed=True)]
    for row in range(3):
        left = 0.2 * (row % 2)
        blocks += [
            PlaneBlock(rectangle(left + 0.4 * k, 0.2 * row, 0.4, 0.2), 2000.0, young, 0.2) for k in range(3 - row % 2)
        ]
    model = PlaneModel(blocks, gravity=(0, -GRAVITY), found=ContactSprings(1e9, 4e8, 0.6))
    result = solve_plane(model, scheme((0.5, 1.0, 0.9), 1e-3), 60, every=10, compiled=False)
    weight = 8 * 2000.0 * 0.08 * GRAVITY
    assert result.outcome == "completed" and np.abs(result.velocity[-1]).max() < 1e-4
    under = [contact.on == 0 or contact.block == 0 for contact in result.contacts]
    assert result.normal[-1][under].sum() == pytest.approx(weight, rel=1e-3)
    assert np.abs(result.energy["balance"]).max() <= 1e-10 * weight


def test_a_corner_that_is_deep_in_a_block_ends_the_history_by_name():
    model = PlaneModel([floor(), PlaneBlock(rectangle(0, -0.5, 2, 1), 2700.0)], gravity=(0, -GRAVITY), found=SPRINGS)
    result = solve_plane(model, scheme(CONSTANT, 1e-3), 5, compiled=False)
    assert result.outcome.startswith(f"{OUTCOMES[TOO_DEEP]} at step 1") and result.reached == 0
    assert result.unsettled == ((1, 0, 0, 2),)  # named tuples, which equal plain ones
