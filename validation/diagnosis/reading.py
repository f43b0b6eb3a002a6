"""Histories of other programs: tables with any header, and the measured-point file of ntdda."""

from __future__ import annotations

import math
import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import partial
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from validation.diagnosis.constants import SEEN
from validation.diagnosis.fits.bar import last_digits
from validation.errors import InputError
from validation.metrics.values import largest
from validation.runs.columns import unit_of
from validation.runs.defects import Defects
from validation.runs.history import DISPLACEMENT, PRESSURE, Array
from validation.runs.tables import read_text, rows_of
from validation.solvers.history_table import AS_NAMED, LARGEST_FILE, HeaderNames, columns_of

SIDEWAYS = "horizontal_displacement"  # m, towards +x
FIELDS = {DISPLACEMENT: "displacement", PRESSURE: "pressure", SIDEWAYS: "sideways"}  # of columns in `Foreign`
OURS = ("time", *FIELDS)
NTDDA = (
    "step",
    "time",
    "dt",
    "x",
    "y",
    "displacement",
    "vx",
    "vy",
)  # given: of the nine columns, the last one the speed
LEAST_ROWS = 4  # of a history that is judged
MOST_STEPS = 10_000  # every explanation steps through all of them: a minute or two, and 200 MB
_POINT = re.compile(r"(measpoint\d+)\s*=\s*\[([^\]]*)")


@dataclass(frozen=True, eq=False)
class Foreign:
    """A history of another program in SI units, from the first row after t = 0 on.

    Columns have one value a recorded row, None if not given; `steps` [s] are the program's own time steps where it
    states them. The roundings are the units of the last printed digit of each value of a column, where they are not to
    be seen from the values. `header` is what was typed of the file's own names, and of factors to SI.
    """

    time: Array  # [s]
    displacement: Array  # upwards [m]
    pressure: Array | None = None  # [Pa]
    steps: Array | None = None
    notes: tuple[str, ...] = ()
    sideways: Array | None = None  # horizontal displacement [m]
    roundings: Mapping[str, Array] = field(default_factory=dict)  # by our names, in units of the columns
    header: HeaderNames = AS_NAMED

    def column(self, name: str) -> Array | None:
        """Return a column by our name."""
        values: Array | None = getattr(self, FIELDS[name])
        return values


def read(path: Path, header: HeaderNames = AS_NAMED) -> Foreign:
    """Read a history: a measured-point file of ntdda, or a table.

    Parameters
    ----------
    path
        A table may be separated by commas, semicolons, tabs or blanks, with comments after ``#`` or ``%``.
    header
        What a table calls our columns; for a measured-point file ``displacement`` is the point, ``measpoint2``. The
        factors make SI units of them, displacement positive upwards.

    Raises
    ------
    InputError
        The file cannot be read, or is no such history.
    """
    try:
        text = read_text(path, LARGEST_FILE).replace("\0", "")
    except OSError as error:
        raise InputError(f"cannot be read: {error.strerror}", source=path) from None
    if _POINT.search(text):
        columns, factors = _measured_point(text, path, header), header.factors
    else:
        columns, factors = _columns(text, path, {name: unit_of(name) for name in FIELDS}, [DISPLACEMENT], header)
    keep = _after_rest(columns["time"] * factors.get("time", 1.0), path)
    columns = {name: values[keep] for name, values in columns.items()}
    notes = [] if PRESSURE in columns else ["no contact pressure in the file: only the displacement is judged"]
    if not np.all(keep):
        notes.append("the row at t = 0 is ignored")
    si = {name: values * factors.get(name, 1.0) for name, values in columns.items()}
    roundings = {name: last_digits(columns[name]) * abs(factors.get(name, 1.0)) for name in FIELDS if name in columns}
    ours = {place: si[name] for name, place in FIELDS.items() if name in si}
    return Foreign(si["time"], **ours, steps=si.get("dt"), notes=tuple(notes), roundings=roundings, header=header)


