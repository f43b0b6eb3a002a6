"""The front matter as a whole: the first page, what did not pass, the three decisions."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from itertools import chain
from pathlib import Path
from typing import Any

from validation.report.blocks import Callout, PageBreak, Paragraph, Part
from validation.report.chapters.data import Groups, Verdicts
from validation.report.chapters.gates import not_passed
from validation.report.front.decisions import decisions
from validation.report.front.first import first_page, verdict_line
from validation.report.front.groups import paper_scene
from validation.report.references import PAPER, identity
from validation.runs.records import AlarmRecord


def front_pages(
    groups: Groups,
    verdicts: Verdicts,
    studies: Sequence[str],
    directory: Path,
    provenances: Sequence[Mapping[str, Any]] = (),
) -> list[Part]:
    """Return the pages that are read first; of results without the paper's block, what they are and their verdicts."""
    imprint = Paragraph(f"The model is that of {PAPER}. {identity(provenances)}.", "small")
    paper = paper_scene(groups)
    failures = not_passed(verdicts)
    if paper is None:
        what = f"{len(groups)} scene{'s' * (len(groups) != 1)} of {', '.join(studies)}: one chapter a study."
        return [imprint, Paragraph(what, "lead"), verdict_line(verdicts), *alarm_lines(groups), *failures]
    return [
        imprint,
        *first_page(groups, paper, verdicts, directory),
        *([PageBreak(), *failures] if failures else []),
        PageBreak(),
        *decisions(groups, paper, directory),
    ]


def alarm_lines(groups: Groups) -> list[Callout]:
    """Return each kind of alarm with the cases that raised it, and the sentence of the first."""
    raised: dict[str, list[AlarmRecord]] = {}
    for alarm in chain.from_iterable(group.alarms for group in groups.values()):
        raised.setdefault(alarm["kind"], []).append(alarm)
    lines = []
    for kind, records in raised.items():
        first = records[0]
        cases = len({record["scene"] for record in records})
        number = f" in {cases} cases" if cases > 1 else ""
        lines.append(Callout(f"Alarm{number}, {kind}: {first['scene']}: {first['sentence']}.", "warn"))
    return lines
