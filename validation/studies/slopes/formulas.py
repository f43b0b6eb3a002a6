"""The study `slopes`: trajectories on inclines against closed forms.

While every corner slips one way or is open, u_t + tan(phi) u_n of the centroid moves freely under
a_s = g (sin b - tan(phi) cos b), in any scheme and, without cohesion, through bounces (`validation.theory.friction`).
So the run-out, what a discount takes of it and the slope at which a block begins to slide are known to rounding.
"""

from __future__ import annotations

import itertools
import math
from collections.abc import Mapping
from typing import Any

import numpy as np

from validation.metrics.values import or_nan
from validation.runs.history import History
from validation.runs.row import Metrics, Row
from validation.scenes.scene import Scene
from validation.solvers.rigid.sliding import rigid_motion, rigid_slide
from validation.studies.slopes import closed as closed_forms
from validation.suite.bands import APART, Band, Bands, Runs, about, cases, near, short
from validation.theory import friction
from validation.theory.statics import moduli, size
from validation.theory.stepping import Stepping

SLIDING = "slope-sliding"
AVERAGE = "slope-average"
DRAG = "slope-drag"
THRESHOLD = "slope-threshold"
MANUAL = "slope-manual"
SHAKEN = "slope-base"
QUAKE = "slope-quake"
STIFFNESS = "slope-stiffness"
FACT_STEPS = (1e-4, 1e-3, 5e-3, 1e-2)  # s
RINGS_FROM = 0.05  # s: what the block rings is seen beside a way of some millimetres
RINGING = 1e-3  # of the error by ringing: the own vibration of a block whose strain follows at rest
SETTLED = 1e-4  # of the penalty offset, what still swings after a second of constant acceleration
RIGID = "sliding block"
# The shaking
STANDS = 1e-9  # m/s of slip, below which a block stands
CYCLES = 4
RATE = 2.0  # Hz


def sliding(scene: Scene, history: History) -> np.ndarray:
    """Return u_t + tan(phi) u_n of the centroid [m]."""
    along = history.columns["horizontal_displacement"]
    return along + friction.coefficient(scene) * history.displacement


def acceleration(scene: Scene, history: History) -> float:
    """Return the acceleration of u_t + tan(phi) u_n over the second half of a run [m/s2].

    The scheme of constant acceleration keeps D = D0 + V0 t + a t^2 / 2 at any three instants.
    """
    z = sliding(scene, history)
    n = len(history.time)
    quarter = n // 4
    middle = n - 1 - quarter
    gained = z[n - 1] - 2 * z[middle] + z[middle - quarter]
    return float(gained / (quarter * scene.time.step) ** 2)


def identity(scene: Scene, history: History) -> Metrics:
    """Return the residual of the sliding identity, and the block's lead [m]."""
    if scene.name.startswith((THRESHOLD, MANUAL)):  # shear springs stick at first: only the rate is known
        return {"acceleration": acceleration(scene, history)}
    free, _ = friction.free_motion(scene, friction.sliding_acceleration(scene))
    difference = np.max(np.abs(sliding(scene, history) - free)) / friction.run_out(scene, scene.time.duration)
    offset = history.columns["horizontal_displacement"][-1] - free[-1]
    return {"largest difference": float(difference), "offset": float(offset)}


def ringing(scene: Scene, history: History) -> Metrics:
    """Return the largest error of a sliding block over its exact way, from a start."""
    way = friction.sliding_acceleration(scene) * history.time**2 / 2
    late = history.time >= RINGS_FROM - closed_forms.TOLERANCE
    return {"error": np.max(np.abs(history.columns["horizontal_displacement"] / way - 1)[late])}


def rigid_ringing() -> Metrics:
    """Return the error of a rigid block that slides and stays closed, over penalty and step."""
    scene = next(iter(cases(STIFFNESS)))
    numbers = {}
    for p, step in itertools.product((1e8, 1e9), FACT_STEPS):
        numbers[f"p = {p:g}, dt = {1e3 * step:g} ms"] = closed_forms.normal_ringing_error(scene, p, step)
    return numbers


