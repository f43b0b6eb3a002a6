"""The restitution map of a penalty contact: its table."""

import math

import pytest

from fem_reference.events.restitution import ContactScheme, statistics


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
def test_the_table_of_rigid_contact(alpha, delta, mean, low, high, square, digits):
    found = statistics(ContactScheme(alpha, delta), math.inf)
    assert [found.mean, found.low, found.high, found.mean_square] == pytest.approx(
        [mean, low, high, square], abs=digits
    )
