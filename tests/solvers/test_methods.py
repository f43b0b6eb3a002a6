"""Time schemes and contact methods of scenes through the adapters: their numbers reach the packages, in full."""

import math

import pytest

from validation import solve
from validation.errors import InputError
from validation.scenes.scene import load_scene
from validation.solvers.registry import get_solver

LOCKED = load_scene("figures-3-4").with_values({"time.step": 5e-4, "time.steps": 40, "fem.elements": 2})
OPENING = load_scene("unlocked-average").expand()[0].with_values({"time.step": 2e-4, "time.steps": 200})
SCHEMES = {
    "chung-hulbert": {"time.scheme": "chung-hulbert", "time.rho_inf": 0.6},
    "hht": {"time.scheme": "hht", "time.rho_inf": 0.7},
    "wbz": {"time.scheme": "wbz", "time.rho_inf": 0.3},
    "leapfrog": {"time.scheme": "leapfrog", "time.start": "consistent"},
    "composite": {"time.scheme": "composite", "time.rho_inf": 0.2, "time.split": 0.55},
}


def record_of(scene, solver="dda"):
    prepared = get_solver(solver).prepare(scene)
    prepared.keeps_contact_record = True
    assert prepared.run().outcome == "completed"
    return prepared.contact_record()


def test_the_limit_of_the_leapfrog_is_that_of_its_highest_mode():
    frequency = max(mode.frequency for mode in get_solver("dda").modes(LOCKED))
    limit = math.sqrt(2 * 1.99) / frequency
    leapfrog = LOCKED.with_values(SCHEMES["leapfrog"] | {"time.gg": 0.99, "time.steps": 3})
    solve(leapfrog.with_values({"time.step": limit * (1 - 1e-9)}), "dda")
    with pytest.raises(InputError):
        solve(leapfrog.with_values({"time.step": limit * (1 + 1e-9)}), "dda")


def test_solves_of_a_composite_scheme_are_two_a_step():
    calm = OPENING.with_values({"contact.restitution": 0.3})
    mean = {name: float(record_of(calm.with_values(SCHEMES[name])).solves.mean()) for name in ("hht", "composite")}
    assert 1.0 <= mean["hht"] < 1.1 and 2.0 <= mean["composite"] < 2.1
