"""Facts of the studies without a run of their own: computed in another way, and not deaf to a fault."""

import math

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from validation.engine.finished import Finished
from validation.engine.judge import evaluate
from validation.gates.gate import Status
from validation.runs.results import Results
from validation.scenes.scene import load_scene
from validation.studies.methods import closed, facts
from validation.studies.slopes import closed as ways
from validation.studies.waves import oblique
from validation.suite.folders import get_study
from validation.theory.stages import LEAPFROG
from validation.theory.stepping import Stepping

UNIT = np.eye(1)


def judged(study, owner, directory):
    """Return the verdicts of an owner's rows that need no run, by row."""
    derived = {(row.scene, row.name): row for row in get_study(study).derived() if row.scene == owner and not row.needs}
    finished = Finished({}, Results(directory), derived)
    gates = [gate for gate in get_study(study).gates() if (gate.scene, gate.pair[0]) in derived]
    statuses = {name: set() for _, name in derived}
    for gate in gates:
        statuses[gate.pair[0]].add(evaluate(gate, finished).status)
    return statuses


OWNERS = {"methods": facts.FACTS, "slopes": "slope-facts", "waves": "waves-facts"}


@pytest.mark.parametrize("study", OWNERS)
def test_facts_hold(study, tmp_path):
    statuses = judged(study, OWNERS[study], tmp_path)
    assert statuses and set().union(*statuses.values()) == {Status.PASS}
    assert all(statuses.values()), "every row has a gate"


def scaled(factor):
    """Make the values of a function off by a factor."""
    return lambda function: lambda *arguments, **options: factor * function(*arguments, **options)


FAULTS = {
    "forward Euler with the new velocity": (
        facts, "EXPLICIT_EULER", lambda stages: LEAPFROG, "methods", "mean rebound"),
    "a dashpot of the whole mass": (facts, "QUARTER", lambda quarter: 1.0, "methods", "dashpot"),
    "a block twice as high": (
        facts.statics, "size", lambda f: lambda scene: (2.0, 4.0), "methods", "passes"),
    "contact frequency 1 % high": (
        facts.spectra, "contact_frequency", scaled(1.01), "methods", "largest explicit step, ms"),
    "normal ringing 2 % large": (ways, "normal_ringing_error", scaled(1.02), "slopes", "ringing of a rigid block"),
    "friction two steps late": (ways, "lagging_friction_error", scaled(2.0), "slopes", "friction of the step before"),
    "gg twice a step": (ways, "shaken_way", lambda f: lambda step, gg: f(step, gg**2), "slopes", "discount"),
    "a base with half the dashpot": (
        oblique, "base_reflection", lambda f: lambda *a, impedance: f(*a, impedance=impedance / 2),
        "waves", "viscous base"),
    "an oblique wave of another Poisson's ratio": (
        oblique, "returned_energy", lambda f: lambda angle, wave: f(angle, wave, 0.3), "waves", "oblique waves"),
}  # fmt: skip


@pytest.mark.parametrize("fault", FAULTS)
def test_a_fault_is_bitten(fault, tmp_path, monkeypatch):
    module, name, change, study, row = FAULTS[fault]
    monkeypatch.setattr(module, name, change(getattr(module, name)))
    assert Status.FAIL in judged(study, OWNERS[study], tmp_path)[row]


# ---- the closed forms, computed in another way ----------------------------------------------------------------------


@pytest.mark.parametrize(("zeta", "omega"), [(0.05, 0.3), (0.2, 1.1), (0.4, 0.05)])
def test_a_damped_step_without_a_step_is_exact(zeta, omega):
    fine = closed.damped_roots(Stepping(1e-4 * omega, 0.25, 0.5), UNIT, 2 * zeta * UNIT, UNIT)
    assert fine[0] == pytest.approx(zeta, rel=1e-5)
    assert closed.exact_damped_roots(UNIT, 2 * zeta * UNIT, UNIT)[0] == pytest.approx(zeta, rel=1e-12)
    # the trapezoidal rule: ln((2 + s W) / (2 - s W)) of the exact root s
    s = complex(-zeta, math.sqrt(1 - zeta**2))
    log = np.log((2 + s * omega) / (2 - s * omega))
    stepped = closed.damped_roots(Stepping(omega, 0.25, 0.5), UNIT, 2 * zeta * UNIT, UNIT)
    assert stepped[0] == pytest.approx(-log.real / abs(log), rel=1e-10)
    for alpha, delta in ((0.25, 0.5), (0.5, 1.0), (0.4, 0.8)):
        found = closed.damped_roots(Stepping(omega, alpha, delta), UNIT, 2 * zeta * UNIT, UNIT)[0]
        end = [[1, 0, -alpha], [0, 1, -delta], [omega**2, 2 * zeta * omega, 1]]
        start = [[1, 1, 0.5 - alpha], [0, 1, 1 - delta], [0, 0, 0]]
        root = np.log(max(np.linalg.eigvals(np.linalg.solve(end, start)), key=np.imag))
        assert found == pytest.approx(-root.real / abs(root), rel=1e-9)


def test_the_locked_block_is_that_of_an_integrator():
    scene = load_scene("figures-3-4").with_values(
        {"time.step": 0.01, "contact.stiffness": 3e9, "block.width": 2.0, "block.height": 1.3}
    )
    mass, stiffness, _ = closed.two_unknowns(scene)
    pressure = scene.load.pressure * scene.block.base_length
    load = pressure * np.array([-1.0, -1.3 / 2])
    time = np.linspace(0.001, 0.05, 40)

    def rates(_, y):
        return np.concatenate([y[2:], np.linalg.solve(mass, load - stiffness @ y[:2])])

    exact = solve_ivp(rates, (0, 0.05), np.zeros(4), t_eval=time, rtol=1e-11, atol=1e-13, method="DOP853").y[0]
    assert closed.exact_locked(scene, time) == pytest.approx(exact, rel=1e-6)


def test_energy_of_oblique_waves():
    for wave in ("P", "S"):
        for poisson in (0.1, 0.25, 0.4):
            assert oblique.returned_energy(0.0, wave, poisson) == pytest.approx(0, abs=1e-24)
            energies = [oblique.returned_energy(angle, wave, poisson) for angle in np.linspace(0, 89, 90)]
            assert all(0 <= energy <= 1 for energy in energies)
            assert oblique.returned_energy(89.9, wave, poisson) > 0.95
    # beyond the critical angle no P wave carries energy away: |S back|^2 alone
    assert 0 < oblique.returned_energy(50.0, "S", 0.25) < 1


def test_a_shaken_block_with_a_rate_of_drag_is_that_of_an_integrator():
    b = math.radians(20)
    rate = 2.0

    def slide(t, y):
        a = 9.81 * (math.sin(b) + 0.28 * math.sin(2 * math.pi * 2.66 * t) - math.tan(math.radians(30)) * math.cos(b))
        a -= rate * y[1]
        return [y[1], a if y[1] > 0 or a > 0 else 0.0]

    state = np.zeros(2)
    step = 1e-4
    for n in range(10_000):  # explicit midpoint, velocity not below 0
        t = n * step
        middle = state + step / 2 * np.array(slide(t, state))
        state = state + step * np.array(slide(t + step / 2, middle))
        state[1] = max(state[1], 0.0)
    assert ways.shaken_way(1e-4, math.exp(-rate * 1e-4), duration=1.0) == pytest.approx(state[0], rel=5e-3)
