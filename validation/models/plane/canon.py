"""Problems of several blocks, or of one that spins, stops, tips or lands on a corner, for programs of any kind.

Each is a scene of the studies `spin`, `pushing`, `standing` or `touching` without their springs: rigid contact, one
friction where that is enough, and the same exact motions and limits. Answers are positions.
"""

from __future__ import annotations

import functools
import math
from collections.abc import Callable, Sequence
from dataclasses import replace

import numpy as np

from validation.models.plane.assembly import Assembly
from validation.models.plane.blocks import PlacedBlock
from validation.models.plane.joints import PlaneContactSection
from validation.models.plane.limits import can_rest
from validation.models.plane.posed import FRICTION, decided, varied, within
from validation.models.plane.tables import PlaneSection
from validation.problems.numbered import UNKNOWN, JudgedNumber
from validation.runs.history import Array, History
from validation.scenes.outline import area
from validation.scenes.scene import Scene
from validation.theory.corner_impact import FallingRectangle, rigid_impulse
from validation.theory.first_touch import FirstTouch, MovingPolygon, first_touches
from validation.theory.spinning import Slide, Spinning
from validation.theory.truss import HalfTruss
from validation.theory.wedges import Wedges

ACTIVE, PASSIVE = math.radians(50), math.radians(10)  # dips of the planes that the wedges slide on
FALLEN = 0.02  # of the side of a square as large as the smallest block: what stands moves less, on any springs
DEPARTED = 1e-3  # m, by which a block has left its straight path
TURNED = 2 * UNKNOWN  # rad: an edge is turned by it if both its ends are off by one per cent of its length


# ---- the exact problem of a scene ----


def moving_blocks(scene: Scene) -> list[PlacedBlock]:
    """Return the blocks that move."""
    return scene.table(PlaneSection).assembly.moving


def friction_of(plane: PlaneSection) -> float:
    """Return tan(phi) of contacts, 0 of smooth ones."""
    return (plane.contact.friction_coefficient if plane.contact else None) or 0.0


def rough(assembly: Assembly, first: int, second: int) -> float:
    """Return tan(phi) between two blocks, 0 where they are smooth."""
    springs = assembly.springs_between(first, second)
    return (springs.friction_coefficient if springs else None) or 0.0


def contact_of(scene: Scene) -> PlaneContactSection:
    """Return the contact of a scene, a rigid one where it states none."""
    return scene.table(PlaneSection).contact or PlaneContactSection(stiffness=math.inf)


def stiffness_of(scene: Scene) -> float:
    """Return the normal spring of a corner [N/m]."""
    return contact_of(scene).stiffness


def extent(block: PlacedBlock) -> tuple[float, float]:
    """Return width and height of a block [m]."""
    width, height = np.ptp(block.corners, axis=0).tolist()
    return width, height


def spinning_of(scene: Scene) -> Spinning:
    """Return the exact problem of a block that spins."""
    (block,) = moving_blocks(scene)
    return Spinning(*extent(block), block.density, block.young, block.poisson, block.spin)


def slide_of(scene: Scene) -> Slide:
    """Return the exact problem of a block that slides over a table."""
    (block,) = moving_blocks(scene)
    plane = scene.table(PlaneSection)
    place, _ = block.centroid
    return Slide(*extent(block), friction_of(plane), place, block.velocity[0], -plane.gravity[1])


def wedges_of(scene: Scene) -> Wedges:
    """Return the exact problem of an active and a passive wedge."""
    plane = scene.table(PlaneSection)
    assembly = plane.assembly
    rock, passive, active = (assembly.members[name][0] for name in ("rock", "passive", "active"))
    first, second = (plane.density * area(assembly.blocks[block].vertices) for block in (active, passive))
    below, between = (rough(assembly, passive, other) for other in (rock, active))
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
        middle = block.centroid
        bodies.append(MovingPolygon(block.corners - middle, middle, block.velocity, block.spin))
    first, second = bodies
    return first, second


def touch_of(scene: Scene) -> FirstTouch | None:
    """Return the first touch of the two blocks of a scene."""
    return next(iter(first_touches(*polygons(scene), scene.time.duration, 0.0)), None)


# ---- what is measured on answers ----


