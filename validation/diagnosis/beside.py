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
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property, partial
from typing import Any, ClassVar, TypeVar

import numpy as np

from validation.diagnosis import evidence, sentences
from validation.diagnosis.answer import Answer, curves, finished
from validation.diagnosis.causes import CAUSES, all_benign
from validation.diagnosis.constants import (
    ARITHMETIC,
    CLEARLY,
    FAINT,
    FARTHER,
    MOST_ALIKE,
    ORDER,
    SAME_NUMBER,
    UNITS,
    WINDOW,
)
from validation.diagnosis.evidence import Departure, Stage
from validation.diagnosis.fits.bar import last_digits, norm, outlying, spread_of_most, white
from validation.diagnosis.numbers import CandidateChange, Values
from validation.diagnosis.one_change import STARTS, Fitted, fitted, nearest, of_scene, run_of
from validation.diagnosis.reading import Foreign, steppings
from validation.diagnosis.readings import Reading, slips, without_slips
from validation.diagnosis.schemes import scheme_numbers
from validation.diagnosis.variant import own_scheme
from validation.errors import InputError
from validation.metrics.contact import AGREED, SHIFT
from validation.metrics.values import largest
from validation.runs.history import Array
from validation.runs.numbers import ROUNDING, significant
from validation.scenes.scene import Scene
from validation.solvers.contract import Role, Solver
from validation.solvers.registry import by_role, get_solver

FARTHEST = 1 / ROUNDING  # times what may remain: a run that fails is no nearer than that
PURSUED = 7  # candidates that are fitted, the nearest along their slope
NOISY = 4 * ORDER  # rows from which on noise is told from a shape by all lags
Search = TypeVar("Search", bound="SceneSearch")


