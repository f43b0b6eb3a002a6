"""Elements on a base that carries no tension: energy, momentum and the laws of contact, step by step."""

from dataclasses import replace

import numpy as np
import pytest
from conftest import thinned
from oracles.elements import make

from fem_reference import Motion, Scheme, Unilateral, solve_unilateral
from fem_reference.contact.points import build
from fem_reference.contact.stepper import ContactStepper

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
    stepper, k_t = ContactStepper(model, replace(CONSTANT, step=1e-4), "glued"), model.shear_stiffness
    state, again, wider = stepper.start(), 0, 0.0
    for _ in range(250):
        new, _ = stepper.advance(state)
        assert new is not None  # every step has its contact at once
        closed, size = new.closed, np.abs(new.slip).max()
        assert np.abs(model.tangential @ new.D - new.slip).max() <= 1e-11 * size
        assert np.abs(new.shear + k_t * (new.slip - new.reference))[closed].max(initial=0) <= 1e-10 * k_t.max() * size
        assert not new.shear[~closed].any() and np.array_equal(new.reference[~closed], new.slip[~closed])
        stuck, closing = closed & state.closed, closed & ~state.closed
        assert np.array_equal(new.reference[stuck], state.reference[stuck])
        share = state.gap / (state.gap - new.gap + (state.gap == new.gap))
        crossing = state.slip + share * (new.slip - state.slip)
        assert np.abs(new.reference - crossing)[closing].max(initial=0) <= 1e-10 * size
        again += np.count_nonzero(closing)
        wider = max(wider, float(np.abs(new.slip - crossing)[closing].max(initial=0)) / size)
        state = new
    assert again > 10 and wider > 1e-3


LOSSES = ("algorithmic_loss", "kinetic_damping_loss", "switching_loss", "friction_loss")


@pytest.mark.parametrize(
    ("scheme", "contact"),
    thinned(
        [
            (replace(CONSTANT, start="zero", gg=0.98), GLUED),
            (replace(AVERAGE, gg=0.999), Unilateral()),
            (replace(AVERAGE, start="zero"), GLUED),
            (Scheme(0.3025, 0.6, 0.99, 2e-4, "zero"), GLUED),
            (Scheme(0.5625, 1.0, 1.0, 1e-3, "zero"), replace(GLUED, limit=2)),
            (replace(AVERAGE, gg=0.999), Unilateral(rule="implicit")),
            (replace(AVERAGE, start="zero", step=3e-4), replace(GLUED, rule="implicit")),
        ],
        3,
    ),
)
def test_what_is_stored_and_what_is_lost_add_up_to_the_start(scheme, contact):
    glue = 4e10 if contact.shear == "glued" else 0.0
    problem = make(elements=4, degree=1, eccentricity=0.3, poisson=0.25, p=1e11, shear=glue)
    if contact.limit == 2:
        problem = replace(problem, elements=8, degree=2, eccentricity=0.5)
    problem = replace(problem, gravity=9.81, traction=2e5)
    run = solve_unilateral(problem, scheme, 120, replace(contact, gap=1e-4, velocity=-0.5))
    stored = np.sum([run.columns[name] for name in ENERGIES], axis=0)
    lost = np.array([run.columns[name] for name in LOSSES])
    begun = 2700.0 * 4 * 0.5**2 / 2
    size = np.abs([run.columns[name] for name in ENERGIES]).max()
    assert run.outcome == "completed"
    # of the rounding of the energies: squares of what a hundred solutions have rounded
    assert np.abs(stored + lost.sum(axis=0) - begun).max() <= 1e-10 * size
    assert np.abs(lost[2]).max() > 1e-3 * begun and np.any(run.columns["open_share"] > 0)
    assert (lost[1].max() > 0) == (scheme.gg < 1)
    if scheme.delta == 1 or contact.rule == "implicit":
        assert np.diff(lost[0] + lost[2])[1:].min() >= -1e-12 * size
    if contact.rule == "implicit":
        plain = solve_unilateral(problem, scheme, 120, replace(contact, gap=1e-4, velocity=-0.5, rule="newmark"))
        assert np.diff(plain.columns["algorithmic_loss"] + plain.columns["switching_loss"]).min() < -1e-3 * size
    assert run.columns["cuts"].max() > 0 or contact.limit > 2


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
