"""What digits and noise may leave of a column, and what its rows tell, by numbers that are worked out by hand."""

from __future__ import annotations

import math
from types import SimpleNamespace

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


def test_single_rows_are_few_and_apart_and_not_the_first():
    target = column(np.linspace(1, 2, 60))
    remainder = 1e-3 * np.random.default_rng(3).standard_normal(60)

    def standing_out(*rows):
        wrong = remainder.copy()
        wrong[list(rows)] += 0.1
        rows_of = target.outlying(wrong / target.scales[0])
        return None if rows_of is None else np.flatnonzero(rows_of[0]).tolist()

    for rows in ((2,), (59,), (20, 40, 50), (20, 21, 40)):
        assert standing_out(*rows) == [*rows]
    for rows in ((), (0,), (1, 30), (20, 21, 22), (10, 20, 30, 40)):
        assert standing_out(*rows) is None


def test_rows_that_a_shift_leaves_open_are_not_judged():
    target = column(np.ones(24))
    joined = np.ones(24)
    assert np.sum(target.inner(joined, OWN)) == 24
    for changes, left in (({"shift": -2}, 20), ({"late": 0.5}, 22), ({"shift": 1, "late": 2.5}, 18)):
        inner = target.inner(joined, SimpleNamespace(**({"shift": 0, "late": 0.0} | changes)))
        assert np.sum(inner) == left and inner[12] == 1
    few = column(np.ones(23))
    assert np.sum(few.inner(np.ones(23), SimpleNamespace(shift=1, late=0))) == 23
    cut = column(np.arange(40.0) + 1).until(30)
    assert (len(cut.rows), len(cut.steps), cut.recorded[0, -1]) == (30, 30, 30.0)
    assert len(column(np.ones(40)).until(3).rows) == 24


def test_two_columns_weigh_the_same():
    recorded = np.array([[3.0, 4.0], [30.0, -40.0]])
    target = Target(None, np.ones(2), np.arange(2), recorded, np.full((2, 2), 0.6))
    assert target.values == pytest.approx(np.array([0.6, 0.8, 0.6, -0.8]) / math.sqrt(2))
    assert target.parts(target.values) == pytest.approx(recorded)
    shares = [0.6**2 / 12 / 25 * 2, 0.6**2 / 12 / 2500 * 2]
    assert target.floor == pytest.approx(math.sqrt(sum(shares) / 2))
    assert column([0.0, 0.0]).scales.tolist() == [[1.0]]
