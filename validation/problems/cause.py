"""The cause of a failure, where it is certain: what, put into the exact motion, gives the answer back.

An answer fails by more than its band. What explains it must leave less than a tenth of that band in every column that
is judged: less than a tenth of the least error that fails, so that nothing which fails by itself is left over. Where
several causes leave as little, all of them are named, since the rows do not tell them apart; where more than a few do,
or none, nothing is named.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, field

import numpy as np

from validation.diagnosis.causes import UNEXPLAINED
from validation.diagnosis.judgement import compare
from validation.diagnosis.numbers import laws
from validation.diagnosis.one_change import Residual, alike, fitted, nearest, nearest_start
from validation.diagnosis.reading import SIDEWAYS, Foreign
from validation.errors import InputError
from validation.problems.bands import Standard
from validation.problems.families import Change, of_damping, of_data, of_output, springs_alike
from validation.problems.models import Base, Columns, Runs, runs_of
from validation.problems.problem import Problem
from validation.runs.history import DISPLACEMENT, PRESSURE, Array, History
from validation.scenes import features
from validation.scenes.scene import Scene

NOT_EXPLAINED = "not explained"
WOULD_TELL = (
    "the same run at half the step (an error of the integrator falls to a half or a quarter, one of the model stays), "
    "and one without the program's own damping"
)
OTHERS_WOULD = "an answer to another problem of the pack, on which these differ"
USUAL = (  # causes that give the same rows are told in this order
    *("scheme", "density-factor", "young-factor", "springs-factor", "friction-factor", "load-factor", "gravity-factor"),
    *("factor", "shift", "time-factor"),
)
BAR = 0.1  # of the band, that an explanation may leave
CLEAR = 10.0  # times more that every other cause must leave than the one that is named alone
ROUNDS, NUDGE = 8, 1e-5  # evaluations of a fit, and its relative change of a number for a derivative
PURSUED, PURSUED_SLOW = 4, 3  # changes that are fitted, the nearest ones; fewer where a run takes a second
NEAR = 3 * BAR  # what a change may leave along its slope and is fitted in any case
HOPELESS = 10.0  # bands that a fit leaves after its first rounds, beyond which it has to have halved them
SAME = 1e-6  # of the band: digit for digit
MOST_ALIKE = 3  # causes that are named together
FARTHEST = 1e6  # bands: a run that leaves its bounds is no nearer than that
NOTHING = 1e-7  # of the exact motion: an answer that is smaller does not move; in other units it is 1e-3 or 1e-6


@dataclass(frozen=True)
class Cause:
    """Why an answer fails: ids and numbers, and one line; no id where it is not explained.

    Attributes
    ----------
    sentence
        One line.
    ids
        Of the causes that are there together.
    values
        Their numbers.
    alike
        Sentences of other causes that give the same rows.
    left
        What the cause leaves of the answer, over the band, in the worst column [1].
    """

    sentence: str = NOT_EXPLAINED
    ids: tuple[str, ...] = ()
    values: dict[str, float] = field(default_factory=dict)
    alike: tuple[str, ...] = ()
    left: float = math.inf

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
    causes = Search(runs, answer).causes()
    if causes:
        return _named(causes)
    return compared(problem.scene, history) or Cause()


def _plain(answer: Columns, reference: Standard) -> Cause | None:
    """Return what needs no run to be seen: no numbers, no motion."""
    for name, x in answer.items():
        if not np.isfinite(x).all():
            row = int(np.argmin(np.isfinite(x))) + 1
            return Cause(f"{name} is not a number from step {row} on", ("not-finite",), left=0.0)
    if all(float(np.max(np.abs(x))) <= NOTHING * _size(name, reference) for name, x in answer.items()):
        return Cause("nothing moves", ("nothing-moves",), left=0.0)
    return None


def _size(name: str, reference: Standard) -> float:
    return float(np.max(np.abs(reference.exact.columns[name])))


@dataclass(eq=False)
class Search:
    """The search for what gives an answer back."""

    runs: Runs
    answer: Columns

    def causes(self) -> list[Cause]:
        """Return all causes that leave less than the bar, the one that leaves least first."""
        causes = sorted(self._schemes(), key=lambda one: one.left)
        if causes and causes[0].left <= SAME:  # digit for digit
            return causes
        exact = self.runs.exact()
        cheap = not {features.FRICTION, features.ROTATION} & {*features.of(self.runs.scene)}
        for base in self._bases(exact, cheap):
            causes += [*self._laws(base), *self._changes(base, cheap)]
        return sorted(causes, key=lambda one: (one.left, len(one.ids)))

    def _bases(self, exact: Base | None, cheap: bool) -> list[Base]:
        """Return the runs that one wrong number is put into: the exact motion's, and those of the usual schemes."""
        bases = [] if exact is None else [exact]
        if exact is not None and not exact.values:  # the scene's own scheme is exact enough by itself
            return bases
        return [*bases, *(base for base in self.runs.schemes() if base.usual and (cheap or not base.values))]

    def _schemes(self) -> Iterable[Cause]:
        t = self.runs.scene.time
        for base in self.runs.schemes():
            remainder = self._left(self.runs.sampled(base))
            if remainder <= BAR:
                values = {"alpha": base.alpha(t), "delta": base.delta(t), "step": t.step / base.every}
                yield Cause(_scheme_sentence(base, self.runs.scene), ("scheme",), values, (), remainder)

    def _laws(self, base: Base) -> Iterable[Cause]:
        """Yield other laws of the contact under which a base gives the answer back."""
        for law in laws(self.runs.scene):
            remainder = self._left(self.runs.sampled(base, law.values))
            if remainder <= BAR:
                yield _with(law.id, law.words, {}, remainder, base, self.runs.scene)

    def _changes(self, base: Base, cheap: bool) -> Iterable[Cause]:
        """Yield the changes by one number that give the answer back, of those that come nearest along their slope."""
        changes = list(of_data(self.runs, base, cheap))
        if base.exact:
            changes += [*of_damping(self.runs, base), *of_output(self.runs, base, tuple(self.answer))]
        starts = [nearest_start(self._residual(change), change) for change in changes]
        for start in nearest(starts, PURSUED if cheap else PURSUED_SLOW, NEAR):
            best = fitted(self._residual(start.change), start, ROUNDS, NUDGE, hopeless=HOPELESS)
            remainder = self._left(best.change.changed(best.u))
            if remainder <= BAR:
                yield _of_change(best.change, best.u, remainder, base, self.runs.scene)

    def _residual(self, change: Change) -> Residual:
        """Return the function of the difference of the answer and a change's columns over norms and bands."""

        def residual(u: float) -> Array:
            columns = change.changed(u)
            parts = []
            for name, x in self.answer.items():
                band = self.runs.standard.bands[name]
                size = float(np.linalg.norm(self.runs.standard.exact.columns[name][: band.rows])) * band.high
                other = np.full(band.rows, np.inf) if columns is None else columns[name][: band.rows]
                parts.append((x[: band.rows] - other) / size)
            return np.nan_to_num(np.clip(np.concatenate(parts), -FARTHEST, FARTHEST), nan=FARTHEST)

        return residual

    def _left(self, columns: Columns | None) -> float:
        """Return what columns leave of the answer over the band, inf where there are none."""
        return math.inf if columns is None else self.runs.apart(self.answer, columns)


