"""What the adapters of programs in space share: angles beyond half a turn, and a ground that is long enough."""

import math

import numpy as np
import pytest
from peers.spatial import Rotation, accelerated_reach
from programs.rigid_scenes import rigid_scene


def test_an_angle_goes_on_beyond_half_a_turn_both_ways():
    angles = np.concatenate([np.arange(0.5, 20.0, 2.9), np.arange(20.0, -20.0, -2.9)])
    rotation = Rotation(0.5)
    followed = [rotation.follow(math.atan2(math.sin(angle), math.cos(angle))) for angle in angles]
    assert followed == pytest.approx(angles, abs=1e-9)


def test_the_ground_reaches_where_a_frictionless_box_slides_to():
    scene = rigid_scene({"x": 3.0, "velocity": (2.0, 0.0)}, slope=30.0, steps=1000)
    end = 3.0 + 2.0 * 10.0 + 9.81 * math.sin(math.radians(30.0)) * 10.0**2 / 2
    assert end + 0.5 < accelerated_reach(scene) < 2 * end


def test_the_ground_reaches_where_its_own_motion_takes_a_box():
    still = accelerated_reach(rigid_scene(steps=1000))
    moved = accelerated_reach(rigid_scene(base_amplitude=1.0, steps=1000))
    assert moved - still == pytest.approx(2 * 2 * math.pi * 10.0)  # twice the peak velocity of the ground, for 10 s
