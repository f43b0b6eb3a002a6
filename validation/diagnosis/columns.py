"""A history beside a scene with a column whose contacts open or slip: the scene's own, one thing changed, or not known.

A step of such a column is a continuous, piecewise linear function of the state before it, so that a run depends
continuously on every number of the scene, with kinks where a contact switches; every switch may enlarge a difference.
Numbers are therefore fitted to the first rows that depart, then to twice as many, up to the horizon behind which two
correct codes need not agree.

What may remain of a row that is explained: one unit of its last digit, half the digits of double precision, and what
the run of a scene with densities larger by 1e-12 leaves of the run itself (`validation.metrics.contact.SHIFT`). A cause
is named if every row up to the horizon is within that, and if the rows of every other cause, and those of the scene,
are clearly beyond it.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import TYPE_CHECKING, Any, TypeAlias

import numpy as np

from validation.diagnosis import evidence, families, sentences
from validation.diagnosis.answer import Answer
from validation.diagnosis.causes import CAUSES, UNEXPLAINED
from validation.diagnosis.evidence import Departure, Stage
from validation.diagnosis.fits.bar import ARITHMETIC, last_digits, norm, significant
from validation.diagnosis.fits.fit import NAMED
from validation.diagnosis.numbers import Values, contacts, layers, places
from validation.diagnosis.one_change import (
    UNITS,
    CandidateChange,
    Fitted,
    Residual,
    fitted,
    nearest_start,
    of_discount,
    of_numbers,
)
from validation.diagnosis.other_solvers import DISCOUNTS, STARTS, row_of
from validation.diagnosis.reading import Foreign, Stepping, steppings
from validation.diagnosis.readings import Reading, slips, words_of_slips
from validation.diagnosis.schemes import scheme_numbers
from validation.diagnosis.variant import own_scheme
from validation.errors import InputError
from validation.metrics.contact import AGREED, SHIFT
from validation.metrics.values import largest
from validation.runs.history import DISPLACEMENT, PRESSURE, Array
from validation.scenes.drive import motion_at
from validation.scenes.scene import Scene
from validation.solvers.columns.names import column_of
from validation.solvers.contract import Role
from validation.solvers.registry import by_role

if TYPE_CHECKING:
    from dda.column.contacts import ColumnContactResult

REPEATS = 300  # runs of a scene for one history, about: compiled code pays
ROUNDS, NUDGE = 8, 1e-6  # evaluations of a fit, those of derivatives apart, and its relative change of a number
SETTLED = 1e-13  # relative gain at which a fit has arrived: rows near the horizon need all digits of a number
FIRST_ROWS = 24  # after the first that departs, by which numbers are fitted first
LEAST_ROWS = 12  # that depart from the scene's own: fewer tell no cause
APART = 10.0  # times more than may remain that every other cause must leave somewhere
NEAR = 0.3  # of what the scene's own run leaves, beyond which a candidate is not pursued to later rows
PATIENCE = 2  # groups of rows that every candidate is fitted to
LARGEST = math.log(1e4)  # of a factor that a number may be wrong by; other units are 1e3 and 1e-3
FARTHEST = 1e12  # times what may remain: a run that fails is no nearer than that
POWERS = (-2.0, -1.0, -0.5, 0.5, 1.0, 2.0)  # by which numbers of one product stand for each other
SAME_NUMBER = 1e-4  # relative: two fits that came to the same number are one
MOST_ALIKE = 6  # causes that are listed
LEAST_LIMIT = 2  # solves of a step: no program gives up after fewer
PARTS = (2, 4)  # steps of a program in one of the scene's
NO_FRICTION = 1e-9  # of the strength: what slips all the time, which no scene can state
WOULD_TELL = "the rows up to the first switch with every step, or a run with one contact"


@dataclass(frozen=True)
class ColumnChange:
    """What a candidate changes: keys of the scene, and whether contacts carry tension and never slip."""

    values: Values = field(default_factory=dict)
    bonded: bool = False


Candidate: TypeAlias = CandidateChange[ColumnChange]


# ---- candidates -----------------------------------------------------------------------------------------------------


def of_scene(scene: Scene) -> Iterator[Candidate]:
    """Yield everything that may be changed in a scene with such a column, one thing at a time."""
    yield from schemes(scene)
    yield from laws(scene)
    for number in of_numbers(scene, STARTS, units=False):
        starts = (*number.starts, *map(math.log, UNITS))
        yield replace(number.giving(_changing(number.changed)), starts=starts)
    discount = of_discount(scene, DISCOUNTS)
    yield discount.giving(_changing(discount.changed))


def _changing(values: Callable[[float], Values]) -> Callable[[float], ColumnChange]:
    return lambda u: ColumnChange(values(u))


def schemes(scene: Scene) -> Iterator[Candidate]:
    """Yield the schemes by which programs step, with either start, and several steps in one of the scene's."""
    t = scene.time
    scene_pairs = [(t.alpha, t.delta)] if t.scheme == "newmark" else []
    for alpha, delta in dict.fromkeys([*scene_pairs, *NAMED.values()]):
        for start in dict.fromkeys([t.start, "zero", "consistent"]):
            values = {"time.scheme": "newmark", "time.alpha": alpha, "time.delta": delta, "time.start": start}
            if (alpha, delta) not in scene_pairs:
                also = "" if start == t.start else f', the initial acceleration is "{start}"'
                yield _plain("scheme", f"{sentences.scheme_words(alpha, delta, t.discount)}{also}", values)
            elif start != t.start:
                yield _plain("start", f'the initial acceleration is "{start}", not "{t.start}"', values)
    for parts in PARTS:
        words = f"the program makes {parts} steps in one of the scene's"
        yield _plain("substeps", words, {"time.step": t.step / parts}, float(parts))


