"""The cause of a failure, where it is certain: what, put into the exact motion, gives the answer back.

An answer fails by more than its band. What explains it must leave less than a tenth of that band in every column that
is judged: less than a tenth of the least error that fails, so that nothing which fails by itself is left over. Where
several causes leave as little, all of them are named, since the rows do not tell them apart; where more than a few do,
or none, nothing is named.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Iterator, Sequence
from dataclasses import dataclass, field, replace
from functools import partial

import numpy as np

from validation.diagnosis.causes import UNEXPLAINED
from validation.diagnosis.constants import SLIGHT, UNITS
from validation.diagnosis.families import ONE_SCHEME
from validation.diagnosis.judgement import compare
from validation.diagnosis.numbers import CandidateChange, Values
from validation.diagnosis.one_change import fitted, nearest, of_scene
from validation.diagnosis.reading import SIDEWAYS, Foreign
from validation.errors import InputError
from validation.metrics.values import largest
from validation.problems.bands import Standard
from validation.problems.models import Base, Columns, Runs, runs_of
from validation.problems.problem import Problem
from validation.runs.history import DISPLACEMENT, PRESSURE, Array, History
from validation.runs.numbers import significant
from validation.scenes import features
from validation.scenes.scene import Scene

FACTORS = (1.0, 0.5, 0.75, 0.88, 1.12, 1.3, 2.0)  # to begin from where a run costs nothing; elsewhere the first
COLUMN_UNITS = (1e-6, 1e-3, 1e2, 1e3)  # factors of a column in other units: MPa, kPa, cm, mm
DAMPINGS = (3.0, 30.0)  # 1/s, of the mass; of the stiffness over the square of the frequency of the steps
OUTPUT = "output"  # among the values of a change, no key of scenes: the columns that are written
NOT_EXPLAINED = "not explained"
WOULD_TELL = (
    "the same run at half the step (an error of the integrator falls to a half or a quarter, one of the model stays), "
    "and one without the program's own damping"
)
OTHERS_WOULD = "an answer to another problem of the pack, on which these differ"
USUAL = (  # causes that give the same rows are told in this order
    *("scheme", "density-factor", "young-factor", "springs-factor", "friction-factor", "load-factor", "gravity-factor"),
    *("velocity-factor", "factor", "shift", "time-factor"),
)
BAR = 0.1  # of the band, that an explanation may leave
CLEAR = 10.0  # times more that every other cause must leave than the one that is named alone
PURSUED = 4  # changes that are fitted, the nearest ones
NEAR = 3 * BAR  # what a change may leave along its slope and is fitted in any case
SAME = 1e-6  # of the band: digit for digit
MOST_ALIKE = 3  # causes that are named together
FARTHEST = 1e6  # bands: a run that leaves its bounds is no nearer than that
MOST_STEPS = 200_000  # of a run by which the step is found at which a scheme passes
NOTHING = 1e-7  # of the exact motion: an answer that is smaller does not move; in other units it is 1e-3 or 1e-6


def of_damping(scene: Scene) -> Iterator[CandidateChange]:
    """Yield viscous damping of the mass and of the stiffness, which DDA knows for linear motions."""
    if not features.linear(scene):
        return
    for key, unit, scale, symbol in (("mass", "1/s", 1.0, "a0"), ("stiffness", "s", scene.time.step**2, "a1")):

        def value(u: float, scale: float = scale) -> float:
            return max(u, 0.0) * scale

        def damped(u: float, key: str = key, value: Callable[[float], float] = value) -> Values:
            return {f"damping.{key}": value(u)}

        words = f"viscous damping of the {key} is there, {symbol} = {{:.4g}} {unit}".format
        yield CandidateChange(f"{key}-damping", words, value, damped, DAMPINGS, 0.1)


def of_output(scene: Scene, dense: History, names: tuple[str, ...]) -> Iterator[CandidateChange]:
    """Yield what may be wrong with rows and columns alone: a factor, a shift of the rows, the rate of time.

    What is before t = 0 is the first row of the exact motion, which is kept between the steps, too.
    """
    from scipy.interpolate import CubicSpline

    # columns whose contacts open may start with a velocity, or at rest under their weight
    moving_column = features.OF_MOVING_COLUMN & {*features.of(scene)}
    starts = {name: dense.columns[name][:1] * bool(moving_column) for name in names}
    time = np.append(0.0, dense.time)
    courses = {
        name: CubicSpline(time, np.append(start, dense.columns[name]), extrapolate=False)
        for name, start in starts.items()
    }
    step = scene.time.step
    instants = step * np.arange(1.0, scene.time.steps + 1)
    plain = {name: course(instants) for name, course in courses.items()}

    def written(group: Sequence[str], factor: float = 1.0, rate: float = 1.0, late: float = 0.0) -> Values:
        """Return all columns, those of a group larger by a factor and at the instants rate (t - late dt)."""
        other_instants = np.maximum(rate * (instants - late * step), 0.0)
        return {OUTPUT: plain | {name: factor * courses[name](other_instants) for name in group}}

    for group in (names, *((name,) for name in names if len(names) > 1)):
        which = "all columns are" if group == names else f"{group[0]} is"

        def late(steps: float, which: str = which) -> str:
            return f"{which} {abs(steps):.3g} steps {'late' if steps > 0 else 'early'}"

        words = f"{which} {{:.4g}} times the exact motion's".format
        yield CandidateChange("factor", words, lambda u: u, partial(written, group), (1.0,))
        shifted = partial(written, group, 1.0, 1.0)
        yield CandidateChange("shift", late, lambda u: u, shifted, (0.0, 1.0, -1.0), 1e-2)
    yield CandidateChange(
        "time-factor",
        "time runs {:.4g} times as fast as in the exact motion".format,
        math.exp,
        lambda u: written(names, rate=math.exp(u)),
        (0.0, math.log(0.8), math.log(0.9)),
    )


@dataclass(frozen=True)
class Cause:
    """Why an answer fails; no id where it is not explained."""

    sentence: str = NOT_EXPLAINED  # one line
    ids: tuple[str, ...] = ()  # of the causes that are there together
    values: dict[str, float] = field(default_factory=dict)  # their numbers
    alike: tuple[str, ...] = ()  # sentences of other causes that give the same rows
    left: float = math.inf  # of the answer by the cause, over the band, in the worst column [1]
    base: Base | None = None  # the scheme, where that is the cause
    passing_step: float | None = None  # halved step of that scheme at which it passes [s]; None where none was found

    @property
    def would_tell(self) -> str:
        """What would tell the cause where it is not explained, nothing where it is."""
        if self.ids:
            return ""
        return OTHERS_WOULD if self.alike else WOULD_TELL


def cause(problem: Problem, history: History, reference: Standard) -> Cause:
    """Return the cause of a failure; silent rather than wrong."""
    answer = {name: x for name, x in history.columns.items() if name in reference.bands}
    if plain := _plain(answer, reference):
        return plain
    runs = runs_of(problem.scene, reference)
    if units := _units(answer, runs):
        return units
    causes = Search(runs, answer).causes()
    if causes:
        # a cause that is a scheme with the step at which that scheme would pass
        scheme = _named(causes)
        if scheme.base is None or scheme.ids != ("scheme",) or not features.linear(runs.scene):
            return scheme
        t = runs.scene.time
        every = 2 * scheme.base.every
        while every * t.steps <= MOST_STEPS:
            finer = runs.sampled(replace(scheme.base, every=every))
            if finer is not None and runs.apart(finer, runs.standard.exact.columns) <= 1:
                return replace(scheme, passing_step=significant(t.step / every, 4))
            every *= 2
        return scheme
    return compared(problem.scene, history) or Cause()


def _plain(answer: Columns, reference: Standard) -> Cause | None:
    """Return what needs no run to be seen: no numbers, no motion."""
    for name, x in answer.items():
        if not np.isfinite(x).all():
            row = int(np.argmin(np.isfinite(x))) + 1
            return Cause(f"{name} is not a number from step {row} on", ("not-finite",), left=0.0)
    if all(largest(x) <= NOTHING * largest(reference.exact.columns[name]) for name, x in answer.items()):
        return Cause("nothing moves", ("nothing-moves",), left=0.0)
    return None


def _units(answer: Columns, runs: Runs) -> Cause | None:
    """Return which columns are in other units where nothing else is wrong: in SI units the answer passes.

    One factor of all columns is that of a load as well, and is left to the search.
    """
    exact = runs.standard.exact.columns
    factors: dict[str, float] = {}
    for name, values in answer.items():
        rows = runs.standard.bands[name].rows
        x = exact[name][:rows]
        factor = float(values[:rows] @ x / (x @ x))
        factors[name] = next((u for u in COLUMN_UNITS if math.isclose(factor, u, rel_tol=SLIGHT)), 1.0)
    remainder = runs.apart({name: answer[name] / factor for name, factor in factors.items()}, exact)
    if len({*factors.values()}) == 1 or remainder > 1:
        return None
    factors_of_columns = {name: factor for name, factor in factors.items() if factor != 1}
    sentence = " and ".join(
        f"{name} is in other units, {factor:g} times the motion's" for name, factor in factors_of_columns.items()
    )
    return Cause(sentence, ("unit",), factors_of_columns, (), remainder)


@dataclass(eq=False)
class Search:
    """The search for what gives an answer back."""

    runs: Runs
    answer: Columns

    def causes(self) -> list[Cause]:
        """Return all causes that leave less than the bar, the one that leaves least first."""
        causes = sorted(self._schemes(), key=lambda each: each.left)
        if causes and causes[0].left <= SAME:  # digit for digit
            return causes
        exact = self.runs.exact()
        # whether runs take so little that fits begin from many numbers: those of bars by DDA do, not their exact ones
        scene_features = {*features.of(self.runs.scene)}
        elastic_bars = features.OF_MOVING_COLUMN & scene_features and features.RIGID_BLOCKS not in scene_features
        quick = not {features.FRICTION, features.ROTATION} & scene_features
        for base in self._bases(exact, quick and not elastic_bars):
            causes += self._changes(base, quick and not (elastic_bars and base.exact))
        return sorted(causes, key=lambda each: (each.left, len(each.ids)))

    def _bases(self, exact: Base | None, cheap: bool) -> list[Base]:
        """Return the runs that one wrong number is put into: the exact motion's, and those of the usual schemes."""
        bases = [] if exact is None else [exact]
        if exact is not None and not exact.values and exact.every == 1:  # the scene's own scheme is exact enough
            return bases
        return [*bases, *(base for base in self.runs.schemes() if base.usual and (cheap or not base.values))]

    def _schemes(self) -> Iterable[Cause]:
        t = self.runs.scene.time
        for base in self.runs.schemes():
            remainder = self._left(self.runs.sampled(base))
            if remainder <= BAR:
                alpha, delta = base.pair(t)
                values = {"alpha": alpha, "delta": delta, "step": t.step / base.every}
                yield Cause(_scheme_sentence(base, self.runs.scene), ("scheme",), values, (), remainder, base)

    def _changes(self, base: Base, cheap: bool) -> Iterable[Cause]:
        """Yield the changes that give the answer back by a base, of those that come nearest along their slope.

        They are told by themselves where the base stands for the exact motion, else beside its scheme.
        """
        scene = self.runs.scene
        # the base may cut the scene's layers finer
        layers = {key: values for key, values in base.values.items() if key == "column.layer"}
        tried = of_scene(scene.with_values(layers), (*FACTORS, *UNITS) if cheap else FACTORS[:1])
        # a discount acts at every step of the scene
        others = {"scheme", "start", *(["gg"] if base.every > 1 else [])}
        changes = [change for change in tried if change.id not in others]
        dense = self.runs.dense(base) if base.exact else None
        if dense is not None:
            changes += [*of_damping(scene), *of_output(scene, dense, tuple(self.answer))]
        residual = partial(self._residual, base)
        for start in nearest(residual, changes, PURSUED, NEAR, NEAR):
            best = fitted(residual, start)
            remainder = self._left(self._columns(base, best.values))
            if remainder <= BAR and best.is_sensible:
                values = {} if best.value is None else {best.id: best.value}
                if base.exact:
                    yield Cause(best.words, (best.id,), values, (), remainder)
                else:
                    words = f"{_scheme_sentence(base, scene)}; and {best.words}"
                    yield Cause(words, ("scheme", best.id), values, (), remainder)

    def _columns(self, base: Base, values: Values) -> Columns | None:
        """Return the columns of a run by a base with other values, or those that are written of it."""
        return values[OUTPUT] if OUTPUT in values else self.runs.sampled(base, values)

    def _residual(self, base: Base, change: CandidateChange, u: float) -> Array:
        """Return the difference of the answer and a change's columns over norms and bands."""
        columns = self._columns(base, change.changed(u))
        if columns is None:
            columns = {name: np.full(len(x), np.inf) for name, x in self.answer.items()}
        shares = np.concatenate(self.runs.shares(self.answer, columns))
        return np.nan_to_num(np.clip(shares, -FARTHEST, FARTHEST), nan=FARTHEST)

    def _left(self, columns: Columns | None) -> float:
        """Return what columns leave of the answer over the band, inf where there are none."""
        return math.inf if columns is None else self.runs.apart(self.answer, columns)


