"""Which time step, discount or scheme gives a target damping.

The target is the total damping ratio xi (algorithmic and kinetic) of the DDA block's first axial mode by the scheme's
closed form. Over dt, gg or delta xi is cut at its extrema into monotone pieces, and each piece that brackets the
target holds exactly one solution. For the scheme the family alpha = (1/2 + delta)^2 / 4, 1/2 <= delta <= 3/2, is
searched: the boundary of the paper's (14), with |lambda| at infinity from 1 down to 0.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import cached_property
from typing import NamedTuple

import numpy as np

from dda.scheme.spectral import Number, damping_ratio, spectral_radius
from validation.advice.friction import left_of_a_distance
from validation.advice.limits import check_choice, check_ratio
from validation.advice.plain import PlainAnswer
from validation.advice.spectra import CONTACT, ModeDamping, dda_modes, highest_frequency, rate_of, runs, steps_to
from validation.advice.spectra import damping as damping_of
from validation.advice.words import say
from validation.metrics.columns import settling_step
from validation.runs.history import Array, ArrayPair
from validation.scenes import features
from validation.scenes.scene import Scene
from validation.solvers.registry import get_solver, solve

FLAT = 1e-12  # relative; smaller turns of xi are rounding, not extrema
HALVINGS = 100  # of an interval in which xi ends to be defined: to the last bit
FLAT_RATE = 1e-9  # turns of xi that are rounding where gg = exp(-c dt), whose logarithm has lost digits
NO_STATIC = "no static displacement"  # in place of where a settling is from
LONGEST = 10_000  # steps that are run for the settling time; beyond, the envelope is used
GAIN = 3.0  # a mode's amplitude over its static share, at most: 1 at rest, more where roots collide


@dataclass(frozen=True)
class Solution:
    """One solution: the settings, and the damping and settling that follow from them."""

    value: float  # dt [s], gg [1] or delta [1]
    damping: float  # xi of the first axial mode there [1]
    settling_steps: int | None  # until displacement stays within 1 % of static under the scene's loads; None if never
    settling_seconds: float | None  # the same [s]
    settling_from: str  # "history", "envelope" where the history would be too long, or `NO_STATIC`
    alpha: float  # weight of the new acceleration in the displacement [1]
    delta: float  # and in the velocity [1]
    step: float  # dt [s]
    gg: float  # per step
    gg_rate: float | None  # c = -ln(gg) / dt [1/s]
    settings: dict[str, float]  # for Scene.with_values
    contact: ModeDamping | None


@dataclass(frozen=True)
class Advice(PlainAnswer):
    """The answer: all solutions in increasing order, the attainable range, and one sentence."""

    scene: str
    solve_for: str
    target: float  # xi [1]
    reachable: bool = False
    solutions: tuple[Solution, ...] = ()
    least: float | None = None  # smallest xi that can be reached [1], None where none is defined
    least_at: float | None = None  # dt [s], gg [1] or delta [1] there
    greatest: float | None = None  # greatest xi [1]
    greatest_at: float | None = None  # dt [s], gg [1] or delta [1] there
    sentence: str = ""


class Sought(NamedTuple):
    """What is varied."""

    words: str
    name: str
    key: str  # of scenes
    unit: str = ""


KINDS = {
    "dt": Sought("time step", "dt", "time.step", " s"),
    "gg": Sought("discount gg", "gg", "time.gg"),
    "scheme": Sought("delta with alpha = (1/2 + delta)^2 / 4", "delta", "time.delta"),
}


@dataclass(frozen=True)
class Search:
    """A search for all values of one parameter that give xi its target: a root between two samples around it."""

    grid: Array  # coordinates s, increasing
    numbers: Callable[[Array], tuple[Number, Number, Number, Number]]  # Omega, alpha, delta and gg there
    settings: Callable[[float], dict[str, float]]  # for Scene.with_values
    key: str  # of them, that is looked for
    highest: float  # frequency of the highest mode over that of the first
    flat: float = FLAT  # relative size of turns that are rounding

    @cached_property
    def samples(self) -> ArrayPair:
        """Coordinates and xi: the grid, its extrema refined, and the last ones at which xi is defined."""
        ratios = self.xi(self.grid)
        slopes = np.diff(ratios)
        bends = np.abs(np.diff(slopes)) > self.flat * np.abs(ratios[1:-1]) + np.finfo(float).eps
        turns = 1 + np.flatnonzero((slopes[1:] * slopes[:-1] <= 0) & bends)
        cuts = np.flatnonzero(np.diff(np.isfinite(ratios)))
        refined = [*map(self._extremum, turns.tolist()), *map(self._edge, cuts.tolist())]
        coordinates = np.unique([*self.grid, *refined])
        return coordinates, self.xi(coordinates)

    def xi(self, s: Array) -> Array:
        """Return xi, NaN wherever it is not finite or the highest mode grows."""
        omega, *scheme = self.numbers(s)
        radius = spectral_radius(omega * self.highest, *scheme)
        ratios = damping_ratio(omega, *scheme)
        return np.where((radius <= 1 + 1e-12) & np.isfinite(ratios), ratios, np.nan)

    def _edge(self, i: int) -> float:
        """Return the last coordinate between two neighbours of the grid at which xi is defined."""
        inside, outside = self.grid[i : i + 2] if np.isfinite(self.at(self.grid[i])) else self.grid[i : i + 2][::-1]
        for _ in range(HALVINGS):
            middle = (inside + outside) / 2
            inside, outside = (middle, outside) if np.isfinite(self.at(middle)) else (inside, middle)
        return float(inside)

    def _extremum(self, i: int) -> float:
        """Return where xi turns next to a point of the grid."""
        from scipy.optimize import minimize_scalar

        sign = np.sign(self.at(self.grid[i - 1]) - self.at(self.grid[i])) or 1.0
        bounds = self.grid[[i - 1, i + 1]]
        best = minimize_scalar(lambda s: sign * self.at(s), bounds=bounds, method="bounded", options={"xatol": 1e-14})
        return float(min(best.x, self.grid[i], key=lambda s: sign * self.at(s)))

    def value(self, s: float) -> float:
        """Return dt [s], gg [1] or delta [1] at one coordinate."""
        return self.settings(s)[self.key]

    def at(self, s: float) -> float:
        """Return xi at one coordinate."""
        return float(self.xi(np.array([s]))[0])

    def solutions(self, target: float) -> list[float]:
        """Return all coordinates at which xi is the target."""
        from scipy.optimize import brentq

        coordinates, ratios = self.samples
        excess = ratios - target
        is_passed = (excess[1:] * excess[:-1] <= 0) & (np.abs(excess[1:]) + np.abs(excess[:-1]) > 0)
        roots: list[float] = []
        for i in np.flatnonzero(is_passed):
            ends = coordinates[i : i + 2]
            root = brentq(lambda s: self.at(s) - target, *ends, xtol=1e-300, rtol=4 * np.finfo(float).eps)
            # a root at a sample belongs to both of its neighbours
            if not roots or not math.isclose(self.value(root), self.value(roots[-1]), rel_tol=1e-12):
                roots.append(root)
        return roots


def _search(scene: Scene, solve_for: str, frequency: float) -> Search:
    """Return the search over ln Omega, over -gg, or over delta on the family alpha = (1/2 + delta)^2 / 4."""
    t = scene.time
    key = KINDS[solve_for].key
    omega = frequency * t.step
    highest = highest_frequency(scene) / frequency  # of sub-blocks the modes are the lowest only
    if solve_for == "dt":
        rate = t.gg_rate
        # below c dt = 1e-6 xi at a fixed rate is c / (2 w) to the digits that gg = exp(-c dt) keeps
        lowest = min(1e-4, 1e-6 * frequency / rate) if rate else 1e-12

        def numbers(s: Array) -> tuple[Number, Number, Number, Number]:
            turn = np.exp(s)
            return turn, t.alpha, t.delta, np.exp(-rate / frequency * turn) if rate else t.discount

        grid = np.linspace(math.log(lowest), math.log(1e8), 4000)
        flat = FLAT_RATE if rate else FLAT
        return Search(grid, numbers, lambda s: {"time.step": math.exp(s) / frequency}, key, highest, flat)
    if solve_for == "gg":  # close to 1 the grid follows 1 - gg
        away = np.geomspace(1e-15, 1 - 1e-12, 3000)
        grid = np.unique(np.concatenate([[-1.0], away - 1, -np.geomspace(1e-12, 1e-3, 300)]))
        return Search(grid, lambda s: (omega, t.alpha, t.delta, -s), lambda s: {"time.gg": -s}, key, highest)
    grid = np.unique(np.concatenate([[0.5], 0.5 + np.geomspace(1e-14, 1, 2000), np.linspace(0.5, 1.5, 1000)]))
    return Search(
        grid,
        lambda s: (omega, (0.5 + s) ** 2 / 4, s, t.discount),
        lambda s: {"time.alpha": (0.5 + s) ** 2 / 4, "time.delta": s},
        key,
        highest,
    )


def advise(scene: Scene, damping: float, solve_for: str = "dt") -> Advice:
    """Return the values of dt, gg or delta that give the first axial mode the target damping ratio.

    Parameters
    ----------
    scene
        A scene without a sweep; its other settings stay as they are. A discount stated as `gg_rate` is kept as a
        rate when dt is solved for.
    damping
        Target xi [1], total: algorithmic and kinetic.
    solve_for
        "dt", "gg" (per step; the rate is given as well) or "scheme" (delta, with alpha = (1/2 + delta)^2 / 4).

    Raises
    ------
    InputError
        The scene has a sweep, the target is not a number from 0 to `LARGEST_RATIO`, or `solve_for` is unknown.

    Examples
    --------
    >>> from validation import advise, load_scene
    >>> scene = load_scene("figures-3-4").with_values({"time.step": 0.002})
    >>> [round(s.value, 6) for s in advise(scene, damping=0.05, solve_for="dt").solutions]
    [0.000584]
    """
    check_ratio(damping, 0.0)
    check_choice("solve_for", solve_for, KINDS)
    features.refuse_damping(scene, "advise")
    frequency = dda_modes(scene)[0].frequency
    search = _search(scene, solve_for, frequency)
    values = search.solutions(damping)
    coordinates, ratios = search.samples
    answer = Advice(scene.name, solve_for, float(damping))
    if np.isfinite(ratios).any():
        least = int(np.nanargmin(ratios))
        greatest = int(np.nanargmax(ratios))
        # average acceleration without discount has xi = 0 at any dt: the present one will do
        if not values and np.max(np.abs(ratios[[least, greatest]] - damping)) < 1e-15:
            present = {"dt": math.log(frequency * scene.time.step), "gg": -scene.time.discount}
            values = [present.get(solve_for, scene.time.delta)]
        answer = replace(
            answer,
            least=float(ratios[least]),
            least_at=search.value(float(coordinates[least])),
            greatest=float(ratios[greatest]),
            greatest_at=search.value(float(coordinates[greatest])),
        )
    found = (_solution(scene, solve_for, search.settings(s)) for s in values)
    solutions = tuple(sorted(found, key=lambda solution: solution.value))
    answer = replace(answer, reachable=bool(solutions), solutions=solutions)
    return replace(answer, sentence=_sentence(scene, answer))


def _solution(scene: Scene, solve_for: str, settings: dict[str, float]) -> Solution:
    case = scene.with_values(settings)
    first, *others = damping_of(case).modes
    t = case.time
    steps, source = _settling(case)
    return Solution(
        value=settings[KINDS[solve_for].key],
        damping=math.nan if first.damping is None else first.damping,
        settling_steps=steps,
        settling_seconds=None if steps is None else steps * t.step,
        settling_from=source,
        alpha=t.alpha,
        delta=t.delta,
        step=t.step,
        gg=t.discount,
        gg_rate=rate_of(t.discount, t.step),
        settings=settings,
        contact=next((mode for mode in others if mode.name == CONTACT), None),
    )


def _settling(case: Scene) -> tuple[int | None, str]:
    """Return the settling step of the displacement under the scene's own loads, and where it is from.

    That is its history or, where it is too long, the envelope. A displacement without a static value settles nowhere.
    """
    static = 0.0 if case.load.base_motion else get_solver("dda").static(case)["displacement"]
    if static == 0:
        return None, NO_STATIC
    modes = [(mode.spectral_radius, abs(mode.share)) for mode in dda_modes(case)]
    last = [steps_to(0.01 / (GAIN * share), radius) for radius, share in modes if share > 0]
    ramp = case.load.ramp / case.time.step  # steps until the load stands in full
    if max(last) + ramp > LONGEST:
        rough = ramp + max(steps_to(0.01 / share, radius) for radius, share in modes if share > 0)
        return (math.ceil(rough) if math.isfinite(rough) else None), "envelope"
    steps = max(10, math.ceil(ramp + max(last)) + 10)
    step = settling_step(solve(case.with_values({"time.steps": steps}), "dda").displacement, static)
    return (int(step) if isinstance(step, float) else None), "history"


# ---- the sentence ----


def _sentence(scene: Scene, answer: Advice) -> str:
    kind = KINDS[answer.solve_for]
    solutions = answer.solutions
    if not solutions:
        if answer.greatest is None or answer.least is None:
            why = "no ratio anywhere"
        elif answer.greatest - answer.least < FLAT:
            why = "flat"
        elif answer.least < answer.target < answer.greatest:
            why = "gap"
        else:
            why = "too much" if answer.target > answer.greatest else "too little"
        return say(
            "none damps", kind=kind, answer=answer, why=say(why, abs(answer.greatest or 0.0), kind=kind, answer=answer)
        )
    text = say("damps", answers=" or ".join(map(_answer, solutions)), answer=answer)
    if len(solutions) > 1:
        text += " in each case"
    settles = [say("settles", solution) for solution in solutions if solution.settling_steps]
    if settles:
        text += f" and the displacement settles within {' or '.join(settles)}"
    flips = [(solution, solution.contact) for solution in solutions if solution.contact and solution.contact.flips]
    if flips:
        last, contact = flips[-1]
        at = "" if len(flips) == len(solutions) else f" at {_answer(last)}"
        text += f", but the contact mode {runs(contact)}{at}"
    first = solutions[0]
    if "time.gg" in first.settings:
        text += say("valid gg", first, left=left_of_a_distance(first.value, first.step))
    elif "time.step" in first.settings and scene.time.gg_rate is not None:
        text += say("kept rate", scene.time)
    elif "time.step" in first.settings and scene.time.discount < 1:
        text += say("kept gg", scene.time)
    return text + "."


def _answer(solution: Solution) -> str:
    return say(next(iter(solution.settings)), solution)
