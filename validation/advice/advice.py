"""The adviser: which time step, discount or scheme gives a target damping.

The target is the total damping ratio xi (algorithmic and kinetic) of the DDA block's first axial mode by the scheme's
closed form. Over dt, gg or delta xi is cut at its extrema into monotone pieces, and each piece that brackets the
target holds exactly one solution. For the scheme the family alpha = (1/2 + delta)^2 / 4, 1/2 <= delta <= 3/2, is
searched: the boundary of the paper's (14), with |lambda| at infinity from 1 down to 0.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from dda.scheme.spectral import damping_ratio, spectral_radius
from validation.advice.friction import left_of_a_distance
from validation.advice.limits import check_choice, check_ratio
from validation.advice.plain import PlainAnswer
from validation.advice.search import FLAT, Search
from validation.advice.spectra import (
    CONTACT,
    ModeDamping,
    dda_modes,
    highest_frequency,
    mode_damping,
    mode_names,
    runs,
    steps_to,
)
from validation.metrics.columns import settling_step
from validation.runs.history import Array
from validation.runs.numbers import share_text
from validation.scenes import features
from validation.scenes.scene import Scene
from validation.solvers.registry import get_solver, solve

KINDS = {"dt": "time step", "gg": "discount gg", "scheme": "delta with alpha = (1/2 + delta)^2 / 4"}
FLAT_RATE = 1e-9  # turns of xi that are rounding where gg = exp(-c dt), whose logarithm has lost digits
NO_STATIC = "no static displacement"  # in place of where a settling is from
LONGEST = 10_000  # steps that are run for the settling time; beyond, the envelope is used
Reach = tuple[float | None, float | None, float | None, float | None]  # least xi and where, greatest xi and where
GAIN = 3.0  # a mode's amplitude over its static share, at most: 1 at rest, more where roots collide


@dataclass(frozen=True)
class Solution:
    """One solution: the settings, and the damping and settling that follow from them."""

    value: float  # dt [s], gg [1] or delta [1]
    damping: float  # xi of the first axial mode there [1]
    settling_steps: (
        int | None
    )  # displacement within 1 % of static under the scene's loads for ever after; None if never
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
    reachable: bool
    solutions: tuple[Solution, ...]
    least: float | None  # smallest xi that can be reached [1], None where none is defined
    least_at: float | None  # dt [s], gg [1] or delta [1] there
    greatest: float | None  # greatest xi [1]
    greatest_at: float | None  # dt [s], gg [1] or delta [1] there
    sentence: str


def _over_dt(scene: Scene, frequency: float, highest: float) -> Search:
    """Search over ln Omega, at fixed gg or at fixed rate."""
    t = scene.time
    rate = t.gg_rate

    def gg(omega: Array) -> Array | float:
        return t.discount if rate is None else np.exp(-rate / frequency * omega)

    # below c dt = 1e-6 xi at a fixed rate is c / (2 w) to the digits that gg = exp(-c dt) keeps
    lowest = min(1e-4, 1e-6 * frequency / rate) if rate else 1e-12
    flat = FLAT if rate is None else FLAT_RATE
    return Search(
        np.linspace(math.log(lowest), math.log(1e8), 4000),
        lambda s: _stable(np.exp(s), t.alpha, t.delta, gg(np.exp(s)), highest / frequency),
        lambda s: math.exp(s) / frequency,
        lambda s: {"time.step": math.exp(s) / frequency},
        flat,
    )


def _stable(omega: Array, alpha: float, delta: float, gg: Array | float, highest: float) -> Array:
    """Return xi over Omega, NaN where the highest mode grows."""
    radius = spectral_radius(omega * highest, alpha, delta, gg)
    return np.where(radius <= 1 + 1e-12, damping_ratio(omega, alpha, delta, gg), np.nan)


def _over_gg(scene: Scene, frequency: float, highest: float) -> Search:
    """Search over -gg, at the scene's time step; close to 1 the grid follows 1 - gg."""
    t = scene.time
    omega = frequency * t.step
    away = np.geomspace(1e-15, 1 - 1e-12, 3000)
    grid = np.unique(np.concatenate([[-1.0], away - 1, -np.geomspace(1e-12, 1e-3, 300)]))

    def xi(s: Array) -> Array:
        return _stable(np.full_like(s, omega), t.alpha, t.delta, -s, highest / frequency)

    return Search(grid, xi, lambda s: -s, lambda s: {"time.gg": -s})


def _over_scheme(scene: Scene, frequency: float, highest: float) -> Search:
    """Search over delta on the family alpha = (1/2 + delta)^2 / 4, at the scene's dt and gg."""
    omega = frequency * scene.time.step
    gg = scene.time.discount
    grid = np.unique(np.concatenate([[0.5], 0.5 + np.geomspace(1e-14, 1, 2000), np.linspace(0.5, 1.5, 1000)]))

    def alpha(delta: Array | float) -> Array | float:
        return (0.5 + delta) ** 2 / 4

    return Search(
        grid,
        lambda s: damping_ratio(np.full_like(s, omega), alpha(s), s, gg),
        lambda s: s,
        lambda s: {"time.alpha": float(alpha(s)), "time.delta": s},
    )


