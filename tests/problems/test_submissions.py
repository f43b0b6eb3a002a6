"""Submissions: what is wrong is refused by field, in one line, before anything is judged or written."""

from __future__ import annotations

import csv
import json
import re
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from oracles.submissions import STATED, submitted

from validation.errors import InputError
from validation.problems.data import PACK, united
from validation.problems.pack import TEMPLATE, TIME, table_of
from validation.problems.problem import Problem, problem, problem_of
from validation.problems.submission import FILE, read_submission
from validation.problems.truth import exact
from validation.runs.history import History
from validation.scenes.scene import load_scene

Rows = list[list[str]]


@pytest.fixture(scope="module")
def one() -> Problem:
    return problem("locked")


@pytest.fixture(scope="module")
def motion(one: Problem) -> History:
    return exact(one.scene, one.truth)


def rows_of(table: str) -> Rows:
    return list(csv.reader(table.splitlines()))


def text_of(rows: Rows) -> str:
    return "\n".join(",".join(row) for row in rows)


def refused(place: Path, own: Problem | None = None) -> str:
    with pytest.raises(InputError) as caught:
        read_submission(place, own)
    said = str(caught.value)
    assert "\n" not in said
    return said


def test_a_sound_submission_is_read(tmp_path: Path, one: Problem, motion: History) -> None:
    table = table_of(motion, one.scene.run.columns)
    found = read_submission(submitted(tmp_path, table))
    assert found.problem.name == "locked" and found.data.program == STATED["program"]
    for name, values in motion.columns.items():
        np.testing.assert_array_equal(found.history.columns[name], values)
    swapped = [[row[1], row[2], row[0]] for row in rows_of(table)]  # columns go by their names
    found = read_submission(submitted(tmp_path, text_of(swapped)))
    np.testing.assert_array_equal(found.history.displacement, motion.displacement)


def test_what_a_program_cannot_report_is_left_out_by_name(tmp_path: Path, motion: History) -> None:
    table = table_of(motion, ["displacement"])
    assert "contact_pressure_Pa is required" in refused(submitted(tmp_path, table))
    found = read_submission(submitted(tmp_path, table, not_reported=["contact_pressure_Pa"]))
    assert list(found.history.columns) == ["displacement"]


@pytest.mark.parametrize(
    ("fields", "said"),
    [
        ({"pack": "99.0"}, f"pack: must be one of {PACK}, this pack and earlier ones"),
        ({"pack": 3.0}, f"pack: must be one of {PACK}, this pack and earlier ones"),
        ({"pack": ...}, "pack: is required, got nothing"),
        ({"format": "other"}, "format: must be 'dda-validation submission', got 'other'"),
        ({"problem": "lokced"}, "problem: must be among locked, opening,"),
        ({"program": " "}, "program: must not be blank, got ' '"),
        ({"version": 3}, "version: must be a valid string, got 3"),
        ({"who": ...}, "who: is required, got nothing"),
        ({"settings": TEMPLATE["settings"]}, "settings: must be filled in, got"),
        ({"wo": "x"}, "wo: unknown key, got 'x'"),
        ({"not_reported": ["pressure"]}, "not_reported: must be among displacement_m, contact_pressure_Pa,"),
        ({"not_reported": ["displacement_m", "contact_pressure_Pa"]}, "not_reported: must leave a column to judge"),
    ],
)  # fmt: skip
def test_a_wrong_field_is_named(
    fields: dict[str, Any], said: str, tmp_path: Path, one: Problem, motion: History
) -> None:
    line = refused(submitted(tmp_path, table_of(motion, one.scene.run.columns), **fields))
    assert re.search(rf"{FILE}:1:\d+: ", line) and said in line


def in_millimetres(rows: Rows) -> Rows:
    return [["time_s", "displacement_mm", "contact_pressure_Pa"], *rows[1:]]


def scaled(column: int, factor: float) -> Callable[[Rows], Rows]:
    def change(rows: Rows) -> Rows:
        return [
            rows[0],
            *([repr(float(x) * factor) if i == column else x for i, x in enumerate(r)] for r in rows[1:]),
        ]

    return change


