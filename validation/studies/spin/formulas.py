"""The study `spin`: rows that compare histories with exact motions, and the bands of their gates."""

from __future__ import annotations

import itertools
import math

import numpy as np

from validation.models.plane.canon import moving_blocks, slide_of, spinning_of, stiffness_of
from validation.models.plane.tables import PlaneSection
from validation.runs.history import History
from validation.runs.row import Metrics, Value
from validation.scenes.scene import Scene
from validation.suite.bands import Band, Bands, Runs, cases, fitted_order, near
from validation.theory.spectra import EPS

STRAINS = ("ex", "ey", "gxy")


# ---- blocks that spin ----


def errors_of(scene: Scene, history: History) -> dict[str, float]:
    """Return the largest error of the angle [rad] and of each strain."""
    exact = spinning_of(scene).at(history.time)
    return {name: float(np.max(np.abs(history.columns[f"block.{name}"] - values))) for name, values in exact.items()}


def balance(history: History) -> float:
    """Return the largest residual of the account of energies, over the first kinetic energy."""
    columns = history.columns
    return float(np.max(np.abs(columns["energy.balance"])) / columns["energy.kinetic"][0])


def accounts(scene: Scene, history: History) -> dict[str, Value]:
    """Return how far angular momentum goes from its start, and the balance of energies."""
    momentum = history.columns["momentum.angular"] / spinning_of(scene).momentum
    return {"momentum": np.max(np.abs(momentum - 1)), "balance": balance(history)}


def against_motion(scene: Scene, history: History) -> Metrics:
    """Return the errors of a block that spins unstrained at first, and its accounts."""
    return errors_of(scene, history) | accounts(scene, history)


def against_steady(scene: Scene, history: History) -> Metrics:
    """Return strains at the end, and area and rate of angle over those of a steady spin."""
    ex, ey, gxy = (float(history.columns[f"block.{name}"][-1]) for name in STRAINS)
    exact = spinning_of(scene)
    stretch = 1 + exact.steady_strain
    rate = float(np.diff(history.columns["block.angle"])[-1]) / scene.time.step
    return accounts(scene, history) | {
        "ex": ex,
        "ey": ey,
        "area": ((1 + ex) * (1 + ey) - gxy**2 / 4) / stretch**2 - 1,
        "rate": rate * stretch**2 / exact.spin - 1,
    }


def orders(runs: Runs) -> Metrics:
    """Return the order of the errors of angle and strains."""
    errors = list(itertools.starmap(errors_of, runs))
    steps = [case.time.step for case, _ in runs]
    names = ("angle", "ex") if runs[0][0].name.startswith("spin-square") else ("angle", *STRAINS)
    return {name: fitted_order(steps, [error[name] for error in errors]) for name in names}


def second_order() -> Bands:
    """Return 2 -/+ what the largest step departs from the leading term of its error.

    A mode of frequency w has in average acceleration the phase 2 atan(w h / 2) = w h - (w h)^3/12 + (w h)^5/80 a step:
    after a time t it is late by d = w t (w h)^2 / 12, of which (12/80) (w h)^2 is of higher order; the difference of
    two vibrations is 2 sin(d/2) instead of d, less by d^2 / 24. Both fall to a quarter with half the step.
    """
    case = next(cases("spin-rectangle"))  # whose frequencies are the higher ones: across its shorter side
    exact = spinning_of(case)
    modulus = exact.young / (1 - exact.poisson**2)
    frequency = math.sqrt(12 * modulus / exact.density) / min(exact.width, exact.height)
    square = (frequency * case.time.step) ** 2
    late = frequency * case.time.duration * square / 12
    half = 0.75 * (late**2 / 24 + 12 / 80 * square) / math.log(2)
    return dict.fromkeys(("angle", "ex", *STRAINS[1:]), (2 - half, 2 + half))


def rounding(case: Scene) -> Band:
    """Return n eps."""
    return 0.0, case.time.steps * EPS


def steady(case: Scene) -> Bands:
    """Return strain, area and rate of a steady spin: each rounded once a step, the rate as a difference of angles."""
    exact = spinning_of(case)
    relative = case.time.steps * EPS
    angles = exact.spin * case.time.duration
    last = angles * EPS / (exact.spin * case.time.step)
    strain = near(exact.steady_strain, relative)
    return {"ex": strain, "ey": strain, "area": (-relative, relative), "rate": (-last, last)}


# ---- blocks that fly and slide ----