SEARCHES = {"dt": _over_dt, "gg": _over_gg, "scheme": _over_scheme}


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
    modes = dda_modes(scene)
    highest = highest_frequency(scene)  # of sub-blocks the modes are the lowest only
    search = SEARCHES[solve_for](scene, modes[0].frequency, highest)
    values = search.solutions(damping)
    coordinates, ratios = search.samples
    reach: Reach = (None, None, None, None)
    if np.isfinite(ratios).any():
        least, greatest = float(np.nanmin(ratios)), float(np.nanmax(ratios))
        # average acceleration without discount has xi = 0 at any dt: the present one will do
        if not values and max(abs(least - damping), abs(greatest - damping)) < 1e-15:
            present = {"dt": math.log(modes[0].frequency * scene.time.step), "gg": -scene.time.discount}
            values = [present.get(solve_for, scene.time.delta)]
        at_least, at_greatest = coordinates[[np.nanargmin(ratios), np.nanargmax(ratios)]]
        reach = (least, search.value(float(at_least)), greatest, search.value(float(at_greatest)))
    solutions = sorted((_solution(scene, search, s) for s in values), key=lambda solution: solution.value)
    text = _sentence(scene, solve_for, damping, solutions, reach)
    return Advice(scene.name, solve_for, float(damping), bool(solutions), tuple(solutions), *reach, text)


def _solution(scene: Scene, search: Search, s: float) -> Solution:
    settings = search.settings(s)
    case = scene.with_values(settings)
    modes = dda_modes(case)
    names = mode_names(modes)
    first = mode_damping(case, names[0], modes[0].frequency)
    contact = None
    if CONTACT in names:
        contact = mode_damping(case, CONTACT, modes[names.index(CONTACT)].frequency)
    t = case.time
    steps, source = _settling(case)
    seconds = None if steps is None else steps * t.step
    rate = -math.log(t.discount) / t.step + 0.0 if t.discount > 0 else None
    damping = math.nan if first.damping is None else first.damping
    return Solution(
        value=search.value(s),
        damping=damping,
        settling_steps=steps,
        settling_seconds=seconds,
        settling_from=source,
        alpha=t.alpha,
        delta=t.delta,
        step=t.step,
        gg=t.discount,
        gg_rate=rate,
        settings=settings,
        contact=contact,
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


# ---- the sentence -------------------------------------------------------------------------------------------------


def _sentence(scene: Scene, solve_for: str, target: float, solutions: Sequence[Solution], reach: Reach) -> str:
    """Return the answer in one sentence: what to set, and what follows from it."""
    if not solutions:
        least, least_at, greatest, greatest_at = reach
        refusal = (
            f"No {KINDS[solve_for]} damps the first axial mode of the DDA block at {share_text(target)} of critical"
        )
        if greatest is None or least is None or greatest_at is None or least_at is None:
            return f"{refusal}: the mode has no damping ratio here, since a root of the step is not positive."
        unit = " s" if solve_for == "dt" else ""
        name = {"dt": "dt", "gg": "gg", "scheme": "delta"}[solve_for]
        if greatest - least < FLAT:
            return f"{refusal}: the largest attainable value is {share_text(abs(greatest))}, at any {name}."
        if least < target < greatest:
            return f"{refusal}: it lies in a gap between attainable values."
        if target > greatest:
            largest = share_text(greatest)
            return f"{refusal}: the largest attainable value is {largest}, at {name} = {greatest_at:.6g}{unit}."
        return f"{refusal}: the smallest attainable value is {share_text(least)}, at {name} = {least_at:.6g}{unit}."
    first = solutions[0]
    answers = " or ".join(_answer(solve_for, s) for s in solutions)
    text = f"Set {answers}: the first axial mode of the DDA block is then damped at {share_text(target)} of critical"
    if len(solutions) > 1:
        text += " in each case"
    settles = [f"{s.settling_steps} steps ({s.settling_seconds:.4g} s)" for s in solutions if s.settling_steps]
    if settles:
        text += f" and the displacement settles within {' or '.join(settles)}"
    flips = [s for s in solutions if s.contact is not None and s.contact.flips]
    if flips:
        at = "" if len(flips) == len(solutions) else f" at {_answer(solve_for, flips[-1])}"
        text += f", but the contact mode {runs(flips[-1].contact)}{at}"  # type: ignore[arg-type]
    return text + _fixed_settings(scene, solve_for, first) + "."


def _answer(solve_for: str, solution: Solution) -> str:
    if solve_for == "dt":
        return f"dt = {solution.value:.6g} s"
    if solve_for == "gg":
        rate = "" if solution.gg_rate is None else f" (c = {solution.gg_rate:.4g} 1/s)"
        return f"gg = {solution.value:.6g} per step{rate}"
    return f"delta = {solution.value:.6g}, alpha = {solution.alpha:.6g}"


def _fixed_settings(scene: Scene, solve_for: str, solution: Solution) -> str:
    """Say which settings are fixed, where it matters."""
    t = scene.time
    if solve_for == "dt" and t.gg_rate is not None:
        return f"; the discount is kept as a rate, c = {t.gg_rate:g} 1/s"
    if solve_for == "dt" and t.discount < 1:
        return f"; gg = {t.discount:g} acts per step, so that refining dt at this gg does not converge"
    if solve_for == "gg":
        left = left_of_a_distance(solution.value, solution.step)
        return f"; this gg is valid at dt = {solution.step:g} s only, at another dt keep the rate c; {left}"
    return ""