def rank(explanation: Fitted) -> tuple[bool, float]:
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
    model = ""  # name of the solver whose runs they are, where it is another one than `dda`
    model_words = ""

    scene: Scene  # from then on at the steps of the history
    reading: Reading
    solver: Solver = field(default_factory=lambda: get_solver(by_role(Role.JUDGED)[0]))
    recorded: Array = field(init=False)  # columns of the history, (columns, rows)
    scene_run: Array = field(init=False)  # columns of the scene's own run at all rows
    allowed: Array = field(init=False)  # what may remain, (columns, rows that can be judged)

    def __post_init__(self) -> None:
        """Begin with the scene's own run."""
        self.scene = self.reading.scene_of(self.scene)
        self.recorded = self.reading.recorded
        scene_run = self.run({}, self.recorded.shape[1])
        if scene_run is None:
            raise InputError(f"{self.solver.name} cannot run it at the steps of the history", source=self.scene.name)
        self.scene_run = scene_run
        units = self.reading.rounding
        if units is None:
            units = np.array([last_digits(values) for values in self.recorded])
        sizes = np.max(np.abs(np.hstack([self.recorded, scene_run])), axis=1, keepdims=True)
        least = np.finfo(float).tiny  # of a column that is zero throughout
        allowed = np.maximum(units + ARITHMETIC * sizes, least) + self.spread({}, scene_run)
        self.allowed = allowed[:, np.all(np.isfinite(allowed), axis=0)]

    # ---- of a kind of scene ----

    def candidates(self) -> Iterator[CandidateChange]:
        """Yield everything that may be changed in the scene, one thing at a time."""
        return of_scene(self.scene, (*STARTS, *UNITS))

    def solved(self, values: Values, steps: int, is_shifted: bool) -> Array | None:
        """Return the columns of a change at all of its own steps, (columns, steps); None if there is no such run.

        A shifted run has springs and friction larger by `SHIFT`, as rounding makes numbers in another code.
        """
        if is_shifted:
            c = self.scene.with_values(values).contact
            shifted = {"stiffness": c.stiffness, "shear_stiffness": c.shear, "friction": c.friction}
            values = values | {f"contact.{key}": number * (1 + SHIFT) for key, number in shifted.items() if number}
        return self.columns(values, steps, *self.NAMES)

    def columns(self, values: Values, steps: int, *names: str) -> Array | None:
        """Return columns of the first steps of a run by the suite; None where there is no such run."""
        asked = {"time.steps": steps, "run.columns": names, "run.solvers": [self.solver.name]}
        history = run_of(self.scene, values | asked, self.solver.name)
        return None if history is None else np.array([history.columns[name] for name in names])

    @property
    def notes(self) -> list[str]:
        """What there is to know beside a verdict."""
        return []

    @cached_property
    def changes(self) -> list[CandidateChange]:
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
        if self.rows < NOISY or self.left(columns) > FAINT:
            return False
        recorded = self.recorded[:, : self.rows]
        for values, row, unit in zip(recorded, recorded - columns[:, : self.rows], self.allowed, strict=True):
            moving = row[values != 0]  # an open contact has neither pressure nor noise
            if not white(moving) or np.any(outlying(row, spread_of_most(moving), unit)):
                return False
        return True

    def is_scene(self, tolerance: float = 0.0) -> bool:
        """Whether the rows up to the horizon are the scene's own, or differ by no more than a relative L2."""
        if self.rows < min(ORDER, self.scene_run.shape[1]):
            return False
        if not len(self.departing) or self.is_noise(self.scene_run):
            return True
        return self.left(self.scene_run) <= tolerance

    def misfits(self, columns: Array) -> list[float]:
        """Return the relative L2 difference of every column up to the horizon [-]."""
        recorded = self.recorded[:, : self.rows]
        sizes = np.maximum(np.linalg.norm(recorded, axis=1), np.linalg.norm(self.scene_run[:, : self.rows], axis=1))
        apart = np.linalg.norm(recorded - columns[:, : self.rows], axis=1)
        return [float(gap / size) if size else 0.0 for gap, size in zip(apart, sizes, strict=True)]

    def left(self, columns: Array) -> float:
        """Return what columns leave up to the horizon: the relative L2 difference of the worst column [-].

        Infinite where the horizon comes before the first row.
        """
        return max(self.misfits(columns)) if self.rows else math.inf

    def departure(self, verdict: RunVerdict) -> Departure | None:
        """Return the first row that is not the scene's own, and how the displacement differs most."""
        if not len(self.departing):
            return None
        rows = self.reading.stepping.rows[: self.rows]
        departure = evidence.measured(self.scene_run[0, : self.rows], self.recorded[0, : self.rows], rows, 0.0)
        return replace(departure, step=int(rows[self.departing[0]]) + 1)

    # ---- the search ----

    def explanations(self, begun: Sequence[Fitted] = ()) -> list[Fitted]:
        """Return all candidates that were pursued to the last row, the one that leaves least first.

        They are those `begun`, where another search has found which can be meant, else those that come nearest to the
        first rows along their slope.
        """
        departing = self.departing
        if len(departing) < ORDER or largest(self.over(self.scene_run, self.rows)) <= CLEARLY:
            return []
        # of rows, twice as many from group to group; in fewer at first noise hides which changes come near
        groups = [min(self.rows, int(departing[0]) + 2 * WINDOW)]
        while groups[-1] < self.rows:
            groups.append(min(self.rows, 2 * groups[-1]))
        first = groups[0]
        residual = partial(self._residual, first)
        candidates = begun or nearest(residual, self.changes, PURSUED, self._near(first), self._bar(first))
        for rows in groups:
            pursued = [fitted(partial(self._residual, rows), candidate) for candidate in candidates]
            candidates = [candidate for candidate in pursued if candidate.remainder <= self._bar(rows)]
        return sorted((self.judged(candidate) for candidate in candidates if candidate.is_sensible), key=rank)

    def _residual(self, rows: int, change: CandidateChange, u: float) -> Array:
        """Return what a candidate leaves of the first rows over what may remain."""
        return self.over(self.run(change.changed(u), rows), rows).ravel()

    def _bar(self, rows: int) -> float:
        """Return the norm of what a candidate may leave of the first rows and is pursued."""
        return max(norm(self.over(self.scene_run, rows)) / FARTHER, self._near(rows))

    def _near(self, rows: int) -> float:
        """Return the norm of what remains if every row leaves as much as an explanation never may."""
        return CLEARLY * math.sqrt(rows * len(self.allowed))

    def alike(self, explanations: Sequence[Fitted]) -> list[Fitted]:
        """Return the explanations that the rows cannot tell apart, the best first; none if nothing explains."""
        if not explanations or not explanations[0].explains:
            return []
        bar = FARTHER * explanations[0].left if explanations[0].is_noise else 0.0
        listed: list[Fitted] = []
        for each in sorted(explanations, key=lambda each: (bool(each.change.starts), each.left)):
            # what a mesh leaves has a shape, with another cause as well; noise has none
            is_near = each.left <= bar and (each.is_noise or bool(self.model))
            if (each.ratio <= CLEARLY or is_near) and not any(_is_same(each, other) for other in listed):
                listed.append(each)
        return sorted(listed, key=rank)

    def as_dict(self, explanation: Fitted) -> dict[str, Any]:
        """Return an explanation as one of several that give the same rows."""
        cause = CAUSES.get(explanation.id)
        further = (cause and (cause.of_columns or cause.further_scene)) or self.WOULD_TELL
        values = {} if explanation.value is None else {explanation.id: explanation.value}
        return {"causes": [explanation.id], "values": values, "further_scene": further}

    def judged(self, candidate: Fitted) -> Fitted:
        """Return a candidate with what it leaves of the rows up to its own horizon."""
        values = candidate.values
        columns = self.run(values, self.rows)
        if columns is None:
            return replace(candidate, ratio=FARTHEST, left=FARTHEST)
        spread = self.spread(values, columns)
        rows = int(np.count_nonzero(np.all(np.isfinite(spread), axis=0)))
        ratio = largest(self.over(columns, rows, spread[:, :rows]))
        is_noise = ratio > 1 and self.is_noise(columns)
        return replace(candidate, ratio=ratio, left=self.left(columns), is_noise=is_noise)


