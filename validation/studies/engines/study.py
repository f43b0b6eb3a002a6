"""The study `engines`: problems of rigid boxes by programs; every cell PASS, PARTIAL, FAIL, NOT RUN or not applicable.

A program's FAIL is a finding and no gate. The gates are on this suite's side: the exact motions pass what they answer,
which says that the measures measure; a program that is installed answers a problem at least; and a program whose
integrator is known falls as that integrator does, which says that its adapter states the problem rightly.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import Any

from validation.engine.finished import Derived
from validation.engine.study import Study
from validation.gates.gate import Gate
from validation.problems.boxes import ASKS, PREFIX, box_problems
from validation.studies.engines import cells, predictions
from validation.studies.engines.cells import case_scenes, curve_scenes
from validation.studies.engines.table import STUDY
from validation.studies.field import answered
from validation.studies.field.programs import BOXES, Program, known, line, programs
from validation.studies.field.table import BESIDE, cell_name


def asked_programs() -> list[Program]:
    """Return the programs that have to answer."""
    return list(known(BOXES))


def gates() -> Iterator[Gate]:
    """Yield the gates on this suite's own answers, and that programs which are there answer."""
    for name in box_problems():
        why = "it is the exact motion; what is left is what measuring at the rows adds"
        yield Gate(PREFIX + name, (cell_name(cells.EXACT),), BESIDE, 0.0, cells.SETTLED, why)
    yield from predictions.gates()
    yield from answered.gates(STUDY, asked_programs(), len(box_problems()))


def derived() -> Iterator[Derived]:
    """Yield the cells, and how many problems each program answers."""
    yield from cells.derived()
    yield from predictions.derived()
    yield from answered.rows(STUDY, asked_programs(), [case_scenes(name)[0][1].name for name in box_problems()])


def data() -> Mapping[str, Any]:
    """Return the rows and columns of the table, and which cases each problem has."""
    problems = []
    cases = {}
    curves = {}
    for name, problem in box_problems().items():
        title = problem.scene().title
        problems.append({"name": name, "scene": PREFIX + name, "title": title, "asks": ASKS[name]})
        cases[name] = [scene.name for _, scene in case_scenes(name)]
        curves[name] = [scene.name for scene in curve_scenes(name)]
    return {
        "problems": problems,
        "cases": cases,
        "curves": curves,
        "programs": [line(program, "family") for program in programs(BOXES)],
    }


def study() -> Study:
    """Return the study over the programs that are installed now."""
    return Study(
        name=STUDY,
        title="The field of contact engines",
        purpose="Contact engines on rigid boxes: who stands still, who bounces, who gains energy, at what price.",
        scenes=list(cells.scenes()),
        gates=lambda: tuple(gates()),
        derived=lambda: tuple(derived()),
        data=data,
        measures=(),
        pairs=(),
        expects=answered.ENDS,
        long=True,
    )
