"""The error ledger: what part of a difference is code, mesh, model form and time."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from pathlib import Path

from validation.report.blocks import Blocks, Heading, Paragraph
from validation.report.chapters.data import CaseGroup, CaseGroups, CaseResults
from validation.report.chapters.text import percent, span
from validation.report.figures import histories
from validation.report.figures.ledger import LedgerLine, ledger_figure
from validation.scenes import features

PARTS = {
    "code": ("dda", "dda-textbook"),
    "mesh": ("fem", "bar"),
    "model form": ("dda", "bar"),
    "time": ("bar", "continuum"),
}
OPENING_PARTS = {  # contact that opens: no recursion is printed for it, and both models are known exact in time
    "code": ("fem", "fenicsx"),
    "mesh": ("fem", "bar"),
    "model form": ("block-events", "bar-events"),
    "time": ("dda", "block-events"),
}
METRICS = ("displacement.l2", "pressure.l2")
Values = tuple[float | None, float | None]  # relative L2 of displacement and contact pressure [1]
NOTHING: Values = (None, None)


def parts_of(case: CaseResults) -> Mapping[str, tuple[str, str]]:
    """Return the parts of the ledger, each the solver and its reference."""
    return PARTS if features.linear(case.scene) else OPENING_PARTS


def entry(group: CaseGroup, case: CaseResults, part: str) -> Values:
    """Return a part of the ledger for one case: its own pair's numbers, None where the pair was not compared."""
    displacement, pressure = (group.number_of_pair(case, *parts_of(case)[part], name) for name in METRICS)
    return displacement, pressure


def with_entries(groups: CaseGroups, parts: Mapping[str, tuple[str, str]]) -> list[CaseGroup]:
    """Return the groups with the cases of these parts that some of them applies to."""
    compared_groups = []
    for group in groups:
        cases = [case for case in group.cases if parts_of(case) is parts]
        compared = tuple(case for case in cases if any(entry(group, case, part) != NOTHING for part in parts))
        if compared:
            compared_groups.append(replace(group, cases=compared))
    return compared_groups


def ledger_blocks(groups: CaseGroups, name: str, directory: Path) -> Blocks:
    """Return the ledger of a study's scenes as a figure and a sentence; nothing where fewer than two cases have one."""
    blocks: Blocks = []
    for parts in (PARTS, OPENING_PARTS):
        compared = with_entries(groups, parts)
        if sum(len(group.cases) for group in compared) > 1:
            pairs = ", ".join(f"{part}: {solver} − {reference}" for part, (solver, reference) in parts.items())
            caption = (
                "Each case on its line; displacement filled, contact pressure open; relative L2 over the history. "
                f"{pairs}. Grey: below 10⁻¹², which is rounding."
            )
            file = f"{name}-ledger{'-opening' * (parts is OPENING_PARTS)}.svg"
            figure = histories.saved(ledger_figure(ledger_lines(compared, parts)), directory, file, caption)
            blocks += [Heading("What the differences are made of", 2), Paragraph(headline(compared)), figure]
    return blocks


def headline(groups: CaseGroups) -> str:
    """Return what code, mesh and model form contribute, in plain sentences."""
    displacement = part_values(groups, "model form", 0)
    pressure = part_values(groups, "model form", 1)
    if not displacement or not pressure:
        return "The model form is not known here: its pair was not compared."
    return (
        f"The model form is {span(displacement)} in displacement and {span(pressure)} in contact pressure "
        f"(relative L2){_shares(groups, min(displacement))}."
    )


def _shares(groups: CaseGroups, model_form: float) -> str:
    """Say what code and mesh contribute, and that the rest is model form where both are below its least."""
    parts = {
        "code and rounding are": part_values(groups, "code", 0),
        "the finite-element mesh is": part_values(groups, "mesh", 0),
    }
    largest = {name: max(values) for name, values in parts.items() if values}
    if not largest:
        return ""
    sentence = " and ".join(f"{name} at most {percent(value)}" for name, value in largest.items())
    remainder = ""
    if max(largest.values()) < model_form:
        remainder = ", so that neither explains it: it is one strain in the block in place of a wave"
    return f"; of the displacement's difference {sentence}{remainder}"


def ledger_lines(groups: CaseGroups, parts: Mapping[str, tuple[str, str]]) -> list[LedgerLine]:
    """Return the ledger as lines of a figure."""
    lines = []
    for group in groups:
        for case in group.cases:
            label = f"{group.name}: {case.label}" if len(group.cases) > 1 else group.name
            lines.append(LedgerLine(label, {part: entry(group, case, part) for part in parts}))
    return lines


def part_values(groups: CaseGroups, part: str, column: int) -> list[float]:
    """Return all numbers of a part, for displacement (0) or pressure (1)."""
    values = []
    for group in groups:
        values += [entry(group, case, part)[column] for case in group.cases]
    return [value for value in values if value is not None]