def _columns(
    text: str, path: Path, units: Mapping[str, str], required: Sequence[str], header: HeaderNames
) -> tuple[Mapping[str, Array], Mapping[str, float]]:
    """Return known columns of rows as in the file, and the factors by which they become SI."""
    rows = rows_of(text)
    if len(rows) > MOST_STEPS + 2:  # a header and the row at t = 0; more would take hours to judge
        advice = "cut it, or keep every tenth row"
        raise InputError(f"must hold at most {MOST_STEPS} rows", source=path, value=len(rows), advice=advice)
    defects = Defects()
    advice_by_name = {name: f"name it with --columns {name}=NAME" for name in OURS}
    table = columns_of(path, rows, units, required, defects, advice_by_name, header)
    defects.check()
    if table is None:
        raise InputError("must hold a history", source=path, value="times only")
    return table.numbers, table.factors


def _measured_point(text: str, path: Path, header: HeaderNames) -> Mapping[str, Array]:
    """Return time, displacements and dt of one measured point.

    The file gives the position with seven digits, few of them of the displacement, and the displacement's unsigned size
    with seven. The sign is that of the summed steps (velocity is the step's displacement over dt) or, where rows are
    missing, of the position relative to the start.
    """
    points = {point[1]: point for point in _POINT.finditer(text)}
    name = header.theirs.get(DISPLACEMENT, next(iter(points)))
    if name not in points:
        raise InputError(f"no measured point {name!r}", source=path, advice=f"it has {', '.join(points)}")
    lines_before = "\n" * text.count("\n", 0, points[name].start(2))
    lines = points[name][2].rstrip().split("\n")
    if len(lines[-1].split()) <= len(NTDDA):  # an interrupted run may leave half a last row
        lines.pop()
    by_number = HeaderNames({column: str(i + 1) for i, column in enumerate(NTDDA)})
    columns, _ = _columns(lines_before + "\n".join(lines), path, dict.fromkeys(NTDDA, ""), NTDDA, by_number)
    step, time, dt, x, y, size, vx, vy = (columns[name] for name in NTDDA)
    summed = np.cumsum(vy * dt)
    start = y[0] - math.copysign(size[0], vy[0])
    every = bool(step[0] == 1 and np.all(np.diff(step) == 1))
    moved = np.copysign(size, summed if every else y - start)
    sideways = largest(moved - summed) if every else 0.0
    if sideways > 1e-4 * float(np.max(size)):  # the size holds a horizontal part, too
        moved = summed
    aside = np.cumsum(vx * dt) if every else x - (x[0] - vx[0] * dt[0])
    return {"time": time, DISPLACEMENT: moved, SIDEWAYS: aside} | ({"dt": dt} if every else {})


def _after_rest(time: Array, path: Path) -> NDArray[np.bool_]:
    """Return which rows are after t = 0; their times have to increase."""
    refused = partial(InputError, source=path, field="time")
    later = np.diff(time) > 0
    if not np.all(later):
        row = int(np.argmin(later)) + 2
        raise refused("must increase from row to row", value=f"{time[row - 1]:g} in row {row}")
    if len(time) and time[0] < 0:
        raise refused("must not be negative", value=f"{time[0]:g} in row 1")
    keep = time > 0
    if np.sum(keep) < LEAST_ROWS:
        raise InputError(f"must hold at least {LEAST_ROWS} rows after t = 0", source=path, value=int(np.sum(keep)))
    return keep


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
        return [replace(inner, factor=slip)]
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
    """Return the power of a thousand that a ratio is, a large one times as many steps as a row shows; or None."""
    power = round(math.log10(ratio) / 3) * 3
    steps = ratio / 10.0**power
    every = max(round(steps), 1) if power > 0 else 1
    return 10.0**power if power and abs(steps / every - 1) < SEEN else None
