"""What a block should be run with for a goal: candidates are run by `dda`, the cheapest that keeps the error stays.

static
    The loads of the scene act at once; a candidate is judged by the steps until displacement and contact force stay
    within a hundredth of their limits. What remains is the model's: its static displacement against that of elements.
    A block that slides has no rest: its own motion is judged by the distance of a rigid block.
wave, quake
    The base moves as Ricker's wavelet, upwards, of a quake sideways as well. A candidate is judged by its history
    against that of elements under average acceleration with a finer step.
impact
    The block lands flat and without load, at four places of a step. A candidate is judged by the worst of them, by its
    history and its restitution against `block-events`, which is exact in time.

Unless they are to stay, the springs of every candidate give way by no more than the error of what the block itself
shortens down to its centroid under the same force, E a / (p h).
"""

from __future__ import annotations

import itertools
import math
import tempfile
import time
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from validation.advice.coarse import closed
from validation.advice.contact_page import elements, own
from validation.advice.contact_page import exact as exact_solver
from validation.advice.friction import sliding
from validation.advice.limits import Limit, check_choice
from validation.advice.plain import PlainAnswer
from validation.advice.spectra import dda_modes
from validation.advice.words import say
from validation.errors import InputError
from validation.metrics.columns import settling_step
from validation.metrics.pairs import relative_l2
from validation.metrics.values import as_number
from validation.runs import extras
from validation.runs.history import DISPLACEMENT, PRESSURE, History
from validation.runs.numbers import significant
from validation.runs.progress import Progress
from validation.scenes.scene import Scene
from validation.solvers.registry import get_solver, solve
from validation.theory import friction, landing, spectra, statics

GOALS = ("static", "wave", "impact", "quake")
ERROR = 0.05  # of displacement and contact force, that is allowed where nothing else is said
CONSTANT = {"time.scheme": "newmark", "time.alpha": 0.5, "time.delta": 1.0, "time.gg": 1.0}
AVERAGE = {"time.scheme": "newmark", "time.alpha": 0.25, "time.delta": 0.5, "time.gg": 1.0}
CONSERVING = AVERAGE | {"contact.rule": "energy-conserving"}
STIFFEST = {"time.scheme": "newmark", "time.alpha": 1.0, "time.delta": 1.5, "time.gg": 1.0}  # no root left at w dt >> 1
RESTED = 0.01  # of the static value, within which a quantity has settled
STATIC_STEPS = (0.5, 1.0, 2.0, 4.0, 8.0, 16.0, 32.0)  # w dt of the first mode
MOST_SETTLING = 400  # steps of a candidate
COARSEST = 10  # steps of a period of the wavelet; the finest candidate takes 2^(REFINEMENTS - 1) times as many
REFINEMENTS = 6
WAVELENGTHS = 20.0  # heights of the block in the wave that is taken where none is requested
ALONG = "horizontal_displacement"  # along the base
RIGID_BLOCK = "a rigid block on its slope"
AXES = {"wave": ("y",), "quake": ("x", "y")}  # along which the base moves
QUAKE = 5.0  # Hz of the wavelet of a quake where none is requested
ONSET = 1.5  # periods after which the wavelet peaks: it begins with less than 1e-8 of its height
DURATION = 4.0  # periods of a run
AMPLITUDE = 1e-3  # m of the wavelet; the motion is linear
PHASES = (0.0, 0.25, 0.5, 0.75)  # of a step, at which the block lands
FEWEST_SLIDE, FINEST_SLIDE = 32, 1024  # steps over the time that a block slides, of the coarsest and finest candidate
LONGEST_SLIDE = 1000  # steps of the scene that are run of it, at most
FEWEST_OF_CONTACT = 2  # steps of the first contact of a landing, of the coarsest candidate
FINEST_OF_CONTACT = 512  # and of the finest
ELEMENTS = 8  # per side of the reference, of degree two
RULE_DIGITS = 2  # of springs, frequency and step, as much as a rule of thumb has
SHORT = 60  # steps of the shorter of two runs that are timed; the longer has four times as many
Errors = tuple[float, float] | None  # of displacement and contact force [-]; None of a run that did not complete
NO_LOADS = {f"load.{name}": 0.0 for name in ("gravity", "pressure", "traction", "eccentricity", "slope", "ramp")}


