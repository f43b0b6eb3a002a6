"""The study `toppling`: the cases of the manuals of block codes as numbers, and the growth by first-order rotation.

A block on a slope stands, slides or topples: with friction a tenth of a degree above and below the slope, with half of
the friction that it needs, and as a tower whose centroid stands beyond its lower corner.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping

import numpy as np

from validation.engine.finished import Derived, from_history
from validation.gates.gate import Gate
from validation.runs.history import History
from validation.runs.row import Value
from validation.scenes.scene import Scene
from validation.studies.bands import about, cases, gate
from validation.studies.declaration import Study
from validation.studies.rocking.read import crossing, increments, rectangle, settlement
from validation.theory.friction import coefficient, sliding_acceleration

STATIC = "toppling-static"
SLIDE = "toppling-slide"
FROM_REST = ("toppling-tower", "toppling-threshold")  # on their base
LET_GO = ("toppling-fall", "toppling-growth")  # on their lower corner
ROW = "trajectory"  # derived row
TURN = 0.5  # by which falling blocks are timed [rad]
ROUNDING = 1e-9  # of identities over some hundred steps


def beyond(scene: Scene) -> float:
    """Return the angle of the centroid beyond the vertical through the lower corner at t = 0 [rad]."""
    return math.radians(scene.load.slope - scene.block.tilt) - rectangle(scene).alpha


def static(scene: Scene, history: History) -> Mapping[str, Value]:
    """Return how far the block moves in the second half of its steps, over what it slides, or its width if it stands.

    A step without velocities moves a sliding block by dt^2 / 2 times its acceleration.
    """
    u = history.columns["horizontal_displacement"]
    steps = scene.time.steps
    displacement = float(u[-1] - u[steps // 2 - 1])
    sliding_distance = (steps - steps // 2) * scene.time.step**2 / 2 * sliding_acceleration(scene)
    return {"moved": displacement / (sliding_distance if sliding_distance > 0 else rectangle(scene).width)}


def slide(scene: Scene, history: History) -> Mapping[str, Value]:
    """Return what the sliding identity leaves, and the run-out over that of a rigid block.

    While both corners slip or are open u + tan(phi) v is a t^2 / 2, free motion under a = g (sin b - tan(phi) cos b).
    """
    u = history.columns["horizontal_displacement"]
    v = history.displacement
    sliding_distance = sliding_acceleration(scene) * history.time**2 / 2
    return {
        "identity": float(np.max(np.abs(u + coefficient(scene) * v - sliding_distance)) / sliding_distance[-1]),
        "run-out": float(u[-1] / sliding_distance[-1]),
    }


def fall(scene: Scene, history: History) -> Mapping[str, Value]:
    """Return when a block has turned by `TURN` over a rigid one's time, its greatest turn, and its area."""
    rotation = -history.columns["rotation"]
    values: dict[str, Value] = {"turned": float(np.max(np.abs(rotation)))}
    if beyond(scene) > 0:
        exact = rectangle(scene).fall_time(beyond(scene), TURN)
        values["time"] = crossing(history.time, rotation, TURN) / exact
    if "area" in history.columns:
        expected_area = float(np.prod(1 + increments(history) ** 2)) if scene.run.rotation == "first-order" else 1.0
        values["growth"] = float(history.columns["area"][-1]) - 1
        values["area"] = float(history.columns["area"][-1]) / expected_area
    return values


def derived() -> tuple[Derived, ...]:
    """Return the rows that are computed from finished cases."""
    computed_rows = ((STATIC, static), (SLIDE, slide), *((name, fall) for name in (*FROM_REST, *LET_GO)))
    rows = []
    for name, compute in computed_rows:
        for case in cases(name):
            rows.append(from_history(case, "dda", ROW, compute))
    return tuple(rows)


def gates() -> tuple[Gate, ...]:
    """Return all gates of the study."""
    return (*sliding_gates(), *toppling_gates(), *falling_gates())


def sliding_gates() -> Iterator[Gate]:
    """Yield the gates on a block that stands or slides."""
    stands = "friction above the slope: a block without velocities comes to rest; band: rounding"
    slips = "friction below the slope: dt^2 / 2 g (sin b - tan(phi) cos b) a step; band: what is left of settling"
    for case in cases(STATIC):
        if sliding_acceleration(case) > 0:
            yield gate(case, ROW, "moved", about(1.0, 1e-6), slips)
        else:
            yield gate(case, ROW, "moved", about(0.0, ROUNDING), stands)
    for case in cases(SLIDE):
        sliding_distance = sliding_acceleration(case) * case.time.duration**2 / 2
        offset = coefficient(case) * settlement(case) / sliding_distance
        why = "both corners slip: the free motion of the scheme, exact for constant acceleration; band: rounding"
        yield gate(case, ROW, "identity", (0.0, ROUNDING), why)
        why = "rigid block; above: tan(phi) times the settlement, twice that of both corners at rest"
        yield gate(case, ROW, "run-out", (1.0, 1 + offset), why)


