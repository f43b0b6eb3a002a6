"""The restitution map of a penalty contact: its table, its limits, and the scheme that it stands for."""

import math

import numpy as np
import pytest

from fem_reference.events.restitution import ContactScheme, branches, statistics
from fem_reference.events.restitution import restitution as of_one_phase

DDA = ContactScheme(0.5, 1.0)
AVERAGE = ContactScheme(0.25, 0.5)


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
