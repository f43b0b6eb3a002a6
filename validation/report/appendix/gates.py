"""Every gate that passed on a line, study by study under the reason that it shares with others."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

from validation.report.blocks import GateLine, GateLines, Heading, Paragraph, Part
from validation.report.chapters.data import Groups, labels_of
from validation.report.chapters.gates import band, measured, reason, value_cell
from validation.runs.case_name import scene_of
from validation.runs.records import VerdictRecord

MOST_LINES = 700  # beyond, gates of a scene that share pair, metric and reason share a line
Verdicts = Sequence[VerdictRecord]


def gate_pages(verdicts: Verdicts, groups: Groups) -> list[Part]:
    """Return the gates that passed, study by study."""
    passed = [v for v in verdicts if v["verdict"] == "PASS"]
    if not passed:
        return []
    labels = labels_of(groups.values())
    joined = len(passed) > MOST_LINES
    sections: list[tuple[str, str, tuple[GateLine, ...]]] = []
    for study in dict.fromkeys(v["study"] for v in passed):
        passed_of_study = [v for v in passed if v["study"] == study]
        title = f"{study}: {len(passed_of_study)} passed"
        for why, lines in _sections(passed_of_study, labels, joined):
            sections.append((title, why, lines))
            title = ""
    text = "Measured value and band of every gate that passed, under the reason of the band and the kind of reference."
    if joined:
        text += " Gates of a scene that share pair, metric and reason share a line, which gives their number and range."
    return [Heading("Gates", 2), Paragraph(text, "small"), GateLines(tuple(sections))]


def _sections(verdicts: Verdicts, labels: Mapping[str, str], joined: bool) -> list[tuple[str, tuple[GateLine, ...]]]:
    """Return the lines of a study under the reasons that they share; with `joined`, like gates share a line."""
    verdicts_by_reason: dict[str, dict[tuple[str, str], list[VerdictRecord]]] = {}
    for v in verdicts:
        kind = scene_of(v["scene"]), _measured(v)
        verdicts_by_reason.setdefault(reason(v), {}).setdefault(kind, []).append(v)
    sections = []
    for why, kinds in verdicts_by_reason.items():
        lines: list[GateLine] = []
        for alike in kinds.values():
            if joined and len(alike) > 1:
                lines.append(_range_line(alike))
            else:
                lines += [_line(v, labels) for v in alike]
        sections.append((why, tuple(lines)))
    return sections


def _measured(v: VerdictRecord) -> str:
    """Return what a gate measures: the pair, the metric and its window."""
    return f"{'–'.join(v['pair'])} {measured(v)}"


def _line(v: VerdictRecord, labels: Mapping[str, str]) -> GateLine:
    label = labels.get(v["scene"], "").replace(" = ", "=")
    scene = f"{scene_of(v['scene'])} {label}".strip()
    return (scene, _measured(v), value_cell(v["value"], v["metric"]), band(v))


def _range_line(verdicts: Verdicts) -> GateLine:
    first = verdicts[0]
    values = sorted(float(v["value"]) for v in verdicts if isinstance(v["value"], int | float))
    has_one_band = len({tuple(v["band"]) for v in verdicts}) == 1
    return (
        f"{scene_of(first['scene'])}, {len(verdicts)} cases",
        _measured(first),
        _ends(values, first["metric"]),
        band(first) if has_one_band else "each with its own band",
    )


def _ends(values: Sequence[float], metric: str) -> str:
    """Return the least and the greatest value, or the one that both read as."""
    low, high = (value_cell(value, metric) for value in (values[0], values[-1]))
    return low if low == high else f"{low} … {high}"
