"""The gates that passed, a line for each reason of a band; the site lists them one by one."""

from __future__ import annotations

from validation.report.blocks import Blocks, Heading, TableColumn, table
from validation.report.chapters.data import Verdicts
from validation.report.chapters.gates import measured
from validation.report.chapters.text import some
from validation.runs.case_name import scene_of
from validation.runs.records import VerdictRecord

MOST_NAMES = 2  # of scenes and of metrics that share a reason; the others are counted


def gate_table(verdicts: Verdicts) -> Blocks:
    """Return how many gates passed for each reason, on what, by study; nothing where none passed."""
    passed_by_study: dict[str, dict[str, list[VerdictRecord]]] = {}
    for v in verdicts:
        if v["verdict"] == "PASS":
            passed_by_reason = passed_by_study.setdefault(v["study"], {})
            passed_by_reason.setdefault(f"{v['reason']} [{v['reference_kind']}]", []).append(v)
    rows: list[tuple[str, ...]] = []
    for study, passed_by_reason in passed_by_study.items():
        rows.append((f"{study}: {sum(map(len, passed_by_reason.values()))} passed",))
        for reason, passed in passed_by_reason.items():
            scenes = some((scene_of(v["scene"]) for v in passed), MOST_NAMES)
            rows.append((str(len(passed)), f"{some(map(measured, passed), MOST_NAMES)} of {scenes}: {reason}"))
    titles = (TableColumn("Gates", "decimal"), TableColumn("Metrics and scenes: why the band is what it is", "fill"))
    caption = (
        "Gates that passed, a line for each reason of a band, with the kind of reference in brackets; the gallery and "
        "verdicts.json list each gate with its value and its band."
    )
    return [Heading("Gates", 2), table(titles, rows, caption, ruled=False, dense=True)] if rows else []
