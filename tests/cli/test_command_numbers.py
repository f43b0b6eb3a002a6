"""Every number that a command prints, with its unit: computed apart, or kept by hand in a results directory."""

import numpy as np
import pytest
from conftest import typed
from oracles.made_cases import between, kept_study, made_history, made_row

from validation import load_scene
from validation.cli.printing import tables
from validation.cli.run import _status
from validation.gates.changes import changes, markdown
from validation.gates.gate import Gate, Status, Verdict, judge
from validation.report.render.terminal import lines
from validation.runs.results import Results
from validation.runs.run import Outcome

# ---- solve and run ------------------------------------------------------------------------------------------------


def test_the_table_of_a_run_shows_value_band_and_seconds_of_its_own_gate(tmp_path, capsys):
    results, scene = Results(tmp_path), load_scene("figures-3-4").with_values({"time.step": 0.002}, label=True)
    rows = [made_row("dda", {}, scene.name, seconds={"setup": 1.25, "stepping": 2.5}),
            made_row("bar", {}, scene.name, seconds={"a": 7.0}, outcome=Outcome.OVERFLOW, notes=("at 3",))]  # fmt: skip
    kept_study(results, [(scene, row, None) for row in rows])
    gate = Gate(scene.name, ("dda", "bar"), "displacement.l2", 0.031, 0.042, "the reason", until=0.2)
    printed = tables.verdict_table([judge(gate, 0.0512), judge(gate, 0.04)], results, ["made"])
    middle = ("time.step=0.002", "dda | bar", "displacement.l2@0.2s")
    assert printed.rows == (
        (*middle, "0.0512", "0.031 .. 0.042", "FAIL", "3.75"),
        (*middle, "0.04", "0.031 .. 0.042", "PASS", "3.75"),
    )
    wide, narrow = ([text for text, _ in lines([printed], width)] for width in (150, 60))
    assert len(wide) == 3 and max(map(len, narrow)) <= 60
    tables.print_ends(results, ["made"])
    assert capsys.readouterr().out == f"{scene.name} bar: overflow: {Outcome.OVERFLOW.sentence} at 3\n"


def test_a_program_that_is_not_installed_says_so_once(tmp_path, capsys):
    results = Results(tmp_path)
    cases = load_scene("figures-3-4").expand()[:3]
    absent = {"outcome": Outcome.NOT_APPLICABLE, "notes": ("Siconos is not installed: RECIPE",)}
    kept_study(results, [(case, made_row("siconos", {}, case.name, **absent), None) for case in cases])
    tables.print_ends(results, ["made"])
    (line,) = capsys.readouterr().out.splitlines()
    assert line.startswith("3 cases siconos: not applicable: ")
    assert line.endswith("Siconos is not installed: RECIPE")


@pytest.mark.parametrize(
    ("words", "required", "refused", "worse", "status"),
    [
        (["PASS", "NOT RUN"], [], False, None, 0),
        (["PASS", "NOT RUN"], ["fem"], False, None, 0),
        (["PASS", "NOT RUN"], ["bar"], False, None, 1),
        (["PASS", "FAIL"], [], False, None, 1),
        (["PASS", "FAIL"], [], False, False, 0),  # it failed in the baseline as well
        (["PASS", "PASS"], [], False, True, 1),  # a gate of the baseline is gone
        (["PASS", "NOT RUN"], ["bar"], False, False, 1),
        (["PASS", "FAIL"], [], True, False, 2),
    ],
)
def test_the_status_of_a_run(words, required, refused, worse, status):
    gate = Gate("s", ("dda", "bar"), "displacement.l2", 0.0, 1.0, "why")
    assert _status([Verdict(gate, None, Status(word)) for word in words], required, refused, worse) == status


# ---- verdicts side by side ----------------------------------------------------------------------------------------


def verdict(name, word, value, study="s"):
    return {"study": study, "id": name, "verdict": word, "value": value, "band": [0.25, 0.75], "reason": "why"}


OLD = [verdict("a", "PASS", 0.5), verdict("b", "FAIL", 0.125), verdict("c", "PASS", 0.3)]
NEW = [verdict("a", "FAIL", 0.875), verdict("b", "FAIL", 0.1), OLD[2], verdict("d", "NOT RUN", None, "t")]


def test_a_summary_shows_counts_values_bands_and_what_changed_from_and_to():
    lines = markdown(NEW, changes(OLD, NEW[:3])).splitlines()
    assert lines[0] == "## dda-validation: 1 PASS, 2 FAIL, 1 NOT RUN"
    assert lines[2] == "| study | PASS | FAIL | NOT RUN |"
    assert lines[4:6] == ["| s | 1 | 2 | 0 |", "| t | 0 | 0 | 1 |"]
    assert "| gate | value | band | why |" in lines and "| `a` | 0.875 | 0.25 .. 0.75 | why |" in lines
    assert "| `d` | - | 0.25 .. 0.75 | why |" in lines
    assert lines[-4:] == [
        "| change | gate | verdict | value |",
        "|---|---|---|---|",
        "| worse | `a` | PASS → FAIL | 0.5 → 0.875 |",
        "| value | `b` | FAIL | 0.125 → 0.1 |",
    ]


# ---- rows and plot ------------------------------------------------------------------------------------------------


@pytest.fixture
def made(tmp_path):
    """Return three steps of DDA and one of the bar, with work, seconds and differences from the bar."""
    results, cases, pairs = Results(tmp_path / "results"), [], []
    for k, step in enumerate((0.01, 0.002, 0.001)):
        scene = load_scene("figures-3-4").with_values({"time.step": step}, label=True)
        row = made_row("dda", {"pressure.peak": 6e6 + k}, scene.name, work={"solves": 10**k},
                       seconds={"setup": 0.5, "stepping": 1.0 + k})  # fmt: skip
        cases.append((scene, row, made_history(step, np.ones(3))))
        pairs.append(between(scene.name, "dda", "bar", displacement_l2=0.1 * (3 - k), pressure_l2=0.0))
    cases.append((scene, made_row("bar", {}, scene.name, seconds={"setup": 9.0}), None))
    kept_study(results, cases, pairs)
    return results


# ---- claims -------------------------------------------------------------------------------------------------------


def test_claims_are_listed_with_their_verdicts(tmp_path):
    derived = [{"scene": "claims", "name": name, "metrics": {"verdict": verdict}} for name, verdict in
               (("C1", 2.0), ("C2", 0.0), ("C6", 1.0))]  # fmt: skip
    Results(tmp_path).write_json("studies/paper.json", {"study": "paper", "derived": derived})
    lines = {line.split()[0]: line for line in typed("claims", "--results", tmp_path).stdout.splitlines()}
    words = {name: line[5:32].strip() for name, line in lines.items()}
    assert [words[name] for name in ("C1", "C2", "C6", "C3")] == [
        "confirmed", "refuted", "confirmed under a condition", "not run",
    ]  # fmt: skip
