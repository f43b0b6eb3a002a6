"""The study `pushing`: two blocks on a slope, and two wedges, against motions in closed form.

Blocks are rigid, contacts are stated. What the springs add to a rigid base falls with their stiffness p: a corner gives
way by W/p at most, so that angles and arms change by its share of the thinnest block, W/(p l). This first correction is
the band of what is exact for rigid blocks.
"""

from __future__ import annotations

import itertools
import math

import numpy as np

from validation.models.plane.canon import ACTIVE, PASSIVE, moving_blocks, rough, stiffness_of, wedges_of
from validation.models.plane.tables import PlaneSection
from validation.runs.history import Array, History
from validation.runs.row import Metrics
from validation.scenes.outline import area
from validation.scenes.scene import Scene
from validation.studies.pushing.exact import Pushing, at
from validation.suite.bands import Band, Runs, cases

LOCKED = "pushing-locked"
DIPS = {"active": ACTIVE, "passive": PASSIVE}
SETTLED = 0.5  # s, from which on the weight has grown and its ringing has gone
STANDS = 1e-3  # m/s: the springs still give way at that speed after two seconds at most


# ---- two blocks on a slope ----


def problem_of(scene: Scene) -> Pushing:
    """Return the exact problem of a scene of two blocks on a slope."""
    plane = scene.table(PlaneSection)
    slope = plane.slope[0]
    assembly = plane.assembly
    upper, lower, ground = (assembly.members[f"slope_{name}"][0] for name in ("1", "2", "ground"))
    masses = [plane.density * area(assembly.blocks[block].vertices) for block in (upper, lower)]
    friction = [rough(assembly, block, ground) for block in (upper, lower)]
    between = assembly.springs_between(upper, lower)
    return Pushing(
        (masses[0], masses[1]),
        (friction[0], friction[1]),
        math.radians(slope.angle),
        between.stiffness if between else 0.0,
        slope.gaps[1],
        (slope.speeds[0], slope.speeds[1]),
    )


def way(history: History, block: str, direction: tuple[float, float]) -> Array:
    """Return the way of a block along a unit vector since the first row [m]."""
    x, y = (history.columns[f"{block}.{part}"] for part in "xy")
    along: Array = (x - x[0]) * direction[0] + (y - y[0]) * direction[1]
    return along


def errors_at_end(scene: Scene, history: History) -> tuple[float, float]:
    """Return how far both blocks are from the exact motion at the end [m]."""
    problem = problem_of(scene)
    start, end = at(problem, float(history.time[0])), at(problem, float(history.time[-1]))
    down = (math.cos(problem.slope), -math.sin(problem.slope))
    upper, lower = (
        float(way(history, f"slope_{block + 1}", down)[-1]) - (end[block] - start[block]) for block in (0, 1)
    )
    return upper, lower


def against_exact(scene: Scene, history: History) -> Metrics:
    """Return the same, and that of their centre of mass [m]."""
    upper, lower = errors_at_end(scene, history)
    first, second = problem_of(scene).masses
    push = history.columns["slope_2.4-slope_1.1.normal"]
    energy = history.columns["energy.kinetic"]
    return {
        "upper": upper,
        "lower": lower,
        "centre": (first * upper + second * lower) / (first + second),
        "largest push": np.max(push),
        "balance": np.max(np.abs(history.columns["energy.balance"])) / np.max(energy),
    }


def push_at_end(scene: Scene, history: History) -> tuple[float, float]:
    """Return the push that is left at the end, and the exact one [N]."""
    problem = problem_of(scene)
    upper, lower, _, _ = at(problem, float(history.time[-1]))
    exact = problem.stiffness * (upper - lower - problem.gap)
    return float(history.columns["slope_2.4-slope_1.1.normal"][-1]), exact


def against_rest(scene: Scene, history: History) -> Metrics:
    """Return the push between two blocks at rest [N], and over the exact one, less one."""
    push, exact = push_at_end(scene, history)
    return {"push": push, "exact": exact, "over exact": push / exact - 1}


