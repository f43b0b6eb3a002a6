"""Every gate that passed on a line, study by study under the reason that it shares with others."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

from validation.report.blocks import Heading, Line, Lines, Paragraph, Part
from validation.report.chapters.data import Group
from validation.report.chapters.gates import band, reason, value_cell
from validation.runs.case_name import scene_of
from validation.runs.records import VerdictRecord

MOST_LINES = 700  # beyond, gates of a scene that share pair, metric and reason share a line
Verdicts = Sequence[VerdictRecord]


def gate_pages(verdicts: Verdicts, found: Mapping[str, Group]) -> list[Part]:
    """Return the gates that passed, study by study."""
    labels = {case.name: case.label for group in found.values() for case in group.cases}
    passed = [v for v in verdicts if v["verdict"] == "PASS"]
    if not passed:
        return []
    together = len(passed) > MOST_LINES
    sections: list[tuple[str, str, tuple[Line, ...]]] = []
    for study in dict.fromkeys(v["study"] for v in passed):
        own = [v for v in passed if v["study"] == study]
        title = f"{study}: {len(own)} passed"
        for why, lines in _sections(own, labels, together):
            sections.append((title, why, lines))
            title = ""
    told = "Measured value and band of every gate that passed, under the reason of the band and the kind of reference."
    if together:
        told += " Gates of a scene that share pair, metric and reason share a line, which gives their number and range."
    return [Heading("Gates", 2), Paragraph(told, "small"), Lines(tuple(sections))]


def _sections(verdicts: Verdicts, labels: Mapping[str, str], together: bool) -> list[tuple[str, tuple[Line, ...]]]:
    """Return the lines of a study under the reasons that they share."""
    shared: dict[str, dict[tuple[str, str], list[VerdictRecord]]] = {}
    for v in verdicts:
        kind = scene_of(v["scene"]), _measured(v)
        shared.setdefault(reason(v), {}).setdefault(kind, []).append(v)
    sections = []
    for why, kinds in shared.items():
        lines: list[Line] = []
        for own in kinds.values():
            lines += [_range_line(own)] if together and len(own) > 1 else [_line(v, labels) for v in own]
        sections.append((why, tuple(lines)))
    return sections


def _measured(v: VerdictRecord) -> str:
    """Return what a gate measures: the pair, the metric and its window."""
    window = f"@{v['id'].rpartition('@')[2]}" if "@" in v["id"] else ""
    return f"{'–'.join(v['pair'])} {v['metric']}{window}"


def _line(v: VerdictRecord, labels: Mapping[str, str]) -> Line:
    scene, label = scene_of(v["scene"]), labels.get(v["scene"], "").replace(" = ", "=")
    return (f"{scene} {label}".strip(), _measured(v), value_cell(v["value"], v["metric"]), band(v))


def _range_line(verdicts: Verdicts) -> Line:
    first = verdicts[0]
    values = sorted(float(v["value"]) for v in verdicts if isinstance(v["value"], int | float))
    same = len({tuple(v["band"]) for v in verdicts}) == 1
    return (
        f"{scene_of(first['scene'])}, {len(verdicts)} cases",
        _measured(first),
        _ends(values, first["metric"]),
        band(first) if same else "each with its own band",
    )


def _ends(values: Sequence[float], metric: str) -> str:
    """Return the least and the greatest value, or the one that both read as."""
    low, high = (value_cell(value, metric) for value in (values[0], values[-1]))
    return low if low == high else f"{low} … {high}"
