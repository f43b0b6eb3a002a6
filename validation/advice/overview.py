"""What `dda-validate advise` says of a block: what its settings do, and what to take for each goal."""

from __future__ import annotations

import math
import shlex
from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any, NamedTuple

import numpy as np

from validation.advice import goals
from validation.advice.across import GAIN, rebound_of
from validation.advice.coarse import closed
from validation.advice.contact_page import elements, own
from validation.advice.contact_page import exact as exact_solver
from validation.advice.friction import left_of_a_distance, sliding
from validation.advice.friction import lines as friction_lines
from validation.advice.goals import AVERAGE, Recommendation
from validation.advice.plain import Line, PlainAnswer, in_columns
from validation.advice.spectra import CONTACT, damping, first_mode, runs, steps_to
from validation.errors import InputError
from validation.runs import extras
from validation.runs.history import DISPLACEMENT, PRESSURE
from validation.runs.numbers import share_text
from validation.runs.progress import Progress
from validation.scenes import features
from validation.scenes.scene import Scene
from validation.solvers.contract import Role
from validation.solvers.registry import by_role, get_solver, solve
from validation.theory import landing
from validation.theory.stepping import Stepping

LONGEST = 400  # steps of the scene that its own error is measured over
FINER = 8  # times, of the elements' step, where nothing exact in time applies
PARTS = {  # what shows more: the command, and the options that it needs
    "damping": ("advise damping", ""),
    "contact": ("advise contact", " --set contact.law=unilateral"),
    "schemes": ("advise schemes", " --damping 0.05"),
}
STILL = 1e-14  # of the height: a displacement that is rounding
FADED = 0.01  # of an amplitude that has rung down


class Fact(NamedTuple):
    """What the present settings do in one respect."""

    subject: str
    sentence: str
    part: str  # of the command `advise`, which shows more


@dataclass(frozen=True)
class PresentError(PlainAnswer):
    """How far the scene's own run is from its exact motion."""

    reference: str
    window: float  # that is compared [s]
    displacement: float  # relative, by root mean squares [-]
    force: float  # of the contact pressure [-]


@dataclass(frozen=True)
class Overview(PlainAnswer):
    """Everything at once."""

    scene: str
    error: float  # requested [-]
    facts: tuple[Fact, ...]
    present: PresentError | None
    recommendations: tuple[Recommendation, ...]
    refused: dict[str, str]  # goal -> why there is nothing to take for it


def overview(
    scene: Scene,
    chosen: tuple[str, ...] = goals.GOALS,
    error: float = 0.05,
    frequency: float | None = None,
    progress: Progress = lambda *_: None,
    keep_springs: bool = False,
) -> Overview:
    """Return what the settings of a block do, and what to take for goals.

    Parameters
    ----------
    scene
        A scene of a block, without a sweep.
    chosen
        Goals among `goals.GOALS`.
    error
        Relative error of displacement and contact force that is allowed [-].
    frequency
        Of the wave and the quake [Hz].
    progress
        Is told what has been done, how much there is, and what comes next.
    keep_springs
        Whether the springs are those of a real joint, and stay.

    Raises
    ------
    InputError
        The scene is of no block, or has a sweep.
    """
    features.refuse_sweep(scene)
    features.refuse_column(scene, "advise")
    progress(0, len(chosen) + 1, "the present settings")
    present = _present_error(scene)
    facts = tuple(_facts(scene))
    recommendations: list[Recommendation] = []
    refused: dict[str, str] = {}
    for number, goal in enumerate(chosen, 1):
        progress(number, len(chosen) + 1, goal)
        try:
            recommendations += goals.recommend(scene, goal, error, frequency, keep_springs)
        except InputError as reason:
            refused[goal] = reason.rule
    return Overview(scene.name, error, facts, present, tuple(recommendations), refused)


