"""The study `field`: problems by programs; every cell PASS, FAIL, NOT RUN or not applicable, with the cause.

A program's FAIL is a finding and no gate. The gates are on this suite's side: its own DDA answers every problem at fine
steps and fails where the habit of DDA codes damps a vibration away; and a program as it comes answers what theory
predicts of its integrator, which says that its adapter states the problem rightly.
"""

from __future__ import annotations

import itertools
from collections.abc import Iterator, Mapping, Sequence
from typing import Any

from validation.engine.finished import Finished
from validation.gates.gate import Gate
from validation.problems.problem import ASKS, PREFIX
from validation.runs.records import Annotations
from validation.runs.run import Outcome
from validation.scenes.scene import Scene
from validation.studies.declaration import Study
from validation.studies.field import predictions, programs, scenes
from validation.studies.field.cells import BESIDE, Cells, case_of, cell_name
from validation.studies.field.scenes import FIELD_PROBLEMS
from validation.studies.field.table import STUDY

DAMPED = ("locked", "opening", "rebound")
FAR = 1e3  # errors are below a thousand bands: what is further off is no damped motion but a blunder
ENDS = tuple(o for o in Outcome if o not in (Outcome.COMPLETED, Outcome.NOT_RUN, Outcome.NOT_APPLICABLE))


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
        "programs": [_program(program) for program in columns],
        "runs": runs,
    }


def _program(program: programs.Program) -> dict[str, Any]:
    return {
        "name": program.name,
        "title": program.title,
        "recipe": program.recipe,
        "kind": program.kind,
        "installed": program.installed,
        "about": programs.about(program),
    }


def nothing(scenes: Sequence[Scene], finished: Finished) -> Annotations:
    """Return no alarms and no budgets: what DDA's habit does is what the cells say."""
    return {"alarms": [], "budgets": []}


def study() -> Study:
    """Return the study over the programs that are installed now."""
    cells = Cells()
    return Study(
        name=STUDY,
        title="The judged field",
        purpose="Other people's block codes on the same problems: which of them give the exact motion, and why not.",
        scenes=[*scenes.scenes(), *predictions.scenes()],
        gates=lambda: (*gates(), *predictions.gates()),
        derived=lambda: (*cells.derived(), *predictions.derived()),
        data=data,
        measures=(),
        pairs=(),
        annotate=nothing,
        expects=ENDS,
        long=True,
    )