def laws(scene: Scene) -> Iterator[Candidate]:
    """Yield what a program may have forgotten, reversed, or put in place of the contacts' law."""
    column = column_of(scene)
    stated = scene.definition()
    has_velocity = any(layer.velocity for layer in column.layer)
    if column.gravity and column.law == "unilateral":
        unloaded: Values = {"column.gravity": 0.0}
        if column.settled:
            unloaded["column.settled"] = False
        if scene.stated_input is not None or has_velocity:
            yield _plain("gravity-factor", "the weight is forgotten", unloaded, 0.0)
        if column.settled:
            words = "the column starts unstrained, its weight put on at once"
            yield _plain("settled", words, {"column.settled": False})
        elif column.base in ("rigid", "springs") and not any(contact.gap for contact in column.contacts):
            words = "the column starts at rest under its weight, not unstrained"
            yield _plain("settled", words, {"column.settled": True})
    for place, where in places(scene, "gap").items():
        yield _plain("gap-factor", f"the gap of {where} is forgotten", contacts("gap", place)(scene, 0.0), 0.0)
    if column.law == "unilateral":
        yield _plain("contact-locked", "the contacts carry tension", {}, bonded=True)
    elif any(math.isfinite(contact.strength) for contact in column.contacts):
        yield _plain("no-slip", "the contacts do not slip", {}, bonded=True)
        free = contacts("strength")(scene, NO_FRICTION)
        free |= contacts("friction")(scene.with_values(free), NO_FRICTION)
        yield _plain("no-friction", "there is no friction", free)
    if any(math.isfinite(contact.stiffness) for contact in column.contacts):
        joints = stated["column"].get("joint", [])
        rigid: Values = {"column.joint": [joint | {"stiffness": math.inf} for joint in joints]}
        if column.stiffness is not None:
            rigid["column.stiffness"] = math.inf
        yield _plain("contact-welded", "the contacts are welded: their faces move alike", rigid, bonded=True)
    if scene.stated_input is not None:
        sizes = {key: -stated["input"].get(key, 0.0) for key in ("velocity", "pressure")}
        reversed_input: Values = {f"input.{key}": size for key, size in sizes.items() if size}
        if reversed_input:
            yield _plain("load-factor", "the input acts the other way", reversed_input, -1.0)
    if has_velocity:
        for words, factor in (("reversed", -1.0), ("forgotten", 0.0)):
            changed = layers("velocity")(scene, factor)
            yield _plain("velocity-factor", f"the starting velocity is {words}", changed, factor)


