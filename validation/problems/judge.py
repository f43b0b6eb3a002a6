"""The judgement of an answer to a problem: the error of each column against the exact motion, in its band."""

from __future__ import annotations

import enum
import math
from dataclasses import dataclass

import numpy as np

from validation.errors import InputError
from validation.metrics.pairs import relative_l2
from validation.problems.bands import Band, Standard, standard
from validation.problems.boxes import measured, problem_posed
from validation.problems.problem import Problem
from validation.problems.quantities import Quantity, quantities
from validation.runs.history import Array, History

ROUNDING = 1e-9  # relative, of an edge: what one per cent of a datum changes is inside
SAME_INSTANT = 1e-3  # of a step: times are often printed with few digits


class Word(enum.StrEnum):
    """What is said of an answer or of one of its columns."""

    PASS = "PASS"
    PARTIAL = "PARTIAL"  # of an answer: what it reports passes, but it withholds a column that the problem asks for
    FAIL = "FAIL"
    NOT_REPORTED = "not reported"
    NOT_JUDGED = "not judged"


@dataclass(frozen=True)
class Column:
    """A column of an answer.

    Attributes
    ----------
    name
        Of the column.
    word
        PASS or FAIL, or why it is neither.
    error
        ||x - exact|| / ||exact|| over the judged rows [1]; infinite where the column is not finite, None if not judged.
    band
        Upper edge of the band, whose lower edge is 0 [1]; None where the column cannot be judged.
    until
        Instant up to which it is judged [s].
    reason
        Why the band ends there, or why the column is not judged.
    within
        Instant up to which its error is within what is allowed [s]: it would pass, were it exact from there on.
    """

    name: str
    word: Word
    error: float | None
    band: float | None
    until: float
    reason: str
    within: float = 0.0


@dataclass(frozen=True)
class Judgement:
    """The judgement of an answer; it fails where a column that it reports fails."""

    problem: str
    columns: tuple[Column, ...]
    quantities: tuple[Quantity, ...] = ()

    @property
    def word(self) -> Word:
        """PASS, PARTIAL or FAIL; `NOT_JUDGED` where it reports no column that is judged."""
        words = [column.word for column in self.columns]
        if Word.PASS in words and Word.FAIL not in words and self.withheld:
            return Word.PARTIAL
        return next((word for word in (Word.FAIL, Word.PASS) if word in words), Word.NOT_JUDGED)

    @property
    def withheld(self) -> tuple[str, ...]:
        """Columns that the problem asks for and judges, and the answer does not report."""
        return tuple(column.name for column in self.columns if column.word is Word.NOT_REPORTED)

    @property
    def verdict(self) -> str:
        """The word, with the columns that it does not speak of."""
        passed = [column.name for column in self.columns if column.word is Word.PASS]
        silent = [f"{column.name} {column.word}" for column in self.columns if column.band is None or _absent(column)]
        if not silent:
            return str(self.word)
        verdicts = {Word.PASS: f"PASS on {', '.join(passed)}", Word.PARTIAL: f"PARTIAL: PASS on {', '.join(passed)}"}
        return "; ".join([verdicts.get(self.word, str(self.word)), *silent])

    @property
    def within(self) -> float:
        """Instant up to which the errors of all columns that it reports are within what is allowed [s]."""
        judged = [column.within for column in self.columns if column.error is not None]
        return min(judged, default=0.0)

    @property
    def deciding(self) -> Column | None:
        """The column whose error is largest beside its band, None where none is judged."""
        judged = [column for column in self.columns if column.error is not None]
        return max(judged, key=lambda column: _beside(column), default=None)


def _absent(column: Column) -> bool:
    return column.word is Word.NOT_REPORTED


def _beside(column: Column) -> float:
    """Return the error over the band."""
    return (column.error or 0.0) / (column.band or math.inf)


