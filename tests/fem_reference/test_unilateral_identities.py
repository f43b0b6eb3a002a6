"""Elements on a base that carries no tension: energy, momentum and the laws of contact, step by step."""

from dataclasses import replace

import numpy as np
import pytest
from oracles.elements import make

from fem_reference import Motion, Scheme, Unilateral, solve_unilateral

AVERAGE = Scheme(0.25, 0.5, 1.0, 1e-4, "consistent")
GLUED = Unilateral(shear="glued")
ENERGIES = ("kinetic_energy", "strain_energy", "spring_energy", "load_energy")


LOSSES = ("algorithmic_loss", "kinetic_damping_loss", "switching_loss", "friction_loss")


@pytest.mark.parametrize("rule", ["newmark", "implicit"])
def test_the_work_of_a_base_that_moves_is_counted(rule):
    motion = Motion((0.0, 0.01, 0.02), (0.0, 1e-3, 0.0), (0.0, 2e-3, -1e-3))
    problem = replace(make(elements=3, degree=1, poisson=0.25, shear=4e8), gravity=9.81, motion=motion)
    contact = replace(GLUED, rule=rule, gap=1e-4, velocity=-0.5)
    run = solve_unilateral(problem, replace(AVERAGE, start="zero"), 60, contact)
    energies = np.array([run.columns[name] for name in (*ENERGIES, *LOSSES)])
    assert np.abs(energies.sum(axis=0) - 2700.0 * 4 * 0.5**2 / 2).max() <= 1e-10 * np.abs(energies).max()