def _plain(name: str, words: str, values: Values, number: float = math.nan, bonded: bool = False) -> Candidate:
    """Return a change without a fitted number; `number` is what it stands for, nan where there is none."""
    return CandidateChange(name, lambda _: words, lambda _: number, lambda _: ColumnChange(values, bonded))


# ---- runs -----------------------------------------------------------------------------------------------------------


@dataclass(eq=False)
class ColumnHistory:
    """A history as it is read, beside runs of its scene by `dda`.

    Attributes
    ----------
    scene
        At the steps of the history, and without a limit of solves.
    reading
        The history.
    """

    scene: Scene
    reading: Reading

    def result(self, change: ColumnChange, steps: int, shift: float = 0.0) -> ColumnContactResult | None:
        """Return what a change gives at the first steps of the history; None where there is no such run.

        Parameters
        ----------
        shift
            Relative change of all densities.
        """
        from dda.column.contacts import ColumnOptions, solve_contact_column
        from dda.column.stepping import Drive
        from validation.solvers.columns.blocks import dda_column
        from validation.solvers.dda import scheme_of

        try:
            scene = self.scene.with_values(change.values)
            if shift:
                scene = scene.with_values(layers("density")(scene, 1 + shift))
            section = column_of(scene)
            column = dda_column(section)
            if change.bonded:
                column = replace(column, joints=[replace(joint, gap=0.0) for joint in column.joints])
            steps *= round(self.scene.time.step / scene.time.step)
            drive = Drive(**vars(motion_at(scene, scene.time.step * np.arange(steps + 1.0))))
            options = ColumnOptions(None, section.settled, bonded=change.bonded, repeats=REPEATS)
            result = solve_contact_column(column, scheme_of(scene), drive, [DISPLACEMENT, PRESSURE], (), options)
        except (InputError, ArithmeticError, ValueError):
            return None
        return result if len(result.time) == steps else None

    def run(self, change: ColumnChange, rows: int, shift: float = 0.0) -> Array | None:
        """Return the columns of a change at the first rows, (columns, rows); None where there is no such run."""
        ends = self.reading.stepping.rows[:rows] + 1
        result = self.result(change, int(ends[-1]), shift)
        if result is None:
            return None
        parts = len(result.time) // int(ends[-1])
        names = (DISPLACEMENT, PRESSURE)[: len(self.recorded)]
        return np.array([result.columns[name][ends * parts - 1] for name in names])

    def spread(self, change: ColumnChange, run: Array) -> Array:
        """Return what another correct code may leave of a run, infinite from its horizon on, (columns, rows)."""
        denser_run = self.run(change, run.shape[1], SHIFT)
        if denser_run is None:
            return np.full(run.shape, np.inf)
        apart = np.maximum.accumulate(np.abs(denser_run - run), axis=1)
        beyond = np.any(apart > AGREED * np.max(np.abs(run), axis=1, keepdims=True), axis=0)
        apart[:, beyond] = np.inf
        return apart

    @cached_property
    def time(self) -> Array:
        """Times of the rows [s]."""
        stepping = self.reading.stepping
        return np.asarray(np.cumsum(stepping.steps)[stepping.rows])

    @cached_property
    def recorded(self) -> Array:
        """The columns of the file, (columns, rows)."""
        columns = [self.reading.displacement]
        if self.reading.pressure is not None:
            columns.append(self.reading.pressure)
        return np.array(columns)

    def units(self, scene_run: Array) -> Array:
        """Return the last digits of the file's rows, with half the digits of double precision, (columns, rows)."""
        roundings = (self.reading.rounding, self.reading.pressure_rounding)
        units = []
        for values, run, rounding in zip(self.recorded, scene_run, roundings, strict=False):
            size = max(largest(values), largest(run))
            unit = (last_digits(values) if rounding is None else rounding) + ARITHMETIC * size
            units.append(np.maximum(unit, np.finfo(float).tiny))  # of a column that is zero throughout
        return np.array(units)


