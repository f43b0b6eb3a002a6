"""Frequency responses: moving bases, large systems, limits and peaks."""

import math

import numpy as np
import pytest
from conftest import thinned
from oracles.stepped_vibration import fit

import dda.linear.elimination
import fem_reference.history.response
from validation import load_scene, response, solve
from validation.advice.response import Response

BLOCK = load_scene("figures-3-4").with_values({"time.step": 0.002, "run.columns": ["displacement", "contact_pressure"]})
COLUMNS = ("displacement", "contact_pressure")
MOVING = [
    ("dda", {}, (0.0, 1.0)),
    ("dda", {"block.poisson": 0.25}, (0.6, 0.8)),
    ("dda", {"block.subdivide": [2, 3], "block.poisson": 0.2}, (-0.6, 0.8)),
    ("dda", {"block.subdivide": [1, 2], "block.pattern": "triangles"}, (1.0, 0.0)),
    ("fem", {"fem.elements": 3}, (0.0, 1.0)),
    ("fem", {"fem.elements": 2, "fem.degree": 1, "block.poisson": 0.3}, (0.8, -0.6)),
]


def moving(path, scene, along, w):
    """Return the scene on a base that moves along a vector as sin(wt)."""
    times = scene.time.step * np.arange(scene.time.steps + 1.0)
    table = np.column_stack([times, *(part * np.sin(w * times) for part in along)])
    np.savetxt(path, table, "%.17g", ",", header="time,x,y", comments="")
    return scene.with_values({"load.base_motion": str(path), "load.pressure": 0.0})


@pytest.mark.parametrize(("solver", "values", "along"), thinned(MOVING, 5))
def test_stepped_histories_on_a_vibrating_base_end_where_the_closed_form_says(tmp_path, solver, values, along):
    w = 2 * np.pi * 43.0
    time = {"time.step": 0.003, "time.steps": 700, "time.alpha": 0.7, "time.gg": 0.97, "contact.stiffness": 4e8}
    scene = moving(tmp_path / "base.csv", BLOCK.with_values(values | time), along, w)
    history = solve(scene, solver).history
    last = slice(-60, None)
    seen = np.column_stack([history.columns[c][last] for c in COLUMNS])
    stepped = 1j * fit(seen, w, history.time[last])  # the record is a sine: Re(-i e^{iwt})
    found = response(scene, 43.0, solver)
    assert found.base
    for amplitude, column in zip(stepped, COLUMNS, strict=True):
        closed = complex(found.columns[column][0])
        assert abs(amplitude - closed) <= 1e-10 * abs(closed) + 1e-12 * {"displacement": 1.0}.get(column, 4e8)


@pytest.mark.parametrize(
    "damped",
    thinned([{"time.alpha": 0.25, "time.delta": 0.5, "time.gg": 0.99}, pytest.param({}, marks=pytest.mark.long)], 3),
)
def test_a_small_space_answers_as_eliminations_do(monkeypatch, damped):
    size = {"block.subdivide": [3, 3], "fem.elements": 3}
    scene = BLOCK.with_values(size | {"block.poisson": 0.3, "load.traction": 1e6} | damped)
    f = np.linspace(0.0, 240.0, 7)
    space, elements = response(scene, f, "dda"), response(scene, f, "fem")
    monkeypatch.setattr(dda.linear.elimination, "BAND", np.inf)
    monkeypatch.setattr(fem_reference.history.response, "NARROW", np.inf)
    for found, solver in ((space, "dda"), (elements, "fem")):
        band = response(scene, f, solver)
        for column in COLUMNS:
            size = np.max(np.abs(band.columns[column]))
            assert np.allclose(found.columns[column], band.columns[column], rtol=1e-9, atol=1e-11 * size)


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
