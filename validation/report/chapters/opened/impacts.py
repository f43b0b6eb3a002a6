"""The chapter of the study `impacts`: published benchmarks, solver by solver, in one table for each."""

from __future__ import annotations

from pathlib import Path

from validation.report.blocks import Block, Heading, Table, columns
from validation.report.chapters.data import Case, Group, groups, verdicts_of
from validation.report.chapters.scene import opening
from validation.report.chapters.text import DASH, plain
from validation.runs.records import Manifest
from validation.runs.results import Results
from validation.solvers.contract import EXACT_IN_TIME
from validation.solvers.registry import role

QUANTITIES = (  # title, metric, factor
    ("lands [ms]", "switches.first_closing", 1e3),
    ("leaves [ms]", "switches.first_opening", 1e3),
    ("lands again [ms]", "switches.second_closing", 1e3),
    ("restitution", "contact.restitution", 1.0),
    ("peak force [MN]", "contact.peak_force", 1e-6),
    ("penetration [mm]", "contact.penetration", 1e3),
)
NOTE = (
    "A step sees a switch at its end. The peak force of a rigid wall is ρ c V a; where a stepped solution gives "
    "more, it is that of the springs: 1.5 to 2 times V √(p m / 2) of the exact block, another under a long step."
)


def chapter(results: Results, manifest: Manifest, directory: Path) -> list[Block]:
    """Return the chapter: a table for each benchmark."""
    found = groups(results, manifest)
    blocks = opening(manifest, verdicts_of(found), said=NOTE)
    for group in found:
        blocks += [Heading(group.title, 3), table(group)]
    return blocks


def table(group: Group) -> Table:
    """Return what each solver found in each case."""
    titles = (*columns("text", "Case", "Solver"), *columns("decimal", *(title for title, _, _ in QUANTITIES)))
    rows = []
    for case in group.cases:
        label = case.label
        for solver in case.rows:
            rows.append((label, named(solver), *cells(case, solver)))
            label = ""
    return Table(titles, tuple(rows))


def named(solver: str) -> str:
    """Return a solver's name, marked where it is exact in time."""
    return f"{solver} (exact)" if role(solver) in EXACT_IN_TIME else solver


def cells(case: Case, solver: str) -> tuple[str, ...]:
    """Return the quantities of a run."""
    values = ((case.number(solver, metric), factor) for _, metric, factor in QUANTITIES)
    return tuple(DASH if value is None else plain(factor * value, 5) for value, factor in values)
