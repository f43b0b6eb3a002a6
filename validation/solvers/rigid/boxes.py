"""The exact motion of rigid boxes, where it is known; every other scene of them is refused by name."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from functools import partial
from time import perf_counter

import numpy as np
from scipy.integrate import solve_ivp
from scipy.optimize import brentq

from validation.runs.history import Array, History
from validation.runs.run import Outcome, Run
from validation.scenes import features
from validation.scenes.rigid import FORCE, POSE, BoxSection, RigidSection
from validation.scenes.scene import Scene
from validation.solvers.contract import LineStyle, Prepared, Role, Solver
from validation.solvers.rigid.rocking import friction_needed
from validation.theory.boxes import ShakenBox, SpringImpact, critical_spin, greatest_rotation, return_time
from validation.theory.rocking import Rectangle

AT_REST = 1e-12  # of the speed of the first landing: what is slower bounces no more
ROLLS = 1e-6  # relative: a velocity that is that of a rotation about the corner, in the digits of a file
ACCURACY = 1e-12  # relative tolerance of the integration
SAMPLES = 64  # of a radian of rotation, in which a corner is sought that has come down
MOST_IMPACTS = 100_000


Motion = Callable[[Array], Mapping[str, Array]]  # the columns of boxes at some instants [s]


class RigidExact(Solver):
    """Exact motions of rigid boxes, with Coulomb's friction and Newton's restitution."""

    name = "rigid-exact"
    handles = features.SCHEMES | {features.RIGID_BOXES}
    sections = ("rigid", "time", "run")
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
        columns = motion(time)
        history = History(time, {name: np.asarray(columns[name], float) for name in scene.run.columns})
        seconds = {"setup": 0.0, "stepping": perf_counter() - start}
        return Run(Outcome.COMPLETED, history, {"steps": scene.time.steps}, seconds)


def motion_of(scene: Scene) -> Motion | str:
    """Return the motion of a scene of rigid boxes, or why none is known."""
    rigid = scene.rigid
    if rigid is None:
        return "it is of rigid boxes only"
    box = rigid.box[0]
    if len(rigid.box) > 1:
        return _why_pile_moves(rigid) or partial(_pile, rigid)
    if rigid.base_amplitude:
        return _why_not_shaken(rigid) or partial(_shaken, rigid)
    if rigid.stiffness is not None:
        return _why_not_on_spring(rigid) or partial(_on_spring, rigid)
    if box.tilt == 0 and box.spin == 0:
        if box.lift == 0 and box.velocity[1] == 0:
            return _why_tips(rigid) or partial(_on_plane, rigid)
        return _why_not_flat(rigid) or partial(_bouncing, rigid)
    if box.tilt == 0 and box.lift == 0 and not _turns_off(rigid, box):
        return _why_not_about_corner(scene, rigid) or partial(_about_corner, rigid)
    if rigid.friction == 0 and rigid.restitution == 1:
        return partial(_tumbling, rigid)
    return (
        "the motion is not known of a box that turns, apart from turning about the corner on which it stands at t = 0, "
        "and from tumbling with friction = 0 and restitution = 1"
    )


# ---- at rest --------------------------------------------------------------------------------------------------------


def _why_pile_moves(rigid: RigidSection) -> str | None:
    if any(box.lift or box.spin or any(box.velocity) for box in rigid.box):
        return "the motion is not known of several boxes that move at t = 0 or do not touch"
    if rigid.base_amplitude or rigid.stiffness is not None:
        return "the motion is not known of several boxes on moving ground, or on contact of given stiffness"
    if rigid.slope and abs(rigid.slope) >= rigid.friction:
        return "the motion is not known of several boxes that slide"
    for lowest in range(len(rigid.box)):
        if not _is_supported(rigid, lowest):
            return f"the motion is not known of boxes that overturn, and those from number {lowest + 1} up do"
    return None


def _is_supported(rigid: RigidSection, lowest: int) -> bool:
    """Whether the resultant weight of all boxes from one up meets what that box stands on."""
    above = rigid.box[lowest:]
    starts = rigid.starts[lowest:]
    foot = starts[0][1] - above[0].reach
    mass = sum(box.mass for box in above)
    x = sum(box.mass * start[0] for box, start in zip(above, starts, strict=True)) / mass
    height = sum(box.mass * (start[1] - foot) for box, start in zip(above, starts, strict=True)) / mass
    meets = x + height * math.tan(math.radians(rigid.slope))
    low = above[0].x - above[0].width / 2
    high = above[0].x + above[0].width / 2
    if lowest:
        below = rigid.box[lowest - 1]
        low = max(low, below.x - below.width / 2)
        high = min(high, below.x + below.width / 2)
    return low < meets < high


def _pile(rigid: RigidSection, time: Array) -> dict[str, Array]:
    columns: dict[str, Array] = {}
    for number, start in enumerate(rigid.starts, start=1):
        for part, value in zip(POSE, start, strict=True):
            columns[f"{part}_{number}"] = np.full(len(time), value)
        weight = -rigid.pull[1] * sum(box.mass for box in rigid.box[number - 1 :])
        columns[f"{FORCE}_{number}"] = np.full(len(time), weight)
    return columns


def _poses(rigid: RigidSection, time: Array, **moved: Array) -> dict[str, Array]:
    """Return the columns of a box alone: those that are given, the others as they are at t = 0."""
    x, y, angle = (np.full(len(time), value) for value in rigid.starts[0])
    columns = {"x": x, "y": y, "angle": angle, FORCE: np.zeros(len(time)), **moved}
    return {f"{part}_1": values for part, values in columns.items()}


# ---- on the plane ---------------------------------------------------------------------------------------------------


def _why_tips(rigid: RigidSection) -> str | None:
    box = rigid.box[0]
    slides = box.velocity[0] != 0 or abs(rigid.slope) > rigid.friction
    needed_friction = rigid.friction_coefficient if slides else abs(math.tan(math.radians(rigid.slope)))
    if needed_friction >= box.width / box.height:
        return "the motion is not known of a box that friction overturns: tan(phi) must be below width / height"
    return None


def _on_plane(rigid: RigidSection, time: Array) -> dict[str, Array]:
    """Stand, slide until friction stops it, or slide on."""
    box = rigid.box[0]
    along, across = rigid.pull
    grip = rigid.friction_coefficient * -across
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
    return _poses(rigid, time, x=box.x + moved, force=force)


# ---- flights --------------------------------------------------------------------------------------------------------


def _why_not_flat(rigid: RigidSection) -> str | None:
    box = rigid.box[0]
    if rigid.friction and (rigid.slope or box.velocity[0]):
        return "the motion is not known of a box that lands with friction while it moves along the ground"
    return None


def _bouncing(rigid: RigidSection, time: Array) -> dict[str, Array]:
    box = rigid.box[0]
    along, across = rigid.pull
    flights = _flights(box.lift, box.velocity[1], -across, rigid.restitution, float(time[-1]))
    index = np.searchsorted([flight[0] for flight in flights], time, side="right") - 1
    start, lift, velocity = np.array(flights)[index].T
    since = time - start
    resting = (lift == 0) & (velocity == 0)
    height = np.where(resting, 0.0, lift + velocity * since + across * since**2 / 2)
    force = np.where(resting, -box.mass * across, 0.0)
    x = box.x + box.velocity[0] * time + along * time**2 / 2
    return _poses(rigid, time, x=x, y=box.reach + height, force=force)


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


def _why_not_on_spring(rigid: RigidSection) -> str | None:
    box = rigid.box[0]
    if box.tilt or box.spin:
        return "the motion is not known of a box that turns on contact of given stiffness"
    if rigid.restitution != 1:
        return "on contact of given stiffness the motion is known with restitution = 1: what loses energy has many laws"
    if rigid.gravity == 0 or box.velocity[1] > 0:
        return "the motion is not known on contact of given stiffness without weight, or upwards from t = 0 on"
    return _why_not_flat(rigid)


def _on_spring(rigid: RigidSection, time: Array) -> dict[str, Array]:
    box = rigid.box[0]
    stiffness = rigid.stiffness
    if stiffness is None:
        raise ValueError("rigid.stiffness: must be given, got none")
    along, across = rigid.pull
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
    return _poses(rigid, time, x=x, y=box.reach + height, force=force)


# ---- on moving ground -----------------------------------------------------------------------------------------------


def _why_not_shaken(rigid: RigidSection) -> str | None:
    box = rigid.box[0]
    if rigid.slope or rigid.gravity == 0 or rigid.stiffness is not None or box.tilt or box.spin:
        return "on moving ground the motion is known of a box that lies flat on level, rigid ground"
    if box.lift or any(box.velocity):
        return "on moving ground the motion is known of a box at rest on it at t = 0"
    peak = abs(rigid.base_amplitude) * (2 * math.pi * rigid.base_frequency) ** 2
    if min(rigid.friction_coefficient, peak / rigid.gravity) >= box.width / box.height:
        return "the motion is not known of a box that friction overturns: tan(phi) must be below width / height"
    return None


def _shaken(rigid: RigidSection, time: Array) -> dict[str, Array]:
    box = rigid.box[0]
    force = np.full(len(time), box.mass * rigid.gravity)
    if rigid.friction == 0:
        return _poses(rigid, time, force=force)
    motion = ShakenBox(rigid.base_amplitude, rigid.base_frequency, rigid.friction_coefficient, rigid.gravity)
    return _poses(rigid, time, x=box.x + motion.displacement(time), force=force)


# ---- about a corner -------------------------------------------------------------------------------------------------


def _turns_off(rigid: RigidSection, box: BoxSection) -> bool:
    """Whether the velocity at t = 0 is another one than that of a rotation about a lower corner."""
    across = -box.spin * box.height / 2
    upwards = abs(box.spin) * box.width / 2
    allowed = ROLLS * abs(box.spin) * math.hypot(box.width, box.height)
    return abs(box.velocity[0] - across) > allowed or abs(box.velocity[1] - upwards) > allowed


def _why_not_about_corner(scene: Scene, rigid: RigidSection) -> str | None:
    box = rigid.box[0]
    if rigid.slope or rigid.gravity == 0:
        return "the motion about a corner is known on level ground, under weight"
    rectangle = Rectangle(box.width, box.height, rigid.gravity)
    if abs(box.spin) >= critical_spin(rectangle):
        return "the motion is not known of a box that overturns, beyond the impact at its end"
    end = return_time(rectangle, abs(box.spin))
    if scene.time.duration >= end:
        return f"the motion about a corner is known until the box comes back after {end:.4g} s"
    needed_friction = friction_needed(box.width, box.height, greatest_rotation(rectangle, abs(box.spin)))
    if rigid.friction_coefficient <= needed_friction:
        return f"the corner slips: friction must be above {math.degrees(math.atan(needed_friction)):.4g} deg"
    return None


def _about_corner(rigid: RigidSection, time: Array) -> dict[str, Array]:
    """Integrate psi'' = P^2 sin(psi), psi the angle of the centre beyond the vertical through the corner."""
    box = rigid.box[0]
    rectangle = Rectangle(box.width, box.height, rigid.gravity)
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
    force = box.mass * (rigid.gravity + falling)
    centre = box.x + sign * (x - box.width / 2)
    return _poses(rigid, time, x=centre, y=y, angle=sign * (psi + rectangle.alpha), force=force)


# ---- tumbling -------------------------------------------------------------------------------------------------------


def _tumbling(rigid: RigidSection, time: Array) -> dict[str, Array]:
    """From impact to impact of a corner, without friction or loss."""
    box = rigid.box[0]
    along, across = rigid.pull
    corners = np.array([(sx * box.width / 2, sy * box.height / 2) for sx in (-1, 1) for sy in (-1, 1)])
    instant = 0.0
    _, y, angle = rigid.starts[0]
    velocity = box.velocity[1]
    spin = box.spin
    heights = np.empty(len(time))
    angles = np.empty(len(time))
    written = 0
    for _ in range(MOST_IMPACTS):
        flight = _CornerFlight(corners, y, angle, velocity, spin, across)
        lasted, corner = flight.lands(float(time[-1]) - instant)
        until = int(np.searchsorted(time, instant + lasted, side="right"))
        since = time[written:until] - instant
        heights[written:until] = y + velocity * since + across * since**2 / 2
        angles[written:until] = angle + spin * since
        written = until
        if corner is None:
            break
        y += velocity * lasted + across * lasted**2 / 2
        angle += spin * lasted
        velocity += across * lasted
        instant += lasted
        arm = corners[corner][0] * math.cos(angle) - corners[corner][1] * math.sin(angle)
        approach = velocity + spin * arm
        impulse = -2 * approach / (1 / box.mass + arm**2 / box.inertia)
        velocity += impulse / box.mass
        spin += impulse * arm / box.inertia
    x = box.x + box.velocity[0] * time + along * time**2 / 2
    return _poses(rigid, time, x=x, y=heights, angle=angles)


@dataclass(frozen=True)
class _CornerFlight:
    """A free flight of a box that turns."""

    corners: Array  # about the centre [m], shape (4, 2)
    y: float
    angle: float
    velocity: float
    spin: float
    gravity: float  # negative downwards

    def height(self, corner: int, time: float) -> float:
        """Return the height of a corner above the ground [m]."""
        angle = self.angle + self.spin * time
        x, y = self.corners[corner]
        lift = x * math.sin(angle) + y * math.cos(angle)
        return self.y + self.velocity * time + self.gravity * time**2 / 2 + float(lift)

    def approach(self, corner: int, time: float) -> float:
        """Return the velocity of a corner upwards [m/s]."""
        angle = self.angle + self.spin * time
        x, y = self.corners[corner]
        arm = x * math.cos(angle) - y * math.sin(angle)
        return self.velocity + self.gravity * time + self.spin * float(arm)

    def lands(self, duration: float) -> tuple[float, int | None]:
        """Return when a corner comes down first [s], and which; the duration and None where none does by then."""
        # samples close enough that between two of them a corner's height is nearly a parabola
        length = float(np.max(np.hypot(*self.corners.T)))
        fast = abs(self.spin) + math.sqrt(abs(self.gravity) / length)
        count = max(2, math.ceil(SAMPLES * fast * duration))
        instants = np.linspace(0.0, duration, count + 1)
        angles = self.angle + self.spin * instants
        centre = self.y + self.velocity * instants + self.gravity * instants**2 / 2
        first: tuple[float, int | None] = (duration, None)
        for corner, (x, y) in enumerate(self.corners):
            above = centre + x * np.sin(angles) + y * np.cos(angles)
            for row in np.flatnonzero(above[1:] < 0)[:1]:
                low = float(instants[row])
                high = float(instants[row + 1])
                if self.height(corner, low) <= 0:  # it has just bounced: from the top of its first rise on
                    low = self._top(corner, low, high)
                    if self.height(corner, low) <= 0:
                        continue
                landing = float(brentq(partial(self.height, corner), low, high, xtol=1e-15, rtol=1e-14))
                if landing < first[0]:
                    first = (landing, corner)
        return first

    def _top(self, corner: int, low: float, high: float) -> float:
        """Return the instant at which a corner that rises turns back, the first one where it does not rise."""
        if self.approach(corner, low) <= 0 or self.approach(corner, high) >= 0:
            return low
        return float(brentq(partial(self.approach, corner), low, high, xtol=1e-15, rtol=1e-14))
