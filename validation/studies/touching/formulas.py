"""The study `touching`: first contacts of moving polygons, and a rectangle that lands on a corner.

The steps of `dda` find contacts as blocks meet. Which one is first, and when, is known to rounding; a step sees it at
its end, so that the first force belongs to the first step that ends after the touch.
"""

from __future__ import annotations

import math

import numpy as np
from scipy.integrate import solve_ivp

from validation.metrics.values import or_nan
from validation.models.plane.canon import contact_of, falling, polygons, stiffness_of, touch_of
from validation.models.plane.tables import PlaneSection
from validation.runs.history import History
from validation.runs.row import Metrics, Row
from validation.scenes.outline import area
from validation.scenes.scene import Scene
from validation.solvers.plane.blocks import first_contact
from validation.suite.bands import Band, Runs, cases
from validation.theory.corner_impact import FallingRectangle, Rebound, on_springs, rigid_impulse
from validation.theory.first_touch import normals

STIFF = "touching-stiff"
TOUCHED = 1e-9  # m/s: a change of velocity by which a contact has pressed
CORNERS = "corner-corner"  # as the query calls it


# ---- who touches whom, and when ----


def query(scene: Scene, row: Row) -> Metrics:
    """Return what `dda.first_contact` says beside the roots: lateness, foot apart, and another pair or none."""
    bodies = polygons(scene)
    first, second = ((*body.centroid, 0.0, *body.velocity, body.spin) for body in bodies)
    outlines = bodies[0].corners, bodies[1].corners
    contact = first_contact(outlines, (first, second), scene.time.duration)
    touch = touch_of(scene)
    if contact is None or touch is None:
        return {"wrong": float((contact is None) != (touch is None))}
    points = [point for one in contact.touches for point in one.points]
    feet = {(point.block, point.corner, point.edge): point.foot for point in points}
    later = {"later": contact.time - touch.time, "time": touch.time}
    if not 0 < round(touch.foot, 9) < 1:  # at a corner, where edges are not told apart
        return {"wrong": float(contact.touches[0].kind != CORNERS), **later}
    foot = feet.get((touch.block, touch.corner, touch.edge))
    return {"wrong": float(foot is None), "foot": touch.foot if foot is None else foot - touch.foot, **later}


def motion(scene: Scene, history: History) -> Metrics:
    """Return when the first contact pressed, in steps after the touch, and its angle to its normals [rad]."""
    columns = history.columns
    u, v = (columns[f"A.{part}"] - columns[f"A.{part}"][0] for part in ("vx", "vy"))
    pressed = np.flatnonzero(np.hypot(u, v) > TOUCHED)
    touch = touch_of(scene)
    energy = columns["energy.kinetic"]
    gain = {"gain": np.max(energy) / energy[0] - 1}
    if touch is None or not len(pressed):
        return {"missed": float((touch is None) != (not len(pressed))), **gain}
    first = int(pressed[0])
    low, high = normals(*polygons(scene), touch)
    direction = math.atan2(v[first], u[first])
    middle = (low + high) / 2
    beside = abs(math.remainder(direction - middle, 2 * math.pi)) - (high - low) / 2
    steps = (float(history.time[first]) - touch.time) / scene.time.step
    words = f"{'AB'[touch.block]}{touch.corner} on {'BA'[touch.block]}{touch.edge}"
    return {"missed": 0.0, "steps": steps, "beside": max(0.0, beside), "pair": words, "foot": touch.foot, **gain}


def turned_in_a_step(case: Scene) -> Band:
    """Return how far the first force may lie beside the normals [rad]: what both blocks turn in two steps.

    A block that does not spin begins to by the force of the step itself, at W^2 v per metre, W = 2 dt sqrt(p/m).
    """
    step = case.time.step
    bodies = polygons(case)
    speed = sum(math.hypot(*body.velocity) for body in bodies)
    plane = case.table(PlaneSection)
    lightest = plane.density * min(block.area for block in plane.assembly.blocks)
    starts = speed * step * min(1.0, step**2 * stiffness_of(case) / lightest * 4)
    return 0.0, 2 * step * sum(abs(body.spin) for body in bodies) + starts


def first_step(case: Scene) -> Band | None:
    """Return the steps after the touch at which the first force is there: within one.

    Of corner on corner within two: at the first step's end it is not yet in front of either edge, and which is taken
    the next step decides.
    """
    touch = touch_of(case)
    if touch is None:
        return None
    return -1e-9, 1.0 + 1e-9 + (not 0 < round(touch.foot, 9) < 1)


# ---- a square that lands on two corners ----


def landing(scene: Scene, history: History) -> Metrics:
    """Return the distance of velocity and spin after it from the closed pieces, over the landing speed."""
    first, second = polygons(scene)
    columns = history.columns
    overlap_left = float(np.min(first.corners[:, 0])) + first.centroid[0]
    overlap_right = float(np.max(second.corners[:, 0])) + second.centroid[0]
    arms = (overlap_left - first.centroid[0], overlap_right - first.centroid[0])
    radius = float(np.mean(np.sum(first.corners**2, axis=1))) / 3  # of gyration, squared, of a rectangle
    rise, turn = two_corners(arms, radius)
    speed = -first.velocity[1]
    return {
        "rise": float(columns["A.vy"][-1]) / speed - rise,
        "spin": float(columns["A.spin"][-1]) / speed - turn,
    }


