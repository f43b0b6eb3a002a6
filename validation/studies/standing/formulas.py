"""The study `standing`: columns, an arch, blocks that overhang or lean, and half a truss, beside their limits.

Blocks are rigid. A weight that grows, under a damping of rate c, brings a structure to rest, or to the speed v at which
its unbalanced weight, the share s of it, is what damping takes: m c v = s m g. So s = c v / g tells standing from
falling: no speed is left of what stands, and what is beyond its limit by a share f of it has an s of that order.
"""

from __future__ import annotations

import itertools
import math
from collections.abc import Callable, Mapping
from typing import NamedTuple

import numpy as np
from scipy.integrate import solve_ivp

from validation.metrics.values import or_nan
from validation.models.plane.canon import friction_of, half_truss, stiffness_of
from validation.models.plane.limits import (
    flat_height,
    harmonic,
    keyed_dip,
    leaning_friction,
    least_thickness,
    seat_forces,
    stepped_dip,
    stepped_friction,
)
from validation.models.plane.tables import PlaneSection
from validation.runs.history import Array, History
from validation.runs.row import Metrics, Value
from validation.scenes.scene import Scene
from validation.suite.bands import Band, Runs, cases

REST = 1e-6  # of the weight: what is left of oscillations after a second of a damping of 5/s and more, exp(-c t)
LEVER = 0.1  # least share of an unbalanced weight that moves the centroid which moves most
OVERHANG = "standing-overhang"
DROP = "standing-truss-drop"


def moving(plane: PlaneSection, history: History | None = None) -> list[str]:
    """Return the names of the blocks that move, of those alone whose places a history has."""
    names = [block.name for block in plane.assembly.moving]
    return [name for name in names if history is None or f"{name}.x" in history.columns]


def unbalanced(scene: Scene, history: History) -> Metrics:
    """Return the unbalanced share of the weight at the end, the greatest way of a centroid [m], and the limit."""
    plane = scene.table(PlaneSection)
    columns = history.columns
    ways = [[columns[f"{name}.{part}"] for part in "xy"] for name in moving(plane, history)]
    way = max(math.hypot(x[-1] - x[0], y[-1] - y[0]) for x, y in ways)
    speed = max(math.hypot(x[-1] - x[-2], y[-1] - y[-2]) for x, y in ways) / scene.time.step
    share = float(speed) * (scene.time.gg_rate or 0.0) / math.hypot(*plane.gravity)
    return {"share": share, "way": float(way), "result": "falls" if share > REST else "stands"} | limit_of(scene)


# ---- limits ----


def limit_of(scene: Scene) -> dict[str, Value]:
    """Return the limit of a scene in closed form, and how far it is above it, negative where it stands."""
    quantity, compute = LIMITS[scene.name.partition("[")[0]]
    limit, beyond = compute(scene.table(PlaneSection))
    return {"quantity": quantity, "limit": limit, "beyond": beyond}


def _heights(plane: PlaneSection) -> list[float]:
    """Return the heights of columns that are stated as blocks [m]."""
    outlines = {block.name: np.array(block.vertices) for block in plane.block if not block.fixed}
    return [float(np.ptp(outline[:, 1])) for outline in outlines.values()]


def _keyed(plane: PlaneSection) -> tuple[float, float]:
    heights = _heights(plane)
    limit = keyed_dip(heights[-1], len(heights), 1.0)
    return math.degrees(limit), _dip(plane) / limit - 1


def _dip(plane: PlaneSection) -> float:
    """Return the tilt of gravity from the vertical [rad]."""
    return math.atan2(plane.gravity[0], -plane.gravity[1])


def _stepped(plane: PlaneSection) -> tuple[float, float]:
    columns = plane.columns[0]
    limit = stepped_dip(columns.heights, columns.width, columns.rise, friction_of(plane))
    return math.degrees(limit), math.radians(columns.dip) / limit - 1


