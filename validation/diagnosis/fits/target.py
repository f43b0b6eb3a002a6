"""A history that is to be explained: its rows, what digits and noise may leave of them, what variants show there."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from validation.diagnosis.fits.bar import AROUND, LOST_ROWS, Bar
from validation.diagnosis.fits.bar import norm as size_of
from validation.diagnosis.stepping import histories
from validation.diagnosis.variant import Rectangle, Variant
from validation.runs.history import Array

LEAST_ROWS = 24  # of a history that is fitted in part
CHUNK = 1500  # variants in one pass
ROUNDING = 1e-10  # relative L2 that no recorded history comes below


def norm(values: Array) -> float:
    """Return the root of the sum of squares, one for zeros throughout."""
    return size_of(values) or 1.0


def joined(recorded: tuple[Array, Array | None], displacement: Array, pressure: Array | None) -> Array:
    """Return two columns over the norms of recorded ones, below one another; their own squares sum to one."""
    first = displacement / norm(recorded[0])
    if recorded[1] is None or pressure is None:
        return np.asarray(first)
    return np.concatenate([first, pressure / norm(recorded[1])]) / math.sqrt(2)


@dataclass(frozen=True, eq=False)
class Target:
    """What is to be explained: recorded rows of one or two columns."""

    column: Rectangle
    steps: Array  # every step of the program [s], shape (n,)
    rows: np.ndarray  # indices of the recorded steps
    displacement: Array  # [m], one value a recorded step
    pressure: Array | None = None  # [Pa]
    rounding: Array | None = None  # of the displacement [m], seen from the values if not given
    pressure_rounding: Array | None = None  # [Pa]
    left_out: NDArray[np.bool_] | None = None  # which of the joined rows are not to be explained

    @property
    def recorded(self) -> list[Array]:
        """The displacement and, if given, the pressure."""
        return [self.displacement] if self.pressure is None else [self.displacement, self.pressure]

    @property
    def values(self) -> Array:
        """The columns over their norms, one below the other: its squares sum to one."""
        return self.join(self.displacement, self.pressure)

    def join(self, displacement: Array, pressure: Array | None) -> Array:
        """Return columns of the recorded rows scaled as `values` is, shape (rows, ...) to (all rows, ...)."""
        rows = joined((self.displacement, self.pressure), displacement, pressure)
        if self.left_out is not None:
            rows[self.left_out] = 0.0
        return rows

    def responses(self, variants: Sequence[Variant]) -> Array:
        """Return the variants' histories scaled as `values` is, one column each."""
        columns = [np.empty((len(self.values), 0))]
        for first in range(0, len(variants), CHUNK):
            stepped = histories(self.column, variants[first : first + CHUNK], self.steps)
            with np.errstate(all="ignore"):  # variants that grow beyond what a double holds are far from any history
                columns.append(self.join(stepped.displacement[self.rows], stepped.pressure[self.rows]))
        return np.nan_to_num(np.hstack(columns), nan=1e6, posinf=1e6, neginf=-1e6).clip(-1e6, 1e6)

    def parts(self, joined: Array) -> list[Array]:
        """Return joined rows as those of the displacement and, if given, of the pressure, in their units."""
        if self.pressure is None:
            return [joined * norm(self.displacement)]
        n = len(self.rows)
        scale = math.sqrt(2)
        return [joined[:n] * scale * norm(self.displacement), joined[n:] * scale * norm(self.pressure)]

    @cached_property
    def bars(self) -> list[Bar]:
        """What digits and noise may leave of the displacement and, if given, of the pressure."""
        bars = [Bar.of(self.displacement, self.rounding)]
        return bars if self.pressure is None else [*bars, Bar.of(self.pressure, self.pressure_rounding)]

    def explained(self, joined: Array) -> bool:
        """Whether nothing but digits and noise remains in every column."""
        return all(bar.holds(part) for bar, part in zip(self.bars, self.parts(joined), strict=True))

    def outlying(self, joined: Array) -> NDArray[np.bool_] | None:
        """Return the joined rows that stand out of what remains; None where there are none, or not as single rows.

        Single rows are few, no more than two beside one another, and not the first ones, where any motion begins.
        """
        outlying = [bar.outlying(part) for bar, part in zip(self.bars, self.parts(joined), strict=True)]
        counts = [int(np.sum(rows)) for rows in outlying]
        if not any(counts) or max(counts) > max(1, len(self.rows) // LOST_ROWS):
            return None
        if any(np.any(rows[:AROUND]) or np.any(rows[2:] & rows[1:-1] & rows[:-2]) for rows in outlying):
            return None
        return np.concatenate(outlying)

    def inner(self, joined: Array, variant: Variant) -> Array:
        """Return joined rows without those that a shift leaves open: a program may write anything there."""
        late, n = math.ceil(max(abs(variant.shift), abs(variant.late))), len(self.rows)
        if not late or n < LEAST_ROWS:
            return joined
        inner_rows = joined.copy()
        for start in range(0, len(joined), n):
            inner_rows[start : start + late] = 0
            inner_rows[start + n - late : start + n] = 0
        return inner_rows

    def deviations(self, joined: Array) -> list[Array]:
        """Return the standard deviation of every row of each column, their noise no larger than a remainder has it."""
        return [bar.deviation(part) for bar, part in zip(self.bars, self.parts(joined), strict=True)]

    @cached_property
    def floor(self) -> float:
        """Relative L2 that digits, noise and double precision leave by themselves [-]."""
        shares = [float(np.sum((bar.deviation() / bar.norm) ** 2)) for bar in self.bars]
        return math.sqrt(sum(shares) / len(shares))

    def until(self, steps: int) -> Target:
        """Return the rows up to a step, at least a few."""
        length = max(int(np.searchsorted(self.rows, steps)), min(LEAST_ROWS, len(self.rows)))
        last = int(self.rows[length - 1]) + 1
        pressure, rounding, other = (
            None if c is None else c[:length] for c in (self.pressure, self.rounding, self.pressure_rounding)
        )
        columns = self.displacement[:length], pressure, rounding, other
        left_out = self.left_out
        if left_out is not None:
            left_out = left_out.reshape(-1, len(self.rows))[:, :length].ravel()
        return Target(self.column, self.steps[:last], self.rows[:length], *columns, left_out)
