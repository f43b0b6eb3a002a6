"""Which program of a family reaches a problem's band at the least price."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence

from validation.studies.engines.table import EngineCell, EngineTable, WorkPoint
from validation.studies.field.table import PARTIAL, PASS, ProgramLine

ALIKE = 1.25  # ratio of seconds of single runs on a machine that does other things too: closer ones are equal
FAMILIES = {
    "mechanics": "Mechanics",
    "robotics": "Robotics",
    "games": "Games",
    "user": "Brought by users",
    "suite": "This suite",
}


def reached(points: Sequence[WorkPoint]) -> WorkPoint | None:
    """Return the cheapest run of a curve that is within what is allowed, as all finer ones are.

    A coarse run that is right while a finer one is not is so by chance, and no answer to rely on.
    """
    cheapest = None
    least = math.inf
    for point in sorted(points, key=lambda candidate: -candidate.refine):
        if point.error is None or point.error > 1:
            break
        if point.seconds is not None and point.seconds < least:
            cheapest = point
            least = point.seconds
    return cheapest


def by_family(table: EngineTable) -> dict[str, list[ProgramLine]]:
    """Return the programs of each family that has some, chosen settings before defaults of the same program."""
    families: dict[str, list[ProgramLine]] = {}
    for family in FAMILIES:
        programs = [program for program in table.programs if program.family == family]
        if programs:
            families[family] = programs
    return families


def best_of_family(table: EngineTable, problem: str, family: str) -> list[tuple[ProgramLine, WorkPoint]]:
    """Return the programs of a family that pass a problem and reach its band in the least time, and the runs that do.

    A curve is of one case of the problem, and often of its first seconds: who is within the band there and fails the
    problem is not the best at it. Those that take nearly as little time are named with the first one.
    """
    runs = []
    for program in table.programs:
        cell = table.cells[problem, program.name]
        point = reached(cell.points)
        passes = cell.verdict in (PASS, PARTIAL)
        if program.family == family and passes and point is not None and point.seconds is not None:
            runs.append((point.seconds, program, point))
    least = min((seconds for seconds, _, _ in runs), default=0.0)
    runs.sort(key=lambda run: run[0])
    return [(program, point) for seconds, program, point in runs if seconds <= ALIKE * least]


def curves(table: EngineTable, problem: str) -> Iterator[tuple[ProgramLine, EngineCell]]:
    """Yield the programs that have a curve of a problem, and their cells."""
    for program in table.programs:
        cell = table.cells[problem, program.name]
        if any(point.error is not None for point in cell.points):
            yield program, cell