def _arch(plane: PlaneSection) -> tuple[float, float]:
    """Least thickness by the linear program, and what springs ask for besides: 1.5 rho g R / p of the radius R.

    An independent program found that for 24 voussoirs; 1/p is so small here that a third of it would not show.
    """
    arch = plane.arch[0]
    stiffness = plane.contact.stiffness if plane.contact else math.inf
    softness = plane.density * math.hypot(*plane.gravity) * arch.radius / stiffness
    limit = least_thickness(arch.radius, arch.voussoirs, arch.chords) + 1.5 * softness * arch.radius
    return limit, 1 - arch.thickness / limit


class Bracket(NamedTuple):
    """What columns with friction between them ask for, by recursion and linear program."""

    recursion: float  # a height [m], or tan(phi)
    program: float
    over_recursion: float  # what they are over that: above 1 it lets them fall
    over_program: float


def bracket_of(plane: PlaneSection) -> Bracket:
    """Return the greatest heights on a flat base, or the least friction of the book's stepped columns."""
    columns = plane.columns[0]
    dip = math.radians(columns.dip)
    mu = friction_of(plane)
    if columns.rise:
        recursion, program = stepped_friction(columns.heights, columns.width, columns.rise, dip)
        return Bracket(recursion, program, recursion / mu, program / mu)
    height = columns.heights[-1]
    recursion, program = flat_height(len(columns.heights), columns.width, dip, mu)
    return Bracket(recursion, program, height / recursion, height / program)


def _bracket(plane: PlaneSection) -> tuple[float, float]:
    bounds = bracket_of(plane)
    return bounds.program, bounds.over_program - 1


def settings(scene: Scene, history: History) -> Metrics:
    """Return how columns with friction between them rest, beside both limits and their springs."""
    plane = scene.table(PlaneSection)
    bounds = bracket_of(plane)
    return {
        **unbalanced(scene, history),
        "recursion": bounds.recursion,
        "over recursion": bounds.over_recursion,
        "over program": bounds.over_program,
        "shear": plane.contact.shear / plane.contact.stiffness if plane.contact else 1.0,
    }


def _overhang(plane: PlaneSection) -> tuple[float, float]:
    pile = plane.stack[0]
    limit = harmonic(pile.count, pile.rectangle[0])
    return limit, (sum(pile.offsets) + pile.rectangle[0] / 2) / limit - 1


def _leaning(plane: PlaneSection) -> tuple[float, float]:
    block = plane.block[0]
    length, thickness = block.rectangle or (math.nan, math.nan)
    limit = leaning_friction(math.radians(block.turned), length / thickness)
    return limit, 1 - friction_of(plane) / limit


def _keystone(plane: PlaneSection) -> tuple[float, float]:
    """A stone that is wider below has no rest on springs without prestress; its lean over the friction's angle."""
    outline = np.array(plane.block[0].vertices)
    first, second = (float(np.ptp(outline[k : k + 2, 0])) for k in (0, 2))
    narrowing = math.atan((first - second) / 2 / float(np.ptp(outline[:, 1])))
    return 0.0, math.copysign(narrowing / math.atan(friction_of(plane)), -narrowing * plane.gravity[1])


LIMITS: Mapping[str, tuple[str, Callable[[PlaneSection], tuple[float, float]]]] = {
    "standing-keyed": ("dip [°]", _keyed),
    "standing-stepped": ("dip [°]", _stepped),
    "standing-flat": ("height [m]", _bracket),
    "standing-book": ("tan φ", _bracket),
    "standing-arch": ("thickness [m]", _arch),
    "standing-arch-24": ("thickness [m]", _arch),
    OVERHANG: ("overhang [m]", _overhang),
    "standing-leaning": ("tan φ", _leaning),
    "standing-keystone": ("lean [°]", _keystone),
}


def verdict(case: Scene) -> Band:
    """Return the unbalanced share of the weight: none below the limit, above at least a tenth of the excess."""
    beyond = or_nan(limit_of(case)["beyond"])
    return (LEVER * min(beyond, 1.0), 1.0) if beyond > 0 else (0.0, REST)