# ---- words ----


def _scheme_sentence(base: Base, scene: Scene) -> str:
    t = scene.time
    alpha, delta = base.pair(t)
    damps = delta > 0.5 or t.discount < 1
    why = "numerical damping" if damps else "the error of its step"
    scene_features = features.of(scene)
    if features.COLUMN in scene_features and features.RIGID_BLOCKS not in scene_features:
        why += ", and the error of so many blocks"
    if base.every == 1 and (alpha, delta) == (0.5, 1.0):
        return f"DDA's usual scheme, {base.words}, at this step: {why}"
    step = "" if base.every > 1 else ", at this step"
    return f"another integrator, {base.words}{step}: {why}"


def _named(causes: Sequence[Cause]) -> Cause:
    """Return the usual one of the causes that leave hardly more than the least; nothing where these are too many."""
    bar = CLEAR * max(min(cause.left for cause in causes), BAR / CLEAR**2)
    near = [cause for cause in causes if cause.left <= bar]
    fewest = min(len(cause.ids) for cause in near)
    distinct: dict[tuple[object, ...], Cause] = {}  # a start that makes no difference is told once
    for cause in sorted((cause for cause in near if len(cause.ids) == fewest), key=_rank):
        distinct.setdefault((cause.ids, *(significant(value, 2) for value in cause.values.values())), cause)
    best, *others = distinct.values()
    if not others:
        return best
    if len(others) >= MOST_ALIKE:
        names = ", ".join(_short(cause) for cause in distinct.values())
        return Cause(
            f"{NOT_EXPLAINED}: the rows do not tell apart {names}", alike=tuple(map(_short, distinct.values()))
        )
    first, joint, _ = best.sentence.partition("; and ")
    same_rows = tuple(cause.sentence.removeprefix(first + joint) if joint else cause.sentence for cause in others)
    sentence = f"{best.sentence} (the same rows: {'; or '.join(same_rows)})"
    return Cause(sentence, best.ids, best.values, same_rows, best.left, best.base)


