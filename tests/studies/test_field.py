"""The study `field`: its table, what is not installed, a program that a user brings, its gates from both sides."""

import re
from dataclasses import replace
from pathlib import Path

import pytest
from oracles.made_cases import made_row

from validation.engine import run_study
from validation.engine.finished import Finished, NothingToDerive
from validation.gates.gate import Status
from validation.problems.problem import PREFIX
from validation.results import Results
from validation.runs.run import Outcome
from validation.solvers import registry
from validation.studies.field import answered, cells, scenes
from validation.studies.field import formulas as module
from validation.studies.field.table import FAIL, NOT_APPLICABLE, NOT_RUN, PASS, read
from validation.suite import programs
from validation.suite.folders import study_folders
from validation.suite.tables import declare

ROOT = Path(__file__).parents[2]
CHEAP = ("locked",)


@pytest.fixture
def brought(monkeypatch, tmp_path):
    """Install the program of docs/field.md, and one that is broken, as packages of a user."""
    text = (ROOT / "docs" / "field.md").read_text()
    adapter = re.search(r"```python\n(.*?)```", text, re.DOTALL)[1]
    (tmp_path / "mine_of_docs.py").write_text(adapter)
    (tmp_path / "broken.py").write_text("handles = frozenset()\ndef solve(scene):\n    raise OSError('no disk')\n")
    monkeypatch.syspath_prepend(tmp_path)
    found = {"mine": "mine_of_docs:Mine", "broken": "broken:solve"}
    monkeypatch.setattr(registry, "entry_points", lambda: found)
    monkeypatch.setattr(programs, "entry_points", lambda: found)


def run(problems, tmp_path, monkeypatch):
    """Run the study over some problems."""
    for room in (module, scenes, cells):
        monkeypatch.setattr(room, "FIELD_PROBLEMS", problems)
    folder = study_folders()["field"]
    whole = declare(folder.path, folder.fields, module)  # over the programs that are installed now
    gates = [gate for gate in whole.gates() if gate.scene in {f"field-{name}" for name in problems} | {"field"}]
    results = Results(tmp_path / "results")
    return run_study(replace(whole, gates=lambda: tuple(gates)), results), read(results)


def test_the_table_of_one_problem(brought, tmp_path, monkeypatch) -> None:
    verdicts, table = run(CHEAP, tmp_path, monkeypatch)
    by_name = {verdict.gate.pair[0]: verdict.status for verdict in verdicts}
    assert by_name["judged dda"] is by_name["judged dda-fine"] is Status.PASS
    assert by_name["opensees"] is by_name["opensees-default as predicted"] is Status.NOT_RUN
    cell = {one.program: one for one in table.row("locked")}
    assert cell["dda-fine"].verdict == cell["mine"].verdict == PASS
    assert 0 < cell["mine"].error < 0.01
    assert cell["mine"].seconds > 0
    assert (cell["dda"].verdict, cell["fem"].verdict) == (FAIL, FAIL)
    assert cell["dda"].cause.endswith("at this step: numerical damping")
    assert cell["opensees"].verdict == NOT_RUN
    assert cell["opensees"].reason == "not installed: pip install 'examples/peers[opensees]'"
    assert 0 < cell["dda"].within < cell["mine"].within == cell["mine"].columns[0].until
    assert cell["broken"].verdict == NOT_RUN
    assert "no disk" in cell["broken"].reason
    about = {line.name: line.about for line in table.programs}
    assert about["mine"]["settings"] == "central differences, a thousandth of the block's wave time"
    assert {column.name for column in cell["mine"].columns} == {"displacement", "contact_pressure"}
    assert cell["mine"].numbers[0].exact == pytest.approx(54.84, rel=1e-3)


def counted(*runs: tuple[Outcome, str]):
    """Return the row on how many problems were answered, of runs that ended so."""
    rows = {}
    for problem, (outcome, note) in zip(module.FIELD_PROBLEMS, runs, strict=False):
        name = f"{PREFIX}{problem}"
        rows[name, "siconos-default"] = made_row("siconos-default", {}, name, outcome=outcome, notes=(note,))
    program = programs.Program("siconos-default", "Siconos, as it comes", "apt-get install python3-siconos")
    return answered.answered(program, [f"{PREFIX}{problem}" for problem in module.FIELD_PROBLEMS])(Finished(rows, None))


def test_a_program_that_is_missing_behind_an_adapter_that_refuses_problems_is_not_run() -> None:
    """Its gate asks for an answer at least; a machine without the program has none to judge."""
    refused = (Outcome.NOT_APPLICABLE, "no stiffness in its contact")
    missing = (Outcome.NOT_APPLICABLE, "Siconos is not installed: apt-get install python3-siconos")
    for runs in ((refused, missing, refused), (missing, missing)):
        with pytest.raises(NothingToDerive, match="not installed"):
            counted(*runs)
    assert counted(refused, (Outcome.RAISED, "it ended")) == {"problems answered": 0.0}
    assert counted((Outcome.COMPLETED, ""), missing) == {"problems answered": 1.0}


@pytest.mark.long
def test_what_a_program_refuses_is_not_applicable(brought, tmp_path, monkeypatch) -> None:
    _, table = run(("column",), tmp_path, monkeypatch)
    cell = table.cell("column", "mine")
    assert cell.verdict == NOT_APPLICABLE
    assert "column" in cell.reason
    assert table.cell("column", "dda").verdict == FAIL
    assert table.cell("column", "dda-fine").verdict == PASS


def test_without_the_study_there_is_no_table(tmp_path) -> None:
    assert read(Results(tmp_path)) is None
