"""The error ledger: what part of a difference is code, mesh, model form and time."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from pathlib import Path

from validation.report.blocks import Block, Heading, Paragraph
from validation.report.chapters.data import Case, Group
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


def parts_of(case: Case) -> Mapping[str, tuple[str, str]]:
    """Return the parts of the ledger, each the solver and its reference."""
    return PARTS if features.linear(case.scene) else OPENING_PARTS


def entry(group: Group, case: Case, part: str) -> Values:
    """Return a part of the ledger for one case: its own pair's numbers, None where the pair was not compared."""
    displacement, pressure = (group.number_of_pair(case, *parts_of(case)[part], name) for name in METRICS)
    return displacement, pressure


def with_entries(groups: Sequence[Group], parts: Mapping[str, tuple[str, str]]) -> list[Group]:
    """Return the groups with the cases of these parts that some of them applies to."""
    kept = []
    for group in groups:
        cases = [case for case in group.cases if parts_of(case) is parts]
        known = tuple(case for case in cases if any(entry(group, case, part) != NOTHING for part in parts))
        kept += [replace(group, cases=known)] if known else []
    return kept


def ledger_blocks(groups: Sequence[Group], name: str, directory: Path) -> list[Block]:
    """Return the ledger of a study's scenes as a figure and a sentence; nothing where fewer than two cases have one."""
    blocks: list[Block] = []
    for parts in (PARTS, OPENING_PARTS):
        found = with_entries(groups, parts)
        if sum(len(group.cases) for group in found) > 1:
            pairs = ", ".join(f"{part}: {solver} − {reference}" for part, (solver, reference) in parts.items())
            caption = (
                "Each case on its line; displacement filled, contact pressure open; relative L2 over the history. "
                f"{pairs}. Grey: below 10⁻¹², which is rounding."
            )
            file = f"{name}-ledger{'-opening' * (parts is OPENING_PARTS)}.svg"
            figure = histories.saved(ledger_figure(ledger_lines(found, parts)), directory, file, caption)
            blocks += [Heading("What the differences are made of", 2), Paragraph(headline(found)), figure]
    return blocks


def headline(found: Sequence[Group]) -> str:
    """Return what code, mesh and model form contribute, in plain sentences."""
    form = [part_values(found, "model form", column) for column in (0, 1)]
    if not all(form):
        return "The model form is not known here: its pair was not compared."
    return (
        f"The model form is {span(form[0])} in displacement and {span(form[1])} in contact pressure "
        f"(relative L2){_shares(found, min(form[0]))}."
    )


def _shares(found: Sequence[Group], form: float) -> str:
    """Say what code and mesh contribute, and that the rest is model form where both are below its least."""
    parts = {
        "code and rounding are": part_values(found, "code", 0),
        "the finite-element mesh is": part_values(found, "mesh", 0),
    }
    said = [f"{name} at most {percent(max(values))}" for name, values in parts.items() if values]
    if not said:
        return ""
    small = all(max(values) < form for values in parts.values() if values)
    rest = ", so that neither explains it: it is one strain in the block in place of a wave" if small else ""
    return f"; of the displacement's difference {' and '.join(said)}{rest}"


def ledger_lines(groups: Sequence[Group], parts: Mapping[str, tuple[str, str]]) -> list[LedgerLine]:
    """Return the ledger as lines of a figure."""
    lines = []
    for group in groups:
        for case in group.cases:
            label = f"{group.name}: {case.label}" if len(group.cases) > 1 else group.name
            lines.append(LedgerLine(label, {part: entry(group, case, part) for part in parts}))
    return lines


def part_values(groups: Sequence[Group], part: str, column: int) -> list[float]:
    """Return all numbers of a part, for displacement (0) or pressure (1)."""
    values = []
    for group in groups:
        found = [entry(group, case, part)[column] for case in group.cases]
        values += [value for value in found if value is not None]
    return values
