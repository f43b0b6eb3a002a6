"""Alarms: results that look better than they are, a line for each kind and scene with its worst case."""

from __future__ import annotations

import itertools
import math
from collections.abc import Callable, Mapping, Sequence

from validation.advice.alarms import AGREEMENT, RINGING, TENSION
from validation.report.blocks import Block, Column, Heading, Table, columns
from validation.report.chapters.data import Group
from validation.report.chapters.text import percent, plain, short
from validation.runs.records import AlarmRecord
from validation.solvers.contract import Role
from validation.solvers.registry import by_role

Alarms = Sequence[AlarmRecord]
MOST_SCENES = 7  # of a kind that are told one by one


def alarm_table(found: Mapping[str, Group]) -> list[Block]:
    """Return the alarms by kind, scenes beyond the first few by name alone; nothing where none was raised."""
    kinds: dict[str, dict[str, list[AlarmRecord]]] = {}
    labels: dict[str, str] = {}
    for group in found.values():
        labels |= {case.name: case.label for case in group.cases}
        for alarm in group.alarms:
            kinds.setdefault(alarm["kind"], {}).setdefault(group.name, []).append(alarm)
    rows = []
    for kind, scenes in sorted(kinds.items()):
        most = MOST_SCENES if kind in WORST else 1
        for name, own in itertools.islice(scenes.items(), most):
            rows.append((kind, name, f"{len(own)} of {len(found[name].cases)}", WORST.get(kind, remark)(own, labels)))
        if len(scenes) > most:
            others = list(itertools.islice(scenes.items(), most, None))
            rest = ", ".join(name for name, _ in others)
            rows.append((kind, f"{len(others)} more", str(sum(len(own) for _, own in others)), f"{rest}."))
    titles = (*columns("text", "Alarm", "Scene", "Cases"), Column("The worst of them", "fill"))
    caption = "Results that look better than they are, as the runs raised them."
    return [Heading("Alarms", 2), Table(titles, tuple(rows), caption)] if rows else []


def remark(alarms: Alarms, labels: Mapping[str, str]) -> str:
    """Return the sentence of the first alarm, with a capital letter unless it begins with a symbol."""
    said = alarms[0]["sentence"]
    first, *rest = said.split()
    symbol = first in ("dt", "gg") or "_" in first or rest[:1] == ["="]  # which stays as it is written
    return f"{said if symbol else said[:1].upper() + said[1:]}."


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
    said = []
    solvers = dict.fromkeys(key.rpartition(".")[0] for alarm in alarms for key in alarm["values"])
    judged = [solver for solver in solvers if solver in by_role(Role.JUDGED)]
    for solver in judged or solvers:
        own = [alarm for alarm in alarms if f"{solver}.minimum" in alarm["values"]]
        worst = min(own, key=lambda alarm: alarm["values"][f"{solver}.minimum"])
        least, when, lasts = (worst["values"][f"{solver}.{part}"] for part in ("minimum", "time", "duration"))
        said.append(
            f"{solver} {plain(least / 1e6, 3)} MPa at {short(1e3 * when)} ms, tension for {short(1e3 * lasts)} ms"
        )
    return f"{'; '.join(said)}."


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