@dataclass(frozen=True)
class Recommendation(PlainAnswer):
    """Settings for a goal, and what is left when `dda` is run with them."""

    goal: str
    condition: str  # under which the numbers hold, in words
    settings: dict[str, Any]  # for Scene.with_values
    is_reached: bool  # whether both errors are within the requested one
    displacement_error: float  # against the reference [-]
    force_error: float | None  # of the contact pressure, or of an impact of the restitution [-]; None if not compared
    reference: str
    uncertainty: float  # of the reference itself [-]
    steps: int  # for `duration`
    duration: float  # that is run for the goal [s]
    seconds: dict[str, float | None]  # solver -> estimate of what it takes; None where it does not apply


@dataclass(frozen=True)
class Candidate:
    """Settings that were run."""

    settings: dict[str, Any]
    steps: int
    displacement_error: float
    force_error: float | None = None

    @property
    def work(self) -> int:
        """Steps times blocks, in which candidates are ranked."""
        blocks: list[int] = self.settings.get("block.subdivide", [1])
        return self.steps * math.prod(blocks)

    @property
    def error(self) -> float:
        """The greater of both [-]."""
        return max(self.displacement_error, self.force_error or 0.0)


@dataclass(frozen=True)
class Trials:
    """Settings that are run at multiples of a step."""

    settings: Mapping[str, Any]
    finest: float  # step [s]
    steps: int  # of it
    errors: Callable[[dict[str, Any], int, int], Errors]  # of settings, multiple and steps

    def candidate(self, every: int) -> Candidate:
        """Return what a multiple of the finest step does."""
        settings = {**self.settings, "time.step": every * self.finest}
        steps = self.steps // every
        return Candidate(settings, steps, *(self.errors(settings, every, steps) or (math.inf, math.inf)))

    def longest_step(self, coarsest: int, error: float) -> Candidate:
        """Return the candidate with the longest step that keeps the error and keeps it at half that step too.

        An error of the step and one of the blocks may cancel at one step only. `coarsest`, a power of two, is the
        multiple to begin with.
        """
        candidate = self.candidate(coarsest)
        while coarsest > 1:
            coarsest //= 2
            finer = self.candidate(coarsest)
            if max(candidate.error, finer.error) <= error:
                return candidate
            candidate = finer
        return candidate


def yielding(scene: Scene, stiffness: float) -> float:
    """Return F / (2 p), what springs p give way by, over F h / (2 E a), what the block shortens to its centroid [-].

    Of a share it returns the p [N/m].
    """
    modulus, _ = statics.moduli(scene)
    return modulus * scene.block.base_length / (statics.height(scene) * stiffness)


@dataclass(frozen=True)
class Question:
    """What is asked of a scene; raises InputError by the options of the command line for what is none."""

    source: str = ""  # the words of the scene on a command line
    error: float = ERROR  # of displacement and contact force, that is allowed [-]
    goals: tuple[str, ...] = GOALS
    frequency: float | None = None  # of the wave or the quake [Hz]
    keep_springs: bool = False  # whether the springs are those of a real joint, and stay
    progress: Progress = lambda *_: None  # is told what has been done, of how much, what is next

    def __post_init__(self) -> None:
        for goal in self.goals:
            check_choice("--goal", goal, GOALS)
        Limit("--error", "must be above 0 and below 1", below=1.0).check(self.error)
        Limit("--frequency").check(self.frequency)

    @property
    def stated(self) -> str:
        """The options that all goals are asked for with, as one goal takes them."""
        options = "" if self.error == ERROR else f" --error {self.error:g}"
        if self.frequency is not None:
            options += f" --frequency {self.frequency:g}"
        return options + " --keep-springs" * self.keep_springs


