"""The study `rocking`: a block that swings from corner to corner, and one that a pulse of its base overturns."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Mapping

import numpy as np

from validation.engine.finished import Derived, from_history
from validation.gates.gate import Gate
from validation.runs.history import History
from validation.runs.row import Value
from validation.scenes.scene import Scene
from validation.studies.bands import cases, gate
from validation.studies.declaration import Study
from validation.studies.rocking.read import crossing, landing, rectangle, settlement

LET_GO = ("rocking-release", "rocking-swing")
PULSE = "rocking-pulse"
# Derived rows
SWING = "swing"
PASSAGE = "pulse"
# The record of the base
PUSH = 5.0  # acceleration [m/s2]
DURATION = 0.36  # s


def swing(scene: Scene, history: History) -> Mapping[str, Value]:
    """Return quarter period over that of a rigid block, and the rate after the impact over that before it.

    The rate is that of a rigid block which rises to the greatest tilt on the other side.
    """
    block = rectangle(scene)
    tilt = math.radians(scene.block.tilt)
    landed = landing(history.time, history.columns["gap_n"])
    other = max(0.0, -float(np.min(history.columns["rotation"])) - tilt)
    risen = math.cos(block.alpha - other) - math.cos(block.alpha)  # over R, as the next
    fallen = math.cos(block.alpha - tilt) - math.cos(block.alpha)
    return {
        "quarter period": landed / block.quarter_period(tilt),
        "rate ratio": math.sqrt(risen / fallen),
        "rigid rate ratio": block.housner,
    }


def passage(scene: Scene, history: History) -> Mapping[str, Value]:
    """Return the greatest tilt over that of a rigid block, or the time at which the block passes over its corner."""
    rotation = history.columns["rotation"]
    exact = after_pulse(scene)
    if overturns(scene):
        return {"time": crossing(history.time, rotation, rectangle(scene).alpha) / exact(1.0)}
    return {"peak": float(np.max(rotation)) / exact(1.0), "tipping": float(np.max(rotation)) / rectangle(scene).alpha}


def overturns(scene: Scene) -> bool:
    """Tell whether the record of the base overturns the rigid block."""
    block = rectangle(scene)
    return PUSH / block.gravity > block.pulse_threshold(DURATION)


def after_pulse(scene: Scene) -> Callable[[float], float]:
    """Return the peak [rad], or the time of passing over the corner [s], of a rigid block by the size of the pulse."""
    block = rectangle(scene)
    sought = block.pulse_overturning if overturns(scene) else block.pulse_peak
    return lambda size: sought(size * PUSH / block.gravity, DURATION)


def derived() -> tuple[Derived, ...]:
    """Return the rows that are computed from finished cases."""
    swings = [from_history(case, "dda", SWING, swing) for case in cases(*LET_GO)]
    pulses = [from_history(case, "dda", PASSAGE, passage) for case in cases(PULSE)]
    return (*swings, *pulses)


def gates() -> tuple[Gate, ...]:
    """Return all gates of the study."""
    return (*swing_gates(), *pulse_gates(), *balance_gates())


def swing_gates() -> Iterator[Gate]:
    """Yield the gates on blocks that are released from a tilt."""
    why = (
        "rigid block, by quadrature; below: the corner settles by up to 2 m g / p, which the tilt need not go back; "
        "both: the gap's straight line within a step, dt^2 theta'' / (theta' T) at the landing"
    )
    falls = "delta = 1 gains no energy; how much an impact takes depends on step and springs and is no property of DDA"
    for case in cases(*LET_GO):
        block = rectangle(case)
        tilt = math.radians(case.block.tilt)
        line = case.time.step**2 * block.rate2 * math.sin(block.alpha) / block.landing_rate(tilt)
        late = line / block.quarter_period(tilt)
        early = settlement(case) / (block.width * tilt) + late
        yield gate(case, SWING, "quarter period", (1 - early, 1 + late), why)
        yield gate(case, SWING, "rate ratio", (0.0, 1.0), falls)


def pulse_gates() -> Iterator[Gate]:
    """Yield the gates on blocks on a base that accelerates for a while."""
    why = (
        "rigid block, by quadrature; the record is sampled at dt: between the answers to pulses that are weaker and "
        "stronger by (dt / duration)^2"
    )
    stays = "below the threshold, in closed form, the centroid does not pass over the corner"
    for case in cases(PULSE):
        exact = after_pulse(case)
        off = (case.time.step / DURATION) ** 2
        edges = sorted(exact(size) / exact(1.0) for size in (1 - off, 1 + off))
        metric = "time" if overturns(case) else "peak"
        yield gate(case, PASSAGE, metric, (edges[0], edges[1]), why)
        if not overturns(case):
            yield gate(case, PASSAGE, "tipping", (0.0, 1.0), stays)


def balance_gates() -> Iterator[Gate]:
    """Yield the gates on energy."""
    falls = "delta = 1 and forces along the chord of the step: contact gains no energy at any angle; band: rounding"
    for case in cases(*LET_GO):
        yield gate(case, "dda", "energy.rise", (0.0, 1e-10), falls)


STUDY = Study(
    name="rocking",
    title="A block that rocks and overturns",
    purpose="A block swings from one corner to the other by any angle, and a pulse of its base overturns it: when, "
    "against a rigid block, and what is left of the rate after an impact?",
    scenes=(*LET_GO, PULSE),
    gates=gates,
    derived=derived,
    pairs=(),
)
