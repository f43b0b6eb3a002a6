"""The table of an answer, a CSV file: read as a history, every defect with its line and the character there."""

from __future__ import annotations

import io
import re
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from validation.errors import InputError
from validation.problems.bands import standard
from validation.problems.data import in_names, united
from validation.problems.defects import Defects, Place
from validation.problems.judge import SAME_INSTANT
from validation.problems.pack import TIME
from validation.problems.questions import BoxQuestion, Question
from validation.problems.stated import read_text
from validation.runs.columns import split, unit_of
from validation.runs.history import DISPLACEMENT, PRESSURE, Array, History
from validation.scenes.unknown import did_you_mean
from validation.solvers.user import UNITS, factor, force

LARGEST_FILE = 100_000_000  # bytes
FIRST_ROW = 0.3  # relative, of the height of a box: what it may have changed by at the first row
LARGEST = 1e100  # of a value in SI units; the squares of larger ones overflow
SEPARATORS = {";": "semicolons", "\t": "tabs", " ": "blanks"}  # that stand where commas belong
ALL_UNITS = {"m": "metres", "Pa": "pascals", "rad": "radians", "s": "seconds", "m/s": "metres per second"}
CELL = re.compile(r'(\s*"(?:[^"]|"")*"[^,]*|[^,]*)(?:,|$)')
FORTRAN = re.compile(r"[+-]?[\d.]+[dDqQ][+-]?\d+")
OF_NUMPY = re.compile(r"np\.float\d+\(.*\)")
GROUPED = re.compile(r"[+-]?\d{1,3}(?:[ '\u2019_\u00a0]\d{3})+(?:\.\d*)?")
COMMENTS = ("#", "%", "//", "!")


@dataclass(frozen=True)
class Cell:
    """A cell of a table: its text without blanks and quotes, and where it begins in the file."""

    text: str
    line: int
    column: int


Row = Sequence[Cell]


def read_answer(path: Path, problem: Question, columns: Sequence[str], defects: Defects) -> History | None:
    """Return the history of a table; None where it has defects, or where it is blank.

    Parameters
    ----------
    path
        Of the CSV file.
    problem
        The problem that it answers.
    columns
        Columns of the problem that the table has to hold, by their names in histories.
    defects
        Which takes what is wrong.
    """
    before = len(defects)
    rows = _rows(path, len(problem.instants), defects)
    if not rows:
        return None
    names = [cell.text for cell in rows[0]]
    if TIME in names and len(names) > 1 and _is_blank(names, rows[1:]):
        return None
    if not _is_header(path, rows, problem, columns, defects):
        return None
    values = _numbers(path, rows, defects)
    times = values.get(TIME)
    if times is not None and len(defects) == before:
        _check_times(path, rows, times, problem.instants, defects)
    if len(defects) > before:
        return None
    history = History(problem.instants, {column: values[united(column)] for column in columns})
    _check_units(path, rows[0], history, problem, defects)
    return history if len(defects) == before else None


def _rows(path: Path, count: int, defects: Defects) -> list[Row]:
    """Return the rows of a table with cells: the header and at most so many rows and two."""
    try:
        text = read_text(path, LARGEST_FILE)
    except OSError as error:
        defects.add(Place(path), f"cannot be read: {error.strerror}")
        return []
    except InputError as error:
        defects.take(error)
        return []
    rows = []
    for number, line in enumerate(io.StringIO(text, newline=None), start=1):
        cells = _cells(line.rstrip("\n"), number)
        if cells and cells[0].text.startswith(COMMENTS):
            defects.add(Place(path, number, cells[0].column), "must not be a comment", value=repr(cells[0].text))
        elif cells:
            rows.append(cells)
        if len(rows) == count + 3:  # too many in any case, so that their numbers are not read
            break
    if not rows:
        defects.add(Place(path), "must be a table of numbers under a header", value="an empty file")
    return rows


