"""The cells of the field of engines: a program's answers to all cases of a problem, measured and judged."""

from __future__ import annotations

import functools
import itertools
import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from validation.engine.finished import Derived, Finished, NothingToDerive
from validation.gates.gate import settled
from validation.metrics import boxes as measures
from validation.problems.boxes import (
    FRICTIONS,
    PREFIX,
    SPINS,
    BoxCase,
    BoxProblem,
    MeasuredQuantity,
    box_problems,
    boxes_of,
    measured,
    standing_threshold,
    toppling_threshold,
)
from validation.runs.history import History
from validation.runs.row import Row, Value
from validation.runs.run import Outcome
from validation.scenes.scene import Scene
from validation.studies.field.programs import BOXES, Program, programs
from validation.studies.field.table import BESIDE, FAIL, PARTIAL, PASS, WRONG, cell_name, last_note

EXACT = "rigid-exact"
LEVELS = 4  # points that an order is fitted over, at least
SETTLED = 0.05  # of the band: what measuring at rows adds, greatest for a time of contact between two of them
FALLS = 1.2  # factor by which an error falls at every halving of the step that has an order
SHRINKS = 0.7  # of the first error: what the last one is below of a curve that shrinks


@dataclass(frozen=True)
class Answer:
    """A program's answer to a case, judged where there is one."""

    case: BoxCase
    scene: Scene
    row: Row | None
    history: History | None
    quantities: tuple[MeasuredQuantity, ...]


@functools.cache
def case_scenes(name: str) -> tuple[tuple[BoxCase, Scene], ...]:
    """Return the cases of a problem with their scenes."""
    problem = box_problems()[name]
    return tuple((case, problem.scene(case)) for case in problem.cases)


@functools.cache
def curve_scenes(name: str) -> tuple[Scene, ...]:
    """Return the scenes of a problem's curve, the coarsest first; none where it has none."""
    problem = box_problems()[name]
    if problem.curve is None:
        return ()
    most = max(program.halvings or 0 for program in programs(BOXES))
    return tuple(problem.curve_scene(refine) for refine in range(most + 1))


def scenes() -> Iterator[Scene]:
    """Yield all scenes of the study, each with the solvers that are asked it."""
    there = [program for program in programs(BOXES) if program.installed]
    names = [program.name for program in there]
    for name in box_problems():
        for _, scene in case_scenes(name):
            yield scene.with_values({"run.solvers": names}).model_copy(update={"name": scene.name})
        for refine, scene in enumerate(curve_scenes(name)):
            refined = [program.name for program in there if program.halvings is not None and program.halvings >= refine]
            if refined:
                yield scene.with_values({"run.solvers": refined}).model_copy(update={"name": scene.name})


def derived() -> Iterator[Derived]:
    """Yield the rows that are the cells of the programs that are there."""
    for name, problem in box_problems().items():
        for program in programs(BOXES):
            if program.installed:
                compute = functools.partial(cell, problem, program)
                yield Derived(PREFIX + name, cell_name(program.name), (), compute)


def cell(problem: BoxProblem, program: Program, finished: Finished) -> Mapping[str, Value]:
    """Return a program's answers to a problem, judged."""
    answers = list(_answers(problem, program.name, finished))
    if not any(answer.history is not None or _is_wrong(answer) for answer in answers):
        raise NothingToDerive(f"{program.name} answers no case")
    return metrics_of(problem, answers, list(_points(problem, program, finished)))


def _answers(problem: BoxProblem, program: str, finished: Finished) -> Iterator[Answer]:
    for case, scene in case_scenes(problem.name):
        row = finished.rows.get((scene.name, program))
        history = finished.history(scene.name, program)
        quantities: tuple[MeasuredQuantity, ...] = ()
        if history is not None:
            quantities = measured((case.quantities or problem.quantities)(scene), history)
        yield Answer(case, scene, row, history, quantities)


def _is_wrong(answer: Answer) -> bool:
    return answer.row is not None and answer.row.outcome in WRONG


@dataclass(frozen=True)
class Point:
    """A run of a curve."""

    refine: int
    step: float
    steps: int
    error: float | None
    outcome: str


