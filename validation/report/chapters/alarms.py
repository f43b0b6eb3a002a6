"""The alarms of scenes in lines, each kind once."""

from __future__ import annotations

from itertools import chain

from validation.report.blocks import Callout
from validation.report.chapters.data import Groups, labels_of
from validation.report.chapters.text import AS_STATED, some
from validation.runs.case_name import scene_of
from validation.runs.records import AlarmRecord

MOST_NAMES = 6  # of scenes in a line


def alarm_lines(groups: Groups) -> list[Callout]:
    """Return each kind of alarm with the number of its cases, scenes if several, and the first sentence."""
    raised: dict[str, list[AlarmRecord]] = {}
    for alarm in chain.from_iterable(group.alarms for group in groups.values()):
        raised.setdefault(alarm["kind"], []).append(alarm)
    labels = labels_of(groups.values())
    lines = []
    for kind, records in raised.items():
        first = records[0]
        names = [record["scene"] for record in records]
        cases = len(set(names))
        number = f" in {cases} cases" if cases > 1 else ""
        scenes = list(map(scene_of, names))
        where = f" of {some(scenes, MOST_NAMES)}" if len(set(scenes)) > 1 else ""
        label = labels.get(first["scene"], AS_STATED)
        case = scene_of(first["scene"]) + ("" if label == AS_STATED else f", {label}")
        lines.append(Callout(f"Alarm{number}{where}, {kind}: {case}: {first['sentence']}.", "warn"))
    return lines
