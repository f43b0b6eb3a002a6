"""The alarms of scenes in lines, each kind once."""

from __future__ import annotations

from itertools import chain

from validation.report.blocks import Callout
from validation.report.chapters.data import Groups
from validation.runs.records import AlarmRecord


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
