"""Alarms: results that look better than they are.

hidden tension
    A locked contact carries tension; a real one would open.
contact ringing
    A root of the contact mode lies next to -1: it flips sign every step and hardly decays.
fixed discount
    dt is refined at a fixed gg < 1, which acts per step: the answers do not converge.

Those of a step that is too long for the motion are in `validation.advice.coarse`, that of a start that puts energy in
in `.overshoot`, those of contact that opens in `.contact_alarms`, those of friction in `.friction`, those of columns
whose contacts open or slip in `.columns`.
"""

from __future__ import annotations

import functools
from collections.abc import Iterable, Iterator, Mapping, Sequence
from typing import Protocol

from validation.advice.alarm import Alarm as Alarm
from validation.advice.alarm import alarm, first_row, number
from validation.advice.coarse import coarse_alarms
from validation.advice.contact_alarms import contact_alarms
from validation.advice.friction import friction_alarms
from validation.advice.overshoot import overshoot_alarms
from validation.advice.spectra import FLIPPING, steps_to
from validation.metrics.catalogue import pair as pair_metric
from validation.runs.case_name import scene_of
from validation.runs.history import History
from validation.runs.numbers import share_text
from validation.runs.row import Row
from validation.runs.run import Outcome
from validation.scenes.scene import Scene
from validation.solvers.contract import EXACT_IN_TIME, Role
from validation.solvers.registry import by_role, role

TENSION = "hidden tension"
RINGING = "contact ringing"
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
    blocks = [scene for scene in listed if "block" in scene.tables()]
    for scene in listed:
        rows = rows_by_scene.get(scene.name, {})
        if _stepped(rows):
            frequency = number(first_row(rows, Role.JUDGED), "mode1.frequency")
            yield from coarse_alarms(scene, frequency, functools.partial(agreement, scene, finished))
    for scene in blocks:
        rows = rows_by_scene.get(scene.name, {})
        yield from _tension(scene, rows)
        yield from _ringing(scene, rows)
        yield from contact_alarms(scene, rows)
        yield from overshoot_alarms(scene, rows)
        yield from friction_alarms(scene, rows)
    yield from fixed_discount(blocks)


def _stepped(rows: Mapping[str, Row]) -> bool:
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


def _tension(scene: Scene, solvers: Mapping[str, Row]) -> Iterator[Alarm]:
    """Yield one alarm for the solvers whose contact carries tension; runs that repeat another are not listed."""
    values: dict[str, float] = {}
    parts = []
    for solver, row in solvers.items():
        minimum = number(row, "pressure.minimum")
        time = number(row, "pressure.minimum_time")
        duration = number(row, "pressure.tension_time")
        if ":" in solver or role(solver) is Role.REPEAT or minimum is None or time is None or duration is None:
            continue
        if minimum < -1e-6 * abs(scene.load.pressure) and duration > 0:
            values |= {f"{solver}.minimum": minimum, f"{solver}.time": time, f"{solver}.duration": duration}
            parts.append(f"in {solver} by {-minimum / 1e6:.3g} MPa at t = {time:.4g} s, for {duration:.3g} s in total")
    if parts:
        yield alarm(TENSION, scene.name, values, solvers="; ".join(parts))


def _ringing(scene: Scene, solvers: Mapping[str, Row]) -> Iterator[Alarm]:
    row = first_row(solvers, Role.JUDGED)
    root = number(row, "contact.least_root")
    radius = number(row, "contact.spectral_radius")
    if root is None or radius is None or root > FLIPPING:
        return
    steps = steps_to(0.01, radius)
    decay = f"takes {steps:.0f} steps to fall to 1 %" if steps < 1e6 else "hardly decays"
    yield alarm(RINGING, scene.name, {"root": root, "radius": radius}, decay=decay)


def fixed_discount(scenes: Sequence[Scene]) -> Iterator[Alarm]:
    """Yield an alarm for each scene whose cases refine dt at one gg < 1."""
    steps_by_discount: dict[tuple[str, float], set[float]] = {}
    for scene in scenes:
        if scene.time.gg_rate is None and 0 < scene.time.discount < 1:
            steps_by_discount.setdefault((scene_of(scene.name), scene.time.discount), set()).add(scene.time.step)
    for (name, gg), steps in steps_by_discount.items():
        if len(steps) > 1:
            yield alarm(DISCOUNT, name, {"gg": gg})
