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
from validation.diagnosis.reading import SIDEWAYS, Foreign
from validation.errors import InputError
from validation.problems.bands import Standard
from validation.problems.families import Family, of_damping, of_data, of_discount, of_output
from validation.problems.models import Base, Columns, Runs
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
ROUNDS = 8  # evaluations of a fit
PURSUED, PURSUED_SLOW = 4, 3  # families that are fitted, the nearest ones; fewer where a run takes a second
NEAR = 3 * BAR  # what a family may leave along its slope and is fitted in any case
SAME = 1e-6  # of the band: digit for digit
MOST_ALIKE = 3  # causes that are named together
FARTHEST = 1e6  # bands: a run that leaves its bounds is no nearer than that
NOTHING = 1e-3  # of a per cent of the exact motion: an answer that is smaller does not move


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


def cause(problem: Problem, history: History, held: Standard) -> Cause:
    """Return the cause of a failure; silent rather than wrong."""
    seen = {name: x for name, x in history.columns.items() if name in held.bands}
    if told := _plain(seen, held):
        return told
    runs = Runs(problem.scene, held)
    found = Search(runs, seen).causes()
    if found:
        return _named(found)
    return compared(problem.scene, history) or Cause()


def _plain(seen: Columns, held: Standard) -> Cause | None:
    """Return what needs no run to be seen: no numbers, no motion."""
    for name, x in seen.items():
        if not np.isfinite(x).all():
            row = int(np.argmin(np.isfinite(x))) + 1
            return Cause(f"{name} is not a number from step {row} on", ("not-finite",), left=0.0)
    if all(float(np.max(np.abs(x))) <= NOTHING * _size(name, held) for name, x in seen.items()):
        return Cause("nothing moves", ("nothing-moves",), left=0.0)
    return None


def _size(name: str, held: Standard) -> float:
    return float(np.max(np.abs(held.exact.columns[name])))