def moved(history: History, block: PlacedBlock) -> Array:
    """Return how far the centroid of a block has moved since t = 0, shape (rows, 2) [m]."""
    place: Array = np.column_stack([history.columns[f"{block.name}.{part}"] for part in "xy"])
    return place - block.centroid


def falls(scene: Scene) -> tuple[JudgedNumber, ...]:
    """Return whether blocks move that no forces between them hold."""
    plane = scene.table(PlaneSection)
    blocks = plane.assembly.blocks
    mu = contact_of(scene).friction_coefficient
    rests = can_rest([block.vertices for block in blocks], [block.held for block in blocks], mu, plane.gravity)
    moving = moving_blocks(scene)
    least = FALLEN * math.sqrt(min(block.area for block in moving))

    reason = f"1 where a centroid has moved by more than {least:.3g} m; the limit is five per cent of a datum away"
    return (
        decided(
            "falls",
            not rests,
            reason,
            lambda history: bool(max(np.linalg.norm(moved(history, block)[-1]) for block in moving) > least),
        ),
    )


def _distance(name: str, block: PlacedBlock, way: Callable[[float], float]) -> JudgedNumber:
    """Return a way along x in the end [m], by a factor on tan(phi)."""
    return varied(name, "m", way, FRICTION, lambda history: float(moved(history, block)[-1] @ (1.0, 0.0)))


def stopping(scene: Scene) -> tuple[JudgedNumber, ...]:
    """Return how far a block slides to rest."""
    slide = slide_of(scene)
    (block,) = moving_blocks(scene)
    name = "distance to rest"
    return (_distance(name, block, lambda f: replace(slide, friction=f * slide.friction).stopping_distance),)


def ledge(scene: Scene) -> tuple[JudgedNumber, ...]:
    """Return how far a block has turned on a ledge, or where it stops before."""
    slide = slide_of(scene)
    if slide.tips is None:
        return stopping(scene)
    (block,) = moving_blocks(scene)
    return (
        varied(
            "turn over the ledge",
            "rad",
            lambda factor: replace(slide, friction=factor * slide.friction).turn(scene.time.duration),
            FRICTION,
            lambda history: -float(history.columns[f"{block.name}.angle"][-1]),
        ),
    )


def pushing(scene: Scene) -> tuple[JudgedNumber, ...]:
    """Return how far two blocks slide that start together, the upper one with less friction."""
    plane = scene.table(PlaneSection)
    assembly = plane.assembly
    along, across = plane.gravity
    ground = next(number for number, block in enumerate(assembly.blocks) if block.held)
    numbers = [number for number, block in enumerate(assembly.blocks) if not block.held]
    grips = [assembly.blocks[number].area * rough(assembly, number, ground) for number in numbers]
    mean = sum(grips) / sum(block.area for block in assembly.moving)
    return tuple(
        _distance(
            f"distance slid, {block.name}", block, lambda f: (along + f * mean * across) * scene.time.duration**2 / 2
        )
        for block in assembly.moving
    )


def wedges(scene: Scene) -> tuple[JudgedNumber, ...]:
    """Return the accelerations of two wedges that slide, over the last two thirds, as weight rings at first."""
    exact = wedges_of(scene)
    numbers = []
    for block in moving_blocks(scene):
        dip = {"active": ACTIVE, "passive": PASSIVE}[block.name]
        direction = (-math.cos(dip), -math.sin(dip))

        def rate(f: float, name: str = block.name) -> float:
            return replace(exact, below=f * exact.below, between=f * exact.between).motion()[name]

        def acceleration(history: History, block: PlacedBlock = block, down: Sequence[float] = direction) -> float:
            late = history.time > history.time[-1] / 3
            return 2 * float(np.polyfit(history.time[late], (moved(history, block) @ down)[late], 2)[0])

        numbers.append(varied(f"acceleration, {block.name}", "m/s2", rate, FRICTION, acceleration))
    return tuple(numbers)