def _cells(line: str, number: int) -> Row:
    """Return the cells of a line, without the empty ones at its end, which spreadsheets leave."""
    cells = []
    for match in CELL.finditer(line):
        text = match[1].strip()
        column = match.start() + len(match[1]) - len(match[1].lstrip()) + 1
        if len(text) > 1 and text[0] == text[-1] == '"':
            text = text[1:-1].replace('""', '"').strip()
        cells.append(Cell(text, number, column))
    while cells and not cells[-1].text:
        cells.pop()
    return cells


def _is_blank(names: Sequence[str], rows: Sequence[Row]) -> bool:
    """Whether a table has instants and nothing else, as the pack's tables to fill in."""
    others = [i for i, name in enumerate(names) if name != TIME]
    return bool(rows) and not any(row[i].text for row in rows for i in others if i < len(row))


# ---- the header -----------------------------------------------------------------------------------------------------


def _is_header(path: Path, rows: Sequence[Row], problem: Question, columns: Sequence[str], defects: Defects) -> bool:
    """Whether the first row names each column once; else its defects are added."""
    before = len(defects)
    header = rows[0]
    names = [cell.text for cell in header]
    unit_by_name = {TIME: "s"} | {united(column): unit_of(column) for column in columns}
    expected = ",".join(unit_by_name)
    first = header[0]
    for mark, separator in SEPARATORS.items():
        if len(first.text.split(mark)) > 1:
            advice = "and decimals by points" if len(rows) > 1 and len(rows[1]) > 1 else None
            place = Place(path, first.line, first.column + first.text.index(mark))
            defects.add(place, "must be separated by commas", field="header", value=separator, advice=advice)
            return False
    if all(_number(name) is not None for name in names):
        defects.add(Place(path, first.line, 1), f"must be the header {expected}", field="header", value="numbers")
        return False
    for cell in header:
        place = Place(path, cell.line, cell.column)
        if cell.text not in unit_by_name:
            rule = _rule(cell.text, unit_by_name, problem)
            advice = did_you_mean(cell.text.lower(), unit_by_name) if "among" in rule else None
            defects.add(place, rule, field="header", value=repr(cell.text), advice=advice)
        elif names.count(cell.text) > 1:
            defects.add(place, f"{cell.text} must appear once", field="header")
    if len(defects) > before:
        return False
    for name in unit_by_name:
        if name not in names:
            advice = None if name == TIME else "not_reported in submission.json is for what the program cannot report"
            place = Place(path, first.line, header[-1].column + len(header[-1].text))
            defects.add(place, f"{name} is required", field="header", value=", ".join(names), advice=advice)
    return len(defects) == before


def _rule(name: str, unit_by_name: dict[str, str], problem: Question) -> str:
    """Return what is wrong with a name: its unit, or all of it."""
    for united_name, its_unit in unit_by_name.items():
        plain = united_name.removesuffix(f"_{in_names(its_unit)}")
        other_unit = name.removeprefix(f"{plain}_").replace("_", "")
        if name == plain or (name.startswith(f"{plain}_") and other_unit.isalpha()):
            return f"must be in {ALL_UNITS[its_unit]}, as {united_name}"
    if name in map(united, problem.columns):
        return "must not stand in the table and in not_reported of submission.json"
    return f"must be among {', '.join(unit_by_name)}"


# ---- the numbers ----------------------------------------------------------------------------------------------------


def _number(text: str) -> float | None:
    """Return the number that a cell holds, None where it holds none; Python's own ways to write one are none."""
    if "_" in text or not text.isascii():
        return None
    try:
        return float(text)
    except ValueError:
        return None


def _numbers(path: Path, rows: Sequence[Row], defects: Defects) -> dict[str, Array]:
    """Return the columns of a table by their names; what is no number is added to the defects."""
    names = [cell.text for cell in rows[0]]
    table = np.full((len(rows) - 1, len(names)), np.nan)
    for i, row in enumerate(rows[1:]):
        if len(row) != len(names):
            extra = row[min(len(row), len(names)) - 1]
            advice = "a decimal comma?" if len(row) > len(names) else None
            place = Place(path, extra.line, extra.column + len(extra.text))
            defects.add(place, f"must have {len(names)} cells", value=len(row), advice=advice)
            continue
        for j, cell in enumerate(row):
            value = _number(cell.text)
            if value is not None and np.isfinite(value) and abs(value) <= LARGEST:
                table[i, j] = value
                continue
            place = Place(path, cell.line, cell.column)
            if value is None:
                stated = repr(cell.text) if cell.text else "nothing"
                defects.add(place, "must be a number", field=names[j], value=stated, advice=_meant(cell.text))
            elif np.isfinite(value):
                defects.add(place, f"must be at most {LARGEST:g} in size", field=names[j], value=cell.text)
            else:
                defects.add(place, "must be a finite number", field=names[j], value=cell.text)
    return dict(zip(names, table.T, strict=True))