def _short(cause: Cause) -> str:
    """Return a cause by its ids and the number of the last, ``friction-factor 1.1``."""
    value = cause.values.get(cause.ids[-1])
    return " and ".join(cause.ids) + ("" if value is None else f" {value:.4g}")


def _rank(cause: Cause) -> tuple[int, float]:
    """Order causes by how usual they are, then by what they leave; one without a fitted number comes first."""
    if not cause.values:
        return -1, cause.left
    return max(USUAL.index(name) if name in USUAL else len(USUAL) for name in cause.ids), cause.left


# ---- compare ----


def compared(scene: Scene, history: History) -> Cause | None:
    """Return what `compare` names, None where it cannot look or names nothing."""
    columns = history.columns
    if DISPLACEMENT not in columns:
        return None
    foreign = Foreign(history.time, columns[DISPLACEMENT], columns.get(PRESSURE), sideways=columns.get(SIDEWAYS))
    try:
        answer = compare(scene, foreign)
    except (InputError, ArithmeticError, ValueError):
        return None
    if UNEXPLAINED in answer.causes or any(one["further_scene"] != ONE_SCHEME for one in answer.alike):
        return None
    return Cause(answer.sentence, tuple(answer.causes) or ("scheme",), dict(answer.values), (), answer.misfit)
