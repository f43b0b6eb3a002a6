"""The page of `advise` on a column: how to cut a bonded one for its wave, what to allow where contacts open or slip."""

from __future__ import annotations

import math
from dataclasses import asdict
from typing import Any

from validation.advice.columns import advised, column_alarms, limits, rest
from validation.advice.contact_page import elements, own
from validation.advice.goals import AVERAGE, Candidate, Question, Recommendation, difference, recommendation
from validation.advice.hooks import AdviceHooks
from validation.advice.pages import Page, PageHooks, page_of_cut
from validation.advice.spectra import truth_of
from validation.advice.wave_advice import advise_wave
from validation.advice.words import say
from validation.errors import InputError
from validation.models.column.tables import ColumnSection
from validation.runs.history import DISPLACEMENT
from validation.scenes.scene import Scene
from validation.solvers.registry import solve
from validation.theory import columns

MOST_STEPS = 4000  # of a run that is compared


class HOOKS(PageHooks):
    """The blocks of each layer and the step, or solves and rest."""

    def page(self, scene: Scene, question: Question) -> Page:
        """Return what the blocks of a bonded column do to its wave, or what is known of contacts before a run."""
        bounds = limits(scene)
        if bounds is None:
            return page_of_cut(scene, question, *recommended_cut(scene, question.error, question.frequency))
        resting = rest(scene)
        alarms = (f"ALARM {alarm.kind}: {alarm.sentence}" for alarm in column_alarms(scene))
        data = asdict(bounds) | {"rest": None if resting is None else asdict(resting)}
        return data, (*advised(scene, bounds, resting), *alarms)


def recommended_cut(scene: Scene, error: float, frequency: float | None = None) -> tuple[str, Recommendation]:
    """Return what the blocks and the step of a bonded column do to a wave, and which to take.

    Half of the error is left to the amplitude of the wave, half to its phase: a delay of a share of a period is an
    error of 2 pi of that. What is advised is run under the scene's own input.

    Raises
    ------
    InputError
        No blocks and step let the wave arrive, or nothing answers exactly.
    """
    column = scene.table(ColumnSection)
    if frequency is None and scene.stated_input is not None:
        frequency = scene.stated_input.frequency
    if frequency is None:
        first = columns.first_frequency(column)
        if first is None:
            raise InputError("must be given: the wave's", source=scene.name, field="--frequency", value="nothing")
        frequency = first / (2 * math.pi)
    advice = advise_wave(scene, frequency, error / 2, None, error / (4 * math.pi))
    if advice.advised is None:
        raise InputError(advice.advice, source=scene.name)
    settings: dict[str, Any] = {"time.step": advice.advised.step}
    layers = AdviceHooks.of(scene).cut(scene, advice.blocks).table(ColumnSection).layer
    settings["column.layer"] = [layer.model_dump(exclude_defaults=True) | {"blocks": layer.blocks} for layer in layers]
    steps = min(MOST_STEPS, math.ceil(scene.time.duration / advice.advised.step))
    case = scene.with_values(settings | {"time.steps": steps, "run.columns": [DISPLACEMENT]})
    truth = truth_of(case)
    name = truth or elements()
    history = solve(case, own()).history
    reference = solve(case if truth else case.with_values(AVERAGE), name).history
    if history is None or reference is None:
        raise InputError("has no motion to compare with", source=scene.name)
    displacement_error = difference(history, reference, DISPLACEMENT)
    condition = say("column condition", advice)
    candidate = Candidate(settings, steps, displacement_error)
    offer = recommendation(scene, "wave", condition, candidate, error, (name, 0.0), steps * advice.advised.step)
    return advice.sentence, offer
