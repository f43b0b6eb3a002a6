"""The register of claims of the literature: computed, gated, and not deaf."""

from __future__ import annotations

import json
import math
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from conftest import refused, typed
from scipy.integrate import solve_ivp

from validation.engine.finished import Finished
from validation.engine.judge import evaluate
from validation.engine.run import _derived_record, finish
from validation.gates.gate import Status
from validation.report.references import references
from validation.runs.results import Results
from validation.scenes.scene import load_scene
from validation.studies.claims import REGISTER, Finding, entries
from validation.studies.literature import closed, register
from validation.studies.literature.study import CLAIMS, CLAIMS_OF_THE_LITERATURE, STUDY
from validation.theory import stepping
from validation.theory.stages import LEAPFROG, Stages
from validation.theory.stepping import Stepping

ROOT = Path(__file__).parents[2]
pytestmark = pytest.mark.xdist_group("literature")


@pytest.fixture(scope="module")
def sound(finished_cases: Path) -> Finished:
    return finish(STUDY.cases(), STUDY, Results(finished_cases))


def test_every_claim_says_where_it_stands_and_how_much_was_read() -> None:
    for claim in CLAIMS:
        assert set(claim.sources) <= set(references()) and claim.sources
        assert ("abstract" in claim.read) == (claim.id not in ("L8", "L9")), claim.id
        assert claim.tested
        assert claim.condition or claim.expected is Finding.REFUTED


# ---- faults ---------------------------------------------------------------------------------------------------------

UNIT = np.eye(1)


def exchanged(scheme: Callable[[float], Stages]) -> Callable[[float], Stages]:
    """Return a scheme whose weights of the old forces and the old acceleration are taken for each other."""

    def faulty(rho_inf: float) -> Stages:
        (stage,) = scheme(rho_inf)
        return (stage._replace(am=stage.af, af=stage.am),)

    return faulty


def scaled(function: Callable[..., Any], factor: float) -> Callable[..., Any]:
    """Return a function whose values are off by a factor."""
    return lambda *arguments, **options: factor * function(*arguments, **options)


FAULTS: dict[str, tuple[Any, str, Callable[[Any], Any], str]] = {
    "normal ringing 2 % large": (closed, "normal_ringing_error", lambda f: scaled(f, 1.02), "L1"),
    "forward Euler with the new velocity": (register, "EXPLICIT_EULER", lambda stages: LEAPFROG, "L2"),
    "composite split at 0.6": (closed, "composite_on_sine", lambda f: lambda split: f(0.8), "L3"),
    "a dashpot of the whole mass": (register.soft_contact, "QUARTER", lambda quarter: 1.0, "L4"),
    "a landing above the contact": (
        register,
        "rebound_statistics",
        lambda f: lambda advance, count: f(advance, 0.9, count),
        "L6",
    ),
    "half of the error's norm": (register, "error", lambda f: scaled(f, 0.5), "L7"),
    "am and af of a scheme exchanged": (
        stepping,
        "GENERALISED_ALPHA",
        lambda schemes: schemes | {"chung-hulbert": exchanged(schemes["chung-hulbert"])},
        "L8",
    ),
    "gg twice a step": (closed, "shaken_way", lambda f: lambda step, gg: f(step, gg**2), "L9"),
    "a base with half the dashpot": (
        register,
        "base_reflection",
        lambda f: lambda *a, impedance: f(*a, impedance=impedance / 2),
        "L10",
    ),
    "an oblique wave of another Poisson's ratio": (
        closed,
        "returned_energy",
        lambda f: lambda angle, wave: f(angle, wave, 0.3),
        "L10",
    ),
}


@pytest.mark.parametrize("fault", FAULTS)
def test_a_fault_is_bitten(fault: str, sound: Finished, monkeypatch: pytest.MonkeyPatch) -> None:
    module, name, change, claim = FAULTS[fault]
    monkeypatch.setattr(module, name, change(getattr(module, name)))
    faulty = Finished(sound.rows, sound.results, sound.derived)
    gates = [gate for gate in STUDY.gates() if gate.id.startswith(f"{REGISTER}:{claim}:")]
    assert any(evaluate(gate, faulty).status is Status.FAIL for gate in gates)


# ---- the closed forms, computed in another way ----------------------------------------------------------------------


@pytest.mark.parametrize(("zeta", "omega"), [(0.05, 0.3), (0.2, 1.1), (0.4, 0.05)])
def test_a_damped_step_without_a_step_is_exact(zeta: float, omega: float) -> None:
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


def test_the_locked_block_is_that_of_an_integrator() -> None:
    scene = load_scene("figures-3-4").with_values(
        {"time.step": 0.01, "contact.stiffness": 3e9, "block.width": 2.0, "block.height": 1.3}
    )
    mass, stiffness, _ = closed.two_unknowns(scene)
    pressure = scene.load.pressure * scene.block.base_length
    load = pressure * np.array([-1.0, -1.3 / 2])
    time = np.linspace(0.001, 0.05, 40)

    def rates(_: float, y: np.ndarray) -> np.ndarray:
        return np.concatenate([y[2:], np.linalg.solve(mass, load - stiffness @ y[:2])])

    exact = solve_ivp(rates, (0, 0.05), np.zeros(4), t_eval=time, rtol=1e-11, atol=1e-13, method="DOP853").y[0]
    assert closed.exact_locked(scene, time) == pytest.approx(exact, rel=1e-6)


def test_energy_of_oblique_waves() -> None:
    for wave in ("P", "S"):
        for poisson in (0.1, 0.25, 0.4):
            assert closed.returned_energy(0.0, wave, poisson) == pytest.approx(0, abs=1e-24)
            energies = [closed.returned_energy(angle, wave, poisson) for angle in np.linspace(0, 89, 90)]
            assert all(0 <= energy <= 1 for energy in energies)
            assert closed.returned_energy(89.9, wave, poisson) > 0.95
    # beyond the critical angle no P wave carries energy away: |S back|^2 alone
    assert 0 < closed.returned_energy(50.0, "S", 0.25) < 1


def test_a_shaken_block_with_a_rate_of_drag_is_that_of_an_integrator() -> None:
    b = math.radians(20)
    rate = 2.0

    def slide(t: float, y: np.ndarray) -> list[float]:
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
    assert closed.shaken_way(1e-4, math.exp(-rate * 1e-4), duration=1.0) == pytest.approx(state[0], rel=5e-3)


# ---- page and command -----------------------------------------------------------------------------------------------


@pytest.mark.long
def test_the_command_lists_and_gives_data(sound: Finished, tmp_path: Path) -> None:
    rows = [_derived_record(sound, REGISTER, claim.id) for claim in CLAIMS]
    Results(tmp_path).write_json("studies/literature.json", {"study": "literature", "derived": rows})
    words = ("claims", "--of", "literature", "--results", tmp_path)
    lines = typed(*words).stdout.splitlines()
    assert [line.split()[0] for line in lines] == [claim.id for claim in CLAIMS]
    listed = json.loads(typed(*words, "--json").stdout)
    assert listed == json.loads(json.dumps(entries(CLAIMS_OF_THE_LITERATURE, rows)))
    assert {entry["verdict"] for entry in listed} <= {finding.words for finding in Finding}
    assert "--of" in refused("claims", "--of", "rumour", "--results", tmp_path)
    assert "run literature" in refused("claims", "--of", "literature", "--results", tmp_path / "none")
