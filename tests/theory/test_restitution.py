"""The restitution of a spring and a dashpot in closed form, and its inverse."""

import math

import mpmath
import pytest

from validation.theory.restitution import damping_ratio, restitution


@pytest.mark.parametrize("zeta", [0.0, 1e-9, 0.4, 0.99, 1 - 5e-5, 1 - 1e-12, 1.0, 1 + 1e-12, 1 + 5e-5, 60.0, 1e20])
def test_it_keeps_its_digits_around_critical_damping_and_the_inverse_leads_back(zeta):
    with mpmath.workdps(60):
        z = mpmath.mpf(zeta)
        s = mpmath.sqrt(1 - z * z)
        exact = mpmath.exp(-2) if zeta == 1 else mpmath.exp(-(z / s) * 2 * mpmath.atan(s / z)).real if zeta else 1
        assert abs(restitution(zeta) / exact - 1) < 2e-12
    assert restitution(damping_ratio(restitution(zeta))) == pytest.approx(restitution(zeta), rel=2e-12)
    if 1e-3 < zeta < 1e3:
        assert damping_ratio(restitution(zeta)) == pytest.approx(zeta, rel=1e-12)


def test_the_ends_of_the_inverse():
    assert damping_ratio(1.0) == 0.0
    assert damping_ratio(1e-300) == pytest.approx(0.5e150, rel=1e-9)  # 1/(2 sqrt(e))
    assert damping_ratio(5e-324) > 1e161
    assert restitution(math.inf) == 0.0
    for e in (0.0, -0.1, 1.0000001, math.nan):
        with pytest.raises(ValueError, match=r"^restitution: "):
            damping_ratio(e)
    with pytest.raises(ValueError, match=r"^damping_ratio: .*, got -1"):
        restitution(-1)