def _meant(text: str) -> str | None:
    """Return what was probably meant by a text that is no number."""
    if text.count(",") == 1:
        return "a decimal comma?"
    if FORTRAN.fullmatch(text):
        return "an exponent is written with E"
    if OF_NUMPY.fullmatch(text):
        return "numpy's repr; float(x) of it is a number"
    return "digits are not grouped" if GROUPED.fullmatch(text) else None


# ---- instants and units ---------------------------------------------------------------------------------------------


def _check_times(path: Path, rows: Sequence[Row], times: Array, instants: Array, defects: Defects) -> None:
    step = float(instants[0])
    index = [cell.text for cell in rows[0]].index(TIME)
    cells = [row[index] for row in rows[1:]]
    common = min(len(times), len(instants))
    off = np.flatnonzero(np.abs(times[:common] - instants[:common]) > SAME_INSTANT * step)
    row = int(off[0]) if len(off) else common  # the first that is wrong, or the first too many, or the one behind all
    cell = cells[min(row, len(cells) - 1)] if cells else rows[0][index]
    place = Place(path, cell.line, cell.column)
    if len(times) != len(instants):
        starts_at_zero = len(times) == len(instants) + 1 and times[0] == 0
        advice = "the state at t = 0 is left out" if starts_at_zero else None
        if len(times) < len(instants):
            advice = f"t = {instants[row]:.9g} s is the first that is missing"
        count = f"{len(instants) + 2} or more" if len(times) > len(instants) + 1 else str(len(times))
        rule = f"must have {len(instants)} rows, {step:g} s apart"
        defects.add(place, rule, field=TIME, value=count, advice=advice)
    elif len(off):
        late = float(times[0] - instants[0])
        advice = None
        if np.allclose(times, 1e3 * instants, rtol=1e-6, atol=0):
            advice = "milliseconds?"
        elif np.allclose(times - late, instants, rtol=0, atol=SAME_INSTANT * step):
            advice = f"all are {abs(late):.9g} s {'late' if late > 0 else 'early'}"
        defects.add(place, f"must be {instants[row]:.9g}", field=TIME, value=f"{times[row]:.9g}", advice=advice)


def _check_units(path: Path, header: Row, history: History, problem: Question, defects: Defects) -> None:
    """Add a defect for each column that is the exact one in another unit or of another sign."""
    for column, difference in _differences(history, problem):
        cell = next(cell for cell in header if cell.text == united(column))
        place = Place(path, cell.line, cell.column)
        defects.add(place, difference, field=united(column))


def _differences(history: History, problem: Question) -> Iterator[tuple[str, str]]:
    """Yield the columns that are the exact ones, or begin where they do, in another unit or of another sign."""
    if isinstance(problem, BoxQuestion):
        for column, values in history.columns.items():
            plain, number = split(column)
            start = problem.scene.rigid.starts[int(number) - 1][1] if plain == "y" and problem.scene.rigid else 0.0
            for ratio, other_unit in UNITS[DISPLACEMENT].items():
                if start and abs(values[0] / start / ratio - 1) < FIRST_ROW:
                    rule = f"wrong units: it begins with {ratio:g} times what is expected in SI, {other_unit}?"
                    yield column, rule
        return
    exact = standard(problem).exact
    for column, values in history.columns.items():
        plain = split(column)[0]
        if plain not in UNITS or column not in exact.columns:
            continue
        difference = factor(plain, values, exact.columns[column])
        if difference is None and column == PRESSURE:
            difference = force(problem.scene, history, exact)
        if difference is not None:
            yield column, difference.replace(plain, "it", 1)
