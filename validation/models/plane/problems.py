"""The problems of boxes on a ground: what is measured on an answer, its exact value, and the band around it.

An answer is positions, held against closed forms (`validation.theory.boxes`). The bands are what one per cent of a
datum changes: data of a body and its contact are not known to better than that, and an error below it changes nothing
for who uses the answer.
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
from validation.models.plane.boxes import BoxesOnGround, boxes_of
from validation.models.plane.canon import CANON_NUMBERS
from validation.models.plane.posed import (
    EITHER_WAY,
    FRICTION,
    PREFIX,
    PlaneCase,
    PlaneProblem,
    at_most,
    decided,
    own_scene,
    problems_of,
    varied,
    within,
)
from validation.models.plane.tables import PlaneSection
from validation.problems.numbered import JudgedNumber, around
from validation.problems.problem import Problem, ProblemHooks
from validation.runs.columns import unit_of
from validation.runs.history import Array, History
from validation.runs.units import ratios
from validation.scenes.scene import Scene
from validation.theory.boxes import (
    ShakenBox,
    SpringImpact,
    sliding_acceleration,
)
from validation.theory.rocking import Rectangle

FIRST_ROW = 0.3  # of the height of a box: what it may have changed by at the first row
BOX = "plane.block.1"  # the first box of a scene, after its ground
MINUTE = 60.0  # s
SETTLED = 0.5  # s after a landing: what moves away then has rebounded


# ---- standing ----


def standing(scene: Scene) -> tuple[JudgedNumber, ...]:
    """Return the creep of a box that stands on a slope, or how far another one slides."""
    ground = boxes_of(scene)
    box = ground.boxes[0]
    if ground.friction > ground.slope:
        scale = 1e3 * box.width / MINUTE
        reason = (
            "it stands exactly; the place of a block is known to one per cent of its width, and a creep that moves it "
            "further in a minute changes the answer"
        )
        return (at_most("creep", "mm/s", scale, reason, lambda history: 1e3 * measures.creep(history, box)),)

    def distance(factor: float) -> float:
        friction = math.degrees(math.atan(factor * ground.friction_coefficient))
        return sliding_acceleration(ground.slope, friction, ground.gravity) * scene.time.duration**2 / 2

    slid = "distance slid"
    return (varied(slid, "m", distance, FRICTION, lambda h: float(measures.column(h, box, "x")[-1] - box.x)),)


# ---- bounces ----


def restitution(scene: Scene) -> tuple[JudgedNumber, ...]:
    """Return the rebound over the speed of a landing without weight."""
    ground = boxes_of(scene)
    box = ground.boxes[0]
    speed = -box.velocity[1]
    after = box.lift / speed + SETTLED
    reason = "one per cent of the speed of landing: no rebound is known better"

    return (
        within(
            "restitution",
            "1",
            ground.rebound,
            1.0,
            reason,
            lambda history: measures.speed_between(history, box, "y", after) / speed,
        ),
    )


RESTITUTIONS = (0.0, 0.5, 1.0)
SPEEDS = (0.1, 1.0, 5.0)  # m/s; programs have no restitution below a threshold, mostly 0.2 to 1 m/s
LANDING = 0.2625  # s after t = 0: in the middle of a row and of the steps of the curves' first runs


def _restitution_cases() -> Iterator[PlaneCase]:
    half_height = boxes_of(own_scene("restitution")).boxes[0].height / 2
    for e in RESTITUTIONS:
        for speed in SPEEDS:
            if (e, speed) != (0.5, 1.0):  # the problem's own scene
                thrown = {f"{BOX}.at": [0.0, half_height + LANDING * speed], f"{BOX}.velocity": [0.0, -speed]}
                yield PlaneCase(f"e = {e:g}, {speed:g} m/s", {"plane.contact.restitution": e, **thrown})


def bouncing(scene: Scene) -> tuple[JudgedNumber, ...]:
    """Return the energy of a box that bounces without loss."""
    ground = boxes_of(scene)
    first = measures.first_energy(ground)
    reason = "one per cent of the height of the drop, which is not known better, changes the energy by as much"

    kept = "energy in the end over that at the start"
    return (
        within(kept, "1", 1.0, 1.0, reason, lambda history: measures.last_energy(history, ground) / first),
        at_most("largest gain of energy", "1", 1.0, reason, lambda history: measures.largest_gain(history, ground)),
    )


def tumbling(scene: Scene) -> tuple[JudgedNumber, ...]:
    """Return energy and momentum along the ground of a box that tumbles without friction or loss.

    Its motion is chaotic; these are not.
    """
    ground = boxes_of(scene)
    box = ground.boxes[0]
    landing = math.sqrt(2 * ground.gravity * box.lift)
    reason = (
        "without friction nothing acts along the ground; one per cent of the speed of landing is what a coefficient of "
        "friction of 0.01 takes in one impact"
    )

    def change(history: History) -> float:
        late = measures.speed_between(history, box, "x", scene.time.duration - measures.LATE)
        return abs(late - box.velocity[0])

    return (*bouncing(scene), at_most("change of the speed along the ground", "m/s", landing, reason, change))


# ---- piles ----


def pile(scene: Scene) -> tuple[JudgedNumber, ...]:
    """Return how far the uppermost of some boxes at rest moves, and the force below the lowest."""
    ground = boxes_of(scene)
    top = ground.boxes[-1]
    width = 1e3 * min(box.width for box in ground.boxes)
    height = 1e3 * (top.y + top.reach)
    weight = sum(box.mass for box in ground.boxes) * ground.gravity
    place = "it stands exactly; the place of a block is known to one per cent of its width"
    rigid = "rigid boxes do not sink; the height of what is piled up is known to one per cent"
    mean = "the weight above it, which one per cent of the density changes by as much; mean of the last tenth"

    def force(history: History) -> float | None:
        values = history.columns.get(ground.force_columns[0])
        if values is None or not np.isfinite(values).all():
            return None
        return float(np.mean(values[-max(1, len(values) // 10) :]))

    return (
        at_most(
            "drift of the top",
            "mm",
            width,
            place,
            lambda history: 1e3 * float(np.max(np.abs(measures.column(history, top, "x") - top.x))),
        ),
        within(
            "sinking of the top",
            "mm",
            0.0,
            height,
            rigid,
            lambda history: 1e3 * float(top.y - measures.column(history, top, "y")[-1]),
        ),
        within("force below the lowest box", "N", weight, weight, mean, force, optional=True),
    )


# ---- toppling ----


def rectangle_of(ground: BoxesOnGround, factor: float = 1.0) -> Rectangle:
    """Return the lowest box, its width multiplied by a factor."""
    box = ground.boxes[0]
    return Rectangle(factor * box.width, box.height, ground.gravity)


def _rotation(history: History, ground: BoxesOnGround) -> float:
    box = ground.boxes[0]
    return measures.peak(np.abs(measures.column(history, box, "angle") - box.angle))


def toppling(scene: Scene) -> tuple[JudgedNumber, ...]:
    """Return how far a box turns about its corner; of one that may overturn, whether it does."""
    ground = boxes_of(scene)
    spin = abs(ground.boxes[0].spin)
    if spin >= min(rectangle_of(ground, factor).critical_spin for factor in EITHER_WAY):
        return overturning(scene)
    return (
        varied(
            "greatest rotation",
            "deg",
            lambda factor: math.degrees(rectangle_of(ground, factor).greatest_rotation(spin)),
            "the width",
            lambda history: math.degrees(_rotation(history, ground)),
        ),
    )


def overturning(scene: Scene) -> tuple[JudgedNumber, ...]:
    """Return whether a box overturns."""
    ground = boxes_of(scene)
    box = rectangle_of(ground)
    overturns = abs(ground.boxes[0].spin) > box.critical_spin
    reason = "1 where the centre passes above the corner, by the energy at the start"
    return (decided("overturns", overturns, reason, lambda history: _rotation(history, ground) > box.alpha),)


SPINS = (0.95, 0.98, 0.99, 1.01, 1.02, 1.05)  # of the one that just overturns
DECIDED = 150  # rows: 2.5 s, in which the unstable position is passed or not


def _toppling_cases() -> Iterator[PlaneCase]:
    box = rectangle_of(boxes_of(own_scene("toppling")))
    for factor in SPINS:
        spin = factor * box.critical_spin
        velocity = [-spin * box.height / 2, spin * box.width / 2]
        started = {f"{BOX}.velocity": velocity, f"{BOX}.spin": spin, "time.steps": DECIDED}
        yield PlaneCase(f"spin {factor:g} of critical", started, overturning)


# ---- shaken ----


def shaken_box(scene: Scene, factor: float = 1.0) -> ShakenBox:
    """Return the first box of a scene on its moving ground, tan(phi) multiplied by a factor."""
    ground = boxes_of(scene)
    friction = factor * ground.friction_coefficient
    return ShakenBox(ground.base_amplitude, ground.base_frequency, friction, ground.gravity)


def shaken(scene: Scene) -> tuple[JudgedNumber, ...]:
    """Return how far a box slips on shaken ground."""
    box = boxes_of(scene).boxes[0]
    time = scene.time.step * np.arange(1.0, scene.time.steps + 1)
    base = shaken_box(scene).ground(time)

    @functools.cache
    def exact(factor: float) -> Array:
        return 1e3 * shaken_box(scene, factor).slip(time)

    def slip(history: History) -> Array:
        return np.asarray(1e3 * (measures.column(history, box, "x") - box.x - base))

    def greatest(slips: Array) -> float:
        return float(np.max(np.abs(slips)))

    scale = greatest(exact(1.0))
    end = "slip in the end"
    return (
        varied(end, "mm", lambda f: float(exact(f)[-1]), FRICTION, lambda h: float(slip(h)[-1]), scale=scale),
        varied("largest slip", "mm", lambda f: greatest(exact(f)), FRICTION, lambda h: greatest(slip(h)), scale=scale),
    )


# ---- impact on a spring ----


def impact_of(scene: Scene, stiffness: float = 1.0, mass: float = 1.0) -> SpringImpact:
    """Return the landing of the first box of a scene on its spring, stiffness and mass multiplied by factors.

    A scene without a stiffness is an `InputError`.
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
    changed = [impact_of(scene, stiffness=factor) for factor in EITHER_WAY]
    changed += [impact_of(scene, mass=factor) for factor in EITHER_WAY]
    why = "one per cent of stiffness or density, which are not known better, changes it by as much"
    landing = "without loss it is the speed of landing, which is not known to better than one per cent"
    lands = (exact.speed + box.velocity[1]) / ground.gravity
    peaks = 1e-3 * exact.peak_force, [1e-3 * one.peak_force for one in changed]
    durations = 1e3 * exact.duration, [1e3 * one.duration for one in changed]

    def gap(history: History) -> Array:
        return np.asarray(measures.column(history, box, "y") - box.reach)

    def reported(history: History) -> float | None:
        values = history.columns.get(ground.force_columns[0])
        return None if values is None else 1e-3 * measures.peak(values)

    def duration(history: History) -> float | None:
        time = measures.contact_time(history, gap(history))
        return None if time is None else 1e3 * time

    def rebound(history: History) -> float | None:
        flying = measures.in_flight(history, ground)
        flying &= history.time > lands + exact.duration
        if not flying.any():
            return None
        energy = float(np.median(measures.energies(history, ground)[flying]))
        energy += ground.gravity * (measures.lowest_centre(box) - box.reach)
        return math.sqrt(max(0.0, 2 * energy))

    return (
        around(
            "peak force by the sinking",
            "kN",
            *peaks,
            why,
            measure=lambda history: 1e-3 * exact.stiffness * max(0.0, measures.peak(-gap(history))),
        ),
        around("peak force as reported", "kN", *peaks, why, measure=reported, optional=True),
        around("time of contact", "ms", *durations, why, measure=duration),
        within("speed of the rebound", "m/s", exact.speed, exact.speed, landing, rebound),
    )


