"""The gates that passed, a line for each reason of a band; the site lists them one by one."""

from __future__ import annotations

from collections.abc import Iterable

from validation.report.blocks import Blocks, Heading, TableColumn, table
from validation.report.chapters.data import Verdicts
from validation.report.chapters.gates import measured
from validation.runs.case_name import scene_of
from validation.runs.records import VerdictRecord

MOST_NAMES = 2  # of scenes and of metrics that share a reason; the others are counted


def gate_table(verdicts: Verdicts) -> Blocks:
    """Return how many gates passed for each reason, on what, study by study; nothing where none passed."""
    passed_by_study: dict[str, dict[str, list[VerdictRecord]]] = {}
    for v in verdicts:
        if v["verdict"] == "PASS":
            passed_by_reason = passed_by_study.setdefault(v["study"], {})
            passed_by_reason.setdefault(f"{v['reason']} [{v['reference_kind']}]", []).append(v)
    rows: list[tuple[str, ...]] = []
    for study, passed_by_reason in passed_by_study.items():
        rows.append((f"{study}: {sum(map(len, passed_by_reason.values()))} passed",))
        for reason, passed in passed_by_reason.items():
            scenes = _some(scene_of(v["scene"]) for v in passed)
            rows.append((str(len(passed)), f"{_some(map(measured, passed))} of {scenes}: {reason}"))
    titles = (TableColumn("Gates", "decimal"), TableColumn("Metrics and scenes: why the band is what it is", "fill"))
    caption = (
        "Gates that passed, a line for each reason of a band, with the kind of reference in brackets; the gallery and "
        "verdicts.json list each gate with its value and its band."
    )
    return [Heading("Gates", 2), table(titles, rows, caption, ruled=False, dense=True)] if rows else []


def _some(names: Iterable[str]) -> str:
    """Return the first few of some names, each once, and how many more there are."""
    distinct = list(dict.fromkeys(names))
    more = len(distinct) - MOST_NAMES
    first = ", ".join(distinct[:MOST_NAMES])
    return f"{first}, {more} more" if more > 0 else first
