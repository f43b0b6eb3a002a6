"""What `damping` and `advise` say, in tables, sentences and plain data, with every number computed apart."""

from __future__ import annotations

import json
import math
import re
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from conftest import typed

from validation import load_scene, solve
from validation.advice import advice
from validation.advice.spectra import Damping, ModeDamping, parts, runs, sentence
from validation.cli import damping as cli_damping

OPTIONS = ("--set", "time.gg=0.98")
CASE = load_scene("figures-3-4").with_values(
    {"time.step": 0.002, "time.steps": 50, "time.gg": 0.98, "fem.elements": 4, "fem.degree": 1}
)


def frequencies() -> np.ndarray:
    """Both axial frequencies of the 2 m block at p = E = 1e9, from (v, ey)."""
    stiffness = np.array([[2e9, -2e9], [-2e9, 4e9 + 2e9]])
    return np.sqrt(np.sort(np.linalg.eigvals(np.linalg.solve(np.diag([10800.0, 3600.0]), stiffness)).real))


def of_scheme(omega: float, gg: float) -> tuple[float, float, float]:
    """Return xi, |lambda| and w/w' - 1 under constant acceleration, from trace and determinant of a step."""
    beta = 1 + omega**2 / 2
    trace = 1 - omega**2 / (2 * beta) + gg * (1 - omega**2 / beta)
    roots = np.roots([1.0, -trace, gg * (1 - omega**2 / (2 * beta))])
    log = np.log(complex(roots[0]))
    return float(-log.real / abs(log)), float(np.abs(roots).max()), float(omega / abs(log) - 1)


# ---- damping ------------------------------------------------------------------------------------------------------


def test_damping_prints_each_mode_in_per_cent_and_radians_a_second(scene_file: Path) -> None:
    lines = typed("damping", scene_file, *OPTIONS).stdout.splitlines()
    w = frequencies()[0]
    xi, radius, elongation = of_scheme(0.002 * w, 0.98)
    own = of_scheme(0.002 * w, 1.0)[0]
    rate = -math.log(0.98) / 0.002
    assert lines[0] == (
        f"At dt = 0.002 s the first axial mode ({w:.4g} rad/s) is damped at {100 * xi:.3g} % of critical, "
        f"{100 * own:.3g} % algorithmic and {100 * (xi - own):.3g} % kinetic; {lines[0].partition('; ')[2]}"
    )
    assert lines[2] == f"gg = 0.98 per step, c = {rate:.4g} 1/s"
    heads = re.split(r"\s{2,}", lines[3])
    assert heads == ["mode", "w [rad/s]", "w dt", "xi [%]", "algorithmic", "kinetic", "|lambda|", "w/w' - 1"]
    shown = dict(zip(heads, re.split(r"\s{2,}", lines[4]), strict=True))
    numbers = [float(shown[name]) for name in heads[1:]]
    assert shown["mode"] == "first axial"
    wanted = [w, 0.002 * w, 100 * xi, 100 * own, 100 * (xi - own), radius, elongation]
    assert numbers == pytest.approx(wanted, rel=2e-3)  # three digits are printed
    assert float(re.split(r"\s{2,}", lines[5])[1]) == pytest.approx(frequencies()[1], rel=1e-5)


def test_damping_prints_the_first_modes_of_the_references(scene_file: Path) -> None:
    """Of the bar b tan b = 2, b = 1.0769, w = (b/2) sqrt(E/rho)."""
    lines = typed("damping", scene_file, *OPTIONS).stdout.splitlines()
    (bar,) = [re.split(r"\s{2,}", line) for line in lines if line.startswith("bar, first")]
    w = 1.0768740 / 2 * math.sqrt(1e9 / 2700)
    assert [float(bar[1]), float(bar[2])] == pytest.approx([w, 100 * of_scheme(0.002 * w, 0.98)[0]], rel=1e-3)


def test_damping_as_plain_data_is_in_fractions_and_seconds(scene_file: Path) -> None:
    found = json.loads(typed("damping", scene_file, *OPTIONS, "--json").stdout)
    w = frequencies()[0]
    xi, radius, elongation = of_scheme(0.002 * w, 0.98)
    own = of_scheme(0.002 * w, 1.0)[0]
    assert (found["scene"], found["step"], found["gg"]) == ("small", 0.002, 0.98)
    assert found["gg_rate"] == pytest.approx(-math.log(0.98) / 0.002)
    first = {name: value for name, value in found["modes"][0].items() if name not in ("name", "least_root")}
    assert first == pytest.approx({
        "frequency": w, "damping": xi, "spectral_radius": radius, "omega_dt": 0.002 * w, "algorithmic": own,
        "kinetic": xi - own, "period_elongation": elongation, "viscous": 0.0,
    })  # fmt: skip
    assert set(found["references"]) == {"fem", "bar"}


