"""A history beside runs of its scene by `dda`: the scene's own, one thing changed, or not known.

A step of contacts that open or slip is a continuous, piecewise linear function of the state before it: a run depends
continuously on every number of the scene, with kinks where a contact switches, and every switch may enlarge a
difference. Numbers are therefore fitted to the first rows that depart, then to twice as many, up to the horizon behind
which two correct codes need not agree.

What may remain of a row that is explained: one unit of its last digit, half the digits of double precision, and what
the run of a scene with a number larger by 1e-12 leaves of the run itself (`validation.metrics.contact.SHIFT`); of many
rows also noise, which is small, white, and without rows that stand out. A cause is named if that is all that remains up
to the horizon, and if the rows of every other cause, and those of the scene, are clearly beyond it.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property, partial
from typing import Any, ClassVar, TypeAlias

import numpy as np

from validation.diagnosis import evidence, sentences
from validation.diagnosis.answer import Answer, curves, finished
from validation.diagnosis.causes import CAUSES, all_benign
from validation.diagnosis.constants import (
    ARITHMETIC,
    CHANGE,
    CLEARLY,
    FAINT,
    FARTHER,
    MOST_ALIKE,
    NUDGE,
    ORDER,
    ROUNDS,
    SAME_NUMBER,
    UNITS,
    WINDOW,
)
from validation.diagnosis.evidence import Departure, Stage
from validation.diagnosis.fits.bar import last_digits, norm, outlying, spread_of_most, white
from validation.diagnosis.numbers import CandidateChange, Values
from validation.diagnosis.one_change import Fitted, fitted, nearest, nearest_start
from validation.diagnosis.reading import Foreign
from validation.diagnosis.readings import Reading
from validation.diagnosis.schemes import scheme_numbers
from validation.diagnosis.variant import own_scheme
from validation.errors import InputError
from validation.metrics.contact import AGREED
from validation.metrics.values import largest
from validation.runs.history import Array
from validation.runs.numbers import ROUNDING, significant
from validation.scenes.scene import Scene

Candidate: TypeAlias = CandidateChange[Values]

FARTHEST = 1 / ROUNDING  # times what may remain: a run that fails is no nearer than that
LARGEST = math.log(CLEARLY * max(UNITS))  # of a factor that a number may be wrong by
PATIENCE = 2  # groups of rows that every candidate is fitted to
PURSUED = 7  # candidates of a slow scene that are fitted, the nearest along their slope
POWERS = (-2.0, -1.0, -0.5, 0.5, 1.0, 2.0)  # given: by which numbers of one product stand for each other
NOISY = 4 * ORDER  # rows from which on noise is told from a shape by all lags


@dataclass(frozen=True, eq=False)
class RunExplanation:
    """A candidate at its best number, with what its run leaves."""

    candidate: Fitted[Values]
    ratio: float  # of what it leaves to what may remain, in the worst row [1]
    left: float  # root mean square over the largest value, of the worst column [1]
    is_noise: bool = False  # whether that is more than digits, but has no shape

    @property
    def explains(self) -> bool:
        """Whether digits or noise are all that remains."""
        return self.ratio <= 1 or self.is_noise

    @property
    def id(self) -> str:
        """Of the cause."""
        return self.candidate.change.id

    @property
    def value(self) -> float | None:
        """The number of the cause, None where it has none."""
        number = self.candidate.change.value(self.candidate.u)
        return None if math.isnan(number) else significant(number, 6)

    @property
    def values(self) -> Values:
        """What it changes."""
        return self.candidate.change.changed(self.candidate.u)

    @property
    def words(self) -> str:
        """The cause in words."""
        return self.candidate.change.words(self.value or 0.0)


def rank(explanation: RunExplanation) -> tuple[bool, float]:
    """Order explanations: those that explain come first, then what leaves least."""
    return not explanation.explains, explanation.left


@dataclass(eq=False)
class SceneSearch:
    """The search for what gives a history back, beside runs of its scene by `dda`.

    Raises
    ------
    InputError
        The scene does not run at the steps of the history.
    """

    NAMES: ClassVar[tuple[str, ...]]  # of the columns, the displacement first
    WOULD_TELL: ClassVar[str]  # a further scene that tells causes apart
    is_slow = False  # whether a run takes so long that few candidates are fitted
    patience = PATIENCE
    model = ""  # name of the solver whose runs they are, where it is another one than `dda`
    model_words = ""

    scene: Scene  # at the steps of the history
    reading: Reading
    recorded: Array = field(init=False)  # columns of the history, (columns, rows)
    scene_run: Array = field(init=False)  # columns of the scene's own run at all rows
    allowed: Array = field(init=False)  # what may remain, (columns, rows that can be judged)

    def __post_init__(self) -> None:
        """Begin with the scene's own run."""
        self.recorded = self.reading.recorded
        scene_run = self.run({}, self.recorded.shape[1])
        if scene_run is None:
            raise InputError("dda cannot run it at the steps of the history", source=self.scene.name)
        self.scene_run = scene_run
        units = self.reading.rounding
        if units is None:
            units = np.array([last_digits(values) for values in self.recorded])
        sizes = np.max(np.abs(np.hstack([self.recorded, scene_run])), axis=1, keepdims=True)
        least = np.finfo(float).tiny  # of a column that is zero throughout
        allowed = np.maximum(units + ARITHMETIC * sizes, least) + self.spread({}, scene_run)
        self.allowed = allowed[:, np.all(np.isfinite(allowed), axis=0)]

    # ---- of a kind of scene ----

    def candidates(self) -> Iterator[Candidate]:
        """Yield everything that may be changed in the scene, one thing at a time."""
        raise NotImplementedError

    def solved(self, values: Values, steps: int, is_shifted: bool) -> Array | None:
        """Return the columns of a change at all of its own steps, (columns, steps); None if there is no such run.

        A shifted run has a number larger by `SHIFT`, as rounding makes it in another code.
        """
        raise NotImplementedError

    @cached_property
    def changes(self) -> list[Candidate]:
        """The candidates, each of them once."""
        return list(self.candidates())

    # ---- runs ----

    @property
    def rows(self) -> int:
        """Number of rows up to the horizon."""
        return int(self.allowed.shape[1])

    @property
    def time(self) -> Array:
        """Times of the rows [s]."""
        stepping = self.reading.stepping
        return np.asarray(np.cumsum(stepping.steps)[stepping.rows])

    def run(self, values: Values, rows: int, is_shifted: bool = False) -> Array | None:
        """Return the columns of a change at the first rows, (columns, rows); None where there is no such run."""
        ends = self.reading.stepping.rows[:rows] + 1
        steps = int(ends[-1])
        columns = self.solved(values, steps, is_shifted)
        if columns is None:
            return None
        parts = columns.shape[1] // steps
        return columns[: len(self.recorded), ends * parts - 1]

    def spread(self, values: Values, run: Array) -> Array:
        """Return what another correct code may leave of a run, infinite from its horizon on, (columns, rows)."""
        shifted_run = self.run(values, run.shape[1], True)
        if shifted_run is None:
            return np.full(run.shape, np.inf)
        apart = np.maximum.accumulate(np.abs(shifted_run - run), axis=1)
        beyond = np.any(apart > AGREED * np.max(np.abs(run), axis=1, keepdims=True), axis=0)
        apart[:, beyond] = np.inf
        return apart

    def over(self, columns: Array | None, rows: int, spread: Array | float = 0.0) -> Array:
        """Return what columns leave of the first rows over what may remain, (columns, rows)."""
        if columns is None:
            return np.full((len(self.allowed), rows), FARTHEST)
        with np.errstate(all="ignore"):
            shares = (self.recorded[:, :rows] - columns[:, :rows]) / (self.allowed[:, :rows] + spread)
        return np.nan_to_num(np.clip(shares, -FARTHEST, FARTHEST), nan=FARTHEST)

    @cached_property
    def departing(self) -> np.ndarray:
        """Indices of the rows that are not the scene's own."""
        return np.flatnonzero(np.any(np.abs(self.over(self.scene_run, self.rows)) > 1, axis=0))

    def is_noise(self, columns: Array) -> bool:
        """Whether columns leave noise: small, without a shape, and no row that stands out."""
        rest = self.recorded[:, : self.rows] - columns[:, : self.rows]
        if self.rows < NOISY or self.left(columns) > FAINT:
            return False
        return all(
            white(row) and not np.any(outlying(row, spread_of_most(row), unit))
            for row, unit in zip(rest, self.allowed, strict=True)
        )

    def is_scene(self, tolerance: float = 0.0) -> bool:
        """Whether the rows up to the horizon are the scene's own, or differ by no more than a relative L2."""
        if self.rows < min(ORDER, self.scene_run.shape[1]):
            return False
        if not len(self.departing) or self.is_noise(self.scene_run):
            return True
        return max(self.misfits(self.scene_run)) <= tolerance

    def misfits(self, columns: Array) -> list[float]:
        """Return the relative L2 difference of every column up to the horizon [-]."""
        recorded = self.recorded[:, : self.rows]
        sizes = np.maximum(np.linalg.norm(recorded, axis=1), np.linalg.norm(self.scene_run[:, : self.rows], axis=1))
        apart = np.linalg.norm(recorded - columns[:, : self.rows], axis=1)
        return [float(gap / size) if size else 0.0 for gap, size in zip(apart, sizes, strict=True)]

    def left(self, columns: Array) -> float:
        """Return what columns leave up to the horizon: root mean square over the largest value, of the worst column.

        Infinite where the horizon comes before the first row.
        """
        if not self.rows:
            return math.inf
        recorded = self.recorded[:, : self.rows]
        sizes = np.maximum(np.max(np.abs(recorded), axis=1), np.finfo(float).tiny)
        return float(np.max(np.sqrt(np.mean((recorded - columns[:, : self.rows]) ** 2, axis=1)) / sizes))

    def departure(self, verdict: RunVerdict) -> Departure | None:
        """Return the first row that is not the scene's own, and how the displacement differs most."""
        if not len(self.departing):
            return None
        rows = self.reading.stepping.rows[: self.rows]
        departure = evidence.measured(self.scene_run[0, : self.rows], self.recorded[0, : self.rows], rows, 0.0)
        return replace(departure, step=int(rows[self.departing[0]]) + 1)

    # ---- the search ----

    def explanations(self, begun: Sequence[Fitted[Values]] = ()) -> list[RunExplanation]:
        """Return all candidates that were pursued to the last row, the one that leaves least first.

        They are those `begun`, with numbers to begin from, where another search has found which can be meant.
        """
        departing = self.departing
        if len(departing) < ORDER or largest(self.over(self.scene_run, self.rows)) <= CLEARLY:
            return []
        groups = [min(self.rows, int(departing[0]) + WINDOW)]  # of rows, twice as many from group to group
        while groups[-1] < self.rows:
            groups.append(min(self.rows, 2 * groups[-1]))
        candidates = list(begun) or [Fitted(change, 0.0, math.inf) for change in self.changes]
        for number, rows in enumerate(groups):
            # what remains if every row leaves as much as an explanation never may
            near = CLEARLY * math.sqrt(rows * len(self.allowed))
            candidates = self._fitted(candidates, rows, number, near)
            if number + 1 >= self.patience:
                bar = max(norm(self.over(self.scene_run, rows)) / FARTHER, near)
                candidates = [candidate for candidate in candidates if candidate.remainder <= bar]
        # a factor beyond is forgotten, or rigid, which candidates of their own say
        sensible = [candidate for candidate in candidates if abs(candidate.u) <= LARGEST]
        explanations = sorted(map(self.judged, sensible), key=rank)
        explanations = [each for each in explanations if each.ratio > CLEARLY or self._is_determined(each.candidate)]
        if explanations and explanations[0].explains and explanations[0].candidate.change.starts:
            explanations += self._relatives(explanations, groups[0])
        return sorted(explanations, key=rank)

    def alike(self, explanations: Sequence[RunExplanation]) -> list[RunExplanation]:
        """Return the explanations that the rows cannot tell apart, the best first; none if nothing explains."""
        if not explanations or not explanations[0].explains:
            return []
        bar = FARTHER * explanations[0].left if explanations[0].is_noise else 0.0
        listed: list[RunExplanation] = []
        for each in sorted(explanations, key=lambda each: (bool(each.candidate.change.starts), each.left)):
            # what a mesh leaves has a shape, with another cause as well; noise has none
            is_near = each.left <= bar and (each.is_noise or bool(self.model))
            if (each.ratio <= CLEARLY or is_near) and not any(_is_same(each, other) for other in listed):
                listed.append(each)
        return sorted(listed, key=rank)

    def as_dict(self, explanation: RunExplanation) -> dict[str, Any]:
        """Return an explanation as one of several that give the same rows."""
        cause = CAUSES.get(explanation.id)
        further = (cause and (cause.of_columns or cause.further_scene)) or self.WOULD_TELL
        values = {} if explanation.value is None else {explanation.id: explanation.value}
        return {"causes": [explanation.id], "values": values, "further_scene": further}

    def judged(self, candidate: Fitted[Values]) -> RunExplanation:
        """Return a candidate with what it leaves of the rows up to its own horizon."""
        values = candidate.change.changed(candidate.u)
        columns = self.run(values, self.rows)
        if columns is None:
            return RunExplanation(candidate, FARTHEST, FARTHEST)
        spread = self.spread(values, columns)
        rows = int(np.count_nonzero(np.all(np.isfinite(spread), axis=0)))
        ratio = largest(self.over(columns, rows, spread[:, :rows]))
        return RunExplanation(candidate, ratio, self.left(columns), ratio > 1 and self.is_noise(columns))

    def _relatives(self, explanations: Sequence[RunExplanation], rows: int) -> list[RunExplanation]:
        """Return what gives the rows of the best number by a power of its factor, and was not found by a fit.

        Equations of motion have numbers in products only: a fit that ends elsewhere must not make a cause unique.
        """
        at_hand = {id(explanation.candidate.change) for explanation in explanations if explanation.ratio <= CLEARLY}
        further = []
        for change in self.changes:
            if id(change) in at_hand or not change.starts:
                continue
            for power in POWERS:
                u = power * explanations[0].candidate.u
                if largest(self.over(self.run(change.changed(u), rows), rows)) <= CLEARLY:
                    further.append(self.judged(Fitted(change, u, 0.0)))
        return further

    def _fitted(
        self, candidates: Sequence[Fitted[Values]], rows: int, number: int, near: float
    ) -> list[Fitted[Values]]:
        """Return candidates at their best numbers in the first rows, of slow scenes the nearest few."""

        def residual(change: Candidate, u: float) -> Array:
            return self.over(self.run(change.changed(u), rows), rows).ravel()

        def at_best(candidate: Fitted[Values]) -> Fitted[Values]:
            of_change = partial(residual, candidate.change)
            if not candidate.change.starts:
                return nearest_start(of_change, candidate.change)
            if number or self.is_slow:
                best = fitted(of_change, candidate, ROUNDS, NUDGE, ROUNDING)
                if best.remainder <= near or number >= PATIENCE or self.is_slow:
                    return best
            return fitted(of_change, nearest_start(of_change, candidate.change), ROUNDS, NUDGE, ROUNDING)

        if self.is_slow and not number:
            begun = [
                each if math.isfinite(each.remainder) else nearest_start(partial(residual, each.change), each.change)
                for each in candidates
            ]
            candidates = nearest(begun, PURSUED, near)
        return [at_best(candidate) for candidate in candidates]

    def _is_determined(self, candidate: Fitted[Values]) -> bool:
        """Whether some row changes with a candidate's number, where it has one."""
        if not candidate.change.starts:
            return True
        runs = [self.run(candidate.change.changed(candidate.u + u), self.rows) for u in (0.0, -CHANGE, CHANGE)]
        if any(run is None for run in runs):
            return True
        shares = [self.over(run, self.rows) for run in runs]
        return all(largest(share - shares[0]) > 1 for share in shares[1:])


