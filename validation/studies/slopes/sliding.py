"""The study `slopes`: trajectories on inclines against closed forms.

While every corner slips one way or is open, u_t + tan(phi) u_n of the centroid moves freely under
a_s = g (sin b - tan(phi) cos b), in any scheme and through bounces (`validation.theory.friction`). So the run-out, what
a discount takes of it and the slope at which a block begins to slide are known to rounding.
"""

from __future__ import annotations

import functools
import math
from collections.abc import Iterator, Mapping

import numpy as np

from validation.engine.finished import Derived, Finished, from_history
from validation.gates.gate import Gate
from validation.runs.history import History
from validation.runs.row import Value
from validation.scenes.scene import Scene
from validation.solvers.rigid.sliding import rigid_motion, rigid_slide
from validation.studies.bands import APART, LAGS, about, cases, gate
from validation.studies.declaration import Study
from validation.theory import friction
from validation.theory.statics import moduli, size

SLIDING = "slope-sliding"
AVERAGE = "slope-average"
DRAG = "slope-drag"
THRESHOLD = "slope-threshold"
MANUAL = "slope-manual"
SHAKEN = "slope-base"
QUAKE = "slope-quake"
QUAKE_EXACT = "slope-quake-exact"
IDENTITY = "sliding identity"
ROUNDED = 1e-10  # of the run-out: two formulations over 500 steps
SETTLED = 1e-4  # of the penalty offset, what still swings after a second of constant acceleration
RIGID = "sliding block"
# The shaking
CYCLES = 4
RATE = 2.0  # Hz
NEAR = 1e-4  # deg: the sliding acceleration is a straight line over 0.02 deg to (0.01 deg)^2 / 2


def derived() -> tuple[Derived, ...]:
    """Return the rows that are computed from finished cases."""
    inclines = cases(SLIDING, AVERAGE, DRAG, THRESHOLD, MANUAL)
    rows = [from_history(case, "dda", IDENTITY, _identity) for case in inclines]
    rows += [from_history(case, "dda", RIGID, _against_rigid) for case in cases(SHAKEN, QUAKE)]
    pair = tuple(cases(THRESHOLD))
    needs = tuple((case.name, "dda") for case in pair)
    return (*rows, Derived(THRESHOLD, "threshold", needs, functools.partial(_threshold, pair)))


def sliding(scene: Scene, history: History) -> np.ndarray:
    """Return u_t + tan(phi) u_n of the centroid [m]."""
    along = history.columns["horizontal_displacement"]
    across = history.displacement
    return np.asarray(along + friction.coefficient(scene) * across)


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


def _identity(scene: Scene, history: History) -> Mapping[str, Value]:
    if scene.name.startswith((THRESHOLD, MANUAL)):  # shear springs stick at first: only the rate is known
        return {"acceleration": acceleration(scene, history)}
    free, _ = friction.free_motion(scene, friction.sliding_acceleration(scene))
    difference = np.max(np.abs(sliding(scene, history) - free)) / friction.run_out(scene, scene.time.duration)
    offset = history.columns["horizontal_displacement"][-1] - free[-1]
    return {"largest difference": float(difference), "offset": float(offset)}


def _against_rigid(scene: Scene, history: History) -> Mapping[str, Value]:
    """Return the slide over the base at the end, and how far it ever is from that of a rigid mass [m]."""
    slide = (history.columns["slide_m"] + history.columns["slide_n"]) / 2
    rigid = rigid_slide(scene, smooth=scene.name.startswith(QUAKE)).slide
    return {"slide": float(slide[-1]), "largest difference": float(np.max(np.abs(slide - rigid)))}


def _threshold(pair: tuple[Scene, ...], finished: Finished) -> Mapping[str, Value]:
    """Return the slope at which the sliding acceleration of two cases passes through zero [deg]."""
    below, above = (acceleration(case, finished.needed_history(case.name, "dda")) for case in pair)
    low, high = (case.load.slope for case in pair)
    return {"angle": low - below * (high - low) / (above - below) if above > below else "undefined"}


def gates() -> tuple[Gate, ...]:
    """Return all gates of the study."""
    return (
        *identity_gates(),
        *offset_gates(),
        *drag_gates(),
        *threshold_gates(),
        *energy_gates(),
        *element_gates(),
        *shaken_gates(),
        *quake_gates(),
        *quake_exact_gates(),
    )


def identity_gates() -> Iterator[Gate]:
    """Yield the gates on the sliding identity."""
    why = "u_t + tan(phi) u_n is the free recursion under g (sin b - tan(phi) cos b); band: rounding over the steps"
    for case in cases(SLIDING, AVERAGE, DRAG):
        yield gate(case, IDENTITY, "largest difference", (0.0, ROUNDED), why)


def offset_gates() -> Iterator[Gate]:
    """Yield the gates on the way by which springs that give put a sliding block ahead."""
    why = "tan(phi) x settlement, m g cos b (1/(2p) + h/(4 E a)), whatever dt; band: what still swings"
    for case in cases(SLIDING, DRAG):
        offset = friction.penalty_offset(case)
        yield gate(case, IDENTITY, "offset", about(offset, SETTLED * offset), why)


def drag_gates() -> Iterator[Gate]:
    """Yield the gates on the way that a block slides under a discount."""
    why = "closed form of the discount as a drag, with the penalty offset; band: what still swings of the offset"
    for case in cases(DRAG):
        free_displacement, _ = friction.free_motion(case, friction.sliding_acceleration(case))
        offset = friction.penalty_offset(case)
        edges = about(float(free_displacement[-1]) + offset, SETTLED * offset)
        yield gate(case, "dda", "horizontal.final", edges, why)


