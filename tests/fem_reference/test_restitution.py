"""The restitution map of a penalty contact: its table, its limits, and the scheme that it stands for."""

import math

import numpy as np
import pytest
from conftest import thinned

from fem_reference.events.restitution import ContactScheme, branches, statistics
from fem_reference.events.restitution import restitution as of_one_phase

DDA = ContactScheme(0.5, 1.0)
AVERAGE = ContactScheme(0.25, 0.5)
THETA = np.linspace(0.0, 1.0, 101)


def restitution(scheme: ContactScheme, omega: float, theta: np.ndarray) -> np.ndarray:
    return np.array([of_one_phase(scheme, omega, phase) for phase in theta])


@pytest.mark.parametrize(
    ("alpha", "delta", "mean", "low", "high", "square", "digits"),
    [
        (1 / 2, 1.0, 1 / 2, 0, 1, 1 / 3, 1e-14),
        (9 / 16, 1.0, 19 / 45, 1 / 15, 7 / 9, 0.2204, 5e-5),
        (1 / 4, 1 / 2, 5 / 3, 1 / 3, 3, 91 / 27, 1e-14),
        (1 / 3, 1 / 2, 5 / 4, 1 / 2, 2, 7 / 4, 1e-14),
        (0.3025, 0.6, 1.280, 0.254, 2.306, 1.989, 5e-4),
    ],
)
def test_the_table_of_rigid_contact(
    alpha: float, delta: float, mean: float, low: float, high: float, square: float, digits: float
) -> None:
    found = statistics(ContactScheme(alpha, delta), math.inf)
    assert [found.mean, found.low, found.high, found.mean_square] == pytest.approx(
        [mean, low, high, square], abs=digits
    )


def damped_rebound(scheme: ContactScheme, omega: float) -> float:
    """Restitution of many steps in contact, e = exp(-pi xi / sqrt(1 - xi^2)), Omega << 1.

    xi = (1 - gg) / (2 Omega) + (delta - 1/2) Omega / 2 is the damping ratio of the scheme in contact; 0 beyond xi = 1.
    """
    xi = (1 - scheme.gg) / (2 * omega) + (scheme.delta - 0.5) * omega / 2
    return math.exp(-math.pi * xi / math.sqrt(1 - xi * xi)) if xi < 1 else 0.0


def two_step_contact(scheme: ContactScheme) -> tuple[float, float]:
    """The Omega at which the trace of a step in contact is zero, and the restitution there for gg = 1.

    Contact then lasts two steps whatever theta is, and two steps multiply the state by minus the determinant:
    Omega^2 = 2 / (1/2 + delta - 2 alpha), e = 1 + (1/2 - delta) Omega^2 / (1 + alpha Omega^2).
    """
    square = 2 / (0.5 + scheme.delta - 2 * scheme.alpha)
    return math.sqrt(square), 1 + (0.5 - scheme.delta) * square / (1 + scheme.alpha * square)


def test_the_closed_forms_of_rigid_contact() -> None:
    assert restitution(DDA, math.inf, THETA) == pytest.approx(np.abs(2 * THETA - 1), abs=1e-15)
    assert restitution(AVERAGE, math.inf, THETA) == pytest.approx(
        np.where(THETA < 1 / 3, 3 - 8 * THETA, 4 * THETA - 1), abs=1e-14
    )


def test_contact_of_two_steps() -> None:
    for scheme, e in ((DDA, 1 / 3), (AVERAGE, 1.0)):
        assert two_step_contact(scheme) == pytest.approx((2.0, e))
    for scheme in (DDA, AVERAGE, ContactScheme(0.3, 0.6), ContactScheme(0.4, 0.9)):
        omega, e = two_step_contact(scheme)
        assert restitution(scheme, omega, THETA) == pytest.approx(np.full_like(THETA, e), abs=1e-14)


def test_the_mean_of_dda_is_least_where_contact_lasts_two_steps() -> None:
    omegas = np.linspace(0.5, 8.0, 76)
    means = [statistics(DDA, float(omega)).mean for omega in omegas]
    assert omegas[int(np.argmin(means))] == pytest.approx(2.0)
    assert min(means) == pytest.approx(1 / 3)
    assert statistics(DDA, 1000.0).mean == pytest.approx(1 / 2, abs=1e-5)


@pytest.mark.parametrize(("omega", "e"), [(0.01, 0.992), (0.1, 0.925), (0.3, 0.792), (1.0, 0.500)])
def test_soft_contact_of_dda(omega: float, e: float) -> None:
    assert statistics(DDA, omega).mean == pytest.approx(e, abs=5e-4)