def _facts(scene: Scene) -> Iterator[Fact]:
    """Yield what the step, the springs and the discount do."""
    block = closed(goals.at_rest(scene))
    if scene.load.slope:
        block = block.with_values({"load.slope": 0.0})  # the modes that its weight across the base reaches
    analysis = damping(block)
    first = analysis.modes[0]
    yield Fact("first mode", f"{first.frequency:.4g} rad/s, w dt = {first.omega_dt:.3g}: {runs(first)}", "damping")
    for mode in analysis.modes:
        if mode.name == CONTACT:
            sentence = f"{mode.frequency:.4g} rad/s: {runs(mode)}"
            steps = steps_to(FADED, mode.spectral_radius)
            if math.isfinite(steps):
                sentence += f"; rings down to 1 % in {math.ceil(steps)} steps"
            yield Fact("contact mode", sentence, "damping")
    finer = first_mode(block, elements()).get("frequency")
    if finer:
        off = first.frequency / finer - 1
        side = "above" if off >= 0 else "below"
        sentence = f"its first frequency is {share_text(abs(off))} {side} that of elements on the same springs"
        yield Fact("one strain" if scene.block.subdivide is None else "strains", sentence, "damping")
    if math.isfinite(scene.contact.stiffness):
        share = share_text(goals.yielding(scene))
        sentence = f"p = {scene.contact.stiffness:.4g} N/m give way by {share} of what the block shortens to its middle"
        yield Fact("springs", sentence, "contact")
    t = scene.time
    if t.discount < 1:
        sentence = f"gg = {t.discount:.6g} acts per step; {left_of_a_distance(t.discount, t.step)}"
        yield Fact("discount", sentence, "damping")
    if scene.block.rectangle is not None and math.isfinite(scene.contact.stiffness):
        most = rebound_of(Stepping.of(scene).stages, landing.contact_frequency(scene) * t.step).most
        may = "may gain energy" if most > 1 + GAIN else "gains nothing"
        yield Fact("switching", f"a landing on these springs at this step {may}: rebound at most {most:.3g}", "schemes")


def _present_error(scene: Scene) -> PresentError | None:
    """Return how far the scene's own run is from its exact motion, or a block that slides from a rigid one."""
    steps = min(scene.time.steps, LONGEST)
    case = scene.with_values({"time.steps": steps, "run.columns": [DISPLACEMENT, PRESSURE]})
    slides = sliding(case)
    if slides is not None and not slides.stands:
        slid = goals.slide_errors(case)
        return None if slid is None else PresentError(goals.RIGID_BLOCK, case.time.duration, *slid)
    every = 1
    truths = [name for name in by_role(Role.TRUTH) if get_solver(name).refusal(case) is None]
    if not features.linear(scene):
        name, exact = exact_solver(), case.with_values({"time.gg": 1.0})
        if extras.missing(*extras.EXACT):
            return None
    elif truths:
        name, exact = truths[0], case
    else:
        name, every = elements(), FINER
        exact = case.with_values(AVERAGE | {"time.step": case.time.step / FINER, "time.steps": FINER * steps})
    if get_solver(name).refusal(exact) or get_solver(own()).refusal(case):
        return None
    history = solve(case, own()).history
    reference = solve(exact, name).history
    if history is None or reference is None or len(reference.time) < every * len(history.time):
        return None
    if np.max(np.abs(reference.columns[DISPLACEMENT])) <= STILL * scene.block.extent[1]:
        return None  # nothing moves upwards or downwards but by rounding
    errors = [goals.difference(history, reference, column, every) for column in (DISPLACEMENT, PRESSURE)]
    return PresentError(name, steps * case.time.step, *errors)


# ---- in words -------------------------------------------------------------------------------------------------------