def _is_same(first: RunExplanation, second: RunExplanation) -> bool:
    """Whether two explanations are one: a number fitted to that of a plain change, or either start."""
    if first.id != second.id:
        return False
    if first.id == "scheme":
        return all(first.values[key] == second.values[key] for key in ("time.alpha", "time.delta"))
    if first.value is None or second.value is None or second.candidate.change.starts:
        return False
    return abs(first.value - second.value) <= SAME_NUMBER * max(1.0, abs(second.value))


# ---- the answer ----


@dataclass(frozen=True, eq=False)
class RunVerdict:
    """What a history came to."""

    search: SceneSearch
    explained: bool  # whether it is certain
    causes: Mapping[str, float | None] = field(default_factory=dict)  # ids of what explains it, or comes nearest
    words: Mapping[str, str] = field(default_factory=dict)  # of these causes
    best: Values = field(default_factory=dict)  # what the run changes that explains it, or comes nearest
    alike: Sequence[Mapping[str, Any]] = ()  # causes that give the same rows

    @cached_property
    def columns(self) -> Array:
        """Columns of the run that explains the history, or comes nearest."""
        search = self.search
        run = search.run(self.best, len(search.time)) if self.best else None
        return search.scene_run if run is None else run

    @property
    def left(self) -> float:
        """What that run leaves over the largest value, of the worst column [-]."""
        return self.search.left(self.columns)


