"""What the documentation shows is run: code blocks in the order of a page, notebooks, drawings, docstrings."""

import doctest
import importlib
import json
import os
import re
import runpy
import shlex
import shutil
import subprocess
import sys
import tempfile
import tomllib
from functools import cache
from pathlib import Path

import pytest
from conftest import SCENE, beside, script, typed
from oracles.pages import BLOCK, FEW, ROOT, write_my_solver

import validation.studies
from validation import solve
from validation.gates.gate import NOISE
from validation.problems import pack
from validation.report.verification import LINES, decisive, standing
from validation.results import Results
from validation.scenes.scene import parse_scene
from validation.solvers.names import check_names
from validation.suite.matrix import phenomena, phenomenon, verify

DOCS = ROOT / "docs"
PAGES = (
    "columns.md",
    "methods.md",
    "extending.md",
    "plane.md",
    "subblocks.md",
    "stacks.md",
    "contact.md",
    "rotation.md",
    "waves.md",
    "judge.md",
    "ci.md",
    "fenicsx.md",
)
BIBLIOGRAPHY = ROOT / "validation/report/references.bib"
NOTEBOOKS = sorted((DOCS / "notebooks").glob("*.ipynb"))


def blocks(page):
    """Return language, file and text of the code blocks of a page."""
    return BLOCK.findall(page.read_text(encoding="utf-8"))


@cache
def judged(words, solver):
    """Put the solver of a page to gates in a process of its own, once where pages do the same."""
    with tempfile.TemporaryDirectory() as place:
        Path(place, "my_solver.py").write_text(solver)
        environment = os.environ | {"OMP_NUM_THREADS": "1", "PYTHONPATH": place}
        command = [sys.executable, "-m", "pytest", *words]
        return subprocess.run(command, capture_output=True, text=True, timeout=200, cwd=place, env=environment)


def run_line(line, directory, gates=FEW, status=0):
    """Run a line of a shell as a user in a directory does and return what it prints."""
    program, *words = shlex.split(line, comments=True)
    if program == "dda-validate":
        done = typed(*words, cwd=directory)
    elif program in ("cp", "python", "g++", "gfortran"):
        command = [sys.executable if program == "python" else program, *words]
        done = subprocess.run(command, capture_output=True, text=True, timeout=200, cwd=directory)
    else:
        assert program == "pytest"
        done = judged((*words, *gates), (directory / "my_solver.py").read_text())
    assert done.returncode == status, f"{line}\n{done.stdout}{done.stderr}"
    return done.stdout


def missing_lines(shown, printed):
    """Return the lines of a page that are no part of a line that was printed, spaces aside."""
    plain = [" ".join(line.split()) for line in printed.splitlines()]
    return [line for line in shown.splitlines() if not any(" ".join(line.split()) in text for text in plain)]


@pytest.mark.long
@pytest.mark.parametrize("page", PAGES)
def test_code_blocks_run(page, tmp_path, finished_cases, monkeypatch):
    for name in ("before", "after"):  # what the page compares, with the cases that other tests have finished
        beside(finished_cases, tmp_path / name)
    if page == "judge.md" and not (shutil.which("g++") and shutil.which("gfortran")):
        pytest.skip("NOT RUN: there is no compiler of C++ and Fortran")
    for folder in ("extend",) if page == "extending.md" else ("judge", "scenes"):
        shutil.copytree(DOCS / "examples" / folder, tmp_path, dirs_exist_ok=True)
    monkeypatch.chdir(tmp_path)
    monkeypatch.syspath_prepend(str(tmp_path))
    monkeypatch.setattr(validation.studies, "__path__", [*validation.studies.__path__])
    if page == "judge.md":  # the exact motions of all problems take half a minute; all of a pack have a test
        monkeypatch.setattr(pack, "names", lambda: ("locked", "sliding", "column", "standing"))
    names = {}
    assert blocks(DOCS / page)
    printed = ""
    for language, file, text in blocks(DOCS / page):
        if file:
            (tmp_path / file).parent.mkdir(parents=True, exist_ok=True)
            (tmp_path / file).write_text(text)
        if language == "sh":
            printed = "".join(run_line(line, tmp_path) for line in text.splitlines())
        elif language == "text" and text.startswith("fall on"):
            assert missing_lines(text, printed) == []
        elif language == "python" and not file:
            exec(compile(text, page, "exec"), names)
        elif language == "toml":
            tomllib.loads(text)


