"""The judgement of an answer to a problem: errors of columns against the exact motion, or numbers, in their bands."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from validation.gates.gate import Status
from validation.metrics.pairs import relative_l2
from validation.metrics.values import as_number
from validation.problems.bands import Band, Standard, standard
from validation.problems.numbered import ROUNDING
from validation.problems.problem import Problem
from validation.problems.quantities import Quantity, quantities
from validation.runs.history import Array, History


@dataclass(frozen=True)
class Criterion:
    """A column or a number of an answer that is judged."""

    name: str
    status: Status  # PASS or FAIL, or why it is neither
    # Of a column ||x - exact|| / ||exact|| over the judged rows, of a number the error as a share of its scale [1];
    # infinite where it is not finite or cannot be measured, None if not judged.
    error: float | None
    allowed: float | None  # upper edge of the band of the error, whose lower edge is 0 [1]; None if not judged
    until: float  # instant up to which it is judged [s]
    reason: str  # why the band ends there, or why the column is not judged
    within: float = 0.0  # instant up to which it would pass, were it exact from there on [s]
    datum: str = ""  # of which one per cent sets the band of a column; empty of a number

    @property
    def beside(self) -> float:
        """The error over what is allowed; what is rounding is nothing, so that it decides nothing."""
        error = self.error or 0.0
        if not self.allowed:
            return math.inf if error > ROUNDING else 0.0
        share = error / self.allowed
        return share if share > ROUNDING else 0.0


@dataclass(frozen=True)
class Judgement:
    """The judgement of an answer; it fails where something that it reports fails."""

    problem: str
    criteria: tuple[Criterion, ...]
    quantities: tuple[Quantity, ...] = ()

    @property
    def status(self) -> Status:
        """PASS, PARTIAL or FAIL; `NOT_JUDGED` where it reports nothing that is judged."""
        statuses = [criterion.status for criterion in self.criteria]
        if Status.PASS in statuses and Status.FAIL not in statuses and self.withheld:
            return Status.PARTIAL
        return next((status for status in (Status.FAIL, Status.PASS) if status in statuses), Status.NOT_JUDGED)

    @property
    def withheld(self) -> tuple[str, ...]:
        """What the problem asks for and judges, and the answer does not report."""
        return tuple(criterion.name for criterion in self.criteria if criterion.status is Status.NOT_REPORTED)

    @property
    def verdict(self) -> str:
        """The status, with what it does not speak of."""
        passed = ", ".join(criterion.name for criterion in self.criteria if criterion.status is Status.PASS)
        judged = (Status.PASS, Status.FAIL)
        silent = [
            f"{criterion.name} {criterion.status}" for criterion in self.criteria if criterion.status not in judged
        ]
        if not silent:
            return str(self.status)
        verdicts = {Status.PASS: f"PASS on {passed}", Status.PARTIAL: f"PARTIAL: PASS on {passed}"}
        return "; ".join([verdicts.get(self.status, str(self.status)), *silent])

    @property
    def within(self) -> float:
        """Instant up to which all errors of what it reports are within what is allowed [s]."""
        judged = [criterion.within for criterion in self.criteria if criterion.error is not None]
        return min(judged, default=0.0)

    @property
    def deciding(self) -> Criterion | None:
        """What has the largest error beside its band, None where nothing is judged."""
        judged = [criterion for criterion in self.criteria if criterion.error is not None]
        return max(judged, key=lambda criterion: criterion.beside, default=None)


def judge(problem: Problem, history: History, against: Standard | None = None) -> Judgement:
    """Judge an answer to a problem, given at the steps of the problem's scene.

    What it is held against is computed, once a problem, where it is not at hand.

    Raises
    ------
    InputError
        No exact motion could be computed.
    """
    if problem.numbers:
        return _judged_numbers(problem, history)
    reference = against or standard(problem)
    criteria = tuple(_judged(name, history.columns.get(name), reference) for name in problem.columns)
    return Judgement(problem.name, criteria, quantities(problem, history, reference.exact))


def _judged_numbers(problem: Problem, history: History) -> Judgement:
    """Judge numbers that are measured on an answer: the error of each is a share of its scale."""
    until = problem.scene.time.duration
    answer = history.until(until)
    criteria = []
    numbers = []
    for number in problem.numbers:
        is_reported = True
        try:
            value = number.measure(answer)
        except KeyError:  # of a column that the answer withholds
            value = None
            is_reported = False
        if value is None or not math.isfinite(value):
            if number.optional:
                continue
            value = None
        numbers.append(Quantity(number.name, number.unit, value, number.exact, (number.low, number.high)))
        error = math.inf if value is None else abs(value - number.exact) / number.scale
        status = Status.PASS if value is not None and number.passes(value) else Status.FAIL
        if not is_reported:
            status = Status.NOT_REPORTED
        within = until if status is Status.PASS else 0.0
        allowed = number.allowed(math.inf if value is None else value)
        criteria.append(
            Criterion(number.name, status, error if is_reported else None, allowed, until, number.reason, within)
        )
    return Judgement(problem.name, tuple(criteria), tuple(numbers))


def _judged(name: str, values: Array | None, reference: Standard) -> Criterion:
    band = reference.bands.get(name)
    if band is None:
        return Criterion(name, Status.NOT_JUDGED, None, None, 0.0, _without_band(name, reference))
    if values is None:
        return Criterion(name, Status.NOT_REPORTED, None, band.high, band.until, band.reason, datum=band.datum)
    with np.errstate(all="ignore"):
        error = as_number(relative_l2(values[: band.rows], reference.exact.columns[name][: band.rows]))
    inside = error <= band.high * (1 + ROUNDING)
    status = Status.PASS if inside else Status.FAIL
    within = band.until if inside else _within_until(values, reference.exact, name, band)
    return Criterion(name, status, error, band.high, band.until, band.reason, within, band.datum)


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