# ---- the search -----------------------------------------------------------------------------------------------------


@dataclass(frozen=True, eq=False)
class ColumnExplanation:
    """A candidate at its best number, over all rows that can be judged.

    Attributes
    ----------
    candidate
        With its number.
    ratio
        What it leaves over what may remain, in the worst row [1].
    remainder
        Root of the sum of squares of the same.
    rows
        That its own horizon leaves to be judged.
    """

    candidate: Fitted[ColumnChange]
    ratio: float
    remainder: float
    rows: int

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
    def change(self) -> ColumnChange:
        """What it changes."""
        return self.candidate.change.changed(self.candidate.u)

    @property
    def words(self) -> str:
        """The cause in words."""
        return self.candidate.change.words(self.value or 0.0)

    def as_dict(self) -> dict[str, Any]:
        """Return it as one of several that give the same rows."""
        cause = CAUSES[self.id]
        further = cause.of_columns or cause.further_scene or WOULD_TELL
        values = {} if self.value is None else {self.id: self.value}
        return {"causes": [self.id], "values": values, "further_scene": further}


def ratio_of(explanation: ColumnExplanation) -> float:
    """Return what an explanation leaves over what may remain."""
    return explanation.ratio


@dataclass(eq=False)
class ColumnSearch:
    """The search for what gives a history back.

    Attributes
    ----------
    history
        Beside its scene.
    scene_run
        Columns of the scene's own run at all rows.
    allowed
        What may remain of each row, (columns, rows that can be judged).
    """

    history: ColumnHistory
    scene_run: Array
    allowed: Array

    @classmethod
    def of(cls, history: ColumnHistory) -> ColumnSearch:
        """Begin with the scene's own run.

        Raises
        ------
        InputError
            The scene does not run at the steps of the history.
        """
        plain = ColumnChange()
        scene_run = history.run(plain, len(history.reading.stepping.rows))
        if scene_run is None:
            raise InputError("dda cannot run it at the steps of the history", source=history.scene.name)
        allowed = history.units(scene_run) + history.spread(plain, scene_run)
        judged = np.all(np.isfinite(allowed), axis=0)
        return cls(history, scene_run, allowed[:, judged])

    @property
    def rows(self) -> int:
        """Number of rows up to the horizon."""
        return int(self.allowed.shape[1])

    def over(self, columns: Array | None, rows: int, spread: Array | None = None) -> Array:
        """Return what columns leave of the first rows over what may remain, (columns, rows)."""
        if columns is None:
            return np.full((len(self.allowed), rows), FARTHEST)
        allowed = self.allowed[:, :rows] if spread is None else self.allowed[:, :rows] + spread
        with np.errstate(all="ignore"):
            shares = (self.history.recorded[:, :rows] - columns) / allowed
        return np.nan_to_num(np.clip(shares, -FARTHEST, FARTHEST), nan=FARTHEST)

    @property
    def scene_shares(self) -> Array:
        """What the scene's own run leaves over what may remain, the worst column of each row."""
        shares: Array = np.max(np.abs(self.over(self.scene_run[:, : self.rows], self.rows)), axis=0)
        return shares

    @property
    def departing(self) -> np.ndarray:
        """Indices of the rows that are not the scene's own."""
        return np.flatnonzero(self.scene_shares > 1)

    def is_scene(self, tolerance: float) -> bool:
        """Whether the rows up to the horizon are the scene's own, or differ by no more than a relative L2."""
        if self.rows < min(LEAST_ROWS, self.scene_run.shape[1]):
            return False
        return not len(self.departing) or bool(max(self.misfits(self.scene_run)) <= tolerance)

    def misfits(self, columns: Array) -> list[float]:
        """Return the relative L2 difference of every column up to the horizon [-]."""
        recorded = self.history.recorded[:, : self.rows]
        sizes = np.maximum(np.linalg.norm(recorded, axis=1), np.linalg.norm(self.scene_run[:, : self.rows], axis=1))
        apart = np.linalg.norm(recorded - columns[:, : self.rows], axis=1)
        return [float(gap / size) if size else 0.0 for gap, size in zip(apart, sizes, strict=True)]

    def explanations(self) -> list[ColumnExplanation]:
        """Return all candidates that were pursued to the last row, the one that leaves least first."""
        changes = list(of_scene(self.history.scene))
        candidates = [Fitted(change, 0.0, math.inf) for change in changes]
        groups = self._groups_of_rows()
        for number, rows in enumerate(groups):
            scene_remainder = norm(self.over(self.scene_run[:, :rows], rows))
            candidates = [self._fitted(candidate, rows, number) for candidate in candidates]
            if number + 1 >= PATIENCE:
                bar = max(NEAR * scene_remainder, self._near(rows))
                candidates = [candidate for candidate in candidates if candidate.remainder <= bar]
        # what is smaller or larger by more is forgotten, or rigid, which candidates of their own say
        sensible = [candidate for candidate in candidates if abs(candidate.u) <= LARGEST]
        explanations = sorted(map(self._judged, sensible), key=ratio_of)
        if explanations and explanations[0].ratio <= 1 and explanations[0].candidate.change.starts:
            explanations += self._relatives(changes, explanations, groups[0])
        return sorted(explanations, key=ratio_of)

    def _relatives(
        self, changes: Sequence[Candidate], explanations: Sequence[ColumnExplanation], rows: int
    ) -> list[ColumnExplanation]:
        """Return what gives the rows of the best number by a power of its factor, and was not found by a fit.

        Equations of motion have numbers in products only: a fit that ends elsewhere must not make a cause unique.
        """
        at_hand = {id(explanation.candidate.change) for explanation in explanations if explanation.ratio <= APART}
        further = []
        for change in changes:
            if id(change) in at_hand or not change.starts:
                continue
            for power in POWERS:
                u = power * explanations[0].candidate.u
                shares = self.over(self.history.run(change.changed(u), rows), rows)
                if largest(shares) <= APART:
                    further.append(self._judged(Fitted(change, u, 0.0)))
        return further

    def _near(self, rows: int) -> float:
        """Return the norm of what remains of the first rows if every row leaves as much as an explanation never may."""
        return APART * math.sqrt(rows * len(self.allowed))

    def _groups_of_rows(self) -> list[int]:
        """Return numbers of rows from the start, from a few that depart up to all that can be judged."""
        groups = [min(self.rows, int(self.departing[0]) + FIRST_ROWS)]
        while groups[-1] < self.rows:
            groups.append(min(self.rows, 2 * groups[-1]))
        return groups

    def _fitted(self, candidate: Fitted[ColumnChange], rows: int, number: int) -> Fitted[ColumnChange]:
        """Return a candidate at the number that comes nearest in the first rows."""
        change = candidate.change

        def residual(u: float) -> Array:
            return self.over(self.history.run(change.changed(u), rows), rows).ravel()

        if not change.starts:
            return nearest_start(residual, change)
        near = self._near(rows)
        if number:
            best = self._refined(residual, candidate)
            if best.remainder <= near or number >= PATIENCE:
                return best
        return self._refined(residual, nearest_start(residual, change))

    def _refined(self, residual: Residual, start: Fitted[ColumnChange]) -> Fitted[ColumnChange]:
        return fitted(residual, start, ROUNDS, NUDGE, SETTLED)

    def _judged(self, candidate: Fitted[ColumnChange]) -> ColumnExplanation:
        """Return a candidate with what it leaves of the rows up to its own horizon."""
        change = candidate.change.changed(candidate.u)
        columns = self.history.run(change, self.rows)
        if columns is None:
            return ColumnExplanation(candidate, FARTHEST, FARTHEST, 0)
        spread = self.history.spread(change, columns)
        rows = int(np.count_nonzero(np.all(np.isfinite(spread), axis=0)))
        shares = self.over(columns[:, :rows], rows, spread[:, :rows])
        return ColumnExplanation(candidate, largest(shares), norm(shares), rows)


