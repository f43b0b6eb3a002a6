"""How many digits `fem` and `bar` keep with stiff springs and extreme steps, against sixty-digit arithmetic."""

from itertools import product

import numpy as np
import pytest
from conftest import thinned
from oracles.matrices_in_balls import lost

from fem_reference.problem.digits import bounded
from validation import load_scene

LIMIT = 1e-9  # over the maximum: what fem promises for p/E from 1e-3 to 1e12, and bar for every one
SCHEMES = [(0.5, 1.0, 1.0, "zero"), (0.25, 0.5, 1.0, "consistent"), (0.5625, 1.0, 0.9, "zero")]
EXTREMES = {
    "fem": [
        *({"contact.stiffness": 1e9 * ratio} for ratio in (1e-3, 1e3, 1e12)),
        {"block.density": 1e-6},
        {"block.width": 2000.0, "block.height": 2.0},
        {"block.poisson": -0.9, "fem.degree": 1},
        {"block.hypothesis": "plane strain", "block.poisson": 0.4999, "fem.degree": 1},
    ],
    "bar": [*({"contact.stiffness": 1e9 * ratio} for ratio in (1e-9, 1.0, 1e15)), {"block.density": 1e-6}],
}
CASES = [
    (solver, values, step, scheme)
    for solver, extremes in EXTREMES.items()
    for values, step, scheme in product(extremes, (1e-9, 1e-3, 1e3), SCHEMES)
]


def extreme(values, step=1e-3, scheme=SCHEMES[0]):
    """Return the scene of the extremes on two elements a side, of which sixty digits take little time."""
    of_scheme = dict(zip(("time.alpha", "time.delta", "time.gg", "time.start"), scheme, strict=True))
    return load_scene("extremes").with_values(
        {"fem.elements": 2, "fem.degree": 2, "time.steps": 100, "time.step": step, **of_scheme, **values}
    )


@pytest.mark.parametrize(("solver", "values", "step", "scheme"), thinned(CASES, 22))
def test_nine_digits_are_kept(solver, values, step, scheme):
    assert lost(extreme(values, step, scheme), solver) <= LIMIT


def test_a_block_whose_modes_are_all_infinitely_fast_for_the_step_is_stepped():
    """Its stiffness is 1 to rounding, or a little more, in the reduced elements' own measure."""
    assert lost(extreme({"block.density": 1e-6}, 1e3), "fem") <= LIMIT


def test_a_history_is_infinite_from_its_first_overflow_on():
    unit = np.array([[1.5, -2.0, 1e300, 3.0], [0.5, np.nan, 7.0, 0.0]])
    for pressure, first in ((1.0, [1.5, -2.0, 1e300, 3.0]), (-1e9, [-1.5e9, 2e9, np.inf, np.inf])):
        assert bounded(unit, pressure).tolist() == [first, [0.5 * pressure, np.inf, np.inf, np.inf]]
    assert not bounded(unit, 0.0).any()
