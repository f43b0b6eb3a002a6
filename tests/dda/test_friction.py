"""One block with friction: histories known by their events."""

import numpy as np
import pytest
from oracles.frictional import KNOWN

from dda import Scheme, UnilateralOptions, solve_unilateral

PLACE = ("horizontal_displacement", "displacement", "rotation")


def error(name, dt, time, scheme=(0.25, 0.5, "consistent")):
    """Return the largest error of the centroid's (u, v, r) at a time, over the largest of them [-]."""
    known, (alpha, delta, start) = KNOWN[name], scheme
    result = solve_unilateral(known.model, Scheme(alpha, delta, 1.0, dt, start), round(time / dt), PLACE)
    exact = np.array(known.at[time])
    assert result.outcome == "completed" and not np.any(result.step_cuts)
    return np.max(np.abs([result.columns[name][-1] for name in PLACE] - exact)) / np.max(np.abs(exact))


@pytest.mark.parametrize(("name", "time"), [("rubbing", 0.01), ("pulled", 0.03), ("incline", 0.05)])
def test_a_history_is_that_of_its_events(name, time):
    assert error(name, 2e-5, time) < 2e-4  # of second order with a constant of a switch a millisecond


def test_friction_takes_energy_and_the_rest_is_kept():
    options = UnilateralOptions(energies=True)
    result = solve_unilateral(KNOWN["incline"].model, Scheme(0.25, 0.5, 1.0, 1e-4, "consistent"), 500, options=options)
    assert result.energies["friction"][-1] > 1.0 and result.slip[-1] > 1e-4
    assert np.min(np.diff(result.energies["friction"])) >= 0
    size = np.max(np.abs(list(result.energies.values())))
    assert np.max(np.abs(sum(result.energies.values()))) < 1e-11 * size
    assert {0, 1, 2} <= set(np.unique(result.states))