@dataclass(eq=False)
class Search:
    """The search for what gives an answer back."""

    runs: Runs
    seen: Columns

    def causes(self) -> list[Cause]:
        """Return all causes that leave less than the bar, the one that leaves least first."""
        found = sorted(self._schemes(), key=lambda one: one.left)
        if found and found[0].left <= SAME:  # digit for digit
            return found
        exact = self.runs.exact()
        cheap = not {features.FRICTION, features.ROTATION} & {*features.of(self.runs.scene)}
        for base in self._bases(exact, cheap):
            found += [*self._laws(base), *self._families(base, cheap)]
        return sorted(found, key=lambda one: (one.left, len(one.ids)))

    def _bases(self, exact: Base | None, cheap: bool) -> list[Base]:
        """Return the runs that one wrong number is put into: the exact motion's, and those of the usual schemes."""
        found = [] if exact is None else [exact]
        if exact is not None and not exact.values:  # the scene's own scheme is exact enough by itself
            return found
        return [*found, *(base for base in self.runs.schemes() if base.usual and (cheap or not base.values))]

    def _schemes(self) -> Iterable[Cause]:
        t = self.runs.scene.time
        for base in self.runs.schemes():
            left = self._left(self.runs.sampled(base))
            if left <= BAR:
                values = {"alpha": base.alpha(t), "delta": base.delta(t), "step": t.step / base.every}
                yield Cause(_scheme_sentence(base, self.runs.scene), ("scheme",), values, (), left)

    def _laws(self, base: Base) -> Iterable[Cause]:
        """Yield other laws of the contact under which a base gives the answer back."""
        for law in laws(self.runs.scene):
            left = self._left(self.runs.sampled(base, law.values))
            if left <= BAR:
                yield _with(law.id, law.words, {}, left, base, self.runs.scene)

    def _families(self, base: Base, cheap: bool) -> Iterable[Cause]:
        families = [*of_data(self.runs, base, cheap), *of_discount(self.runs, base)]
        if base.exact:
            families += [*of_damping(self.runs, base), *of_output(self.runs, base, tuple(self.seen))]
        for family, start in self._pursued(families, cheap):
            u, left = self._fitted(family, start)
            if left <= BAR:
                yield _of_family(family, u, left, base, self.runs.scene)

    def _pursued(self, families: Sequence[Family], cheap: bool) -> list[tuple[Family, float]]:
        """Return the families that come nearest along their slope, each from its best start."""
        tried = [self._near(family, family.starts if cheap else family.starts[:1]) for family in families]
        order = sorted(range(len(families)), key=lambda i: tried[i][1])
        last = order[min(len(order), PURSUED if cheap else PURSUED_SLOW) - 1]
        bar = max(tried[last][1], NEAR)  # none is left out that may give the same rows
        return [(families[i], tried[i][0]) for i in order if tried[i][1] <= bar]

    def _near(self, family: Family, starts: Sequence[float]) -> tuple[float, float]:
        """Return the best start of a family, and what its best number leaves if the answer is linear in it there."""
        best = min(starts, key=lambda u: float(np.linalg.norm(self._residual(family, u))))
        at, then = self._residual(family, best), self._residual(family, best + family.nudge)
        slope = (then - at) / family.nudge
        size = float(slope @ slope)
        return best, float(np.linalg.norm(at - slope * (slope @ at) / size)) if size > 0 else math.inf

    def _residual(self, family: Family, u: float) -> Array:
        """Return the difference of the answer and a family's columns over norms and bands."""
        columns = family.of(u)
        parts = []
        for name, x in self.seen.items():
            band = self.runs.held.bands[name]
            size = float(np.linalg.norm(self.runs.held.exact.columns[name][: band.rows])) * band.high
            other = np.full(band.rows, np.inf) if columns is None else columns[name][: band.rows]
            parts.append((x[: band.rows] - other) / size)
        return np.nan_to_num(np.clip(np.concatenate(parts), -FARTHEST, FARTHEST), nan=FARTHEST)

    def _fitted(self, family: Family, start: float) -> tuple[float, float]:
        """Return the number that comes nearest, and what it leaves."""
        from scipy.optimize import least_squares

        done = least_squares(
            lambda u: self._residual(family, float(u[0])), [start], diff_step=1e-5, x_scale=0.05, max_nfev=ROUNDS
        )
        u = float(done.x[0])
        return u, self._left(family.of(u))

    def _left(self, columns: Columns | None) -> float:
        """Return what columns leave of the answer over the band, inf where there are none."""
        return math.inf if columns is None else self.runs.apart(self.seen, columns)


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


def _of_family(family: Family, u: float, left: float, base: Base, scene: Scene) -> Cause:
    value = float(f"{family.value(u):.6g}")
    return _with(family.id, family.words(value), {family.id: value}, left, base, scene)


def _with(name: str, said: str, values: dict[str, float], left: float, base: Base, scene: Scene) -> Cause:
    """Return a cause that a base shows: by itself where that stands for the exact motion, else beside its scheme."""
    if base.exact:
        return Cause(said, (name,), values, (), left)
    return Cause(f"{_scheme_sentence(base, scene)}; and {said}", ("scheme", name), values, (), left)


def _named(found: Sequence[Cause]) -> Cause:
    """Return the usual one of the causes that leave hardly more than the least; nothing where these are too many."""
    bar = CLEAR * max(found[0].left, BAR / CLEAR**2)
    near = [one for one in found if one.left <= bar]
    fewest = min(len(one.ids) for one in near)
    told: dict[tuple[object, ...], Cause] = {}  # a start that makes no difference is told once
    for one in sorted((one for one in near if len(one.ids) == fewest), key=_rank):
        told.setdefault((one.ids, *(float(f"{value:.2g}") for value in one.values.values())), one)
    best, *others = told.values()
    if not others:
        return best
    if len(others) >= MOST_ALIKE:
        names = ", ".join(_short(one) for one in told.values())
        return Cause(f"{NOT_EXPLAINED}: the rows do not tell apart {names}", alike=tuple(map(_short, told.values())))
    first, joint, _ = best.sentence.partition("; and ")
    alike = tuple(one.sentence.removeprefix(first + joint) if joint else one.sentence for one in others)
    return Cause(f"{best.sentence} (the same rows: {'; or '.join(alike)})", best.ids, best.values, alike, best.left)


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
