"""A history that another program wrote as a table: columns by their names, in SI, every defect with its place."""

from __future__ import annotations

from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path

import numpy as np

from validation.errors import InputError
from validation.runs.defects import Defects, Place
from validation.runs.history import Array, History
from validation.runs.tables import Cell, Row, meant, number, read_text, rows_of
from validation.runs.units import factors_of, named, recognised, theirs_of
from validation.scenes.unknown import did_you_mean

LARGEST_FILE = 100_000_000  # bytes
LARGEST = 1e100  # of a value in SI units; the squares of larger ones overflow
SAME_INSTANT = 1e-3  # of a step: times are often printed with few digits
TIME = "time"
NO_ADVICE: Mapping[str, str] = {}


@dataclass(frozen=True)
class HeaderNames:
    """What a table calls columns, and factors by which its numbers become SI where its names do not say so.

    A column is called by its header, in any case where that is not another's, or by its number from 1 on.
    """

    theirs: Mapping[str, str] = field(default_factory=dict)
    factors: Mapping[str, float] = field(default_factory=dict)

    @classmethod
    def typed(cls, columns: str | None, scale: str | None, ours: Collection[str]) -> HeaderNames:
        """Return what the options ``--columns`` and ``--scale`` say of columns of ours."""
        return cls(theirs_of(columns, ours), factors_of(scale, ours))

    def recognised(self, texts: Sequence[str], known: Mapping[str, str]) -> list[tuple[str, float] | None]:
        """Return which of the known columns each header names, and the factor to SI; None where it names none."""
        named_by_place = {_place(theirs, texts): column for column, theirs in self.theirs.items()}
        others = {column: unit for column, unit in known.items() if column not in self.theirs}
        found: list[tuple[str, float] | None] = []
        for i, text in enumerate(texts):
            one = (named_by_place[i], 1.0) if i in named_by_place else recognised(text, others)
            found.append(None if one is None else (one[0], one[1] * self.factors.get(one[0], 1.0)))
        return found


AS_NAMED = HeaderNames()


def _place(theirs: str, texts: Sequence[str]) -> int | None:
    """Return the index of a column by its header or its number, None where there is none."""
    folded = [text.casefold() for text in texts]
    numbers = [str(i + 1) for i in range(len(texts))]
    ways = ((theirs, texts), (theirs.casefold(), folded), (theirs, numbers))
    return next((list(names).index(name) for name, names in ways if name in names), None)


@dataclass(frozen=True, eq=False)
class Columns:
    """Columns of a table by our names, with the cells of its header and those of its times."""

    numbers: Mapping[str, Array]  # as in the file
    factors: Mapping[str, float]  # by which they become SI
    header: Mapping[str, Cell]
    times: Sequence[Cell]


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
    absent: Mapping[str, str] = NO_ADVICE,
    text: str | None = None,
    header: HeaderNames = AS_NAMED,
) -> HistoryTable | None:
    """Return the history of a table; None where it has defects, or where it is blank.

    It has to have its rows at the instants [s]; a row at t = 0 is left out. Text is a table that a program has printed,
    of which the path is the name. The rest is as in `columns_of`.
    """
    before = len(defects)
    try:
        # a header and at most so many rows and three: too many in any case, so that more are not read
        rows = rows_of(read_text(path, LARGEST_FILE) if text is None else text, len(instants) + 4)
    except OSError as error:
        defects.add(Place(path), f"cannot be read: {error.strerror}")
        return None
    except InputError as error:
        defects.take(error)
        return None
    table = columns_of(path, rows, units, required, defects, absent, header)
    if table is None:
        return None
    columns = {column: table.factors[column] * numbers for column, numbers in table.numbers.items()}
    cells = table.times
    if len(cells) and columns[TIME][0] == 0:
        columns = {column: numbers[1:] for column, numbers in columns.items()}
        cells = cells[1:]
    times = columns.pop(TIME)
    _check_times(path, table.header[TIME], cells, times, instants, defects)
    return None if len(defects) > before else HistoryTable(History(instants, columns), table.header)


