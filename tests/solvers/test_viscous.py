"""Damping tables, C = a0 M + a1 K: the radius of the step and the damping budget."""

import numpy as np
import pytest

from validation import damping, load_scene
from validation.solvers.registry import get_solver

TABLES = {"damping.mass": 20.0, "damping.stiffness": 3e-4}
BLOCK = load_scene("figures-3-4").with_values({"time.step": 5e-4, "time.steps": 120} | TABLES)


def test_the_radius_of_the_step_is_the_predicted_one():
    found = get_solver("dda").prepare(BLOCK).diagnostics()
    assert found["spectral_radius"] == pytest.approx(found["predicted_radius"], rel=1e-10)


def test_the_budget_has_a_viscous_part_that_rayleighs_formula_gives():
    scene = BLOCK.with_values({"time.step": 1e-5, "time.gg": 0.9999})
    mode = damping(scene).modes[0]
    expected = 20.0 / (2 * mode.frequency) + 3e-4 * mode.frequency / 2
    assert mode.viscous == pytest.approx(expected, rel=2e-2)  # the parts add up to leading order
    assert mode.damping is not None and mode.algorithmic is not None and mode.kinetic is not None
    assert mode.damping == pytest.approx(mode.algorithmic + mode.kinetic + mode.viscous, rel=1e-12)
    assert "viscous" in damping(scene).sentence
    free = damping(BLOCK.with_values({"damping.mass": 0.0, "damping.stiffness": 0.0})).modes[0]
    assert free.viscous == 0
    exact = get_solver("continuum").prepare(BLOCK).modes()[0]
    rate = -2 * np.log(abs(exact.eigenvalues[0])) / BLOCK.time.step
    assert rate == pytest.approx(20.0 + 3e-4 * exact.frequency**2, rel=1e-9)
