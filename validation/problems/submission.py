"""A submission: a directory with one table and `submission.json`, checked field by field."""

from __future__ import annotations

import csv
import difflib
import json
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from functools import partial
from itertools import islice
from pathlib import Path
from typing import Any

import numpy as np
from pydantic import ValidationError

from validation.errors import InputError
from validation.problems.bands import standard
from validation.problems.data import PACK, SubmissionData, in_names, kind, unit, united
from validation.problems.judge import SAME_INSTANT
from validation.problems.pack import TEMPLATE, TIME
from validation.problems.problem import PROBLEMS, Problem, problem
from validation.runs.history import Array, History
from validation.runs.regular import regular
from validation.scenes.scene import first_defect
from validation.solvers.user import UNITS, factor

FILE = "submission.json"
LARGEST_FILE = 100_000_000  # bytes
LARGEST = 1e100  # of a value in SI units; the squares of larger ones overflow
SEPARATORS = {";": "semicolons", "\t": "tabs", " ": "blanks"}  # that stand where commas belong
ALL_UNITS = {"m": "metres", "Pa": "pascals", "rad": "radians", "s": "seconds", "m/s": "metres per second"}
EXPORT = "dda-validate export-pack DIR writes the problems"


@dataclass(frozen=True, eq=False)
class Submission:
    """What was submitted, read and checked."""

    data: SubmissionData
    problem: Problem
    history: History  # of the columns that are reported


def read_submission(directory: Path, own_problem: Problem | None = None) -> Submission:
    """Read a submission to a problem of the pack, or to one of the caller's own.

    Raises
    ------
    InputError
        A file or a field is missing or wrong; the line names it.
    """
    if not directory.is_dir():
        raise InputError(f"must be a directory with {FILE} and one CSV file", source=directory, advice=EXPORT)
    path = directory / FILE
    data = _data(path)
    if own_problem is None and data.problem not in PROBLEMS:
        near = difflib.get_close_matches(data.problem, PROBLEMS, n=1)
        raise InputError(
            f"must be among {', '.join(PROBLEMS)}",
            source=path,
            field="problem",
            value=repr(data.problem),
            advice=f"did you mean {near[0]}?" if near else None,
        )
    posed = own_problem or problem(data.problem)
    if data.problem != posed.name:
        raise InputError(
            f"must be {posed.name!r}, the scene's name", source=path, field="problem", value=repr(data.problem)
        )
    columns = _reported(path, data, posed.scene.run.columns)
    return Submission(data, posed, _history(_table(directory), posed, columns))


def _data(path: Path) -> SubmissionData:
    stated = _object(path)
    if "pack" in stated and stated["pack"] != PACK:
        rule = f"must be {PACK!r}, the version of this pack"
        raise InputError(rule, source=path, field="pack", value=repr(stated["pack"]), advice=EXPORT)
    try:
        data = SubmissionData.model_validate(stated)
    except ValidationError as error:
        raise first_defect(error, str(path)) from None
    for field in ("program", "version", "settings", "who"):
        if getattr(data, field) == TEMPLATE[field]:
            raise InputError("must be filled in", source=path, field=field, value=repr(getattr(data, field)))
    return data


def _object(path: Path) -> dict[str, Any]:
    try:
        regular(path, LARGEST_FILE)
        content = json.loads(path.read_bytes().decode("utf-8-sig"), object_pairs_hook=_once)
    except InputError:
        raise
    except FileNotFoundError:
        raise InputError(
            "is required", source=path, value="no such file", advice=f"{EXPORT} with one to fill in for each"
        ) from None
    except OSError as error:
        raise InputError(f"cannot be read: {error.strerror}", source=path) from None
    except (ValueError, RecursionError) as error:
        raise InputError(f"must be JSON in UTF-8: {' '.join(str(error).split())}", source=path) from None
    if not isinstance(content, dict):
        raise InputError("must be an object", source=path, value=type(content).__name__)
    return content


def _once(pairs: Sequence[tuple[str, Any]]) -> dict[str, Any]:
    """Return an object of JSON; a key that stands twice would lose its first value."""
    names = [name for name, _ in pairs]
    for name in names:
        if names.count(name) > 1:
            raise ValueError(f"{name!r} must appear once, got it {names.count(name)} times")
    return dict(pairs)


def _reported(path: Path, data: SubmissionData, columns: Sequence[str]) -> list[str]:
    """Return the columns of the history that the table has to hold."""
    names = ", ".join(map(united, columns))
    refused = partial(InputError, source=path, field="not_reported")
    for name in data.not_reported:
        if name not in map(united, columns):
            raise refused(f"must be among {names}", value=repr(name))
    reported = [column for column in columns if united(column) not in data.not_reported]
    if not reported:
        raise refused("must leave a column to judge", value=f"all of {names}")
    return reported


# ---- the table ------------------------------------------------------------------------------------------------------


def _table(directory: Path) -> Path:
    try:  # a name that begins with a point is the system's, not the submitter's
        tables = sorted(p for p in directory.iterdir() if p.suffix.lower() == ".csv" and not p.name.startswith("."))
    except OSError as error:
        raise InputError(f"cannot be read: {error.strerror}", source=directory) from None
    if len(tables) != 1:
        listed = ", ".join(path.name for path in tables) or "none"
        raise InputError(f"must hold one CSV file beside {FILE}", source=directory, value=listed)
    return tables[0]


