"""The problems of boxes on a ground: what is measured on an answer, its exact value, and the band around it.

An answer is positions. Its numbers are held against closed forms (`validation.theory.boxes`), and the bands are what
one per cent of a datum changes: data of a body and its contact are not known to better than that, an error below it
changes nothing for who uses the answer.
"""

from __future__ import annotations

import functools
import math
import re
from collections.abc import Callable, Iterator, Mapping
from typing import Any

import numpy as np

from validation.diagnosis.numbers import Values
from validation.errors import InputError
from validation.models.plane import measures
from validation.models.plane.blocks import centroid
from validation.models.plane.boxes import BoxesOnGround, boxes_of
from validation.models.plane.canon import CANON_ASKS, canon_problems
from validation.models.plane.posed import EITHER_WAY, PREFIX, PlaneCase, PlaneProblem, own_scene
from validation.models.plane.tables import PlaneSection
from validation.problems.numbered import UNKNOWN, JudgedNumber, around
from validation.problems.problem import Problem, ProblemHooks
from validation.runs.columns import unit_of
from validation.runs.history import Array, History
from validation.runs.units import ratios
from validation.scenes.scene import Scene
from validation.theory.boxes import (
    ShakenBox,
    SpringImpact,
    critical_spin,
    greatest_rotation,
    sliding_acceleration,
)
from validation.theory.rocking import Rectangle

FIRST_ROW = 0.3  # relative, of the height of a box: what it may have changed by at the first row
BOX = "plane.block.1"  # the first box of a scene, after its ground
MINUTE = 60.0  # s
SETTLED = 0.5  # s after a landing: what moves away then has rebounded


# ---- standing -------------------------------------------------------------------------------------------------------


def standing(scene: Scene) -> tuple[JudgedNumber, ...]:
    """Return the creep of a box that stands on a slope, or how far one slides that does not."""
    ground = boxes_of(scene)
    box = ground.boxes[0]
    if ground.friction > ground.slope:
        allowed = 1e3 * UNKNOWN * box.width / MINUTE
        return (
            JudgedNumber(
                "creep",
                "mm/s",
                exact=0.0,
                low=0.0,
                high=allowed,
                scale=allowed / UNKNOWN,
                reason="it stands exactly; the place of a block is known to one per cent of its width, and a creep "
                "that moves it further in a minute changes the answer",
                measure=lambda history: 1e3 * measures.creep(history, box),
            ),
        )
    duration = scene.time.duration
    distances = []
    for factor in (1.0, *EITHER_WAY):
        friction = math.degrees(math.atan(factor * ground.friction_coefficient))
        distances.append(sliding_acceleration(ground.slope, friction, ground.gravity) * duration**2 / 2)
    return (
        around(
            "distance slid",
            "m",
            distances[0],
            distances[1:],
            "one per cent of tan(phi), which is not known better, moves it as far",
            measure=lambda history: float(measures.column(history, box, "x")[-1] - box.x),
        ),
    )


FRICTIONS = (19.0, 19.8, 20.2, 20.5, 21.0, 25.0, 30.0)  # deg, on a slope of 20; 1 % of tan(phi) is 0.18 deg there
STANDING_CASES = tuple(
    PlaneCase(f"friction {friction:g} deg", {"plane.contact.friction": friction, "time.steps": 40})
    for friction in FRICTIONS
)


# ---- bounces --------------------------------------------------------------------------------------------------------


def restitution(scene: Scene) -> tuple[JudgedNumber, ...]:
    """Return the rebound over the speed of a landing without weight."""
    ground = boxes_of(scene)
    box = ground.boxes[0]
    speed = -box.velocity[1]
    landing = box.lift / speed
    rebound = ground.rebound
    return (
        JudgedNumber(
            "restitution",
            "1",
            exact=rebound,
            low=rebound - UNKNOWN,
            high=rebound + UNKNOWN,
            scale=1.0,
            reason="one per cent of the speed of landing: no rebound is known better",
            measure=lambda history: measures.speed_between(history, box, "y", landing + SETTLED) / speed,
        ),
    )


RESTITUTIONS = (0.0, 0.5, 1.0)
SPEEDS = (0.1, 1.0, 5.0)  # m/s; programs leave restitution away below a threshold, most often from 0.2 to 1 m/s
LANDING = 0.2625  # s after t = 0: in the middle of a row and of the steps of the curves' first runs