def two_corners(arms: tuple[float, float], radius_squared: float) -> tuple[float, float]:
    """Return the velocity and the spin over the speed at which a body leaves two springs it lands on flat.

    In times of sqrt(m/p): y'' = sum f, theta'' = sum a f/r^2, f = -(y + a theta) while that is positive.
    """
    a, b = arms

    def rate(_: float, z: np.ndarray) -> list[float]:
        first = max(0.0, -(z[0] + a * z[1]))
        second = max(0.0, -(z[0] + b * z[1]))
        return [z[2], z[3], first + second, (a * first + b * second) / radius_squared]

    # Where a spring is met or left the force has a kink, which the tolerance finds.
    solution = solve_ivp(rate, (0.0, 6.0), [0.0, 0.0, -1.0, 0.0], method="DOP853", rtol=1e-12, atol=1e-13)
    return float(solution.y[2, -1]), float(solution.y[3, -1])


def small_turn(case: Scene) -> Band:
    """Return the first correction of the landing: how deep it presses, v sqrt(m/p), over the shorter arm of a contact.

    Directions turn by that; beside it the second order of the step, W^2/12 with W = dt sqrt(p (2 + a^2/r^2)/m).
    """
    plane = case.table(PlaneSection)
    mass = plane.density * area(plane.assembly.blocks[0].vertices)
    stiffness = stiffness_of(case)
    first, _ = polygons(case)
    deep = math.hypot(*first.velocity) * math.sqrt(mass / stiffness) / 0.5
    own = case.time.step**2 * stiffness / mass * (2 + 1.25 / (2 / 3)) / 12
    return -deep - own, deep + own


# ---- a rectangle that lands on a corner ----


def rebound(scene: Scene) -> tuple[FallingRectangle, Rebound]:
    """Return the rectangle, and how it leaves springs."""
    contact = contact_of(scene)
    body = falling(scene)
    return body, on_springs(body, contact.stiffness, contact.shear, contact.friction_coefficient, scene.time.duration)


def against_springs(scene: Scene, history: History) -> Metrics:
    """Return errors of the velocities after the impact beside the exact ones on these springs, and impulses."""
    body, exact = rebound(scene)
    columns = history.columns
    vx, vy, spin = (float(columns[f"rectangle.{part}"][-1]) for part in ("vx", "vy", "spin"))
    _, _, _, left_x, left_y, left_spin = exact.state
    left_y -= body.gravity * (float(history.time[-1]) - exact.time)
    errors = {"vx": vx - left_x, "vy": vy - left_y, "spin": spin - left_spin}
    landed = body.flown(body.landing(scene.time.duration)[0])
    arm = math.hypot(body.width, body.height) / 2
    flight = body.gravity * float(history.time[-1]) * body.mass
    contact = contact_of(scene)
    balance = np.max(np.abs(columns["energy.balance"])) / np.max(columns["energy.kinetic"])
    return {
        **errors,
        "size": max(abs(errors["vx"]), abs(errors["vy"]), abs(errors["spin"]) * arm) / abs(landed.velocity[1]),
        "bound": events_in_steps(scene)[1],
        "J_t": body.mass * (vx - body.velocity[0]),
        "J_n": body.mass * (vy - body.velocity[1]) + flight,
        "mu": contact.friction_coefficient or 0.0,
        "ratio": contact.shear / contact.stiffness,
        "balance": float(balance),
        **rigid(scene),
    }


def rigid(scene: Scene) -> dict[str, float]:
    """Return the impulses of the rigid limit, of the same friction, whose springs along the plane are far stiffer."""
    along, across = rigid_impulse(falling(scene), contact_of(scene).friction_coefficient or 0.0, 1.0)
    return {"rigid J_t": along, "rigid J_n": across}


def in_the_limit(runs: Runs) -> Metrics:
    """Return the smooth impulse over a rigid one, less one: on both springs, and extrapolated in p^-1/2."""
    soft, stiff = (or_nan(against_springs(*run)["J_n"]) / smooth_limit() - 1 for run in runs)
    first, second = (stiffness_of(case) for case, _ in runs)
    root = math.sqrt(second / first)
    return {"soft": soft, "stiff": stiff, "rigid": (root * stiff - soft) / (root - 1)}


def smooth_limit() -> float:
    """Return the rigid impulse without friction [N s]."""
    return rigid(next(iter(cases(STIFF))))["rigid J_n"]


def square_of_the_first() -> Band:
    """Return what extrapolating in p^-1/2 leaves: the square of the correction on the softer springs, exactly."""
    _, exact = rebound(next(iter(cases(STIFF))))
    half = (exact.impulse[1] / smooth_limit() - 1) ** 2
    return -half, half


def events_in_steps(case: Scene) -> Band:
    """Return the error of a velocity over that of the landing: W^2, W^2 = dt^2 (p A_nn + ps A_tt), A of the corner.

    The trapezoid of a force that begins or ends within a step is wrong by 1/8 of its rate times dt^2 at most, W^2/8 of
    the velocity: there are five such events at most (closing, slip, stick, slip, opening), and the period's W^2/12.
    """
    body = falling(case)
    landing, number = body.landing(case.time.duration)
    landed = body.flown(landing)
    x, y = landed.arm(number)
    contact = contact_of(case)
    across = contact.stiffness * (1 / body.mass + x**2 / body.inertia)
    along = contact.shear * (1 / body.mass + y**2 / body.inertia)
    return 0.0, case.time.step**2 * (across + along)
