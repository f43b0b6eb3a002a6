"""Histories in a Krylov space: equal to stepped ones, with an honest estimate, for one factorisation."""

import pytest
from conftest import thinned
from oracles.elements import error, make, stepped

from fem_reference import Scheme, solve
from fem_reference.history import reduced

CONSTANT = Scheme(0.5, 1.0, 1.0, 1e-3)
PATCH = {"poisson": 0.3, "hypothesis": "plane strain", "foundation": "patch", "patch_width": 0.31}


@pytest.mark.parametrize(
    ("change", "scheme"),
    thinned(
        [
            ({"poisson": 0.25, "degree": 1, "elements": 16}, CONSTANT),
            ({"poisson": 0.3, "hypothesis": "plane strain"}, Scheme(0.5, 1.0, 0.97, 8e-4, "consistent")),
            (PATCH, Scheme(0.5625, 1.0, 0.97, 2e-3, "consistent")),
            ({**PATCH, "elements": 5}, Scheme(0.3025, 0.6, 0.97, 2e-3)),
            ({"poisson": 0.3, "eccentricity": 0.2, "gravity": 9.81}, Scheme(0.5, 1.0, 1.0, 2e-3)),
            ({"poisson": 0.3, "p": 1e6}, Scheme(0.5, 1.0, 1.0, 5e-3)),
            ({"poisson": 0.3, "p": 1e16}, Scheme(0.25, 0.5, 0.98, 5e-3)),
            ({"elements": 24}, Scheme(0.25, 0.5, 1.0, 1e-3, "consistent")),
            ({"elements": 24}, Scheme(0.5, 1.0, 1.0, 1e-5)),
        ],
        9,
    ),
)
def test_the_history_is_that_of_the_steps(change, scheme):
    problem = make(**{"elements": 8, "degree": 2, **change})
    steps = 400
    result = solve(problem, scheme, steps)
    assert result.notes[-1].endswith("Krylov vectors") and result.notes[-1].startswith("blocked")
    assert result.factorisations == 1
    assert result.solves <= steps // reduced.PAID + 1
    off = error(result.columns.values(), stepped(problem, scheme, steps))
    assert off <= 1e-10
    assert off <= result.estimate


@pytest.mark.parametrize(
    ("problem", "scheme", "steps", "reason"),
    [
        (make(), CONSTANT, 20, "few steps"),
        (make(poisson=0.3, elements=8), Scheme(0.25, 0.5, 1.0, 1e-5), 100, "vectors do not represent the history"),
        (make(), Scheme(0.0, 0.5, 1.0, 1e-7), 100, "an explicit step is unstable"),
        (make(), Scheme(0.2, 0.5, 1.0, 1e-7), 100, "unstable for the high frequencies"),
    ],
)
def test_where_no_space_pays_the_block_is_stepped_and_says_why(problem, scheme, steps, reason):
    result = solve(problem, scheme, steps)
    assert result.notes[-1].startswith("stepped: ") and reason in result.notes[-1]
    assert result.estimate is None
    assert steps <= result.solves <= steps + steps // reduced.PAID + 1 or scheme.alpha == 0
    assert error(result.columns.values(), stepped(problem, scheme, steps)) == 0
