"""What commands print and how they end, from answers, rows and runs made by hand: each word with its own number."""

import json
import os
import sys
import tomllib
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest
import typer
from conftest import typed

from validation import load_scene, response
from validation.advice import across
from validation.cli import app, run, verify
from validation.cli import judge as cli_judge
from validation.cli import waves as cli_waves
from validation.gates.gate import Status
from validation.problems.answers import Answer, AnswerSet, stated_by
from validation.report.figures import response as figures
from validation.runs.run import Outcome, Run
from validation.suite import judging

SCENE = load_scene("figures-3-4").with_values({"time.step": 0.002})
CASE = ("figures-3-4", "--set", "time.step=0.002")


def printed(*words, **options):
    done = typed(*words, **options)
    assert done.returncode == 0, done.stderr
    return done.stdout


# ---- statuses -----------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("outcome", [Outcome.TIMEOUT, Outcome.RAISED, Outcome.OVERFLOW, Outcome.COMPLETED])
def test_a_solver_that_gives_no_answer_is_a_numerical_failure(outcome, capsys):
    status, reason = judging._ending(Run(outcome, notes=("whatever",)))
    answers = AnswerSet(Path("mine"), stated_by("mine"), (Answer("locked", None, None, status, reason),))
    with pytest.raises(typer.Exit) as ended:
        cli_judge._refuse_inapplicable(answers)
    assert ended.value.exit_code == 3
    said = capsys.readouterr().out
    assert said.startswith(f"locked mine: {status}: ") and "whatever" in said
    assert status is (Status.FAIL if outcome is Outcome.OVERFLOW else Status.NOT_RUN)


# ---- figures of frequencies ---------------------------------------------------------------------------------------


def test_what_is_stepped_is_drawn_up_to_half_the_sampling_and_the_exact_answer_to_the_end(monkeypatch, tmp_path):
    caught = []
    monkeypatch.setattr(figures, "response_figure", lambda curves, *rest: caught.extend(curves))
    monkeypatch.setattr(figures, "save_as", lambda figure, path: path)
    frequency = np.array([100.0, 249.0, 251.0, 900.0])
    answers = {"dda": response(SCENE, frequency, "dda"), cli_waves.EXACT: response(SCENE, frequency, "dda", True)}
    cli_waves._draw(SCENE, answers, False, tmp_path / "r.svg")
    seen = {curve.name: np.isfinite(curve.columns["displacement"][0]).tolist() for curve in caught}
    stepped, *others = caught
    assert stepped.name.startswith("dda ") and seen.pop(stepped.name) == [True, True, False, False]
    assert [*seen.values()] == [[True] * 4] * len(others)
    assert [curve.dashed for curve in caught] == [False, True, False]


@pytest.mark.parametrize("exact", [False, True])
def test_the_table_of_a_response_is_that_of_the_function(exact, tmp_path):
    path = tmp_path / "r.csv"
    words = ("--solver", "bar", "--from", "2", "--to", "180", "--points", "7")
    printed("advise", "response", *CASE, *words, "--csv", path, *["--exact"] * exact)
    header, *_ = path.read_text().splitlines()
    assert header == "frequency,displacement,displacement_phase,contact_pressure,contact_pressure_phase"
    table = np.loadtxt(path, delimiter=",", skiprows=1)
    assert np.array_equal(table, response(SCENE, np.linspace(2, 180, 7), "bar", exact).table())


# ---- answers made by hand -------------------------------------------------------------------------------------------