def _points(problem: BoxProblem, program: Program, finished: Finished) -> Iterator[Point]:
    if program.halvings is None:
        return
    for refine, scene in enumerate(curve_scenes(problem.name)[: program.halvings + 1]):
        row = finished.rows.get((scene.name, program.name))
        if row is None or row.outcome is Outcome.NOT_APPLICABLE:
            continue
        history = finished.history(scene.name, program.name)
        steps = int(row.work.get("steps", 0))
        step = scene.time.duration / steps if steps else math.nan
        error = None
        if history is not None:
            error = largest_error(measured(problem.quantities(scene), history))
        yield Point(refine, step, steps, error, str(row.outcome))


def largest_error(quantities: Sequence[MeasuredQuantity]) -> float | None:
    """Return the largest error over its band, None where nothing was measured."""
    return max((number.beside for number in quantities if number.beside is not None), default=None)


# ---- the grid -------------------------------------------------------------------------------------------------------


def threshold(problem: BoxProblem, answers: Sequence[Answer]) -> MeasuredQuantity | None:
    """Return from where on a box stands or overturns, by the cases of a grid; None where one is not answered."""
    own_scene = problem.scene()
    if problem.name == "standing":
        flags = {_friction(answer): _stands(answer) for answer in answers if answer.history is not None}
        quantity = standing_threshold(own_scene)
        complete = {*FRICTIONS} <= set(flags)
    elif problem.name == "toppling":
        grid = [answer for answer in answers if answer.case.label]
        factors = dict(zip(SPINS, grid, strict=True))
        flags = {
            factor: bool(answer.quantities[0].value) for factor, answer in factors.items() if answer.history is not None
        }
        quantity = toppling_threshold(own_scene)
        complete = len(flags) == len(SPINS)
    else:
        return None
    return MeasuredQuantity(quantity, from_where(flags)) if complete else None


def from_where(flags: Mapping[float, bool]) -> float:
    """Return the value from which on all flags are up: half-way between two of a grid, or the end of it."""
    grid = sorted(flags)
    first = len(grid)
    while first and flags[grid[first - 1]]:
        first -= 1
    if first == 0:
        return grid[0]
    if first == len(grid):
        return grid[-1]
    return (grid[first - 1] + grid[first]) / 2


def _friction(answer: Answer) -> float:
    return boxes_of(answer.scene).friction


def _stands(answer: Answer) -> bool:
    """Whether a box creeps no further than is allowed of one that stands."""
    if answer.history is None:
        raise ValueError(f"{answer.scene.name}: must have a history, got none")
    allowed = _creep_allowed(answer.scene)
    return 1e3 * measures.creep(answer.history) <= allowed


def _creep_allowed(scene: Scene) -> float:
    steep = scene.with_values({"rigid.friction": 80.0})
    (creep,) = box_problems()["standing"].quantities(steep)
    return creep.high


# ---- metrics --------------------------------------------------------------------------------------------------------


def metrics_of(problem: BoxProblem, answers: Sequence[Answer], points: Sequence[Point]) -> dict[str, Value]:
    """Return a cell as the metrics of a row: its own, those of each number, then the points of its curve."""
    labelled = [(answer.case.label, number_of_answer) for answer in answers for number_of_answer in answer.quantities]
    grid = threshold(problem, answers)
    if grid is not None:
        labelled.insert(1, ("", grid))
    ended_wrong = [answer for answer in answers if _is_wrong(answer)]
    missing = [answer for answer in answers if answer.history is None and not _is_wrong(answer)]
    words = [number_of_answer.word for _, number_of_answer in labelled]
    verdict = PARTIAL if missing else PASS
    if FAIL in words or ended_wrong:
        verdict = FAIL
    error = largest_error([number_of_answer for _, number_of_answer in labelled])
    metrics: dict[str, Value] = {
        "verdict": verdict,
        "says": _says(labelled, ended_wrong),
        "finding": finding(points),
        "reason": _reason(missing, ended_wrong),
    }
    if error is not None and math.isfinite(error) and not ended_wrong:
        metrics[BESIDE] = settled(error)
    for number, (label, number_of_answer) in enumerate(labelled):
        quantity = number_of_answer.quantity
        metrics |= {
            f"number {number}: name": quantity.name,
            f"number {number}: unit": quantity.unit,
            f"number {number}: case": label,
            f"number {number}: value": None if number_of_answer.value is None else settled(number_of_answer.value),
            f"number {number}: exact": settled(quantity.exact),
            f"number {number}: low": settled(quantity.low),
            f"number {number}: high": settled(quantity.high),
            f"number {number}: word": number_of_answer.word,
            f"number {number}: reason": quantity.reason,
        }
    for number, point in enumerate(points):
        finite = point.error is not None and math.isfinite(point.error)
        metrics |= {
            f"point {number}: refine": float(point.refine),
            f"point {number}: step": point.step if point.steps else None,
            f"point {number}: steps": float(point.steps),
            f"point {number}: error": settled(point.error) if finite and point.error is not None else None,
            f"point {number}: outcome": point.outcome,
        }
    return metrics


