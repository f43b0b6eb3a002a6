"""Records of a base's motion: CSV files of time and displacement."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from validation.errors import InputError
from validation.runs.files import read_table
from validation.runs.history import Array
from validation.scenes.scene import Scene

STRAIGHT = 1e-9  # of a path, across it
HEADERS = ("time,x", "time,y", "time,x,y", "time,y,x")


@dataclass(frozen=True)
class Record:
    """Displacement of the base, to be read linearly between its instants and held beyond them; shapes (count,)."""

    time: Array  # increasing instants [s]
    x: Array  # displacement at the instants [m]
    y: Array


def read_columns(path: Path, headers: Sequence[str]) -> dict[str, Array]:
    """Read the columns of a record whose instants increase, under one of some headers.

    Raises
    ------
    InputError
        The file cannot be read, its header is another, its numbers are not finite, or its instants do not increase.
    """
    names, table = read_table(path)
    if ",".join(names) not in headers:
        raise InputError(f"header must be {' or '.join(headers)}", source=path, value=repr(",".join(names)))
    if not np.all(np.isfinite(table)):
        raise InputError("must hold finite numbers", source=path, value="others")
    time = table[:, 0]
    late = np.flatnonzero(np.diff(time) <= 0) + 1
    if len(late):
        value = f"{time[late[0]]:g} after {time[late[0] - 1]:g}"
        raise InputError("time must increase from row to row", source=path, value=value)
    return dict(zip(names, table.T, strict=True))


def read_record(path: Path) -> Record:
    """Read a record of a base's motion; see `read_columns`."""
    columns = read_columns(path, HEADERS)
    time = columns["time"]
    still = np.zeros_like(time)
    return Record(time, columns.get("x", still), columns.get("y", still))


def direction(record: Record) -> tuple[float, float]:
    """Return the unit vector of the straight line that the base moves along, towards +x, or +y where it is steeper.

    Raises InputError where the base does not move along a straight line.
    """
    _, sizes, lines = np.linalg.svd(np.column_stack([record.x, record.y]), full_matrices=False)
    if sizes[0] == 0:
        raise InputError("must move for a response to it", field="load.base_motion", value="a base at rest")
    if len(sizes) > 1 and sizes[1] > STRAIGHT * sizes[0]:
        raise InputError(
            "must run along one straight line for a response to it", field="load.base_motion", value="another path"
        )
    line = np.where(np.abs(lines[0]) > STRAIGHT, lines[0], 0.0)
    x, y = (line * np.sign(line[np.argmax(np.abs(line))])).tolist()
    return x + 0.0, y + 0.0


def base_direction(scene: Scene) -> tuple[float, float] | None:
    """Return the direction that a scene's base moves along, or None where it is fixed."""
    record = base_record(scene)
    return None if record is None else direction(record)


def base_record(scene: Scene) -> Record | None:
    """Return the record that a scene names, or None where its base is fixed."""
    return None if scene.load.base_motion is None else read_record(Path(scene.load.base_motion))
