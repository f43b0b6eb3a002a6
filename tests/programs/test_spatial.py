"""What the adapters of programs in space share: angles beyond half a turn."""

import math

import numpy as np
import pytest
from peers.spatial import Rotation


def test_an_angle_goes_on_beyond_half_a_turn_both_ways():
    angles = np.concatenate([np.arange(0.5, 20.0, 2.9), np.arange(20.0, -20.0, -2.9)])
    rotation = Rotation(0.5)
    followed = [rotation.follow(math.atan2(math.sin(angle), math.cos(angle))) for angle in angles]
    assert followed == pytest.approx(angles, abs=1e-9)