def _history(path: Path, posed: Problem, columns: Sequence[str]) -> History:
    names, rows = _read(path, posed.scene.time.steps + 2)
    _check_header(path, names, posed, columns)
    motion = standard(posed).exact
    if len(rows) > len(motion.time) + 1:  # too many in any case, so that their numbers are not read
        raise _miscounted(path, motion.time, f"{len(motion.time) + 2} or more")
    numbers = [_numbers(path, names, number, row) for number, row in enumerate(rows, start=1)]
    values = dict(zip(names, np.array(numbers).reshape(len(numbers), len(names)).T, strict=True))
    _check_times(path, values[TIME], motion.time)
    history = History(motion.time, {column: values[united(column)] for column in columns})
    for column in columns:
        plain = kind(column)[0]
        if plain in UNITS and (
            other_unit := factor(plain, history.columns[column], motion.columns[column], posed.scene)
        ):
            raise InputError(other_unit.replace(plain, "it", 1), source=path, field=united(column))
    return history


def _read(path: Path, most: int) -> tuple[list[str], list[list[str]]]:
    """Return the names of a table and its first rows, at most so many, in words."""
    try:
        regular(path, LARGEST_FILE)
        with path.open(encoding="utf-8-sig", newline="") as stream:
            rows = list(islice(_filled(csv.reader(stream)), most + 1))
    except OSError as error:
        raise InputError(f"cannot be read: {error.strerror}", source=path) from None
    except (UnicodeDecodeError, csv.Error) as error:
        raise InputError(f"must be a CSV table in UTF-8: {error}", source=path) from None
    if not rows:
        raise InputError("must be a table of numbers under a header", source=path, value="an empty file")
    return rows[0], rows[1:]


def _filled(rows: Iterator[list[str]]) -> Iterator[list[str]]:
    """Yield rows without the empty cells at their ends, which spreadsheets leave, and no empty row."""
    for row in rows:
        cells = [cell.strip() for cell in row]
        while cells and not cells[-1]:
            cells.pop()
        if cells:
            yield cells


def _numbers(path: Path, names: Sequence[str], number: int, row: Sequence[str]) -> list[float]:
    if len(row) != len(names):
        raise InputError(f"row {number}: must have {len(names)} values", source=path, value=len(row))
    return [_number(path, f"row {number}: {name}", cell) for name, cell in zip(names, row, strict=True)]


def _number(path: Path, field: str, cell: str) -> float:
    refused = partial(InputError, source=path, field=field)
    try:
        if "_" in cell or not cell.isascii():  # Python's own ways to write a number
            raise ValueError
        value = float(cell)
    except ValueError:
        advice = "a decimal comma?" if cell.count(",") == 1 else None
        raise refused("must be a number", value=repr(cell), advice=advice) from None
    if not np.isfinite(value):
        raise refused("must be a finite number", value=cell)
    if abs(value) > LARGEST:
        raise refused(f"must be at most {LARGEST:g} in size", value=cell)
    return value


def _check_header(path: Path, names: Sequence[str], posed: Problem, columns: Sequence[str]) -> None:
    unit_by_name = {TIME: "s"} | {united(column): unit(column) for column in columns}
    refused = partial(InputError, source=path, field="header")
    for mark, separator in SEPARATORS.items():
        if TIME in names[0].split(mark)[:-1]:
            raise refused("must be separated by commas", value=f"{separator}: {names[0]!r}")
    for place, name in enumerate(names, start=1):
        if not name:
            raise refused(f"column {place}: must be among {', '.join(unit_by_name)}", value="no name")
        if name not in unit_by_name:
            raise refused(f"{name}: {_rule(name, unit_by_name, posed)}", value=repr(name))
        if names.count(name) > 1:
            raise refused(f"{name}: must appear once", value=f"it {names.count(name)} times")
    for name in unit_by_name:
        if name not in names:
            advice = None if name == TIME else f"not_reported in {FILE} is for what the program cannot report"
            raise refused(f"{name}: is required", value=", ".join(names), advice=advice)


def _rule(name: str, unit_by_name: dict[str, str], posed: Problem) -> str:
    """Return what is wrong with a name: its unit, or all of it."""
    for united_name, its_unit in unit_by_name.items():
        plain = united_name.removesuffix(f"_{in_names(its_unit)}")
        other_unit = name.removeprefix(f"{plain}_").replace("_", "")
        if name == plain or (name.startswith(f"{plain}_") and other_unit.isalpha()):
            return f"must be in {ALL_UNITS[its_unit]}, as {united_name}"
    if name in map(united, posed.scene.run.columns):
        return f"must not stand in the table and in not_reported of {FILE}"
    return f"must be among {', '.join(unit_by_name)}"


def _check_times(path: Path, times: Array, instants: Array) -> None:
    step = float(instants[0])
    if len(times) != len(instants):
        starts_at_zero = len(times) == len(instants) + 1 and times[0] == 0
        advice = "the state at t = 0 is left out" if starts_at_zero else None
        raise _miscounted(path, instants, str(len(times)), advice)
    off = np.flatnonzero(np.abs(times - instants) > SAME_INSTANT * step)
    if len(off):
        n = int(off[0])
        close = np.allclose(times, 1e3 * instants, rtol=1e-6, atol=0)
        raise InputError(
            f"must be {instants[n]:.9g}",
            source=path,
            field=f"row {n + 1}: {TIME}",
            value=f"{times[n]:.9g}",
            advice="milliseconds?" if close else None,
        )


def _miscounted(path: Path, instants: Array, count: str, advice: str | None = None) -> InputError:
    rule = f"must have {len(instants)} rows, {float(instants[0]):g} s apart"
    return InputError(rule, source=path, field=TIME, value=count, advice=advice)
