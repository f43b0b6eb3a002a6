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
from validation.cli import compare as cli_compare
from validation.cli import judge as cli_judge
from validation.cli import waves as cli_waves
from validation.diagnosis.evidence import Stage
from validation.errors import InputError
from validation.gates.gate import Status
from validation.problems.answers import Answer, AnswerSet, stated_by
from validation.report import book
from validation.report.figures import response as figures
from validation.report.site import pages
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
    printed("new", "column.toml", "--kind", "column", "--rock", "basalt", "--frequency", "3.7", cwd=tmp_path)
    assert load_scene(tmp_path / "column.toml").input.frequency == 3.7 and 3.7 not in asked


# ---- what is handed on ----------------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("words", "asked", "said"),
    [
        ("", [("pdf", "reports/report.pdf", None, False)], "wrote reports/report.pdf\n"),
        ("core --out a.PDF --appendix", [("pdf", "a.PDF", ["core"], True)], "wrote a.PDF\n"),
        ("core --figures f", [("figures", "f", ["core"])], "wrote f/one.svg\nwrote f/two.svg\n"),
        ("--site s --docs ../d/", [("site", "s", None, "../d")], "wrote s/index.html (2.5 MB in all)\n"),
        ("--site s --out b.pdf", [("pdf", "b.pdf", None, False), ("site", "s", None, "")], "wrote b.pdf\nwrote s/"),
    ],
)
def test_a_report_is_written_where_and_of_what_it_is_asked_for(words, asked, said, monkeypatch):
    found = []

    def site(store, place, names, progress, docs):
        found.append(("site", str(place), names, docs))
        return place / "index.html"

    def drawn(store, place, names):
        found.append(("figures", str(place), names))
        return [place / "one.svg", place / "two.svg"]

    monkeypatch.setattr(book, "build", lambda store, *rest: found.append(("pdf", str(rest[0]), *rest[1:])))
    monkeypatch.setattr(book, "write_figures", drawn)
    monkeypatch.setattr(book, "unread_studies", lambda store, studies: {"old": "it is of another version"})
    monkeypatch.setattr(book, "ordered_studies", lambda store: ["old"])
    monkeypatch.setattr(pages, "build", site)
    monkeypatch.setattr(pages, "size", lambda place: 2_500_000)
    done = typed("report", *words.split())
    assert (done.returncode, found, done.stderr) == (0, asked, "note: old is left out: it is of another version\n")
    assert done.stdout.startswith(said)


@pytest.mark.parametrize(
    ("words", "studies", "machine"),
    [
        ("", ["core"], (False, 1, 1, None)),
        ("figure-8 --jobs 3 --full", ["figure-8"], (True, 1, 3, None)),
        ("figure-8 figure-9 --ranks 2 --scheduler tcp://a:1", ["figure-8", "figure-9"], (False, 2, 1, "tcp://a:1")),
        ("cost --scene field-locked --set time.steps=9", ["cost-of-field-locked"], (False, 1, 1, None)),
    ],
)
def test_a_run_is_of_the_studies_that_are_named_on_the_machine_that_is_stated(words, studies, machine, monkeypatch):
    found = []

    def stop(*given):
        found.extend(given)
        raise InputError("so far")

    monkeypatch.setattr(run, run._run_studies.__name__, stop)
    done = typed("run", *words.split(), "--results", "r", "--require", "fem")
    assert done.stderr == "error: so far\n"
    named, results, on, judging = found
    assert [study.name for study in named] == studies and str(results.directory) == "r"
    assert (on.full, on.ranks, on.jobs, on.scheduler) == machine
    assert (judging.required, judging.verbose, judging.quiet) == (["fem"], False, False)
    two = typed("run", "cost", "core", "--scene", "figure-8")
    assert (two.returncode, two.stderr[:17]) == (2, "error: --scene: g")


