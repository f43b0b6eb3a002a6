"""Alarms: results that look better than they are. Their sentences are in `alarms.toml`.

Those of a step that is too long for the motion are in `validation.advice.coarse`; a kind of scene brings those of its
contacts: `.block_alarms`, and `.columns` of columns whose contacts open or slip.
"""

from __future__ import annotations

import functools
from collections.abc import Iterable, Iterator
from typing import Protocol

from validation.advice.alarm import Alarm as Alarm
from validation.advice.alarm import alarm, first_row, number
from validation.advice.coarse import coarse_alarms
from validation.advice.hooks import AdviceHooks
from validation.metrics.catalogue import pair as pair_metric
from validation.runs.case_name import scene_of
from validation.runs.history import History
from validation.runs.numbers import share_text
from validation.runs.row import Row, RowsBySolver
from validation.runs.run import Outcome
from validation.scenes.scene import Scene
from validation.solvers.contract import EXACT_IN_TIME, Role
from validation.solvers.registry import by_role, role

DISCOUNT = "fixed discount"
AGREES = 0.5  # relative L2 below which two histories share more than half of the motion


class Cases(Protocol):
    """What alarms are raised from: rows and histories of finished cases."""

    @property
    def rows(self) -> dict[tuple[str, str], Row]:
        """Rows by (scene, solver)."""

    def history(self, scene: str, solver: str) -> History | None:
        """Return the history of a case, or None."""


def alarms(scenes: Iterable[Scene], finished: Cases) -> Iterator[Alarm]:
    """Yield the alarms of finished cases, in the order of the scenes."""
    listed = list(scenes)
    rows_by_scene: dict[str, dict[str, Row]] = {}
    for (name, solver), row in finished.rows.items():
        rows_by_scene.setdefault(name, {})[solver] = row
    for scene in listed:
        rows = rows_by_scene.get(scene.name, {})
        if _stepped(rows):
            frequency = number(first_row(rows, Role.JUDGED), "mode1.frequency")
            yield from coarse_alarms(scene, frequency, functools.partial(agreement, scene, finished))
    for scene in listed:
        yield from AdviceHooks.of(scene).alarms(scene, rows_by_scene.get(scene.name, {}))
    yield from fixed_discount(scene for scene in listed if AdviceHooks.of(scene).has_budget)


def _stepped(rows: RowsBySolver) -> bool:
    """Whether some solver that takes the scene's steps has completed it."""
    return any(row.outcome is Outcome.COMPLETED and role(solver) not in EXACT_IN_TIME for solver, row in rows.items())


def agreement(scene: Scene, finished: Cases) -> str:
    """Say how well the judged method and its reference agree; nothing where one did not run, or they do not agree."""
    judged, history = _first(scene, finished, Role.JUDGED)
    name, reference = _first(scene, finished, Role.REFERENCE)
    if history is None or reference is None:
        return ""
    difference = pair_metric("displacement.l2", history, reference)
    if not isinstance(difference, float) or difference >= AGREES:
        return ""
    return f"{judged} and {name} are {share_text(difference, 2)} apart only"


def _first(scene: Scene, finished: Cases, role_of_solver: Role) -> tuple[str, History | None]:
    """Return the solver of the highest rank of a role that has a history of the scene, and that history."""
    for name in by_role(role_of_solver):
        if (history := finished.history(scene.name, name)) is not None:
            return name, history
    return "", None


def fixed_discount(scenes: Iterable[Scene]) -> Iterator[Alarm]:
    """Yield an alarm for each scene whose cases refine dt at one gg < 1."""
    steps_by_discount: dict[tuple[str, float], set[float]] = {}
    for scene in scenes:
        if scene.time.gg_rate is None and 0 < scene.time.discount < 1:
            steps_by_discount.setdefault((scene_of(scene.name), scene.time.discount), set()).add(scene.time.step)
    for (name, gg), steps in steps_by_discount.items():
        if len(steps) > 1:
            yield alarm(DISCOUNT, name, {"gg": gg})
