"""Schemes by name where contact stays locked: roots, histories, operators, responses, and what is refused."""

import math
from dataclasses import replace

import numpy as np
import pytest
from conftest import thinned
from oracles.scheme_cases import CASES, every_scheme, few_schemes, scheme_of, truth_of
from oracles.staged import System, march

from dda import (
    SCHEMES,
    BaseMotion,
    Block,
    Contact,
    Load,
    Material,
    TwoBlockModel,
    diagnostics,
    modes,
    named_scheme,
    response,
    solve,
)
from dda.bodies.diagnostics import step_of_mode
from dda.scheme import roots


def square(ratio=1.0, mu=0.0, **load):
    block = Block.rectangle(2.0, 2.0, Material(2700.0, 1e9, mu, "plane stress"))
    return TwoBlockModel(block, Contact(ratio * 1e9, 0.4e9), Load(5e6, **load))


def test_the_names_are_those_of_scenes():
    assert SCHEMES == ("newmark", "chung-hulbert", "hht", "wbz", "leapfrog", "composite")
    assert all(named_scheme(name, step=1e-3, **values).name == name for name, values in CASES)


@pytest.mark.parametrize("omega", [1.9, 40.0])
@few_schemes
def test_roots_are_those_of_steps_written_as_in_the_papers(name, values, omega):
    """The polynomial of the roots makes nothing of displacements in a row; the first step of leapfrog is its own."""
    if name == "leapfrog" and omega > 2:
        return
    gg = 0.93
    scheme = scheme_of(name, values, 1.0, gg)
    found = roots.roots(scheme, omega)
    one = np.eye(1)
    x, _, _ = march(
        System(one, omega**2 * one, lambda t: 0 * one[0]), name, 1.0, 12, one[0], one[0], gg, **truth_of(values)
    )
    polynomial = np.poly(found)
    left = np.convolve(x[1:, 0], polynomial, "valid")
    assert np.max(np.abs(left)) < 1e-12 * np.max(np.abs(x)) * np.sum(np.abs(polynomial))
    largest = np.sort(np.abs(np.linalg.eigvals(step_of_mode(scheme, omega))))[::-1][: len(found)]
    assert largest == pytest.approx(np.abs(found), abs=2e-6)


def dense(model):
    """Return the model in all six unknowns, and the row of the displacement."""
    return System(model.mass, model.stiffness, lambda t: model.force * 1.0), 1


@every_scheme
def test_histories_are_those_written_as_in_the_papers(name, values):
    """Under a load that rises, on a base that moves; in reduced and in all unknowns."""
    step, steps, gg = 3e-4, 18, 0.97
    scheme = scheme_of(name, values, step, gg)
    t = scheme.instants(steps)
    path = np.column_stack([1e-3 * np.sin(90 * t) ** 2, 2e-3 * np.sin(70 * t) ** 2])
    still = square(1.7, 0.2)

    def load(now):
        base = np.array([np.interp(now, t, part) for part in path.T])
        return still.force * min(now / 4.1e-3, 1.0) + still.stiffness[:, :2] @ base

    system = System(still.mass, still.stiffness, load)
    D, _, _ = march(system, name, step, steps, np.zeros(6), np.zeros(6), gg, **truth_of(values))
    model = square(1.7, 0.2, ramp=4.1e-3, motion=BaseMotion(t, path))
    for full in (False, True):
        result = solve(model, scheme, steps, ("displacement", "horizontal_displacement"), full)
        assert result.solves == steps * len(scheme.stages)
        for column, row in (("displacement", 1), ("horizontal_displacement", 0)):
            assert np.max(np.abs(result.columns[column] - D[1:, row])) < 1e-11 * np.max(np.abs(D[:, row])), column


def test_what_grows_is_stepped_and_overflows_by_name():
    result = solve(square(100.0), named_scheme("leapfrog", step=5e-3), 300)
    reached = np.isfinite([*result.columns.values()]).all(axis=0)
    assert {"stepped: a mode grows", f"overflow at step {reached.sum() + 1}"} < {*result.notes}


@few_schemes
def test_diagnostics_and_modes(name, values, held):
    scheme = scheme_of(name, values, 3e-4, 0.99)
    measured = diagnostics(square(2.0, 0.2), scheme)
    assert measured.spectral_radius == pytest.approx(measured.predicted_radius, rel=1e-9)
    held(f"diagnostics {name}", measured)
    for mode in modes(square(2.0, 0.2), scheme):
        assert abs(mode.eigenvalues[0]) == pytest.approx(abs(roots.roots(scheme, mode.frequency * 3e-4)[0]), rel=1e-9)


@pytest.mark.parametrize(
    ("name", "values", "along"),
    thinned([(*case, along) for case in CASES for along in (None, (0.3, 1.0))], 5),
)
def test_the_response_is_what_steady_vibration_is_stepped_to(name, values, along):
    frequency = 25.0
    step = 4e-4
    scheme = scheme_of(name, values, step, 0.75)
    steps = 170
    t = scheme.instants(steps)
    cosine = np.cos(2 * np.pi * frequency * t)
    motion = None if along is None else BaseMotion(t, 1e-3 * np.outer(cosine - 1, along))
    model = square(1.3, 0.2, motion=motion)
    amplitude = response(model, scheme, [frequency], ("displacement",), along)["displacement"][0]
    if motion is None:
        system, row = dense(square(1.3, 0.2))
        force = system.F(0)
        system.F = lambda now: force * math.cos(2 * math.pi * frequency * now)
        D, _, _ = march(system, name, step, steps, np.zeros(6), np.zeros(6), 0.75, **truth_of(values))
        late = D[1:, row]
    else:
        alone = replace(model, load=Load(motion=motion))
        late = solve(alone, scheme, steps, ("displacement",)).columns["displacement"] * 1e3
        late = late + along[1]  # counted from where the base is at t = 0
    expected = (amplitude * np.exp(2j * np.pi * frequency * step * np.arange(1, steps + 1))).real
    tail = slice(steps - 40, steps)
    assert np.max(np.abs(late - expected)[tail]) < 1e-6 * abs(amplitude)
