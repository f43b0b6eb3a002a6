"""DART's adapter: that it states a scene of boxes rightly, by what DART's own integrator and impulses must give."""

import importlib
from importlib.util import find_spec

import numpy as np
import pytest
from oracles.box_scenes import box_scene
from peers.dart import FINE_STEP, OWN_STEP, Dart, World

if not find_spec("dartpy"):  # to import it takes seconds in every process that collects these tests
    pytest.skip("NOT RUN: DART is not installed", allow_module_level=True)
DEPTH = 1e-6  # m: DART lets a resting box sink by about g h^2 before its contact holds


def test_its_default_step_and_sleeping_are_those_of_a_new_world():
    world = importlib.import_module("dartpy").simulation.World()
    assert world.getTimeStep() == OWN_STEP
    assert world.getDeactivationOptions().mEnabled


def test_a_box_below_the_bouncing_speed_of_dart_does_not_bounce():
    """DART leaves restitution away below 0.1 m/s, which nothing sets from Python."""
    scene = box_scene({"velocity": (0.0, -0.05)}, restitution=1.0)
    assert np.max(Dart().solve(scene)["box_1.y"]) < 0.5 + 1e-4


def test_nothing_leaves_the_plane_though_nothing_holds_it_there():
    world = World(box_scene({}, {}, {"lift": 0.1}, friction=30.0), sleeps=False)
    for number in range(1000):
        world.advance(number * FINE_STEP, FINE_STEP)
    for body in world.bodies:
        transform = body.getWorldTransform().matrix()
        assert abs(transform[2, 3]) < DEPTH
        assert np.max(np.abs(transform[2, :2])) < DEPTH