def _restitution_cases() -> tuple[PlaneCase, ...]:
    cases = []
    half_height = boxes_of(own_scene("restitution")).boxes[0].height / 2
    for e in RESTITUTIONS:
        for speed in SPEEDS:
            if (e, speed) == (0.5, 1.0):  # the problem's own scene
                continue
            thrown = {f"{BOX}.at": [0.0, half_height + LANDING * speed], f"{BOX}.velocity": [0.0, -speed]}
            cases.append(PlaneCase(f"e = {e:g}, {speed:g} m/s", {"plane.contact.restitution": e, **thrown}))
    return tuple(cases)


def _energy(scene: Scene) -> tuple[JudgedNumber, JudgedNumber]:
    ground = boxes_of(scene)
    first = measures.first_energy(ground)
    reason = "one per cent of the height of the drop, which is not known better, changes the energy by as much"
    return (
        JudgedNumber(
            "energy in the end over that at the start",
            "1",
            exact=1.0,
            low=1.0 - UNKNOWN,
            high=1.0 + UNKNOWN,
            scale=1.0,
            reason=reason,
            measure=lambda history: measures.last_energy(history, ground) / first,
        ),
        JudgedNumber(
            "largest gain of energy",
            "1",
            exact=0.0,
            low=0.0,
            high=UNKNOWN,
            scale=1.0,
            reason=reason,
            measure=lambda history: measures.largest_gain(history, ground),
        ),
    )


def bouncing(scene: Scene) -> tuple[JudgedNumber, ...]:
    """Return the energy of a box that bounces without loss."""
    return _energy(scene)


def tumbling(scene: Scene) -> tuple[JudgedNumber, ...]:
    """Return energy and momentum along the ground of a box that tumbles without friction or loss.

    Its motion is chaotic; these are not.
    """
    ground = boxes_of(scene)
    box = ground.boxes[0]
    landing_speed = math.sqrt(2 * ground.gravity * box.lift)
    return (
        *_energy(scene),
        JudgedNumber(
            "change of the speed along the ground",
            "m/s",
            exact=0.0,
            low=0.0,
            high=UNKNOWN * landing_speed,
            scale=landing_speed,
            reason="without friction nothing acts along the ground; one per cent of the speed of landing is what a "
            "coefficient of friction of 0.01 takes in one impact",
            measure=lambda history: abs(
                measures.speed_between(history, box, "x", scene.time.duration - measures.LATE) - box.velocity[0]
            ),
        ),
    )


# ---- piles ----------------------------------------------------------------------------------------------------------


