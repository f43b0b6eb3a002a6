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
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field, replace
from typing import TYPE_CHECKING, Any, TypeAlias

import numpy as np

from validation.diagnosis import evidence, families, sentences
from validation.diagnosis.answer import Answer
from validation.diagnosis.causes import CAUSES, UNEXPLAINED
from validation.diagnosis.evidence import Departure, Stage
from validation.diagnosis.fits.bar import ARITHMETIC, last_digits, norm
from validation.diagnosis.numbers import Values, contacts, layers, places
from validation.diagnosis.one_change import (
    UNITS,
    CandidateChange,
    Fitted,
    fitted,
    fixed,
    nearest_start,
    of_discount,
    of_numbers,
    of_schemes,
)
from validation.diagnosis.other_solvers import DISCOUNTS, STARTS
from validation.diagnosis.reading import Foreign, Stepping, steppings
from validation.diagnosis.readings import Reading, slips, words_of_slips
from validation.diagnosis.schemes import scheme_numbers
from validation.diagnosis.variant import own_scheme
from validation.errors import InputError
from validation.metrics.contact import AGREED, SHIFT
from validation.metrics.values import largest
from validation.runs.history import DISPLACEMENT, PRESSURE, Array
from validation.runs.numbers import share_text, significant
from validation.scenes.drive import motion_at
from validation.scenes.scene import Scene
from validation.solvers.columns.names import column_of
from validation.solvers.contract import Role
from validation.solvers.registry import by_role

if TYPE_CHECKING:
    from dda.bodies.column_history import ColumnResult

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
WIDE = 1e6  # times a gap, that never closes
ELSEWHERE = 0.1  # of a factor's logarithm: a number with whose change by that no row changes is none
LEAST_LIMIT = 2  # solves of a step: no program gives up after fewer
PARTS = (2, 4)  # steps of a program in one of the scene's
NO_FRICTION = 1e-9  # of the strength: what slips all the time, which no scene can state
BONDED = "bonded"  # among the values of a change, no key of scenes: contacts carry tension and never slip
WOULD_TELL = "the rows up to the first switch with every step, or a run with one contact"

Candidate: TypeAlias = CandidateChange[Values]


# ---- candidates -----------------------------------------------------------------------------------------------------


def of_scene(scene: Scene) -> Iterator[Candidate]:
    """Yield everything that may be changed in a scene with such a column, one thing at a time."""
    yield from of_schemes(scene)
    for parts in PARTS:
        words = f"the program makes {parts} steps in one of the scene's"
        yield fixed("substeps", words, {"time.step": scene.time.step / parts}, float(parts))
    yield from laws(scene)
    yield from of_numbers(scene, (*STARTS, *UNITS), units=False)
    yield of_discount(scene, DISCOUNTS)


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
            yield fixed("gravity-factor", "the weight is forgotten", unloaded, 0.0)
        if column.settled:
            words = "the column starts unstrained, its weight put on at once"
            yield fixed("settled", words, {"column.settled": False})
        elif column.base in ("rigid", "springs") and not any(contact.gap for contact in column.contacts):
            words = "the column starts at rest under its weight, not unstrained"
            yield fixed("settled", words, {"column.settled": True})
    for place, where in places(scene, "gap").items():
        gap = contacts("gap", place)
        yield fixed("gap-factor", f"the gap of {where} is forgotten", gap(scene, 0.0), 0.0)
        words = f"{where} is never reached: it is not there, or its gap is wide"
        yield fixed("contact-missing", words, gap(scene, WIDE))
    if column.law == "unilateral":
        yield fixed("contact-locked", "the contacts carry tension", {BONDED: True})
    elif any(math.isfinite(contact.strength) for contact in column.contacts):
        yield fixed("no-slip", "the contacts do not slip", {BONDED: True})
        free = contacts("strength")(scene, NO_FRICTION)
        free |= contacts("friction")(scene.with_values(free), NO_FRICTION)
        yield fixed("no-friction", "there is no friction", free)
    if any(math.isfinite(contact.stiffness) for contact in column.contacts):
        joints = stated["column"].get("joint", [])
        rigid: Values = {"column.joint": [joint | {"stiffness": math.inf} for joint in joints], BONDED: True}
        if column.stiffness is not None:
            rigid["column.stiffness"] = math.inf
        yield fixed("contact-welded", "the contacts are welded: their faces move alike", rigid)
    given = stated["input"] if scene.stated_input is not None else {}
    reversed_input = {f"input.{key}": -given[key] for key in ("velocity", "pressure") if given.get(key)}
    if reversed_input:
        yield fixed("load-factor", "the input acts the other way", reversed_input, -1.0)
    for words, factor in (("reversed", -1.0), ("forgotten", 0.0)) if has_velocity else ():
        yield fixed("velocity-factor", f"the starting velocity is {words}", layers("velocity")(scene, factor), factor)


