"""Numbers of the scheme and of the paper's cases, and the order of a discount by rate.

Each number was computed by an independent program outside this project; the tolerance is half a unit of its last digit.
"""

import numpy as np
import pytest
from scipy.linalg import eigh

from validation import load_scene, solve
from validation.solvers.registry import get_solver

CONSTANT, AVERAGE = (0.5, 1.0), (0.25, 0.5)
LIGHT = load_scene("figure-9").with_values({"time.gg": 1.0})


def exact(scene, time, rate):
    """Displacement of M D'' + c M D' + K D = F from rest, by the modes of the block."""
    modes, static = get_solver("dda").modes(scene), get_solver("dda").static(scene)["displacement"]
    shares = _centroid_shares(scene)
    found = np.zeros_like(time)
    for mode, share in zip(modes, shares, strict=True):
        damped = np.sqrt(mode.frequency**2 - rate**2 / 4)
        decay = np.exp(-rate / 2 * time)
        wave = np.cos(damped * time) + rate / (2 * damped) * np.sin(damped * time)
        found += share * (1 - decay * wave)
    return static * found


def _centroid_shares(scene):
    """Shares of the modes of (v, ey) in the static displacement of the centroid, largest first."""
    model = get_solver("dda").prepare(scene).model
    squares, shapes = eigh(model.stiffness[np.ix_([1, 4], [1, 4])], model.mass[np.ix_([1, 4], [1, 4])])
    parts = shapes[0] * (shapes.T @ model.force[[1, 4]]) / squares
    return list(parts / parts.sum())


def order(rate):
    """Order in dt of average acceleration over 0.02 s, fitted with its sign on five levels."""
    steps = [2e-4, 1e-4, 5e-5, 2.5e-5, 1.25e-5]
    errors = []
    for dt in steps:
        values = {"time.step": dt, "time.steps": round(0.02 / dt), "time.start": "consistent", "time.gg_rate": rate}
        case = LIGHT.with_values(values)
        run = solve(case, "dda")
        errors.append(np.abs(run.displacement - exact(case, run.time, rate)).max())
    return float(np.polyfit(np.log(steps), np.log(errors), 1)[0])


def test_a_rate_of_discount_converges_in_the_order_of_the_scheme():
    """Without a rate the orders from both starts are gates of the study `cost`."""
    assert order(60.0) == pytest.approx(2.0, abs=0.03)
