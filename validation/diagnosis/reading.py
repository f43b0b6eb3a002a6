"""Histories of other programs: tables with any header, and the measured-point file of ntdda."""

from __future__ import annotations

import math
import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import partial
from pathlib import Path

import numpy as np

from validation.diagnosis.constants import SEEN
from validation.diagnosis.fits.bar import last_digits
from validation.errors import InputError
from validation.metrics.values import largest
from validation.runs.columns import unit_of
from validation.runs.history import DISPLACEMENT, PRESSURE, Array
from validation.runs.tables import Row, number, read_text, rows_of
from validation.runs.units import factors_of, recognised, theirs_of
from validation.solvers.history_table import LARGEST_FILE

SIDEWAYS = "horizontal_displacement"  # m, towards +x
OURS = ("time", DISPLACEMENT, PRESSURE, SIDEWAYS)
FREE = (PRESSURE, SIDEWAYS)  # columns that a file need not have
NTDDA_COLUMNS = 9  # given: step, time, dt, x, y, cumulative displacement, vx, vy, speed
LEAST_ROWS = 4  # of a history that is judged
LARGEST = 1e100  # given: the squares of larger numbers overflow
MOST_STEPS = 10_000  # every explanation steps through all of them: a minute or two, and 200 MB


@dataclass(frozen=True, eq=False)
class Foreign:
    """A history of another program in SI units, from the first row after t = 0 on.

    Columns have one value a recorded row, None if not given; `steps` [s] are the program's own time steps where it
    states them. The roundings are the units of the last printed digit of each value, None where they are to be seen
    from the values. `names` are the file's own names of our columns, `scale` the factors by which its numbers were
    multiplied.
    """

    time: Array  # [s]
    displacement: Array  # upwards [m]
    pressure: Array | None = None  # [Pa]
    steps: Array | None = None
    notes: tuple[str, ...] = ()
    rounding: Array | None = None  # [m]
    pressure_rounding: Array | None = None  # [Pa]
    sideways: Array | None = None  # horizontal displacement [m]
    sideways_rounding: Array | None = None  # [m]
    names: Mapping[str, str] = field(default_factory=dict)
    scale: Mapping[str, float] = field(default_factory=dict)


def parse_columns(text: str | None) -> dict[str, str]:
    """Return the mapping of ``time=t,displacement=uy``: our column to theirs."""
    return theirs_of(text, OURS)


def parse_scale(text: str | None) -> dict[str, float]:
    """Return the factors of ``displacement=-1e-3``: what their numbers are multiplied by."""
    return factors_of(text, OURS)


def read(path: Path, columns: Mapping[str, str] | None = None, scale: Mapping[str, float] | None = None) -> Foreign:
    """Read a history: a measured-point file of ntdda, or a table under a header.

    Parameters
    ----------
    path
        A table may be separated by commas, semicolons, tabs or blanks, with comments after ``#`` or ``%``.
    columns
        Our column name to theirs; for a measured-point file ``{"displacement": "measpoint2"}`` picks a point.
    scale
        Our column name to the factor that makes it SI units, displacement positive upwards.

    Raises
    ------
    InputError
        The file cannot be read, or is no such history.
    """
    try:
        text = read_text(path, LARGEST_FILE).replace("\0", "")
    except OSError as error:
        raise InputError(f"cannot be read: {error.strerror}", source=path) from None
    columns, scale = columns or {}, scale or {}
    reader = _measured_point if re.search(r"measpoint\d+\s*=\s*\[", text) else _table
    columns_of_file, factors = reader(text, path, columns)
    si = {name: factors.get(name, 1.0) * scale.get(name, 1.0) for name in OURS}
    scaled = {name: values * si[name] for name, values in columns_of_file.items() if name in OURS}
    rounded = {name: last_digits(columns_of_file[name]) * abs(si[name]) for name in OURS[1:] if name in columns_of_file}
    history = _checked(scaled, rounded, columns_of_file.get("dt"), path)
    return replace(history, names=columns, scale=scale)


# ---- tables ----


def _table(text: str, path: Path, columns: Mapping[str, str]) -> tuple[dict[str, Array], dict[str, float]]:
    """Return our columns of a table, and the factors by which those in other units become SI."""
    rows = rows_of(text)
    if not rows:
        raise InputError("must hold a history", source=path, value="an empty file")
    _bounded(len(rows), path)
    header = None if _numbers(rows[0]) else [cell.text for cell in rows.pop(0)]
    names = header or [str(i + 1) for i in range(len(rows[0]) if rows else 0)]
    values = []
    for row_number, row in enumerate(rows, start=1):
        parsed = _numbers(row)
        if parsed is None or len(parsed) != len(names):
            listed = ", ".join(cell.text for cell in row)
            raise InputError(f"row {row_number}: must be {len(names)} numbers", source=path, value=repr(listed[:60]))
        values.append(parsed)
    table = np.array(values, dtype=float).reshape(len(values), len(names))
    columns_of_file = {}
    factors = {}
    for ours in OURS:
        theirs, factor = (columns[ours], 1.0) if ours in columns else _recognised(ours, names)
        place = _place(ours, theirs, names, path)
        if place is not None:
            columns_of_file[ours] = table[:, place]
            factors[ours] = factor
    return columns_of_file, factors