def mode(**changes: Any) -> ModeDamping:
    values = {"name": "first axial", "frequency": 300.0, "damping": 0.05, "spectral_radius": 0.875, "omega_dt": 0.6,
              "algorithmic": 0.04, "kinetic": 0.01, "period_elongation": 0.1, "least_root": 0.1}  # fmt: skip
    return ModeDamping(**(values | changes))


@pytest.mark.parametrize(
    ("changes", "words"),
    [
        ({}, "is damped at 5 % of critical, 4 % algorithmic and 1 % kinetic"),
        ({"kinetic": 0.0}, "is damped at 5 % of critical, all of it algorithmic"),
        ({"algorithmic": 0.0}, "is damped at 5 % of critical, all of it kinetic"),
        ({"damping": 1.5}, "is overdamped at 150 % of critical, 4 % algorithmic and 1 % kinetic"),
        ({"least_root": -0.95, "omega_dt": 7.25}, "flips sign every step and keeps 87.5 % of its amplitude per step "
         "(w dt = 7.25)"),
        ({"damping": None}, "has no damping ratio (a root is not positive) and keeps 87.5 % of its amplitude per step"),
        ({"spectral_radius": 1.25}, "grows by a factor of 1.25 per step"),
        ({"damping": 0.0, "spectral_radius": 1.0}, "is not damped"),
    ],
)  # fmt: skip
def test_a_mode_is_told_in_words_with_its_numbers(changes: dict[str, Any], words: str) -> None:
    assert runs(mode(**changes)) == words
    assert parts(mode(algorithmic=None)) == "kinetic and algorithmic"
    contact = mode(name="contact", least_root=-0.95, omega_dt=7.25)
    assert sentence(CASE, [mode(**changes), mode(name="mode 2"), contact]) == (
        f"At dt = 0.002 s the first axial mode (300 rad/s) {words}; the contact mode {runs(contact)}."
    )


def test_what_is_not_known_of_a_mode_is_a_dash() -> None:
    found = Damping("s", 0.002, 0.0, None, (mode(damping=None, period_elongation=None),), {}, "It is so.")
    lines = "\n".join(cli_damping._damping_lines(found)).splitlines()
    assert lines[2] == "gg = 0 per step"
    assert re.split(r"\s{2,}", lines[4])[3:] == ["-", "4", "1", "0.875", "-"]


# ---- advise -------------------------------------------------------------------------------------------------------


def test_advise_prints_ratio_settling_and_errors_of_what_it_advises(scene_file: Path) -> None:
    done = typed("advise", scene_file, "--damping", "0.05").stdout
    facts = dict(re.findall(r"^  (\S.*?)  +(.*)$", done, re.MULTILINE))
    (step,) = (float(text) for text in re.findall(r"time.step = (\S+)", done))
    assert of_scheme(step * frequencies()[0], 1.0)[0] == pytest.approx(0.05, rel=1e-6)
    assert float(facts["damping ratio"].removesuffix(" %")) == pytest.approx(5.0, rel=1e-6)
    settled = re.fullmatch(r"(\d+) steps = (\S+) s \(from the history\)", facts["displacement settles"])
    assert settled and float(settled[2]) == pytest.approx(int(settled[1]) * step, rel=1e-3)
    assert done.count("damping ratio") == 1
    steps = round(0.1 / step)  # the scene's 50 steps of 2 ms
    case = load_scene(scene_file).with_values({"time.step": step, "time.steps": steps})
    for name in ("fem", "continuum"):
        told = re.fullmatch(r"displacement (\S+) %, pressure (\S+) % over (\S+) s \(relative L2\)",
                            facts[f"differs from {name} by"])  # fmt: skip
        assert told
        a, b = solve(case, "dda"), solve(case, name)
        want = [100 * np.linalg.norm(x - y) / np.linalg.norm(y) for x, y in
                ((a.displacement, b.displacement), (a.contact_pressure, b.contact_pressure))]  # fmt: skip
        assert [float(told[i]) for i in (1, 2, 3)] == pytest.approx([*want, steps * step], rel=1e-2)