def verdict_of(search: SceneSearch, explanations: Sequence[RunExplanation]) -> RunVerdict:
    """Return what one thing changed explains, if it is certain which."""
    if not explanations:
        return RunVerdict(search, False)
    alike = search.alike(explanations)
    best = explanations[0]
    is_certain = len(alike) == 1 and best.id in CAUSES
    listed = [] if is_certain else [search.as_dict(each) for each in alike[:MOST_ALIKE]]
    return RunVerdict(search, is_certain, {best.id: best.value}, {best.id: best.words}, best.values, listed)


def answer_of(
    foreign: Foreign, verdict: RunVerdict, more_stages: Sequence[Stage] = (), notes: Sequence[str] = ()
) -> Answer:
    """Return a verdict as the answer of `compare`."""
    search = verdict.search
    reading = search.reading
    explained = verdict.explained
    scene_misfit, misfit = (math.hypot(*search.misfits(run)) for run in (search.scene_run, verdict.columns))
    own = own_scheme(search.scene)
    scheme = scheme_numbers(own)
    stated = sentences.scheme_of(own)
    words = dict(verdict.words)
    if explained:
        if {"scheme", "start"} & verdict.causes.keys():
            scheme |= {name: verdict.best[f"time.{name}"] for name in ("alpha", "delta")}
        scheme["gg"] = verdict.best.get("time.gg", scheme["gg"])
        if "scheme" in words:
            words["scheme"] = f"a different scheme from the scene's {stated}"
            stated = verdict.words["scheme"]
        elif "exact-in-time" in words:
            scheme = dict.fromkeys(("alpha", "delta", "gg"))
            stated = sentences.EXACT
        else:
            stated = sentences.scheme_of(replace(own, gg=scheme["gg"]))
    horizon = [_horizon(search)] if search.rows < search.scene_run.shape[1] else []
    is_fault = not (explained and all_benign([*reading.slips, *verdict.causes]))
    answer = Answer(
        causes=list(verdict.causes),
        values={name: significant(value, 6) for name, value in verdict.causes.items() if value is not None},
        scheme=scheme,
        departure=search.departure(verdict) if is_fault else None,
        notes=(*foreign.notes, *reading.notes, *horizon, *notes),
        misfit=misfit,
        curves=curves(search.time, search.NAMES, search.recorded, search.scene_run, verdict.columns),
        unexplained=0.0 if explained else significant(min(misfit / scene_misfit, 1.0) if scene_misfit else 1.0, 4),
        alike=[dict(one) for one in verdict.alike],
        evidence=(*_stages(search), *more_stages),
        model=search.model,
    )
    answer = finished(answer, reading, explained, words, stated, search.model_words)
    if explained:
        return answer
    return replace(answer, sentence=f"{answer.sentence[:-1]}; {_first_rows(search)}.")


