"""The chapter of the study `impacts`: published benchmarks, solver by solver, in one table for each."""

from __future__ import annotations

from pathlib import Path

from validation.report.blocks import Blocks, Heading, Table
from validation.report.chapters.data import CaseGroup, case_groups, verdicts_of
from validation.report.chapters.described import Description
from validation.report.chapters.scene import opening
from validation.runs.records import Manifest
from validation.runs.results import Results
from validation.solvers.contract import EXACT_IN_TIME
from validation.solvers.registry import role

PAGE = Description(__file__)


def chapter(results: Results, manifest: Manifest, directory: Path) -> Blocks:
    """Return the chapter: a table for each benchmark."""
    groups = case_groups(results, manifest)
    blocks = opening(manifest, verdicts_of(groups), remark=PAGE.text("note"))
    for group in groups:
        blocks += [Heading(group.title, 3), quantity_table(group)]
    return blocks


def quantity_table(group: CaseGroup) -> Table:
    """Return the quantities of each run."""
    rows = []
    for case in group.cases:
        label = case.label
        for solver in case.rows:
            name = f"{solver} (exact)" if role(solver) in EXACT_IN_TIME else solver
            cells = [column.text(case.number(solver, column.of)) for column in PAGE.columns("quantities")[2:]]
            rows.append((label, name, *cells))
            label = ""
    return PAGE.table("quantities", rows)