def test_each_of_two_answers_has_its_own_errors(scene_file: Path) -> None:
    """Both sides of the maximum of 37 %: the larger step is further from the continuum."""
    found = json.loads(typed("advise", scene_file, "--damping", "0.35", "--json").stdout)
    case, errors = load_scene(scene_file), [solution["errors"] for solution in found["solutions"]]
    for told, error in zip(found["solutions"], errors, strict=True):
        steps = round(0.1 / told["value"])
        run = case.with_values({"time.step": told["value"], "time.steps": steps})
        a, b = solve(run, "dda").displacement, solve(run, "continuum").displacement
        want = np.linalg.norm(a - b) / np.linalg.norm(b)
        assert error["continuum"]["displacement"] == pytest.approx(want, rel=1e-9)
        assert error["window"] == pytest.approx(steps * told["value"])
    text = typed("advise", scene_file, "--damping", "0.35").stdout
    shown = [float(value) for value in re.findall(r"continuum by  displacement (\S+) %", text)]
    assert shown == pytest.approx([100 * error["continuum"]["displacement"] for error in errors], rel=1e-2)
    assert shown[0] != shown[1]


def solution(**changes: Any) -> advice.Solution:
    values = {"value": 0.003, "damping": 0.05, "settling_steps": 40, "settling_seconds": 0.12,
              "settling_from": "envelope", "alpha": 0.6, "delta": 1.1, "step": 0.003, "gg": 0.97, "gg_rate": 10.15,
              "settings": {"time.step": 0.003}, "contact": None}  # fmt: skip
    return advice.Solution(**(values | changes))


def test_facts_of_a_solution_are_told_with_their_units() -> None:
    flipping = mode(name="contact", least_root=-0.95, omega_dt=7.25)
    error = {"window": 0.4, "fem": {"displacement": 0.0123, "pressure": 0.045}, "continuum": {"not applicable": "so"}}
    assert dict(cli_damping._facts(solution(contact=flipping), error)) == {
        "damping ratio": "5 %",
        "discount": "gg = 0.97 per step, c = 10.15 1/s",
        "displacement settles": "40 steps = 0.12 s (from the envelope)",
        "contact mode": runs(flipping),
        "differs from fem by": "displacement 1.23 %, pressure 4.5 % over 0.4 s (relative L2)",
        "differs from continuum by": "so",
    }
    never = dict(cli_damping._facts(solution(settling_steps=None, settling_seconds=None), {}))
    assert never["displacement settles"] == "never (from the envelope)"


def test_a_rate_that_is_kept_is_named() -> None:
    rate = load_scene("figures-3-4").with_values({"time.step": 0.002, "time.gg_rate": 12.5})
    text = advice._sentence(rate, "dt", 0.05, [solution()], (None, None, None, None))
    assert text.endswith("; the discount is kept as a rate, c = 12.5 1/s.")


@pytest.mark.parametrize(
    ("solve_for", "words"),
    [
        ("dt", "Set dt = 0.003 s: the first axial mode of the DDA block is then damped at 5 % of critical and the "
         "displacement settles within 40 steps (0.12 s); gg = 0.98 acts per step, so that refining dt at this gg does "
         "not converge."),
        ("gg", "Set gg = 0.003 per step (c = 10.15 1/s): the first axial mode of the DDA block is then damped at 5 % "
         "of critical and the displacement settles within 40 steps (0.12 s); this gg is valid at dt = 0.003 s only, at "
         "another dt keep the rate c; in flight or sliding it leaves 0.302 % of the distance covered from rest in a "
         "second."),
        ("scheme", "Set delta = 0.003, alpha = 0.6: the first axial mode of the DDA block is then damped at 5 % of "
         "critical and the displacement settles within 40 steps (0.12 s)."),
    ],
)  # fmt: skip
def test_the_advice_in_one_sentence(solve_for: str, words: str) -> None:
    assert advice._sentence(CASE, solve_for, 0.05, [solution()], (None, None, None, None)) == words


def test_the_advice_names_the_solution_whose_contact_flips() -> None:
    flipping = mode(name="contact", least_root=-0.95, omega_dt=7.25)
    found = [solution(), solution(value=0.009, contact=flipping, settling_steps=9, settling_seconds=0.081)]
    text = advice._sentence(CASE, "dt", 0.05, found, (None, None, None, None))
    assert text.startswith("Set dt = 0.003 s or dt = 0.009 s: ") and "in each case" in text
    assert "within 40 steps (0.12 s) or 9 steps (0.081 s), but the contact mode flips sign" in text
    assert "per step (w dt = 7.25) at dt = 0.009 s; gg" in text


@pytest.mark.parametrize(
    ("target", "words"),
    [
        (0.5, "at 50 % of critical: the largest attainable value is 30 %, at dt = 0.02 s."),
        (0.01, "at 1 % of critical: the smallest attainable value is 2 %, at dt = 0.001 s."),
        (0.1, "at 10 % of critical: it lies in a gap between attainable values."),
    ],
)
def test_what_is_out_of_reach_is_told_with_where_the_end_is(target: float, words: str) -> None:
    assert advice._sentence(CASE, "dt", target, [], (0.02, 0.001, 0.3, 0.02)).endswith(words)