def _first_rows(search: SceneSearch) -> str:
    """Return which rows agree, and what would tell."""
    row = search.departing[0] if len(search.departing) else search.rows
    agree = f"the first {row} rows agree, up to t = {search.time[row - 1]:.6g} s" if row else "no row agrees"
    return f"{agree}; what would tell: {search.WOULD_TELL}"


def _stages(search: SceneSearch) -> list[Stage]:
    """Return what is seen without a cause: how it reads, and each column alone."""
    stages = [evidence.reading_stage(search.reading)]
    shares = search.over(search.scene_run, search.rows)
    is_noise = search.is_noise(search.scene_run)
    for name, misfit, share in zip(search.NAMES, search.misfits(search.scene_run), shares, strict=False):
        beyond = np.flatnonzero(np.abs(share) > 1) + 1
        first = float(beyond[0]) if len(beyond) else None
        agrees = is_noise or first is None
        since = f", from row {first or 0:g} on"
        stages.append(evidence.column_stage(name, agrees, misfit, since, {"first_row": first}))
    if search.rows < search.scene_run.shape[1]:
        time = float(search.time[max(search.rows - 1, 0)])
        stages.append(Stage("horizon", None, _horizon(search), {"time": time, "rows": float(search.rows)}))
    return stages


def _horizon(search: SceneSearch) -> str:
    time = search.time[max(search.rows - 1, 0)]
    return f"two correct codes agree up to t = {time:.6g} s only; later rows are not judged"