# ---- the verdict ----------------------------------------------------------------------------------------------------


@dataclass(frozen=True, eq=False)
class ColumnVerdict:
    """What a history came to.

    Attributes
    ----------
    search
        The history beside its scene.
    ranked
        Explanations that were tried, the best first; none where the scene's own run is the history.
    alike
        Those that give the same rows; one where a cause is certain.
    is_scene
        Whether it is the scene's own, as it is read.
    slipped
        Another reading by which it is the scene's own: with other signs or units.
    """

    search: ColumnSearch
    ranked: Sequence[ColumnExplanation] = ()
    alike: Sequence[ColumnExplanation] = ()
    is_scene: bool = False
    slipped: ColumnSearch | None = None

    @property
    def cause(self) -> ColumnExplanation | None:
        """What explains the history, where nothing else does."""
        return self.alike[0] if len(self.alike) == 1 and self.slipped is None else None

    @property
    def reading(self) -> Reading:
        """The history as it is read."""
        return self.search.history.reading


def compare_column(scene: Scene, foreign: Foreign, tolerance: float = 0.0) -> Answer:
    """Judge a history against a scene with a column whose contacts open or slip.

    Parameters
    ----------
    tolerance
        Relative L2 difference up to which a column counts as the scene's own [-].

    Raises
    ------
    InputError
        The times are not uniform, or the scene does not run at the steps of the history.
    """
    uniform = [stepping for stepping in steppings(foreign, scene.time.step) if np.ptp(stepping.steps) == 0]
    if not uniform:
        raise InputError("the times of the history are not uniform, which a column needs", source=scene.name)
    searches = [search for stepping in uniform for search in searches_of(scene, foreign, stepping)]
    fewest = min(len(search.history.reading.corrected) for search in searches)
    plain = [search for search in searches if len(search.history.reading.corrected) == fewest]
    for search in plain:
        if search.is_scene(tolerance):
            return answer_of(scene, foreign, ColumnVerdict(search, is_scene=True))
    slipped = [search for search in searches if search not in plain and search.is_scene(tolerance)]
    verdicts = [verdict_of(search) for search in plain]
    verdict = next((verdict for verdict in verdicts if verdict.alike), verdicts[0])
    if slipped and not verdict.alike:
        verdict = ColumnVerdict(slipped[0], is_scene=True)
    elif slipped:
        verdict = replace(verdict, slipped=slipped[0])
    return answer_of(scene, foreign, verdict)


