"""Contacts in the plane that are found: what they give equals what is stated, and the smallest cases of their rule."""

from itertools import product

import numpy as np
import pytest
from conftest import thinned
from oracles.plane_scenes import CONSTANT, GRAVITY, SCHEMES, floor, rectangle, scheme

from dda import ContactSprings, CornerOnEdge, PlaneBlock, PlaneModel, solve_plane
from dda.contact.rows import OUTCOMES, TOO_DEEP
from dda.plane import solution

SPRINGS = ContactSprings(1e8, 4e7, 0.4)


@pytest.mark.parametrize(("name", "dense"), thinned(product(SCHEMES, [solution.DENSE, 0]), 5))
def test_contacts_that_are_found_give_the_numbers_of_those_that_are_stated(name, dense, monkeypatch, held):
    """Few contacts by their forces, or as many are by the blocks."""
    monkeypatch.setattr(solution, "DENSE", dense)
    block = PlaneBlock(rectangle(0, 0.002, 2, 1), 2700.0, 1e9, 0.2, velocity=(0.2, -1.0), spin=-0.01)
    corners = [CornerOnEdge(1, corner, 0, 2, SPRINGS) for corner in (0, 1)]
    stated = solve_plane(PlaneModel([floor(), block], corners, gravity=(0, -GRAVITY)), SCHEMES[name], 16)
    free = PlaneModel([floor(), block], gravity=(0, -GRAVITY), found=SPRINGS)
    found = solve_plane(free, SCHEMES[name], 16, compiled=False)
    assert np.abs(found.displacement - stated.displacement).max() <= 1e-9 * np.abs(stated.displacement).max()
    held(f"found by {name}", found)
    columns = [found.contacts.index((1, corner, 0, 2)) for corner in (0, 1)]
    assert found.normal[:, columns] == pytest.approx(stated.normal, abs=1e-7 * stated.normal.max())
    assert np.array_equal(found.state[:, columns], stated.state)
    if name in ("average", "constant"):
        assert np.abs(found.energy["balance"]).max() <= 1e-10 * found.energy["kinetic"].max()


def test_a_corner_that_is_deep_in_a_block_ends_the_history_by_name():
    model = PlaneModel([floor(), PlaneBlock(rectangle(0, -0.5, 2, 1), 2700.0)], gravity=(0, -GRAVITY), found=SPRINGS)
    result = solve_plane(model, scheme(CONSTANT, 1e-3), 5, compiled=False)
    assert result.outcome.startswith(f"{OUTCOMES[TOO_DEEP]} at step 1") and result.reached == 0
    assert result.unsettled == ((1, 0, 0, 2),)  # named tuples, which equal plain ones
