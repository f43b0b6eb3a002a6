r"""What springs and step make of the contacts of moving blocks, known before anything is run.

A block of the mass m that moves by u = (x, y, angle) and, if it is elastic, by the strains (ex, ey, gxy), displaces a
corner c by B_c u. With the mass matrix M, the stiffness K of its strains and a spring p in both directions at c, its
highest frequency on that corner alone, the other side being fixed, is the largest root of

    (K + p B_c^T B_c - w^2 M) u = 0.

Where both sides move, the opening is a difference of two such displacements, and w^2 is at most the sum of both: that
of the two fastest blocks bounds any one contact. A rigid square has w^2 = 4 p / m, a soft one of one strain 7 p / m.

One spring that carries all that moves gives way by W / p; a block that lands on one at the speed v sinks by
v sqrt(m / p). Both are to stay below `OVERLAP` of a block's thickness, beyond which a scene is refused. The step is the
longest at which a landing on a spring of that frequency, at any place in the step, gives back its speed to within the
error (`validation.theory.rebound`).
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np

from validation.advice.across import rebound_of
from validation.advice.friction import left_of_a_distance
from validation.advice.plain import PlainAnswer, in_columns
from validation.advice.words import say
from validation.errors import InputError
from validation.models.plane.assembly import OVERLAP
from validation.models.plane.blocks import PlacedBlock, second_moments
from validation.models.plane.tables import OWN_STIFFNESS, PlaneSection
from validation.runs.numbers import significant
from validation.scenes.scene import Scene
from validation.theory.edges import edge
from validation.theory.statics import elasticity, plane_moduli
from validation.theory.stepping import Stepping

DIGITS = 2  # of springs and step, as much as a rule of thumb has
ROUNDED_DOWN = 0.95  # of a step that is rounded to so few digits: not beyond it
RESOLVED, LONGEST = 0.01, 10.0  # w dt between which a step is looked for; beyond, a contact lasts one step
GRID = 40  # of w dt between them
EDGE = 1e-3  # relative, of the step that is looked for
LINEAR = np.array(  # displacements linear in place: of the angle and the strains ex, ey, gxy
    [[[0.0, -1.0], [1.0, 0.0]], [[1.0, 0.0], [0.0, 0.0]], [[0.0, 0.0], [0.0, 1.0]], [[0.0, 0.5], [0.5, 0.0]]]
)


@dataclass(frozen=True)
class MovingAdvice(PlainAnswer):
    """What springs and step make of the contacts, and which to take."""

    scene: str
    blocks: int  # that move
    stiffness: tuple[float, float]  # of the softest and of the stiffest spring [N/m]
    fastest: tuple[str, ...]  # the blocks of the fastest contact, one or two
    frequency: float  # w of that contact [rad/s]
    omega_dt: float  # w dt [1]
    sinking: float  # W / p [m]
    sinking_share: float  # of the thickness of the thinnest block [1]
    landing: float  # v sqrt(m / p) at t = 0, the greatest share of a thickness [m]
    landing_share: float  # that share [1]
    rebound: tuple[float, float]  # least and greatest, of a landing at any place in a step [1]
    error: float  # of the rebound, that is allowed [1]
    settings: dict[str, float]  # for Scene.with_values


def highest_frequency(block: PlacedBlock, stiffness: float) -> float:
    """Return the highest frequency of a block on a spring in both directions at one of its corners [rad/s]."""
    from scipy.linalg import eigh

    linear = LINEAR[:1] if math.isinf(block.young) else LINEAR
    moments = second_moments(block.vertices)
    mass = np.zeros((2 + len(linear), 2 + len(linear)))
    mass[:2, :2] = block.area * np.eye(2)
    mass[2:, 2:] = np.einsum("ikl,jkm,lm->ij", linear, linear, moments)
    strains = np.zeros_like(mass)
    if len(linear) > 1:
        strains[3:, 3:] = block.area * elasticity(*plane_moduli(block.young, block.poisson, block.hypothesis))
    greatest = 0.0
    for corner in block.corners - block.centroid:
        B = np.column_stack([np.eye(2), (linear @ corner).T])
        squares = eigh(strains + stiffness * B.T @ B, block.density * mass, eigvals_only=True)
        greatest = max(greatest, float(squares[-1]))
    return math.sqrt(greatest)


def moving_advice(scene: Scene, error: float, keep_springs: bool = False) -> MovingAdvice:
    """Return what springs and step make of the contacts of moving blocks, and which to take.

    The error is that of the rebound of a landing [1]; springs are kept where they are those of real joints.

    Raises
    ------
    InputError
        Nothing touches, or no step brings the rebound within the error.
    """
    plane = scene.table(PlaneSection)
    springs = spring_range(plane)
    if springs is None:
        rule = "advise tells of contacts of moving blocks, and nothing touches"
        raise InputError(rule, source=scene.name, field="plane.contact", value="nothing")
    softest, stiffest = springs
    moving = plane.assembly.moving
    masses = np.array([block.mass for block in moving])
    sizes = np.array([block.thickness for block in moving])
    speeds = np.array([math.hypot(*block.velocity) for block in moving])
    weight = float(np.sum(masses)) * math.hypot(*plane.gravity)
    landings = speeds * np.sqrt(masses / softest)
    deepest = int(np.argmax(landings / sizes))
    fastest, frequency = fastest_contact(moving, stiffest)
    rebound = rebound_of(Stepping.of(scene).stages, frequency * scene.time.step)
    settings: dict[str, float] = {}
    needed = max(weight / (OVERLAP * np.min(sizes)), np.max(masses * (speeds / (OVERLAP * sizes)) ** 2))
    if needed > 0 and plane.contact is not None and not keep_springs:
        settings["plane.contact.stiffness"] = significant(float(needed), DIGITS)
        _, stiffest = spring_range(scene.with_values(settings).table(PlaneSection)) or springs
    longest = longest_omega(Stepping.of(scene), error)
    if longest is None:
        rule = f"no step down to w dt = {RESOLVED:g} gives a landing its speed back to within the error by this scheme"
        raise InputError(rule, source=scene.name, field="--error", value=f"{error:g}")
    _, new_frequency = fastest_contact(moving, stiffest)
    settings["time.step"] = significant(ROUNDED_DOWN * longest / new_frequency, DIGITS)
    return MovingAdvice(
        scene=scene.name,
        blocks=len(moving),
        stiffness=springs,
        fastest=fastest,
        frequency=frequency,
        omega_dt=frequency * scene.time.step,
        sinking=weight / softest,
        sinking_share=weight / softest / float(np.min(sizes)),
        landing=float(landings[deepest]),
        landing_share=float(landings[deepest] / sizes[deepest]),
        rebound=(rebound.least, rebound.most),
        error=error,
        settings=settings,
    )


def spring_range(plane: PlaneSection) -> tuple[float, float] | None:
    """Return the softest and the stiffest spring of a contact, of shear too [N/m]; None where nothing touches.

    Of rigid contact they are those that `dda` takes in its place.
    """
    laws = plane.assembly.all_springs
    normal = [OWN_STIFFNESS if math.isinf(law.stiffness) else law.stiffness for law in laws]
    shear = [OWN_STIFFNESS if math.isinf(law.shear) else law.shear for law in laws]
    return (min(normal), max(normal + shear)) if laws else None


def fastest_contact(moving: Sequence[PlacedBlock], stiffness: float) -> tuple[tuple[str, ...], float]:
    """Return the blocks of the fastest contact on a spring and the bound of its frequency [rad/s]."""
    squares = {block.name: highest_frequency(block, stiffness) ** 2 for block in moving}
    fastest = sorted(squares, key=squares.__getitem__)[-2:]
    return tuple(reversed(fastest)), math.sqrt(sum(squares[name] for name in fastest))


def longest_omega(stepping: Stepping, error: float) -> float | None:
    """Return the largest w dt up to which a landing gives its speed back to within an error; None where none does."""

    def is_followed(omega: float) -> bool:
        rebound = rebound_of(stepping.stages, omega)
        return max(1 - rebound.least, rebound.most - 1) <= error

    omegas = np.geomspace(RESOLVED, LONGEST, GRID).tolist()
    beyond = next((number for number, omega in enumerate(omegas) if not is_followed(omega)), None)
    if beyond is None:
        return float(LONGEST)
    return edge(is_followed, omegas[beyond - 1], omegas[beyond], EDGE) if beyond else None


def lines(scene: Scene, source: str, advice: MovingAdvice) -> Iterator[str]:
    """Yield the lines of one page of text; `source` has the words of the scene on a command line."""
    t = scene.time
    yield say("moving blocks", advice, time=t, stepping=Stepping.of(scene))
    yield ""
    yield "What these settings do"
    stiffness = " to ".join(f"{p:.4g}" for p in dict.fromkeys(advice.stiffness))
    law = scene.table(PlaneSection).contact
    is_rigid = law is not None and math.isinf(law.stiffness)
    words = {"stiffness": stiffness, "corner": " on ".join(advice.fastest)}
    facts = {
        "springs": say("springs of dda" if is_rigid else "springs of contacts", advice, **words),
        "weight": say("weight", advice) if advice.sinking else "",
        "landing": say("landing", advice) if advice.landing else "",
        "contact": say("fastest contact", advice, **words),
        "rebound": say("rebound", advice),
        "discount": say("discount", t, left=left_of_a_distance(t.discount, t.step)) if t.discount < 1 else "",
    }
    yield in_columns([(f"  {name}", sentence) for name, sentence in facts.items() if sentence])
    yield ""
    yield say("what to take of contacts", advice, thickness=OVERLAP)
    yield in_columns([(f"  {key}", f"{value:.{DIGITS}g}") for key, value in advice.settings.items()])
    yield say("next run", source, " ".join(f"--set {key}={value:g}" for key, value in advice.settings.items()))
