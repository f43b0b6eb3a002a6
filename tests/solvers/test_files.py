"""Solvers that are no Python: programs that read a scene and print a table, and tables that are read."""

import shutil
import subprocess
from pathlib import Path
from time import perf_counter

import numpy as np
import pytest
from oracles.pages import ROOT

from validation.engine.measure import completed
from validation.errors import InputError
from validation.runs.defects import Defects, DefectsError
from validation.runs.history import History
from validation.runs.results import Results
from validation.runs.run import Outcome, Run
from validation.scenes.plain import lines, words
from validation.scenes.scene import load_scene
from validation.solvers import user
from validation.solvers.history_table import read_table
from validation.solvers.processes.user_worker import columns_of, place_of, plain, text_of
from validation.solvers.processes.worker import WorkerDied
from validation.solvers.registry import get_solver
from validation.solvers.user import VARIABLE
from validation.suite.own_solver.gates import applying
from validation.suite.own_solver.session import Session

PROGRAM = (ROOT / "docs/examples/judge/block.cpp").read_text(encoding="utf-8")
LOCKED = load_scene("field-locked")


@pytest.mark.long
@pytest.mark.parametrize(("old", "new", "group"), [("", "", None), ('gg = number("time.gg")', "gg = 1", "damping")])
def test_a_program_in_c_goes_through_the_gates(old, new, group, tmp_path):
    if shutil.which("g++") is None:
        pytest.skip("NOT RUN: there is no compiler of C++")
    assert old in PROGRAM
    (tmp_path / "block.cpp").write_text(PROGRAM.replace(old, new))
    subprocess.run(["g++", "-o", tmp_path / "block", tmp_path / "block.cpp"], check=True)
    session = Session(str(tmp_path / "block"), Results(tmp_path / "results"))
    reports = [session.judge(name)[1] for name in applying() if name.startswith(("figure-8[time.start", "figures-5-6"))]
    assert sum(report.status == "PASS" for report in reports) > (18 if group is None else 0)
    failed = {report.group for report in reports if report.status == "FAIL"}
    assert (not failed) if group is None else group in failed


def program(place, text):
    """Write a program of a shell and return its path."""
    path = place / "program"
    path.write_text(f"#!/bin/sh\n{text}\n")
    path.chmod(0o755)
    return str(path)


ROWS = "\n".join(f"echo 0.00{n},-1e-3" for n in range(1, 4))
SCENE = LOCKED.with_values({"time.step": 0.001, "time.steps": 3})


@pytest.mark.parametrize(
    ("text", "outcome", "said"),
    [
        (f"cat > /dev/null\necho time,displacement\n{ROWS}", Outcome.COMPLETED, ""),
        (f"echo time,displacement\n{ROWS}", Outcome.COMPLETED, ""),  # which does not read
        ("echo a column >&2\nexit 77", Outcome.NOT_APPLICABLE, "not made for it: a column"),
        ("echo no licence >&2\nexit 3", Outcome.RAISED, "ended with status 3: no licence"),
        ("echo time,displacement\necho 0.001,x", Outcome.WRONG_SHAPE, "displacement: must be a number, got 'x'"),
        ("exit 0", Outcome.WRONG_SHAPE, "got an empty file"),
        (f"echo time,displacement\n{ROWS.replace('0.00', '')}", Outcome.WRONG_SHAPE, "milliseconds?"),
        (f"echo time,displacement_m\n{ROWS.replace('-1e-3', 'nan')}", Outcome.WRONG_SHAPE, "must be a finite number"),
        ("sleep 30", Outcome.TIMEOUT, "no history within"),
    ],
)
def test_how_a_program_ends_is_named(text, outcome, said, tmp_path, monkeypatch):
    if outcome is Outcome.TIMEOUT:
        monkeypatch.setenv(VARIABLE, "0.2")
    began = perf_counter()
    run = completed(get_solver(program(tmp_path, text)), SCENE)
    assert run.outcome is outcome, run.notes
    assert said in "".join(run.notes)
    if outcome is Outcome.COMPLETED:
        assert run.seconds["setup"] == 0 < run.seconds["stepping"] < 60
    assert perf_counter() - began < 25  # nobody waits for what sleeps


COLUMNS = {"displacement": "m", "rotation": "rad"}
TABLES = [  # of three rows, 0.001 s apart: what is wrong with it, where, and in which field
    ("time,displacement\n0,9\n0.001,1\n0.002,2\n0.003,3", None, None),
    ("time,displacement\n0,9\n0.001,1\n0.0025,2\n0.003,3", "x:4:1", "time"),
    ("time,displacement\n0,9\n0.001,1\n0.002,2", "x:4:1", "time"),
    ("time,displacement\n0.001,1\n0.002,2\n0.003,3\n0.004,4", "x:5:1", "time"),
    ("time,displacement\n1,1\n2,2\n3,3", "x:2:1", "time"),
    ("time,displacement\n0.002,1\n0.003,2\n0.004,3", "x:2:1", "time"),
    ("time,displacement\n0.001,1\n0.002,2,5\n0.003,3", "x:3:8", None),
    ("time,displacement\n0.001,1\n0.002\n0.003,3", "x:3:6", None),
    ("time,displacement\n0.001,1\n0.002,1e200\n0.003,inf", "x:3:7", "displacement"),
    ("time,displacment\n0.001,1", "x:1:6", "header"),
    ("time,rotation\n0.001,1", "x:1:14", "header"),
    ("time,displacement,time\n0.001,1,1", "x:1:19", "header"),
    ("0.001,1\n0.002,2", "x:1:1", "header"),
    ("time,displacement\n0.001,\n0.002,", "blank", None),
    ("", "x", None),
]


