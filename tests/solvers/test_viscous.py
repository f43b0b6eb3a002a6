"""Damping tables, C = a0 M + a1 K: the radius of the step and the decay of the bar."""

import numpy as np
import pytest

from validation import load_scene
from validation.solvers.registry import get_solver

TABLES = {"damping.mass": 20.0, "damping.stiffness": 3e-4}
BLOCK = load_scene("figures-3-4").with_values({"time.step": 5e-4, "time.steps": 120} | TABLES)


def test_the_radius_of_the_step_is_the_predicted_one():
    found = get_solver("dda").prepare(BLOCK).diagnostics()
    assert found["spectral_radius"] == pytest.approx(found["predicted_radius"], rel=1e-10)


def test_the_bar_decays_by_rayleighs_formula():
    exact = get_solver("continuum").prepare(BLOCK).modes()[0]
    rate = -2 * np.log(abs(exact.eigenvalues[0])) / BLOCK.time.step
    assert rate == pytest.approx(20.0 + 3e-4 * exact.frequency**2, rel=1e-9)