# ---- the search -----------------------------------------------------------------------------------------------------


@dataclass(frozen=True, eq=False)
class ColumnExplanation:
    """A candidate at its best number, with what it leaves over what may remain, in the worst row [1]."""

    candidate: Fitted[Values]
    ratio: float

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
    """The search for what gives a history back, beside runs of its scene by `dda`.

    Attributes
    ----------
    scene
        At the steps of the history.
    reading
        The history as it is read.
    recorded
        Its columns, (columns, rows).
    scene_run
        Columns of the scene's own run at all rows.
    allowed
        What may remain of each row, (columns, rows that can be judged).

    Raises
    ------
    InputError
        The scene does not run at the steps of the history.
    """

    scene: Scene
    reading: Reading
    recorded: Array = field(init=False)
    scene_run: Array = field(init=False)
    allowed: Array = field(init=False)

    def __post_init__(self) -> None:
        """Begin with the scene's own run."""
        reading = self.reading
        columns = [reading.displacement] if reading.pressure is None else [reading.displacement, reading.pressure]
        self.recorded = np.array(columns)
        scene_run = self.run({}, len(reading.stepping.rows))
        if scene_run is None:
            raise InputError("dda cannot run it at the steps of the history", source=self.scene.name)
        self.scene_run = scene_run
        units = []
        roundings = (reading.rounding, reading.pressure_rounding)
        for values, run, rounding in zip(columns, scene_run, roundings, strict=False):
            size = max(largest(values), largest(run))
            unit = (last_digits(values) if rounding is None else rounding) + ARITHMETIC * size
            units.append(np.maximum(unit, np.finfo(float).tiny))  # of a column that is zero throughout
        allowed = np.array(units) + self.spread({}, scene_run)
        self.allowed = allowed[:, np.all(np.isfinite(allowed), axis=0)]

    @property
    def rows(self) -> int:
        """Number of rows up to the horizon."""
        return int(self.allowed.shape[1])

    @property
    def time(self) -> Array:
        """Times of the rows [s]."""
        stepping = self.reading.stepping
        return np.asarray(np.cumsum(stepping.steps)[stepping.rows])

    def result(self, values: Values, steps: int, shift: float = 0.0) -> ColumnResult | None:
        """Return what a change gives at the first steps of the history; None where there is no such run.

        Parameters
        ----------
        shift
            Relative change of all densities.
        """
        from dda.bodies.column_history import ColumnOptions, solve_column
        from dda.bodies.column_march import Drive
        from validation.solvers.columns.blocks import dda_column
        from validation.solvers.dda import scheme_of

        is_bonded = BONDED in values
        try:
            scene = self.scene.with_values({key: value for key, value in values.items() if key != BONDED})
            if shift:
                scene = scene.with_values(layers("density")(scene, 1 + shift))
            section = column_of(scene)
            column = dda_column(section)
            if is_bonded:
                column = replace(column, joints=[replace(joint, gap=0.0) for joint in column.joints])
            steps *= round(self.scene.time.step / scene.time.step)
            drive = Drive(**vars(motion_at(scene, scene.time.step * np.arange(steps + 1.0))))
            options = ColumnOptions(None, section.settled, bonded=is_bonded, repeats=REPEATS)
            result = solve_column(column, scheme_of(scene), drive, [DISPLACEMENT, PRESSURE], (), options)
        except (InputError, ArithmeticError, ValueError):
            return None
        return result if len(result.time) == steps else None

    def run(self, values: Values, rows: int, shift: float = 0.0) -> Array | None:
        """Return the columns of a change at the first rows, (columns, rows); None where there is no such run."""
        ends = self.reading.stepping.rows[:rows] + 1
        result = self.result(values, int(ends[-1]), shift)
        if result is None:
            return None
        parts = len(result.time) // int(ends[-1])
        names = (DISPLACEMENT, PRESSURE)[: len(self.recorded)]
        return np.array([result.columns[name][ends * parts - 1] for name in names])

    def spread(self, values: Values, run: Array) -> Array:
        """Return what another correct code may leave of a run, infinite from its horizon on, (columns, rows)."""
        denser_run = self.run(values, run.shape[1], SHIFT)
        if denser_run is None:
            return np.full(run.shape, np.inf)
        apart = np.maximum.accumulate(np.abs(denser_run - run), axis=1)
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

    @property
    def scene_shares(self) -> Array:
        """What the scene's own run leaves over what may remain, the worst column of each row."""
        shares: Array = np.max(np.abs(self.over(self.scene_run, self.rows)), axis=0)
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
        recorded = self.recorded[:, : self.rows]
        sizes = np.maximum(np.linalg.norm(recorded, axis=1), np.linalg.norm(self.scene_run[:, : self.rows], axis=1))
        apart = np.linalg.norm(recorded - columns[:, : self.rows], axis=1)
        return [float(gap / size) if size else 0.0 for gap, size in zip(apart, sizes, strict=True)]

    def explanations(self) -> list[ColumnExplanation]:
        """Return all candidates that were pursued to the last row, the one that leaves least first."""
        changes = list(of_scene(self.scene))
        groups = [min(self.rows, int(self.departing[0]) + FIRST_ROWS)]  # of rows, twice as many from group to group
        while groups[-1] < self.rows:
            groups.append(min(self.rows, 2 * groups[-1]))
        candidates = [Fitted(change, 0.0, math.inf) for change in changes]
        for number, rows in enumerate(groups):
            # what remains of these rows if every one leaves as much as an explanation never may
            near = APART * math.sqrt(rows * len(self.allowed))
            candidates = [self._fitted(candidate, rows, number, near) for candidate in candidates]
            if number + 1 >= PATIENCE:
                bar = max(NEAR * norm(self.over(self.scene_run, rows)), near)
                candidates = [candidate for candidate in candidates if candidate.remainder <= bar]
        # what is smaller or larger by more is forgotten, or rigid, which candidates of their own say
        sensible = [candidate for candidate in candidates if abs(candidate.u) <= LARGEST]
        explanations = sorted(map(self._judged, sensible), key=ratio_of)
        explanations = [each for each in explanations if each.ratio > APART or self._is_determined(each.candidate)]
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
                if largest(self.over(self.run(change.changed(u), rows), rows)) <= APART:
                    further.append(self._judged(Fitted(change, u, 0.0)))
        return further

    def _fitted(self, candidate: Fitted[Values], rows: int, number: int, near: float) -> Fitted[Values]:
        """Return a candidate at the number that comes nearest in the first rows."""
        change = candidate.change

        def residual(u: float) -> Array:
            return self.over(self.run(change.changed(u), rows), rows).ravel()

        if not change.starts:
            return nearest_start(residual, change)
        if number:
            best = fitted(residual, candidate, ROUNDS, NUDGE, SETTLED)
            if best.remainder <= near or number >= PATIENCE:
                return best
        return fitted(residual, nearest_start(residual, change), ROUNDS, NUDGE, SETTLED)

    def _is_determined(self, candidate: Fitted[Values]) -> bool:
        """Whether some row changes with a candidate's number, where it has one."""
        if not candidate.change.starts:
            return True
        runs = [self.run(candidate.change.changed(candidate.u + u), self.rows) for u in (0.0, -ELSEWHERE, ELSEWHERE)]
        if any(run is None for run in runs):
            return True
        shares = [self.over(run, self.rows) for run in runs]
        return all(largest(share - shares[0]) > 1 for share in shares[1:])

    def _judged(self, candidate: Fitted[Values]) -> ColumnExplanation:
        """Return a candidate with what it leaves of the rows up to its own horizon."""
        values = candidate.change.changed(candidate.u)
        columns = self.run(values, self.rows)
        if columns is None:
            return ColumnExplanation(candidate, FARTHEST)
        spread = self.spread(values, columns)
        rows = int(np.count_nonzero(np.all(np.isfinite(spread), axis=0)))
        return ColumnExplanation(candidate, largest(self.over(columns, rows, spread[:, :rows])))


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
    fewest = min(len(search.reading.corrected) for search in searches)
    plain = [search for search in searches if len(search.reading.corrected) == fewest]
    own = [search for search in searches if search.is_scene(tolerance)]
    as_read = next((search for search in own if search in plain), None)
    if as_read is not None:
        return answer_of(scene, foreign, ColumnVerdict(as_read, is_scene=True))
    verdicts = [verdict_of(search) for search in plain]
    verdict = next((verdict for verdict in verdicts if verdict.alike), verdicts[0])
    if own and not verdict.alike:
        verdict = ColumnVerdict(own[0], is_scene=True)
    elif own:
        verdict = replace(verdict, slipped=own[0])
    return answer_of(scene, foreign, verdict)


