"""A history that is to be explained: its rows, what may remain of them, what variants show there."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from validation.diagnosis.constants import UNBOUNDED, WINDOW
from validation.diagnosis.fits.bar import AROUND, Bar, bars_of
from validation.diagnosis.fits.bar import norm as size_of
from validation.diagnosis.stepping import histories
from validation.diagnosis.variant import Rectangle, Variant
from validation.runs.history import Array


def norm(values: Array) -> float:
    """Return the root of the sum of squares, one for zeros throughout."""
    return size_of(values) or 1.0


@dataclass(frozen=True, eq=False)
class Target:
    """Recorded rows of one or two columns that are to be explained.

    Joined rows are those of all columns, one below the other, over their norms: the squares of the recorded ones sum to
    one.
    """

    column: Rectangle
    steps: Array  # every step of the program [s], shape (n,)
    rows: np.ndarray  # indices of the recorded steps
    recorded: Array  # the displacement [m] and, if given, the pressure [Pa], (columns, rows)
    rounding: Array | None = None  # of each of them, seen from the values if not given
    left_out: NDArray[np.bool_] | None = None  # which of them are not to be explained

    @property
    def displacement(self) -> Array:
        """The recorded displacement [m]."""
        return np.asarray(self.recorded[0])

    @property
    def pressure(self) -> Array | None:
        """The recorded pressure, if given [Pa]."""
        return np.asarray(self.recorded[1]) if len(self.recorded) > 1 else None

    @cached_property
    def scales(self) -> Array:
        """By which columns are divided where rows are joined, (columns, 1)."""
        norms = np.array([[norm(values)] for values in self.recorded])
        return norms * math.sqrt(len(norms))

    @property
    def values(self) -> Array:
        """The joined rows of the history."""
        return self.join(self.recorded[..., None])[:, 0]

    def join(self, columns: Array) -> Array:
        """Return columns of histories, (columns, rows, histories), as joined rows, (all rows, histories)."""
        rows = columns / self.scales[..., None]
        if self.left_out is not None:
            rows[self.left_out] = 0.0
        return np.asarray(rows.reshape(-1, rows.shape[-1]))

    def responses(self, variants: Sequence[Variant]) -> Array:
        """Return the variants' histories as joined rows, one column each."""
        if not variants:
            return np.empty((self.recorded.size, 0))
        stepped = histories(self.column, variants, self.steps)
        both = [stepped.displacement[self.rows], stepped.pressure[self.rows]]
        with np.errstate(all="ignore"):  # variants that grow beyond a double are far from any history
            columns = self.join(np.array(both[: len(self.recorded)]))
        return np.nan_to_num(columns, nan=UNBOUNDED).clip(-UNBOUNDED, UNBOUNDED)

    def parts(self, joined: Array) -> Array:
        """Return joined rows as columns in their units, (columns, rows)."""
        return np.asarray(joined.reshape(len(self.recorded), -1) * self.scales)

    @cached_property
    def bars(self) -> list[Bar]:
        """What digits and noise may leave of each column."""
        return bars_of(self.recorded, self.rounding)

    def explained(self, joined: Array) -> bool:
        """Whether nothing but digits and noise remains in every column."""
        return all(bar.holds(part) for bar, part in zip(self.bars, self.parts(joined), strict=True))

    def outlying(self, joined: Array) -> NDArray[np.bool_] | None:
        """Return the rows of each column that stand out of what remains; None where none do, or not as single rows.

        Single rows are few, at most two beside one another, and not the first ones, where any motion begins.
        """
        rows = np.array([bar.outlying(part) for bar, part in zip(self.bars, self.parts(joined), strict=True)])
        most = int(np.max(np.sum(rows, axis=1)))
        if not 0 < most <= max(1, len(self.rows) // WINDOW):
            return None
        if np.any(rows[:, :AROUND]) or np.any(rows[:, 2:] & rows[:, 1:-1] & rows[:, :-2]):
            return None
        return rows

    def inner(self, joined: Array, variant: Variant) -> Array:
        """Return joined rows without those that a shift leaves open: a program may write anything there."""
        late, n = math.ceil(max(abs(variant.shift), abs(variant.late))), len(self.rows)
        if not late or n < WINDOW:
            return joined
        inner_rows = joined.reshape(-1, n).copy()
        inner_rows[:, :late] = 0
        inner_rows[:, n - late :] = 0
        return inner_rows.ravel()

    def deviations(self, joined: Array) -> Array:
        """Return the standard deviation of every row of each column, as `Bar.deviation` has it for a remainder."""
        return np.array([bar.deviation(part) for bar, part in zip(self.bars, self.parts(joined), strict=True)])

    @cached_property
    def floor(self) -> float:
        """Relative L2 that digits, noise and double precision leave by themselves [-]."""
        shares = [float(np.sum((bar.deviation() / bar.norm) ** 2)) for bar in self.bars]
        return math.sqrt(sum(shares) / len(shares))

    def until(self, steps: int) -> Target:
        """Return the rows up to a step, at least a few."""
        length = max(int(np.searchsorted(self.rows, steps)), min(WINDOW, len(self.rows)))
        rounding = None if self.rounding is None else self.rounding[:, :length]
        left_out = None if self.left_out is None else self.left_out[:, :length]
        steps_of_rows = self.steps[: int(self.rows[length - 1]) + 1]
        return Target(self.column, steps_of_rows, self.rows[:length], self.recorded[:, :length], rounding, left_out)
