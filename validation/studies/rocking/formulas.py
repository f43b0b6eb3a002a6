"""The study `rocking`: a block that swings from corner to corner, and one that a pulse of its base overturns."""

from __future__ import annotations

import math
from collections.abc import Callable

import numpy as np

from validation.metrics.rotation import crossing, landing
from validation.runs.history import History
from validation.runs.row import Metrics
from validation.scenes.scene import Scene
from validation.suite.bands import Band, Bands
from validation.theory.rocking import rectangle, settlement

PULSED = "rocking-pulse"
# The record of the base
PUSH = 5.0  # acceleration [m/s2]
DURATION = 0.36  # s


def swing(scene: Scene, history: History) -> Metrics:
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


def passage(scene: Scene, history: History) -> Metrics:
    """Return the greatest tilt over a rigid block's, or the time at which the block passes over its corner."""
    rotation = history.columns["rotation"]
    exact = after_pulse(scene)
    if overturns(scene):
        return {"time": crossing(history.time, rotation, rectangle(scene).alpha) / exact(1.0)}
    return {"peak": float(np.max(rotation)) / exact(1.0), "tipping": float(np.max(rotation)) / rectangle(scene).alpha}


def rigid(scene: Scene) -> Metrics:
    """Return the rigid block: shape and tilt, or the pulse over the least one that overturns it."""
    block = rectangle(scene)
    values = {"slenderness": block.height / block.width, "tipping": block.alpha}
    if scene.name.startswith(PULSED):
        return values | {"size": PUSH / block.gravity / block.pulse_threshold(DURATION)}
    tilt = math.radians(scene.block.tilt)
    return values | {
        "tilt": tilt,
        "tilt over tipping": tilt / block.alpha,
        "quarter period": block.quarter_period(tilt),
    }


def overturns(scene: Scene) -> bool:
    """Tell whether the record overturns the rigid block."""
    block = rectangle(scene)
    return PUSH / block.gravity > block.pulse_threshold(DURATION)


def after_pulse(scene: Scene) -> Callable[[float], float]:
    """Return the peak [rad], or the time over the corner [s], of a rigid block by the size of the pulse."""
    block = rectangle(scene)
    sought = block.pulse_overturning if overturns(scene) else block.pulse_peak
    return lambda size: sought(size * PUSH / block.gravity, DURATION)


def quarter_period(case: Scene) -> Band:
    """Return the quarter period of a block released from a tilt, over that of a rigid block."""
    block = rectangle(case)
    tilt = math.radians(case.block.tilt)
    line = case.time.step**2 * block.rate2 * math.sin(block.alpha) / block.landing_rate(tilt)
    late = line / block.quarter_period(tilt)
    early = settlement(case) / (block.width * tilt) + late
    return 1 - early, 1 + late


def pulsed(case: Scene) -> Bands:
    """Return what a pulse that is sampled does, over what the pulse does to a rigid block."""
    exact = after_pulse(case)
    off = (case.time.step / DURATION) ** 2
    low, high = sorted(exact(size) / exact(1.0) for size in (1 - off, 1 + off))
    return {"time" if overturns(case) else "peak": (low, high)}
