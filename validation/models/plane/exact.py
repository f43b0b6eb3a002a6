"""The exact motion of rigid boxes on a ground, where it is known; every other scene of the plane is refused by name."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from functools import partial
from time import perf_counter

import numpy as np
from scipy.integrate import solve_ivp

from validation.models.plane.boxes import LANDS_BY, Box, BoxesOnGround, boxes_of
from validation.models.plane.history import POSE
from validation.runs.history import Array, History
from validation.runs.run import Outcome, Run
from validation.scenes import features
from validation.scenes.scene import Scene
from validation.solvers.contract import LineStyle, Prepared, Role, Solver
from validation.solvers.rigid.rocking import friction_needed
from validation.theory.boxes import ShakenBox, SpringImpact, critical_spin, greatest_rotation, return_time
from validation.theory.rocking import Rectangle

AT_REST = 1e-12  # of the speed of the first landing: what is slower bounces no more
ROLLS = 1e-6  # relative: a velocity that is that of a rotation about the corner, in the digits of a file
ACCURACY = 1e-12  # relative tolerance of the integration
ROUNDING = 16 * float(np.finfo(float).eps)  # part of the lengths in it by which a height of a corner may be wrong
MOST_IMPACTS = 100_000


Motion = Callable[[Array], Mapping[str, Array]]  # the columns of boxes at some instants [s]


class RigidExact(Solver):
    """Exact motions of rigid boxes, with Coulomb's friction and Newton's restitution."""

    name = "rigid-exact"
    handles = features.SCHEMES | {features.PLANE, features.MOVING_BLOCKS}
    sources = ("validation.theory.boxes", "validation.theory.rocking", "fem_reference.exact.rocking")
    role = Role.TRUTH
    rank = 3.0
    line = LineStyle("#000000", (1.0, 1.0))

    def applicable(self, scene: Scene) -> str | None:
        """Return None, or why the motion is not known."""
        motion = motion_of(scene)
        return motion if isinstance(motion, str) else None

    def build(self, scene: Scene, full: bool) -> Prepared:
        """Take the scene."""
        return ExactBoxes(scene)


class ExactBoxes(Prepared):
    """Rigid boxes whose motion is known."""

    def __init__(self, scene: Scene) -> None:
        self.scene = scene

    def history_run(self) -> Run:
        """Return the motion at the scene's steps."""
        scene = self.scene
        start = perf_counter()
        motion = motion_of(scene)
        if isinstance(motion, str):
            return Run(Outcome.NOT_APPLICABLE, notes=(motion,))
        time = scene.time.step * np.arange(1.0, scene.time.steps + 1)
        try:
            columns = motion(time)
        except TumblingHorizonError as error:
            steps = math.floor(error.time / scene.time.step)
            return Run(Outcome.HORIZON, notes=(f"{error}; the scene may have {steps} steps",))
        history = History(time, {name: np.asarray(columns[name], float) for name in scene.run.columns})
        seconds = {"setup": 0.0, "stepping": perf_counter() - start}
        return Run(Outcome.COMPLETED, history, {"steps": scene.time.steps}, seconds)


def motion_of(scene: Scene) -> Motion | str:
    """Return the motion of a scene of boxes on a ground, or why none is known."""
    try:
        ground = boxes_of(scene)
    except ValueError as error:
        return str(error)
    if others := [name for name in scene.run.columns if name not in ground.columns]:
        return f"it has positions, angles and the normal forces below boxes, {ground.force_columns[0]}, not {others[0]}"
    box = ground.boxes[0]
    if len(ground.boxes) > 1:
        return _why_pile_moves(ground) or partial(_pile, ground)
    if ground.base_amplitude:
        return _why_not_shaken(ground) or partial(_shaken, ground)
    if ground.stiffness is not None:
        return _why_not_on_spring(ground) or partial(_on_spring, ground)
    if box.angle == 0 and box.spin == 0:
        if box.lift == 0 and box.velocity[1] == 0:
            return _why_tips(ground) or partial(_on_plane, ground)
        return _why_not_flat(ground) or partial(_bouncing, ground)
    if box.angle == 0 and box.lift == 0 and not _turns_off(ground, box):
        return _why_not_about_corner(scene, ground) or partial(_about_corner, ground)
    if ground.friction == 0 and ground.restitution == 1:
        return _why_not_tumbling(ground) or partial(_tumbling, ground)
    return (
        "the motion is not known of a box that turns, apart from turning about the corner on which it stands at t = 0, "
        "and from tumbling with friction = 0 and restitution = 1"
    )


