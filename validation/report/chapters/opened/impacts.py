"""The chapter of the study `impacts`: published benchmarks, solver by solver, in one table for each."""

from __future__ import annotations

from pathlib import Path

from validation.report.blocks import Blocks, Heading, Table, table
from validation.report.chapters.data import CaseGroup, case_groups, verdicts_of
from validation.report.chapters.measures import MetricColumn, cells, heads
from validation.report.chapters.scene import opening
from validation.runs.records import Manifest
from validation.runs.results import Results
from validation.solvers.contract import EXACT_IN_TIME
from validation.solvers.registry import role

QUANTITIES = (
    ("switches.first_closing", 1e3, "lands [ms]"),
    ("switches.first_opening", 1e3, "leaves [ms]"),
    ("switches.second_closing", 1e3, "lands again [ms]"),
    ("contact.restitution", 1.0, "restitution"),
    ("contact.peak_force", 1e-6, "peak force [MN]"),
    ("contact.penetration", 1e3, "penetration [mm]"),
)
NOTE = (
    "A step sees a switch at its end. The peak force of a rigid wall is ρ c V a; where a stepped solution gives "
    "more, it is that of the springs: 1.5 to 2 times V √(p m / 2) of the exact block, another under a long step."
)


def chapter(results: Results, manifest: Manifest, directory: Path) -> Blocks:
    """Return the chapter: a table for each benchmark."""
    groups = case_groups(results, manifest)
    blocks = opening(manifest, verdicts_of(groups), remark=NOTE)
    for group in groups:
        blocks += [Heading(group.title, 3), quantity_table(group)]
    return blocks


def measures_of(solver: str) -> list[MetricColumn]:
    """Return the columns of a solver."""
    return [MetricColumn(*quantity, digits=5, solver=solver) for quantity in QUANTITIES]


def quantity_table(group: CaseGroup) -> Table:
    """Return the quantities of each run."""
    rows = []
    for case in group.cases:
        label = case.label
        for solver in case.rows:
            name = f"{solver} (exact)" if role(solver) in EXACT_IN_TIME else solver
            rows.append((label, name, *cells(measures_of(solver), case)))
            label = ""
    return table(("Case", "Solver", *heads(measures_of("dda"))), rows)