def lines(scene: Scene, source: str, answer: Overview, stated: str = "") -> Iterator[str]:
    """Yield the lines of one page of text on a block.

    Parameters
    ----------
    scene, answer
        The block and what was found.
    source, stated
        The words of the scene on a command line, and the options that its goals were asked for with.
    """
    t = scene.time
    width, height = scene.block.extent
    numbers = f"{Stepping.of(scene).numbers}, gg = {t.discount:.6g}"
    yield f"{scene.name}: {width:g} x {height:g} m, {scene.block.mass:.4g} kg, dt = {t.step:g} s, {numbers}"
    yield ""
    yield "What these settings do"
    yield in_columns([(f"  {fact.subject}", fact.sentence) for fact in answer.facts])
    slides = sliding(scene)
    if slides is not None:
        yield from friction_lines(scene, slides)
    present = answer.present
    if present is not None:
        errors = f"displacement {share_text(present.displacement)}, contact force {share_text(present.force)}"
        yield f"  error: {errors} over {present.window:.4g} s, against {present.reference}"
    for part, (command, options) in PARTS.items():
        subjects = [fact.subject for fact in answer.facts if fact.part == part]
        if part == "damping" and not features.linear(scene):
            command = "show"  # which closes the contact, without which there are no modes
        if subjects:
            yield f"  more on {', '.join(subjects)}: dda-validate {command} {source}{options}"
    yield ""
    yield from recommended(source, answer, stated)


def recommended(source: str, answer: Overview, stated: str = "") -> Iterator[str]:
    """Yield what to take, its conditions, and what to type next."""
    if answer.recommendations:
        how = "each as run by dda, seconds estimated; for springs of a real joint add --keep-springs"
        yield f"What to take for an error of {share_text(answer.error)}, {how}"
        yield in_columns(_table(answer))
    for goal, offer in {offer.goal: offer for offer in answer.recommendations}.items():
        known = f" (itself within {share_text(offer.uncertainty)})" if offer.uncertainty > 1e-6 else ""
        yield f"{goal}: {offer.condition}; against {offer.reference}{known}"
    yield from (f"{goal}: {why}" for goal, why in answer.refused.items())
    if missed := [offer.goal for offer in answer.recommendations if not offer.is_reached]:
        yield f"{', '.join(dict.fromkeys(missed))}: nothing that was tried keeps the error; the least is shown"
    if len(answer.recommendations) == 1:
        settings = answer.recommendations[0].settings
        sets = " ".join(f"--set {shlex.quote(f'{key}={_written(value)}')}" for key, value in settings.items())
        yield f"next: dda-validate run {source} {sets}"
    elif answer.recommendations:
        yield f"next: dda-validate advise {source}{stated} --goal {'|'.join(goals.GOALS)}, which names what to --set"


def _table(answer: Overview) -> list[Line]:
    inputs = ("", "dt [s]", "alpha, delta", "gg", "p [N/m]", "blocks")
    rows: list[Line] = [(*inputs, "displacement", "force", "steps", "dda [s]", "fem [s]")]
    for offer in answer.recommendations:
        values = offer.settings
        scheme = "as is"
        if "time.alpha" in values:
            rule = values.get("contact.rule", "")
            scheme = f"{values['time.alpha']:g}, {values['time.delta']:g} {rule}".rstrip()
        cut = values.get("block.subdivide") or values.get("plane.subdivide") or ["as is"]
        if "column.layer" in values:
            cut = [layer["blocks"] for layer in values["column.layer"]]
        separator = ", " if "column.layer" in values else " x "
        stiffness = values.get("contact.stiffness")
        numbers = (
            f"{values.get('time.step', math.nan):.4g}",
            scheme,
            f"{values['time.gg']:g}" if "time.gg" in values else "as is",
            "-" if stiffness is None else f"{stiffness:.3g}",
            separator.join(map(str, cut)),
            _share(offer.displacement_error),
            _share(offer.force_error),
            str(offer.steps),
        )
        seconds = ("-" if value is None else f"{value:.2g}" for value in offer.seconds.values())
        rows.append((offer.goal, *numbers, *seconds))
    return rows


def _share(value: float | None) -> str:
    """Return an error in per cent, which below a thousandth of one is rounding or as good."""
    if value is None:
        return "-"
    return share_text(value) if value >= 1e-5 else "0 %"


def _written(value: Any) -> str:
    """Return a value as ``--set`` takes it."""
    if isinstance(value, float):
        return f"{value:.6g}"
    if isinstance(value, dict):
        pairs = ", ".join(f"{key} = {_written(part)}" for key, part in value.items() if part is not None)
        return f"{{ {pairs} }}"
    if isinstance(value, list):
        return f"[{', '.join(map(_written, value))}]"
    return str(value)
