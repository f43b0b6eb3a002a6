"""Histories, outcomes and runs: what every solver gives back."""

from __future__ import annotations

import csv
import enum
import io
import os
import tempfile
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, field
from pathlib import Path
from typing import IO

import numpy as np
from numpy.typing import NDArray

from validation.scene import SceneError

Array = NDArray[np.float64]
DISPLACEMENT, PRESSURE = "displacement", "contact_pressure"


class Outcome(enum.StrEnum):
    """How a run ended; `sentence` says it in words."""

    COMPLETED = "completed"
    OVERFLOW = "overflow"
    UNSTABLE = "unstable as predicted"
    MISPREDICTED = "unstable, not as predicted"
    NOT_A_NUMBER = "not a number"
    WRONG_SHAPE = "wrong shape"
    WRONG_UNITS = "wrong units"
    RAISED = "raised"
    TIMEOUT = "timeout"
    REFUSED = "refused"
    NOT_APPLICABLE = "not applicable"
    NOT_RUN = "not run"

    @property
    def sentence(self) -> str:
        """One sentence for a table or a report."""
        return _SENTENCES[self]


_SENTENCES = {
    Outcome.COMPLETED: "The run reached its last step with finite numbers.",
    Outcome.OVERFLOW: "The numbers left the range of double precision.",
    Outcome.UNSTABLE: "The step lies beyond the limit of the scheme and the numbers grew as predicted.",
    Outcome.MISPREDICTED: "The step lies beyond the limit of the scheme and the numbers grew at another rate.",
    Outcome.NOT_A_NUMBER: "The history holds values that are not numbers.",
    Outcome.WRONG_SHAPE: "The history does not hold one value for each step of the scene.",
    Outcome.WRONG_UNITS: "The history is in other units or has another sign.",
    Outcome.RAISED: "The solver raised an error.",
    Outcome.TIMEOUT: "The solver did not finish within its time limit.",
    Outcome.REFUSED: "The scene asks for what the solver must refuse.",
    Outcome.NOT_APPLICABLE: "The solver does not apply to this scene.",
    Outcome.NOT_RUN: "A part that the solver needs is not installed.",
}


@dataclass(frozen=True)
class History:
    """Columns over time, one value per step from the first step on.

    Attributes
    ----------
    time
        Times of the steps [s], shape (steps,).
    columns
        Column name to values, each of shape (steps,): displacement [m], contact_pressure [Pa], others.
    """

    time: Array
    columns: Mapping[str, Array]

    @property
    def displacement(self) -> Array:
        """Vertical displacement v of the centroid point [m]."""
        return self.columns[DISPLACEMENT]

    @property
    def contact_pressure(self) -> Array:
        """Mean contact pressure [Pa], positive in compression."""
        return self.columns[PRESSURE]

    def until(self, duration: float) -> History:
        """Return the part up to a time [s]; the last step may exceed it by rounding only."""
        keep = self.time <= duration * (1 + 1e-9)
        return History(self.time[keep], {name: values[keep] for name, values in self.columns.items()})


@dataclass(frozen=True)
class Mode:
    """One mode of a discrete model and of its one-step operator.

    Attributes
    ----------
    frequency
        Natural circular frequency w of (K, M) [rad/s].
    share
        Share (phi'F)^2 / (w^2 F'D_static) of the static response [1].
    eigenvalues
        The two eigenvalues of the one-step operator that are not identically zero [1].
    contact_share
        Static contact pressure that the mode carries over the applied pressure [1]; None where not reported.
    """

    frequency: float
    share: float
    eigenvalues: tuple[complex, complex]
    contact_share: float | None = None

    @property
    def spectral_radius(self) -> float:
        """Largest modulus of the eigenvalues [1]."""
        return max(abs(value) for value in self.eigenvalues)


def contact_index(modes: Sequence[Mode]) -> int | None:
    """Index of the contact mode: of the modes after the first axial one, that with most of the contact pressure."""
    if len(modes) < 2 or modes[0].contact_share is None:
        return None
    return 1 + int(np.argmax([abs(mode.contact_share or 0.0) for mode in modes[1:]]))