@pytest.mark.parametrize("omega", thinned([0.03, 0.003, 0.1, 0.3], 2))
def test_soft_contact_is_a_damped_half_wave(omega: float) -> None:
    # within 1 % to 5 % of the speed of impact; the averages are far nearer
    for gg, band in ((1.0, 0.01), (0.95, 0.05)):
        for scheme in (ContactScheme(0.5, 1.0, gg), ContactScheme(0.25, 0.5, gg)):
            assert statistics(scheme, omega).mean == pytest.approx(damped_rebound(scheme, omega), abs=band)
    assert np.abs(restitution(AVERAGE, omega, THETA) - 1).max() <= omega**2 / 8


def test_kinetic_damping_does_not_tame_average_acceleration() -> None:
    assert statistics(ContactScheme(0.25, 0.5, 0.95), 1000.0).mean == pytest.approx(1.5313, abs=5e-4)


@pytest.mark.parametrize("gg", [0.95, 0.7])
def test_the_overshoot_of_a_mass_that_falls_from_above_is_uniform_from_0_to_gg(gg: float) -> None:
    """Free steps from many heights: none overshoots by more than gg V dt, and the map holds what such falls return."""
    for alpha, delta in ((0.5, 1.0), (0.25, 0.5)):
        scheme = ContactScheme(alpha, delta, gg)
        overshoots = []
        for height in np.linspace(0.0, gg * (1 + gg), 2001)[1:-1]:  # of the last two steps of flight, in V dt
            w, v = height, -1.0 / gg
            while w + gg * v >= 0:  # v before the discount of the step
                w, v = w + gg * v, gg * v
            overshoots.append((w + gg * v) / v)
        assert 0.999 * gg < max(overshoots) <= gg
        found = statistics(scheme, 1000.0)
        uniform = restitution(scheme, 1000.0, np.linspace(0.0, gg, 2001))
        assert found.mean == pytest.approx(uniform.mean(), abs=3e-3)
        assert found.mean_square == pytest.approx((uniform**2).mean(), abs=5e-3)
        assert (found.low, found.high) == pytest.approx((uniform.min(), uniform.max()), abs=2e-3)
        with pytest.raises(ValueError, match="theta"):
            of_one_phase(scheme, 1000.0, gg + 0.01)


@pytest.mark.long
def test_an_overdamped_contact_sticks() -> None:
    scheme = ContactScheme(0.5, 1.0, 0.9)
    assert damped_rebound(scheme, 0.01) == 0.0
    assert statistics(scheme, 0.01).mean == 0.0
    assert restitution(scheme, 0.01, [0.3, 0.8]) == pytest.approx([0.0, 0.0])


@pytest.mark.parametrize("omega", [0.4, 1.7, 5.0])
@pytest.mark.parametrize("scheme", [DDA, AVERAGE, ContactScheme(0.41, 0.77, 0.93)])
def test_the_lines_are_newmarks_runs(scheme: ContactScheme, omega: float) -> None:
    """A mass m on a spring k in SI units, step by step as the scheme is defined."""
    m, V, dt = 3.0, 0.7, 0.02
    k = m * (omega / dt) ** 2
    a, d, gg = scheme.alpha, scheme.delta, scheme.gg
    lines = branches(scheme, omega)
    assert lines[0].low == 0 and lines[-1].high == gg
    assert [line.high for line in lines[:-1]] == [line.low for line in lines[1:]]
    for theta in np.linspace(0.0, gg, 23)[1:-1]:
        v, A = -V, 0.0
        w = -theta * V * dt + gg * V * dt  # so that the first predictor lies theta V dt deep
        for step in range(400):
            free = w + gg * dt * v + (0.5 - a) * dt**2 * A
            w1 = m * free / (m + a * dt**2 * k) if free < 0 else free
            A1 = -k * w1 / m if free < 0 else 0.0
            w, v, A = w1, gg * v + dt * ((1 - d) * A + d * A1), A1
            if step and free >= 0:
                break
        assert v / V == pytest.approx(of_one_phase(scheme, omega, float(theta)), rel=1e-9, abs=1e-12)


def test_bad_input_is_refused_by_name() -> None:
    for field, values in {"alpha": (0.0, 0.5), "delta": (0.25, 0.8), "gg": (0.5, 1.0, 0.0)}.items():
        with pytest.raises(ValueError, match=field):
            ContactScheme(*values)
    for field, omega, theta in (("omega", 0.0, 0.5), ("theta", 1.0, 1.5)):
        with pytest.raises(ValueError, match=field):
            of_one_phase(DDA, omega, theta)
