"""What digits and noise may leave of a column, and what its rows tell, by numbers that are worked out by hand."""

from __future__ import annotations

import math

import numpy as np
import pytest

from validation.diagnosis.fits import bar
from validation.diagnosis.fits.bar import Bar
from validation.diagnosis.fits.target import Target
from validation.diagnosis.variant import Variant

OWN = Variant(0.5, 1.0, 1.0)
N = np.arange(200)


def column(values):
    """Return a target of one column, every step recorded, each value with all its digits."""
    values = np.asarray(values, dtype=float)
    rows = np.arange(len(values))
    return Target(None, np.full(len(values), 1e-3), rows, values[None], np.zeros((1, len(values))))


def test_the_last_digit_is_that_of_most_digits_or_of_most_decimals():
    assert bar.last_digits(np.array([0.0123, 1.5, 0.0, -250.0, math.inf]))[:4] == pytest.approx([1e-4, 1e-2, 1e-4, 1.0])
    for values in ([0.0, 0.0], [1 / 3, 0.5]):
        assert not np.any(bar.last_digits(np.array(values)))


def test_noise_is_what_no_recurrence_tells():
    y = 3.0 + 0.7 * np.exp(-0.01 * N) * np.cos(0.4 * N) + 0.2 * np.exp(-0.03 * N) * np.sin(1.1 * N)
    white = np.random.default_rng(4).standard_normal(200)
    assert bar.noise(y) < 1e-14
    assert bar.noise(y + 2e-3 * white) == pytest.approx(2.2426e-3, rel=1e-3)  # known to a fifth
    assert bar.noise(2e-3 * white[:16]) > 0
    assert bar.noise(white[:15]) == bar.noise(0 * white) == 0.0


def test_what_is_left_is_held_up_to_the_bar():
    signs = np.sign(np.random.default_rng(1).standard_normal(80))
    digits = Bar(np.ones(80), 1.0, 1.0, 0.0, np.ones(80, dtype=bool))
    for size, shape, holds in (
        (0.4999, 1.0, True),  # of a unit of the last digit, whatever its shape
        (0.501, 1.0, False),
        (0.501, signs, False),  # 1.74 deviations
    ):
        assert digits.holds(size * shape * np.ones(80)) is holds, size
    mostly = 0.45 * signs
    mostly[7] = 0.6
    assert digits.holds(mostly)  # 1.56 deviations, and white
    mostly[7] = 3.1
    assert not digits.holds(mostly)  # the row alone
    assert not digits.holds(0.43 * np.ones(80) + np.r_[0.1, np.zeros(79)])  # 1.5 of them, with a shape
    noisy = Bar(np.zeros(80), 1.0, 1.0, 0.1, np.ones(80, dtype=bool))
    wave = np.sin(0.2 * np.arange(80))
    assert noisy.holds(0.1 * wave) and not noisy.holds(0.15 * wave)