def against_flight(scene: Scene, history: History) -> Metrics:
    """Return how far a flying block is from its parabola and even turn, over the largest way and angle."""
    (block,) = moving_blocks(scene)
    t = history.time - history.time[0]
    started = history.time[0]
    gravity = scene.table(PlaneSection).gravity
    largest = 0.0
    for axis, name in enumerate(("x", "y")):
        way = history.columns[f"block.{name}"] - history.columns[f"block.{name}"][0]
        exact = (block.velocity[axis] + gravity[axis] * started) * t + gravity[axis] * t**2 / 2
        largest = max(largest, float(np.max(np.abs(way - exact)) / np.max(np.abs(exact))))
    angle = history.columns["block.angle"] - block.angle - block.spin * history.time
    return {"way": largest, "angle": float(np.max(np.abs(angle))) / (block.spin * scene.time.duration)}


def weight_over_stiffness(scene: Scene) -> float:
    """Return W/p [m]."""
    (block,) = moving_blocks(scene)
    return block.mass * -scene.table(PlaneSection).gravity[1] / stiffness_of(scene)


def pitch(scene: Scene) -> float:
    """Return the pitch of a block that slides, at rest in its own axes: mu W h / (p b^2) [rad]."""
    slide = slide_of(scene)
    return slide.friction * weight_over_stiffness(scene) * slide.height / slide.width**2


def against_stop(scene: Scene, history: History) -> Metrics:
    """Return how far the centre is from its parabola before its foot stops, and its way at the end [m]."""
    slide = slide_of(scene)
    slowing = slide.friction * slide.gravity
    t = history.time
    way = history.columns["block.x"] - slide.start
    parabola = slide.speed * t - slowing * t**2 / 2
    sliding = t < 0.99 * slide.speed / slowing
    return {"parabola": np.max(np.abs((way - parabola)[sliding])), "distance": way[-1]}


def closed_stop(case: Scene) -> Metrics:
    """Return the way to rest of the rigid block, and the return of its centre on springs [m]."""
    slide = slide_of(case)
    return {"distance": slide.stopping_distance, "back": pitch(case) * slide.height / 2}


def parabola(case: Scene) -> Band:
    """Return what the pitch takes from the parabola [m]: twice the resting one while it swings, squared, of the way.

    The friction of both corners is mu W while both are closed; the heave that a pitch makes is of its second order.
    """
    return 0.0, (2 * pitch(case)) ** 2 * slide_of(case).stopping_distance


def distance(case: Scene) -> Band:
    """Return the way to rest [m]: the foot's, since the centre comes back by the pitch times h/2 as friction ends.

    A step stops it in place, mu g h^2 / 2 too early or too late.
    """
    slide = slide_of(case)
    foot = slide.stopping_distance - pitch(case) * slide.height / 2
    within = slide.friction * slide.gravity * case.time.step**2 / 2
    return foot - within, foot + within


# ---- blocks on a ledge ----


def turn_at_end(scene: Scene, history: History) -> tuple[float, float]:
    """Return the turn, clockwise, and the rigid block's, at the end [rad]."""
    return -float(history.columns["block.angle"][-1]), slide_of(scene).turn(float(history.time[-1]))


def against_ledge(scene: Scene, history: History) -> Metrics:
    """Return the turn at the end over the rigid block's, less one, or where it stops [m]."""
    accounted = {"balance": balance(history), "stiffness": stiffness_of(scene)}
    slide = slide_of(scene)
    if slide.tips is None:
        return accounted | {"rest": float(history.columns["block.x"][-1]) - slide.start - slide.stopping_distance}
    turn, exact = turn_at_end(scene, history)
    return accounted | {"turn": turn / exact - 1, "rigid turn": exact}


def extrapolated(runs: Runs) -> Metrics:
    """Return what two stiffnesses extrapolate to, over the rigid block's turn, less one; also over the next term.

    The turn is the rigid block's and a term in 1/p, which both stiffnesses tell; the next term is its square.
    """
    (first, exact), (second, _) = itertools.starmap(turn_at_end, runs)
    soft, stiff = (stiffness_of(case) for case, _ in runs)
    ratio = stiff / soft
    error = (ratio * second - first) / (ratio - 1) / exact - 1
    term = (first - second) / exact
    return {"turn": error, "over the next term": error / term**2}


def stops(case: Scene) -> Band:
    """Return the distance of its rest from the rigid block's [m]: no more than it sinks, W/2p."""
    half = weight_over_stiffness(case) / 2
    return -half, half