@pytest.mark.long
@pytest.mark.parametrize(("page", "outputs"), [("choose.md", 7), ("tutorial.md", 4)])
def test_commands_print_what_the_page_shows(page, outputs, tmp_path, finished_cases, monkeypatch):
    write_my_solver(tmp_path)
    monkeypatch.chdir(tmp_path)
    monkeypatch.syspath_prepend(str(tmp_path))
    (tmp_path / "reports").mkdir()
    beside(finished_cases, tmp_path / "reports/results")
    printed = ""
    checked = 0
    for language, file, text in blocks(DOCS / page):
        if file:
            (tmp_path / file).write_text(text)
        elif language == "sh":
            printed = "".join(run_line(line, tmp_path) for line in text.splitlines())
        elif language == "text" and printed:
            if "statics" in text:  # the mistake that the tutorial asks for
                solver = tmp_path / "my_solver.py"
                right = solver.read_text()
                solver.write_text(right.replace("b.density * w * h", "2 * b.density * w * h"))
                gates = "pytest --pyargs validation -m validation --dda-solver my_solver:solve"
                printed = run_line(gates, tmp_path, FEW[:3], status=1)
                solver.write_text(right)
            assert missing_lines(text, printed) == [], printed
            checked += 1
    assert checked == outputs


def test_the_example_of_readme_prints_what_its_comments_say(capsys):
    (text,) = [text for language, _, text in blocks(ROOT / "README.md") if language == "python"]
    exec(compile(text, "README.md", "exec"), {})
    form, mesh, pressure = map(float, capsys.readouterr().out.split())
    assert 1e-4 < form < 1e-2 and mesh < 1e-3 * form and pressure == pytest.approx(5e6, rel=1e-3)


@pytest.mark.long
@pytest.mark.parametrize("path", sorted((DOCS / "examples/numbers").glob("*.py")), ids=lambda path: path.stem)
def test_numbers_of_pages_are_those_of_their_scripts(path):
    runpy.run_path(str(path))
    assert f"(examples/numbers/{path.name})" in page_text(f"{path.stem}.md")


@pytest.mark.parametrize("page", ["loads.md", *(pytest.param(f"{name}.md", marks=pytest.mark.long) for name in
                                                ("plane", "subblocks"))])  # fmt: skip
def test_tables_of_scenes_load(page, tmp_path):
    (tmp_path / "record.csv").write_text("time,x\n0,0\n1,0.001\n")
    for text in [text for language, _, text in blocks(DOCS / page) if language == "toml"]:
        data = {} if "[plane]" in text else tomllib.loads(SCENE)
        for name, table in tomllib.loads(text.replace('"record.csv"', f"'{tmp_path}/record.csv'")).items():
            data[name] = {**data.get(name, {}), **table} if isinstance(table, dict) else table
        scene = parse_scene(data, page)
        check_names(scene, page)
        run = solve(scene.expand()[0], "dda")
        assert run.history is not None and set(scene.run.columns) == set(run.history.columns)


# ---- notebooks, drawings, references --------------------------------------------------------------------------------


@pytest.mark.long
@pytest.mark.parametrize("path", NOTEBOOKS, ids=lambda path: path.stem)
def test_notebooks_print_what_is_committed(path, monkeypatch):
    notebooks = script("notebooks", monkeypatch)
    monkeypatch.setattr(sys, "path", list(sys.path))
    committed = json.loads(path.read_text(encoding="utf-8"))
    fresh = notebooks.run(path)
    assert notebooks.text_of(fresh) == notebooks.text_of(committed) != []
    kinds = [
        [[output["output_type"] for output in cell.get("outputs", ())] for cell in one["cells"]]
        for one in (fresh, committed)
    ]
    assert kinds[0] == kinds[1]


def texts(drawing):
    """Return the words and numbers of a drawing."""
    return re.findall(r"<text[^>]*>([^<]+)</text>", drawing.read_text(encoding="utf-8"))


