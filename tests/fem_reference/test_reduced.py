"""A Krylov space holds the history of the steps; where it does not pay the block is stepped."""

import pytest
from oracles.elements import error, make, stepped

from fem_reference import Scheme, solve
from fem_reference.history import reduced

CONSTANT = Scheme(0.5, 1.0, 1.0, 1e-3)


@pytest.mark.parametrize(
    ("problem", "scheme", "steps", "reason"),
    [
        (make(), CONSTANT, 20, "few steps"),
        (make(poisson=0.3, elements=8), Scheme(0.25, 0.5, 1.0, 1e-5), 100, "vectors do not represent the history"),
        (make(poisson=0.3, elements=8), CONSTANT, 40, ": 8 Krylov vectors do"),
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


def test_a_small_space_holds_the_history_of_the_steps():
    problem = make(poisson=0.25, degree=1, elements=6)
    scheme = Scheme(0.5, 1.0, 0.97, 2e-3, "consistent")
    result = solve(problem, scheme, 400)
    assert result.notes[-1] == "blocked in 32 Krylov vectors"
    assert (result.factorisations, result.solves) == (1, 35)
    assert error(result.columns.values(), stepped(problem, scheme, 400)) <= min(1e-10, result.estimate)
