"""What friction, slope and a discount make of a block's displacement, and the alarms of blocks that slip.

Lagged friction lets a stable block creep the faster the finer the step: at 20 degrees under 30 by 0.8 mm in a second at
1 ms and by 6.1 mm at 0.2 ms, at 5 degrees hardly. That a step hides slip is not told where shear springs are as stiff
as normal ones and the slope is gentle: there the exact block stands as well.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass

from validation.advice.alarm import Alarm, alarm, first_row, number
from validation.advice.plain import PlainAnswer
from validation.advice.words import say
from validation.runs.row import RowsBySolver
from validation.runs.run import Outcome
from validation.scenes import features
from validation.scenes.scene import Scene
from validation.solvers.contract import Role
from validation.theory import friction
from validation.theory.stepping import Stepping

CREEPS = "creep of a stable block"
LAGS = "lagged friction"
HIDES = "slip hidden by the step"
STATELESS = "no contact state"
BRAKES = "drag on a sliding block"
KINDS = (CREEPS, LAGS, HIDES, STATELESS, BRAKES)
COHESION = ", cohesion acting at both corners"
SLOW = 0.01  # of g / w_n: a slower creep is not worth an alarm
STOPPING = 4.0  # times the time in which friction takes the speed g / w_n
COARSE = 0.3  # w_n dt from which on the ringing is not followed
NOTABLE = 0.01  # of the run-out, that a discount takes
STATES = (Outcome.NO_CONTACT_STATE, Outcome.SEVERAL_CONTACT_STATES)


@dataclass(frozen=True)
class Sliding(PlainAnswer):
    """What follows of a scene with friction before anything is run."""

    threshold: float  # slope at which it begins to slide [deg]
    acceleration: float  # g (sin b - tan(phi) cos b) - c a / m [m/s2]; negative where it stands
    run_out: float  # displacement of a sliding block over the scene's time [m]; zero where it stands
    braked: float  # the same with the scene's scheme and discount [m]
    offset: float  # by which the deflection of the springs puts it ahead [m]
    creep: float  # g / w_n, with which the creep of a stable block on ringing springs scales [m/s]
    shear_ratio: float  # of shear springs over normal ones, on which the factor depends
    rings_alike: bool  # whether they ring alike, and a block on this slope stands in spite of it
    rate: float | None  # -ln(gg) / dt [1/s]; None where gg = 0, which takes the whole velocity in every step
    constant: float  # dt / (1 - gg), terminal speed over acceleration [s]

    @property
    def stands(self) -> bool:
        """Whether the block is stable."""
        return self.acceleration <= 0

    @property
    def drag(self) -> str:
        """The drag of the discount in words."""
        return "takes the whole velocity" if self.rate is None else f"is a drag of {self.rate:.3g} 1/s"


def left_of_a_distance(gg: float, step: float) -> str:
    """Say what a discount leaves of the distance that is covered in a second."""
    return say("left of a distance", friction.distance_share(gg, step, 1.0))


def sliding(scene: Scene) -> Sliding | None:
    """Return what follows for a block with friction under its own weight, None for another one."""
    alone = scene.load.pressure == scene.load.traction == 0 and scene.load.base_motion is None
    if features.FRICTION not in features.of(scene) or scene.load.gravity <= 0 or not alone:
        return None
    acceleration = friction.sliding_acceleration(scene)
    displacements, _ = friction.free_motion(scene, max(acceleration, 0.0))
    is_soft = math.isfinite(scene.contact.stiffness)
    creep = friction.creep_scale(scene) if is_soft else 0.0
    rate = friction.drag_rate(scene) if scene.time.discount > 0 else None
    return Sliding(
        friction.threshold_angle(scene),
        acceleration,
        friction.run_out(scene, scene.time.duration),
        float(displacements[-1]),
        friction.penalty_offset(scene),
        creep,
        scene.contact.shear / scene.contact.stiffness if is_soft else 1.0,
        is_soft and friction.stands_on_ringing_springs(scene),
        rate,
        friction.time_constant(scene),
    )


def lines(scene: Scene, slides: Sliding) -> Iterator[str]:
    """Yield the lines on a block with friction."""
    slope = "slope below" if slides.stands else "slope above"
    yield say(slope, slides, slope=abs(scene.load.slope), both=COHESION if scene.contact.cohesion else "")
    words = {
        "time": scene.time,
        "creep": 1e3 * slides.creep,
        "w_dt": friction.normal_frequency(scene) * scene.time.step,
    }
    words |= {"fastest": slides.acceleration * slides.constant}
    if slides.stands:
        yield say("rings alike" if slides.rings_alike else "may creep", slides, **words)
        return
    yield say("slides", slides, **words)
    if scene.time.discount < 1:
        yield say("brakes", slides, **words)


def friction_alarms(scene: Scene, rows: RowsBySolver) -> Iterator[Alarm]:
    """Yield the alarms of the judged method's run of a scene with friction, by its finished rows."""
    row = first_row(rows, Role.JUDGED)
    if row is None or features.FRICTION not in features.of(scene):
        return
    t = scene.time
    if row.outcome in STATES:
        yield alarm(STATELESS, scene.name, outcome=row.outcome.value)
    if scene.contact.rules == "lagged":
        yield alarm(LAGS, scene.name)
    slides = None if scene.block.tilt else sliding(scene)  # a block that is let go on a corner does not stand
    if slides is None:
        return
    if not slides.stands:
        if t.discount < 1 and slides.braked < (1 - NOTABLE) * slides.run_out:
            rate = {} if slides.rate is None else {"rate": slides.rate}
            values = {**rate, "run_out": slides.run_out, "braked": slides.braked}
            yield alarm(BRAKES, scene.name, values, gg=t.discount, drag=slides.drag)
        return
    # slip that goes on after friction has had the time to stop a speed of g / w_n
    rate_of_slip = number(row, "contact.slip_rate") or 0.0
    stopped = STOPPING * slides.creep / -slides.acceleration if slides.acceleration < 0 else math.inf
    if rate_of_slip > SLOW * slides.creep > 0 and t.duration / 2 > stopped:
        values = {"rate": rate_of_slip, "scale": slides.creep}
        words = {"slope": abs(scene.load.slope), "speed": 1e3 * rate_of_slip, "share": rate_of_slip / slides.creep}
        yield alarm(CREEPS, scene.name, values, slides=slides, **words)
    # a slope that stands because its ringing is not followed
    phase = friction.normal_frequency(scene) * t.step
    is_hidden = phase > COARSE and slides.creep > 0 and not slides.rings_alike
    if scene.load.slope and is_hidden and (Stepping.of(scene).damps or t.discount < 1):
        values = {"phase": phase, "scale": slides.creep, "ratio": slides.shear_ratio}
        yield alarm(HIDES, scene.name, values, period=2 * math.pi * t.step / phase, speed=1e3 * slides.creep)