def toppling_gates() -> Iterator[Gate]:
    """Yield the gates on towers that stand on a slope when gravity begins to act."""
    why = (
        "rigid block about its lower corner, by quadrature; below: the impulse of the upper corner before it lifts, "
        "m g cos b pi sqrt(m / 2 p) at most; above: a straight line within a step"
    )
    stands = "tan b < a/h: the tower stands; twice the turn m g / (p a) by which its corners settle"
    for case in cases(*FROM_REST):
        block = rectangle(case)
        if beyond(case) < 0:
            yield gate(case, ROW, "turned", (0.0, 2 * settlement(case) / block.width), stands)
            continue
        exact = block.fall_time(beyond(case), TURN)
        low = 1 - lifted(case) / exact
        high = 1 + straight(case)
        yield gate(case, ROW, "time", (low, high), why)


def lifted(scene: Scene) -> float:
    """Return the time that the impulse of the upper corner can save [s].

    An impulse J gives the turn the rate J a / I, and psi = psi0 cosh(P t) is then ahead by that over psi0 P^2.
    """
    block = rectangle(scene)
    p = scene.contact.stiffness
    m = scene.block.density * block.width * block.height
    impulse = m * block.gravity * math.cos(math.radians(scene.load.slope)) * math.pi * math.sqrt(m / (2 * p))
    inertia = m * (block.width**2 + block.height**2) / 3
    return impulse * block.width / inertia / (beyond(scene) * block.rate2)


def straight(scene: Scene) -> float:
    """Return the error of a straight line within a step, relative to the time of the fall: (dt/T)^2."""
    return (scene.time.step / rectangle(scene).fall_time(beyond(scene), TURN)) ** 2


def falling_gates() -> Iterator[Gate]:
    """Yield the gates on towers released on their lower corner, by exact and by first-order rotation."""
    timed = "rigid block about its lower corner, by quadrature; the corner settles by up to 2 m g / p, seen from psi"
    exact_reason = "exact rotation keeps the outline; band: the strain of four times the weight"
    product = "a step's first-order rotation multiplies the area by 1 + r^2; band: the strain of four times the weight"
    growing = (
        "dt times the integral of the squared rate of a rigid block; band: twice what the growth g itself changes, "
        "P T g / 2 by P^2 ~ 1/R and 3 g / 4 by the centroid, which gets further from the corner and is sped up by it"
    )
    for case in cases(*LET_GO):
        block = rectangle(case)
        grown = growth(case)
        exact = case.run.rotation == "exact"
        strain = 4 * case.block.density * block.gravity * block.height / case.block.young
        slack = 2 * settlement(case) / block.width / beyond(case) + (0.0 if exact else grown) + straight(case)
        yield gate(case, ROW, "time", about(1.0, slack), timed)
        why = exact_reason if exact else product
        yield gate(case, ROW, "area", about(1.0, strain), why)
        if not exact:
            yield gate(case, ROW, "growth", about(grown, 2 * slowed(case) * grown**2 + strain), growing)


def slowed(scene: Scene) -> float:
    """Return P T / 2 + 3/4, by how much of itself the growth lessens the growth [-]."""
    return math.sqrt(rectangle(scene).rate2) * scene.time.duration / 2 + 0.75


def growth(scene: Scene) -> float:
    """Return the growth of the area by first-order rotation of a rigid block, dt times the integral of psi'^2 [-]."""
    return scene.time.step * rectangle(scene).squared_rate(beyond(scene), scene.time.duration)


STUDY = Study(
    name="toppling",
    title="Blocks on slopes that stand, slide and topple",
    purpose="The cases by which manuals of block codes show that a block stands, slides or topples, as numbers: "
    "does DDA do so at the right slope, along the right trajectory, and with the outline that it began with?",
    scenes=(STATIC, SLIDE, *FROM_REST, *LET_GO),
    gates=gates,
    derived=derived,
    measures=(),  # all gates are on the rows above
    pairs=(),
)
