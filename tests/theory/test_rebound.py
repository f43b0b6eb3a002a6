"""The rebound of a rigid mass by scheme, contact and phase, against an independent program and the closed map."""

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
OMEGAS = (0.3, 1.9, 10.0)
SCHEMES = {
    "constant": stages.newmark(0.5, 1.0),
    "average": stages.newmark(0.25, 0.5),
    "ch-0.5": stages.chung_hulbert(0.5),
    "ch-0": stages.chung_hulbert(0.0),
    "wbz-0.5": stages.wbz(0.5),
    "bathe": stages.composite(0.0),
    "bathe-0.5": stages.composite(0.5),
    "leapfrog": stages.LEAPFROG,
    "explicit-euler": stages.EXPLICIT_EULER,
    "implicit-euler": IMPLICIT_EULER,
}
# mean, least and greatest over 100 phases by omega, from an independent program
TABLE = {
    "constant": "0.7924 0.784 0.801  0.3391 0.302 0.376  0.4854 0.010 0.952",
    "average": "1.0001 0.989 1.011  1.0039 0.916 1.091  1.5987 0.365 2.827",
    "ch-0.5": "0.9987 0.988 1.009  0.9420 0.808 1.076  1.3166 0.387 2.248",
    "ch-0": "0.9755 0.969 0.982  0.6691 0.549 0.788  0.6561 0.355 0.956",
    "wbz-0.5": "0.9952 0.985 1.005  0.8671 0.729 1.005  1.1319 0.354 1.898",
    "bathe": "0.9997 0.995 1.004  0.9617 0.850 1.040  0.9557 0.332 1.792",
    "bathe-0.5": "0.9998 0.998 1.002  0.9827 0.869 1.074  1.2158 0.351 2.210",
    "leapfrog": "1.0001 0.989 1.011  1.4965 0.390 2.592",
    "explicit-euler": "1.5911 1.579 1.603  8.9862 8.145 9.819",
    "implicit-euler": "0.6285 0.624 0.633  0.1123 0.102 0.123  0.0065 0.003 0.010",
}


def test_rebounds_by_scheme_and_contact_frequency():
    for name, printed in TABLE.items():
        rows = np.array(printed.split(), float).reshape(-1, 3)
        for omega, row in zip(OMEGAS, rows, strict=False):
            statistics = rebound_statistics(spring_steps(SCHEMES[name], omega))
            assert abs(statistics.mean - row[0]) < 6e-5, (name, omega)
            assert abs(statistics.least - row[1]) < 6e-4 and abs(statistics.most - row[2]) < 6e-4, (name, omega)


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
