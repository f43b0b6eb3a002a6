"""The table of what was measured of a scene's motions: frequency, damping, settling and peaks, by case and solver."""

from __future__ import annotations

import itertools

from validation.report.blocks import Table, table
from validation.report.chapters.data import CaseGroup, CaseResults
from validation.report.chapters.described import Description
from validation.report.chapters.text import load_size, word_notes
from validation.runs.numbers import DASH
from validation.runs.row import Value
from validation.scenes.scene import Scene
from validation.solvers.contract import EXACT_IN_TIME
from validation.solvers.registry import is_solver, role

PAGE = Description(__file__)
NOISE = 1e-9  # of the load; a smaller least pressure is rounding
LONG_LABEL = 18  # letters; a longer label takes a line of its own above its solvers


def damping_table(group: CaseGroup) -> Table:
    """Return frequency and damping of the first axial mode, settling steps and peaks per case and solver.

    Solvers whose numbers read alike share a line; what is exact in time has no damping to tell, and no line.
    """
    columns = PAGE.columns("damping")
    has_long_labels = any(len(case.label) > LONG_LABEL for case in group.cases)
    rows = []
    measured = []
    for case in group.cases:
        solvers_by_cells: dict[tuple[str, ...], list[str]] = {}
        for solver in _finished(case):
            metrics = case.rows[solver].metrics
            values = [_significant(column.of, metrics.get(column.of), case.scene) for column in columns]
            cells = tuple(column.text(value) for column, value in zip(columns, values, strict=True))
            if set(cells) != {DASH}:
                solvers_by_cells.setdefault(cells, []).append(solver)
                measured += values
        lines = [(", ".join(solvers), *cells) for cells, solvers in solvers_by_cells.items()]
        if has_long_labels:
            rows += [(case.label,), *lines] if lines else []
        else:
            labels = itertools.chain([case.label], itertools.repeat(""))
            rows += [(label, *line) for label, line in zip(labels, lines, strict=False)]
    heads = [*["Case"] * (not has_long_labels), "Solver", *(column.head for column in columns)]
    return table(heads, rows, notes=word_notes(measured), ruled=not has_long_labels)


def _finished(case: CaseResults) -> list[str]:
    finished = [solver for solver, row in case.rows.items() if row.metrics and not solver.endswith(":full")]
    return [solver for solver in finished if not is_solver(solver) or role(solver) not in EXACT_IN_TIME] or finished


def _significant(metric: str, value: Value, scene: Scene) -> Value:
    """Return a metric without rounding: a least pressure that is nothing beside the load."""
    is_noise = isinstance(value, int | float) and abs(value) <= NOISE * load_size(scene)
    return 0.0 if is_noise and metric == "pressure.minimum" else value