@pytest.mark.parametrize(
    ("change", "said"),
    [
        (in_millimetres, "1:8: header: must be in metres, as displacement_m, got 'displacement_mm'"),
        (lambda r: [["time", *r[0][1:]], *r[1:]], "1:1: header: must be in seconds, as time_s"),
        (lambda r: [[*r[0][:2], "contact_pressure"], *r[1:]], "1:23: header: must be in pascals, as contact"),
        (lambda r: [[*r[0][:2], "speed"], *r[1:]], "1:23: header: must be among time_s, displacement_m,"),
        (lambda r: [row[:2] for row in r], "1:22: header: contact_pressure_Pa is required, got time_s, displ"),
        (lambda r: [row[1:] for row in r], "1:35: header: time_s is required, got displacement_m, contact_pressure_Pa"),
        (lambda r: [[*row, row[1]] for row in r], "1:8: header: displacement_m must appear once; and in 1 more place"),
        (lambda r: [[";".join(row)] for row in r], "1:7: header: must be separated by commas, got semicolons"),
        (lambda r: [["\t".join(row)] for row in r], "1:7: header: must be separated by commas, got tabs"),
        (lambda r: [["# of my code"], *r], "1:1: must not be a comment, got '# of my code'"),
        (lambda r: [["", *r[0]], *(["7", *row] for row in r[1:])], "1:1: header: must be among time_s, displa"),
        (lambda r: [r[0], ['"0,002"', "0", "0"], *r[2:]], "2:1: time_s: must be a number, got '0,002'; a decimal"),
        (lambda r: [[" ".join(row)] for row in r], "1:7: header: must be separated by commas, got blanks"),
        (lambda r: r[1:], "1:1: header: must be the header time_s,displacement_m,contact_pressure_Pa, got numbers"),
        (lambda r: [[*r[0][:2], "Contact_Pressure_Pa"], *r[1:]], "; did you mean contact_pressure_Pa?"),
        (lambda r: [r[0], *([repr(float(row[0]) + 1e-3), *row[1:]] for row in r[1:])], "all are 0.001 s late"),
        (lambda r: [r[0], ["0.002", "", "0"], *r[2:]], "2:7: displacement_m: must be a number, got nothing"),
        (lambda r: [r[0], ["0.002", "1.5D-03", "0"], *r[2:]], "got '1.5D-03'; an exponent is written with E"),
        (lambda r: [r[0], ["0.002", "np.float64(0.5)", "0"], *r[2:]], "numpy's repr; float(x) of it is a number"),
        (lambda r: [r[0], ["0.002", "1_0", "0"], *r[2:]], "2:7: displacement_m: must be a number, got '1_0'"),
        (lambda r: [r[0], ["0.002", "1e400", "0"], *r[2:]], "2:7: displacement_m: must be a finite number, got 1e400"),
        (lambda r: [r[0], ["0.002", "1e308", "0"], *r[2:]], "must be at most 1e+100 in size, got 1e308"),
        (lambda r: [*r, *r[1:]], "52:1: time_s: must have 50 rows, 0.002 s apart, got 52 or more"),
        (lambda r: [r[0], *r[:0:-1]], "2:1: time_s: must be 0.002, got 0.1"),
        (lambda r: r[:-1], "got 49; t = 0.1 s is the first that is missing"),
        (lambda r: [r[0], ["0", "0", "0"], *r[1:]], "got 51; the state at t = 0 is left out"),
        (lambda r: [r[0], *r[2:], r[-1]], "2:1: time_s: must be 0.002, got 0.004"),
        (scaled(0, 1e3), "2:1: time_s: must be 0.002, got 2; milliseconds?"),
        (lambda r: [*r[:3], [r[3][0], "nan", "0"], *r[4:]], "4:7: displacement_m: must be a finite number, got nan"),
        (lambda r: [*r[:3], [r[3][0], "-", r[3][2]], *r[4:]], "4:7: displacement_m: must be a number, got '-'"),
        (lambda r: [*r[:3], r[3][:2], *r[4:]], "4:28: must have 3 cells, got 2"),
        (lambda r: r[:1], "time_s: must have 50 rows"),
        (lambda r: [], "must be a table of numbers under a header, got an empty file"),
        (scaled(1, 1e3), "1:8: displacement_m: wrong units: it is 1000 times what is expected in SI, mm?"),
        (scaled(2, 1e-6), "1:23: contact_pressure_Pa: wrong units: it is 1e-06 times what is expected in SI, MPa?"),
        (scaled(1, -1.0), "1:8: displacement_m: wrong sign: it is the negative of what is expected"),
    ],
)  # fmt: skip
def test_a_wrong_table_is_named(
    change: Callable[[Rows], Rows], said: str, tmp_path: Path, one: Problem, motion: History
) -> None:
    table = text_of(change(rows_of(table_of(motion, one.scene.run.columns))))
    line = refused(submitted(tmp_path, table))
    assert "answer.csv:" in line and said in line


