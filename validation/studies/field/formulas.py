"""The study `field`: problems by programs; every cell PASS, FAIL, NOT RUN or not applicable, with the cause.

A program's FAIL is a finding and no gate. The gates are on this suite's side: its own DDA answers every problem at fine
steps and fails where the habit of DDA codes damps a vibration away; and a program as it comes answers what theory
predicts of its integrator, which says that its adapter states the problem rightly.
"""

from __future__ import annotations

import itertools
from collections.abc import Iterator, Mapping, Sequence
from typing import Any

from validation.engine.finished import Derived, Finished
from validation.gates.gate import Gate
from validation.problems.problem import ASKS, PREFIX
from validation.runs.records import Annotations
from validation.scenes.scene import Scene
from validation.studies.field import answered, cells, predictions, scenes
from validation.studies.field.answered import ENDS as ENDS
from validation.studies.field.cells import case_of
from validation.studies.field.scenes import FIELD_PROBLEMS
from validation.studies.field.table import BESIDE, STUDY, cell_name
from validation.suite import programs

DAMPED = ("locked", "opening", "rebound")
FAR = 1e3  # errors are below a thousand bands: what is further off is no damped motion but a blunder


def gates() -> Iterator[Gate]:
    """Yield the gates on this suite's own answers."""
    for name in FIELD_PROBLEMS:
        why = "at fine steps DDA's error is that of its scheme, far below what one per cent of the data changes"
        yield Gate(PREFIX + name, (cell_name(programs.FINE),), BESIDE, 0.0, 1.0, why)
    for name in DAMPED:
        why = "alpha = 1/2, delta = 1 damps the vibration at this step: the answer leaves the band, as DDA codes do"
        yield Gate(PREFIX + name, (cell_name(programs.HABIT),), BESIDE, 1.0, FAR, why)


def data() -> Mapping[str, Any]:
    """Return the rows and columns of the table, and which run each cell is of."""
    columns = programs.programs()
    runs = {}
    for name, program in itertools.product(FIELD_PROBLEMS, columns):
        runs[f"{name} {program.name}"] = [list(case_of(name, program.name)), cell_name(program.name)]
    return {
        "problems": [
            {"name": name, "scene": PREFIX + name, "title": scenes.scene_of(name).title, "asks": ASKS[name]}
            for name in FIELD_PROBLEMS
        ],
        "programs": [programs.line(program) for program in columns],
        "runs": runs,
    }


def known() -> tuple[programs.Program, ...]:
    """Return the programs that are installed now, and those that the suite knows."""
    return tuple(programs.known())


def all_scenes() -> list[Scene]:
    """Return the scenes of the problems and those that bands, checks and curves are computed from."""
    return [*scenes.scenes(), *predictions.scenes()]


def all_gates() -> tuple[Gate, ...]:
    """Return the gates on this suite's own answers, on what theory predicts, and on what every program answered."""
    return (*gates(), *predictions.gates(), *answered.gates(STUDY, known(), len(FIELD_PROBLEMS)))


def derived() -> tuple[Derived, ...]:
    """Return the cells, the checks, and what every program answered."""
    problems = [PREFIX + name for name in FIELD_PROBLEMS]
    return (*cells.derived(), *predictions.derived(), *answered.rows(STUDY, known(), problems))


def nothing(scenes: Sequence[Scene], finished: Finished) -> Annotations:
    """Return no alarms: other people's programs are judged here."""
    return {"alarms": [], "budgets": []}
