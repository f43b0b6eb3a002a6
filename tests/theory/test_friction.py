"""The closed forms of sliding: printed numbers, identities of the recursion, and equilibrium at other data."""

import numpy as np
import pytest

from validation import load_scene, solve
from validation.theory import friction

SLOPE = {
    "contact.law": "unilateral",
    "contact.friction": 15.0,
    "load.pressure": 0.0,
    "load.gravity": 9.81,
    "load.slope": 28.9,
}
OTHER = {"block.width": 1.5, "block.height": 3.0, "block.density": 2400.0, "block.young": 3e9, "contact.stiffness": 7e8}


def scene(**changes):
    base = {"time.step": 0.01, "time.steps": 100}
    return load_scene("figures-3-4").with_values(SLOPE | base | {k.replace("__", "."): v for k, v in changes.items()})


@pytest.mark.parametrize("gg", [1.0, 0.97])
@pytest.mark.parametrize(
    ("start", "numbers"),
    [
        ("consistent", {"time__scheme": "chung-hulbert", "time__rho_inf": 0.6}),
        ("zero", {"time__scheme": "composite", "time__rho_inf": 0.6}),
        ("consistent", {"time__scheme": "leapfrog"}),
        ("zero", {"time__alpha": 0.3, "time__delta": 0.6}),
        ("consistent", {"time__alpha": 0.6, "time__delta": 1.1}),
    ],
)
def test_free_motion_is_that_of_dda_under_every_scheme(start, numbers, gg):
    case = scene(time__start=start, time__gg=gg, time__step=2e-4, time__steps=60, **numbers)
    run = solve(case.with_values({"run.columns": ["displacement", "horizontal_displacement"]}), "dda").history
    slide = run.columns["horizontal_displacement"] + friction.coefficient(case) * run.displacement
    moved, speed = friction.free_motion(case, friction.sliding_acceleration(case))
    assert np.max(abs(slide - moved)) < 1e-9 * moved[-1]
    rates = np.gradient(moved, case.time.step)[1:-1]  # of a parabola, once the start has passed
    late = 0.01 if start == "zero" else 1e-9
    assert speed[1:-1] == pytest.approx(rates, rel=2 * (1 - gg) + late)


@pytest.mark.parametrize(
    "changes", [OTHER | {"contact.cohesion": 4e3}, {"contact.friction": 35.0, "load.gravity": 3.7}]
)
def test_at_the_threshold_the_forces_balance(changes):
    case = scene().with_values(changes)
    limit = friction.threshold_angle(case)
    at = case.with_values({"load.slope": limit})
    forces = friction.along(at), friction.coefficient(at) * friction.across(at), friction.adhesion(at)
    assert forces[0] == pytest.approx(forces[1] + forces[2], rel=1e-12)
    assert at.block.mass * forces[2] == pytest.approx(at.contact.cohesion * at.block.base_length, rel=1e-12)
    assert friction.run_out(case.with_values({"load.slope": limit - 1e-3}), 1.0) == 0
    assert friction.threshold_angle(case.with_values({"contact.cohesion": 1e9})) == 90.0  # it stands on a wall
    steeper = case.with_values({"load.slope": limit + 1.0})
    assert 0 < friction.run_out(steeper, 3.0) == pytest.approx(4.5 * friction.sliding_acceleration(steeper))


def test_springs_that_ring_alike_and_what_a_discount_takes_of_a_way():
    case = scene().with_values(OTHER | {"contact.friction": 40.0})
    stiff = case.with_values({"contact.shear_stiffness": 7.03e8, "load.slope": -20.0})
    stands = [{}, {"load.slope": 23.0}, {"contact.shear_stiffness": 7.2e8}, {"contact.cohesion": 1e3}]
    found = [friction.stands_on_ringing_springs(stiff.with_values(one)) for one in stands]
    assert found == [True, False, False, False]
    for gg in (1.0, 0.9, 0.0):
        x, v = 0.0, 0.0
        for _ in range(7):
            x, v = x + gg * v + 0.5, gg * v + 1
        assert friction.distance_share(gg, 0.1, 0.7) == pytest.approx(x / 24.5, rel=1e-12)
