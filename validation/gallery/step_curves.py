"""Error over time step of answers to one problem: small charts, drawn where a program answered it at several steps."""

from __future__ import annotations

import itertools
import math
from collections.abc import Mapping, Sequence
from typing import Any

from validation.problems.answers import AnswerSet
from validation.problems.data import AnswersData
from validation.problems.questions import names
from validation.report.chapters.judged import JudgedAnswer
from validation.report.chapters.judged_boxes import JudgedBoxes
from validation.report.chapters.text import short

WIDTH = 240.0
HEIGHT = 130.0
LEFT = 34.0  # of the drawing, for the numbers beside it
RIGHT = 10.0
TOP = 10.0
BOTTOM = 20.0
LEAST_RATIO = 1e-9  # of error and what is allowed: an answer nearer than that is the exact motion


def step_curves(sets: Sequence[tuple[AnswerSet, Mapping[str, JudgedAnswer | JudgedBoxes]]]) -> list[dict[str, Any]]:
    """Return a chart for each problem that one version answered at two steps of one scheme or more."""
    charts = []
    for name in names():
        points = [point for answers, judged in sets if (point := _point(answers, name, judged.get(name))) is not None]
        points.sort(key=lambda point: point[0])
        for (version, scheme), group in itertools.groupby(points, key=lambda point: point[0]):
            ratio_by_step = {step: ratio for _, step, ratio in group}
            if len(ratio_by_step) > 1:
                charts.append(_chart(name, version, scheme, sorted(ratio_by_step.items())))
    return charts


def _point(
    answers: AnswerSet, name: str, judged: JudgedAnswer | JudgedBoxes | None
) -> tuple[tuple[str, str], float, float] | None:
    """Return version and scheme, step [s] and error over what is allowed of an answer; None where one is missing."""
    if judged is None or not isinstance(answers.data, AnswersData):
        return None
    step = answers.data.step_of(name)
    ratio = _beside(judged)
    if step is None or ratio is None or not math.isfinite(ratio):
        return None
    return (answers.data.version, answers.data.scheme), step, max(ratio, LEAST_RATIO)


def _beside(judged: JudgedAnswer | JudgedBoxes) -> float | None:
    """Return the error over what is allowed of the column or number that decides; None where there is none."""
    if isinstance(judged, JudgedBoxes):
        return judged.deciding.beside
    deciding = judged.judgement.deciding
    if deciding is None or deciding.error is None or not deciding.band:
        return None
    return deciding.error / deciding.band


def _chart(name: str, version: str, scheme: str, points: Sequence[tuple[float, float]]) -> dict[str, Any]:
    """Return a chart on logarithmic axes: places of the answers, of the line of what is allowed, and their numbers."""
    steps = [math.log(step) for step, _ in points]
    ratios = [math.log(ratio) for _, ratio in points]
    low = min([*ratios, 0.0])
    high = max([*ratios, 0.0])

    def x(step: float) -> float:
        return LEFT + (WIDTH - LEFT - RIGHT) * (step - steps[0]) / (steps[-1] - steps[0])

    def y(ratio: float) -> float:
        return TOP + (HEIGHT - TOP - BOTTOM) * ((high - ratio) / (high - low) if high > low else 0.5)

    marks = [{"x": round(x(s), 1), "y": round(y(r), 1)} for s, r in zip(steps, ratios, strict=True)]
    description = ", ".join(f"{short(ratio, 2)} at {short(step, 2)} s" for step, ratio in reversed(points))
    return {
        "problem": name,
        "version": version,
        "scheme": scheme,
        "marks": marks,
        "line": " ".join(f"{mark['x']},{mark['y']}" for mark in marks),
        "allowed": round(y(0.0), 1),
        "first_step": f"{short(points[0][0], 2)} s",
        "last_step": f"{short(points[-1][0], 2)} s",
        "words": f"error over allowed {description}",
        "width": WIDTH,
        "height": HEIGHT,
        "left": LEFT,
        "right": RIGHT,
        "bottom": BOTTOM,
    }
