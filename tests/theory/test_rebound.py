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
OMEGAS = (0.1, 0.3, 1.0, 1.9, 4.0, 10.0, 1000.0)
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
    "constant": "0.9246 0.923 0.926 0.7924 0.784 0.801 0.5000 0.446 0.554 0.3391 0.302 0.376 0.4222 0.073 0.772 "
    "0.4854 0.010 0.952 0.5000 0.010 0.990",
    "average": "1.0000 0.999 1.001 1.0001 0.989 1.011 1.0056 0.900 1.110 1.0039 0.916 1.091 1.3272 0.456 2.184 "
    "1.5987 0.365 2.827 1.6666 0.340 2.980",
    "ch-0.5": "0.9999 0.999 1.001 0.9987 0.988 1.009 0.9788 0.879 1.079 0.9420 0.808 1.076 1.1307 0.484 1.775 "
    "1.3166 0.387 2.248 1.3625 0.367 2.358",
    "ch-0": "0.9986 0.997 1.000 0.9755 0.969 0.982 0.8009 0.751 0.851 0.6691 0.549 0.788 0.6162 0.456 0.776 "
    "0.6561 0.355 0.956 0.6666 0.335 0.995",
    "wbz-0.5": "0.9998 0.999 1.001 0.9952 0.985 1.005 0.9371 0.845 1.028 0.8671 0.729 1.005 0.9904 0.456 1.517 "
    "1.1319 0.354 1.898 1.1666 0.335 1.985",
    "bathe": "1.0000 1.000 1.001 0.9997 0.995 1.004 0.9921 0.952 1.046 0.9617 0.850 1.040 0.9209 0.599 1.186 "
    "0.9557 0.332 1.792 1.0463 0.221 2.116",
    "bathe-0.5": "1.0000 1.000 1.000 0.9998 0.998 1.002 0.9959 0.963 1.035 0.9827 0.869 1.074 0.9444 0.769 1.040 "
    "1.2158 0.351 2.210 1.3863 0.272 2.655",
    "leapfrog": "1.0000 0.999 1.001 1.0001 0.989 1.011 1.0000 1.000 1.000 1.4965 0.390 2.592",
    "explicit-euler": "1.1698 1.168 1.171 1.5911 1.579 1.603 4.0000 4.000 4.000 8.9862 8.145 9.819",
    "implicit-euler": "0.8549 0.854 0.856 0.6285 0.624 0.633 0.2500 0.250 0.250 0.1123 0.102 0.123 0.0366 0.021 0.052 "
    "0.0065 0.003 0.010 0.0000 0.000 0.000",
}


@pytest.mark.parametrize("name", TABLE)
def test_rebounds_by_scheme_and_contact_frequency(name):
    rows = np.array(TABLE[name].split(), float).reshape(-1, 3)
    for omega, row in zip(OMEGAS, rows, strict=False):
        statistics = rebound_statistics(spring_steps(SCHEMES[name], omega))
        assert abs(statistics.mean - row[0]) < 6e-5, omega
        assert abs(statistics.least - row[1]) < 6e-4 and abs(statistics.most - row[2]) < 6e-4, omega


@pytest.mark.parametrize(
    ("scheme", "mean", "least", "most", "mean_square"),
    [
        (stages.newmark(0.25, 0.5), 5 / 3, 1 / 3, 3.0, 91 / 27),
        (stages.generalised_alpha(0.0, 0.1), 1.5050, 0.338, 2.672, 2.720),
        (stages.wbz(0.5), 7 / 6, 1 / 3, 2.0, 43 / 27),
        (stages.composite(0.0, 0.5), 1.0952, 0.264, 1.999, 1.393),
        (IMPLICIT_EULER, 0.0, 0.0, 0.0, 0.0),
    ],
)
def test_the_stiff_limit_has_a_map_of_its_own(scheme, mean, least, most, mean_square):
    statistics = rebound_statistics(spring_steps(scheme, math.inf), count=2000)
    assert abs(statistics.mean - mean) < 6e-5
    assert abs(statistics.least - least) < 1.3e-3 and abs(statistics.most - most) < 1.3e-3
    assert abs(statistics.mean_square - mean_square) < 6e-4
    stiff = rebound_statistics(spring_steps(scheme, 1e7), count=2000)
    assert np.allclose(stiff, statistics, atol=2e-5)


def test_energy_conserving_contact_has_no_rigid_stop():
    with pytest.raises(ValueError, match=r"^omega: "):
        conserving_steps(math.inf)


@pytest.mark.parametrize("omega", [0.1, 0.7, 1.9, 4.0, 1e3])
def test_energy_conserving_contact_returns_the_speed(omega):
    assert rebounds(conserving_steps(omega), midpoints(20)) == pytest.approx(np.ones(20), rel=1e-9)