@dataclass(frozen=True)
class Run:
    """A history with its outcome, its work and its error estimate.

    `work` counts unknowns, nonzeros, factorisations, solves and steps; `seconds` holds setup and stepping [s].
    """

    outcome: Outcome
    history: History | None = None
    work: Mapping[str, int] = field(default_factory=dict)
    seconds: Mapping[str, float] = field(default_factory=dict)
    notes: tuple[str, ...] = ()
    estimate: float | None = None  # estimated relative error of the run's own numerics [1]

    def _finished(self) -> History:
        if self.history is None:
            raise ValueError(f"no history: {self.outcome.sentence} {' '.join(self.notes)}".strip())
        return self.history

    @property
    def time(self) -> Array:
        """Times of the steps [s]."""
        return self._finished().time

    @property
    def displacement(self) -> Array:
        """Vertical displacement v of the centroid point [m]."""
        return self._finished().displacement

    @property
    def contact_pressure(self) -> Array:
        """Mean contact pressure [Pa], positive in compression."""
        return self._finished().contact_pressure


@contextmanager
def atomic_path(path: Path) -> Iterator[Path]:
    """Yield a temporary path of the same ending beside `path`; it takes the name when the block ends well.

    Raises
    ------
    SceneError
        The directory or the file cannot be written.
    """
    temporary = ""
    try:
        handle, temporary = tempfile.mkstemp(dir=path.parent, prefix=f".{path.stem}.", suffix=path.suffix)
        os.close(handle)
        yield Path(temporary)
        os.chmod(temporary, 0o666 & ~_umask())
        os.replace(temporary, path)
    except BaseException as error:
        if temporary:
            Path(temporary).unlink(missing_ok=True)
        if isinstance(error, OSError):
            raise SceneError(f"{path}: cannot be written: {error.strerror}; choose another place") from None
        raise


def write_atomically(path: Path, write: Callable[[IO[bytes]], object]) -> None:
    """Write a file under a temporary name and rename it, so that no half-written file is ever seen.

    Raises
    ------
    SceneError
        The directory or the file cannot be written.
    """
    with atomic_path(path) as temporary, temporary.open("wb") as stream:
        write(stream)


def _umask() -> int:
    mask = os.umask(0)
    os.umask(mask)
    return mask


def write_csv(history: History, path: Path) -> None:
    """Write a history as CSV with full double precision, header ``time,displacement,...``."""
    table = np.column_stack([history.time, *history.columns.values()])
    text = io.StringIO(newline="")
    writer = csv.writer(text, lineterminator="\n")
    writer.writerow(["time", *history.columns])
    writer.writerows([repr(value) for value in row] for row in table.tolist())
    write_atomically(path, lambda stream: stream.write(text.getvalue().encode()))


def read_csv(path: Path) -> History:
    """Read a history that `write_csv` wrote.

    Raises
    ------
    SceneError
        The file cannot be read or is not such a table.
    """
    names, table = read_table(path)
    return History(table[:, 0], dict(zip(names[1:], table.T[1:], strict=True)))


def read_table(path: Path) -> tuple[list[str], Array]:
    """Read a CSV table of numbers under a header that begins with time: names and values, a row a time.

    Raises
    ------
    SceneError
        The file cannot be read or is not such a table.
    """
    try:
        with path.open(encoding="utf-8", newline="") as stream:
            names = [name.strip() for name in next(csv.reader(stream), [])]
            lines = [line for line in stream if line.strip()]
            table = np.atleast_2d(np.loadtxt(lines, delimiter=",")) if lines else np.zeros((0, 0))
    except OSError as error:
        raise SceneError(f"{path}: cannot be read: {error.strerror}") from None
    except (ValueError, UnicodeDecodeError) as error:
        raise SceneError(f"{path}: must be a table of numbers under a header: {error}") from None
    if not names or names[0] != "time" or table.shape[1] != len(names):
        raise SceneError(f"{path}: header must begin with time and name every column, got {','.join(names)!r}")
    return names, table
