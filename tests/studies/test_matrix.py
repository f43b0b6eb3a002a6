"""The verification matrix: every gate can be looked up, a phenomenon is found by its name and judges any solver."""

import json
from dataclasses import replace

import pytest
from conftest import typed

import validation.studies
from validation.errors import InputError
from validation.runs.results import Results
from validation.runs.run import Outcome
from validation.suite import matrix
from validation.suite.folders import study_folders
from validation.suite.matrix import phenomena, phenomenon, unstated, verify

STUDY = """
[study]
name = "added"
title = "Added"
purpose = "Is it asked what it is of?"
order = 1
scenes = ["figure-7", "figure-8"]
{stated}
[[gate]]
scenes = ["figure-7", "figure-8"]
pairs = [["dda"]]
metrics = ["displacement.static"]
band = [-1.0, 0.0]
reason = "downwards"
"""
SOLVER = """
from dataclasses import replace
from validation import solve as suite
from validation.solvers.dda import DDA

def solve(scene):
    run = suite(scene, "dda")
    columns = dict(run.history.columns)
    columns["box.x"] = {factor} * columns["box.x"]
    return replace(run.history, columns=columns)

solve.handles = DDA.handles
"""


@pytest.mark.long
def test_every_gate_names_its_phenomenon_and_its_sources():
    assert list(unstated()) == []
    assert all(shown.gates for shown in phenomena())
    names = [shown.name for shown in phenomena()]
    assert len(set(names)) == len(names)


@pytest.fixture
def few(monkeypatch):
    """Leave the studies whose bands take no time."""
    chosen = {
        name: folder for name, folder in study_folders().items() if name in ("boxes", "rocking", "columns", "impacts")
    }
    monkeypatch.setattr(matrix, "study_folders", lambda: chosen)


@pytest.mark.parametrize(
    ("stated", "lacks"),
    [
        ('phenomenon = "statics"', {"sources"}),
        ('sources = "known"\nphenomenon = { "statics" = ["figure-7"] }', {"phenomenon"}),
        ('sources = "known"\nphenomenon = { "statics" = ["figure-*"], "again" = ["figure-8"] }', {"phenomenon"}),
        ('sources = "known"\nphenomenon = { "statics" = ["figure-7"], "again" = ["figure-8"] }', set()),
    ],
)
def test_a_gate_without_phenomenon_or_sources_is_found(stated, lacks, tmp_path, monkeypatch):
    (tmp_path / "added").mkdir()
    (tmp_path / "added" / "study.toml").write_text(STUDY.format(stated=stated))
    monkeypatch.setattr(validation.studies, "__path__", [str(tmp_path)])
    found = list(unstated())
    assert {lack for lack, _ in found} == lacks and {gate.metric for _, gate in found} <= {"displacement.static"}


@pytest.mark.parametrize(("text", "advice"), [("ing", "several"), ("rokcing", "rocking"), ("", "lists them")])
def test_a_name_of_none_or_several_is_refused(text, advice, few):
    with pytest.raises(InputError) as refusal:
        phenomenon(text)
    assert refusal.value.field == "PHENOMENON" and advice in str(refusal.value.advice)
    assert typed("verify", text).returncode == 2


@pytest.mark.long
@pytest.mark.parametrize(("factor", "status"), [(1.0, 0), (1.1, 1)])
def test_a_phenomenon_judges_another_solver_behind_derived_rows(factor, status, few, tmp_path, monkeypatch):
    sliding = replace(phenomenon("boxes"), scenes=("boxes-sliding",))
    monkeypatch.setattr(matrix, "phenomenon", lambda text: sliding)
    (tmp_path / f"mine{status}.py").write_text(SOLVER.format(factor=factor))
    done = typed("verify", "boxes", "--solver", f"mine{status}:solve", "--json", cwd=tmp_path)
    assert done.returncode == status, done.stderr
    verdicts = {record["metric"]: record["verdict"] for record in json.loads(done.stdout)}
    assert verdicts == {"lead": "FAIL" if status else "PASS", "force": "PASS"}
    assert not list(tmp_path.glob("reports"))


def test_a_phenomenon_is_run_and_judged_and_who_cannot_answer_is_told(few, finished_cases, tmp_path):
    dominoes = replace(phenomena(["columns"])[0], scenes=("columns-domino",))
    verdicts, remarks = verify(dominoes, Results(finished_cases))
    assert ([str(verdict.status) for verdict in verdicts], remarks) == (["PASS"] * 4, [])
    verdicts, (remark,) = verify(dominoes, Results(tmp_path), "dda-textbook")
    assert [str(verdict.status) for verdict in verdicts] == ["NOT RUN"] * 4
    assert remark.split(": ")[:3] == ["4 of 4 runs", "dda-textbook", str(Outcome.NOT_APPLICABLE)]
    bouncing = replace(phenomenon("impacts"), scenes=("bouncing-mass",))  # of whose four gates one is on `dda`
    assert len(bouncing.gates) == 4 and len(verify(bouncing, Results(tmp_path), "dda-textbook")[0]) == 1
