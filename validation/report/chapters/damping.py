"""Damping budgets and alarms as blocks of a scene's page."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from pathlib import Path

from validation.advice.alarms import AGREEMENT, RINGING, TENSION
from validation.report.blocks import Block, Callout, Column, Table, columns
from validation.report.chapters.data import Group
from validation.report.chapters.text import percent, plain, short
from validation.report.figures import histories
from validation.report.figures.paper import BudgetPanel, budget_figure
from validation.runs.records import AlarmRecord, BudgetRecord


def budget_blocks(group: Group, directory: Path) -> list[Block]:
    """Return the damping budget chart of a scene, or nothing where its results hold none."""
    if not group.budgets:
        return []
    labels = {case.name: case.label for case in group.cases}
    alone = len(group.budgets) == 1
    panels = []
    for budget in group.budgets:
        panels.append(BudgetPanel("" if alone else _label(labels.get(budget["scene"], "")), budget))
    file = f"{group.slug}-damping-budget.svg"
    return [histories.saved(budget_figure(panels), directory, file, _caption(group.budgets))]


def _label(text: str) -> str:
    """Return a case's label without its time step, over which the chart is drawn."""
    return ", ".join(part for part in text.split(", ") if not part.startswith(("dt =", "steps =", "n =")))


def _caption(budgets: Sequence[BudgetRecord]) -> str:
    said = [
        "Damping budget of DDA's first axial and contact mode over the time step (triangles: the cases).",
        "Open circles: the roots of the step turn real and there is no damping ratio beyond; one root returns to −1.",
    ]
    if any("overdamped below" in budget["limits"] for budget in budgets):
        said.append("Grey: overdamped.")
    said.append("a/c: the wave's way from top to base; a larger dt does not see it.")
    floors = sorted({budget["floor"] for budget in budgets if budget["floor"]})
    if floors:
        span = f"{floors[0]:.3f}" + (f" to {floors[-1]:.3f}" if floors[-1] != floors[0] else "")
        said.append(f"DDA's first frequency is {span} times the bar's at any dt.")
    if any(budget["gg_rate"] for budget in budgets):
        said.append("The discount is held as a rate.")
    elif any(budget["gg"] < 1 for budget in budgets):
        said.append("gg acts per step: towards small dt the kinetic part grows without bound.")
    return " ".join(said)


def alarm_blocks(group: Group) -> list[Block]:
    """Return the alarms of a scene: a table for each kind that has numbers side by side, a remark for each other."""
    labels = {case.name: case.label for case in group.cases}
    kinds: dict[str, list[AlarmRecord]] = {kind: [] for kind in TABLES}
    for alarm in group.alarms:
        kinds.setdefault(alarm["kind"], []).append(alarm)
    tables = [TABLES[kind](own, labels) for kind, own in kinds.items() if own and kind in TABLES]
    return [*tables, *(Callout(remark(own), "warn") for kind, own in kinds.items() if kind not in TABLES)]


def remark(alarms: Sequence[AlarmRecord]) -> str:
    """Return the sentence of an alarm; of several of one kind the first, and how many cases it is raised in."""
    said = alarms[0]["sentence"]
    count = f" (the first of {len(alarms)} cases with this alarm)" if len(alarms) > 1 else ""
    return f"{said[:1].upper()}{said[1:]}{count}."


Alarms = Sequence[AlarmRecord]
Labels = Mapping[str, str]


def agreement_table(alarms: Alarms, labels: Labels) -> Table:
    """Return agreement, share of the motion that damping removed and time error, side by side."""
    rows = tuple(
        (
            labels.get(alarm["scene"], alarm["scene"]),
            percent(alarm["values"]["agreement"]),
            f"{plain(100 * alarm['values']['removed'], 2)}\u00a0%",
            percent(alarm["values"]["time error"]),
        )
        for alarm in alarms
    )
    titles = columns("decimal", "DDA – elastic block", "Motion removed by damping", "Time error of both")
    caption = "Alarm, agreement by damping: both are damped out (relative L2 of the displacement)."
    return Table((Column("Case"), *titles), rows, caption)


def tension_table(alarms: Alarms, labels: Labels) -> Table:
    """Return how deep, when and for how long the locked contact pulls, by solver."""
    rows = []
    for alarm in alarms:
        values, label = alarm["values"], labels.get(alarm["scene"], alarm["scene"])
        for solver in dict.fromkeys(key.rpartition(".")[0] for key in values):
            least, when, duration = (values[f"{solver}.{part}"] for part in ("minimum", "time", "duration"))
            rows.append((label, solver, plain(least / 1e6, 3), short(1e3 * when), short(1e3 * duration)))
            label = ""
    titles = (
        *columns("text", "Case", "Solver"),
        *columns("decimal", "Least pressure [MPa]", "at [ms]", "tension for [ms]"),
    )
    return Table(titles, tuple(rows), "Alarm, hidden tension: the locked contact pulls where a real one opens.")


def ringing_table(alarms: Alarms, labels: Labels) -> Table:
    """Return the root next to -1 and how many steps it takes to fall to 1 %."""
    rows = []
    for alarm in alarms:
        radius = alarm["values"]["radius"]
        steps = f"{math.log(100) / -math.log(radius):.0f}" if 0 < radius < 1 else "∞"
        label = labels.get(alarm["scene"], alarm["scene"])
        rows.append((label, plain(alarm["values"]["root"]), plain(radius), steps))
    titles = (Column("Case"), *columns("decimal", "Root", "|λ|", "Steps to fall to 1 %"))
    return Table(titles, tuple(rows), "Alarm, contact ringing: a root of DDA's contact mode lies next to −1.")


TABLES: dict[str, Callable[[Alarms, Labels], Table]] = {
    AGREEMENT: agreement_table,
    TENSION: tension_table,
    RINGING: ringing_table,
}