# ---- words ----------------------------------------------------------------------------------------------------------


def _scheme_sentence(base: Base, scene: Scene) -> str:
    t = scene.time
    alpha, delta = base.alpha(t), base.delta(t)
    damps = delta > 0.5 or t.discount < 1
    why = "numerical damping" if damps else "the error of its step"
    why += "" if scene.column is None else ", and the error of so many blocks"
    if base.every == 1 and (alpha, delta) == (0.5, 1.0):
        return f"DDA's usual scheme, {base.words}, at this step: {why}"
    step = "" if base.every > 1 else ", at this step"
    return f"another integrator, {base.words}{step}: {why}"


def _of_change(change: Change, u: float, remainder: float, base: Base, scene: Scene) -> Cause:
    value = float(f"{change.value(u):.6g}")
    words = change.words(value) + springs_alike(scene, change.id, value)
    return _with(change.id, words, {change.id: value}, remainder, base, scene)


def _with(name: str, words: str, values: dict[str, float], remainder: float, base: Base, scene: Scene) -> Cause:
    """Return a cause that a base shows: by itself where that stands for the exact motion, else beside its scheme."""
    if base.exact:
        return Cause(words, (name,), values, (), remainder)
    return Cause(f"{_scheme_sentence(base, scene)}; and {words}", ("scheme", name), values, (), remainder)


def _named(causes: Sequence[Cause]) -> Cause:
    """Return the usual one of the causes that leave hardly more than the least; nothing where these are too many."""
    near = alike(causes, lambda one: one.left, CLEAR, BAR / CLEAR**2)
    fewest = min(len(one.ids) for one in near)
    distinct: dict[tuple[object, ...], Cause] = {}  # a start that makes no difference is told once
    for one in sorted((one for one in near if len(one.ids) == fewest), key=_rank):
        distinct.setdefault((one.ids, *(float(f"{value:.2g}") for value in one.values.values())), one)
    best, *others = distinct.values()
    if not others:
        return best
    if len(others) >= MOST_ALIKE:
        names = ", ".join(_short(one) for one in distinct.values())
        return Cause(
            f"{NOT_EXPLAINED}: the rows do not tell apart {names}", alike=tuple(map(_short, distinct.values()))
        )
    first, joint, _ = best.sentence.partition("; and ")
    same_rows = tuple(one.sentence.removeprefix(first + joint) if joint else one.sentence for one in others)
    sentence = f"{best.sentence} (the same rows: {'; or '.join(same_rows)})"
    return Cause(sentence, best.ids, best.values, same_rows, best.left)


def _short(one: Cause) -> str:
    """Return a cause by its ids and the number of the last, ``friction-factor 1.1``."""
    value = one.values.get(one.ids[-1])
    return " and ".join(one.ids) + ("" if value is None else f" {value:.4g}")


def _rank(one: Cause) -> tuple[int, float]:
    """Order causes by how usual they are, then by what they leave; one without a fitted number comes first."""
    if not one.values:
        return -1, one.left
    return max(USUAL.index(name) if name in USUAL else len(USUAL) for name in one.ids), one.left


# ---- compare --------------------------------------------------------------------------------------------------------


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
    if UNEXPLAINED in answer.causes or answer.alike:
        return None
    return Cause(answer.sentence, tuple(answer.causes) or ("scheme",), dict(answer.values), (), answer.misfit)
