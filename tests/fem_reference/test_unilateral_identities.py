"""Elements on a base that carries no tension: energy, momentum and the laws of contact, step by step."""

from dataclasses import replace

import numpy as np
import pytest
from oracles.elements import make

from fem_reference import Motion, Scheme, Unilateral, solve_unilateral
from fem_reference.contact.iteration import CONVERGED
from fem_reference.contact.law import INSIDE
from fem_reference.contact.points import build
from fem_reference.contact.stepper import ContactStepper
from fem_reference.history.unilateral import block_at_start

AVERAGE = Scheme(0.25, 0.5, 1.0, 1e-4, "consistent")
CONSTANT = Scheme(0.5, 1.0, 1.0, 1e-4, "consistent")
GLUED = Unilateral(shear="glued")
ENERGIES = ("kinetic_energy", "strain_energy", "spring_energy", "load_energy")


def energy(model, scheme, state):
    """Energies of motion, strain, base springs and loads, and what the scheme counts beside them [J]."""
    D, V, A = state.D, state.V, state.A
    springs = state.normal @ (state.normal / model.stiffness)
    extra = (scheme.alpha - scheme.delta / 2) * scheme.step**2 * (A @ (model.M @ A))
    return (V @ (model.M @ V) + D @ (model.K @ D) + springs + extra) / 2 - model.F @ D


def test_glued_points_bear_their_stretch_from_where_they_closed():
    problem = replace(make(elements=4, eccentricity=0.3, poisson=0.25, p=1e9, shear=4e8), traction=2e5)
    model = build(problem)
    stepper, k_t = ContactStepper(model.system("glued"), replace(CONSTANT, step=1e-4)), model.shear_stiffness
    state, again, wider, points = block_at_start(stepper, model, Unilateral()), 0, 0.0, len(k_t)
    slip = reference = np.zeros(points)
    closed = np.ones(points, dtype=bool)
    for _ in range(250):
        marched = stepper.march(state, stepper.record(1))
        assert marched.outcome == CONVERGED  # every step has its contact at once
        new = marched.state
        gap, before = new.place[:points], state.place[:points]
        was_closed, closed = closed, new.states[:points] == INSIDE
        was, slip = slip, model.tangential @ new.D
        size = np.abs(slip).max()
        shear, stretch = new.force[points:], new.place[points:]
        assert np.abs(shear + k_t * stretch).max() <= 1e-10 * k_t.max() * size
        assert not shear[~closed].any() and not stretch[~closed].any()
        share = before / (before - gap + (before == gap))
        crossing = was + share * (slip - was)
        closing = closed & ~was_closed
        # Where it sticks its reference stays, where it closes that is the crossing, and it follows what is open.
        reference = np.where(closing, crossing, np.where(closed, reference, slip))
        assert np.abs(slip - stretch - reference).max() <= 1e-10 * size
        again += np.count_nonzero(closing)
        wider = max(wider, float(np.abs(slip - crossing)[closing].max(initial=0)) / size)
        state = new
    assert again > 10 and wider > 1e-3


LOSSES = ("algorithmic_loss", "kinetic_damping_loss", "switching_loss", "friction_loss")


@pytest.mark.parametrize("rule", ["newmark", "implicit"])
def test_the_work_of_a_base_that_moves_is_counted(rule):
    motion = Motion((0.0, 0.01, 0.02), (0.0, 1e-3, 0.0), (0.0, 2e-3, -1e-3))
    problem = replace(make(elements=3, degree=1, poisson=0.25, shear=4e8), gravity=9.81, motion=motion)
    contact = replace(GLUED, rule=rule, gap=1e-4, velocity=-0.5)
    run = solve_unilateral(problem, replace(AVERAGE, start="zero"), 60, contact)
    energies = np.array([run.columns[name] for name in (*ENERGIES, *LOSSES)])
    assert np.abs(energies.sum(axis=0) - 2700.0 * 4 * 0.5**2 / 2).max() <= 1e-10 * np.abs(energies).max()


def test_columns_cost_only_where_they_are_asked_for():
    problem = make(elements=3, poisson=0.2)
    everything = solve_unilateral(problem, CONSTANT, 50).columns
    few = solve_unilateral(problem, CONSTANT, 50, columns=("cuts", "switching_loss", "displacement")).columns
    assert set(few) == {"cuts", "displacement", *LOSSES}
    assert all(np.array_equal(values, everything[name]) for name, values in few.items())
    with pytest.raises(ValueError, match=r"^columns: .*'depth'"):
        solve_unilateral(problem, CONSTANT, 1, columns=("depth",))
