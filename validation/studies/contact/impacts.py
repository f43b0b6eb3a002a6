"""The study `impacts`: benchmarks of impact that others publish, by exact motions, by DDA and by elements.

The data are those of the publications; the numbers are closed forms, or those of an independent program where the
springs are soft enough to count (p h / E finite, where the publications have a rigid wall).
"""

from __future__ import annotations

import functools
import math
from collections.abc import Iterator, Mapping

from validation.engine.finished import Derived, Finished
from validation.gates.gate import Gate
from validation.runs.row import Value
from validation.scenes.scene import Scene
from validation.solvers.events import rectangle
from validation.studies.bands import OTHER, about, cases, gate
from validation.studies.declaration import Study
from validation.studies.opening import half_unit

BLOCK = "block-events"
BAR = "bar-events"
SCENES = ("unlocked-other", "impact", "drop", "bouncing-bar", "ansys-vm265", "siconos-bar", "bouncing-mass")
WALLS = ("ansys-vm265", "siconos-bar")  # next to rigid
# p/E -> first release over a / c and restitution of the block, then of the bar, by an independent program.
IMPACTS = {
    0.1: ((7.20752512306, 0.998520157614), (7.24747963974, 0.999434986336)),
    1.0: ((2.64272535338, 0.930732420604), (2.83643330853, 0.975858485361)),
    10.0: ((0.376151058977, 0.999964928635), (2.0839173495, 0.997414419614)),
    100.0: ((0.111708797046, 0.932300965885), (2.00839173495, 0.999741441961)),
}
# p/E -> release after the impact of block and bar [s], and the block's second closing and opening after the impact.
FALLS = {
    1.0: (0.0089485487848081, 0.0094942023919859, None, None),
    100.0: (0.00036738771005667, 0.0066019935521345, 0.0022040919388594, 0.0025951314402221),
}
# Openings and closings of another block under a pressure: first and second, of the block and of the bar [s].
OTHERS = {
    BLOCK: {
        "first_closing": 0.0013278582077407,
        "first_opening": 0.0054491055360487,
        "second_closing": 0.0072447406133871,
        "second_opening": 0.012414067088762,
    },
    BAR: {
        "first_opening": 0.0069218140380999,
        "first_closing": 0.0077222679298686,
        "second_opening": 0.012238800061209,
        "second_closing": 0.012590286189158,
    },
}
# 2 p h / E -> release, second impact and second release of the bouncing bar [s].
BOUNCES = {
    10.0: (1.7719679119689, 3.7434589506622, 4.4891745212166),
    100.0: (1.6774227044841, 3.674310110746, 4.3488789444489),
    1000.0: (1.667744780213, 3.6674307545665, 4.3348876303179),
    10000.0: (1.6667745034073, 3.6667430730035, 4.3334887605193),
}
STOP = {
    "first_closing": 0.65785098512048,
    "second_closing": 1.2324367791597,
}  # of the block on a rigid stop, over a / c
RETURNED = 0.89132203751993  # share of its momentum after three impacts in a row, by an independent program
RIGID = {"release": 5 / 3, "impact": 11 / 3, "second release": 13 / 3}  # of the bouncing bar on a rigid wall [s]
SWITCHES = ("first_opening", "second_closing", "second_opening")
PRINTED = "an independent program; band: half a unit of its last digit, and 1e-11 of the value"
LIMIT = "rigid wall"


def transit(scene: Scene) -> float:
    """Return h / c, the time of a wave through the block [s]."""
    _, height = rectangle(scene) or (0.0, 0.0)
    return height * math.sqrt(scene.block.density / scene.block.young)


def stiffness_ratio(scene: Scene) -> float:
    """Return the springs' stiffness over that of the bar, 2 p h / (E a) [-]."""
    width, height = rectangle(scene) or (math.nan, math.nan)
    return 2 * scene.contact.stiffness * height / (scene.block.young * width)


def release(scene: Scene) -> float:
    """Return when an unloaded bar leaves stiff springs [s]: gap / V + (2 + x / F) h / c, e^x = 2 (1 + x).

    F is the springs' stiffness over the bar's; what is left out is of the order e^(-2 F).
    """
    x = 2.0
    for _ in range(60):  # a step leaves 1 / (1 + x) = 0.37 of the error
        x = math.log(2 * (1 + x))
    return scene.contact.gap / -scene.block.velocity + (2 + x / stiffness_ratio(scene)) * transit(scene)