BOX_NUMBERS = (standing, restitution, bouncing, tumbling, pile, toppling, shaken, impact)


@functools.cache
def box_problems() -> Mapping[str, PlaneProblem]:
    """Return the problems of boxes by name."""
    more = {"restitution": _restitution_cases(), "toppling": _toppling_cases()}
    return problems_of("boxes", {numbers.__name__: numbers for numbers in BOX_NUMBERS}, more)


@functools.cache
def canon_problems() -> Mapping[str, PlaneProblem]:
    """Return the problems of several blocks by name."""
    return problems_of("canon", {numbers.__name__: numbers for numbers in CANON_NUMBERS}, {})


def problem_posed(scene: Scene) -> PlaneProblem:
    """Return the problem that a scene of blocks poses: one of the suite's, some of its data perhaps changed.

    Raises
    ------
    InputError
        It is none of them: nobody has said what is measured on any other scene of blocks.
    """
    problems = {**box_problems(), **canon_problems()}
    name = scene.name.removeprefix(PREFIX).partition("[")[0]
    if name not in problems or not scene.name.startswith(PREFIX):
        rule = f"must be one of {', '.join(problems)}: blocks that move are judged by the numbers of a problem"
        raise InputError(rule, source=scene.name, field="plane", advice="name the problem, and use --set")
    problem = problems[name]
    as_posed = problem.scene()
    stated = _flat(scene)
    for field_name, value in _flat(as_posed).items():
        if stated.get(field_name) != value and field_name not in problem.changeable:
            free = " and ".join(f"plane.{key}" for key in problem.changeable) or "nothing"
            rule = f"must be that of the problem {name}, whose numbers are judged; {free} may be another"
            raise InputError(rule, source=scene.name, field=f"plane.{field_name}")
    if (scene.time.step, scene.time.steps) != (as_posed.time.step, as_posed.time.steps):
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
    return Problem(name, posed.asks, title, scene, None, (case.quantities or posed.quantities)(scene))


class HOOKS(ProblemHooks):
    """Answers are positions, of which numbers are judged."""

    def problems(self) -> Iterator[tuple[str, Callable[[], Problem]]]:
        """Yield the cases of all problems; a case has its values in the name."""
        for posed in (*box_problems().values(), *canon_problems().values()):
            for case in posed.cases:
                label = re.sub(r"[^a-z0-9.]+", "-", case.label.lower()).strip("-")
                name = f"{posed.name}-{label}" if label else posed.name
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
        for block in scene.table(PlaneSection).assembly.blocks:
            column = f"{block.name}.y"
            start = block.centroid[1]
            if block.held or abs(start) < FIRST_ROW or column not in history.columns:
                continue  # m: no height that a unit would show in
            first = history.columns[column][0]
            for ratio, other_unit in ratios(unit_of(column, scene.kind.columns)).items():
                if abs(first / start / ratio - 1) < FIRST_ROW:
                    rule = f"wrong units: it begins with {ratio:g} times what is expected in SI, {other_unit}?"
                    yield column, rule