def recommend(scene: Scene, goal: str, question: Question) -> tuple[Recommendation, ...]:
    """Return what a block, in a scene without a sweep, should be run with for one of `GOALS`.

    Of an impact it returns settings with energy-conserving contact as well.

    Raises
    ------
    InputError
        The goal does not apply to the scene, in words; or its exact motion needs a library that is not installed.
    """
    error = question.error
    values: dict[str, Any] = {}
    if not question.keep_springs or math.isinf(scene.contact.stiffness):  # a rigid stop has none to keep
        values = {"contact.stiffness": significant(yielding(scene, error), RULE_DIGITS)}
    values |= {"time.start": "zero", "run.columns": [DISPLACEMENT, PRESSURE]}
    if scene.time.scheme != "newmark":
        values |= CONSTANT  # explicit steps have a start of their own
    sprung = scene.with_values(values)
    block = closed(sprung)
    if goal == "impact":
        return _impacts(block, error, abs(scene.block.velocity))
    if goal != "static":
        usual = QUAKE if goal == "quake" else significant(1 / (WAVELENGTHS * spectra.transit(scene)), RULE_DIGITS)
        return (_driven(block, goal, error, question.frequency or usual),)
    slides = sliding(scene)
    if slides is None or slides.stands:
        return (_static(sprung, block, error),)
    # the longest step with which a block slides as far as a rigid one, on its own springs
    duration = min(scene.time.duration, LONGEST_SLIDE * scene.time.step)
    plain = scene.with_values(CONSTANT | {"run.columns": [ALONG, DISPLACEMENT, PRESSURE]})
    trials = Trials(
        CONSTANT,
        duration / FINEST_SLIDE,
        FINEST_SLIDE,
        lambda settings, _, steps: slide_errors(plain.with_values(settings | {"time.steps": steps})),
    )
    best = trials.longest_step(FINEST_SLIDE // FEWEST_SLIDE, error)
    return (recommendation(plain, "slide", say("slide condition"), best, error, (RIGID_BLOCK, 0.0), duration),)


# ---- static ----


def _static(scene: Scene, block: Scene, error: float) -> Recommendation:
    """Return the rows and the step with which a block comes to rest in the fewest steps.

    The contact of `scene` may open on the way; that of `block` is closed, so that there are static values.
    """
    if block.load.base_motion is not None or not get_solver(own()).static(block)[DISPLACEMENT]:
        raise _refusal("needs a load with a static answer", block, "static")
    coarse, fine = (get_solver(elements()).static(meshed) for meshed in _meshes(block))
    for cut in _cuts(block):
        limits = get_solver(own()).static(block.with_values(cut))
        errors = [abs(limits[name] / fine[name] - 1) for name in (DISPLACEMENT, PRESSURE)]
        if max(errors) <= error:
            break
    first = dda_modes(block)[0].frequency
    candidates = []
    for scheme, omega_dt in itertools.product((CONSTANT, STIFFEST), STATIC_STEPS):
        settings = scheme | cut | {"time.step": significant(omega_dt / first, RULE_DIGITS)}
        history = history_of_run(scene, own(), settings | {"time.steps": MOST_SETTLING})
        if history is None:
            continue
        rests = [settling_step(history.columns[name], limits[name], RESTED) for name in (DISPLACEMENT, PRESSURE)]
        steps = [rest for rest in rests if isinstance(rest, float)]
        if len(steps) == len(rests):
            candidates.append(Candidate(settings, int(max(steps)), *errors))
    if not candidates:
        raise _refusal(say("no rest", MOST_SETTLING), block, "static")
    best = min(candidates, key=lambda candidate: candidate.steps)
    reference = ("static elements", abs(coarse[DISPLACEMENT] / fine[DISPLACEMENT] - 1))
    duration = best.steps * float(best.settings["time.step"])
    return recommendation(scene, "static", say("static condition"), best, error, reference, duration)


def _refusal(rule: str, scene: Scene, goal: str) -> InputError:
    return InputError(rule, source=scene.name, field="--goal", value=goal)


def slide_errors(scene: Scene) -> Errors:
    """Return how far `dda` is from a rigid block that slides: of the distance, and of the mean contact pressure [-].

    Undamped stiff springs may let the exact block hop, which then slides farther; a rigid block stays on its slope.
    None where the run did not complete.
    """
    history = history_of_run(scene, own(), {"run.columns": [ALONG, DISPLACEMENT, PRESSURE]})
    if history is None:
        return None
    distance = abs(float(history.columns[ALONG][-1])) / friction.run_out(scene, scene.time.duration)
    pressure = scene.block.mass * friction.across(scene) / scene.block.base_length
    return abs(distance - 1), abs(float(np.mean(history.columns[PRESSURE])) / pressure - 1)


# ---- wave and quake ----


def _driven(block: Scene, goal: str, error: float, frequency: float) -> Recommendation:
    duration = DURATION / frequency
    finest = 1 / (frequency * COARSEST * 2 ** (REFINEMENTS - 1))
    axes = AXES[goal]
    with tempfile.TemporaryDirectory() as folder:
        record = Path(folder) / "wavelet.csv"
        # Ricker's wavelet (1 - 2 a^2) exp(-a^2), a = pi f (t - t0), as a record of the base
        times = np.arange(round(duration / finest) + 2) * finest
        a = (np.pi * (frequency * times - ONSET)) ** 2
        motion = AMPLITUDE * (1 - 2 * a) * np.exp(-a)
        table = np.column_stack([times, *[motion - motion[0]] * len(axes)])
        np.savetxt(record, table, delimiter=",", header=",".join(("time", *axes)), comments="")
        columns = [DISPLACEMENT, PRESSURE, *([ALONG] if "x" in axes else [])]
        driven = block.with_values(NO_LOADS | {"load.base_motion": str(record), "run.columns": columns})
        fine = AVERAGE | {"time.step": finest, "time.steps": round(duration / finest)}
        coarser, exact = (history_of_run(meshed, elements(), fine) for meshed in _meshes(driven))
        if exact is None or coarser is None:
            raise _refusal("the elements have no motion to compare with", block, goal)

        def errors(settings: dict[str, Any], every: int, steps: int) -> Errors:
            history = history_of_run(driven, own(), settings | {"time.steps": steps})
            if history is None:
                return None
            return difference(history, exact, DISPLACEMENT, every), difference(history, exact, PRESSURE, every)

        # the fewest steps times blocks that keep the error, or the least error
        tried: list[Candidate] = []
        good: list[Candidate] = []
        for cut in _cuts(driven):
            for scheme in (AVERAGE, CONSTANT):
                trials = Trials(scheme | cut, finest, len(exact.time), errors)
                tried.append(trials.candidate(1))
                if tried[-1].error <= error:
                    good.append(trials.longest_step(2 ** (REFINEMENTS - 1), error))
            if good:
                break
        best = min(
            good, key=lambda candidate: candidate.work, default=min(tried, key=lambda candidate: candidate.error)
        )
        condition = say(f"{goal} condition", frequency)
        reference = ("elements, fine in time", difference(coarser, exact, DISPLACEMENT))
        return recommendation(driven, goal, condition, best, error, reference, duration)


# ---- impact ----


def _impacts(block: Scene, error: float, own_speed: float) -> tuple[Recommendation, ...]:
    extras.require("the exact motion of an impact", *extras.EXACT)
    if block.block.rectangle is None:
        raise _refusal("needs an upright rectangle", block, "impact")
    speed = own_speed or 1.0
    transit = spectra.transit(block)
    contact_time = landing.own_landing(landing.stiffness_ratio(block)).duration * transit
    finest = contact_time / FINEST_OF_CONTACT
    duration = 3 * contact_time + 4 * transit  # the block is in flight again, whatever its springs
    values = NO_LOADS | {"contact.law": "unilateral", "contact.friction": None, "block.velocity": -speed}
    falling = block.with_values(values | {"run.columns": [DISPLACEMENT, PRESSURE]})
    steps = math.ceil(duration / finest)
    exact = history_of_run(falling, exact_solver(), AVERAGE | {"time.step": finest, "time.steps": steps})
    if exact is None:
        raise _refusal("has no exact motion of a landing", block, "impact")
    flight = np.concatenate([[0.0], exact.columns[DISPLACEMENT]])  # from the landing on

    def errors(settings: dict[str, Any], every: int, steps: int) -> Errors:
        """Return the worst errors of displacement and restitution over all phases of the first step."""
        step = settings["time.step"]
        worst = np.zeros(2)
        for phase in PHASES:
            before = round(phase * every)  # instants of the exact motion until the landing
            count = (len(flight) - 1) // every
            gap = before / every * step * speed
            history = history_of_run(falling, own(), {**settings, "contact.gap": gap, "time.steps": count})
            if history is None:
                return None
            displacement = history.columns[DISPLACEMENT]
            reference = flight[every - before :: every][:count] - gap
            rebounds = [float(motion[-1] - motion[-2]) / (step * speed) for motion in (displacement, reference)]
            worst = np.maximum(worst, [as_number(relative_l2(displacement, reference)), abs(rebounds[0] - rebounds[1])])
        return float(worst[0]), float(worst[1])

    condition = say("impact condition", "its own speed" if own_speed else "any speed")
    offers = []
    for method in (CONSTANT, CONSERVING):
        if method is CONSERVING and block.block.poisson != 0:
            continue  # its base slides, which the rule does not take with springs of shear
        trials = Trials(method, finest, steps, errors)
        best = trials.longest_step(FINEST_OF_CONTACT // FEWEST_OF_CONTACT, error)
        offers.append(
            recommendation(falling, "impact", condition, best, error, ("block-events, one strain", 0.0), duration)
        )
    return tuple(offers)


# ---- what all share ----


def _cuts(scene: Scene) -> list[dict[str, Any]]:
    """Return settings that leave a block whole or cut each side in two or four; of a rectangle, another stays whole.

    Each present block is cut upwards, and sideways where it strains sideways.
    """
    across, upwards = scene.block.cuts
    cuts: list[dict[str, Any]] = [{}]
    for pieces in (2, 4) if scene.block.rectangle is not None else ():
        sideways = pieces if scene.block.poisson else 1
        cuts.append({"block.subdivide": [across * sideways, upwards * pieces]})
    return cuts


def history_of_run(scene: Scene, solver: str, values: Mapping[str, Any]) -> History | None:
    """Return the history of a run with some values; None where it did not complete."""
    run = solve(scene.with_values(dict(values)), solver)
    return run.history if run.outcome.value == "completed" else None


def _meshes(scene: Scene) -> tuple[Scene, Scene]:
    """Return a scene on two meshes, the finer last; a mesh of the user's is all there is."""
    if scene.fem.mesh is not None:
        return scene, scene
    return scene.with_values({"fem.elements": ELEMENTS // 2}), scene.with_values({"fem.elements": ELEMENTS})


def difference(history: History, exact: History, column: str, every: int = 1) -> float:
    """Return the difference of a column over the exact one, by root mean squares, at each `every`-th exact instant."""
    reference = exact.columns[column][every - 1 :: every]
    values = history.columns[column][: len(reference)]
    return 0.0 if np.array_equal(values, reference) else as_number(relative_l2(values, reference))


def recommendation(
    scene: Scene,
    goal: str,
    condition: str,
    chosen: Candidate,
    error: float,
    reference: tuple[str, float],
    duration: float,
) -> Recommendation:
    """Return a candidate as what is recommended, timed on the scene that it was run on."""
    case = scene.with_values(chosen.settings)
    contact = scene.stated_contact
    steps = math.ceil(duration / case.time.step * (1 - 1e-9))
    return Recommendation(
        goal,
        condition,
        chosen.settings | ({} if contact is None else {"contact.stiffness": contact.stiffness}),
        chosen.error <= error,
        chosen.displacement_error,
        chosen.force_error,
        *reference,
        steps,
        duration,
        {solver: estimated_seconds(case, solver, steps) for solver in (own(), elements())},
    )


def estimated_seconds(scene: Scene, solver: str, steps: int) -> float | None:
    """Return about how long some steps of a solver take, with their set-up [s]; None where it does not apply.

    Many steps are estimated from two short runs, of which the longer has four times the steps of the shorter.
    """
    if get_solver(solver).refusal(scene):
        return None
    if steps <= 4 * SHORT:
        return seconds_of(scene, solver, steps)
    shorter, longer = (seconds_of(scene, solver, count) for count in (SHORT, 4 * SHORT))
    return longer + (steps - 4 * SHORT) * max(longer - shorter, 0.0) / (3 * SHORT)


def seconds_of(scene: Scene, solver: str, steps: int) -> float:
    """Return how long a run of some steps takes [s]."""
    start = time.perf_counter()
    solve(scene.with_values({"time.steps": steps}), solver)
    return time.perf_counter() - start