def _says(labelled: Sequence[tuple[str, MeasuredQuantity]], ended_wrong: Sequence[Answer]) -> str:
    """Return the number that is furthest from its exact value beside its band, in words for a table."""
    if ended_wrong and ended_wrong[0].row is not None:
        label = f" at {ended_wrong[0].case.label}" if ended_wrong[0].case.label else ""
        return f"{ended_wrong[0].row.outcome}{label}"
    judged = [(label, number) for label, number in labelled if number.beside is not None]
    if not judged:
        return ""
    # the first of those that are equally far: the problem's own scene stands before its variants
    label, worst = max(judged, key=lambda pair: pair[1].beside or 0.0)
    return f"{number_in_words(worst)}{f', {label}' if label else ''}"


def number_in_words(number: MeasuredQuantity) -> str:
    """Return a number of an answer with its exact value, in words."""
    quantity = number.quantity
    unit = "" if quantity.unit == "1" else f" {quantity.unit}"
    if quantity.name == "overturns":
        return "overturns" if number.value else "does not overturn"
    if number.value is None:
        return f"{quantity.name} cannot be measured"
    exact = f" (exact {_short(quantity.exact)})" if quantity.exact else ""
    return f"{quantity.name} {_short(number.value)}{unit}{exact}"


def _short(value: float) -> str:
    return "0" if abs(value) < 1e-9 else f"{value:.3g}"


def _reason(missing: Sequence[Answer], ended_wrong: Sequence[Answer]) -> str:
    """Return which cases have no answer, and why."""
    reasons: dict[str, list[str]] = {}
    for answer in (*ended_wrong, *missing):
        row = answer.row
        why = "was not run"
        if row is not None:
            why = last_note(row)
        reasons.setdefault(why, []).append(answer.case.label or "the problem's own case")
    return "; ".join(f"{', '.join(labels)}: {why}" for why, labels in reasons.items())


def finding(points: Sequence[Point]) -> str:
    """Return what a curve of error over step shows, as a fact; nothing where it is too short to show anything."""
    curve = [point for point in points if point.error is not None and math.isfinite(point.error)]
    if len(curve) < LEVELS or len(curve) < len(points):
        return ""
    halved = all(after.steps == 2 * before.steps for before, after in itertools.pairwise(curve))
    if not halved:  # the program made other steps than it was asked for
        return ""
    errors = [point.error or 0.0 for point in curve]
    count = len(errors) - 1
    if max(errors) <= SETTLED:
        return "the error is below a twentieth of its band at every step"
    if min(errors) > 0:
        ratios = [before / after for before, after in itertools.pairwise(errors)]
        order = -float(np.polyfit(np.arange(len(errors)), np.log2(errors), 1)[0])
        if min(ratios) >= FALLS:
            return f"the error falls at each of {count} halvings of the step, order {order:.1f}"
        if max(ratios) <= 1 / FALLS:
            return f"the error grows at each of {count} halvings of the step, order {order:.1f}"
    first = _short(errors[0])
    last = _short(errors[-1])
    if errors[-1] < SHRINKS * errors[0]:
        return f"the error falls unevenly, from {first} to {last} of its band in {count} halvings of the step"
    return f"the error does not shrink with the step: {first} of its band at first, {last} after {count} halvings"