def pile(scene: Scene) -> tuple[JudgedNumber, ...]:
    """Return how far the uppermost of some boxes at rest moves, and the force below the lowest."""
    ground = boxes_of(scene)
    top = ground.boxes[-1]
    height = top.y + top.reach
    width = min(box.width for box in ground.boxes)
    weight = sum(box.mass for box in ground.boxes) * ground.gravity
    drift = 1e3 * UNKNOWN * width
    sinking = 1e3 * UNKNOWN * height

    def force(history: History) -> float | None:
        values = history.columns.get(ground.force_columns[0])
        if values is None or not np.isfinite(values).all():
            return None
        late = -max(1, len(values) // 10)
        return float(np.mean(values[late:]))

    return (
        JudgedNumber(
            "drift of the top",
            "mm",
            exact=0.0,
            low=0.0,
            high=drift,
            scale=drift / UNKNOWN,
            reason="it stands exactly; the place of a block is known to one per cent of its width",
            measure=lambda history: 1e3 * float(np.max(np.abs(measures.column(history, top, "x") - top.x))),
        ),
        JudgedNumber(
            "sinking of the top",
            "mm",
            exact=0.0,
            low=-sinking,
            high=sinking,
            scale=sinking / UNKNOWN,
            reason="rigid boxes do not sink; the height of what is piled up is known to one per cent",
            measure=lambda history: 1e3 * float(top.y - measures.column(history, top, "y")[-1]),
        ),
        JudgedNumber(
            "force below the lowest box",
            "N",
            exact=weight,
            low=(1 - UNKNOWN) * weight,
            high=(1 + UNKNOWN) * weight,
            scale=weight,
            reason="the weight above it, which one per cent of the density changes by as much; mean of the last tenth",
            measure=force,
            optional=True,
        ),
    )


LIGHT = 10.0  # kg/m3, of the lower box
RATIOS = (1, 10, 1000)  # of the mass of the upper box to that of the lower one; 100 is the problem's own


def _heavy_top_cases() -> tuple[PlaneCase, ...]:
    return tuple(PlaneCase(f"mass ratio {ratio}", {"plane.block.2.density": LIGHT * ratio}) for ratio in RATIOS)


# ---- toppling -------------------------------------------------------------------------------------------------------


def rectangle_of(ground: BoxesOnGround) -> Rectangle:
    """Return the lowest box."""
    box = ground.boxes[0]
    return Rectangle(box.width, box.height, ground.gravity)


def _rotation(ground: BoxesOnGround) -> Callable[[History], float]:
    box = ground.boxes[0]
    return lambda history: measures.peak(np.abs(measures.column(history, box, "angle") - box.angle))


def toppling(scene: Scene) -> tuple[JudgedNumber, ...]:
    """Return how far a box turns that was started about its corner; of one that may overturn, whether it does."""
    ground = boxes_of(scene)
    box = rectangle_of(ground)
    spin = abs(ground.boxes[0].spin)
    widths = [Rectangle(factor * box.width, box.height, box.gravity) for factor in EITHER_WAY]
    if spin >= min(critical_spin(changed_box) for changed_box in widths):
        return overturning(scene)
    rotation = _rotation(ground)
    return (
        around(
            "greatest rotation",
            "deg",
            math.degrees(greatest_rotation(box, spin)),
            [math.degrees(greatest_rotation(changed_box, spin)) for changed_box in widths],
            "one per cent of the width changes it by as much",
            measure=lambda history: math.degrees(rotation(history)),
        ),
    )


def overturning(scene: Scene) -> tuple[JudgedNumber, ...]:
    """Return whether a box overturns."""
    ground = boxes_of(scene)
    box = rectangle_of(ground)
    rotation = _rotation(ground)
    exact = float(abs(ground.boxes[0].spin) > critical_spin(box))
    return (
        JudgedNumber(
            "overturns",
            "1",
            exact=exact,
            low=exact,
            high=exact,
            scale=1.0,
            reason="1 where the centre passes above the corner, by the energy at the start",
            measure=lambda history: float(rotation(history) > box.alpha),
        ),
    )


SPINS = (0.95, 0.98, 0.99, 1.01, 1.02, 1.05)  # of the one that just overturns
DECIDED = 150  # rows: 2.5 s, in which what passes the unstable position has done so


def _toppling_cases() -> tuple[PlaneCase, ...]:
    box = rectangle_of(boxes_of(own_scene("toppling")))
    cases = []
    for factor in SPINS:
        spin = factor * critical_spin(box)
        velocity = [-spin * box.height / 2, spin * box.width / 2]
        started = {f"{BOX}.velocity": velocity, f"{BOX}.spin": spin, "time.steps": DECIDED}
        cases.append(PlaneCase(f"spin {factor:g} of critical", started, overturning))
    return tuple(cases)


# ---- shaken ---------------------------------------------------------------------------------------------------------


def shaken_box(scene: Scene, factor: float = 1.0) -> ShakenBox:
    """Return the first box of a scene on its moving ground, tan(phi) multiplied by a factor."""
    ground = boxes_of(scene)
    friction = factor * ground.friction_coefficient
    return ShakenBox(ground.base_amplitude, ground.base_frequency, friction, ground.gravity)


def shaken(scene: Scene) -> tuple[JudgedNumber, ...]:
    """Return how far a box slips on shaken ground."""
    box = boxes_of(scene).boxes[0]
    time = scene.time.step * np.arange(1.0, scene.time.steps + 1)
    exact = shaken_box(scene).slip(time)
    changed = [shaken_box(scene, factor).slip(time) for factor in EITHER_WAY]
    base = shaken_box(scene).ground(time)
    why = "one per cent of tan(phi), which is not known better, changes it by as much"
    width = {"scale": 1e3 * float(np.max(np.abs(exact)))}

    def slip(history: History) -> Array:
        moved: Array = measures.column(history, box, "x") - box.x - base
        return moved

    return (
        around(
            "slip in the end",
            "mm",
            1e3 * float(exact[-1]),
            [1e3 * float(changed_slip[-1]) for changed_slip in changed],
            why,
            measure=lambda history: 1e3 * float(slip(history)[-1]),
            **width,
        ),
        around(
            "largest slip",
            "mm",
            1e3 * float(np.max(np.abs(exact))),
            [1e3 * float(np.max(np.abs(changed_slip))) for changed_slip in changed],
            why,
            measure=lambda history: 1e3 * float(np.max(np.abs(slip(history)))),
            **width,
        ),
    )


# ---- impact on a spring ---------------------------------------------------------------------------------------------


def impact_of(scene: Scene, stiffness: float = 1.0, mass: float = 1.0) -> SpringImpact:
    """Return the landing of the first box of a scene on its spring, stiffness and mass multiplied by factors.

    Raises
    ------
    InputError
        The scene gives no stiffness.
    """
    ground = boxes_of(scene)
    box = ground.boxes[0]
    if ground.stiffness is None:
        rule = "must be finite in this problem"
        raise InputError(rule, source=scene.name, field="plane.contact.stiffness", value="inf")
    speed = math.sqrt(box.velocity[1] ** 2 + 2 * ground.gravity * box.lift)
    return SpringImpact(mass * box.mass, stiffness * ground.stiffness, ground.gravity, speed)


def impact(scene: Scene) -> tuple[JudgedNumber, ...]:
    """Return force, duration and rebound of a landing on a spring."""
    ground = boxes_of(scene)
    box = ground.boxes[0]
    exact = impact_of(scene)
    factors = [(factor, 1.0) for factor in EITHER_WAY] + [(1.0, factor) for factor in EITHER_WAY]
    changed = [impact_of(scene, *pair) for pair in factors]
    why = "one per cent of stiffness or density, which are not known better, changes it by as much"

    def gap(history: History) -> Array:
        lifted: Array = measures.column(history, box, "y") - box.reach
        return lifted

    def reported(history: History) -> float | None:
        values = history.columns.get(ground.force_columns[0])
        return None if values is None else measures.peak(values)

    def rebound(history: History) -> float | None:
        flying = measures.in_flight(history, ground)
        flying &= history.time > lands + exact.duration
        if not flying.any():
            return None
        energy = float(np.median(measures.energies(history, ground)[flying])) + ground.gravity * (
            measures.lowest_centre(box) - box.reach
        )
        return math.sqrt(max(0.0, 2 * energy))

    lands = (exact.speed + box.velocity[1]) / ground.gravity
    force = [1e-3 * changed_impact.peak_force for changed_impact in changed]
    return (
        around(
            "peak force by the sinking",
            "kN",
            1e-3 * exact.peak_force,
            force,
            why,
            measure=lambda history: 1e-3 * exact.stiffness * max(0.0, measures.peak(-gap(history))),
        ),
        around(
            "peak force as reported",
            "kN",
            1e-3 * exact.peak_force,
            force,
            why,
            measure=lambda history: None if reported(history) is None else 1e-3 * float(reported(history) or 0.0),
            optional=True,
        ),
        around(
            "time of contact",
            "ms",
            1e3 * exact.duration,
            [1e3 * changed_impact.duration for changed_impact in changed],
            why,
            measure=lambda history: _times(1e3, measures.contact_time(history, gap(history))),
        ),
        around(
            "speed of the rebound",
            "m/s",
            exact.speed,
            [factor * exact.speed for factor in EITHER_WAY],
            "without loss it is the speed of landing, which is not known to better than one per cent",
            measure=rebound,
        ),
    )


def _times(factor: float, value: float | None) -> float | None:
    return None if value is None else factor * value


@functools.cache
def box_problems() -> Mapping[str, PlaneProblem]:
    """Return the problems of boxes by name."""
    problems = (
        PlaneProblem("standing", standing, STANDING_CASES, changeable=("contact.friction", "gravity")),
        PlaneProblem("restitution", restitution, _restitution_cases(), changeable=("contact.restitution",)),
        PlaneProblem("bouncing", bouncing),
        PlaneProblem("tumbling", tumbling),
        PlaneProblem("pile", pile, forces=True),
        PlaneProblem("heavy-top", pile, _heavy_top_cases(), forces=True),
        PlaneProblem("toppling", toppling, _toppling_cases()),
        PlaneProblem("shaken", shaken),
        PlaneProblem("impact", impact, forces=True),
    )
    return {box_problem.name: box_problem for box_problem in problems}


@functools.cache
def plane_problems() -> Mapping[str, PlaneProblem]:
    """Return all problems of blocks in the plane by name."""
    return {**box_problems(), **{problem.name: problem for problem in canon_problems()}}


ASKS = {
    "standing": "A box on a slope that friction holds: does it stand for a minute, and from which friction on?",
    "restitution": "A box thrown flat at the ground: what is asked of its rebound, and what comes back?",
    "bouncing": "A box that bounces without loss for a minute: does its energy stay?",
    "tumbling": "A tilted box that tumbles without friction or loss: do energy and momentum stay?",
    "pile": "Ten equal boxes on each other at rest: do they stay, and what is the force below?",
    "heavy-top": "A heavy box on a light one: do both stay, up to which mass ratio?",
    "toppling": "A slender box started about its corner: how far it turns, and from which spin on it overturns.",
    "shaken": "A box on ground that shakes more than friction can pass on: how far it slips.",
    "impact": "A box that falls on a spring of given stiffness: peak force, time of contact, rebound.",
}


def problem_posed(scene: Scene) -> PlaneProblem:
    """Return the problem that a scene of blocks poses: one of the suite's, some of its data perhaps changed.

    Raises
    ------
    InputError
        It is none of them; what is measured on any other scene of blocks, and against what, nobody has said.
    """
    name = scene.name.removeprefix(PREFIX).partition("[")[0]
    if name not in plane_problems() or not scene.name.startswith(PREFIX):
        rule = f"must be one of {', '.join(plane_problems())}: blocks that move are judged by the numbers of a problem"
        raise InputError(rule, source=scene.name, field="plane", advice="name the problem, and use --set")
    problem = plane_problems()[name]
    as_posed = problem.scene()
    stated = _flat(scene)
    for field_name, value in _flat(as_posed).items():
        if stated.get(field_name) != value and field_name not in problem.changeable:
            free = " and ".join(f"plane.{key}" for key in problem.changeable) or "nothing"
            rule = f"must be that of the problem {name}, whose numbers are judged; {free} may be another"
            raise InputError(rule, source=scene.name, field=f"plane.{field_name}")
    same_time = (scene.time.step, scene.time.steps) == (as_posed.time.step, as_posed.time.steps)
    if not same_time:
        raise InputError(f"must be that of the problem {name}", source=scene.name, field="time")
    return problem


def _flat(scene: Scene) -> dict[str, Any]:
    """Return the keys of a scene's table of the plane, those of its contact as ``contact.friction``."""
    data = scene.table(PlaneSection).model_dump()
    contact = data.pop("contact")
    return data | {f"contact.{name}": value for name, value in (contact or {}).items()}


def _problem(name: str, posed: PlaneProblem, case: PlaneCase) -> Problem:
    scene = posed.scene(case)
    title = ": ".join(part for part in (scene.title, case.label) if part)
    asks = (ASKS | CANON_ASKS)[posed.name]
    return Problem(name, asks, title, scene, None, (case.quantities or posed.quantities)(scene))


class HOOKS(ProblemHooks):
    """Answers are positions, of which numbers are judged."""

    def problems(self) -> Iterator[tuple[str, Callable[[], Problem]]]:
        """Yield the cases of all problems; a case has its values in the name."""
        for posed in plane_problems().values():
            for case in posed.cases:
                label = re.sub(r"[^a-z0-9.]+", "-", case.label.lower()).strip("-")
                name = "-".join(part for part in (posed.name, label) if part)
                yield name, functools.partial(_problem, name, posed, case)

    def answer_columns(self, scene: Scene) -> tuple[str, ...]:
        """Return the poses of all blocks that move; of glued ones what is observed."""
        plane = scene.table(PlaneSection)
        return plane.assembly.pose_columns if plane.moves else scene.run.columns

    def judged_numbers(self, scene: Scene) -> tuple[JudgedNumber, ...]:
        """Return the numbers of the problem that a scene poses."""
        return problem_posed(scene).quantities(scene) if scene.table(PlaneSection).moves else ()

    def changes(self, scene: Scene) -> dict[str, Values]:
        """Return none: the bands are those of the numbers."""
        return {}

    def other_units(self, scene: Scene, history: History) -> Iterator[tuple[str, str]]:
        """Yield heights that begin in another unit."""
        blocks = scene.table(PlaneSection).assembly.blocks
        starts = {f"{block.name}.y": centroid(block.vertices)[1] for block in blocks if not block.held}
        for column, start in starts.items():
            values = history.columns.get(column, np.array([start]))
            if abs(start) < FIRST_ROW:  # m: no height that a unit would show in
                continue
            for ratio, other_unit in ratios(unit_of(column, scene.kind.columns)).items():
                if abs(values[0] / start / ratio - 1) < FIRST_ROW:
                    rule = f"wrong units: it begins with {ratio:g} times what is expected in SI, {other_unit}?"
                    yield column, rule
