"""Facts of the studies without a run of their own: computed in another way, and not deaf to a fault."""

import functools

import numpy as np
import pytest

from validation.engine.finished import Finished
from validation.engine.judge import evaluate
from validation.gates.gate import Status
from validation.runs.results import Results
from validation.studies.methods import closed, facts
from validation.studies.slopes import closed as ways
from validation.studies.waves import oblique
from validation.suite.folders import get_study
from validation.theory.stages import LEAPFROG
from validation.theory.stepping import Stepping

UNIT = np.eye(1)


@functools.cache
def gates_of(study):
    return get_study(study).gates()


def judged(study, directory, only=None):
    """Return the verdicts of a study's rows that need no run, or of one of them, by row."""
    rows = [row for row in get_study(study).derived() if row.scene == OWNERS[study] and not row.needs]
    derived = {(row.scene, row.name): row for row in rows if only in (None, row.name)}
    finished = Finished({}, Results(directory), derived)
    statuses = {name: set() for _, name in derived}
    for gate in gates_of(study):
        if (gate.scene, gate.pair[0]) not in derived:
            continue
        statuses[gate.pair[0]].add(evaluate(gate, finished).status)
    return statuses


OWNERS = {"methods": facts.FACTS, "slopes": "slope-facts", "waves": "waves-facts"}


@pytest.mark.long
@pytest.mark.parametrize("study", OWNERS)
def test_facts_hold(study, tmp_path):
    statuses = judged(study, tmp_path)
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


@pytest.mark.long
@pytest.mark.parametrize("fault", FAULTS)
def test_a_fault_is_bitten(fault, tmp_path, monkeypatch):
    module, name, change, study, row = FAULTS[fault]
    monkeypatch.setattr(module, name, change(getattr(module, name)))
    assert Status.FAIL in judged(study, tmp_path, row)[row]


# ---- the closed forms, computed in another way ----------------------------------------------------------------------


@pytest.mark.parametrize(("zeta", "omega"), [(0.05, 0.3), (0.2, 1.1), (0.4, 0.05)])
def test_a_damped_step_has_the_roots_of_its_equations(zeta, omega):
    assert closed.exact_damped_roots(UNIT, 2 * zeta * UNIT, UNIT)[0] == pytest.approx(zeta, rel=1e-12)
    for alpha, delta in ((0.25, 0.5), (0.5, 1.0), (0.4, 0.8)):
        found = closed.damped_roots(Stepping(omega, alpha, delta), UNIT, 2 * zeta * UNIT, UNIT)[0]
        end = [[1, 0, -alpha], [0, 1, -delta], [omega**2, 2 * zeta * omega, 1]]
        start = [[1, 1, 0.5 - alpha], [0, 1, 1 - delta], [0, 0, 0]]
        root = np.log(max(np.linalg.eigvals(np.linalg.solve(end, start)), key=np.imag))
        assert found == pytest.approx(-root.real / abs(root), rel=1e-9)


def test_energy_of_oblique_waves():
    for wave in ("P", "S"):
        for poisson in (0.1, 0.25, 0.4):
            assert oblique.returned_energy(0.0, wave, poisson) == pytest.approx(0, abs=1e-24)
            energies = [oblique.returned_energy(angle, wave, poisson) for angle in np.linspace(0, 89, 90)]
            assert all(0 <= energy <= 1 for energy in energies)
            assert oblique.returned_energy(89.9, wave, poisson) > 0.95
    # beyond the critical angle no P wave carries energy away: |S back|^2 alone
    assert 0 < oblique.returned_energy(50.0, "S", 0.25) < 1