def searches_of(scene: Scene, foreign: Foreign, stepping: Stepping) -> list[ColumnSearch]:
    """Return the ways to read signs and units, each beside the scene's own run."""
    reading = Reading(stepping, foreign.displacement, foreign.pressure, ())
    stepped = reading.scene_of(scene)
    scene_run = ColumnSearch(stepped, reading).scene_run
    readings = slips(foreign, stepping, scene_run[0], scene_run[-1], furthest=math.inf)
    return [ColumnSearch(stepped, reading) for reading in readings]


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
        return all(first.values[key] == second.values[key] for key in ("time.alpha", "time.delta"))
    if first.value is None or second.value is None or second.candidate.change.starts:
        return False
    return abs(first.value - second.value) <= SAME_NUMBER * max(1.0, abs(second.value))


# ---- the answer -----------------------------------------------------------------------------------------------------


def answer_of(scene: Scene, foreign: Foreign, verdict: ColumnVerdict) -> Answer:
    """Return a verdict as the answer of `compare`."""
    search = verdict.search
    cause = verdict.cause
    explained = verdict.is_scene or cause is not None
    best = cause or (verdict.ranked[0] if verdict.ranked else None)
    columns = None if best is None else search.run(best.values, len(search.time))
    columns = search.scene_run if columns is None else columns
    scene_misfit, misfit = (math.hypot(*search.misfits(run)) for run in (search.scene_run, columns))
    unexplained = 0.0 if explained else significant(min(misfit / scene_misfit, 1.0) if scene_misfit else 1.0, 4)
    slips_of_reading = search.reading.corrected if explained else ()
    ids = [*search.reading.slips, *([cause.id] if cause else [])] if explained else [UNEXPLAINED]
    departure = _departure(search) if ids else None
    own = own_scheme(scene)
    scheme = scheme_numbers(own)
    stated = sentences.scheme_of(own)
    words = words_of_slips(search.reading.corrected)
    (judged_solver, *_) = by_role(Role.JUDGED)
    alike = [] if cause else [explanation.as_dict() for explanation in verdict.alike[:MOST_ALIKE]]
    if cause is not None:
        if cause.id in ("scheme", "start"):
            scheme = {"alpha": cause.values["time.alpha"], "delta": cause.values["time.delta"], "gg": scheme["gg"]}
        scheme["gg"] = cause.values.get("time.gg", scheme["gg"])
        words[cause.id] = cause.words
        if cause.id == "scheme":
            words["scheme"] = f"a different scheme from the scene's {stated}"
        stated = cause.words if cause.id == "scheme" else sentences.scheme_of(replace(own, gg=scheme["gg"]))
    if verdict.slipped is not None:
        slipped = list(verdict.slipped.reading.slips)
        alike.append({"causes": slipped, "values": {}, "further_scene": families.BESIDE_GRAVITY})
    nearest: dict[str, Any] | None = None
    if not explained and not alike and best is not None:
        nearest = best.as_dict() | {"left": unexplained}
        del nearest["further_scene"]
    stages = _stages(search)
    subject = sentences.Subject(stated, words, departure, sentences.remaining(misfit), alike)
    sentence = sentences.sentence(subject)
    if not explained:
        sentence = f"{sentences.not_explained(subject, nearest, unexplained, stages)[:-1]}; {_first_rows(search)}."
    curves = {"the file": search.recorded, judged_solver: search.scene_run, "best": columns}
    return Answer(
        sentence=sentence,
        causes=ids,
        scheme=scheme,
        departure=departure,
        notes=(*foreign.notes, *search.reading.notes, *_notes(search, scene)),
        misfit=misfit,
        curves={name: (search.time, run[0]) for name, run in curves.items()},
        values={cause.id: cause.value} if cause and cause.value is not None else {},
        unexplained=unexplained,
        nearest=nearest,
        alike=alike,
        evidence=tuple(stages),
        pressures={name: run[1] for name, run in curves.items()} if len(search.scene_run) > 1 else {},
        slips=slips_of_reading,
    )


