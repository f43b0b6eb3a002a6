"""The rebound of a rigid mass in the stiff limit, and by a contact that conserves energy."""

import math

import numpy as np
import pytest

from validation.theory import stages
from validation.theory.rebound import (
    conserving_steps,
    midpoints,
    rebound_statistics,
    rebounds,
    spring_steps,
)

IMPLICIT_EULER = (stages.Stage(beta=1.0, gamma=1.0),)  # v1 = v + dt a1, x1 = x + dt v1


def test_the_stiff_limit_has_a_map_of_its_own():
    limits = [  # mean, least, most, mean square
        (stages.newmark(0.25, 0.5), 5 / 3, 1 / 3, 3.0, 91 / 27),
        (stages.generalised_alpha(0.0, 0.1), 1.5050, 0.338, 2.672, 2.720),
        (stages.composite(0.0, 0.5), 1.0952, 0.264, 1.999, 1.393),
    ]
    for scheme, mean, *least_most, mean_square in limits:
        statistics = rebound_statistics(spring_steps(scheme, math.inf), count=1000)
        assert abs(statistics.mean - mean) < 6e-5 and abs(statistics.mean_square - mean_square) < 6e-4
        assert statistics[1:3] == pytest.approx(least_most, abs=2.6e-3)
    assert rebound_statistics(spring_steps(scheme, 1e7), count=1000) == pytest.approx(statistics, abs=4e-5)
    assert rebounds(spring_steps(IMPLICIT_EULER, math.inf), midpoints(9)).tolist() == [0.0] * 9


def test_energy_conserving_contact_has_no_rigid_stop():
    with pytest.raises(ValueError, match=r"^omega: "):
        conserving_steps(math.inf)


def test_energy_conserving_contact_returns_the_speed():
    for omega in (0.1, 1.9, 4.0, 1e3):
        assert rebounds(conserving_steps(omega), midpoints(20)) == pytest.approx(np.ones(20), rel=1e-9), omega