def of_a_spreadsheet(rows: Rows) -> str:
    """Return a table as spreadsheets write it: a mark in front, CR LF, empty cells and rows at the ends."""
    return "\ufeff" + "\r\n".join(",".join([*row, "", ""]) for row in [*rows, ["", "", ""]])


def in_single_precision(rows: Rows) -> str:
    return text_of([rows[0], *([repr(float(np.float32(row[0]))), *row[1:]] for row in rows[1:])])


@pytest.mark.parametrize("written", [of_a_spreadsheet, in_single_precision])
def test_what_other_programs_write_is_read(
    written: Callable[[Rows], str], tmp_path: Path, one: Problem, motion: History
) -> None:
    place = submitted(tmp_path, written(rows_of(table_of(motion, one.scene.run.columns))))
    (place / "._answer.csv").write_bytes(b"\0")  # which a system lays beside a file
    found = read_submission(place)
    np.testing.assert_array_equal(found.history.displacement, motion.displacement)
    np.testing.assert_array_equal(found.history.time, motion.time)


def test_a_key_that_stands_twice_is_refused(tmp_path: Path, one: Problem, motion: History) -> None:
    place = submitted(tmp_path, table_of(motion, one.scene.run.columns))
    stated = json.dumps(STATED)
    (place / FILE).write_text(stated.replace('{"format"', '{"pack": "1.0", "format"'))
    assert f"{FILE}:1:56: pack: must appear once" in refused(place)
    (place / FILE).write_text(stated.replace("}", ', "not_reported": "time_s"}'))
    assert "not_reported: must be a list, got 'time_s'" in refused(place)


def test_files_that_are_missing_or_no_such_files(tmp_path: Path, one: Problem, motion: History) -> None:
    assert "must be a directory" in refused(tmp_path / "none")
    assert f"{FILE}: is required, got no such file" in refused(tmp_path)
    (tmp_path / FILE).write_text("[1]")
    assert "must be an object, got list" in refused(tmp_path)
    (tmp_path / FILE).write_text("{")
    assert f"{FILE}:1:2: must be JSON: " in refused(tmp_path)
    place = submitted(tmp_path, table_of(motion, one.scene.run.columns))
    (place / "second.csv").write_text("")
    assert f"must hold one CSV file beside {FILE}, got answer.csv, second.csv" in refused(place)
    (place / "second.csv").unlink()
    (place / "answer.csv").unlink()
    assert "got none" in refused(place)


def test_the_callers_own_problem(tmp_path: Path) -> None:
    scene = load_scene("field-locked").with_values({"contact.stiffness": 2e9}).model_copy(update={"name": "mine"})
    own = problem_of(scene)
    place = submitted(tmp_path, table_of(exact(scene, own.truth), scene.run.columns), problem="mine")
    assert read_submission(place, own).problem is own
    assert "problem: must be among locked" in refused(place)
    assert "problem: must be 'mine', the scene's name, got 'locked'" in refused(
        submitted(tmp_path, "", problem="locked"), own
    )


def test_a_column_of_a_wave_names_its_height_and_unit(tmp_path: Path) -> None:
    one = problem("column")
    motion = exact(one.scene, one.truth)
    table = table_of(motion, one.scene.run.columns)
    assert rows_of(table)[0] == [TIME, united("displacement_1"), united("displacement_2")]
    read_submission(submitted(tmp_path, table, problem="column"))
    wrong = table.replace("displacement_2_m", "displacement_2_cm")
    assert "header: must be in metres, as displacement_2_m, got 'displacement_2_cm'" in refused(
        submitted(tmp_path, wrong, problem="column")
    )
