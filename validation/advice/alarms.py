"""Alarms: results that look better than they are.

agreement by damping
    DDA and its reference agree better than either of them agrees with the motion, because both are damped out.
hidden tension
    A locked contact carries tension; a real one would open.
contact ringing
    A root of the contact mode lies next to -1: it flips sign every step and hardly decays.
fixed discount
    dt is refined at a fixed gg < 1, which acts per step: the answers do not converge.

Those of contact that opens are in `validation.advice.contact_alarms`, those of friction in `.friction`, those of
columns whose contacts open or slip in `.columns`.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator, Mapping, Sequence
from typing import Protocol

import numpy as np

from validation.advice.alarm import Alarm as Alarm
from validation.advice.alarm import alarm, first_row, number
from validation.advice.contact_alarms import contact_alarms
from validation.advice.friction import friction_alarms
from validation.metrics.catalogue import pair as pair_metric
from validation.runs.case_name import scene_of
from validation.runs.history import History
from validation.runs.row import Row
from validation.scenes.scene import Scene
from validation.solvers.contract import Role
from validation.solvers.registry import by_role, role

AGREEMENT = "agreement by damping"
TENSION = "hidden tension"
RINGING = "contact ringing"
DISCOUNT = "fixed discount"
REMOVED = 0.5  # of the first mode's motion over the window
FLIPPING = -0.9  # real part of a root below which a mode flips every step and keeps over 0.9 of its amplitude


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
        yield from _agreement(scene, finished)
        yield from _tension(scene, rows)
        yield from _ringing(scene, rows)
        yield from contact_alarms(scene, rows)
        yield from friction_alarms(scene, rows)
    yield from fixed_discount(listed)


def agreement_by_damping(scene: Scene, finished: Cases) -> dict[str, float] | None:
    """Return agreement, share of the motion that damping removed and time error, or None where not all are known.

    Agreement and time error are relative L2 of the displacement, over the whole history: DDA against the bar (or
    elements) under the same scheme, and that reference against the continuum. The share is one minus the root mean
    square over the window of the first mode's amplitude |lambda|^n, without what physical damping would remove: the
    continuum has the kinetic damping -ln(gg) / dt, so that only the algorithmic part counts.
    """
    solver, history = _first(scene, finished, Role.JUDGED)
    _, reference = _first(scene, finished, Role.REFERENCE)
    _, exact = _first(scene, finished, Role.TRUTH)
    if history is None or exact is None or reference is None:
        return None
    agreement = pair_metric("displacement.l2", history, reference)
    error = pair_metric("displacement.l2", reference, exact)
    row = finished.rows[scene.name, solver]
    radius = number(row, "mode1.spectral_radius")
    if not (isinstance(agreement, float) and isinstance(error, float) and radius is not None):
        return None
    removed = removed_motion(scene, radius, number(row, "mode1.frequency") or 0.0)
    return {"agreement": agreement, "removed": removed, "time error": error}


def _first(scene: Scene, finished: Cases, role_of_solver: Role) -> tuple[str, History | None]:
    """Return the solver of the highest rank of a role that has a history of the scene, and that history."""
    for name in by_role(role_of_solver):
        if (history := finished.history(scene.name, name)) is not None:
            return name, history
    return "", None


def removed_motion(scene: Scene, radius: float, frequency: float = 0.0) -> float:
    """Return one minus the root mean square of (|lambda| / sqrt(gg))^n over the window, 0 where nothing is damped.

    Damping tables are meant: what they take from a mode of some frequency [rad/s] is no removal, and neither is what
    the discount takes.
    """
    rate = scene.damping.mass + scene.damping.stiffness * frequency**2
    physical_radius = math.sqrt(scene.time.discount) * math.exp(-rate * scene.time.step / 2)
    if radius == 0 or physical_radius == 0:
        return 1.0
    amplitude = np.minimum(radius / physical_radius, 1.0) ** np.arange(1, scene.time.steps + 1)
    return float(1 - np.sqrt(np.mean(amplitude**2)))


def _agreement(scene: Scene, finished: Cases) -> Iterator[Alarm]:
    values = agreement_by_damping(scene, finished)
    if values is None or values["removed"] < REMOVED or values["agreement"] >= values["time error"]:
        return
    shares = {"agreement_share": "agreement", "removed_share": "removed", "error_share": "time error"}
    yield alarm(AGREEMENT, scene.name, values, **{word: 100 * values[name] for word, name in shares.items()})


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
    steps = math.log(100) / -math.log(radius) if 0 < radius < 1 else math.inf
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