def bounce(scene: Scene) -> tuple[float, float, float]:
    """Return when a mass lands on its spring, when it leaves [s], and how deep it goes [m].

    With V^2 = V0^2 + 2 g s, w^2 = k / m: contact lasts (2 / w) (pi - atan(V w / g)), and the penetration is
    g / w^2 + sqrt(g^2 / w^4 + V^2 / w^2).
    """
    b = scene.block
    g = scene.load.gravity
    width, height = rectangle(scene) or (math.nan, math.nan)
    w = math.sqrt(2 * scene.contact.stiffness / (b.density * width * height))
    V = math.sqrt(b.velocity**2 + 2 * g * scene.contact.gap)
    landing = (V + b.velocity) / g
    sag = g / w**2
    return landing, landing + 2 / w * (math.pi - math.atan(V * w / g)), sag + math.hypot(sag, V / w)


def gates() -> tuple[Gate, ...]:
    """Return all gates of the study."""
    return (*other_gates(), *impact_gates(), *fall_gates(), *bouncing_bar_gates(), *wall_gates(), *mass_gates())


def _near(scene: Scene, solver: str, metric: str, value: float, half: float) -> Gate:
    return gate(scene, solver, metric, about(value, half + 1e-11 * abs(value)), PRINTED, OTHER, half)


def other_gates() -> Iterator[Gate]:
    """Yield the gates on the switches of a block of other data under a pressure."""
    (case,) = cases("unlocked-other")
    for solver, switches in OTHERS.items():
        for name, time in switches.items():
            yield _near(case, solver, f"switches.{name}", time, half_unit(time))


def impact_gates() -> Iterator[Gate]:
    """Yield the gates on an unloaded block and bar that land at 1 m/s."""
    *soft, stiff = cases("impact")
    yield from stop_gates(stiff)
    for case in soft:
        for solver, (time, e) in zip((BLOCK, BAR), IMPACTS[case.contact.stiffness / case.block.young], strict=True):
            yield _near(case, solver, "switches.first_opening", time * transit(case), half_unit(time) * transit(case))
            yield _near(case, solver, "contact.restitution", e, half_unit(e))
    wave = "a wall so stiff that the pressure reaches rho c V: e^(-400) is left, and the samples lie in the plateau"
    force = math.sqrt(case.block.density * case.block.young) * case.block.base_length * -case.block.velocity
    yield gate(case, BAR, "contact.peak_force", about(force, 1e-11 * force), wave)


def stop_gates(case: Scene) -> Iterator[Gate]:
    """Yield the gates on a block on springs next to rigid: impacts of its base, a quarter of its mass, in a row."""
    impact_length = math.sqrt(case.block.young / case.contact.stiffness)
    why = "an independent program, on a rigid stop; band: sqrt(E / p), the length of an impact over a transit"
    for name, time in STOP.items():
        edges = about(time * transit(case), impact_length * transit(case))
        yield gate(case, BLOCK, f"switches.{name}", edges, why, OTHER)
    yield gate(case, BLOCK, "contact.restitution", about(RETURNED, impact_length), why, OTHER)
    whole = "contact of 2 h / c on a rigid wall; band: E / p, the springs of a wall that stiff"
    compliance = 2 * impact_length**2
    edges = about(2 * transit(case), compliance * transit(case))
    yield gate(case, BAR, "switches.first_opening", edges, whole)
    yield gate(case, BAR, "contact.restitution", (1 - compliance, 1 + 1e-12), whole)


def fall_gates() -> Iterator[Gate]:
    """Yield the gates on a block that falls under its own weight."""
    for case in cases("drop"):
        start = math.sqrt(2 * case.contact.gap / case.load.gravity)
        free = "free fall, sqrt(2 s / g); band: rounding"
        block, bar, closing, opening = FALLS[case.contact.stiffness / case.block.young]
        for solver in (BLOCK, BAR):
            yield gate(case, solver, "switches.first_closing", about(start, 1e-12), free)
        switch_times = ((BLOCK, SWITCHES[0], block), (BAR, SWITCHES[0], bar), (BLOCK, SWITCHES[1], closing))
        for solver, name, delay in (*switch_times, (BLOCK, SWITCHES[2], opening)):
            if delay is not None:
                yield _near(case, solver, f"switches.{name}", start + delay, half_unit(delay))


