"""Alarms: results that look better than they are, a line for each kind and scene with its worst case."""

from __future__ import annotations

import itertools
import math
from collections.abc import Callable, Mapping, Sequence

from validation.advice.alarms import AGREEMENT, RINGING, TENSION
from validation.report.blocks import Blocks, Heading, TableColumn, table
from validation.report.chapters.data import Groups, labels_of
from validation.report.chapters.text import percent, plain, short
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
        most = MOST_SCENES if kind in WORST else 1
        for name, alarms in itertools.islice(scenes.items(), most):
            worst = WORST.get(kind, remark)(alarms, labels)
            rows.append((kind, name, f"{len(alarms)} of {len(groups[name].cases)}", worst))
        if len(scenes) > most:
            others = dict(itertools.islice(scenes.items(), most, None))
            count = sum(map(len, others.values()))
            rows.append((kind, f"{len(others)} more", str(count), f"{', '.join(others)}."))
    titles = ("Alarm", "Scene", "Cases", TableColumn("The worst of them", "fill"))
    caption = "Results that look better than they are, as the runs raised them."
    return [Heading("Alarms", 2), table(titles, rows, caption)] if rows else []


def remark(alarms: Alarms, labels: Mapping[str, str]) -> str:
    """Return the sentence of the first alarm, with a capital letter unless it begins with a symbol."""
    sentence = alarms[0]["sentence"]
    first, *remainder = sentence.split()
    is_symbol = first in ("dt", "gg") or "_" in first or remainder[:1] == ["="]  # which stays as it is written
    return f"{sentence if is_symbol else sentence[:1].upper() + sentence[1:]}."


def agreement(alarms: Alarms, labels: Mapping[str, str]) -> str:
    """Say how well two motions agree that are both damped out, where damping took most."""
    worst = max(alarms, key=lambda alarm: alarm["values"]["removed"])
    agreed, removed, time = (worst["values"][name] for name in ("agreement", "removed", "time error"))
    return (
        f"{_at(worst, labels)}DDA within {percent(agreed)} of the elastic block, of whose motion damping removed "
        f"{plain(100 * removed, 2)}\u00a0%; both are {percent(time)} off in time."
    )


def tension(alarms: Alarms, labels: Mapping[str, str]) -> str:
    """Say how deep, when and for how long a locked contact pulls where it pulls most: under the judged solver if so."""
    keys = itertools.chain.from_iterable(alarm["values"] for alarm in alarms)
    solvers = dict.fromkeys(key.rpartition(".")[0] for key in keys)
    judged_solvers = [solver for solver in solvers if solver in by_role(Role.JUDGED)]
    parts = []
    for solver in judged_solvers or solvers:
        alarms_of_solver = [alarm for alarm in alarms if f"{solver}.minimum" in alarm["values"]]
        worst = min(alarms_of_solver, key=lambda alarm: alarm["values"][f"{solver}.minimum"])
        minimum, time, duration = (worst["values"][f"{solver}.{part}"] for part in ("minimum", "time", "duration"))
        parts.append(
            f"{solver} {plain(minimum / 1e6, 3)} MPa at {short(1e3 * time)} ms, tension for {short(1e3 * duration)} ms"
        )
    return f"{'; '.join(parts)}."


def ringing(alarms: Alarms, labels: Mapping[str, str]) -> str:
    """Say how long a contact rings whose root lies next to -1, where it rings longest."""
    worst = max(alarms, key=lambda alarm: alarm["values"]["radius"])
    radius = worst["values"]["radius"]
    steps = f"{math.log(100) / -math.log(radius):.0f}" if 0 < radius < 1 else "∞"
    root = f"root {plain(worst['values']['root'])}, |λ| = {plain(radius)}"
    return f"{_at(worst, labels)}{root}: {steps} steps to fall to 1 %."


def _at(alarm: AlarmRecord, labels: Mapping[str, str]) -> str:
    label = labels.get(alarm["scene"], "")
    return f"{label}: " if label else ""


WORST: dict[str, Callable[[Alarms, Mapping[str, str]], str]] = {
    AGREEMENT: agreement,
    TENSION: tension,
    RINGING: ringing,
}