# ---- at rest --------------------------------------------------------------------------------------------------------


def _why_pile_moves(ground: BoxesOnGround) -> str | None:
    if any(box.lift or box.spin or any(box.velocity) for box in ground.boxes):
        return "the motion is not known of several boxes that move at t = 0 or do not touch"
    if ground.base_amplitude or ground.stiffness is not None:
        return "the motion is not known of several boxes on moving ground, or on contact of given stiffness"
    if ground.slope and abs(ground.slope) >= ground.friction:
        return "the motion is not known of several boxes that slide"
    for lowest in range(len(ground.boxes)):
        if not _is_supported(ground, lowest):
            return f"the motion is not known of boxes that overturn, and those from number {lowest + 1} up do"
    return None


def _is_supported(ground: BoxesOnGround, lowest: int) -> bool:
    """Whether the resultant weight of all boxes from one up meets what that box stands on."""
    above = ground.boxes[lowest:]
    foot = above[0].y - above[0].reach
    mass = sum(box.mass for box in above)
    x = sum(box.mass * box.x for box in above) / mass
    height = sum(box.mass * (box.y - foot) for box in above) / mass
    meets = x + height * math.tan(math.radians(ground.slope))
    low = above[0].x - above[0].width / 2
    high = above[0].x + above[0].width / 2
    if lowest:
        below = ground.boxes[lowest - 1]
        low = max(low, below.x - below.width / 2)
        high = min(high, below.x + below.width / 2)
    return low < meets < high


def _pile(ground: BoxesOnGround, time: Array) -> dict[str, Array]:
    columns: dict[str, Array] = {}
    for number, (box, force_column) in enumerate(zip(ground.boxes, ground.force_columns, strict=True)):
        for part, value in zip(POSE, (box.x, box.y, box.angle), strict=True):
            columns[f"{box.name}.{part}"] = np.full(len(time), value)
        weight = -ground.pull[1] * sum(above.mass for above in ground.boxes[number:])
        columns[force_column] = np.full(len(time), weight)
    return columns


def _poses(ground: BoxesOnGround, time: Array, force: Array | None = None, **moved: Array) -> dict[str, Array]:
    """Return the columns of a box alone: those that are given, the others as they are at t = 0."""
    box = ground.boxes[0]
    still = dict.fromkeys(ground.columns, 0.0) | {f"{box.name}.{part}": getattr(box, part) for part in POSE}
    changed = {f"{box.name}.{part}": values for part, values in moved.items()}
    columns = {name: np.full(len(time), value) for name, value in still.items()} | changed
    return columns if force is None else columns | {ground.force_columns[0]: force}


# ---- on the plane ---------------------------------------------------------------------------------------------------


def _why_tips(ground: BoxesOnGround) -> str | None:
    box = ground.boxes[0]
    slides = box.velocity[0] != 0 or abs(ground.slope) > ground.friction
    needed_friction = ground.friction_coefficient if slides else abs(math.tan(math.radians(ground.slope)))
    if needed_friction >= box.width / box.height:
        return "the motion is not known of a box that friction overturns: tan(phi) must be below width / height"
    return None