def searches_of(scene: Scene, foreign: Foreign, stepping: Stepping) -> list[ColumnSearch]:
    """Return the ways to read signs and units, each beside the scene's own run."""
    reading = Reading(stepping, foreign.displacement, foreign.pressure, ())
    run = ColumnHistory(reading.scene_of(scene), reading).result(ColumnChange(), len(stepping.steps))
    if run is None:
        raise InputError("dda cannot run it at the steps of the history", source=scene.name)
    displacement, pressure = (run.columns[name][stepping.rows] for name in (DISPLACEMENT, PRESSURE))
    readings = slips(foreign, stepping, displacement, pressure, furthest=math.inf)
    return [ColumnSearch.of(ColumnHistory(reading.scene_of(scene), reading)) for reading in readings]


def verdict_of(search: ColumnSearch) -> ColumnVerdict:
    """Return what explains a history that is not the scene's own."""
    if len(search.departing) < LEAST_ROWS or search.scene_shares.max() <= APART:
        return ColumnVerdict(search)
    ranked = search.explanations()
    alike: list[ColumnExplanation] = []
    if ranked and ranked[0].ratio <= 1:
        for explanation in sorted(ranked, key=lambda each: (bool(each.candidate.change.starts), each.ratio)):
            if explanation.ratio <= APART and not any(_is_same(explanation, listed) for listed in alike):
                alike.append(explanation)
    return ColumnVerdict(search, ranked, sorted(alike, key=ratio_of))


