"""The sixty-digit block against another route to the same numbers."""

import numpy as np
import pytest
from conftest import thinned
from flint import arb
from mpmath import mp, mpf
from oracles import mp_reference

from validation import solve
from validation.runs.run import Outcome
from validation.solvers.registry import get_solver
from validation.solvers.sixty_digits import block as precise_block

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


def test_dda_60_is_an_ordinary_solver(scene):
    fast, exact = solve(scene, "dda"), solve(scene, "dda-60")
    assert exact.outcome is Outcome.COMPLETED
    assert exact.history.time == pytest.approx(fast.history.time, rel=1e-15)
    for name in COLUMNS:
        assert fast.history.columns[name] == pytest.approx(exact.history.columns[name], rel=1e-11, abs=1e-20)


def test_what_a_double_cannot_hold_is_infinite_from_there_on(scene):
    grown = scene.with_values(
        {"time.alpha": 0.0, "time.delta": 0.5, "time.step": 1.0, "time.allow_unstable": True, "time.steps": 80}
    )
    values = solve(grown, "dda-60").displacement
    first = int(np.argmax(np.isinf(values)))
    assert first > 0 and np.all(np.isfinite(values[:first])) and np.all(np.isinf(values[first:]))
