"""The cells of the field: a program's answer to a problem, judged, with the cause of its failure."""

from __future__ import annotations

import functools
from collections.abc import Iterator, Mapping

from validation.engine.finished import Derived, Finished
from validation.gates.gate import settled
from validation.problems.bands import Standard, standard, standard_of
from validation.problems.cause import cause
from validation.problems.judge import Judgement, Word, judge
from validation.problems.problem import PREFIX
from validation.runs.history import History
from validation.runs.row import Value
from validation.studies.field.scenes import (
    EXACT,
    FIELD_PROBLEMS,
    changed,
    fine_name,
    finer,
    kept_exact,
    problem_named,
    scene_of,
    with_elements,
)
from validation.studies.field.table import BESIDE, cell_name
from validation.suite.programs import ELEMENTS, FINE, HABIT, installed

OF_MODEL = "another model: the block strains from point to point, where DDA's has one strain"


def derived() -> Iterator[Derived]:
    """Yield a derived row for every case that is judged."""
    for name in FIELD_PROBLEMS:
        elements = (ELEMENTS,) if with_elements(scene_of(name)) else ()
        for program in (HABIT, FINE, *elements, *installed()):
            needs = [case_of(name, program)]
            if kept_exact(scene_of(name)):
                needs += [(PREFIX + name, EXACT), *((scene.name, EXACT) for scene in changed(name).values())]
            compute = functools.partial(cell, name, program)
            yield Derived(PREFIX + name, cell_name(program), tuple(needs), compute)


def cell(name: str, program: str, finished: Finished) -> Mapping[str, Value]:
    """Return a program's answer to a problem, judged."""
    answer = finished.history(*case_of(name, program))
    if answer is None:
        return {}
    history = sampled(name, program, answer)
    bands = standard_in(name, finished)
    problem = problem_named(name)
    judgement = judge(problem, history, bands)
    why = ""
    if judgement.word is Word.FAIL:
        why = OF_MODEL if program == ELEMENTS else cause(problem, history, bands).sentence
    return metrics_of(judgement, why)


def case_of(name: str, program: str) -> tuple[str, str]:
    """Return scene and solver of the case that a program's cell is computed from."""
    at_fine_steps = {FINE: HABIT, ELEMENTS: ELEMENTS}
    return (fine_name(name), at_fine_steps[program]) if program in at_fine_steps else (PREFIX + name, program)


def sampled(name: str, program: str, answer: History) -> History:
    """Return an answer at the steps of the problem."""
    if program not in (FINE, ELEMENTS):
        return answer
    stride = finer(scene_of(name))
    last_of_each = slice(stride - 1, None, stride)
    return History(answer.time[last_of_each], {key: x[last_of_each] for key, x in answer.columns.items()})


def standard_in(name: str, finished: Finished) -> Standard:
    """Return the standard of a problem from exact motions that the study has kept, or computed where they take no time.

    Raises
    ------
    ValueError
        A kept motion is lost.
    """
    if not kept_exact(problem_named(name).scene):
        return computed_standard(name)
    exact = finished.history(PREFIX + name, EXACT)
    others = {datum: finished.history(scene.name, EXACT) for datum, scene in changed(name).items()}
    changed_motions = {datum: history for datum, history in others.items() if history is not None}
    if exact is None or len(changed_motions) < len(others):
        raise ValueError(f"{name}: an exact motion is lost")
    return standard_of(exact, changed_motions)


@functools.cache
def computed_standard(name: str) -> Standard:
    """Return the standard of a problem whose exact motions take no time."""
    return standard(problem_named(name))


def metrics_of(judgement: Judgement, why: str) -> dict[str, Value]:
    """Return a judgement as the metrics of a row: the cell's own, then those of each column, then what is told."""
    deciding = judgement.deciding
    metrics: dict[str, Value] = {"verdict": str(judgement.word), "says": judgement.verdict, "cause": why}
    if deciding is not None and deciding.band is not None and deciding.error is not None:
        metrics |= {
            "column": deciding.name,
            "error": settled(deciding.error),
            "band": settled(deciding.band),
            BESIDE: settled(deciding.error / deciding.band),
            "reason": deciding.reason,
            "within": settled(judgement.within),
        }
    for column in judgement.columns:
        metrics[f"{column.name}: word"] = str(column.word)
        metrics[f"{column.name}: error"] = None if column.error is None else settled(column.error)
        metrics[f"{column.name}: band"] = None if column.band is None else settled(column.band)
        metrics[f"{column.name}: until"] = settled(column.until)
        metrics[f"{column.name}: reason"] = column.reason
    for number in judgement.quantities:
        for kind, value in (("value", number.value), ("exact", number.exact)):
            metrics[f"told {kind}: {number.name} [{number.unit}]"] = None if value is None else settled(value)
    return metrics
