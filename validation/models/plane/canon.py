"""Problems of several blocks, or of one that spins, stops, tips or lands on a corner, for programs of any kind.

Each is a scene of the studies `spin`, `pushing`, `standing` or `touching` without their springs: rigid contact, one
friction where that is enough, and the same exact motions and limits. Answers are positions.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import replace

import numpy as np

from validation.models.plane.blocks import PlacedBlock, centroid
from validation.models.plane.limits import can_rest
from validation.models.plane.posed import EITHER_WAY, PlaneCase, PlaneProblem
from validation.models.plane.tables import PlaneSection
from validation.problems.numbered import UNKNOWN, JudgedNumber, around
from validation.runs.history import Array, History
from validation.scenes.outline import area
from validation.scenes.scene import Scene
from validation.theory.corner_impact import FallingRectangle, rigid_impulse
from validation.theory.first_touch import MovingPolygon, first_touches, normals
from validation.theory.spinning import Slide, Spinning
from validation.theory.truss import HalfTruss
from validation.theory.wedges import Wedges

ACTIVE, PASSIVE = math.radians(50), math.radians(10)  # dips of the planes that the wedges slide on
FALLEN = 0.02  # of the side of a square as large as the smallest block: what stands moves less, on any springs
DEPARTED = 1e-3  # m, by which a block has left its straight path
TURNED = 2 * UNKNOWN  # rad: an edge is turned by it if both its ends are off by one per cent of its length
TOGETHER = 1e-9  # of the time: touches that are one


# ---- the exact problem of a scene -----------------------------------------------------------------------------------


def moving_blocks(scene: Scene) -> list[PlacedBlock]:
    """Return the blocks that move."""
    return [block for block in scene.table(PlaneSection).assembly.blocks if not block.held]


def friction_of(plane: PlaneSection) -> float:
    """Return tan(phi) of contacts, 0 of smooth ones."""
    return (plane.contact.friction_coefficient if plane.contact else None) or 0.0


def stiffness_of(scene: Scene) -> float:
    """Return the normal spring of a corner [N/m]."""
    contact = scene.table(PlaneSection).contact
    return contact.stiffness if contact else math.inf


def extent(block: PlacedBlock) -> tuple[float, float]:
    """Return width and height of a block [m]."""
    width, height = np.ptp(block.vertices, axis=0)
    return float(width), float(height)


def spinning_of(scene: Scene) -> Spinning:
    """Return the exact problem of a block that spins."""
    (block,) = moving_blocks(scene)
    return Spinning(*extent(block), block.density, block.young, block.poisson, block.spin)


def slide_of(scene: Scene) -> Slide:
    """Return the exact problem of a block that slides over a table."""
    (block,) = moving_blocks(scene)
    plane = scene.table(PlaneSection)
    place, _ = centroid(block.vertices)
    return Slide(*extent(block), friction_of(plane), place, block.velocity[0], -plane.gravity[1])


def wedges_of(scene: Scene) -> Wedges:
    """Return the exact problem of an active and a passive wedge."""
    plane = scene.table(PlaneSection)
    assembly = plane.assembly
    rock, passive, active = (assembly.members[name][0] for name in ("rock", "passive", "active"))
    first, second = (plane.density * area(assembly.blocks[block].vertices) for block in (active, passive))
    below, between = (
        (contact.friction_coefficient if contact else None) or 0.0
        for contact in (assembly.springs_between(passive, rock), assembly.springs_between(passive, active))
    )
    return Wedges((first, second), (ACTIVE, PASSIVE), below, between, -plane.gravity[1])


def half_truss(scene: Scene) -> HalfTruss:
    """Return the exact problem of half a truss."""
    plane = scene.table(PlaneSection)
    blocks = {block.name: block for block in plane.block}
    length, height = (float(size) for size in np.ptp(np.array(blocks["half"].vertices), axis=0))
    return HalfTruss(
        length=length,
        height=height,
        mass=plane.density * area(blocks["half"].outline),
        turned=-math.radians(blocks["half"].turned),
        place=blocks["half"].at,
        span=min(x for x, _ in blocks["crown"].outline),
        abutment=stiffness_of(scene),
        crown=plane.pair[0].stiffness or math.inf,
        gravity=-plane.gravity[1],
    )


def falling(scene: Scene) -> FallingRectangle:
    """Return the exact problem of a rectangle that lands on a corner."""
    plane = scene.table(PlaneSection)
    block = next(block for block in plane.block if not block.fixed)
    width, height = block.rectangle or (math.nan, math.nan)
    return FallingRectangle(
        width=width,
        height=height,
        mass=plane.density * width * height,
        place=block.at,
        angle=math.radians(block.turned),
        velocity=block.velocity,
        spin=block.spin,
        gravity=-plane.gravity[1],
    )


def polygons(scene: Scene) -> tuple[MovingPolygon, MovingPolygon]:
    """Return the two blocks of a scene as moving polygons about their centroids."""
    bodies = []
    for block in scene.table(PlaneSection).assembly.blocks:
        middle = centroid(block.vertices)
        bodies.append(MovingPolygon(np.array(block.vertices) - middle, middle, block.velocity, block.spin))
    first, second = bodies
    return first, second


# ---- what is measured on answers ------------------------------------------------------------------------------------


def moved(history: History, block: PlacedBlock) -> Array:
    """Return how far the centroid of a block has moved since t = 0, shape (rows, 2) [m]."""
    place: Array = np.column_stack([history.columns[f"{block.name}.{part}"] for part in "xy"])
    return place - centroid(block.vertices)


def falls(scene: Scene) -> tuple[JudgedNumber, ...]:
    """Return whether blocks move that no forces between them hold."""
    plane = scene.table(PlaneSection)
    blocks = plane.assembly.blocks
    mu = plane.contact.friction_coefficient if plane.contact else 0.0
    rests = can_rest([block.vertices for block in blocks], [block.held for block in blocks], mu, plane.gravity)
    moving = moving_blocks(scene)
    least = FALLEN * math.sqrt(min(area(block.vertices) for block in moving))

    def measure(history: History) -> float:
        return float(max(np.linalg.norm(moved(history, block)[-1]) for block in moving) > least)

    exact = float(not rests)
    reason = f"1 where a centroid has moved by more than {least:.3g} m; the limit is five per cent of a datum away"
    return (JudgedNumber("falls", "1", exact, exact, exact, 1.0, reason, measure),)


def _distance(
    name: str, block: PlacedBlock, along: Sequence[float], exact: float, changed: Sequence[float]
) -> JudgedNumber:
    """Return a way along a direction in the end [m], that one per cent of tan(phi) changes."""
    reason = "one per cent of tan(phi), which is not known better, changes it by as much"
    return around(name, "m", exact, changed, reason, measure=lambda history: float(moved(history, block)[-1] @ along))


def stopping(scene: Scene) -> tuple[JudgedNumber, ...]:
    """Return how far a block slides to rest."""
    slide = slide_of(scene)
    (block,) = moving_blocks(scene)
    changed = [replace(slide, friction=factor * slide.friction).stopping_distance for factor in EITHER_WAY]
    return (_distance("distance to rest", block, (1.0, 0.0), slide.stopping_distance, changed),)


def ledge(scene: Scene) -> tuple[JudgedNumber, ...]:
    """Return how far a block has turned on a ledge, or where it stops before."""
    slide = slide_of(scene)
    if slide.tips is None:
        return stopping(scene)
    (block,) = moving_blocks(scene)
    end = scene.time.duration
    turns = [replace(slide, friction=factor * slide.friction).turn(end) for factor in (1.0, *EITHER_WAY)]
    return (
        around(
            "turn over the ledge",
            "rad",
            turns[0],
            turns[1:],
            "one per cent of tan(phi), which is not known better, changes it by as much",
            measure=lambda history: -float(history.columns[f"{block.name}.angle"][-1]),
        ),
    )


def pushing(scene: Scene) -> tuple[JudgedNumber, ...]:
    """Return how far two blocks slide that start together, the upper one with less friction."""
    plane = scene.table(PlaneSection)
    assembly = plane.assembly
    along, across = plane.gravity
    ground = next(number for number, block in enumerate(assembly.blocks) if block.held)
    weights = []
    for number, block in enumerate(assembly.blocks):
        if not block.held:
            springs = assembly.springs_between(number, ground)
            weights.append((area(block.vertices), (springs.friction_coefficient if springs else None) or 0.0))
    mean = sum(weight * mu for weight, mu in weights) / sum(weight for weight, _ in weights)
    ways = [(along + factor * mean * across) * scene.time.duration**2 / 2 for factor in (1.0, *EITHER_WAY)]
    names = [f"distance slid, {block.name}" for block in moving_blocks(scene)]
    pairs = zip(names, moving_blocks(scene), strict=True)
    return tuple(_distance(name, block, (1.0, 0.0), ways[0], ways[1:]) for name, block in pairs)


def wedges(scene: Scene) -> tuple[JudgedNumber, ...]:
    """Return the accelerations of two wedges that slide, over the last two thirds: put on at once, weight rings."""
    exact = wedges_of(scene)
    motions = [replace(exact, below=f * exact.below, between=f * exact.between).motion() for f in (1.0, *EITHER_WAY)]
    numbers = []
    for block in moving_blocks(scene):
        dip = {"active": ACTIVE, "passive": PASSIVE}[block.name]
        direction = (-math.cos(dip), -math.sin(dip))

        def acceleration(history: History, block: PlacedBlock = block, down: Sequence[float] = direction) -> float:
            late = history.time > history.time[-1] / 3
            return 2 * float(np.polyfit(history.time[late], (moved(history, block) @ down)[late], 2)[0])

        rates = [motion[block.name] for motion in motions]
        why = "one per cent of tan(phi), which is not known better, changes it by as much"
        numbers.append(around(f"acceleration, {block.name}", "m/s2", rates[0], rates[1:], why, measure=acceleration))
    return tuple(numbers)


def spinning(scene: Scene) -> tuple[JudgedNumber, ...]:
    """Return by how much an elastic block lags behind a rigid one."""
    (block,) = moving_blocks(scene)
    exact = spinning_of(scene)
    times = np.linspace(0.0, scene.time.duration, 1 + scene.time.steps)
    rigid = block.angle + block.spin * scene.time.duration
    bodies = [replace(exact, young=factor * exact.young) for factor in (1.0, *EITHER_WAY)]
    lags = [block.spin * scene.time.duration - float(body.at(times)["angle"][-1]) for body in bodies]
    return (
        around(
            "angle behind a rigid block",
            "rad",
            lags[0],
            lags[1:],
            "one per cent of Young's modulus, which is not known better, changes it by as much",
            measure=lambda history: rigid - float(history.columns[f"{block.name}.angle"][-1]),
        ),
    )


def truss(scene: Scene) -> tuple[JudgedNumber, ...]:
    """Return where half a truss is that drops on its springs."""
    (block,) = moving_blocks(scene)
    exact = half_truss(scene)
    ways = []
    for factor in (1.0, *EITHER_WAY):
        body = replace(exact, abutment=factor * exact.abutment, crown=factor * exact.crown)
        start, end = body.motion(np.array([0.0, scene.time.duration]))
        ways.append((float(start[1] - end[1]), float(end[2] - start[2])))
    why = "one per cent of the stiffness of its springs, which is not known better, changes it by as much"
    sunk, turned = ([way[number] for way in ways] for number in (0, 1))
    angle = f"{block.name}.angle"

    def turn(history: History) -> float:
        return block.angle - float(history.columns[angle][-1])

    return (
        around("sinking", "m", sunk[0], sunk[1:], why, measure=lambda history: -float(moved(history, block)[-1][1])),
        around("turn", "rad", turned[0], turned[1:], why, measure=turn),
    )


def corner(scene: Scene) -> tuple[JudgedNumber, ...]:
    """Return speed and spin with which a rectangle leaves a smooth impact of a corner."""
    (block,) = moving_blocks(scene)
    body = falling(scene)
    time, number = body.landing(scene.time.duration)
    landed = body.flown(time)
    _, impulse = rigid_impulse(body, 0.0, scene.time.duration)
    arm = float(landed.arms(landed.angle)[number][0])
    approach = abs(landed.velocity[1] + landed.spin * arm)
    why = "one per cent of the speed of the corner as it lands: no rebound is known better"

    def number_of(
        name: str, unit: str, exact: float, scale: float, measure: Callable[[History], float]
    ) -> JudgedNumber:
        return JudgedNumber(name, unit, exact, exact - UNKNOWN * scale, exact + UNKNOWN * scale, scale, why, measure)

    def rate(history: History, part: str) -> float:
        half = len(history.time) // 2
        values = history.columns[f"{block.name}.{part}"]
        return float((values[-1] - values[half]) / (history.time[-1] - history.time[half]))

    def speed(history: History) -> float:
        middle = (history.time[-1] + history.time[len(history.time) // 2]) / 2
        return rate(history, "y") + body.gravity * float(middle - time)

    return (
        number_of("speed upwards", "m/s", landed.velocity[1] + impulse / body.mass, approach, speed),
        number_of(
            "spin",
            "rad/s",
            landed.spin + impulse * arm / body.inertia,
            approach / abs(arm),
            lambda history: rate(history, "angle"),
        ),
    )


def touching(scene: Scene) -> tuple[JudgedNumber, ...]:
    """Return when two blocks touch first and which way the first one is pushed, or whether they touch."""
    until = scene.time.duration
    first, second = polygons(scene)
    touches = first_touches(first, second, until, TOGETHER * until)
    block = scene.table(PlaneSection).assembly.blocks[0]

    def departure(history: History) -> tuple[int, Array]:
        """Return the first row at which the block has left its straight path, and how far it is off there."""
        off = moved(history, block) - history.time[:, None] * np.array(block.velocity)
        rows = np.flatnonzero(np.linalg.norm(off, axis=1) > DEPARTED)
        row = int(rows[0]) if len(rows) else len(off)
        return row, off[min(row, len(off) - 1)]

    def touched(history: History) -> float:
        return float(departure(history)[0] < len(history.time))

    if not touches:
        return (JudgedNumber("touches", "1", 0.0, 0.0, 0.0, 1.0, "they pass each other", touched),)
    touch = touches[0]
    low, high = normals(first, second, touch)

    def time(history: History) -> float | None:
        row, _ = departure(history)
        return float(history.time[row]) if row < len(history.time) else None

    def beside(history: History) -> float:
        _, off = departure(history)
        return math.remainder(math.atan2(off[1], off[0]) - (low + high) / 2, math.tau)

    return (
        JudgedNumber(
            "first row after the touch",
            "s",
            touch.time,
            (1 - UNKNOWN) * touch.time,
            (1 + UNKNOWN) * touch.time + 2 * scene.time.step,
            touch.time,
            "one per cent of the speeds, and two rows, in which it leaves its path by a millimetre",
            time,
        ),
        JudgedNumber(
            "push beside the normal of the edge that is hit",
            "rad",
            0.0,
            (low - high) / 2 - TURNED,
            (high - low) / 2 + TURNED,
            1.0,
            "both ends of the edge are known to one per cent of its length",
            beside,
        ),
    )


CANON_ASKS = {
    "stopping": "A box that slides to rest: how far?",
    "ledge": "A box that slides over the end of a table: when does it tip, and does one that is slower stop?",
    "spinning": "An elastic block that is set spinning: which angle does its centrifugal strain cost?",
    "pushing": "Two blocks on a slope, the upper one with less friction: how far do they slide together?",
    "wedges": "A wedge that drives another one out: how far do both slide?",
    "safety": "The same wedges about their factor of safety of 1: do they stand?",
    "columns": "Five columns on a stepped base: do they stand?",
    "arch": "A semicircular arch of seven straight voussoirs: does it stand?",
    "overhang": "Three blocks that overhang a table: do they stand?",
    "leaning": "A block that leans on a wall as rough as the floor: does it stand?",
    "truss": "Half a truss that drops on its springs: where is it after 0.1 s?",
    "corner": "A rectangle that lands on a corner without friction or loss: how does it leave?",
    "touch-pentagon": "A triangle and a pentagon fly at each other: when do they touch, and which edge is hit?",
    "touch-clip": "A diamond that clips the corner of a square: when, and does its own edge turn it?",
    "touch-fast": "A triangle that turns fast clips the corner of a square: when, and with which edge?",
    "touch-miss": "A diamond that passes a square: do they touch?",
}


def canon_problems() -> tuple[PlaneProblem, ...]:
    """Return the problems, each with the cases beside its own scene."""
    thinner = [{"name": "arch", "radius": 10.0, "thickness": 0.9092, "voussoirs": 7}]
    farther = [{"name": "pile", "count": 3, "rectangle": [2.0, 0.5], "offsets": [-0.65, 0.525, 1.05]}]
    steeper = [{"name": "column", "width": 1.0, "heights": [2, 4, 4, 4, 4], "dip": 28.13, "rise": 1.0}]
    return (
        PlaneProblem("stopping", stopping, changeable=("contact.friction", "gravity")),
        PlaneProblem("ledge", ledge, (PlaneCase("tan 0.55", {"plane.contact.friction": 28.810793742973}),)),
        PlaneProblem("spinning", spinning, changeable=("young", "density", "poisson")),
        PlaneProblem("pushing", pushing, changeable=("gravity", "pair")),
        PlaneProblem("wedges", wedges, changeable=("contact.friction",)),
        PlaneProblem("safety", falls, (PlaneCase("less friction", {"plane.contact.friction": 28.14}),)),
        PlaneProblem("columns", falls, (PlaneCase("steeper", {"plane.columns": steeper}),)),
        PlaneProblem("arch", falls, (PlaneCase("thinner", {"plane.arch": thinner}),)),
        PlaneProblem("overhang", falls, (PlaneCase("farther", {"plane.stack": farther}),)),
        PlaneProblem("leaning", falls, (PlaneCase("less friction", {"plane.contact.friction": 11.12}),)),
        PlaneProblem("truss", truss, changeable=("contact.stiffness", "density")),
        PlaneProblem("corner", corner),
        *(PlaneProblem(f"touch-{name}", touching) for name in ("pentagon", "clip", "fast", "miss")),
    )