def columns_of(
    path: Path,
    rows: Sequence[Row],
    units: Mapping[str, str],
    required: Collection[str],
    defects: Defects,
    absent: Mapping[str, str] = NO_ADVICE,
    names: HeaderNames = AS_NAMED,
) -> Columns | None:
    """Return the time and the known columns of rows under a header; None where they have defects, or are blank.

    Columns are known that have a unit (SI); those of other names are left out. Without a header all that are required
    have to be called by their numbers. `absent` is what to do about columns that are not there.
    """
    if not rows:
        defects.add(Place(path), "must be a table of numbers under a header", value="an empty file")
        return None
    before = len(defects)
    known = {TIME: "s"} | dict(units)
    header, body = rows[0], rows[1:]
    has_header = any(number(cell.text) is None for cell in header)
    if not has_header:
        header, body = [replace(cell, text=str(i + 1)) for i, cell in enumerate(header)], rows
    found = names.recognised([cell.text for cell in header], known)
    places: dict[str, int] = {}
    factors: dict[str, float] = {}
    for i, one in enumerate(found):
        if one is None:
            continue
        column, factor = one
        if column in places:
            place = Place(path, header[i].line, header[i].column)
            defects.add(place, f"{header[i].text} must appear once", field="header")
        places[column] = i
        factors[column] = factor
    is_blank = not any(cell.text for row in body for cell in row[1:])
    if TIME in places and len(header) > 1 and body and is_blank:
        return None
    missing = [column for column in (TIME, *required) if column not in places]
    called = {column: named(column, unit) for column, unit in known.items()}
    if missing and not has_header:
        rule = f"must be the header {','.join(called.values())}, or columns called by their numbers"
        defects.add(Place(path, header[0].line, 1), rule, field="header", value="numbers")
    for column in missing if has_header else ():
        _add_missing(path, header, found, called[column], absent.get(column), defects)
    if len(defects) > before:
        return None
    columns = [column for column in known if column in places]
    numbers = _numbers(path, header, body, [places[column] for column in columns], defects)
    if len(defects) > before:
        return None
    cells = {column: header[places[column]] for column in columns}
    times = [row[places[TIME]] for row in body]
    return Columns(dict(zip(columns, numbers, strict=True)), factors, cells, times)


def _add_missing(
    path: Path,
    header: Row,
    found: Sequence[tuple[str, float] | None],
    called: str,
    absent: str | None,
    defects: Defects,
) -> None:
    """Add that a column is missing, at the header that is meant for it, or behind all of them."""
    rule = f"{called} is required"
    for cell, one in zip(header, found, strict=True):
        advice = did_you_mean(cell.text.lower(), [called])
        if one is None and advice is not None:
            place = Place(path, cell.line, cell.column)
            defects.add(place, rule, field="header", value=repr(cell.text), advice=advice)
            return
    listed = ", ".join(cell.text for cell in header)
    defects.add(Place(path, header[-1].line, header[-1].end), rule, field="header", value=listed, advice=absent)


def _numbers(path: Path, header: Row, body: Sequence[Row], places: Sequence[int], defects: Defects) -> Array:
    """Return the values at some places of all rows, (places, rows); what is no number is added to the defects."""
    table = np.full((len(places), len(body)), np.nan)
    for i, row in enumerate(body):
        if len(row) != len(header):
            extra = row[min(len(row), len(header)) - 1]
            advice = "a decimal comma?" if len(row) > len(header) else None
            place = Place(path, extra.line, extra.end)
            defects.add(place, f"must have {len(header)} cells", value=len(row), advice=advice)
            continue
        for j, at in enumerate(places):
            cell = row[at]
            value = number(cell.text)
            field = header[at].text
            place = Place(path, cell.line, cell.column)
            if value is None:
                stated = repr(cell.text) if cell.text else "nothing"
                defects.add(place, "must be a number", field=field, value=stated, advice=meant(cell.text))
            elif not abs(value) <= LARGEST:
                rule = f"must be a finite number of at most {LARGEST:g} in size"
                defects.add(place, rule, field=field, value=cell.text)
            else:
                table[j, i] = value
    return table


def _check_times(
    path: Path, header: Cell, cells: Sequence[Cell], times: Array, instants: Array, defects: Defects
) -> None:
    step = float(instants[0])
    common = min(len(times), len(instants))
    off = np.flatnonzero(np.abs(times[:common] - instants[:common]) > SAME_INSTANT * step)
    row = int(off[0]) if len(off) else common  # the first that is wrong, or the first too many, or the one behind all
    cell = cells[min(row, len(cells) - 1)] if cells else header
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
