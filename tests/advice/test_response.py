"""Peaks of a frequency response, of amplitudes that are known in closed form."""

import math

import numpy as np
import pytest

from validation.advice.response import PRESSURE, Response

DISPLACEMENT = "displacement"


@pytest.mark.parametrize("points", [13, 14, 60, 61])
def test_a_peak_between_listed_frequencies_is_followed_to_its_digits(points):
    f0, xi = 50.0, 0.03  # [Hz], [-]

    def answer(frequency):
        f = np.asarray(frequency) / f0
        return {DISPLACEMENT: 1 / (1 - f**2 + 2j * xi * f), PRESSURE: 0 * f + 1j}

    frequencies = np.linspace(11.0, 97.0, points)
    found = Response("s", "dda", True, False, frequencies, answer(frequencies), answer)
    ((frequency, amplitude),) = found.peaks(DISPLACEMENT)
    assert frequency == pytest.approx(f0 * math.sqrt(1 - 2 * xi**2), rel=1e-7)
    assert amplitude == pytest.approx(1 / (2 * xi * math.sqrt(1 - xi**2)), rel=1e-9)
    assert found.peaks(PRESSURE) == []
