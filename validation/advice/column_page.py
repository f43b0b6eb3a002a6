"""What `dda-validate contact` says of a column whose contacts open or slip: its runs, and what its steps need."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import asdict
from typing import Any

from validation.advice import columns, contact_page
from validation.advice.plain import Line, in_columns
from validation.runs.row import Row, Value
from validation.scenes import features
from validation.scenes.scene import Scene
from validation.solvers.contract import Role
from validation.solvers.registry import by_role, get_solver
from validation.theory.stepping import Stepping


def scenes(scene: Scene) -> dict[str, Scene]:
    """Return the scene that each solver runs: the exact motion has no kinetic damping."""
    handled = {name for name in features.OF_MOVING_COLUMN if name in features.of(scene)}
    free = scene.with_values({"time.gg": 1.0}) if scene.time.discount < 1 else scene
    exact = [name for name in by_role(Role.LIMIT) if handled <= get_solver(name).handles]
    return {contact_page.own(): scene} | dict.fromkeys(exact, free)


def answer(scene: Scene, rows: Mapping[str, Row], bound: columns.ColumnLimits) -> dict[str, Any]:
    """Return everything as plain data."""
    return {
        "scene": scene.name,
        "limits": asdict(bound),
        "runs": {name: contact_page.measured(row) for name, row in rows.items()},
        "alarms": [alarm.record() for alarm in columns.column_alarms(scene)],
    }


def page(
    scene: Scene, bound: columns.ColumnLimits, data: Mapping[str, Any], absent: Mapping[str, str]
) -> Iterator[str]:
    """Yield the lines of one page of text; `absent` says why a solver has no column."""
    t = scene.time
    yield f"{scene.name}: {scene.title or 'a column whose contacts open or slip'}"
    yield (f"{bound.contacts} contacts, dt = {t.step:g} s, {Stepping.of(scene).numbers}, gg = {t.discount:.6g}")
    yield ""
    yield in_columns(table(scene, data["runs"]))
    yield from (f"{name}: {why}" for name, why in absent.items())
    yield ""
    yield from columns.advised(scene, bound)
    for alarm in data["alarms"]:
        yield f"ALARM {alarm['kind']}: {alarm['sentence']}"


def table(scene: Scene, runs: Mapping[str, Mapping[str, Value]]) -> list[Line]:
    """Return the runs side by side; a line that no run has a number for is left out."""
    lines: list[Line] = [(f"over {scene.time.duration:.4g} s", *runs)]
    for line in [*contact_page.measured_lines("column", runs), *contact_page.measured_lines("repeatable", runs)]:
        if any(value != contact_page.NONE for value in line[1:]):
            lines.append(line)
    return lines
