"""One block with friction: histories known by their events, sliding as an identity."""

import numpy as np
import pytest
from conftest import thinned
from oracles.contact_bodies import DT, apart, shaken

from dda import BaseMotion, Block, Material, Scheme, Unilateral, UnilateralModel, solve_unilateral


@pytest.mark.parametrize("turned", thinned([50.0, -30.0], 2))
def test_a_polygon_on_any_edge_slides_as_it_does_on_a_level_one(turned):
    corners = np.array([[0.0, 0.0], [1.6, 0.0], [2.1, 0.9], [1.2, 1.7], [0.1, 1.2]])
    angle = np.radians(turned)
    R = np.array([[np.cos(angle), -np.sin(angle)], [np.sin(angle), np.cos(angle)]])
    material, law = Material(2500.0, 2e9, 0.2), Unilateral(3e9, 2e9, 1e-5, friction=0.3, cohesion=500.0)
    shakes = shaken(np.random.default_rng(7), 2e-5)
    level = UnilateralModel(Block(corners, material), law, gravity=9.81, slope=10.0, motion=shakes)
    block = Block(np.roll(corners @ R.T, 3, axis=0), material)
    motion = BaseMotion(shakes.time, shakes.displacement @ R.T)
    leant = UnilateralModel(block, law, base=3, top=0, gravity=9.81, slope=10.0 + turned, motion=motion)
    one, other = (solve_unilateral(model, Scheme(0.5, 1.0, 0.99, DT), 150) for model in (level, leant))
    assert np.array_equal(one.states, other.states) and {1, 2, -2} & set(one.states.ravel()) == {1, 2, -2}
    for name in ("normal", "shear", "gap", "slide", "slip"):
        assert apart(getattr(other, name), getattr(one, name)) < 1e-8, name
