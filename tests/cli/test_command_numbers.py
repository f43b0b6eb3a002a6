"""Every number that a command prints, with its unit: computed apart, or kept by hand in a results directory."""

import csv
import json

import pytest
from conftest import refused, typed
from oracles.made_cases import kept_study, made_row

from validation.cli.run import _status
from validation.gates.gate import Gate, Status, Verdict
from validation.runs.results import Results
from validation.scenes.scene import load_scene


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


# ---- rows -----------------------------------------------------------------------------------------------------------


def test_rows_of_a_study_are_one_table(tmp_path):
    case = load_scene("figures-3-4").with_values({"time.step": 0.002})
    kept_study(Results(tmp_path), [(case, made_row("dda", {"displacement.static": -0.0125}, case.name), None)])
    words = ("--results", tmp_path, "--csv", tmp_path / "rows.csv")
    assert typed("rows", "made", *words).returncode == 0
    lines = list(csv.DictReader((tmp_path / "rows.csv").read_text().splitlines()))
    (line,) = [line for line in lines if line["metric"] == "displacement.static"]
    assert (line["study"], line["solver"], line["value"], line["unit"]) == ("made", "dda", "-0.0125", "m")
    assert refused("rows", "other", *words).startswith("error: other: ")


# ---- claims -------------------------------------------------------------------------------------------------------


def test_claims_are_listed_with_their_verdicts(tmp_path):
    derived = [{"scene": "claims", "name": name, "metrics": {"verdict": verdict}} for name, verdict in
               (("C1", 2.0), ("C2", 0.0), ("C6", 1.0))]  # fmt: skip
    Results(tmp_path).write_json("studies/paper.json", {"study": "paper", "derived": derived})
    lines = {line.split()[0]: line for line in typed("claims", "--results", tmp_path).stdout.splitlines()}
    words = {"C1": "confirmed", "C2": "refuted", "C6": "confirmed under a condition", "C3": "not run"}
    assert {name: lines[name][5:32].strip() for name in words} == words
    assert typed("claims", "--results", tmp_path, "--out", tmp_path / "claims.md").returncode == 0
    assert "## C1: confirmed" in (tmp_path / "claims.md").read_text()
    listed = json.loads(typed("claims", "--results", tmp_path, "--json").stdout)
    assert {one["id"]: one["verdict"] for one in listed if one["verdict"]} == {
        k: v for k, v in words.items() if k != "C3"
    }
    Results(tmp_path).write_json("studies/paper.json", {"study": "paper"})
    assert refused("claims", "--results", tmp_path).strip().endswith("dda-validate run paper")