def order_of_push(runs: Runs) -> Metrics:
    """Return the error of the push that is left over twice that of half the step."""
    coarse, fine = (push - exact for push, exact in itertools.starmap(push_at_end, runs))
    return {"push": coarse / (2 * fine)}


def orders(runs: Runs) -> Metrics:
    """Return the error of each block over twice that of half the step."""
    coarse, fine = itertools.starmap(errors_at_end, runs)
    return {block: coarse[number] / (2 * fine[number]) for number, block in enumerate(("upper", "lower"))}


def first_correction(case: Scene) -> float:
    """Return W/(p l): all weight on one corner spring over the thinnest block that moves."""
    plane = case.table(PlaneSection)
    weight = sum(block.mass for block in moving_blocks(case)) * math.hypot(*plane.gravity)
    return weight / (stiffness_of(case) * plane.assembly.thinnest)


def centre(case: Scene) -> Band:
    """Return the error of the centre of mass [m]: the first correction of its way."""
    problem = problem_of(case)
    end = at(problem, case.time.duration)
    first, second = problem.masses
    half = first_correction(case) * ((first * end[0] + second * end[1]) / (first + second))
    return -half, half


def first_order() -> Band:
    """Return 1 -/+ w h: the share by which the error of the larger step h departs from a straight line in it.

    Both scenes have the same blocks, spring and steps.
    """
    return _first_order("pushing-both")


def first_order_of_push() -> Band:
    """Return the same of the blocks that come to rest."""
    return _first_order(LOCKED)


def _first_order(name: str) -> Band:
    case = next(iter(cases(name)))
    problem = problem_of(case)
    frequency = math.sqrt(problem.stiffness * sum(1 / mass for mass in problem.masses))
    return 1 - frequency * case.time.step, 1 + frequency * case.time.step


# ---- two wedges ----


def against_wedges(scene: Scene, history: History) -> Metrics:
    """Return accelerations and mean forces over those of rigid wedges, less one, and the larger end speed."""
    late = history.time > SETTLED
    ways = {name: way(history, name, (-math.cos(dip), -math.sin(dip))) for name, dip in DIPS.items()}
    measured = {name: 2 * float(np.polyfit(history.time[late], down[late], 2)[0]) for name, down in ways.items()}
    corners = {
        "interface": [f"passive.{corner}-active.2.normal" for corner in (2, 3)],
        "active base": [f"active.{corner}-rock.3.normal" for corner in (0, 1)],
        "passive base": [f"passive.{corner}-rock.4.normal" for corner in (0, 1)],
    }
    for name, columns in corners.items():
        measured[name] = float(np.mean(sum(history.columns[column][late] for column in columns)))
    exact = wedges_of(scene).motion()
    speed = max(float(down[-1] - down[-2]) for down in ways.values()) / scene.time.step
    return {name: value / exact[name] - 1 for name, value in measured.items()} | {
        "speed": speed,
        "stiffness": stiffness_of(scene),
    }


def rigid_wedges(case: Scene) -> Band:
    """Return the first correction in 1/p."""
    half = first_correction(case)
    return -half, half


def factor_of_safety(case: Scene) -> float:
    """Return the factor of safety of the wedges."""
    return wedges_of(case).factor_of_safety


def limit(case: Scene) -> Metrics:
    """Return the factor of safety of the wedges and the friction angles [rad], below and between them."""
    wedges = wedges_of(case)
    angles = {"below": math.atan(wedges.below), "between": math.atan(wedges.between)}
    return {"factor": wedges.factor_of_safety, **angles}


def at_the_limit(case: Scene) -> Band:
    """Return the speed at the end [m/s]: none above the limit; below it at least what half the deficit drives.

    Of tan(phi) 1 % too low, the weight along the planes exceeds the friction by a hundredth of it.
    """
    plane = case.table(PlaneSection)
    deficit = 1 - factor_of_safety(case)
    if deficit < 0:
        return -STANDS, STANDS
    return deficit / 2 * -plane.gravity[1] * math.sin(PASSIVE) * (case.time.duration - plane.ramp), math.inf
