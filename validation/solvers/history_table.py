"""A history that another program wrote as a table: columns by their names, in SI, every defect with its place."""

from __future__ import annotations

from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np

from validation.errors import InputError
from validation.runs.defects import Defects, Place
from validation.runs.history import Array, History
from validation.runs.tables import Cell, Row, meant, number, read_text, rows_of
from validation.runs.units import named, recognised
from validation.scenes.unknown import did_you_mean

LARGEST_FILE = 100_000_000  # bytes
LARGEST = 1e100  # of a value in SI units; the squares of larger ones overflow
SAME_INSTANT = 1e-3  # of a step: times are often printed with few digits
TIME = "time"


@dataclass(frozen=True)
class HeaderNames:
    """What a table calls columns, and factors by which its numbers become SI where its names do not say so."""

    theirs: Mapping[str, str] = field(default_factory=dict)
    factors: Mapping[str, float] = field(default_factory=dict)

    def recognised(self, text: str, known: Mapping[str, str]) -> tuple[str, float] | None:
        """Return which of the known columns a header names, and the factor to SI; None where it names none."""
        found = next(((column, 1.0) for column, theirs in self.theirs.items() if theirs == text), None)
        if found is None:
            found = recognised(text, {column: unit for column, unit in known.items() if column not in self.theirs})
        return None if found is None else (found[0], found[1] * self.factors.get(found[0], 1.0))


AS_NAMED = HeaderNames()


@dataclass(frozen=True, eq=False)
class HistoryTable:
    """A history, and the cells of its header by column."""

    history: History
    header: Mapping[str, Cell]


def read_table(
    path: Path,
    instants: Array,
    units: Mapping[str, str],
    required: Collection[str],
    defects: Defects,
    absent: str | None = None,
    text: str | None = None,
    header: HeaderNames = AS_NAMED,
) -> HistoryTable | None:
    """Return the history of a table; None where it has defects, or where it is blank.

    A row at t = 0 is left out, and so are columns of other names where nothing is missing.

    It has to have its rows at the instants [s]. Columns are read that have a unit (SI); `absent` is what to do about a
    column that the program cannot report. Text is a table that a program has printed, of which the path is the name.
    """
    before = len(defects)
    rows = _rows(path, text, len(instants), defects)
    if not rows:
        return None
    cells = rows[0]
    known = {TIME: "s"} | dict(units)
    found = [header.recognised(cell.text, known) for cell in cells]
    timed = any(one is not None and one[0] == TIME for one in found)
    if timed and len(cells) > 1 and len(rows) > 1 and not any(cell.text for row in rows[1:] for cell in row[1:]):
        return None
    places = _places(path, cells, found, known, (TIME, *required), absent, defects)
    if len(defects) > before:
        return None
    values = _numbers(path, rows, [column for column in known if column in places], places, defects)
    if len(defects) > before:
        return None
    factors = {one[0]: one[1] for one in found if one is not None}
    columns = {column: factors[column] * numbers for column, numbers in values.items()}
    body = rows[1:]
    if len(columns[TIME]) and columns[TIME][0] == 0:
        columns = {column: numbers[1:] for column, numbers in columns.items()}
        body = body[1:]
    times = columns.pop(TIME)
    _check_times(path, cells, [row[places[TIME]] for row in body], times, instants, defects)
    if len(defects) > before:
        return None
    return HistoryTable(History(instants, columns), {column: cells[places[column]] for column in columns})


def _rows(path: Path, text: str | None, count: int, defects: Defects) -> list[Row]:
    """Return the header and at most so many rows and three: too many in any case, so that more are not read."""
    try:
        rows = rows_of(read_text(path, LARGEST_FILE) if text is None else text, count + 4)
    except OSError as error:
        defects.add(Place(path), f"cannot be read: {error.strerror}")
        return []
    except InputError as error:
        defects.take(error)
        return []
    if not rows:
        defects.add(Place(path), "must be a table of numbers under a header", value="an empty file")
    return rows


def _places(
    path: Path,
    header: Row,
    found: Sequence[tuple[str, float] | None],
    known: Mapping[str, str],
    required: Collection[str],
    absent: str | None,
    defects: Defects,
) -> dict[str, int]:
    """Return the place of each column in the rows; what is missing, repeated or in a strange unit is a defect."""
    names = {column: named(column, unit) for column, unit in known.items()}
    if all(number(cell.text) is not None for cell in header):
        rule = f"must be the header {','.join(names.values())}"
        defects.add(Place(path, header[0].line, 1), rule, field="header", value="numbers")
        return {}
    places: dict[str, int] = {}
    for i, one in enumerate(found):
        if one is None:
            continue
        if one[0] in places:
            cell = header[i]
            defects.add(Place(path, cell.line, cell.column), f"{cell.text} must appear once", field="header")
        places[one[0]] = i
    missing = [column for column in required if column not in places]
    if not missing:
        return places
    strangers = [cell for cell, one in zip(header, found, strict=True) if one is None and cell.text]
    for cell in strangers:
        advice = did_you_mean(cell.text.lower(), names.values())
        rule = f"must be among {', '.join(names.values())}"
        place = Place(path, cell.line, cell.column)
        defects.add(place, rule, field="header", value=repr(cell.text), advice=advice)
    if not strangers:
        listed = ", ".join(cell.text for cell in header)
        for column in missing:
            advice = None if column == TIME else absent
            place = Place(path, header[-1].line, header[-1].end)
            defects.add(place, f"{names[column]} is required", field="header", value=listed, advice=advice)
    return places


def _numbers(
    path: Path, rows: Sequence[Row], columns: Sequence[str], places: Mapping[str, int], defects: Defects
) -> dict[str, Array]:
    """Return the values of columns; what is no number is added to the defects."""
    header = rows[0]
    table = np.full((len(columns), len(rows) - 1), np.nan)
    for i, row in enumerate(rows[1:]):
        if len(row) != len(header):
            extra = row[min(len(row), len(header)) - 1]
            advice = "a decimal comma?" if len(row) > len(header) else None
            place = Place(path, extra.line, extra.end)
            defects.add(place, f"must have {len(header)} cells", value=len(row), advice=advice)
            continue
        for j, column in enumerate(columns):
            cell = row[places[column]]
            value = number(cell.text)
            field = header[places[column]].text
            place = Place(path, cell.line, cell.column)
            if value is None:
                stated = repr(cell.text) if cell.text else "nothing"
                defects.add(place, "must be a number", field=field, value=stated, advice=meant(cell.text))
            elif not np.isfinite(value):
                defects.add(place, "must be a finite number", field=field, value=cell.text)
            elif abs(value) > LARGEST:
                defects.add(place, f"must be at most {LARGEST:g} in size", field=field, value=cell.text)
            else:
                table[j, i] = value
    return dict(zip(columns, table, strict=True))


def _check_times(
    path: Path, header: Row, cells: Sequence[Cell], times: Array, instants: Array, defects: Defects
) -> None:
    step = float(instants[0])
    common = min(len(times), len(instants))
    off = np.flatnonzero(np.abs(times[:common] - instants[:common]) > SAME_INSTANT * step)
    row = int(off[0]) if len(off) else common  # the first that is wrong, or the first too many, or the one behind all
    cell = cells[min(row, len(cells) - 1)] if cells else header[0]
    place = Place(path, cell.line, cell.column)
    if len(times) != len(instants):
        advice = None
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
