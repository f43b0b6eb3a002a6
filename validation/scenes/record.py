"""Records of a base's motion: CSV files of time and displacement."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

import numpy as np

from validation.errors import InputError
from validation.runs.files import read_table
from validation.runs.history import Array
from validation.scenes.scene import Scene

HEADERS = (["time", "x"], ["time", "y"], ["time", "x", "y"], ["time", "y", "x"])


@dataclass(frozen=True)
class Record:
    """Displacement of the base, to be read linearly between its instants and held beyond them.

    Attributes
    ----------
    time
        Increasing instants [s], shape (count,).
    x, y
        Displacement at the instants [m], shape (count,).
    """

    time: Array
    x: Array
    y: Array


def read_record(path: Path) -> Record:
    """Read a record.

    Raises
    ------
    InputError
        The file cannot be read, its header is another, or its instants do not increase.
    """
    names, table = read_table(path)
    if names not in HEADERS:
        raise InputError(f"{path}: header must be time,x or time,y or time,x,y, got {','.join(names)!r}")
    columns = dict(zip(names, table.T, strict=True))
    time = columns["time"]
    if not np.all(np.isfinite(table)):
        raise InputError(f"{path}: must hold finite numbers, got others")
    if np.any(np.diff(time) <= 0):
        late = int(np.argmax(np.diff(time) <= 0)) + 1
        raise InputError(f"{path}: time must increase from row to row, got {time[late]:g} after {time[late - 1]:g}")
    still = np.zeros_like(time)
    return Record(time, columns.get("x", still), columns.get("y", still))


def base_record(scene: Scene) -> Record | None:
    """Return the record that a scene names, or None where its base is fixed."""
    return None if scene.load.base_motion is None else read_record(Path(scene.load.base_motion))
