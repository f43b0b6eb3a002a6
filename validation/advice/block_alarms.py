"""The alarms of a block: tension of a locked contact, and a contact mode that rings.

That of a start that puts energy in is in `validation.advice.overshoot`, those of contact that opens in
`.contact_alarms`, those of friction in `.friction`.
"""

from __future__ import annotations

from collections.abc import Iterator

from validation.advice.alarm import Alarm, alarm, first_row, number
from validation.advice.contact_alarms import contact_alarms
from validation.advice.friction import friction_alarms
from validation.advice.overshoot import overshoot_alarms
from validation.advice.spectra import FLIPPING, steps_to
from validation.runs.row import RowsBySolver
from validation.scenes.scene import Scene
from validation.solvers.contract import Role
from validation.solvers.registry import role

TENSION = "hidden tension"
RINGING = "contact ringing"


def block_alarms(scene: Scene, rows: RowsBySolver) -> Iterator[Alarm]:
    """Yield the alarms of a block from its finished rows by solver."""
    # one alarm for all solvers whose contact carries tension
    values: dict[str, float] = {}
    parts = []
    for solver, row in rows.items():
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
    judged = first_row(rows, Role.JUDGED)
    root = number(judged, "contact.least_root")
    radius = number(judged, "contact.spectral_radius")
    if root is not None and radius is not None and root <= FLIPPING:
        steps = steps_to(0.01, radius)
        decay = f"takes {steps:.0f} steps to fall to 1 %" if steps < 1e6 else "hardly decays"
        yield alarm(RINGING, scene.name, {"root": root, "radius": radius}, decay=decay)
    yield from contact_alarms(scene, rows)
    yield from overshoot_alarms(scene, rows)
    yield from friction_alarms(scene, rows)