def test_a_table_of_a_history_is_read_or_its_defect_has_a_place():
    for text, place, field in TABLES:
        defects = Defects()
        table = read_table(Path("x"), 0.001 * np.arange(1, 4), COLUMNS, ["displacement"], defects, text=text)
        if place is None:
            assert table.history.displacement.tolist() == [1.0, 2.0, 3.0] and not len(defects)
            assert [*table.header] == ["time", "displacement"]
            continue
        assert table is None and (place == "blank") is (not len(defects)), text
        if place != "blank":
            with pytest.raises(DefectsError) as error:
                defects.check()
            assert (str(error.value.source), error.value.field) == (place, field), text


def test_a_solver_answers_in_one_of_a_few_forms():
    rows = np.arange(15.0).reshape(5, 3)
    named = {"displacement": [1.0], "contact_pressure": [2.0]}
    assert columns_of(([1.0], [2.0])) == columns_of(named) == named
    found = columns_of(rows)
    assert {name: list(values) for name, values in found.items()} == dict(
        zip(("time", "displacement", "contact_pressure"), rows.T.tolist(), strict=True)
    )
    history = History(np.array([0.5]), {"displacement": np.array([1.0])})
    for value in (history, Run(Outcome.COMPLETED, history)):
        assert columns_of(value) == {"time": history.time, "displacement": history.displacement}
    for other in ([1, 2, 3, 4], np.zeros((3, 4)), np.zeros(3), "ab", None):
        with pytest.raises(TypeError):
            columns_of(other)
    assert plain("x", [[True, 2], [None, 3.5]])[1][1] == 3.5
    for other in (["1"], [1j], [np.datetime64("2020-01-01")]):
        with pytest.raises(TypeError, match="x must hold real numbers"):
            plain("x", other)
    silent = type("Silent", (Exception,), {"__str__": lambda self: 1 / 0})()
    with pytest.raises(np.linalg.LinAlgError) as raised:  # within numpy
        np.linalg.solve(np.zeros((2, 2)), np.ones(2))
    assert place_of(raised.value, Path(__file__).parent).startswith("test_files.py:")
    assert place_of(ValueError(), Path()) == ""
    said = ["ValueError: no", "Silent, whose text raises ZeroDivisionError"]
    assert [text_of(error) for error in (ValueError("no"), silent)] == said


def test_a_solver_that_says_nothing_of_itself_has_nothing_to_say(monkeypatch):
    solver = get_solver("json:solve")
    asked = []

    def answer(command, environment, request, limit):
        asked.append((request, limit))
        if len(asked) > 2:
            raise WorkerDied("the end")
        return {"raised": "no\nmodule", "about": {"program": "a\n b", "version": 3}}

    monkeypatch.setattr(user, "ask", answer)
    monkeypatch.setenv(VARIABLE, "9")
    for said, about in (("no module", {"program": "a b", "version": "3"}), ("the end", {})):
        with pytest.raises(InputError, match=said):
            solver.check_loads()
        assert solver.about() == about
    assert {*asked[0][0]} == {"parts", "about"} and {limit for _, limit in asked} == {9.0}


def test_a_table_that_cannot_be_read_is_a_defect(tmp_path):
    (tmp_path / "bytes").write_bytes(b"time,displacement\n0,\xff")
    for name, said in (("none", "cannot be read"), ("bytes", "UTF-8")):
        defects = Defects()
        assert read_table(tmp_path / name, np.ones(1), COLUMNS, ["displacement"], defects) is None
        with pytest.raises(DefectsError, match=said):
            defects.check()
    (tmp_path / "field-locked.csv").write_text("time,displacement\n0.001,\n")
    files = get_solver(f"{tmp_path}/")
    assert files.solve(LOCKED.with_values({"time.steps": 1})).outcome is Outcome.NOT_RUN
    assert files.prepare(LOCKED).assumed_static() == get_solver("dda").static(LOCKED)
    assert get_solver(str(tmp_path / "none.csv")).read(LOCKED).outcome is Outcome.NOT_APPLICABLE


def test_what_cannot_be_started_and_kinds_without_words(tmp_path):
    path = Path(program(tmp_path, "exit 0"))
    path.write_bytes(b"\x7fELF no such thing")
    assert get_solver(str(path)).read(SCENE).outcome is Outcome.RAISED
    plane = completed(get_solver(str(path)), load_scene("patch-strip").expand()[0])
    assert plane.outcome is Outcome.NOT_APPLICABLE


def test_a_program_is_told_what_problems_never_have():
    changed = LOCKED.with_values({"damping.mass": 2.0, "load.ramp": 0.01})
    told = sorted(line.split() for line in set(lines(changed)) - set(lines(LOCKED)))
    assert told == [["also", "damping.mass_1_per_s", "2.0"], ["also", "load.ramp_s", "0.01"]]


def test_every_line_of_a_scene_has_words():
    known = {line.split()[0] for name in ("field-locked", "field-creep") for line in lines(load_scene(name))}
    described = {name for name, _ in words()} | {name for name in known if name.startswith("time.")}
    assert known - described - {"geometry", "columns", "block.width_m", "block.height_m"} == set()
    assert {name.partition(".")[0] for name, _ in words()} == {"block", "contact", "load", "column", "input", "plane"}
