"""The chapter of the study `two-codes`: how far two finite-element programs are apart on one mesh."""

from __future__ import annotations

from pathlib import Path

from validation.report.blocks import Block, Callout, Paragraph, Table, columns
from validation.report.chapters.data import Group, groups
from validation.report.chapters.scene import gate_count, opening, outcomes
from validation.report.chapters.text import DASH, bounded, power
from validation.runs.records import Manifest
from validation.runs.results import Results

CODES = ("fem:full", "fenicsx")
MEASURES = ("displacement.l2", "displacement.max", "pressure.l2", "pressure.max")


def chapter(results: Results, manifest: Manifest, directory: Path) -> list[Block]:
    """Return the chapter: how far the codes are apart, scene by scene; where one did not run, why."""
    found = groups(results, manifest)
    blocks = opening(manifest)
    verdicts = results.verdicts(manifest["study"])
    table = apart(found)
    blocks += [Paragraph(f"{gate_count(verdicts).capitalize()}."), table] if table.rows else []
    missing = list(
        dict.fromkeys(block.text for group in found for block in outcomes(group) if isinstance(block, Callout))
    )
    blocks += [Callout(text, "warn") for text in missing[:3]]
    return blocks


def apart(found: list[Group]) -> Table:
    """Return the largest difference of the two codes over the cases of each scene."""
    rows = []
    for group in found:
        worst = []
        for metric in MEASURES:
            values = [group.number_of_pair(case, *CODES, metric) for case in group.cases]
            known = [value for value in values if value is not None]
            worst.append(bounded(max(known), power(max(known))) if known else DASH)
        if set(worst) != {DASH}:
            rows.append((group.title, str(len(group.cases)), *worst))
    titles = (
        *columns("text", "Scene"), *columns("decimal", "Cases"),
        *columns("decimal", "L2", "largest", group="Displacement"),
        *columns("decimal", "L2", "largest", group="Pressure"),
    )  # fmt: skip
    return Table(titles, tuple(rows), "Two programs on one mesh: relative differences, the largest over the cases.")
