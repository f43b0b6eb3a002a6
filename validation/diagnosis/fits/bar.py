"""How much may remain of a history that is explained: what its digits and its noise leave.

A row has the standard deviation sigma, sigma^2 = unit^2 / 12 + noise^2 + (1e-8 size)^2, of its last digit, of noise and
of double precision. A column is explained if no row is beyond its last digit, or if what remains is hardly larger than
digits leave by themselves, or hardly larger than sigma and white, and has no row beyond six sigma. The noise is what
the column shows by itself: any linear model of one block obeys one recurrence of low order, so that the Hankel matrix
of its samples has that rank; the singular values beyond it are noise, whatever the model. Contact that opens obeys none
and looks noisier than it is: noise is no tenth of a column, and has no shape.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cache

import numpy as np
from numpy.typing import NDArray

from validation.diagnosis.constants import ARITHMETIC, CHANGE, ORDER, SIGMAS, WINDOW
from validation.metrics.values import largest
from validation.runs.history import Array

FEWEST = 16  # samples: eight of a window, four powers
LONGEST = 600  # rows that the noise is estimated from, and steps of the first fits: more tell little
MARGIN = 1.6  # of the estimated noise: tens of singular values tell it to a fifth, least squares take more
MEDIAN = 1.4826  # given: standard deviation of normal noise over the median of its absolute values
OUTLYING = 6.0  # spreads: of ten million rows of normal noise none is farther away
ROUNDED = 0.5  # given: last digits: the most that rounding leaves
AROUND = 2  # rows at the start, where what dies out stands out too


def bars_of(columns: Array, roundings: Array | None) -> list[Bar]:
    """Return what digits and noise may leave of each column; digits are seen from the values where none are given."""
    units = [None] * len(columns) if roundings is None else list(roundings)
    return [Bar.of(values, unit) for values, unit in zip(columns, units, strict=True)]


def last_digits(values: Array) -> Array:
    """Return the unit of the last printed digit of each value, zero where all digits of a double are given.

    A format has a number of significant digits or of decimals; the larger unit of the two counts.
    """
    places = [_places(float(v)) for v in values if v != 0 and math.isfinite(v)]
    if not places:
        return np.zeros(len(values))
    digits = max(top - last + 1 for top, last in places)
    if digits >= np.finfo(float).precision:
        return np.zeros(len(values))
    least = 10.0 ** min(last for _, last in places)
    with np.errstate(divide="ignore"):
        top = np.where(values == 0, -np.inf, np.floor(np.log10(np.abs(values))))
    return np.maximum(10.0 ** (top - digits + 1), least)


def _places(value: float) -> tuple[int, int]:
    """Return the decimal exponents of the first and of the last digit of a number."""
    mantissa, _, exponent = f"{value!r}".partition("e")
    _, digits, scale = f"{value:.16e}".partition("e")
    top = int(scale)
    digits_of_mantissa = mantissa.replace("-", "").replace(".", "").lstrip("0").rstrip("0")
    return top, top - max(len(digits_of_mantissa), 1) + 1 if exponent or digits else top


def norm(values: Array) -> float:
    """Return the root of the sum of squares."""
    return float(np.linalg.norm(values))


def noise(values: Array) -> float:
    """Return the standard deviation of what no recurrence of low order predicts, zero if the rows are too few."""
    y = np.asarray(values[:LONGEST], dtype=float)
    size = largest(y) if len(y) else 0.0
    if len(y) < FEWEST or size == 0:
        return 0.0
    return size * _beyond(y / size) / _bias(len(y))


def _beyond(y: Array) -> float:
    """Return the root mean square of the singular values beyond the order, a row of samples."""
    window = min(WINDOW, len(y) // 2)
    rows = np.lib.stride_tricks.sliding_window_view(y, window)
    s = np.linalg.svd(rows, compute_uv=False)[window // 2 :]
    return float(np.sqrt(np.mean(s**2)))


@cache
def _bias(samples: int) -> float:
    """Return what the smaller singular values show of white noise of unit variance."""
    of_seeds = [_beyond(np.random.default_rng(seed).standard_normal(samples)) for seed in range(8)]
    return float(np.mean(of_seeds))


def white(remainder: Array) -> bool:
    """Whether a remainder has no shape, by Ljung and Box's statistic of its first lags."""
    r, n = remainder - 0.0, len(remainder)
    square = float(r @ r)
    if square == 0:
        return True
    lags = min(ORDER, n // 4)
    if lags < 1:
        return False
    rho = np.array([float(r[k:] @ r[:-k]) / square for k in range(1, lags + 1)])
    statistic = n * (n + 2) * float(np.sum(rho**2 / (n - np.arange(1, lags + 1))))
    return statistic <= lags + SIGMAS * math.sqrt(2 * lags) + SIGMAS**2 / 2


def spread_of_most(remainder: Array) -> float:
    """Return the spread of a remainder by its median: a few wrong rows do not excuse themselves."""
    return MEDIAN * float(np.median(np.abs(remainder))) if len(remainder) else 0.0


def outlying(remainder: Array, spread: float, unit: Array) -> NDArray[np.bool_]:
    """Return which rows of a remainder are farther away than noise of a spread, and units of last digits, have them."""
    return np.asarray(np.abs(remainder) > OUTLYING * np.hypot(spread, ROUNDED * unit))


@dataclass(frozen=True, eq=False)
class Bar:
    """What digits and noise may leave of a column, in its unit."""

    rounding: Array  # units of the last digits
    size: float  # largest value
    norm: float  # root of the sum of squares, one for zeros throughout
    spread: float  # standard deviation of the noise
    moving: NDArray[np.bool_]  # which rows are not zero: an open contact has neither pressure nor noise

    @classmethod
    def of(cls, values: Array, rounding: Array | None) -> Bar:
        """Derive it from the column itself."""
        rounding = last_digits(values) if rounding is None else rounding
        return cls(rounding, largest(values), norm(values) or 1.0, noise(values), values != 0)

    def deviation(self, remainder: Array | None = None) -> Array:
        """Return the standard deviation of each row: of its digits, the noise, and the solver's own error.

        Where a remainder is given, the noise is at most the spread of most of its rows: one wrong row, or contact that
        switches, widens the noise of the column itself.
        """
        spread = self.spread
        if remainder is not None:
            spread = min(spread, spread_of_most(remainder[self.moving]))
        return np.asarray(np.hypot(self.digits, spread))

    @property
    def digits(self) -> Array:
        """Standard deviation of each row of its digits and of double precision."""
        least = (ARITHMETIC * self.size) ** 2 or np.finfo(float).tiny  # of a column at rest
        return np.asarray(np.sqrt(self.rounding**2 / 12 + least))

    def outlying(self, remainder: Array) -> NDArray[np.bool_]:
        """Return which rows of a remainder are farther away than the noise of most of its rows would have them."""
        unit = self.rounding + ARITHMETIC * self.size
        return outlying(remainder, spread_of_most(remainder[self.moving]), unit)

    @property
    def allowed(self) -> float:
        """Relative L2 that digits and noise may leave [-]."""
        return MARGIN * norm(self.deviation()) / self.norm

    def holds(self, remainder: Array) -> bool:
        """Whether a remainder is digits and noise, as the head of this module says."""
        if np.all(np.abs(remainder) <= ROUNDED * self.rounding + ARITHMETIC * self.size):
            return True
        # the few landings of a contact that bounces have no recurrence, and look like noise throughout
        if norm(remainder) > CHANGE * self.norm or np.any(self.outlying(remainder)):
            return False
        if norm(remainder) <= MARGIN * norm(self.digits):  # of a slow motion they have a shape, noise has none
            return True
        shares = remainder / self.deviation(remainder)
        return norm(shares) <= MARGIN * math.sqrt(len(shares)) and white(shares[self.moving])
