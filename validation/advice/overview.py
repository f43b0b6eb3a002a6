"""What `dda-validate advise` says of a block: what its settings do, and what to take for each goal."""

from __future__ import annotations

import math
import shlex
from collections.abc import Iterator, Sequence
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
from validation.advice.goals import AVERAGE, Question, Recommendation
from validation.advice.plain import Line, PlainAnswer, in_columns
from validation.advice.spectra import CONTACT, damping, first_mode, runs, steps_to, truth_of
from validation.advice.words import say
from validation.errors import InputError
from validation.runs import extras
from validation.runs.history import DISPLACEMENT, PRESSURE
from validation.runs.numbers import number_text, share_text
from validation.scenes import features
from validation.scenes.scene import Scene
from validation.solvers.registry import get_solver, solve
from validation.theory import landing
from validation.theory.stepping import Stepping

LONGEST = 400  # steps of the scene that its own error is measured over
FINER = 8  # times, of the elements' step, where nothing exact in time applies
PARTS = {  # what shows more: the command, and the options that it needs
    "damping": ("advise damping", ""),
    "contact": ("advise contact", " --set contact.law=unilateral"),
    "schemes": ("advise schemes", " --damping 0.05"),
}
HEADS = (
    *("", "dt [s]", "alpha, delta", "gg", "p [N/m]", "blocks"),
    *("displacement", "force", "steps", "dda [s]", "fem [s]"),
)
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


def overview(scene: Scene, question: Question) -> Overview:
    """Return what the settings of a block do, and what to take for goals.

    Raises InputError for a scene of no block or with a sweep.
    """
    features.refuse_sweep(scene)
    features.refuse_column(scene, "advise")
    count = len(question.goals) + 1
    question.progress(0, count, "the present settings")
    present = _present_error(scene)
    facts = tuple(_facts(scene))
    recommendations: list[Recommendation] = []
    refused: dict[str, str] = {}
    for number, goal in enumerate(question.goals, 1):
        question.progress(number, count, goal)
        try:
            recommendations += goals.recommend(scene, goal, question)
        except InputError as reason:
            refused[goal] = reason.rule
    return Overview(scene.name, question.error, facts, present, tuple(recommendations), refused)


def _facts(scene: Scene) -> Iterator[Fact]:
    """Yield what the step, the springs and the discount do."""
    block = closed(scene)
    if scene.load.slope:
        block = block.with_values({"load.slope": 0.0})  # the modes that its weight across the base reaches
    first, *others = damping(block).modes
    yield Fact("first mode", say("first mode", first, runs=runs(first)), "damping")
    for mode in others:
        if mode.name == CONTACT:
            steps = steps_to(FADED, mode.spectral_radius)
            decay = say("rings down", math.ceil(steps)) if math.isfinite(steps) else ""
            yield Fact("contact mode", say("contact mode", mode, runs=runs(mode), decay=decay), "damping")
    finer = first_mode(block, elements()).get("frequency")
    if finer:
        off = first.frequency / finer - 1
        sentence = say("above elements" if off >= 0 else "below elements", abs(off))
        yield Fact("one strain" if scene.block.subdivide is None else "strains", sentence, "damping")
    is_sprung = math.isfinite(scene.contact.stiffness)
    if is_sprung:
        share = goals.yielding(scene, scene.contact.stiffness)
        yield Fact("springs", say("springs give way", scene.contact, share=share), "contact")
    t = scene.time
    if t.discount < 1:
        yield Fact("discount", say("discount", t, left=left_of_a_distance(t.discount, t.step)), "damping")
    if scene.block.rectangle is not None and is_sprung:
        most = rebound_of(Stepping.of(scene).stages, landing.contact_frequency(scene) * t.step).most
        yield Fact("switching", say("may gain" if most > 1 + GAIN else "gains nothing", most), "schemes")


def _present_error(scene: Scene) -> PresentError | None:
    """Return how far the scene's own run is from its exact motion, or a block that slides from a rigid one."""
    steps = min(scene.time.steps, LONGEST)
    case = scene.with_values({"time.steps": steps, "run.columns": [DISPLACEMENT, PRESSURE]})
    slides = sliding(case)
    if slides is not None and not slides.stands:
        slid = goals.slide_errors(case)
        return None if slid is None else PresentError(goals.RIGID_BLOCK, case.time.duration, *slid)
    every = 1
    truth = truth_of(case)
    if not features.linear(scene):
        name, exact = exact_solver(), case.with_values({"time.gg": 1.0})
        if extras.missing(*extras.EXACT):
            return None
    elif truth:
        name, exact = truth, case
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


# ---- in words ----


def lines(scene: Scene, question: Question, answer: Overview) -> Iterator[str]:
    """Yield the lines of one page of text on a block."""
    yield say("block", scene, size=scene.block.extent, stepping=Stepping.of(scene))
    yield ""
    yield "What these settings do"
    yield in_columns([(f"  {fact.subject}", fact.sentence) for fact in answer.facts])
    slides = sliding(scene)
    if slides is not None:
        yield from friction_lines(scene, slides)
    if answer.present is not None:
        yield say("present error", answer.present)
    for part, (command, options) in PARTS.items():
        subjects = [fact.subject for fact in answer.facts if fact.part == part]
        if part == "damping" and not features.linear(scene):
            command = "show"  # which closes the contact, without which there are no modes
        if subjects:
            yield say("more", ", ".join(subjects), command=command, source=question.source, options=options)
    yield ""
    yield from recommended(question, answer)


def recommended(question: Question, answer: Overview) -> Iterator[str]:
    """Yield what to take, its conditions, and what to type next."""
    offers = answer.recommendations
    if offers:
        yield say("what to take", answer)
        yield in_columns(_table(offers))
    for offer in {offer.goal: offer for offer in offers}.values():
        yield say("offer" if offer.uncertainty <= 1e-6 else "offer by an uncertain reference", offer)
    yield from (f"{goal}: {why}" for goal, why in answer.refused.items())
    if missed := [offer.goal for offer in offers if not offer.is_reached]:
        yield say("missed", ", ".join(dict.fromkeys(missed)))
    if len(offers) == 1:
        settings = offers[0].settings
        sets = " ".join(f"--set {shlex.quote(f'{key}={_written(value)}')}" for key, value in settings.items())
        yield say("next run", question.source, sets)
    elif offers:
        yield say("next goal", question, "|".join(goals.GOALS))


def _table(offers: Sequence[Recommendation]) -> list[Line]:
    rows: list[Line] = [HEADS]
    for offer in offers:
        values = offer.settings
        scheme = "as is"
        if "time.alpha" in values:
            scheme = f"{values['time.alpha']:g}, {values['time.delta']:g} {values.get('contact.rule', '')}".rstrip()
        cut = " x ".join(map(str, values.get("block.subdivide") or values.get("plane.subdivide") or ["as is"]))
        if "column.layer" in values:
            cut = ", ".join(str(layer["blocks"]) for layer in values["column.layer"])
        numbers = (
            f"{values.get('time.step', math.nan):.4g}",
            scheme,
            f"{values['time.gg']:g}" if "time.gg" in values else "as is",
            number_text(values.get("contact.stiffness"), 3),
            cut,
            _share(offer.displacement_error),
            _share(offer.force_error),
            str(offer.steps),
            *(number_text(value, 2) for value in offer.seconds.values()),
        )
        rows.append((offer.goal, *numbers))
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
