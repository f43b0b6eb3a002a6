"""The exact motion of rigid boxes on a ground, where it is known; others are refused by name."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from time import perf_counter
from typing import Any

import numpy as np

from validation.models.plane.boxes import LANDS_BY, Box, BoxesOnGround, boxes_of
from validation.models.plane.history import POSE
from validation.runs.history import Array, History
from validation.runs.run import Outcome, Run
from validation.scenes import features
from validation.scenes.scene import Scene
from validation.solvers.contract import LineStyle, Prepared, Role, Solver
from validation.solvers.rigid.rocking import friction_needed
from validation.theory.boxes import ShakenBox, SpringImpact
from validation.theory.corner_impact import FallingRectangle, HorizonError
from validation.theory.rocking import Rectangle

AT_REST = 1e-12  # of the speed of the first landing: what is slower bounces no more
ROLLS = 1e-6  # relative: a velocity that is that of a rotation about the corner, in the digits of a file
ACCURACY = 1e-12  # relative tolerance of the integration
MOST_IMPACTS = 100_000


Motion = Callable[[Array], Mapping[str, Array]]  # the columns of boxes at some instants [s]


class UnknownMotionError(ValueError):
    """The motion of a scene is not known."""


class RigidExact(Solver):
    """Exact motions of rigid boxes, with Coulomb's friction and Newton's restitution."""

    name = "rigid-exact"
    handles = features.SCHEMES | {features.PLANE, features.MOVING_BLOCKS}
    sources = (
        "validation.theory.boxes",
        "validation.theory.corner_impact",
        "validation.theory.rocking",
        "fem_reference.exact.rocking",
    )
    role = Role.TRUTH
    rank = 3.0
    line = LineStyle("#000000", (1.0, 1.0))

    def applicable(self, scene: Scene) -> str | None:
        """Return None, or why the motion is not known."""
        try:
            motion_of(scene)
        except ValueError as error:
            return str(error)
        return None

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
        time = scene.time.step * np.arange(1.0, scene.time.steps + 1)
        try:
            columns = motion_of(scene)(time)
        except HorizonError as error:
            steps = math.floor(error.time / scene.time.step)
            return Run(Outcome.HORIZON, notes=(f"{error}; the scene may have {steps} steps",))
        except ValueError as error:
            return Run(Outcome.NOT_APPLICABLE, notes=(str(error),))
        history = History(time, {name: np.asarray(columns[name], float) for name in scene.run.columns})
        seconds = {"setup": 0.0, "stepping": perf_counter() - start}
        return Run(Outcome.COMPLETED, history, {"steps": scene.time.steps}, seconds)


def motion_of(scene: Scene) -> Motion:
    """Return the motion of a scene of boxes on a ground; a ValueError says why none is known."""
    ground = boxes_of(scene)
    for name in scene.run.columns:
        if name not in ground.columns:
            known = f"positions, angles and the normal forces below boxes, {ground.force_columns[0]}"
            raise UnknownMotionError(f"it has {known}, not {name}")
    box = ground.boxes[0]
    if len(ground.boxes) > 1:
        return _pile(ground)
    if ground.base_amplitude:
        return _shaken(ground, box)
    if ground.stiffness is not None:
        return _on_spring(ground, box)
    if box.angle == 0 and box.spin == 0:
        rests = box.lift == 0 and box.velocity[1] == 0
        return _on_plane(ground, box) if rests else _bouncing(ground, box)
    if box.angle == 0 and box.lift == 0 and not _turns_off(box):
        return _about_corner(scene, ground, box)
    if ground.friction == 0 and ground.restitution == 1:
        return _tumbling(ground, box)
    raise UnknownMotionError(
        "the motion is not known of a box that turns, apart from turning about the corner on which it stands at t = 0, "
        "and from tumbling with friction = 0 and restitution = 1"
    )


def _unless(is_unknown: bool, why: str) -> None:
    if is_unknown:
        raise UnknownMotionError(why)


def _poses(ground: BoxesOnGround, time: Array, force: Any = 0.0, **moved: Array) -> dict[str, Array]:
    """Return the columns of a box alone: those that are given, the others as at t = 0."""
    (box,) = ground.boxes
    columns = {ground.force_columns[0]: force}
    columns |= {f"{box.name}.{part}": moved.get(part, getattr(box, part)) for part in POSE}
    return {name: np.full(len(time), values) for name, values in columns.items()}


def _flown(ground: BoxesOnGround, box: Box, time: Array) -> Array:
    """Return where a box is along frictionless ground [m]."""
    return np.asarray(box.x + box.velocity[0] * time + ground.pull[0] * time**2 / 2)


# ---- at rest ----


def _pile(ground: BoxesOnGround) -> Motion:
    moves = any(box.lift or box.spin or any(box.velocity) for box in ground.boxes)
    unknown = "the motion is not known of"
    _unless(moves, f"{unknown} several boxes that move at t = 0 or do not touch")
    loose = bool(ground.base_amplitude or ground.stiffness is not None)
    _unless(loose, f"{unknown} several boxes on moving ground, or on contact of given stiffness")
    slides = bool(ground.slope) and abs(ground.slope) >= ground.friction
    _unless(slides, f"{unknown} several boxes that slide")
    for lowest in range(len(ground.boxes)):
        falls = not _is_supported(ground, lowest)
        _unless(falls, f"{unknown} boxes that overturn, and those from number {lowest + 1} up do")

    def motion(time: Array) -> dict[str, Array]:
        values: dict[str, float] = {}
        for number, (box, force_column) in enumerate(zip(ground.boxes, ground.force_columns, strict=True)):
            values |= {f"{box.name}.{part}": getattr(box, part) for part in POSE}
            values[force_column] = -ground.pull[1] * sum(above.mass for above in ground.boxes[number:])
        return {name: np.full(len(time), value) for name, value in values.items()}

    return motion


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


# ---- on the plane ----


def _on_plane(ground: BoxesOnGround, box: Box) -> Motion:
    """Stand, slide until friction stops it, or slide on."""
    along, across = ground.pull
    grip = ground.friction_coefficient * -across
    velocity = box.velocity[0]
    slides = velocity != 0 or abs(ground.slope) > ground.friction
    _check_upright(box, ground.friction_coefficient if slides else abs(math.tan(math.radians(ground.slope))))

    def motion(time: Array) -> dict[str, Array]:
        moved = np.zeros(len(time))
        stop = 0.0
        if velocity:
            slowing = along - math.copysign(grip, velocity)
            stop = -velocity / slowing if velocity * slowing < 0 else math.inf
            sliding = np.minimum(time, stop)
            moved = velocity * sliding + slowing * sliding**2 / 2
        excess = max(0.0, abs(along) - grip)
        # from rest down the slope, also after it has come to rest
        moved = moved + math.copysign(excess, along) * np.maximum(0.0, time - stop) ** 2 / 2
        return _poses(ground, time, x=box.x + moved, force=-box.mass * across)

    return motion


def _check_upright(box: Box, needed_friction: float) -> None:
    why = "the motion is not known of a box that friction overturns: tan(phi) must be below width / height"
    _unless(needed_friction >= box.width / box.height, why)


# ---- flights ----


def _check_flat(ground: BoxesOnGround, box: Box) -> None:
    _unless(ground.restitution is None, LANDS_BY)
    slides = bool(ground.friction and (ground.slope or box.velocity[0]))
    _unless(slides, "the motion is not known of a box that lands with friction while it moves along the ground")


def _bouncing(ground: BoxesOnGround, box: Box) -> Motion:
    _check_flat(ground, box)
    across = ground.pull[1]

    def motion(time: Array) -> dict[str, Array]:
        flights = np.array(_flights(box.lift, box.velocity[1], -across, ground.rebound, float(time[-1])))
        start, lift, velocity = flights[np.searchsorted(flights[:, 0], time, side="right") - 1].T
        since = time - start
        resting = (lift == 0) & (velocity == 0)
        height = np.where(resting, 0.0, lift + velocity * since + across * since**2 / 2)
        force = np.where(resting, -box.mass * across, 0.0)
        return _poses(ground, time, x=_flown(ground, box, time), y=box.reach + height, force=force)

    return motion


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
        if landing == 0:
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


# ---- on a spring ----


def _on_spring(ground: BoxesOnGround, box: Box) -> Motion:
    turns = bool(box.angle or box.spin)
    _unless(turns, "the motion is not known of a box that turns on contact of given stiffness")
    loses = "on contact of given stiffness the motion is known with restitution = 1: what loses energy has many laws"
    _unless(ground.restitution != 1, loses)
    rises = ground.gravity == 0 or box.velocity[1] > 0
    _unless(rises, "the motion is not known on contact of given stiffness without weight, or upwards from t = 0 on")
    _check_flat(ground, box)
    stiffness = ground.stiffness or math.inf
    gravity = -ground.pull[1]

    def motion(time: Array) -> dict[str, Array]:
        speed = math.sqrt(box.velocity[1] ** 2 + 2 * gravity * box.lift)
        landing = SpringImpact(box.mass, stiffness, gravity, speed)
        # from the first landing on contact and flight follow each other
        since = time - (speed + box.velocity[1]) / gravity
        cycle = np.mod(since, landing.duration + 2 * speed / gravity)
        pressed = (since >= 0) & (cycle < landing.duration)
        aloft = np.where(since < 0, since, cycle - landing.duration)
        rising = np.where(since < 0, -speed, speed)
        height = np.where(pressed, -landing.sinking(cycle), rising * aloft - gravity * aloft**2 / 2)
        force = np.where(pressed, -stiffness * height, 0.0)
        return _poses(ground, time, x=_flown(ground, box, time), y=box.reach + height, force=force)

    return motion


# ---- on moving ground ----


def _shaken(ground: BoxesOnGround, box: Box) -> Motion:
    tilted = ground.slope or ground.gravity == 0 or ground.stiffness is not None or box.angle or box.spin
    _unless(bool(tilted), "on moving ground the motion is known of a box that lies flat on level, rigid ground")
    moves = bool(box.lift or any(box.velocity))
    _unless(moves, "on moving ground the motion is known of a box at rest on it at t = 0")
    mu = ground.friction_coefficient
    shaken = ShakenBox(ground.base_amplitude, ground.base_frequency, mu, ground.gravity)
    _check_upright(box, min(mu, shaken.peak / ground.gravity))

    def motion(time: Array) -> dict[str, Array]:
        moved = shaken.displacement(time) if mu else 0 * time
        return _poses(ground, time, x=box.x + moved, force=box.mass * ground.gravity)

    return motion


# ---- about a corner ----


def _turns_off(box: Box) -> bool:
    """Whether the velocity at t = 0 is not that of a rotation about a lower corner."""
    across = -box.spin * box.height / 2
    upwards = abs(box.spin) * box.width / 2
    allowed = ROLLS * abs(box.spin) * math.hypot(box.width, box.height)
    return abs(box.velocity[0] - across) > allowed or abs(box.velocity[1] - upwards) > allowed


def _about_corner(scene: Scene, ground: BoxesOnGround, box: Box) -> Motion:
    """Integrate psi'' = P^2 sin(psi), psi the angle of the centre beyond the vertical through the corner."""
    tilted = ground.slope != 0 or ground.gravity == 0
    _unless(tilted, "the motion about a corner is known on level ground, under weight")
    rectangle = Rectangle(box.width, box.height, ground.gravity)
    spin = abs(box.spin)
    overturns = spin >= rectangle.critical_spin
    _unless(overturns, "the motion is not known of a box that overturns, beyond the impact at its end")
    tilt = rectangle.greatest_rotation(spin)
    end = 2 * rectangle.quarter_period(tilt)  # it comes down as it rose
    comes_back = f"the motion about a corner is known until the box comes back after {end:.4g} s"
    _unless(scene.time.duration >= end, comes_back)
    needed = friction_needed(box.width, box.height, tilt)
    slips = f"the corner slips: friction must be above {math.degrees(math.atan(needed)):.4g} deg"
    _unless(ground.friction_coefficient <= needed, slips)

    def motion(time: Array) -> dict[str, Array]:
        from scipy.integrate import solve_ivp

        radius = math.hypot(box.width, box.height) / 2
        sign = math.copysign(1.0, box.spin)
        solution = solve_ivp(
            lambda _, state: [state[1], rectangle.rate2 * math.sin(state[0])],
            (0.0, float(time[-1])),
            [-rectangle.alpha, spin],
            method="DOP853",
            t_eval=time,
            rtol=ACCURACY,
            atol=ACCURACY,
        )
        psi, rate = solution.y
        # about the left corner, a positive rotation; to the right all is mirrored
        falling = -radius * (np.cos(psi) * rate**2 + np.sin(psi) * rectangle.rate2 * np.sin(psi))
        force = box.mass * (ground.gravity + falling)
        centre = box.x + sign * (-radius * np.sin(psi) - box.width / 2)
        angle = sign * (psi + rectangle.alpha)
        return _poses(ground, time, x=centre, y=radius * np.cos(psi), angle=angle, force=force)

    return motion


# ---- tumbling ----


def _tumbling(ground: BoxesOnGround, box: Box) -> Motion:
    """From impact to impact of a corner, without friction or loss.

    The motion raises `HorizonError` if the box does not go on so, or impacts are more than `MOST_IMPACTS`.
    """
    across = ground.pull[1]
    thrown = FallingRectangle(
        width=box.width,
        height=box.height,
        mass=box.mass,
        place=(box.x, box.y),
        angle=box.angle,
        velocity=box.velocity,
        spin=box.spin,
        gravity=-across,
    )
    try:
        thrown.next_impact(0.0, 0.0)
    except HorizonError as error:
        why = f"the motion is not known of a box that at t = 0 does this: {error.reason}"
        raise UnknownMotionError(why) from None

    def motion(time: Array) -> dict[str, Array]:
        flight = thrown
        start = 0.0
        heights, angles = np.empty((2, len(time)))
        written = 0
        for _ in range(MOST_IMPACTS):
            impact = flight.next_impact(start, float(time[-1]))
            until = len(time) if impact is None else int(np.searchsorted(time, impact[0], side="right"))
            since = time[written:until] - start
            heights[written:until] = flight.place[1] + flight.velocity[1] * since + across * since**2 / 2
            angles[written:until] = flight.angle + flight.spin * since
            written = until
            if impact is None:
                return _poses(ground, time, x=_flown(ground, box, time), y=heights, angle=angles)
            instant, corner = impact
            flight = flight.flown(instant - start).rebounded(corner)
            start = instant
        raise HorizonError(start, f"more than {MOST_IMPACTS} impacts")

    return motion
