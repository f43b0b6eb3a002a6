"""The contact forces of one step: many at once, failures, cuts of the step."""

from dataclasses import replace

import numpy as np
import pytest
from conftest import thinned
from oracles.elements import make

from fem_reference import Friction, Motion, Scheme, Unilateral, solve_unilateral
from fem_reference.contact import points, stepper
from fem_reference.contact.driver import Cut, cut_step
from fem_reference.contact.iteration import NONE, OVERFLOW
from fem_reference.contact.law import INSIDE
from fem_reference.contact.stepper import ContactStepper, Marched
from fem_reference.history import unilateral

SCHEME = Scheme(0.5, 1.0, 0.9, 1e-3)


@pytest.mark.parametrize(
    ("shear", "rule"), thinned([("glued", "implicit"), ("frictionless", "newmark"), ("glued", "newmark")], 3)
)
def test_many_forces_are_solved_for_twice(shear, rule, monkeypatch):
    problem = make(elements=4, degree=1, eccentricity=0.3, poisson=0.2, shear=4e8)
    contact = Unilateral(gap=1e-5, velocity=-0.1, shear=shear, rule=rule)
    scheme = Scheme(0.25, 0.5, 0.9, 2e-4) if rule == "implicit" else replace(SCHEME, step=2e-4)
    few = solve_unilateral(problem, scheme, 50, contact)
    monkeypatch.setattr(stepper, "DENSE", 4)
    many = solve_unilateral(problem, scheme, 50, contact)
    assert 0 < few.columns["open_share"].mean() < 1 and many.solves > few.solves
    for name, values in few.columns.items():
        # rounding of the energies lost is that of the energies
        size = max(np.abs(values).max(), np.abs(few.columns["strain_energy"]).max() if "loss" in name else 0.0)
        assert np.abs(many.columns[name] - values).max() <= 1e-10 * size, name


class Refusing(ContactStepper):
    """A stepper that finds no contact in steps longer than a share of its own."""

    longest = 1.0

    def __post_init__(self):
        super().__post_init__()
        self.lengths = []  # of the accepted pieces over the step

    def march(self, state, record, ratio=1.0):
        if ratio > self.longest * (1 + 1e-9):
            return Marched(state, 0, 3, NONE)
        self.lengths.append(ratio)
        return super().march(state, record, ratio)


def refusing(longest, **more):
    found = Refusing(points.build(make(elements=2)).system(), SCHEME, **more)
    found.longest = longest
    return found


def test_a_base_that_finds_no_contact_ends_with_its_reason(monkeypatch):
    monkeypatch.setattr(unilateral, "ContactStepper", lambda *a, **more: refusing(0.005))
    run = solve_unilateral(make(elements=2), SCHEME, 4)
    assert run.outcome == "no consistent contact state"
    assert len(run.time) == 0 and len(run.columns["displacement"]) == 0
    monkeypatch.setattr(unilateral, "ContactStepper", lambda *a, **more: refusing(0.01))
    run = solve_unilateral(make(elements=2), SCHEME, 1)
    # 1, 0.3, 0.09 and 0.027 are refused
    assert run.outcome == "completed" and run.columns["cuts"][0] == 4


def test_an_unstable_scheme_ends_with_its_overflow():
    run = solve_unilateral(make(elements=8), Scheme(0.0, 0.5, 1.0, 5e-3), 2000)
    assert run.outcome == "overflow" and 10 < len(run.time) < 2000
    assert all(np.all(np.isfinite(column)) for column in run.columns.values())


def test_a_step_from_a_velocity_without_bound_solves_no_contact():
    model = points.build(make(elements=2))
    one = ContactStepper(model.system(), SCHEME)
    start = unilateral.block_at_start(one, model, Unilateral())
    with np.errstate(all="ignore"):
        marched = one.march(start._replace(V=start.V + np.inf), one.record(1))
    assert (marched.steps, marched.solves, marched.outcome) == (0, 0, OVERFLOW)


SHAKE = Motion((0.0, 0.004, 0.011, 0.02, 0.03), (0.0, 1e-3, -2e-3, 1e-3, 0.0), (0.0, -5e-4, 1e-3, 0.0, 0.0))


def test_a_cut_step_starts_from_the_state_as_it_was_and_the_base_from_its_place():
    weight = {"gravity": 98.1, "slope": 25.0, "motion": SHAKE}
    problem = replace(make(elements=2, degree=1, poisson=0.2, shear=4e8), pressure=0.0, **weight)
    model = points.build(problem)
    scheme = replace(SCHEME, start="consistent")
    one, fresh = (kind(model.system("glued", Friction(10.0, 1e3)), scheme) for kind in (Refusing, ContactStepper))
    one.longest = 0.3
    rubbing = Unilateral(shear="glued", friction=Friction(10.0, 1e3))
    first = state = again = one.march(unilateral.block_at_start(one, model, rubbing), one.record(1), 0.3).state

    saved = [np.copy(part) for part in first]
    for _ in range(4):
        one.lengths.clear()
        row = one.record(1)
        step = cut_step(one, one.march(state, row), Cut(rubbing.cut, rubbing.shortest), row)
        assert one.lengths == pytest.approx([0.3, 0.3, 0.3, 0.1])
        for piece in one.lengths:
            again = fresh.march(again, fresh.record(1), piece).state
        state = step.state
    assert all(np.array_equal(a, b) for a, b in zip(saved, first, strict=True))
    assert np.any(state.states[len(model.share) :] != INSIDE) and state.position == pytest.approx(4.3, rel=1e-12)
    for name, value in state._asdict().items():
        assert np.array_equal(value, getattr(again, name)), name
    # the base is where its record says, whatever the steps were cut into
    assert state.parts[0] == pytest.approx(np.interp(4.3e-3, SHAKE.time, SHAKE.x), rel=1e-12)