def _recognised(ours: str, names: Sequence[str]) -> tuple[str, float]:
    """Return the header that names a column of ours, perhaps with a unit, and the factor to SI."""
    units = {ours: "s" if ours == "time" else unit_of(ours)}
    for name in names:
        found = recognised(name, units)
        if found is not None:
            return name, found[1]
    return ours, 1.0


def _numbers(row: Row) -> list[float] | None:
    """Return the numbers of a row, None where a cell holds none."""
    values = [number(cell.text) for cell in row]
    return None if None in values else [value for value in values if value is not None]


def _place(ours: str, theirs: str, names: list[str], path: Path) -> int | None:
    """Return the index of a column; None if the pressure is absent and was not asked for."""
    folded = [name.casefold() for name in names]
    if theirs in names:
        return names.index(theirs)
    if theirs.casefold() in folded:
        return folded.index(theirs.casefold())
    if theirs.isdigit() and 1 <= int(theirs) <= len(names):
        return int(theirs) - 1
    if ours in FREE and theirs == ours:
        return None
    raise InputError(
        f"no column {theirs!r} for {ours}; it has {', '.join(names)}",
        source=path,
        advice=f"name it with --columns {ours}=NAME",
    )


# ---- measured points of ntdda ----


def _measured_point(text: str, path: Path, columns: Mapping[str, str]) -> tuple[dict[str, Array], dict[str, float]]:
    """Return time, displacement and dt of one measured point, which are in SI.

    The file gives the position with seven digits, few of them of the displacement, and the displacement's unsigned size
    with seven. The sign is that of the summed steps (velocity is the step's displacement over dt) or, where rows are
    missing, of the position relative to the start.
    """
    points = dict(re.findall(r"(measpoint\d+)\s*=\s*\[([^\]]*)", text))
    name = columns.get(DISPLACEMENT, next(iter(points)))
    if name not in points:
        raise InputError(f"no measured point {name!r}", source=path, advice=f"it has {', '.join(points)}")
    cells = rows_of(points[name])
    _bounded(len(cells), path)
    rows = [_numbers(row) for row in cells]
    full_rows = [row for row in rows if row is not None and len(row) == NTDDA_COLUMNS]
    if not full_rows or len(full_rows) < len(rows) - 1:  # an interrupted run may leave half a last row
        raise InputError(
            f"must hold rows of {NTDDA_COLUMNS} numbers",
            source=path,
            field=name,
            value=f"{len(rows) - len(full_rows)} other rows",
        )
    step, time, dt, x, y, size, vx, vy, _ = np.array(full_rows).T
    summed = np.cumsum(vy * dt)
    start = y[0] - math.copysign(size[0], vy[0])
    every = bool(step[0] == 1 and np.all(np.diff(step) == 1))
    moved = np.copysign(size, summed if every else y - start)
    sideways = largest(moved - summed) if every else 0.0
    if sideways > 1e-4 * float(np.max(size)):  # the size holds a horizontal part, too
        moved = summed
    aside = np.cumsum(vx * dt) if every else x - (x[0] - vx[0] * dt[0])
    return {"time": time, DISPLACEMENT: moved, SIDEWAYS: aside} | ({"dt": dt} if every else {}), {}


def _bounded(rows: int, path: Path) -> None:
    """Refuse a history that would take hours to judge."""
    if rows > MOST_STEPS + 2:  # a header and the row at t = 0
        raise InputError(
            f"must hold at most {MOST_STEPS} rows", source=path, value=rows, advice="cut it, or keep every tenth row"
        )


# ---- checks ----