def _on_plane(ground: BoxesOnGround, time: Array) -> dict[str, Array]:
    """Stand, slide until friction stops it, or slide on."""
    box = ground.boxes[0]
    along, across = ground.pull
    grip = ground.friction_coefficient * -across
    velocity = box.velocity[0]
    moved = np.zeros(len(time))
    stop = 0.0
    if velocity:
        slowing = along - math.copysign(grip, velocity)
        stops = velocity * slowing < 0
        stop = -velocity / slowing if stops else math.inf
        sliding = np.minimum(time, stop)
        moved = velocity * sliding + slowing * sliding**2 / 2
    excess = max(0.0, abs(along) - grip)
    if excess and not math.isinf(stop):  # from rest down the slope, also after it has come to rest
        moved = moved + math.copysign(excess, along) * np.maximum(0.0, time - stop) ** 2 / 2
    force = np.full(len(time), -box.mass * across)
    return _poses(ground, time, x=box.x + moved, force=force)


# ---- flights --------------------------------------------------------------------------------------------------------


def _why_not_flat(ground: BoxesOnGround) -> str | None:
    box = ground.boxes[0]
    if ground.restitution is None:
        return LANDS_BY
    if ground.friction and (ground.slope or box.velocity[0]):
        return "the motion is not known of a box that lands with friction while it moves along the ground"
    return None


def _bouncing(ground: BoxesOnGround, time: Array) -> dict[str, Array]:
    box = ground.boxes[0]
    along, across = ground.pull
    flights = _flights(box.lift, box.velocity[1], -across, ground.rebound, float(time[-1]))
    index = np.searchsorted([flight[0] for flight in flights], time, side="right") - 1
    start, lift, velocity = np.array(flights)[index].T
    since = time - start
    resting = (lift == 0) & (velocity == 0)
    height = np.where(resting, 0.0, lift + velocity * since + across * since**2 / 2)
    force = np.where(resting, -box.mass * across, 0.0)
    x = box.x + box.velocity[0] * time + along * time**2 / 2
    return _poses(ground, time, x=x, y=box.reach + height, force=force)


def _flights(
    lift: float, velocity: float, gravity: float, restitution: float, duration: float
) -> list[tuple[float, float, float]]:
    """Return the flights of a body above the ground: first instant [s], height [m] and velocity upwards [m/s] then.

    The last one may be rest on the ground, with neither.
    """
    flights = [(0.0, lift, velocity)]
    first_landing: float | None = None
    while True:
        start, height, speed = flights[-1]
        landing = math.sqrt(speed**2 + 2 * gravity * height)
        if speed <= 0 and height == 0 and landing == 0:
            return flights
        if gravity == 0:
            lasted = height / -speed if speed < 0 else math.inf
        elif speed > 0:
            lasted = (speed + landing) / gravity
        else:  # without the difference of two nearly equal speeds
            lasted = 2 * height / (landing - speed)
        if start + lasted >= duration:
            return flights
        first_landing = landing if first_landing is None else first_landing
        rebound = restitution * landing
        flights.append((start + lasted, 0.0, rebound if rebound > AT_REST * first_landing else 0.0))


# ---- on a spring ----------------------------------------------------------------------------------------------------


def _why_not_on_spring(ground: BoxesOnGround) -> str | None:
    box = ground.boxes[0]
    if box.angle or box.spin:
        return "the motion is not known of a box that turns on contact of given stiffness"
    if ground.restitution != 1:
        return "on contact of given stiffness the motion is known with restitution = 1: what loses energy has many laws"
    if ground.gravity == 0 or box.velocity[1] > 0:
        return "the motion is not known on contact of given stiffness without weight, or upwards from t = 0 on"
    return _why_not_flat(ground)


