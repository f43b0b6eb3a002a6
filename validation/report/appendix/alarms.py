"""Alarms: results that look better than they are, a line for each kind and scene with its worst case."""

from __future__ import annotations

import itertools
from collections.abc import Callable, Mapping, Sequence

from validation.advice.alarms import AGREEMENT, RINGING, TENSION
from validation.report.blocks import Blocks, Heading, TableColumn, table
from validation.report.chapters.data import Groups, labels_of
from validation.report.chapters.text import capital
from validation.runs.records import AlarmRecord
from validation.solvers.contract import Role
from validation.solvers.registry import by_role

Alarms = Sequence[AlarmRecord]
MOST_SCENES = 7  # of a kind that get a row each


def alarm_table(groups: Groups) -> Blocks:
    """Return the alarms by kind, scenes beyond the first few by name alone; nothing where none was raised."""
    kinds: dict[str, dict[str, list[AlarmRecord]]] = {}  # by kind and scene
    labels = labels_of(groups.values())
    for group in groups.values():
        for alarm in group.alarms:
            kinds.setdefault(alarm["kind"], {}).setdefault(group.name, []).append(alarm)
    rows = []
    for kind, scenes in sorted(kinds.items()):
        most = MOST_SCENES if kind in SEVERITY else 1
        for name, alarms in itertools.islice(scenes.items(), most):
            rows.append((kind, name, f"{len(alarms)} of {len(groups[name].cases)}", remark(alarms, labels)))
        if len(scenes) > most:
            others = dict(itertools.islice(scenes.items(), most, None))
            count = sum(map(len, others.values()))
            rows.append((kind, f"{len(others)} more", str(count), f"{', '.join(others)}."))
    titles = ("Alarm", "Scene", "Cases", TableColumn("The worst of them", "fill"))
    caption = "Results that look better than they are, as the runs raised them."
    return [Heading("Alarms", 2), table(titles, rows, caption)] if rows else []


def remark(alarms: Alarms, labels: Mapping[str, str]) -> str:
    """Return the sentence of the worst alarm behind its case, of the first where the kind has no order."""
    severity = SEVERITY.get(alarms[0]["kind"])
    if severity is None:
        return _sentence(alarms[0])
    worst = max(alarms, key=lambda alarm: severity(alarm["values"]))
    label = labels.get(worst["scene"], "")
    return f"{label}: {worst['sentence']}." if label else _sentence(worst)


def _sentence(alarm: AlarmRecord) -> str:
    """Return the sentence of an alarm, with a capital letter unless it begins with a symbol."""
    sentence = alarm["sentence"]
    first, *remainder = sentence.split()
    is_symbol = first in ("dt", "gg") or "_" in first or remainder[:1] == ["="]  # which stays as it is written
    return f"{sentence if is_symbol else capital(sentence)}."


def tension(values: Mapping[str, float]) -> tuple[bool, float]:
    """Return how deep a locked contact pulls [Pa], under the judged solver if it does."""
    minima = {name.removesuffix(".minimum"): value for name, value in values.items() if name.endswith(".minimum")}
    judged = [minima[solver] for solver in by_role(Role.JUDGED) if solver in minima]
    return bool(judged), -min(judged or minima.values())


# Of a kind of alarm whose worst is shown for each scene: how bad it is, by its values.
SEVERITY: dict[str, Callable[[Mapping[str, float]], tuple[bool, float]]] = {
    AGREEMENT: lambda values: (True, values["removed"]),
    TENSION: tension,
    RINGING: lambda values: (True, values["radius"]),
}
