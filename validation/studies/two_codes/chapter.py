"""The chapter of the study `two-codes`: how far two finite-element programs are apart on one mesh."""

from __future__ import annotations

from pathlib import Path

from validation.report.blocks import Block, Blocks, Paragraph, Table, table
from validation.report.chapters.data import CaseGroup, case_groups
from validation.report.chapters.scene import gate_count, opening, outcomes
from validation.report.chapters.text import DASH, bounded, power
from validation.runs.records import Manifest
from validation.runs.results import Results

CODES = ("fem:full", "fenicsx")
MEASURES = ("displacement.l2", "displacement.max", "pressure.l2", "pressure.max")


def chapter(results: Results, manifest: Manifest, directory: Path) -> Blocks:
    """Return the chapter: how far the codes are apart, scene by scene; where one did not run, why."""
    groups = case_groups(results, manifest)
    blocks = opening(manifest)
    verdicts = results.verdicts(manifest["study"])
    table = apart(groups)
    blocks += [Paragraph(f"{gate_count(verdicts).capitalize()}."), table] if table.rows else []
    distinct: dict[Block, None] = {}
    for group in groups:
        distinct |= dict.fromkeys(outcomes(group))
    return [*blocks, *list(distinct)[:3]]


def apart(groups: list[CaseGroup]) -> Table:
    """Return the largest difference of the two codes over the cases of each scene."""
    rows = []
    for group in groups:
        cells = []
        for metric in MEASURES:
            worst = max(group.numbers_of_pair(*CODES, metric), default=None)
            cells.append(DASH if worst is None else bounded(worst, power(worst)))
        if set(cells) != {DASH}:
            rows.append((group.title, str(len(group.cases)), *cells))
    return table(
        ("Scene", "Cases", ("Displacement", "L2", "largest"), ("Pressure", "L2", "largest")),
        rows,
        "Two programs on one mesh: relative differences, the largest over the cases.",
    )
