"""A foundation's motion is linear between its instants and held beyond them."""

import numpy as np

from fem_reference.problem.motion import Motion


def test_a_record_is_linear_between_its_instants_and_held_beyond_them():
    motion = Motion((1.0, 3.0), (0.0, 4.0), (1.0, 0.0))
    assert np.array_equal(motion(np.array([0.0, 2.0, 9.0])), [[0.0, 1.0], [2.0, 0.5], [4.0, 0.0]])
    assert motion.sideways
    assert not Motion((0.0, 1.0), (0.0, 0.0), (0.0, 1.0)).sideways