def _on_spring(ground: BoxesOnGround, time: Array) -> dict[str, Array]:
    box = ground.boxes[0]
    stiffness = ground.stiffness or math.inf
    along, across = ground.pull
    gravity = -across
    speed = math.sqrt(box.velocity[1] ** 2 + 2 * gravity * box.lift)
    landing = SpringImpact(box.mass, stiffness, gravity, speed)
    first = (speed + box.velocity[1]) / gravity
    flight = 2 * speed / gravity
    # from the first landing on contact and flight follow each other
    since = time - first
    cycle = np.mod(since, landing.duration + flight)
    pressed = (since >= 0) & (cycle < landing.duration)
    aloft = np.where(since < 0, since, cycle - landing.duration)
    rising = np.where(since < 0, -speed, speed)
    height = np.where(pressed, -landing.sinking(cycle), rising * aloft - gravity * aloft**2 / 2)
    force = np.where(pressed, -stiffness * height, 0.0)
    x = box.x + box.velocity[0] * time + along * time**2 / 2
    return _poses(ground, time, x=x, y=box.reach + height, force=force)


# ---- on moving ground -----------------------------------------------------------------------------------------------


def _why_not_shaken(ground: BoxesOnGround) -> str | None:
    box = ground.boxes[0]
    if ground.slope or ground.gravity == 0 or ground.stiffness is not None or box.angle or box.spin:
        return "on moving ground the motion is known of a box that lies flat on level, rigid ground"
    if box.lift or any(box.velocity):
        return "on moving ground the motion is known of a box at rest on it at t = 0"
    peak = abs(ground.base_amplitude) * (2 * math.pi * ground.base_frequency) ** 2
    if min(ground.friction_coefficient, peak / ground.gravity) >= box.width / box.height:
        return "the motion is not known of a box that friction overturns: tan(phi) must be below width / height"
    return None


def _shaken(ground: BoxesOnGround, time: Array) -> dict[str, Array]:
    box = ground.boxes[0]
    force = np.full(len(time), box.mass * ground.gravity)
    if ground.friction == 0:
        return _poses(ground, time, force=force)
    motion = ShakenBox(ground.base_amplitude, ground.base_frequency, ground.friction_coefficient, ground.gravity)
    return _poses(ground, time, x=box.x + motion.displacement(time), force=force)


# ---- about a corner -------------------------------------------------------------------------------------------------


def _turns_off(ground: BoxesOnGround, box: Box) -> bool:
    """Whether the velocity at t = 0 is another one than that of a rotation about a lower corner."""
    across = -box.spin * box.height / 2
    upwards = abs(box.spin) * box.width / 2
    allowed = ROLLS * abs(box.spin) * math.hypot(box.width, box.height)
    return abs(box.velocity[0] - across) > allowed or abs(box.velocity[1] - upwards) > allowed


def _why_not_about_corner(scene: Scene, ground: BoxesOnGround) -> str | None:
    box = ground.boxes[0]
    if ground.slope or ground.gravity == 0:
        return "the motion about a corner is known on level ground, under weight"
    rectangle = Rectangle(box.width, box.height, ground.gravity)
    if abs(box.spin) >= critical_spin(rectangle):
        return "the motion is not known of a box that overturns, beyond the impact at its end"
    end = return_time(rectangle, abs(box.spin))
    if scene.time.duration >= end:
        return f"the motion about a corner is known until the box comes back after {end:.4g} s"
    needed_friction = friction_needed(box.width, box.height, greatest_rotation(rectangle, abs(box.spin)))
    if ground.friction_coefficient <= needed_friction:
        return f"the corner slips: friction must be above {math.degrees(math.atan(needed_friction)):.4g} deg"
    return None


def _about_corner(ground: BoxesOnGround, time: Array) -> dict[str, Array]:
    """Integrate psi'' = P^2 sin(psi), psi the angle of the centre beyond the vertical through the corner."""
    box = ground.boxes[0]
    rectangle = Rectangle(box.width, box.height, ground.gravity)
    radius = math.hypot(box.width, box.height) / 2
    sign = math.copysign(1.0, box.spin)

    def rates(_: float, state: Array) -> list[float]:
        return [state[1], rectangle.rate2 * math.sin(state[0])]

    start = [-rectangle.alpha, abs(box.spin)]
    solution = solve_ivp(
        rates, (0.0, float(time[-1])), start, method="DOP853", t_eval=time, rtol=ACCURACY, atol=ACCURACY
    )
    psi, rate = solution.y
    # from the left corner, about which a positive rotation turns; to the right all is mirrored
    x = -radius * np.sin(psi)
    y = radius * np.cos(psi)
    falling = -radius * (np.cos(psi) * rate**2 + np.sin(psi) * rectangle.rate2 * np.sin(psi))
    force = box.mass * (ground.gravity + falling)
    centre = box.x + sign * (x - box.width / 2)
    return _poses(ground, time, x=centre, y=y, angle=sign * (psi + rectangle.alpha), force=force)