def test_causes_that_give_the_same_history_are_told_apart(monkeypatch):
    stages = (Stage("one", True, "so", {}), Stage("two", False, "not so", {}), Stage("three", None, "who knows", {}))
    alike = {"causes": ["scheme", "gg"], "values": {"gg": 0.98765432}, "further_scene": "a longer run"}
    answer = SimpleNamespace(
        sentence="It departs.", remedy="--scale time=2", causes=("start", "gg"), values={"gg": 0.98765432},
        alike=[alike], evidence=stages, opened=(3, 17), told={}, untold=[{"E": 1.0, "p": -0.5}], notes=("mind",),
    )  # fmt: skip
    lines = [" ".join(line.split()) for line in cli_compare._lines(answer)]
    assert lines == [
        "It departs.",
        "to read the history so, add --scale time=2",
        "causes",
        "start the other initial acceleration",
        "gg 0.98765 a different velocity discount gg",
        "scheme and gg 0.98765 would give the same history here; to tell them apart, try a longer run",
        *("evidence", "one right so", "two wrong not so", "three - who knows"),
        "the contact opened: first step 3, last 17",
        *("", "not determined by the data: +1.00 E, -0.50 p", "note: mind"),
    ]
    answer.remedy = "--set time.gg=0.9"
    assert [*cli_compare._lines(answer)][1] == "to run the scene so, add --set time.gg=0.9"
    answer.departs, answer.as_dict = True, dict
    found = []
    stand_ins = {
        "diagnosis.judgement.compare": lambda *given: answer,
        "diagnosis.reading.read": lambda *given: given,
        "report.chapters.compare.write_document": lambda out, blocks: found.append(out),
        "report.chapters.compare.answer_figure": lambda *given, slide: slide,
        "report.figures.response.save_as": lambda *given: found.append(given),
    }
    for place, stand_in in stand_ins.items():
        monkeypatch.setattr(f"validation.{place}", stand_in)
    done = typed("compare", *CASE, "x.csv", "--out", "o.pdf", "--figure", "f.svg")
    assert (done.returncode, found) == (1, [Path("o.pdf"), (True, Path("f.svg"))])


def test_a_solver_on_several_ranks_is_told_with_their_number(monkeypatch):
    found = []

    def stopped(adapter, case, full, *rest):
        found.append((adapter.name, full))
        return Run(Outcome.OVERFLOW)

    monkeypatch.setattr(run, run._run_case.__name__, stopped)
    done = typed("solve", *CASE, "--solver", "fenicsx", "--ranks", "2", "--full")
    assert done.stdout.startswith("figures-3-4 fenicsx:2: overflow: ") and found.pop() == ("fenicsx:2", True)
    prepared = SimpleNamespace()
    run._watch(lambda *given: found.append(given[:2]), prepared)
    prepared.progress(0.371)
    assert found == [(37, 100)]


def test_answers_that_are_kept_and_written_as_a_pdf_are_named(monkeypatch, tmp_path):
    judged = [SimpleNamespace(judged=True)]
    found = []

    def written(out, blocks):
        found.append((out.name, blocks(tmp_path)))
        return out

    monkeypatch.setattr(judging, "judged_sets", lambda sets, progress: judged)
    monkeypatch.setattr("validation.problems.answers.keep", lambda sets, keep: [keep / "a", keep / "b"])
    monkeypatch.setattr("validation.report.chapters.answers.first_page", lambda sets: [len(sets)])
    monkeypatch.setattr("validation.report.render.pdf.write_document", written)
    monkeypatch.setattr("validation.report.site.submissions.write_site", lambda sets, out, progress: out / "index.html")
    for out, wrote in (("p.pdf", ["wrote p.pdf"]), ("site", ["wrote site/index.html"]), (None, [])):
        told = cli_judge._judged_and_written((), None if out is None else Path(out), Path("k"), None)
        assert told == (judged, ["kept in k/a", "kept in k/b", *wrote])
    assert cli_judge._judged_and_written((), None, None, None) == (judged, [])
    assert found == [("p.pdf", [1])]
