"""The answer of `run`: failures in full, a line a study, alarms by kind, what comes next; bounded, and for machines."""

import re
from dataclasses import replace

import pytest
from oracles.made_cases import kept_study, made_row

from validation import load_scene
from validation.cli.printing import answer
from validation.cli.printing.answer import FAILURES_SHOWN, SCREEN, RunAnswer
from validation.cli.printing.tables import print_ends
from validation.engine.measured import JudgedStudy
from validation.gates.changes import Change
from validation.gates.gate import Gate, Status, Verdict, judge
from validation.runs.results import Results
from validation.runs.run import Outcome
from validation.suite.folders import get_study

CASE = load_scene("figures-3-4").with_values({"time.step": 0.002, "time.steps": 50})
GATE = Gate(CASE.name, ("dda", "bar"), "displacement.l2", 0.031, 0.042, "the reason " * 12)
NOT_RUN = Verdict(GATE, None, Status.NOT_RUN, "fenicsx: needs the package dolfinx")
MESSAGES = ["a: no case was measured"]
ENDS = {"dda": Outcome.COMPLETED, "fem": Outcome.OVERFLOW, "bar": Outcome.TIMEOUT, "continuum": Outcome.NOT_APPLICABLE}


def run_of(name, verdicts, ends=None):
    study = replace(get_study("core"), name=name, expects=(Outcome.OVERFLOW,))
    return JudgedStudy(study, verdicts, {(CASE.name, solver): end for solver, end in (ends or {}).items()})


def ran(results, runs, own=frozenset()):
    return RunAnswer(runs, [1.25] * len(runs), results, MESSAGES, None, own, 1)


def said(what, width=80):
    return [text for text, _ in answer.lines(what, width)]


@pytest.fixture
def made(tmp_path):
    results = Results(tmp_path / "r")
    rows = [made_row(name, {}, CASE.name, outcome=end, notes=("at 3",)) for name, end in ENDS.items()]
    told = (("tension", "a", "x"), ("tension", "a", "y"), ("tension", "b", "z"), ("ringing", "a", "it rings"))
    alarms = [{"kind": kind, "scene": name, "sentence": text} for kind, name, text in told]
    kept_study(results, [(CASE, row, None) for row in rows], alarms=alarms)
    return results


def test_many_studies_fit_one_screen_and_those_with_something_to_tell_keep_their_line(made):
    runs = [run_of("made" if i == 19 else f"s{i}", [judge(GATE, 0.04 if i != 18 else 1.0)], ENDS) for i in range(25)]
    lines = [text for text, _ in answer.summary(ran(made, runs), 80)]
    assert len(lines) == SCREEN
    rows = lines[1 : next(i for i, line in enumerate(lines) if " PASS, " in line)]
    assert len(rows) > 10 and rows[-1].startswith(f"{26 - len(rows)} more")
    assert sum(int(row.split()[-4]) for row in rows) == 24
    assert [row.split()[0] for row in rows if row.split()[-3] == "1"] == ["s18"]


def test_of_very_many_failures_the_rest_is_counted_by_metric(made):
    many = [judge(replace(GATE, until=float(i + 1)), 1.0) for i in range(FAILURES_SHOWN + 7)]
    lines = said(ran(made, [run_of("made", many)]), 200)
    assert sum(line.startswith(f"FAIL {CASE.name}") for line in lines) == FAILURES_SHOWN
    assert [line for line in lines if re.match("FAIL .* 7 .*: displacement.l2 7;", line)]


def test_of_many_runs_that_ended_badly_and_of_many_reasons_the_rest_is_counted(made):
    ended = {(f"s{number}", "dda"): Outcome.TIMEOUT for number in range(FAILURES_SHOWN + 2)}
    kept_study(made, [(CASE.model_copy(update={"name": name}), made_row("dda", {}, name), None) for name, _ in ended])
    study = replace(run_of("made", [replace(NOT_RUN, why=f"why {number}") for number in (1, 2, 2, 3, 3, 3, 4)]))
    lines = said(ran(made, [replace(study, outcomes=ended)]))
    assert [line for line in lines if line.startswith("NOT RUN") and "reasons" not in line] == [
        "NOT RUN 3: why 3",
        "NOT RUN 2: why 2",
    ]
    assert all(re.search(rf"\b2 more {what}", "\n".join(lines)) for what in ("reasons", "runs ended"))
    assert "reasons" not in str(said(ran(made, [replace(study, verdicts=study.verdicts[:3])])))


def test_plain_data_hold_what_the_text_says(made):
    change = Change("made", GATE.id, "PASS", "FAIL", 0.035, 0.0512)
    data = answer.as_data(replace(ran(made, [run_of("made", [judge(GATE, 0.0512), NOT_RUN], ENDS)]), changes=[change]))
    (study,) = data["studies"]
    outcomes = {str(end): 1 for end in ENDS.values()}
    counts = {"study": "made", "passed": 0, "failed": 1, "not_run": 1, "seconds": 1.25}
    assert study == {**counts, "outcomes": outcomes}
    assert data["alarms"] == {"tension": 2, "ringing": 1}
    assert (data["changes"][0]["before"], data["changes"][0]["after"]) == ("PASS", "FAIL")
    assert data["ended_badly"] == [f"{CASE.name} bar: timeout: {Outcome.TIMEOUT.sentence} at 3"]
    assert (data["messages"], data["status"]) == (MESSAGES, 1)


def test_what_did_not_complete_is_told_with_its_end_and_what_was_refused_is_bad(made, capsys):
    print_ends(made, ["made"])
    assert [line.split(": ")[:2] for line in capsys.readouterr().out.splitlines()] == [
        [f"{CASE.name} {solver}", str(end)] for solver, end in ENDS.items() if end is not Outcome.COMPLETED
    ]
    refused = run_of("made", [], {"dda": Outcome.REFUSED, "fem": Outcome.OVERFLOW})
    assert [line.split()[1] for line in answer.badly_ended(ran(made, [refused]))] == ["dda:"]
    assert answer.ends(ran(made, [refused])) == {"overflow": 1}