def bracket(case: Scene) -> Band | None:
    """Return the same of columns with friction between them: they stand at 0.8 of the recursion, above it no band."""
    bounds = bracket_of(case.table(PlaneSection))
    return verdict(case) if bounds.over_recursion < 0.81 or bounds.over_program > 1 else None


# ---- columns that turn ----


def turning(scene: Scene, history: History) -> Metrics:
    """Return the angular acceleration of keyed columns over that of rigid ones, less one, at the toe and the top.

    From a parabola through the second half of the history: what springs give in the first instants is a velocity.
    """
    late = history.time > history.time[-1] / 2
    times = history.time[late]
    exact = turned_columns(scene, times)

    def acceleration(angle: Array) -> float:
        return 2 * float(np.polyfit(times, angle[late] if len(angle) > len(times) else angle, 2)[0])

    columns = [-history.columns[f"{name}.angle"] for name in moving(scene.table(PlaneSection))]
    ratios = [acceleration(column) / acceleration(exact) - 1 for column in columns]
    return {"toe": ratios[0], "top": ratios[-1], "turn": exact[-1]}


def turned_columns(scene: Scene, times: Array) -> Array:
    """Return the turn of rigid columns together from rest, all about their lower corners [rad]."""
    plane = scene.table(PlaneSection)
    heights = np.array(_heights(plane))
    dip = _dip(plane)
    gravity = math.hypot(*plane.gravity)

    def rate(_: float, z: Array) -> list[float]:
        a = dip + z[0]
        moment = gravity * float(np.sum(heights * (heights * math.sin(a) - math.cos(a)))) / 2
        return [z[1], 3 * moment / float(np.sum(heights * (heights**2 + 1)))]

    solution = solve_ivp(rate, (0.0, float(times[-1])), [0.0, 0.0], t_eval=times, rtol=1e-11, atol=1e-15)
    turned: Array = solution.y[0]
    return turned


def overlap_of_turning(case: Scene) -> Band:
    """Return what the second order of a turn th changes: 6 th dx/2y of its acceleration, y the lowest column.

    Columns that turn by th come nearer by dx th^2/2, so that one turns by dx th^2/2y more than the next; in th^2 ~ t^4
    a second derivative is six times as large.
    """
    plane = case.table(PlaneSection)
    turn = float(turned_columns(case, np.array([case.time.duration]))[-1])
    half = 6 * turn / (2 * min(_heights(plane)))
    return -half, half


# ---- three blocks that overhang ----


def seats(runs: Runs) -> Metrics:
    """Return the forces at the inner corner of each seat over rigid ones, less one: soft, stiff, in the limit."""
    (soft, softer), (stiff, stiffer), *_ = runs
    pile = soft.table(PlaneSection).stack[0]
    share = (sum(pile.offsets) + pile.rectangle[0] / 2) / harmonic(pile.count, pile.rectangle[0])
    weight = soft.table(PlaneSection).density * math.prod(pile.rectangle) * 9.81
    values = {}
    for number, (_, inner) in enumerate(seat_forces(pile.count, pile.rectangle[0], share), start=1):
        upper = pile.count + 1 - number
        column = f"pile_{upper}.0-" + (f"pile_{upper - 1}.2.normal" if upper > 1 else "table.2.normal")
        ratios = [float(history.columns[column][-1]) / (weight * inner) - 1 for history in (softer, stiffer)]
        times = stiffness_of(stiff) / stiffness_of(soft)
        values[f"soft {number}"] = ratios[0]
        values[f"stiff {number}"] = ratios[1]
        values[f"rigid {number}"] = (times * ratios[1] - ratios[0]) / (times - 1)
    return values