def _checked(
    columns_of_file: Mapping[str, Array],
    rounded: Mapping[str, Array],
    dt: Array | None,
    path: Path,
) -> Foreign:
    """Return the history without its row at t = 0."""
    refused = partial(InputError, source=path)
    time = columns_of_file["time"]
    pressure = columns_of_file.get(PRESSURE)
    notes = () if pressure is not None else ("no contact pressure in the file: only the displacement is judged",)
    for name, values in columns_of_file.items():
        sound = np.isfinite(values) & (np.abs(values) < LARGEST)
        if not np.all(sound):
            row = int(np.argmin(sound)) + 1
            rule = f"must be finite numbers below {LARGEST:g} in size"
            raise refused(rule, field=name, value=f"{values[row - 1]} in row {row}")
    later = np.diff(time) > 0
    if not np.all(later):
        row = int(np.argmin(later)) + 2
        raise refused("must increase from row to row", field="time", value=f"{time[row - 1]:g} in row {row}")
    if len(time) and time[0] < 0:
        raise refused("must not be negative", field="time", value=f"{time[0]:g} in row 1")
    keep = time > 0
    if np.sum(keep) < LEAST_ROWS:
        raise refused(f"must hold at least {LEAST_ROWS} rows after t = 0", value=int(np.sum(keep)))
    if not np.all(keep):
        notes = (*notes, "the row at t = 0 is ignored")
    return Foreign(
        time[keep],
        columns_of_file[DISPLACEMENT][keep],
        None if pressure is None else pressure[keep],
        None if dt is None else dt[keep],
        notes,
        rounded[DISPLACEMENT][keep],
        None if pressure is None else rounded[PRESSURE][keep],
        *((columns_of_file[SIDEWAYS][keep], rounded[SIDEWAYS][keep]) if SIDEWAYS in columns_of_file else (None, None)),
    )


# ---- time steps ----


@dataclass(frozen=True, eq=False)
class Stepping:
    """The time steps that a program took, and which of them its rows show."""

    steps: Array  # [s]
    rows: np.ndarray  # indices of the steps
    note: str = ""  # what differs from one row a step of the scene
    factor: float = 1.0  # that a slip of the time's unit put in


def steppings(foreign: Foreign, step: float) -> list[Stepping]:
    """Return the ways to read the times of a history of a scene's time step [s], the likeliest first.

    Raises
    ------
    InputError
        The rows are not uniform and lie too many steps apart.
    """
    gaps = np.diff(np.concatenate([[0.0], foreign.time]))
    every = np.arange(len(gaps))
    usual = float(np.median(gaps))
    slip = _unit_slip(usual / step) if foreign.steps is None else None
    if slip:
        inner = steppings(Foreign(foreign.time / slip, foreign.displacement), step)[0]
        note = f"the times are {slip:g} times those of the scene: a unit error"
        return [Stepping(inner.steps, inner.rows, note, slip)]
    if foreign.steps is not None and np.ptp(foreign.steps) > SEEN * usual:
        return [Stepping(foreign.steps, every, "the times are not uniform: the program changed its step")]
    multiples = _multiples(gaps, step)
    if multiples and len(multiples[0].rows) == len(multiples[0].steps):
        return multiples
    return multiples + _own_steps(gaps, usual, step)


def _multiples(gaps: Array, step: float) -> list[Stepping]:
    """Return the reading that rows show some of the scene's steps, if the times allow it."""
    ends = np.cumsum(gaps) / step
    whole = np.rint(ends)
    near = np.all(np.abs(np.diff(ends, prepend=0.0) - np.diff(whole, prepend=0.0)) < SEEN * (1 + gaps / step))
    if not near or whole[0] < 1 or np.any(np.diff(whole) < 1):
        return []
    if whole[-1] > MOST_STEPS:
        if np.ptp(gaps) <= SEEN * gaps[0]:
            return []  # the program's own steps, longer than the scene's
        raise InputError(
            f"must end within {MOST_STEPS} steps of {step:g} s", field="time", value=f"step {whole[-1]:.0f}"
        )
    counts = whole.astype(int)
    every = np.diff(counts, prepend=0)
    kind = (
        f"one row every {every[0]} steps"
        if np.all(every == every[0])
        else "rows for some of the steps, at non-uniform times"
    )
    note = "" if np.all(every == 1) else f"the file has {kind}"
    return [Stepping(np.full(int(counts[-1]), step), counts - 1, note)]


def _own_steps(gaps: Array, usual: float, step: float) -> list[Stepping]:
    """Return the reading that every row is a step of the program's own."""
    if np.all(np.abs(gaps - usual) <= SEEN * usual):
        mean = float(np.mean(gaps))
        note = f"the program's step is {mean:g} s, the scene's {step:g} s: compared at the program's step"
        return [Stepping(np.full(len(gaps), mean), np.arange(len(gaps)), note)]
    first = gaps[0] / usual
    if np.all(np.abs(gaps[1:] - usual) <= SEEN * usual) and first > 1 and abs(first - round(first)) < SEEN:
        inner = _multiples(gaps, usual)
        return [Stepping(s.steps, s.rows, f"the rows begin at step {s.rows[0] + 1}") for s in inner]
    return [Stepping(gaps, np.arange(len(gaps)), "the times are not uniform: each row is taken as one step")]


def _unit_slip(ratio: float) -> float | None:
    """Return the power of a thousand that a ratio is, or None."""
    power = round(math.log10(ratio) / 3) * 3
    return 10.0**power if power and abs(ratio / 10.0**power - 1) < SEEN else None
