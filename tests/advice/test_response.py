"""Peaks of a frequency response, of amplitudes that are known in closed form."""

import math

import numpy as np
import pytest

from validation.advice.response import PRESSURE, Response

MODES = ((50.0, 0.03, 1.0), (120.3, 0.01, 0.7), (300.0, 0.2, 0.1))  # f [Hz], xi, static share
DISPLACEMENT = "displacement"


def vibrating(modes):
    def answer(frequency):
        f = np.asarray(frequency)
        with np.errstate(all="ignore"):
            terms = [share / (1 - (f / f0) ** 2 + 2j * xi * f / f0) for f0, xi, share in modes]
            return {DISPLACEMENT: np.sum(terms, axis=0), PRESSURE: 0 * f + 1j}

    return answer


def response_at(frequency, modes):
    answer = vibrating(modes)
    return Response("s", "dda", True, False, frequency, answer(frequency), answer)


@pytest.mark.parametrize("points", [13, 14, 60, 61])
def test_a_peak_between_listed_frequencies_is_followed_to_its_digits(points):
    (f0, xi, share) = MODES[0]
    found = response_at(np.linspace(11.0, 97.0, points), MODES[:1])
    ((frequency, amplitude),) = found.peaks(DISPLACEMENT)
    assert frequency == pytest.approx(f0 * math.sqrt(1 - 2 * xi**2), rel=1e-7)
    assert amplitude == pytest.approx(share / (2 * xi * math.sqrt(1 - xi**2)), rel=1e-9)
    assert found.peaks(PRESSURE) == []