def second_correction() -> Band:
    """Return what is left of forces that are extrapolated in 1/p: the square of the first correction.

    Springs of p tilt each of n blocks by W/(p l) at most, W all their weight, which moves what is above by n h/2 times
    that; over the distance (1 - s) l/2 of the resultant from the edge that is the first correction.
    """
    soft = next(iter(cases(OVERHANG)))
    pile = soft.table(PlaneSection).stack[0]
    length, height = pile.rectangle
    weight = pile.count * soft.table(PlaneSection).density * length * height * 9.81
    share = (sum(pile.offsets) + length / 2) / harmonic(pile.count, length)
    tilt = pile.count * weight / (stiffness_of(soft) * length)
    first = tilt * pile.count * height / 2 / ((1 - share) * length / 2)
    return -(first**2), first**2


# ---- half a truss ----


def at_rest(scene: Scene, history: History) -> Metrics:
    """Return turn and forces at the end over the closed form, less one; and the load over its limit."""
    truss = half_truss(scene)
    load = -2 * sum(one.force[1] for one in scene.table(PlaneSection).load if one.force)
    weight = truss.mass * truss.gravity
    _, most = truss.limit
    turn = -float(history.columns["half.angle"][-1])
    values = {"load": (load + weight) / (most + weight), "turned": turn}
    u, _ = truss.limit
    values["beyond"] = turn - (math.atan2(truss.height, truss.length) - u)
    exact = truss.rest(load)
    if exact is None:
        return values
    measured = {
        "turn": turn,
        "thrust": history.columns["half.0-abutment.1.normal"][-1],
        "shear": abs(float(history.columns["half.0-abutment.1.shear"][-1])),
    }
    return values | {name: value / exact[name] - 1 for name, value in measured.items()}


def settled(case: Scene) -> Band:
    """Return what a damping of rate c leaves after the weight has grown: oscillations fall with exp(-c t/2)."""
    time = case.time.duration - case.table(PlaneSection).ramp
    half = math.exp(-(case.time.gg_rate or 0.0) * time / 2)
    return -half, half


def snaps(case: Scene) -> Band:
    """Return the turn at the end over that of the limit [rad]: beyond it where there is no rest."""
    return (-math.inf, 0.0) if half_truss(case).rest(0.0) else (0.0, math.inf)


def motion_errors(scene: Scene, history: History) -> dict[str, float]:
    """Return the errors at the end of the way of the centre [m] and of the turn [rad]."""
    exact = half_truss(scene).motion(np.array([history.time[-1]]))[0]
    names = ("half.x", "half.y", "half.angle")
    signs = (1.0, 1.0, -1.0)
    x, y, turn = (
        sign * float(history.columns[name][-1]) - float(value)
        for name, sign, value in zip(names, signs, exact, strict=False)
    )
    return {"x": x, "y": y, "turn": turn}


def against_motion(scene: Scene, history: History) -> Metrics:
    """Return these errors, and the residual of the account of energies over the work of the weight."""
    columns = history.columns
    balance = float(np.max(np.abs(columns["energy.balance"])) / np.max(np.abs(columns["energy.load"])))
    errors = motion_errors(scene, history)
    return {**errors, **{f"size {name}": abs(error) for name, error in errors.items()}, "balance": balance}


def drop_orders(runs: Runs) -> Metrics:
    """Return the orders of the errors of the two finest steps."""
    errors = list(itertools.starmap(motion_errors, runs))
    return {name: math.log2(abs(errors[-2][name] / errors[-1][name])) for name in errors[-1]}


def second_order() -> Band:
    """Return 2 -/+ (w h)^2, the next term of the larger step h at the truss's highest frequency w.

    A bound of w: both springs at C and A on the mass that a corner has across, 1/m + (D/2)^2/I = 4/m.
    """
    *_, case, _ = cases(DROP)
    truss = half_truss(case)
    frequency = math.sqrt(4 * (truss.abutment + truss.crown) / truss.mass)
    half = (frequency * case.time.step) ** 2
    return 2 - half, 2 + half
