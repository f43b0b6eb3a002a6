"""The study `rebound`: what time step, springs and scheme make of a contact that opens.

A rigid block that lands with the speed V returns e V. For Newmark's scheme e is a function of Omega = w_c dt and of the
phase theta in which the block lands (its overshoot in the first step in contact over V dt), a continuous one of
straight lines in theta. DDA is held to that map, impact by impact; the map to its closed forms; and the paper's block,
unlocked, shows over time step and springs what follows: solves, switches and energy.
"""

from __future__ import annotations

import functools
import math
from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from validation.engine.finished import Derived, DerivedRows, Finished
from validation.metrics.values import finite, or_nan
from validation.runs.row import Metrics, Row
from validation.scenes.scene import Scene
from validation.solvers.rigid.impacts import impact_restitution, impact_statistics
from validation.suite.bands import Band, about, cases, short
from validation.theory import landing

KINDS = ("constant", "average", "implicit", "conserving")
IMPACTS = tuple(f"rebound-{kind}" for kind in KINDS)
MAPS = tuple(f"contact-map-{kind}" for kind in KINDS)
MAP = "restitution map"
EXACT_SWITCHES = {1.0: 21, 10.0: 108, 100.0: 156}  # p/E -> switches of each corner in 0.2 s, by an independent program
STIFF = ((0.5, 1.0), (0.25, 0.5), (1 / 3, 0.5), (0.5625, 1.0), (0.3025, 0.6))  # schemes on a rigid contact
PARTS = ("mean", "low", "high", "mean_square")
SOFT = 1e-7  # the block's own strain: eight times p/E, the steepest slope of the map in theta, and rounding beside it


def omega(scene: Scene) -> float:
    """Return sqrt(2 p / m) dt of a rigid block [-]."""
    return math.sqrt(2 * scene.contact.stiffness / scene.block.mass) * scene.time.step


def phase(scene: Scene) -> float:
    """Return the predictor's overshoot in the first step in contact over that step's way [-]."""
    ways = scene.contact.gap / (-scene.block.velocity * scene.time.step)
    return 1 - (ways - math.floor(ways))


def expected(scene: Scene) -> float:
    """Return the restitution at the scene's Omega and phase.

    A rigid mass under a fully implicit contact force moves as under constant acceleration, w' = w + V dt + A' dt^2 / 2
    and V' = V + A' dt; energy-conserving contact returns all of its speed.
    """
    t = scene.time
    if scene.contact.rule == "energy-conserving":
        return 1.0
    if scene.contact.rule == "implicit":
        return impact_restitution(0.5, 1.0, t.discount, omega(scene), phase(scene))
    return impact_restitution(t.alpha, t.delta, t.discount, omega(scene), phase(scene))


def derived() -> DerivedRows:
    """Return the rows that need no run, by scheme and by p/E."""
    statistics = [Derived(MAP, label(scheme), (), functools.partial(stiff, scheme)) for scheme in STIFF]
    own = [Derived(MAP, f"p = {r:g}E", (), functools.partial(own_landing, r)) for r in EXACT_SWITCHES]
    return (*statistics, *own)


def label(scheme: tuple[float, float]) -> str:
    """Return a scheme's name."""
    return f"({scheme[0]:.4g}, {scheme[1]:.4g})"


def compared(impacts: Sequence[tuple[Scene, Row]]) -> Metrics:
    """Return how far impacts are from the map at most."""
    differences = [abs(or_nan(dda.metrics.get("contact.restitution")) - expected(scene)) for scene, dda in impacts]
    return {"largest difference": finite(float(np.max(differences)))}


def stiff(scheme: tuple[float, float], finished: Finished) -> Metrics:
    """Return the statistics of the map on rigid contact."""
    return dict(zip(PARTS, impact_statistics(*scheme, 1.0, math.inf), strict=True))


def two_steps_of_constant_acceleration(case: Scene) -> Band | None:
    """Restitution at Omega = 2, where contact lasts two steps."""
    return about(1 / 3, SOFT) if math.isclose(omega(case), 2.0) else None


def two_steps_that_return_all(case: Scene) -> Band | None:
    """The same of a scheme that keeps the energy of two steps."""
    return about(1.0, SOFT) if math.isclose(omega(case), 2.0) else None


def exact_switches(case: Scene) -> Band:
    """Switches of both corners in 0.2 s."""
    count = 2.0 * EXACT_SWITCHES[ratio(case)]
    return count, count


def ratio(scene: Scene) -> float:
    """Return p/E."""
    return scene.contact.stiffness / scene.block.young


def finest() -> list[Scene]:
    """Return the case of smallest step for each p, whose exact motion is run."""
    finest_by_ratio: dict[float, Scene] = {}
    for case in cases(MAPS[0]):
        if ratio(case) not in finest_by_ratio or case.time.step < finest_by_ratio[ratio(case)].time.step:
            finest_by_ratio[ratio(case)] = case
    return list(finest_by_ratio.values())


@functools.cache
def data() -> Mapping[str, Any]:
    """Return the restitution map: mean, least and greatest e over Omega, by kind."""
    grid = np.geomspace(0.05, 1500.0, 61)
    curves = {}
    for kind, scheme in zip(KINDS, ((0.5, 1.0), (0.25, 0.5), (0.5, 1.0), None), strict=True):
        rows = np.ones((len(PARTS), len(grid)))
        if scheme is not None:
            rows = np.array([impact_statistics(*scheme, 1.0, float(x)) for x in grid]).T
        curves[kind] = {"omega": short(grid)} | {part: short(row) for part, row in zip(PARTS, rows, strict=True)}
    return {"schemes": curves}


def exact_cases() -> tuple[tuple[str, str], ...]:
    """Return the cases whose exact motion is run too."""
    return tuple((case.name, "block-events") for case in finest())


def landing_data(case: Scene) -> Metrics:
    """Return w_c dt and the phase of a landing."""
    return {"omega": omega(case), "phase": phase(case)}


def springs(case: Scene, dda: Row) -> Metrics:
    """Return p/E, the switches over the exact ones, and the energy that the scheme itself has damped."""
    lost, given, switches = (
        or_nan(dda.metrics.get(name)) for name in ("energy.lost_algorithmic", "energy.given", "switches.count")
    )
    exact = 2.0 * EXACT_SWITCHES[ratio(case)]
    return {"p/E": ratio(case), "switches over exact": switches / exact, "lost": lost / given}


def own_landing(stiffness_ratio: float, _: Finished) -> Metrics:
    """Return the restitution of a square block of one strain, exact in time, by p/E."""
    return {"restitution": landing.own_landing(2 * stiffness_ratio).restitution}