def judge(problem: Problem, history: History, against: Standard | None = None) -> Judgement:
    """Judge an answer to a problem.

    Parameters
    ----------
    problem
        The problem.
    history
        The answer, at the steps of the problem's scene.
    against
        The exact motion and the bands, where they are at hand; by default computed, once a problem.

    Raises
    ------
    InputError
        The answer is not at the steps of the scene, or no exact motion could be computed.
    """
    reference = against or standard(problem)
    rows, step = len(reference.exact.time), problem.scene.time.step
    if len(history.time) < rows:
        raise InputError(f"must hold {rows} rows", source=problem.name, field="time", value=len(history.time))
    apart = np.abs(history.time[:rows] - reference.exact.time)
    if not np.all(apart <= SAME_INSTANT * step):
        row = int(np.argmin(apart <= SAME_INSTANT * step))
        expected, stated = reference.exact.time[row], history.time[row]
        raise InputError(
            f"must be {expected:.9g} s in row {row + 1}", source=problem.name, field="time", value=f"{stated:.9g}"
        )
    if problem.scene.rigid is not None:
        return _judged_boxes(problem, history)
    names = problem.scene.run.columns
    columns = tuple(_judged(name, history.columns.get(name), reference) for name in names)
    return Judgement(problem.name, columns, quantities(problem, history, reference.exact))


def _judged_boxes(problem: Problem, history: History) -> Judgement:
    """Judge the numbers of rigid boxes: each stands where a column does, its error as a share of its scale."""
    until = problem.scene.time.duration
    posed = problem_posed(problem.scene)
    answers = measured(posed.quantities(problem.scene), history.until(until))
    columns = []
    numbers = []
    for one in answers:
        if one.optional_and_absent:
            continue
        quantity = one.quantity
        numbers.append(Quantity(quantity.name, quantity.unit, one.value, quantity.exact))
        error, allowed = one.shares
        word = Word(one.word)
        if error is None and word is not Word.NOT_REPORTED:
            error = math.inf
        within = until if word is Word.PASS else 0.0
        columns.append(Column(quantity.name, word, error, allowed, until, quantity.reason, within))
    return Judgement(problem.name, tuple(columns), tuple(numbers))


def _judged(name: str, values: Array | None, reference: Standard) -> Column:
    band = reference.bands.get(name)
    if band is None:
        return Column(name, Word.NOT_JUDGED, None, None, 0.0, _without_band(name, reference))
    if values is None:
        return Column(name, Word.NOT_REPORTED, None, band.high, band.until, band.reason)
    error = error_of(values, reference.exact.columns[name], band)
    inside = error <= band.high * (1 + ROUNDING)
    word = Word.PASS if inside else Word.FAIL
    within = band.until if inside else _within_until(values, reference.exact, name, band)
    return Column(name, word, error, band.high, band.until, band.reason, within)


def _within_until(values: Array, exact: History, name: str, band: Band) -> float:
    """Return the last instant before the error alone of the rows so far is more than is allowed of all [s]."""
    expected = exact.columns[name][: band.rows]
    with np.errstate(all="ignore"):
        so_far = np.sqrt(np.cumsum((values[: band.rows] - expected) ** 2))
    rows = np.flatnonzero(~(so_far <= band.high * np.linalg.norm(expected)))
    return float(exact.time[rows[0] - 1]) if len(rows) and rows[0] else 0.0


def _without_band(name: str, reference: Standard) -> str:
    exact = reference.exact.columns.get(name)
    if exact is None:
        return "no exact motion of this column is known"
    if not np.any(exact):
        return "it does not move in the exact motion, which leaves nothing to divide an error by"
    return "one per cent of the scene's data changes it more than anything could be judged by"


def error_of(values: Array, exact: Array, band: Band) -> float:
    """Return the relative L2 error over the judged rows; infinite where a value is not finite."""
    judged, expected = values[: band.rows], exact[: band.rows]
    if not np.isfinite(judged).all():
        return math.inf
    with np.errstate(over="ignore"):
        error = relative_l2(judged, expected)
    return error if isinstance(error, float) else math.inf
