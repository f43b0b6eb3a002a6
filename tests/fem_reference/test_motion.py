"""A foundation's motion is a record of increasing instants and finite numbers."""

from __future__ import annotations

import math

import numpy as np
import pytest

from fem_reference.problem.motion import Motion


@pytest.mark.parametrize(
    ("time", "x", "y"),
    [
        ((), (), ()),
        ((0.0, 1.0), (0.0,), (0.0, 0.0)),
        ((0.0, 1.0), (0.0, 0.0), (0.0,)),
        ((0.0, 1.0), (0.0, math.nan), (0.0, 0.0)),
        ((0.0, 1.0), (0.0, 0.0), (math.inf, 0.0)),
        ((0.0, math.nan), (0.0, 0.0), (0.0, 0.0)),
        ((0.0, 1.0, 1.0), (0.0, 0.0, 1.0), (0.0, 0.0, 0.0)),
        ((1.0, 0.0), (0.0, 0.0), (0.0, 0.0)),
    ],
    ids=str,
)
def test_a_record_that_is_none_is_refused(time: tuple[float, ...], x: tuple[float, ...], y: tuple[float, ...]) -> None:
    with pytest.raises(ValueError, match="motion: must"):
        Motion(time, x, y)


def test_a_record_is_linear_between_its_instants_and_held_beyond_them() -> None:
    motion = Motion((1.0, 3.0), (0.0, 4.0), (1.0, 0.0))
    assert np.array_equal(motion(np.array([0.0, 2.0, 9.0])), [[0.0, 1.0], [2.0, 0.5], [4.0, 0.0]])
    assert motion.sideways
    assert not Motion((0.0, 1.0), (0.0, 0.0), (0.0, 1.0)).sideways