def threshold_gates() -> Iterator[Gate]:
    """Yield the gates on the slope at which a block slides, and on the rates about it."""
    angle = friction.threshold_angle(next(cases(THRESHOLD)))
    why = "the angle of friction; band: the curvature of the acceleration over a hundredth of a degree"
    yield gate(THRESHOLD, "threshold", "angle", about(angle, NEAR), why)
    rate_reason = "g (sin b - tan(phi) cos b) once it slides; band: 1e-6 of gravity along the slope"
    for case in cases(THRESHOLD, MANUAL):
        if case.name.startswith(THRESHOLD) or (case.contact.friction or 0) < case.load.slope:
            edges = about(friction.sliding_acceleration(case), 1e-6 * friction.along(case))
            yield gate(case, IDENTITY, "acceleration", edges, rate_reason)
        else:
            stands_reason = (
                "its friction is above the slope, by a tenth of a degree at least: it stands; band: rounding"
            )
            yield gate(case, "dda", "contact.slip_rate", (0.0, 1e-9), stands_reason)


def energy_gates() -> Iterator[Gate]:
    """Yield the gates on the energy: friction takes what it says, and nothing is gained."""
    falls = "delta = 1: no opening, closing, sticking or slipping adds energy; band: rounding"
    closes = "the balance of stored and lost energy is an identity of the step; band: rounding over the steps"
    for case in cases(SLIDING, DRAG, AVERAGE):
        yield gate(case, "dda", "energy.imbalance", (0.0, 1e-10), closes)
        if case.time.delta == 1:
            yield gate(case, "dda", "energy.rise", (0.0, 1e-10), falls)
    for case in cases(SLIDING):
        normal_force = case.block.mass * friction.across(case)
        sliding_resistance = friction.coefficient(case) * normal_force + case.block.mass * friction.adhesion(case)
        lost = sliding_resistance * friction.run_out(case, case.time.duration)
        why = "tan(phi) m g cos b + c a times the distance; band: the oscillation of the normal force at first, 1e-3"
        yield gate(case, "dda", "energy.lost_friction", about(lost, 1e-3 * lost), why)


def element_gates() -> Iterator[Gate]:
    """Yield the gates of elements on the same slope."""
    for case in cases(SLIDING):
        late = 2 * size(case)[1] / math.sqrt(moduli(case)[0] / case.block.density) / case.time.duration
        why = (
            "one run-out for both: points of the base begin to slip while a wave travels up, 2 h / (c t) of the run-out"
        )
        yield gate(case, ("dda", "fem"), "horizontal.final", (-late, late), why)


def shaken_gates() -> Iterator[Gate]:
    """Yield the gates on a base that shakes, against Newmark's sliding block."""
    for case in cases(SHAKEN):
        resisted = friction.coefficient(case) * friction.across(case)
        stretch = case.block.mass * resisted / (2 * case.contact.shear)
        late = resisted * case.time.step / (2 * RATE)  # a phase that begins a step late, until the next one
        why = (
            "a rigid mass on the same record; band: shear springs that stretch and return twice a cycle, and one step "
            "in the instant at which half a cycle begins to slide"
        )
        allowed = 2 * CYCLES * stretch + late
        rigid = rigid_motion(case)
        ends = float(rigid.at([rigid.end])[0][0])
        yield gate(case, RIGID, "slide", about(ends, allowed), why)
        yield gate(case, RIGID, "largest difference", (APART, allowed), why)


def quake_gates() -> Iterator[Gate]:
    """Yield the gates on a base that follows a record of several frequencies, against Newmark's sliding block."""
    why = (
        "a rigid mass under the record's accelerations; band: a slide begins with up to the speed Y / w_s of a swing "
        "on the shear springs and up to a step late, Y dt, for as long as it lasts; Y / w_s^2 of stretch at both its "
        "ends"
    )
    for case in cases(QUAKE):
        rigid = rigid_motion(case, smooth=True)
        allowed = _late(case, rigid.switches)
        ends = float(rigid.at([rigid.end])[0][0])
        yield gate(case, RIGID, "slide", about(ends, allowed), why)
        yield gate(case, RIGID, "largest difference", (APART, allowed), why)


def _late(case: Scene, switches: tuple[tuple[float, int], ...]) -> float:
    """Return how far a block on shear springs may be from a rigid mass that slides between some switches [m]."""
    ends = [*(t for t, _ in switches[1:]), case.time.duration]
    durations = [end - t for (t, direction), end in zip(switches, ends, strict=True) if direction]
    resisted = friction.coefficient(case) * friction.across(case)
    shear_frequency = math.sqrt(2 * case.contact.shear / case.block.mass)
    late = math.fsum(durations) * (1 / shear_frequency + case.time.step)
    return resisted * (late + 2 * len(durations) / shear_frequency**2)


def quake_exact_gates() -> Iterator[Gate]:
    """Yield the gates on the same record against the exact motion of the block on its springs."""
    for case in cases(QUAKE_EXACT):
        for column in ("displacement", "horizontal"):
            yield gate(case, ("dda", "block-events"), f"{column}.l2", (APART, friction.lag(case)), LAGS)


STUDY = Study(
    name="slopes",
    title="Blocks that slide down inclines",
    purpose="A block on an incline slides by g (sin b - tan(phi) cos b), whatever its springs and steps, and stands up "
    "to the angle of friction. How far does each code, and each discount, let it run?",
    scenes=(SLIDING, AVERAGE, DRAG, THRESHOLD, MANUAL, SHAKEN, QUAKE, QUAKE_EXACT),
    gates=gates,
    derived=derived,
    pairs=(("dda", "fem"), ("dda", "block-events")),
)