@pytest.mark.long
def test_drawings_are_those_that_the_solvers_give(tmp_path, monkeypatch):
    figures = script("figures", monkeypatch)
    figures.write(list(figures.FIGURES), tmp_path)
    committed = {path.name: texts(path) for path in (DOCS / "figures").glob("*.svg")}
    assert {path.name: texts(path) for path in tmp_path.iterdir()} == committed
    for name in figures.FIGURES:
        assert f"(figures/{name}.svg)" in (DOCS / f"{name}.md").read_text(encoding="utf-8")


def page_text(name):
    """Return a page of the documentation."""
    return (DOCS / name).read_text(encoding="utf-8")


def test_citations_lead_to_an_entry_of_the_bibliography():
    anchors = re.findall(r'<a id="(\w+)">', (DOCS / "references.md").read_text(encoding="utf-8"))
    assert anchors == re.findall(r"^@\w+\{(\w+),$", BIBLIOGRAPHY.read_text(encoding="utf-8"), re.M)
    for page in DOCS.glob("*.md"):
        cited = re.findall(r"references\.md#(\w+)", page.read_text(encoding="utf-8"))
        assert set(cited) <= set(anchors), page.name
    paper = (DOCS / "paper/paper.md").read_text(encoding="utf-8")
    assert set(re.findall(r"@([a-z]+\d{4})", paper)) <= set(anchors)
    assert (DOCS / "paper/paper.bib").read_bytes() == BIBLIOGRAPHY.read_bytes()


def test_the_page_of_references_is_that_of_the_bibliography(monkeypatch):
    pytest.importorskip("pybtex", reason="the page of references is NOT RUN: needs the extra docs")
    references = script("references", monkeypatch)
    assert references.PAGE.read_text(encoding="utf-8") == references.page()


@pytest.mark.long
def test_the_page_of_what_is_verified_is_that_of_the_gates(monkeypatch):
    """The values that it keeps are those of all gates that decide, and lie within their bands."""
    verification = script("verification", monkeypatch)
    kept = verification.read()
    assert verification.PAGE.read_text(encoding="utf-8") == verification.page(kept)
    for shown in phenomena():
        values = kept[shown.name].values
        gates = [decisive(gates) for gates in shown.lines()[:LINES]]
        assert [gate.id for gate in gates] == list(values), shown.name
        assert all(good == judged for good, judged in kept[shown.name].passed.values())
        for gate in gates:
            value, margin = values[gate.id]
            assert margin is None or 0 <= margin <= 1, gate.id
            rounded = 6e-4 * abs(value) + NOISE
            assert gate.low - rounded <= value <= gate.high + rounded, gate.id


@pytest.mark.long
@pytest.mark.parametrize("name", ["spins", "wedge"])
def test_what_is_verified_today_is_what_the_page_keeps(name, monkeypatch, finished_cases):
    shown = phenomenon(name)
    verdicts, _ = verify(shown, Results(finished_cases))
    fresh = standing(shown, [verdict.record(shown.study) for verdict in verdicts])
    kept = script("verification", monkeypatch).read()[shown.name]
    assert {solver: list(tally) for solver, tally in fresh.passed.items()} == kept.passed
    for gate, (value, margin) in kept.values.items():
        now, left = fresh.values[gate]
        assert now == pytest.approx(value, rel=1e-3, abs=NOISE), gate
        assert left == (None if margin is None else pytest.approx(margin, abs=0.02)), gate


# ---- docstrings -----------------------------------------------------------------------------------------------------


EXAMPLES = [
    pytest.param(path, id=path.stem, marks=[pytest.mark.long] if path.stem == "across" else [])  # seconds
    for package in ("dda", "fem_reference", "validation")
    for path in sorted((ROOT / package).rglob("*.py"))
    if ">>>" in path.read_text()
]


@pytest.mark.parametrize("path", EXAMPLES)
def test_examples_of_docstrings_print_what_they_say(path):
    module = importlib.import_module(".".join(path.relative_to(ROOT).with_suffix("").parts))
    result = doctest.testmod(module)
    assert result.attempted > 0 and result.failed == 0