def _departure(search: ColumnSearch) -> Departure | None:
    """Return the first row that is not the scene's own, and how the displacement differs most."""
    if not len(search.departing):
        return None
    rows = search.reading.stepping.rows[: search.rows]
    departure = evidence.measured(search.scene_run[0, : search.rows], search.recorded[0, : search.rows], rows, 0.0)
    return replace(departure, step=int(rows[search.departing[0]]) + 1)


def _first_rows(search: ColumnSearch) -> str:
    """Return which rows agree, and what would tell."""
    row = search.departing[0] if len(search.departing) else search.rows
    agree = f"the first {row} rows agree, up to t = {search.time[row - 1]:.6g} s" if row else "no row agrees"
    return f"{agree}; what would tell: {WOULD_TELL}"


def _stages(search: ColumnSearch) -> list[Stage]:
    """Return what can be seen without a cause: how it reads, and each column alone."""
    stages = [evidence.reading_stage(search.reading)]
    shares = search.over(search.scene_run, search.rows)
    for name, misfit, share in zip((DISPLACEMENT, PRESSURE), search.misfits(search.scene_run), shares, strict=False):
        beyond = np.flatnonzero(np.abs(share) > 1) + 1
        what = f"is {share_text(misfit)} off, from row {beyond[0]} on" if len(beyond) else "is the scene's"
        words = f"the {name.replace('_', ' ')} alone {what}"
        first = float(beyond[0]) if len(beyond) else None
        stages.append(Stage(name, not len(beyond), words, {"misfit": misfit, "first_row": first}))
    if search.rows < search.scene_run.shape[1]:
        time = float(search.time[max(search.rows - 1, 0)])
        stages.append(Stage("horizon", None, _horizon(search), {"time": time, "rows": float(search.rows)}))
    return stages