def late_friction() -> Metrics:
    """Return the error after a second of a sliding block whose friction is that of the step before."""
    scene = next(iter(cases(STIFFNESS)))
    return {f"dt = {1e3 * step:g} ms": closed_forms.lagging_friction_error(scene, step, 1.0) for step in FACT_STEPS}


def discounted() -> Metrics:
    """Return what gg = 0.98 a step is: a rate, damping ratios, and the way kept by a shaken block."""
    gg = 0.98
    numbers = {"frequency of 2 % times dt": -math.log(gg) / (2 * 0.02) / (2 * math.pi)}
    for step in (1e-2, 5e-3, 2.5e-3, 1e-3):
        numbers[f"rate at dt = {1e3 * step:g} ms, 1/s"] = -math.log(gg) / step
    for step in (1e-2, 2.5e-3):
        for hertz in (1.0, 5.0, 10.0):
            ratio = Stepping(step, 0.25, 0.5, gg=gg).damping_ratio(2 * math.pi * hertz * step)
            numbers[f"xi at {hertz:g} Hz, dt = {1e3 * step:g} ms"] = ratio
    exact = closed_forms.shaken_way(closed_forms.FINE, 1.0)
    for step in (1e-2, 5e-3, 2.5e-3, 1e-3, 1e-4):
        numbers[f"way kept at dt = {1e3 * step:g} ms"] = closed_forms.shaken_way(step, gg) / exact
    return numbers | {"way without a discount at dt = 10 ms": closed_forms.shaken_way(1e-2, 1.0) / exact}


def against_rigid(scene: Scene, history: History) -> Metrics:
    """Return the slide over the base at the end, and its greatest distance from a rigid mass's [m]."""
    slide = (history.columns["slide_m"] + history.columns["slide_n"]) / 2
    rigid = rigid_slide(scene, smooth=scene.name.startswith(QUAKE)).slide
    return {"slide": slide[-1], "largest difference": np.max(np.abs(slide - rigid))}


def threshold(runs: Runs) -> Metrics:
    """Return the slope at which the sliding acceleration of two cases is zero [deg]."""
    below, above = itertools.starmap(acceleration, runs)
    low, high = (case.load.slope for case, _ in runs)
    return {"angle": low - below * (high - low) / (above - below) if above > below else "undefined"}


def offset(case: Scene) -> Band:
    """Return by how much springs that give put a sliding block ahead [m]."""
    return near(friction.penalty_offset(case), SETTLED)


def dragged(case: Scene) -> Band:
    """Return the way that a block slides under a discount [m]."""
    free_displacement, _ = friction.free_motion(case, friction.sliding_acceleration(case))
    ahead = friction.penalty_offset(case)
    return about(float(free_displacement[-1]) + ahead, SETTLED * ahead)


def sliding_rate(case: Scene) -> Band:
    """Return the acceleration of a block that slides [m/s2]."""
    return about(friction.sliding_acceleration(case), 1e-6 * friction.along(case))


def ringing_way(case: Scene) -> Band:
    """Return the error by ringing on stiff springs; its own strain settles with them, p h / (2 E a) more."""
    width, height = size(case)
    modulus, _ = moduli(case)
    own_strain = case.contact.stiffness * height / (2 * modulus * width)
    rigid = closed_forms.normal_ringing_error(case, case.contact.stiffness, case.time.step)
    return near(rigid * (1 + own_strain), RINGING)


def lost_energy(case: Scene) -> Band:
    """Return what friction and cohesion take over the run-out [J]."""
    normal_force = case.block.mass * friction.across(case)
    sliding_resistance = friction.coefficient(case) * normal_force + case.block.mass * friction.adhesion(case)
    return near(sliding_resistance * friction.run_out(case, case.time.duration), 1e-3)


