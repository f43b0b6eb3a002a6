"""The alarm of a start that puts energy in, whatever the contact does later."""

from __future__ import annotations

import math
from collections.abc import Iterator
from contextlib import suppress

from validation.advice.alarm import Alarm, alarm, first_row
from validation.advice.coarse import closed
from validation.advice.spectra import dda_modes
from validation.errors import InputError
from validation.runs.modes import Mode
from validation.runs.row import RowsBySolver
from validation.scenes import features
from validation.scenes.scene import Scene
from validation.solvers.contract import Role
from validation.theory import overshoot
from validation.theory.stepping import Stepping

OVERSHOOT = "overshoot of the start"
KINDS = (OVERSHOOT,)
NOTABLE = 0.01  # of the energy given
IMPULSES = frozenset({features.RIGID, features.IMPLICIT, features.CONSERVING, features.SUB_BLOCKS})


def overshoot_alarms(scene: Scene, rows: RowsBySolver) -> Iterator[Alarm]:
    """Yield the alarm of the judged method's start, by its finished rows."""
    if first_row(rows, Role.JUDGED) is None or (rise := start_rise(scene)) is None:
        return
    if rise > NOTABLE:
        yield alarm(OVERSHOOT, scene.name, {"rise": rise}, scheme=Stepping.of(scene).name)


def start_rise(scene: Scene) -> float | None:
    """Return by how much the start raises the energy over what the loads give [-]; None where that is not known.

    Known it is of a whole block that stands on its springs at rest under loads that come on at once.
    """
    if IMPULSES & {*features.of(scene)}:
        return None
    if scene.contact.gap or scene.block.velocity or scene.block.tilt or scene.load.ramp:
        return None
    if scene.time.start == "zero":  # nothing that an alarm would tell, and no modes need be known
        return 0.0
    with suppress(InputError):  # DDA does not take the scene
        return rise_of(Stepping.of(scene), dda_modes(closed(scene)))
    return None


def rise_of(stepping: Stepping, modes: tuple[Mode, ...]) -> float | None:
    """Return it of a scheme, a consistent start and a block's modes; None where not every step is stable."""
    if math.isfinite(stepping.critical_omega):
        return None
    omegas_dt = [mode.frequency * stepping.step for mode in modes]
    return overshoot.greatest_rise(stepping.stages, omegas_dt, [mode.share for mode in modes])