def _is_same(first: Fitted, second: Fitted) -> bool:
    """Whether two explanations are one: a number fitted to that of a plain change, or either start."""
    if first.id != second.id:
        return False
    if first.id == "scheme":
        return all(first.values[key] == second.values[key] for key in ("time.alpha", "time.delta"))
    if first.value is None or second.value is None or second.change.starts:
        return False
    return abs(first.value - second.value) <= SAME_NUMBER * max(1.0, abs(second.value))


def searches_of(scene: Scene, foreign: Foreign, search: Callable[[Scene, Reading], Search]) -> list[Search]:
    """Return the ways to read the steps, signs and units of a history, each beside the scene's own run.

    Raises
    ------
    InputError
        The times are not uniform, or the scene does not run at the steps of the history.
    """
    searches = []
    for stepping in steppings(foreign, scene.time.step):
        if np.ptp(stepping.steps) == 0:
            run = search(scene, without_slips(foreign, stepping)).scene_run
            read = slips(foreign, stepping, run[0], run[-1])
            searches += [search(scene, reading) for reading in read]
    if not searches:
        raise InputError("the times of the history are not uniform, which this scene needs", source=scene.name)
    return searches


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
        """The relative L2 difference that this run leaves of the worst column [-]."""
        return self.search.left(self.columns)


def verdict_of(search: SceneSearch, explanations: Sequence[Fitted]) -> RunVerdict:
    """Return what one thing changed explains, if it is certain which."""
    if not explanations:
        return RunVerdict(search, False)
    alike = search.alike(explanations)
    best = explanations[0]
    is_certain = len(alike) == 1 and best.id in CAUSES
    listed = [] if is_certain else [search.as_dict(each) for each in alike[:MOST_ALIKE]]
    return RunVerdict(search, is_certain, {best.id: best.value}, {best.id: best.words}, best.values, listed)


def answer_of(foreign: Foreign, verdict: RunVerdict, more_stages: Sequence[Stage] = ()) -> Answer:
    """Return a verdict as the answer of `compare`."""
    search = verdict.search
    reading = search.reading
    explained = verdict.explained
    scene_misfit, misfit = (math.hypot(*search.misfits(run)) for run in (search.scene_run, verdict.columns))
    of_time = {key: value for key, value in verdict.best.items() if explained and key.startswith("time.")}
    scheme_of_best = own_scheme(search.scene.with_values(of_time))
    scheme = scheme_numbers(scheme_of_best)
    stated = sentences.scheme_of(scheme_of_best)
    words = dict(verdict.words)
    if explained and "scheme" in words:
        stated = words["scheme"]
        words["scheme"] = f"a different scheme from the scene's {sentences.scheme_of(own_scheme(search.scene))}"
    elif explained and "exact-in-time" in words:
        scheme = dict.fromkeys(scheme)
        stated = sentences.EXACT
    is_fault = not (explained and all_benign([*reading.slips, *verdict.causes]))
    answer = Answer(
        causes=list(verdict.causes),
        values={name: significant(value, 6) for name, value in verdict.causes.items() if value is not None},
        scheme=scheme,
        departure=search.departure(verdict) if is_fault else None,
        notes=(*foreign.notes, *reading.notes, *search.notes),
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
        stages.append(Stage("horizon", None, evidence.horizon(time), {"time": time, "rows": float(search.rows)}))
    return stages
