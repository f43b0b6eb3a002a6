"""The study `impacts`: benchmarks of impact that others publish, by exact motions, by DDA and by elements.

The data are those of the publications; the numbers are closed forms, or those of an independent program where the
springs are soft enough to count (p h / E finite; the publications have a rigid wall).
"""

from __future__ import annotations

import math
from collections.abc import Sequence

from validation.metrics.values import finite, or_nan
from validation.runs.row import Metrics, Row, Value
from validation.scenes.scene import Scene
from validation.suite.bands import Band, Bands, about, near

SWITCHES = {  # of the bouncing bar on a rigid wall
    "release": "switches.first_opening",
    "impact": "switches.second_closing",
    "second release": "switches.second_opening",
}


def transit(scene: Scene) -> float:
    """Return h / c, the time of a wave through the block [s]."""
    _, height = scene.block.rectangle or (0.0, 0.0)
    return height * math.sqrt(scene.block.density / scene.block.young)


def stiffness_ratio(scene: Scene) -> float:
    """Return the springs' stiffness over the bar's, 2 p h / (E a) [-]."""
    width, height = scene.block.rectangle or (math.nan, math.nan)
    return 2 * scene.contact.stiffness * height / (scene.block.young * width)


def release(scene: Scene) -> float:
    """Return when an unloaded bar leaves stiff springs [s]: gap / V + (2 + x / F) h / c, e^x = 2 (1 + x).

    F is the springs' stiffness over the bar's; what is left out is of the order e^(-2 F).
    """
    x = 2.0
    for _ in range(60):  # a step leaves 1 / (1 + x) = 0.37 of the error
        x = math.log(2 * (1 + x))
    return scene.contact.gap / -scene.block.velocity + (2 + x / stiffness_ratio(scene)) * transit(scene)


def bounce(scene: Scene) -> tuple[float, float, float]:
    """Return when a mass lands on its spring, when it leaves [s], and how deep it goes [m].

    With V^2 = V0^2 + 2 g s, w^2 = k / m: contact lasts (2 / w) (pi - atan(V w / g)), and the penetration is
    g / w^2 + sqrt(g^2 / w^4 + V^2 / w^2).
    """
    b = scene.block
    g = scene.load.gravity
    width, height = scene.block.rectangle or (math.nan, math.nan)
    w = math.sqrt(2 * scene.contact.stiffness / (b.density * width * height))
    V = math.sqrt(b.velocity**2 + 2 * g * scene.contact.gap)
    landing = (V + b.velocity) / g
    sag = g / w**2
    return landing, landing + 2 / w * (math.pi - math.atan(V * w / g)), sag + math.hypot(sag, V / w)


def fall(scene: Scene) -> float:
    """Return when a block in free fall lands, sqrt(2 s / g) [s]."""
    return math.sqrt(2 * scene.contact.gap / scene.load.gravity)


def fall_landing(scene: Scene) -> Band:
    """Return when it lands, to rounding [s]."""
    return about(fall(scene), 1e-12)


def impact_length(scene: Scene) -> float:
    """Return the length of an impact of a quarter of the mass over a transit, sqrt(E / p) [-]."""
    return math.sqrt(scene.block.young / scene.contact.stiffness)


def impact_duration(scene: Scene) -> float:
    """Return the length of such an impact [s]."""
    return impact_length(scene) * transit(scene)


def wall(scene: Scene) -> Bands:
    """Return the impact of a bar on springs next to rigid: all of its momentum in 2 h / c, and the force rho c V."""
    compliance = 2 * impact_length(scene) ** 2
    force = math.sqrt(scene.block.density * scene.block.young) * scene.block.base_length * -scene.block.velocity
    return {
        "switches.first_opening": about(2 * transit(scene), compliance * transit(scene)),
        "contact.restitution": (1 - compliance, 1 + 1e-12),
        "contact.peak_force": near(force, 1e-11),
    }


def stiff_springs(scene: Scene) -> Bands:
    """Return the impact of an unloaded bar on stiff springs."""
    return {
        "switches.first_closing": near(scene.contact.gap / -scene.block.velocity, 1e-12),
        "switches.first_opening": near(release(scene), 1e-12),
        "contact.restitution": (1 - 1 / stiffness_ratio(scene), 1.0),
    }


def mass(scene: Scene) -> Bands:
    """Return the exact impact of a mass on its spring."""
    landing, leaving, depth = bounce(scene)
    return {
        "switches.first_closing": about(landing, 1e-12),
        "switches.first_opening": about(leaving, 1e-4 * (leaving - landing)),
        "contact.penetration": near(depth, 1e-4),
    }


def depth_by_steps(scene: Scene) -> Band:
    """Return how deep it goes by steps [m]."""
    return near(bounce(scene)[2], 2e-4)


def rigid(levels: Sequence[tuple[Scene, Row]]) -> Metrics:
    """Return the bouncing bar's times on a rigid wall, linear in 1/p from the two stiffest springs [s]."""
    a, b = (1 / stiffness_ratio(case) for case, _ in levels[-2:])
    times: dict[str, Value] = {}
    for name, switch in SWITCHES.items():
        x, y = (or_nan(row.metrics.get(switch)) for _, row in levels[-2:])
        times[name] = finite((a * y - b * x) / (a - b))
    return times