def bouncing_bar_gates() -> Iterator[Gate]:
    """Yield the gates on the bouncing bar, and on what its times tend to."""
    for case in cases("bouncing-bar"):
        falls = "free fall from 5 m under 10 m/s2: 1 s; band: rounding"
        yield gate(case, BAR, "switches.first_closing", about(1.0, 1e-12), falls)
        for name, time in zip(SWITCHES, BOUNCES[round(stiffness_ratio(case), 6)], strict=True):
            yield _near(case, BAR, f"switches.{name}", time, half_unit(time))
    for name, time in RIGID.items():
        why = (
            "Doyen, Ern and Piperno 2011, on a rigid wall; band: of the two stiffest springs, extrapolated linearly "
            "in 1/p, what is quadratic is left, (E / (2 p h))^2 of both, ten times over"
        )
        yield gate("bouncing-bar", LIMIT, name, about(time, 10 * 1e-3 * 1e-4), why, OTHER)


def derived() -> tuple[Derived, ...]:
    """Return the row of the bouncing bar's times, extrapolated to a rigid wall."""
    softer, stiffer = tuple(cases("bouncing-bar"))[-2:]
    needs = ((softer.name, BAR), (stiffer.name, BAR))
    reads = tuple(f"switches.{switch}" for switch in SWITCHES)
    return (Derived("bouncing-bar", LIMIT, needs, functools.partial(rigid, softer, stiffer), reads),)


def rigid(softer: Scene, stiffer: Scene, finished: Finished) -> Mapping[str, Value]:
    """Return the times on a rigid wall, linearly in 1/p from the two stiffest springs [s]."""
    a = 1 / stiffness_ratio(softer)
    b = 1 / stiffness_ratio(stiffer)
    times: dict[str, Value] = {}
    for name, switch in zip(RIGID, SWITCHES, strict=True):
        x = finished.rows[softer.name, BAR].metrics.get(f"switches.{switch}")
        y = finished.rows[stiffer.name, BAR].metrics.get(f"switches.{switch}")
        if isinstance(x, float) and isinstance(y, float):
            times[name] = (a * y - b * x) / (a - b)
        else:
            times[name] = "undefined"
    return times


def wall_gates() -> Iterator[Gate]:
    """Yield the gates on the bars of Ansys and Siconos."""
    for case in cases(*WALLS):
        start = case.contact.gap / -case.block.velocity
        end = release(case)
        closed = "contact lasts 2 L / c and what the springs add, 1.6783 / F of a transit; band: rounding"
        yield gate(case, BAR, "switches.first_closing", about(start, 1e-12 * start), "gap over speed; band: rounding")
        yield gate(case, BAR, "switches.first_opening", about(end, 1e-12 * end), closed)
        F = stiffness_ratio(case)
        restitution_reason = "all of the momentum on a rigid wall; band: 1 / F of the springs"
        yield gate(case, BAR, "contact.restitution", (1 - 1 / F, 1.0), restitution_reason)


def mass_gates() -> Iterator[Gate]:
    """Yield the gates on the mass that bounces on a spring."""
    (case,) = cases("bouncing-mass")
    landing, leaving, depth = bounce(case)
    soft = (
        "closed form of code_aster V5.01.108 for a rigid mass; band: 2 p h / (E a) = 1e-4, by which the block gives way"
    )
    yield gate(case, BLOCK, "switches.first_closing", about(landing, 1e-12), "free fall; band: rounding")
    yield gate(case, BLOCK, "switches.first_opening", about(leaving, 1e-4 * (leaving - landing)), soft)
    yield gate(case, BLOCK, "contact.penetration", about(depth, 1e-4 * depth), soft)
    step = "the same; band: what a landing within the step leaves open, (w dt)^2 = 1e-4, and 1e-4 as above"
    yield gate(case, "dda", "contact.penetration", about(depth, 2e-4 * depth), step)


STUDY = Study(
    name="impacts",
    title="Impacts that others publish",
    purpose="Bars on rigid walls, a bar that bounces, a mass on a spring: what the exact motions give, against closed "
    "forms and published numbers, and what DDA and elements make of the same data.",
    scenes=SCENES,
    gates=gates,
    derived=derived,
    pairs=(),
)