def _is_same(first: ColumnExplanation, second: ColumnExplanation) -> bool:
    """Whether two explanations are one: a number that was fitted to that of a plain change, or either start."""
    if first.id != second.id:
        return False
    if first.id == "scheme":
        return all(first.change.values[key] == second.change.values[key] for key in ("time.alpha", "time.delta"))
    if first.value is None or second.value is None or second.candidate.change.starts:
        return False
    return abs(first.value - second.value) <= SAME_NUMBER * max(1.0, abs(second.value))


# ---- the answer -----------------------------------------------------------------------------------------------------


def answer_of(scene: Scene, foreign: Foreign, verdict: ColumnVerdict) -> Answer:
    """Return a verdict as the answer of `compare`."""
    search = verdict.search
    reading = verdict.reading
    cause = verdict.cause
    ids = [*reading.slips, *([cause.id] if cause else [])]
    explained = verdict.is_scene or cause is not None
    best = cause or (verdict.ranked[0] if verdict.ranked else None)
    time = search.history.time
    columns = None if best is None else search.history.run(best.change, len(time))
    if columns is None:
        columns = search.scene_run
    scene_misfit, misfit = (math.hypot(*search.misfits(run)) for run in (search.scene_run, columns))
    unexplained = 0.0 if explained else significant(min(misfit / scene_misfit, 1.0) if scene_misfit else 1.0, 4)
    departure = None if not ids and explained else _departure(search)
    scene_variant = own_scheme(scene)
    scheme = scheme_numbers(scene_variant)
    words = words_of_slips(reading.corrected)
    if cause is not None:
        values = cause.change.values
        if "time.alpha" in values:
            scheme = {"alpha": values["time.alpha"], "delta": values["time.delta"], "gg": scheme["gg"]}
        if "time.gg" in values:
            scheme["gg"] = values["time.gg"]
        words[cause.id] = cause.words
        if cause.id == "scheme":
            words["scheme"] = f"a different scheme from the scene's {sentences.scheme_of(scene_variant)}"
    alike = [] if cause or verdict.is_scene else [explanation.as_dict() for explanation in verdict.alike[:MOST_ALIKE]]
    if verdict.slipped is not None:
        slipped = list(verdict.slipped.history.reading.slips)
        alike.append({"causes": slipped, "values": {}, "further_scene": families.BESIDE_GRAVITY})
    subject = sentences.Subject(
        cause.words if cause and cause.id == "scheme" else sentences.scheme_of(replace(scene_variant, gg=scheme["gg"])),
        words,
        departure,
        sentences.remaining(misfit),
        alike,
    )
    nearest: dict[str, Any] | None = None
    if not explained and not alike and best is not None:
        nearest = {key: value for key, value in best.as_dict().items() if key != "further_scene"} | {
            "left": unexplained
        }
    stages = _stages(search)
    if explained:
        sentence = sentences.sentence(subject)
    else:
        sentence = f"{sentences.not_explained(subject, nearest, unexplained, stages)[:-1]}; {_first_rows(search)}."
    (judged_solver, *_) = by_role(Role.JUDGED)
    curves = {"the file": search.history.recorded, judged_solver: search.scene_run, "best": columns}
    alpha, delta = (scene_variant.scheme[:2]) if scene_variant.family == "newmark" else (None, None)
    ranking = [row_of(judged_solver, alpha, delta, scene_variant.gg, scene_misfit, None)]
    if cause is not None:
        ranking.insert(0, row_of(judged_solver, scheme["alpha"], scheme["delta"], scheme["gg"], misfit, None))
    return Answer(
        sentence=sentence,
        causes=ids if explained else [UNEXPLAINED],
        scheme=scheme,
        departure=departure,
        notes=(*foreign.notes, *_notes(search, scene)),
        ranking=ranking,
        misfit=misfit,
        curves={name: (time, run[0]) for name, run in curves.items()},
        values={cause.id: cause.value} if cause and cause.value is not None else {},
        unexplained=unexplained,
        nearest=nearest,
        alike=alike,
        evidence=tuple(stages),
        pressures={name: run[1] for name, run in curves.items()} if len(search.scene_run) > 1 else {},
        slips=reading.corrected if explained else (),
    )