def _horizon(search: ColumnSearch) -> str:
    time = search.time[max(search.rows - 1, 0)]
    return f"two correct codes agree up to t = {time:.6g} s only; later rows are not judged"


def _notes(search: ColumnSearch, scene: Scene) -> list[str]:
    """Return what there is to know beside the verdict: the horizon, limits of solves."""
    notes = [_horizon(search)] if search.rows < search.scene_run.shape[1] else []
    steps = len(search.reading.stepping.steps)
    result = search.result({}, steps + 1)
    if result is None:
        return notes
    limit = column_of(scene).solve_limit
    solves = result.step_solves
    if limit and np.max(solves[:steps]) > limit:
        step = np.argmax(solves > limit) + 1
        notes.append(f"the scene's own limit of {limit} solves ends its run at step {step}: it was left out")
    needed = int(solves[-1])
    is_first = needed > max(int(np.max(solves[:steps])), LEAST_LIMIT)
    same_step = search.reading.stepping.steps[0] == scene.time.step
    if is_first and same_step and steps < scene.time.steps and not len(search.departing):
        notes.append(
            f"the file ends at step {steps} of {scene.time.steps}; the next step is the first that needs {needed} "
            f"solves of the open-close iteration: a limit of {needed - 1} ends a run there"
        )
    return notes
