"""Alarms: results that look better than they are, a line for each kind."""

from __future__ import annotations

from validation.report.blocks import Blocks, Heading, TableColumn, table
from validation.report.chapters.data import Groups, labels_of
from validation.runs.records import AlarmRecord


def alarm_table(groups: Groups) -> Blocks:
    """Return the alarms by kind, with the scenes that raised them and the first of them; nothing where none was."""
    kinds: dict[str, dict[str, list[AlarmRecord]]] = {}  # by kind and scene
    for group in groups.values():
        for alarm in group.alarms:
            kinds.setdefault(alarm["kind"], {}).setdefault(group.name, []).append(alarm)
    labels = labels_of(groups.values())
    rows = []
    for kind, alarms in sorted(kinds.items()):
        scenes = ", ".join(f"{name} ({len(raised)} of {len(groups[name].cases)})" for name, raised in alarms.items())
        name, (first, *_) = next(iter(alarms.items()))
        case = ", ".join(filter(None, (name, labels.get(first["scene"]))))
        rows.append((kind, scenes, f"{case}: {first['sentence']}."))
    titles = ("Alarm", TableColumn("Scenes, and how many of their cases", "fill"), TableColumn("The first", "fill"))
    caption = "Results that look better than they are, as the runs raised them."
    return [Heading("Alarms", 2), table(titles, rows, caption, dense=True)] if rows else []