# ---- tumbling -------------------------------------------------------------------------------------------------------


class TumblingHorizonError(ArithmeticError):
    """A box does not go on from impact to impact of one corner."""

    def __init__(self, time: float, reason: str) -> None:
        super().__init__(f"exact up to {time:.6g} s only: {reason}")
        self.time = time  # the horizon [s]
        self.reason = reason


def _why_not_tumbling(ground: BoxesOnGround) -> str | None:
    try:
        _start_of_tumbling(ground).next_impact(0.0)
    except TumblingHorizonError as error:
        return f"the motion is not known of a box that at t = 0 does this: {error.reason}"
    return None


def _tumbling(ground: BoxesOnGround, time: Array) -> dict[str, Array]:
    """From impact to impact of a corner, without friction or loss.

    Raises
    ------
    TumblingHorizonError
        If the box does not go on from impact to impact, or these are more than `MOST_IMPACTS`.
    """
    box = ground.boxes[0]
    along, across = ground.pull
    flight = _start_of_tumbling(ground)
    heights = np.empty(len(time))
    angles = np.empty(len(time))
    written = 0
    for _ in range(MOST_IMPACTS):
        impact = flight.next_impact(float(time[-1]))
        until = len(time) if impact is None else int(np.searchsorted(time, impact[0], side="right"))
        since = time[written:until] - flight.start
        heights[written:until] = flight.y + flight.velocity * since + across * since**2 / 2
        angles[written:until] = flight.angle + flight.spin * since
        written = until
        if impact is None:
            x = box.x + box.velocity[0] * time + along * time**2 / 2
            return _poses(ground, time, x=x, y=heights, angle=angles)
        flight = flight.after(*impact)
    raise TumblingHorizonError(flight.start, f"more than {MOST_IMPACTS} impacts")


def _start_of_tumbling(ground: BoxesOnGround) -> _CornerFlight:
    box = ground.boxes[0]
    corners = tuple((sx * box.width / 2, sy * box.height / 2) for sx in (-1, 1) for sy in (-1, 1))
    return _CornerFlight(
        corners=corners,
        inverse_mass=1 / box.mass,
        inverse_inertia=1 / box.inertia,
        gravity=ground.pull[1],
        start=0.0,
        y=box.y,
        angle=box.angle,
        velocity=box.velocity[1],
        spin=box.spin,
    )


