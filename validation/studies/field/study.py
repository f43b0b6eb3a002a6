"""The study `field`: problems by programs; every cell PASS, FAIL, NOT RUN or not applicable, with the cause.

A program's FAIL is a finding and no gate. The gates are on this suite's side: its own DDA answers every problem at fine
steps and fails where the habit of DDA codes damps a vibration away; and a program as it comes answers what theory
predicts of its integrator, which says that its adapter states the problem rightly.
"""

from __future__ import annotations

import itertools
from collections.abc import Iterator, Mapping
from typing import Any

from validation.engine.study import Study
from validation.gates.gate import Gate
from validation.problems.problem import ASKS, PREFIX
from validation.studies.field import answered, cells, predictions, programs, scenes
from validation.studies.field.cells import case_of
from validation.studies.field.scenes import FIELD_PROBLEMS
from validation.studies.field.table import BESIDE, STUDY, cell_name

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


def study() -> Study:
    """Return the study over the programs that are installed now."""
    known = tuple(programs.known())
    problems = [PREFIX + name for name in FIELD_PROBLEMS]
    return Study(
        name=STUDY,
        title="The judged field",
        purpose="Other people's block codes on the same problems: which of them give the exact motion, and why not.",
        scenes=[*scenes.scenes(), *predictions.scenes()],
        gates=lambda: (*gates(), *predictions.gates(), *answered.gates(STUDY, known, len(problems))),
        derived=lambda: (
            *cells.derived(),
            *predictions.derived(),
            *answered.rows(STUDY, known, problems),
        ),
        data=data,
        measures=(),
        pairs=(),
        expects=answered.ENDS,
        long=True,
    )