def _departure(search: ColumnSearch) -> Departure | None:
    """Return the first row that is not the scene's own, and how the displacement differs most."""
    departing = search.departing
    if not len(departing):
        return None
    rows = search.history.reading.stepping.rows[: search.rows]
    recorded = search.history.recorded[0, : search.rows]
    return replace(
        evidence.measured(search.scene_run[0, : search.rows], recorded, rows, 0.0), step=int(rows[departing[0]]) + 1
    )


def _first_rows(search: ColumnSearch) -> str:
    """Return which rows agree, and what would tell."""
    row = search.departing[0] if len(search.departing) else search.rows
    agree = "no row agrees"
    if row:
        agree = f"the first {row} rows agree, up to t = {search.history.time[row - 1]:.6g} s"
    return f"{agree}; what would tell: {WOULD_TELL}"


def _stages(search: ColumnSearch) -> list[Stage]:
    """Return what can be seen without a cause: how it reads, and each column alone."""
    reading = search.history.reading
    words = ", ".join(reading.slips) or "units, signs and columns are the scene's"
    note = reading.stepping.note
    stages = [Stage("reading", not reading.slips, words + (f"; {note}" if note else ""), {})]
    shares = search.over(search.scene_run[:, : search.rows], search.rows)
    for name, misfit, share in zip((DISPLACEMENT, PRESSURE), search.misfits(search.scene_run), shares, strict=False):
        beyond = np.flatnonzero(np.abs(share) > 1)
        of_column = f"the {name.replace('_', ' ')} alone "
        what = f"is {100 * misfit:.3g} % off, from row {beyond[0] + 1} on" if len(beyond) else "is the scene's"
        first = float(beyond[0] + 1) if len(beyond) else None
        stages.append(Stage(name, not len(beyond), of_column + what, {"misfit": misfit, "first_row": first}))
    if search.rows < search.scene_run.shape[1]:
        time = float(search.history.time[max(search.rows - 1, 0)])
        words = f"two correct codes agree up to t = {time:.6g} s only; later rows are not judged"
        stages.append(Stage("horizon", None, words, {"time": time, "rows": float(search.rows)}))
    return stages


def _notes(search: ColumnSearch, scene: Scene) -> tuple[str, ...]:
    """Return what there is to know beside the verdict: times, horizon, limits of solves."""
    reading = search.history.reading
    notes = [reading.stepping.note] if reading.stepping.note else []
    notes += [slip.words for slip in reading.corrected]
    notes += [stage.words for stage in _stages(search) if stage.name == "horizon"]
    steps = len(reading.stepping.steps)
    result = search.history.result(ColumnChange(), steps + 1)
    if result is None:
        return tuple(notes)
    limit = column_of(scene).solve_limit
    exceeding = np.flatnonzero(result.step_solves[:steps] > limit) if limit else np.zeros(0, int)
    if len(exceeding):
        step = exceeding[0] + 1
        notes.append(f"the scene's own limit of {limit} solves ends its run at step {step}: it was left out")
    needed = int(result.step_solves[-1])
    is_first = needed > max(int(result.step_solves[:steps].max()), LEAST_LIMIT)
    same_step = reading.stepping.steps[0] == scene.time.step
    if is_first and same_step and steps < scene.time.steps and not len(search.departing):
        notes.append(
            f"the file ends at step {steps} of {scene.time.steps}; the next step is the first that needs {needed} "
            f"solves of the open-close iteration: a limit of {needed - 1} ends a run there"
        )
    return tuple(notes)
