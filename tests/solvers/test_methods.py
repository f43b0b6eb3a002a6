"""Time schemes and contact methods of scenes through the adapters: their numbers reach the packages, in full."""

import itertools
import math

import pytest
from conftest import thinned

from validation import solve
from validation.errors import InputError
from validation.metrics.modes import operator_damping
from validation.scenes.scene import load_scene
from validation.solvers.registry import get_solver
from validation.theory.stepping import Stepping

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


@pytest.mark.parametrize(
    ("scheme", "solver", "gg"), thinned(itertools.product(SCHEMES, ("dda", "fem", "bar"), (1.0, 0.99)), 7)
)
def test_modes_have_the_roots_of_the_scene_s_scheme(scheme, solver, gg):
    scene = LOCKED.with_values(SCHEMES[scheme] | {"time.gg": gg})
    if solver == "bar" and scheme == "leapfrog":
        with pytest.raises(InputError, match="explicit"):
            solve(scene, solver)
        return
    for mode in get_solver(solver).modes(scene)[:2]:
        omega = mode.frequency * scene.time.step
        expected = Stepping.of(scene).damping_ratio(omega)
        assert operator_damping(mode.eigenvalues) == pytest.approx(expected, rel=1e-8, abs=1e-13)
        assert max(map(abs, mode.eigenvalues)) == pytest.approx(abs(Stepping.of(scene).roots(omega)[0]), rel=1e-10)


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