@dataclass(frozen=True)
class _CornerFlight:
    """A free flight of a box that turns, above frictionless ground that gives all energy back."""

    corners: tuple[tuple[float, float], ...]  # about the centre [m]
    inverse_mass: float  # [1/kg]
    inverse_inertia: float  # [1/(kg m2)]
    gravity: float  # negative downwards [m/s2]
    start: float  # instant at which it begins [s]
    y: float  # of the centre then [m]
    angle: float  # [rad]
    velocity: float  # of the centre upwards [m/s]
    spin: float  # [rad/s]

    def arm(self, corner: int, elapsed: float) -> float:
        """Return how far a corner is from the centre along the ground [m]."""
        x, y = self.corners[corner]
        angle = self.angle + self.spin * elapsed
        return x * math.cos(angle) - y * math.sin(angle)

    def height(self, corner: int, elapsed: float) -> float:
        """Return the height of a corner above the ground [m]."""
        x, y = self.corners[corner]
        angle = self.angle + self.spin * elapsed
        centre = self.y + self.velocity * elapsed + self.gravity * elapsed**2 / 2
        return centre + x * math.sin(angle) + y * math.cos(angle)

    def rate(self, corner: int, elapsed: float) -> float:
        """Return the velocity of a corner upwards [m/s]."""
        return self.velocity + self.gravity * elapsed + self.spin * self.arm(corner, elapsed)

    def acceleration(self, corner: int, elapsed: float) -> float:
        """Return the acceleration of a corner upwards [m/s2]."""
        centre = self.y + self.velocity * elapsed + self.gravity * elapsed**2 / 2
        return self.gravity - self.spin**2 * (self.height(corner, elapsed) - centre)

    def next_impact(self, end: float) -> tuple[float, int] | None:
        """Return when a corner comes down first [s], and which; None where none does before an instant.

        Raises
        ------
        TumblingHorizonError
            If a corner comes to press on the ground without an impact, or two come down at once.
        """
        landings: list[tuple[float, int]] = []
        pressing = math.inf
        for corner in range(len(self.corners)):
            elapsed, presses = self._comes_down(corner, end - self.start)
            if elapsed is None:
                continue
            if presses:
                pressing = min(pressing, elapsed)
            else:
                landings.append((self.start + elapsed, corner))
        first = min(landings, default=(math.inf, 0))
        if math.isfinite(pressing) and self.start + pressing <= first[0]:
            reason = "a corner presses on the ground without an impact, and slides on it"
            raise TumblingHorizonError(self.start + pressing, reason)
        if len(landings) > 1 and sorted(landings)[1][0] == first[0]:
            raise TumblingHorizonError(
                first[0], "two corners come down at once, and the first one decides what follows"
            )
        return first if landings else None

    def _comes_down(self, corner: int, duration: float) -> tuple[float | None, bool]:
        """Return when a corner is on the ground and does not rise, within a duration, and whether it presses on it.

        No step passes a landing: with K a bound of the acceleration the height s later is at least
        h + h' s - K s^2 / 2, and with K' one of its rate at least a s^2 / 2 - K' s^3 / 6 where h = h' = 0.
        """
        size = max(math.hypot(*place) for place in self.corners)
        bound = abs(self.gravity) + size * self.spin**2
        bound_of_rate = size * abs(self.spin) ** 3
        elapsed = 0.0
        while elapsed <= duration:
            height = self.height(corner, elapsed)
            rate = self.rate(corner, elapsed)
            # what rounding leaves of a height, and the rate with which one falls through so little
            extent = size + abs(self.y) + abs(self.velocity) * elapsed - self.gravity * elapsed**2
            nothing = ROUNDING * (extent + abs(rate) * self.start)
            slow = math.sqrt(2 * bound * nothing)
            if height > nothing:
                root = math.sqrt(rate**2 + 2 * bound * height)
                if bound == 0 and rate >= 0:
                    return None, False
                elapsed += 2 * height / (root - rate) if rate < 0 else (rate + root) / bound
            elif rate < -slow:
                return elapsed, False
            elif rate > slow:
                elapsed += rate / bound if bound else math.inf
            else:
                acceleration = self.acceleration(corner, elapsed)
                if acceleration < 0 or (acceleration == 0 and bound > 0):
                    return elapsed, True
                if bound_of_rate == 0:
                    return None, False
                elapsed += acceleration / bound_of_rate
        return None, False

    def after(self, time: float, corner: int) -> _CornerFlight:
        """Return the flight after the impact of a corner at an instant [s]."""
        elapsed = time - self.start
        arm = self.arm(corner, elapsed)
        impulse = -2 * self.rate(corner, elapsed) / (self.inverse_mass + arm**2 * self.inverse_inertia)
        return replace(
            self,
            start=time,
            y=self.y + self.velocity * elapsed + self.gravity * elapsed**2 / 2,
            angle=self.angle + self.spin * elapsed,
            velocity=self.velocity + self.gravity * elapsed + impulse * self.inverse_mass,
            spin=self.spin + impulse * arm * self.inverse_inertia,
        )
