"""The sixty-digit references against other routes to the same numbers."""

import numpy as np
import pytest
from conftest import thinned
from flint import arb
from mpmath import mp, mpf
from oracles import mp_reference

from validation import solve
from validation.errors import InputError
from validation.runs.run import Outcome
from validation.solvers.registry import get_solver
from validation.solvers.sixty_digits import bar as precise_bar
from validation.solvers.sixty_digits import block as precise_block
from validation.solvers.sixty_digits import matrices as precise_matrices

COLUMNS = ("displacement", "contact_pressure")
PENTAGON = [[1, 1], [3.1, 1.7], [2.9, 3.3], [1.5, 4], [0.7, 2]]


def exactly(values: list[arb]) -> list[mpf]:
    """Midpoints of balls; call it with enough digits set."""
    return [mpf(value.str(mp.dps, radius=False)) for value in values]


SCHEMES = [(0.5, 1.0, 1.0, "zero"), (0.3025, 0.6, 0.9, "consistent"), (0.0, 0.5, 1.0, "zero")]


@pytest.mark.parametrize(
    ("outline", "alpha", "delta", "gg", "start"),
    thinned(((outline, *scheme) for outline in ("square", "pentagon") for scheme in SCHEMES), 2),
)
def test_the_block_by_trace_and_determinant_is_the_block_by_steps(scene, outline, alpha, delta, gg, start):
    values = {"time.alpha": alpha, "time.delta": delta, "time.gg": gg, "time.start": start, "block.poisson": 0.31}
    if outline == "pentagon":
        values |= {"block.vertices": PENTAGON, "block.top": 3, "contact.shear_stiffness": 3e8}
    case = scene.with_values(values)
    block = get_solver("dda").prepare(case)
    reference = mp_reference.history(block.model, block.scheme, case.time.steps)
    found = precise_block.history(case, COLUMNS)
    for name, exact in zip(COLUMNS, reference, strict=True):
        with mp.workdps(80):
            peak = max(abs(x) for x in exact)
            assert max(abs(a - b) for a, b in zip(exactly(found[name]), exact, strict=True)) < mpf(10) ** -60 * peak


@pytest.mark.parametrize(
    ("p", "step", "alpha", "delta", "gg", "start"),
    thinned((((p, step, *scheme)) for p, step in ((1e9, 1e-3), (1e14, 1e-2)) for scheme in SCHEMES[:2]), 3),
)
def test_the_bar_without_modes_is_the_bar_by_modes(scene, p, step, alpha, delta, gg, start):
    values = {"time.alpha": alpha, "time.delta": delta, "time.gg": gg, "time.start": start}
    case = scene.with_values(values | {"contact.stiffness": p, "time.step": step})
    exact, bar = precise_bar.history(case, COLUMNS), solve(case, "bar").history
    for name in COLUMNS:
        rounded = np.array([float(value) for value in exact[name]])
        # the modes of `bar` are cut off at an estimated 1e-11 and their sum carries some roundings each
        assert np.max(np.abs(bar.columns[name] - rounded)) < 1e-13 * np.max(np.abs(rounded))


def test_the_bars_precise_values_are_proven_and_hold_those_of_more_digits(scene, monkeypatch):
    values = {"time.alpha": 0.25, "time.delta": 0.5, "time.step": 1e-4, "time.steps": 200}
    slow = scene.with_values(values)  # of 120 digits 52 are left
    first = precise_bar.history(slow, COLUMNS)
    monkeypatch.setattr(precise_bar, "DIGITS", 150)
    second = precise_bar.history(slow, COLUMNS)
    for name in COLUMNS:
        peak = max(map(abs, first[name]))
        assert max(value.rad() for value in second[name]) < peak * arb("1e-149")
        for value, finer in zip(first[name], second[name], strict=True):
            assert value.rad() < peak * arb("1e-59")
            assert value.overlaps(finer)


def stepped(M, K, F, rows, case):
    """Return the columns by plain steps of dense matrices, equations (4) to (9) as they stand."""
    t = case.time
    a, d, gg, dt = (mpf(x) for x in (t.alpha, t.delta, t.discount, t.step))
    S, M_inverse = (M + a * dt**2 * K) ** -1, M**-1
    D, V = 0 * F, 0 * F
    A = M_inverse * F if t.start == "consistent" else 0 * F
    columns = {name: [] for name in rows}
    for _ in range(t.steps):
        ahead = D + gg * dt * V + dt**2 * (mpf(1) / 2 - a) * A
        D = S * (M * ahead + a * dt**2 * F)
        after = M_inverse * (F - K * D)
        V = gg * V + dt * ((1 - d) * A + d * after)
        A = after
        for name, row in rows.items():
            columns[name].append(mp.fdot(row, D))
    return columns


@pytest.mark.parametrize(("alpha", "delta", "gg", "start"), thinned(SCHEMES, 2))
def test_a_mesh_by_trace_and_determinant_is_the_mesh_by_steps(scene, alpha, delta, gg, start):
    values = {"time.alpha": alpha, "time.delta": delta, "time.gg": gg, "time.start": start, "fem.elements": 1}
    case = scene.with_values(values | {"block.poisson": 0.3, "time.steps": 12, "time.step": 3e-4, "fem.degree": 1})
    model = get_solver("fem-60").prepare(case).model
    rows = {name: model.observers[name] for name in COLUMNS}
    found = precise_matrices.history(case, model.M, model.K, model.F, rows, 3.0)
    with mp.workdps(precise_block.WORKING):
        M, K = (mp.matrix(matrix.toarray().tolist()) for matrix in (model.M, model.K))
        exact = stepped(M, K, 3 * mp.matrix(model.F.tolist()), {n: list(map(mpf, rows[n])) for n in rows}, case)
        for name in COLUMNS:
            peak = max(map(abs, exact[name]))
            assert (
                max(abs(a - b) for a, b in zip(exactly(found[name]), exact[name], strict=True)) < mpf(10) ** -60 * peak
            )


@pytest.mark.parametrize(("double", "precise"), [("dda", "dda-60"), ("fem", "fem-60"), ("bar", "bar-60")])
def test_precise_solvers_are_ordinary_solvers(scene, double, precise):
    fast, exact = solve(scene, double), solve(scene, precise)
    assert exact.outcome is Outcome.COMPLETED
    assert exact.history.time == pytest.approx(fast.history.time, rel=1e-15)
    for name in COLUMNS:
        assert fast.history.columns[name] == pytest.approx(exact.history.columns[name], rel=1e-11, abs=1e-20)


def test_a_large_mesh_is_refused_in_words(scene):
    large = scene.with_values({"fem.elements": 16, "block.poisson": 0.3})
    assert "sixty-digit arithmetic would take minutes" in get_solver("fem-60").applicable(large)
    whole = scene.with_values({"fem.elements": 6})  # one column of elements is small, the whole block is not
    assert get_solver("fem-60").applicable(whole) is None
    with pytest.raises(InputError, match="sixty-digit arithmetic would take minutes"):
        solve(whole, "fem-60", full=True)


def test_what_a_double_cannot_hold_is_infinite_from_there_on(scene):
    grown = scene.with_values(
        {"time.alpha": 0.0, "time.delta": 0.5, "time.step": 1.0, "time.allow_unstable": True, "time.steps": 80}
    )
    values = solve(grown, "dda-60").displacement
    first = int(np.argmax(np.isinf(values)))
    assert first > 0 and np.all(np.isfinite(values[:first])) and np.all(np.isinf(values[first:]))
