"""Where a small space would not hold the digits: what is asked for comes out all the same, as plain steps give it."""

import pytest
from oracles.elements import error, make, stepped

from fem_reference import Scheme, solve

STEPS = 200
CASES = {
    "light modes under a consistent start, long steps": (
        {"p": 4.6e15, "poisson": 0.2, "elements": 2, "degree": 1},
        Scheme(0.5625, 1.0, 1.0, 2.4653, "consistent"),
    ),
    "a space that closes late": ({"p": 1.4e14, "elements": 4, "degree": 2}, Scheme(0.5, 1.0, 0.98, 5.7465)),
    "columns that have hardly begun, a stiff spring": (
        {"p": 1.8e17, "elements": 3, "degree": 2},
        Scheme(0.5625, 1.0, 1.0, 2.1361e-6),
    ),
}


@pytest.mark.parametrize(("change", "scheme"), CASES.values(), ids=CASES)
def test_what_no_small_space_holds_is_stepped(change, scheme):
    problem = make(**change)
    result = solve(problem, scheme, STEPS)
    off = error(result.columns.values(), stepped(problem, scheme, STEPS))
    assert off <= 1e-10  # without a guard: 1e-7, 3e-7 and 3e-10
    assert result.estimate is None or off <= result.estimate


@pytest.mark.long
def test_the_stiffness_of_slow_modes_keeps_its_digits_through_many_steps():
    """1 - tau of the slowest mode, 5e-7, has lost 5e-10 of itself; half of that, over 11 rad, is a phase of 3e-9."""
    problem, scheme, steps = make(p=1e6, elements=2, degree=1, poisson=0.3), Scheme(0.25, 0.5, 1.0, 1e-4), 8000
    result = solve(problem, scheme, steps)
    assert result.notes[-1].startswith("blocked")
    assert error(result.columns.values(), stepped(problem, scheme, steps)) <= 1e-10