def late_waves(case: Scene) -> Band:
    """Return by how much points of a base that slip late change the run-out."""
    return about(0.0, 2 * size(case)[1] / math.sqrt(moduli(case)[0] / case.block.density) / case.time.duration)


def shaken(case: Scene) -> Bands:
    """Return the slide on a base that shakes, and its distance from a rigid mass's [m]."""
    resisted = friction.coefficient(case) * friction.across(case)
    stretch = case.block.mass * resisted / (2 * case.contact.shear)
    late = resisted * case.time.step / (2 * RATE)  # a phase that begins a step late, until the next one
    rigid = rigid_motion(case)
    return _beside(rigid.at([rigid.end])[0][0], 2 * CYCLES * stretch + late)


def in_an_earthquake(case: Scene) -> Bands:
    """Return the same on a base that follows a record of several frequencies [m]."""
    rigid = rigid_motion(case, smooth=True)
    ends = [*(t for t, _ in rigid.switches[1:]), case.time.duration]
    durations = [end - t for (t, direction), end in zip(rigid.switches, ends, strict=True) if direction]
    resisted = friction.coefficient(case) * friction.across(case)
    shear_frequency = math.sqrt(2 * case.contact.shear / case.block.mass)
    late = math.fsum(durations) * (1 / shear_frequency + case.time.step)
    return _beside(rigid.at([rigid.end])[0][0], resisted * (late + 2 * len(durations) / shear_frequency**2))


def lag(case: Scene) -> Band:
    """Return how far DDA lags behind the exact block."""
    return APART, friction.lag(case)


def _beside(slide: float, allowed: float) -> Bands:
    return {"slide": about(float(slide), allowed), "largest difference": (APART, allowed)}


def closed(case: Scene) -> Metrics:
    """Return the drag [1/s], the acceleration [m/s2] and the displacement at the end [m] in closed form."""
    acceleration = friction.sliding_acceleration(case)
    displacement, _ = friction.free_motion(case, acceleration)
    return {"drag": abs(friction.drag_rate(case)), "acceleration": acceleration, "free": displacement[-1]}


def beside_closed(case: Scene, dda: Row) -> Metrics:
    """Return how far a run is beyond the closed form [m], and its displacement over that without drag."""
    final = or_nan(dda.metrics.get("horizontal.final"))
    displacement, _ = friction.free_motion(case, friction.sliding_acceleration(case))
    return {"ahead": final - float(displacement[-1]), "share": final / friction.run_out(case, case.time.duration)}


def start(case: Scene, dda: Row) -> Metrics:
    """Return the slip a second [m/s], and that a block stands whose corners do not slip."""
    slip_rate = or_nan(dda.metrics.get("contact.slip_rate"))
    if friction.sliding_acceleration(case) < 0 and slip_rate < STANDS:
        return {"state": "stands", "slip": 0.0}
    return {"slip": slip_rate}


def beside_rigid(case: Scene) -> Metrics:
    """Return the slide of a rigid mass, and by how much a block may differ from it [m]."""
    low, high = (in_an_earthquake if case.name.startswith(QUAKE) else shaken)(case)["slide"]
    return {"slide": (low + high) / 2, "allowed": (high - low) / 2}


def data() -> Mapping[str, Any]:
    """Return closed forms to draw: displacements over time, and what a drag leaves after a second."""
    free = []
    *_, without_drag = cases(SLIDING)
    for case in (without_drag, *cases(DRAG)):
        displacement, _ = friction.free_motion(case, friction.sliding_acceleration(case))
        instants = np.unique(np.linspace(0, case.time.steps - 1, 200).round().astype(int))
        free.append({"time": short((instants + 1) * case.time.step), "distance": short(displacement[instants])})
    x = np.geomspace(0.1, 100.0, 61)  # of a drag, 1/s times a second
    return {"free": free, "drag": {"rate": short(x), "share": short(2 * (x + np.expm1(-x)) / x**2)}}