def spinning(scene: Scene) -> tuple[JudgedNumber, ...]:
    """Return by how much an elastic block lags behind a rigid one."""
    (block,) = moving_blocks(scene)
    exact = spinning_of(scene)
    times = np.linspace(0.0, scene.time.duration, 1 + scene.time.steps)
    turn = block.spin * scene.time.duration
    rigid = block.angle + turn
    return (
        varied(
            "angle behind a rigid block",
            "rad",
            lambda factor: turn - float(replace(exact, young=factor * exact.young).at(times)["angle"][-1]),
            "Young's modulus, which is not known better,",
            lambda history: rigid - float(history.columns[f"{block.name}.angle"][-1]),
        ),
    )


def truss(scene: Scene) -> tuple[JudgedNumber, ...]:
    """Return where half a truss is that drops on its springs."""
    (block,) = moving_blocks(scene)
    exact = half_truss(scene)

    @functools.cache
    def way(factor: float) -> Array:
        body = replace(exact, abutment=factor * exact.abutment, crown=factor * exact.crown)
        start, end = body.motion(np.array([0.0, scene.time.duration]))
        return np.asarray(np.subtract(end, start))

    datum = "the stiffness of its springs, which is not known better,"
    angle = f"{block.name}.angle"
    return (
        varied("sinking", "m", lambda f: -float(way(f)[1]), datum, lambda h: -float(moved(h, block)[-1][1])),
        varied("turn", "rad", lambda f: float(way(f)[2]), datum, lambda h: block.angle - float(h.columns[angle][-1])),
    )


def corner(scene: Scene) -> tuple[JudgedNumber, ...]:
    """Return speed and spin with which a rectangle leaves a smooth impact of a corner."""
    (block,) = moving_blocks(scene)
    body = falling(scene)
    time, number = body.landing(scene.time.duration)
    landed = body.flown(time)
    _, impulse = rigid_impulse(body, 0.0, scene.time.duration)
    arm = landed.arm(number)[0]
    approach = abs(landed.velocity[1] + landed.spin * arm)
    why = "one per cent of the speed of the corner as it lands: no rebound is known better"
    vertical = landed.velocity[1] + impulse / body.mass
    spin = landed.spin + impulse * arm / body.inertia

    def rate(history: History, part: str) -> float:
        half = len(history.time) // 2
        values = history.columns[f"{block.name}.{part}"]
        return float((values[-1] - values[half]) / (history.time[-1] - history.time[half]))

    def speed(history: History) -> float:
        middle = (history.time[-1] + history.time[len(history.time) // 2]) / 2
        return rate(history, "y") + body.gravity * float(middle - time)

    return (
        within("speed upwards", "m/s", vertical, approach, why, speed),
        within("spin", "rad/s", spin, approach / abs(arm), why, lambda history: rate(history, "angle")),
    )


def touching(scene: Scene) -> tuple[JudgedNumber, ...]:
    """Return when two blocks touch first and which way the first one is pushed, or whether they touch."""
    touch = touch_of(scene)
    block = scene.table(PlaneSection).assembly.blocks[0]

    def departure(history: History) -> tuple[int, Array]:
        """Return the first row at which the block has left its straight path, and by how much."""
        off = moved(history, block) - history.time[:, None] * np.array(block.velocity)
        rows = np.flatnonzero(np.linalg.norm(off, axis=1) > DEPARTED)
        row = int(rows[0]) if len(rows) else len(off)
        return row, off[min(row, len(off) - 1)]

    if touch is None:
        return (decided("touches", False, "they pass each other", lambda h: departure(h)[0] < len(h.time)),)

    def time(history: History) -> float | None:
        row, _ = departure(history)
        return float(history.time[row]) if row < len(history.time) else None

    def beside(history: History) -> float:
        _, off = departure(history)
        return math.remainder(math.atan2(off[1], off[0]) - touch.normal, math.tau)

    earliest = (1 - UNKNOWN) * touch.time
    latest = (1 + UNKNOWN) * touch.time + 2 * scene.time.step
    path = "one per cent of the speeds, and two rows, in which it leaves its path by a millimetre"
    ends = "both ends of the edge are known to one per cent of its length"
    push = "push beside the normal of the edge that is hit"
    return (
        JudgedNumber("first row after the touch", "s", touch.time, earliest, latest, touch.time, path, time),
        JudgedNumber(push, "rad", 0.0, -TURNED, TURNED, 1.0, ends, beside),
    )


CANON_NUMBERS = (stopping, ledge, pushing, wedges, falls, spinning, truss, corner, touching)