def test_schemes_stand_with_their_numbers_and_fears_and_those_that_do_not_reach(monkeypatch):
    asked = []
    first = across.Offer("one", {}, 0.0031259, 1.0, 0.05, 0.0, {1.0: 0.0123, 25.0: None}, 0.34567, None, 1.0, 2.468,
                         {"most": 0.4321}, 1.0987, False, None, ("it rings", "it gains"))  # fmt: skip
    other = across.Offer("two", {}, 0.05, 1.0, 0.05, 0.0, {1.0: 0.5, 25.0: 0.25}, 0.1, 0.2, 1.0, None,
                         {"most": 2.0}, 3.0, True, None, ())  # fmt: skip
    advice = across.SchemeAdvice("s", 0.05, 5.0, True, (first, other), {"three": 0.0456}, "Take one.")

    def advised(scene, *given):
        asked.append((scene.name, *given))
        return advice if len(asked) == 1 else across.SchemeAdvice("s", 0.05, 5.0, True, (), {}, "None.")

    monkeypatch.setattr(across, "advise_across", advised)
    words = ("advise", "schemes", *CASE, "--damping", "0.05")
    lines = [" ".join(line.split()) for line in printed(*words, "--at", "5", "--no-gain").splitlines()]
    assert [line for line in lines if line] == [
        "Take one.",
        "dt [s] xi at 1 Hz xi at 25 Hz first mode contact solves rebound at any step",
        "one 0.0031259 1.23 % real roots 34.57 % real roots 2.47 0.432 1.1",
        "two 0.05 50 % 25 % 10 % 20 % - 2 3",
        "solves: a second, over those of the scene; rebound: the greatest, 1 returns the speed",
        "one: it rings; it gains",
        "three: has 4.56 % there at most, at any step",
    ]
    assert printed(*words).startswith("None.\n")
    assert asked == [("figures-3-4", 0.05, 5.0, True), ("figures-3-4", 0.05, None, None)]


def test_the_data_of_a_scene_are_its_numbers_over_all_cases():
    found = json.loads(printed("show", "figures-3-4", "--set", "block.density=27.0", "--json"))
    assert (found["cases"], found["scene"]["block"]["density"], len(found["warnings"])) == (3, 27.0, 1)
    numbers = found["numbers"]
    speed = (1e9 / 27.0) ** 0.5
    assert numbers["c"] == {"low": pytest.approx(speed), "high": pytest.approx(speed), "unit": "m/s"}
    assert (numbers["n dt"]["low"], numbers["n dt"]["high"]) == pytest.approx((0.2, 2.0))
    assert numbers["c dt/h"]["high"] == pytest.approx(speed * 0.01 / 2)
    assert sorted(found["remarks"].values()) == [1, 3, 3]


def test_a_shell_completes_names_and_one_worker_a_processor_is_taken(monkeypatch):
    assert app.known_scenes("columns-we") == ["columns-weight"]
    assert app.known_targets("figures-3") == ["figures-3-4"] and {"all", "alarms"} >= {*app.known_targets("al")}
    shown = [SimpleNamespace(name=name, study="s") for name in ("ledge", "lever", "arch")]
    monkeypatch.setattr("validation.suite.matrix.phenomena", lambda: shown)
    monkeypatch.setattr("validation.report.verification.truth_counts", lambda one: f"{len(one.name)} exact")
    assert verify.known_phenomena("le") == ["ledge", "lever"]
    lines = [line.split() for line in printed("verify").splitlines()]
    assert lines[1:] == [["ledge", "s", "5", "exact"], ["lever", "s", "5", "exact"], ["arch", "s", "4", "exact"]]
    for count, jobs in ((5, 5), (None, 1)):
        monkeypatch.setattr(os, "cpu_count", lambda count=count: count)
        assert run.default_jobs() == jobs


def test_on_a_terminal_what_a_new_scene_needs_is_asked(tmp_path, monkeypatch):
    asked = []

    def answer(question, default, **options):
        asked.append(default)
        return {"block": "slope", "granite": "basalt"}.get(default, default)

    monkeypatch.setattr(sys, "stdin", SimpleNamespace(isatty=lambda: True))
    monkeypatch.setattr(typer, "prompt", answer)
    printed("new", "asked.toml", "--width", "3", cwd=tmp_path)
    scene = tomllib.loads((tmp_path / "asked.toml").read_text())
    assert asked[:2] == ["block", "granite"] and 3.0 not in asked
    assert scene["block"]["width"] == 3.0 and scene["load"]["slope"] in asked
    asked.clear()
    printed("new", "told.toml", "--kind", "slope", "--rock", "basalt", "--width", "3", cwd=tmp_path)
    assert "block" not in asked and "granite" not in asked
    assert (tmp_path / "told.toml").read_text() == (tmp_path / "asked.toml").read_text()
