"""Frequency responses: moving bases, large systems, limits and peaks."""

import math

import numpy as np
import pytest

from validation import load_scene, response
from validation.advice.response import Response

BLOCK = load_scene("figures-3-4").with_values({"time.step": 0.002, "run.columns": ["displacement", "contact_pressure"]})


def rational(poles):
    """Return the response sum r / (f0^2 - f^2 + 2 i zeta f0 f) of poles (r, f0, zeta)."""

    def answer(f):
        parts = [r / (f0**2 - f**2 + 2j * zeta * f0 * f) for r, f0, zeta in poles]
        return {"displacement": np.asarray(sum(parts), complex)}

    return answer


PEAKS = {  # poles, range and its points, peaks
    "undamped": ([(1.0, 50.3, 0.0)], (1.0, 200.0, 50), [(50.3, math.inf)]),
    "undamped, few points": ([(1.0, 50.3, 0.0)], (1.0, 200.0, 5), [(50.3, math.inf)]),
    "undamped, next to an end": ([(1.0, 50.3, 0.0)], (50.0, 60.0, 5), [(50.3, math.inf)]),
    "two, with a zero between": (
        [(1.0, 50.3, 0.0), (2.0, 80.7, 0.0)],
        (1.0, 90.0, 40),
        [(50.3, math.inf), (80.7, math.inf)],
    ),
    "a zero alone": ([(1.0, 50.3, 0.0), (2.0, 80.7, 0.0)], (55.0, 75.0, 40), []),
    "damped": (
        [(1.0, 50.0, 0.05)],
        (1.0, 200.0, 40),
        [(50 * math.sqrt(1 - 2 * 0.05**2), 1 / (2 * 0.05 * 2500 * math.sqrt(1 - 0.05**2)))],
    ),
    "no peak": ([(1.0, 50.3, 0.0)], (60.0, 200.0, 40), []),
}


@pytest.mark.parametrize(("poles", "span", "expected"), PEAKS.values(), ids=PEAKS)
def test_peaks_are_those_of_the_model_between_the_listed_frequencies(poles, span, expected):
    answer = rational(poles)
    frequency = np.linspace(*span)
    peaks = Response("s", "dda", True, False, frequency, answer(frequency), answer).peaks("displacement")
    assert np.allclose(np.array(peaks).reshape(-1, 2), np.array(expected).reshape(-1, 2), rtol=1e-6)


def test_phases_of_what_nothing_damps_are_zero_or_a_half_turn():
    table = response(BLOCK, np.linspace(1.0, 200.0, 50), "continuum").table()
    assert set(np.unique(table[:, [2, 4]])) == {0.0, np.pi}
