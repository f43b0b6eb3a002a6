"""The sixty-digit references against other routes to the same numbers."""

import mp_reference
import numpy as np
import pytest
from conftest import SCENE
from mpmath import mp, mpf
from scipy.sparse import csr_array, diags_array

from validation import load_scene, precise_bar, precise_block, precise_matrices, solve
from validation.history import Outcome
from validation.scene import Scene
from validation.solvers import get_solver

COLUMNS = ("displacement", "contact_pressure")
PENTAGON = [[1, 1], [3.1, 1.7], [2.9, 3.3], [1.5, 4], [0.7, 2]]


@pytest.fixture
def scene(tmp_path) -> Scene:
    (tmp_path / "small.toml").write_text(SCENE)
    return load_scene(tmp_path / "small.toml")


SCHEMES = [(0.5, 1.0, 1.0, "zero"), (0.3025, 0.6, 0.9, "consistent"), (0.0, 0.5, 1.0, "zero")]


@pytest.mark.parametrize(("alpha", "delta", "gg", "start"), SCHEMES)
@pytest.mark.parametrize("outline", ["square", "pentagon"])
def test_the_block_by_modes_is_the_block_by_matrices(scene, outline, alpha, delta, gg, start):
    values = {"time.alpha": alpha, "time.delta": delta, "time.gg": gg, "time.start": start, "block.poisson": 0.31}
    if outline == "pentagon":
        values |= {"block.vertices": PENTAGON, "block.top": 3, "contact.shear_stiffness": 3e8}
    case = scene.with_values(values)
    dda = get_solver("dda")
    reference = mp_reference.history(dda.model(case), dda.scheme(case), case.time.steps)
    found = precise_block.history(case, COLUMNS)
    for name, exact in zip(COLUMNS, reference, strict=True):
        with mp.workdps(80):
            peak = max(abs(x) for x in exact)
            assert max(abs(a - b) for a, b in zip(found[name], exact, strict=True)) < mpf(10) ** -60 * peak


@pytest.mark.parametrize(("alpha", "delta", "gg", "start"), SCHEMES[:2])
@pytest.mark.parametrize(("p", "step"), [(1e9, 1e-3), (1e14, 1e-2)])
def test_the_bar_without_modes_is_the_bar_by_modes(scene, p, step, alpha, delta, gg, start):
    values = {"time.alpha": alpha, "time.delta": delta, "time.gg": gg, "time.start": start}
    case = scene.with_values(values | {"contact.stiffness": p, "time.step": step})
    exact, bar = precise_bar.history(case, COLUMNS), solve(case, "bar").history
    for name in COLUMNS:
        rounded = np.array([float(value) for value in exact[name]])
        # the modes of `bar` are cut off at an estimated 1e-11 and their sum carries some roundings each
        assert np.max(np.abs(bar.columns[name] - rounded)) < 1e-13 * np.max(np.abs(rounded))


def test_the_bars_precise_values_do_not_depend_on_the_circle(scene, monkeypatch):
    first = precise_bar.history(scene, COLUMNS)
    monkeypatch.setattr(precise_bar, "ALIAS", 45)
    second = precise_bar.history(scene, COLUMNS)
    for name in COLUMNS:
        peak = max(map(abs, first[name]))
        assert max(abs(a - b) for a, b in zip(first[name], second[name], strict=True)) < mpf(10) ** -30 * peak


@pytest.mark.parametrize(("alpha", "delta", "gg", "start"), SCHEMES)
def test_matrices_of_separate_oscillators_are_the_oscillators(scene, alpha, delta, gg, start):
    values = {"time.alpha": alpha, "time.delta": delta, "time.gg": gg, "time.start": start}
    case = scene.with_values(values)
    squares, load = np.array([1e4, 3e5, 7e2]), np.array([1.0, -2.0, 0.5])
    mass = np.array([2.0, 3.0, 5.0])
    M, K = csr_array(diags_array(mass)), csr_array(diags_array(mass * squares))
    rows = {f"x{i}": np.eye(3)[i] for i in range(3)}
    found = precise_matrices.history(case, M, K, load, rows, 3.0)
    with mp.workdps(precise_block.WORKING):
        scheme = precise_block.NewmarkNumbers.of(case)
        for i in range(3):
            w2 = mpf(float(K.diagonal()[i])) / mpf(float(mass[i]))
            exact = precise_block.modal_history(w2, 3 * mpf(float(load[i])) / mpf(float(mass[i])), scheme, 50)
            peak = max(map(abs, exact))
            assert max(abs(a - b) for a, b in zip(found[f"x{i}"], exact, strict=True)) < mpf(10) ** -60 * peak


def test_a_coupled_system_is_solved(scene):
    """One huge implicit step is the static solution, to the order of 1 / (alpha dt^2 w^2)."""
    fem = get_solver("fem")
    case = scene.with_values({"time.step": 1e12, "time.steps": 1, "time.alpha": 1.0, "block.poisson": 0.3})
    exact = solve(case, "fem-60").history
    for name, value in fem.static(case).items():
        if name in COLUMNS:
            assert exact.columns[name][0] == pytest.approx(value, rel=1e-10)


@pytest.mark.parametrize(("double", "precise"), [("dda", "dda-60"), ("fem", "fem-60"), ("bar", "bar-60")])
def test_precise_solvers_are_ordinary_solvers(scene, double, precise):
    fast, exact = solve(scene, double), solve(scene, precise)
    assert exact.outcome is Outcome.COMPLETED
    assert exact.history.time == pytest.approx(fast.history.time, rel=1e-15)
    for name in COLUMNS:
        assert fast.history.columns[name] == pytest.approx(exact.history.columns[name], rel=1e-11, abs=1e-20)
    full = solve(scene, precise, full=True)
    assert full.displacement == pytest.approx(exact.displacement, rel=1e-13)


def test_a_large_mesh_is_refused_in_words(scene):
    large = scene.with_values({"fem.elements": 16, "block.poisson": 0.3})
    assert "sixty-digit arithmetic take minutes" in get_solver("fem-60").applicable(large)


def test_what_a_double_cannot_hold_is_infinite_from_there_on(scene):
    grown = scene.with_values(
        {"time.alpha": 0.0, "time.delta": 0.5, "time.step": 1.0, "time.allow_unstable": True, "time.steps": 80}
    )
    values = solve(grown, "dda-60").displacement
    first = int(np.argmax(np.isinf(values)))
    assert first > 0 and np.all(np.isfinite(values[:first])) and np.all(np.isinf(values[first:]))
