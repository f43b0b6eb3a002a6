"""What to set in another program for a penetration at rest, a restitution or a hidden damping: `translate` backwards.

Every program's contact is a spring and a dashpot on the body (`validation.theory.soft_contact`), so that the stiffness
follows from the penetration, w^2 = (share of the load) g / x, and the dashpot from the restitution. The restitution is
that of the program's own steps under the body's weight, as a mean over where in a step the body lands; their least and
greatest are stated beside it. What a program cannot have is refused, with what to do.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, field, replace

from validation.advice import engines
from validation.advice.engine_table import (
    BOX2D_LIMIT,
    BOX2D_STATIC,
    MUJOCO_IMPEDANCES,
    MUJOCO_STEPS,
    PROGRAMS,
    Program,
    Settings,
)
from validation.advice.limits import Limit, check_choice
from validation.advice.plain import PlainAnswer
from validation.errors import InputError
from validation.scenes.scene import Scene
from validation.theory import rebound, stages
from validation.theory.soft_contact import (
    PYBULLET_SLOP,
    Impedance,
    SoftContact,
    curve_rebounds,
    implicit_step,
    shared_impedance,
)

PYBULLET_LOOKS_AHEAD = 0.02  # of the radius, the distance from which on PyBullet brakes a ball
FINE_STEP = 0.2  # w h of the programs that have no step of their own, 31 steps a period of the contact
YADE_SAFETY = 0.8  # of GlobalStiffnessTimeStepper, over sqrt(2) / w
SUBSTEPS = 4  # of Box2D in a step, as its documentation has it
FINEST_STEP = 0.002  # w h, of a step that is sought
LAST_DIGITS = 1e-9  # by which a timeconst at the edge of refsafe stays on its right side
REACHED = 1e-6  # of a restitution
IMPEDANCE = 0.95  # MuJoCo's default dmax
CRITICAL = 1.0  # damping ratio where no restitution is stated
SETTLING = 0.06  # s, of a contact of Box2D's creep: exp(-0.5 / 0.06) is left when a slow body falls asleep
PROGRAMS_ADVISED = ("box2d", "mujoco", "opensees", "pybullet", "yade")


@dataclass(frozen=True)
class Landing:
    """A body that lands flat on ground that does not move, and stands there."""

    mass: float  # [kg]
    load: float  # that stands on the contact at rest [N]
    speed: float = 0.0  # at which it lands [m/s]
    step: float | None = None  # of the scene [s]
    box: tuple[float, ...] | None = None  # width and height [m]; None of a sphere
    stiffness: float | None = None  # of the body under the load, E a / h [N/m]; None if rigid

    @property
    def acceleration(self) -> float:
        """Load over mass [m/s2]."""
        return self.load / self.mass


@dataclass(frozen=True)
class Targets:
    """What a user wants; None where it may be as it comes."""

    penetration: float | None = None  # at rest [m]
    restitution: float | None = None
    hidden: float | None = None  # damping ratio that the steps may add to a free vibration of the contact


@dataclass(frozen=True)
class EngineAdvice(PlainAnswer):
    """What to set in a program, and what that is."""

    program: str
    version: str  # with which the formulas were checked
    mass: float  # [kg]
    points: int  # contact points that share the body
    step: float | None  # h over which the contact is solved [s]
    settings: Settings
    penetration: float | None = None  # at rest [m]
    rebound: dict[str, float] | None = None  # over the phase: mean, low, high [-]; None where it is not known
    hidden: float | None = None  # damping ratio that the steps add [-]; None where the contact does not vibrate
    stiffness: float | None = None  # of all points [N/m]
    damping: float | None = None  # of all points [N s/m]
    omega_step: float | None = None  # w h [-]
    damping_ratio: float | None = None  # zeta [-]
    stiffness_ratio: float | None = None  # of the contact over the block, k h / (E a) [-]
    defaults: dict[str, float | None] = field(default_factory=dict)  # of the program as it comes
    notes: tuple[str, ...] = ()


def landing_of(scene: Scene) -> Landing:
    """Return the landing of a scene's block or box.

    Raises
    ------
    InputError
        The scene has a column, several boxes or a box that is tilted.
    """
    from validation.solvers import opened
    from validation.theory import statics

    if scene.rigid is not None:
        if len(scene.rigid.box) > 1:
            advice = "advise for each contact apart: a scene with that box alone, with the mass that it carries"
            raise InputError("must be one box", source=scene.name, field="rigid.box", advice=advice)
        box = scene.rigid.box[0]
        if box.tilt:
            advice = "state box.tilt = 0: a corner that lands alone feels less than the mass of the box"
            raise InputError(
                "must be 0 for a flat landing", source=scene.name, field="box.tilt", value=box.tilt, advice=advice
            )
        pull = -scene.rigid.pull[1]
        speed = math.sqrt(box.velocity[1] ** 2 + 2 * pull * box.lift)
        return Landing(box.mass, box.mass * pull, speed, None, (box.width, box.height))
    if scene.column is not None:
        raise InputError(
            "advise --for takes scenes of a block or of a rigid box only", source=scene.name, value=scene.kind_in_words
        )
    block = scene.block
    load = opened.resultant_load(scene)
    acceleration = load / block.mass
    drop = 2 * max(acceleration, 0.0) * scene.contact.gap
    sides = (block.base_length, statics.height(scene))
    modulus, _ = statics.moduli(scene)
    stiffness = modulus * sides[0] / sides[1]
    return Landing(block.mass, load, math.sqrt(block.velocity**2 + drop), scene.time.step, sides, stiffness)


def advise_engine(
    scene: Scene,
    program: str,
    *,
    penetration: float | None = None,
    restitution: float | None = None,
    hidden: float | None = None,
    speed: float | None = None,
    step: float | None = None,
    points: int | None = None,
) -> EngineAdvice:
    """Return what to set in another program for the block or the box of a scene.

    Parameters
    ----------
    scene
        A block, which the program has as a rigid body, or a rigid box.
    program
        "box2d", "mujoco", "opensees", "pybullet" or "yade".
    penetration
        Wanted at rest [m].
    restitution
        Wanted of a flat landing.
    hidden
        Damping ratio that the program's steps may add to a free vibration of the contact, at most.
    speed
        At which the body lands [m/s]; that of the scene if not stated.
    step
        h over which the program solves the contact, of Box2D a sub-step [s]; if not stated that of a block's scene, or
        the program's own.
    points
        Contact points that share the body; if not stated those of a flat box in the program.

    Raises
    ------
    InputError
        The program cannot have it.

    Examples
    --------
    >>> from validation import load_scene
    >>> advice = advise_engine(load_scene("field-rebound"), "opensees", penetration=1e-4)
    >>> advice.settings["penalty"] * advice.points == advice.stiffness
    True
    """
    targets = Targets(penetration, restitution, hidden)
    return advise_landing(landing_of(scene), program, targets, speed=speed, step=step, points=points)


def advise_landing(
    landing: Landing,
    program: str,
    targets: Targets,
    *,
    speed: float | None = None,
    step: float | None = None,
    points: int | None = None,
) -> EngineAdvice:
    """Return what to set in a program for a landing; see `advise_engine`."""
    check_choice("--for", program, PROGRAMS_ADVISED)
    if (targets.penetration, targets.restitution, targets.hidden) == (None, None, None):
        raise InputError(
            "one of them must be given", field="--penetration, --restitution, --hidden-damping", value="neither"
        )
    stated = (targets.penetration, targets.restitution, targets.hidden, speed, step, points)
    for limit, value in zip(LIMITS, stated, strict=True):
        limit.check(value)
    described = PROGRAMS[program]
    if points is None:
        points = described.points if landing.box is not None else 1
    is_step_stated = step is not None
    step = step or landing.step or described.step
    if step is None:
        frequency = 1.0
        if targets.penetration is not None:
            frequency = math.sqrt(max(landing.acceleration, 0.0) / targets.penetration) or 1.0
        step = FINE_STEP / frequency
    if speed is not None:
        landing = replace(landing, speed=speed)
    if targets.restitution is not None and landing.speed <= 0:
        advice = "the restitution under a weight follows the speed: add --speed"
        raise InputError("must be given, the body of the scene does not land", field="--speed", advice=advice)
    if targets.penetration is not None and landing.load <= 0:
        advice = "nothing stands in the contact: state a weight or a pressure"
        raise InputError(
            "must be positive for a penetration at rest", field="load", value=f"{landing.load:g} N", advice=advice
        )
    question = _Question(described, landing, targets, step, is_step_stated, points)
    return _ADVICE[program](question)


LIMITS = (
    Limit("--penetration", "must be positive"),
    Limit("--restitution", "must be from 0 to 1", below=1.0, ends=(0.0, 1.0)),
    Limit("--hidden-damping", "must be between 0 and 1", below=1.0),
    Limit("--speed", "must be positive"),
    Limit("--step", "must be positive"),
    Limit("--points", "must be at least 1"),
)


@dataclass(frozen=True)
class _Question:
    """All that an answer for a program is made of."""

    program: Program
    landing: Landing
    targets: Targets
    step: float
    is_step_stated: bool
    points: int

    @property
    def acceleration(self) -> float:
        return self.landing.acceleration

    def relative_load(self, step: float) -> float:
        """Return g h / V; 0 where nothing lands."""
        return self.acceleration * step / self.landing.speed if self.landing.speed > 0 else 0.0

    def answer(
        self,
        contact: SoftContact | None,
        settings: Settings,
        step: float | None,
        rebounds: dict[str, float] | None,
        hidden: float | None,
        notes: list[str],
    ) -> EngineAdvice:
        """Return the advice of a contact."""
        known: dict[str, float | None] = {}
        if contact is not None:
            known = {
                "penetration": contact.rest_penetration(self.landing.load),
                "stiffness": contact.stiffness,
                "damping": contact.damping,
                "damping_ratio": contact.ratio,
                "omega_step": None if step is None else contact.frequency * step,
            }
            if self.landing.stiffness is not None:
                known["stiffness_ratio"] = contact.stiffness / self.landing.stiffness
        return EngineAdvice(
            program=self.program.name,
            version=self.program.version,
            mass=self.landing.mass,
            points=self.points,
            step=step,
            settings=settings,
            rebound=rebounds,
            hidden=hidden,
            defaults=defaults(self.program, self.landing, self.points),
            notes=tuple(notes),
            **known,
        )

    def spread(self, contact: SoftContact, step: float) -> dict[str, float] | None:
        """Return mean, least and greatest rebound; None where nothing lands."""
        if self.landing.speed <= 0:
            return None
        return engines.spread(contact.rebounds(step, self.relative_load(step)))


def defaults(program: Program, landing: Landing, points: int) -> dict[str, float | None]:
    """Return what a program does as it comes: penetration at rest [m], restitution, hidden damping; None if unknown."""
    if program.name == "pybullet":
        return {"penetration": PYBULLET_SLOP, "restitution": 0.0, "hidden": None}
    if program.name == "opensees":
        return {"penetration": None, "restitution": None, "hidden": 0.0}
    if program.name == "yade":
        as_it_comes = SoftContact.of_yade(1.0, 1.0, program.default("local_damping")[0])
        e = float(as_it_comes.rebounds(FINE_STEP).mean())
        return {"penetration": None, "restitution": e, "hidden": as_it_comes.numerical_ratio(FINE_STEP)}
    gravity = max(landing.acceleration, 0.0)
    box = landing.box if points > 1 else None
    comes = engines.translate(program.name, mass=landing.mass, gravity=gravity, points=points, box=box, static=True)
    restitution = 0.0 if program.name == "box2d" else _mujoco_as_it_comes(program, landing, points)
    return {
        "penetration": comes.rest_penetration if gravity else None,
        "restitution": restitution,
        "hidden": None if program.name == "box2d" else 0.0,
    }


def _mujoco_as_it_comes(program: Program, landing: Landing, points: int) -> float | None:
    """Return the mean rebound of MuJoCo's default contact at its own step; None where nothing lands."""
    if landing.speed <= 0 or program.step is None:
        return None
    solimp = program.default("solimp")
    solref = (program.default("timeconst")[0], program.default("dampratio")[0])
    gravity = max(landing.acceleration, 0.0)
    return float(curve_rebounds(Impedance(*solimp), *solref, points, program.step, landing.speed, gravity).mean())


# ---- a dashpot for a restitution ------------------------------------------------------------------------------------


def ratio_for(e: float, contact_of: Callable[[float], SoftContact], step: float, load: float) -> float | None:
    """Return the damping ratio at which the mean rebound of the steps is e; None if there is none.

    Parameters
    ----------
    e
        Restitution wanted.
    contact_of
        The contact of a damping ratio.
    step
        h [s].
    load
        g h / V.
    """
    from scipy.optimize import brentq

    def excess(zeta: float) -> float:
        return float(contact_of(zeta).rebounds(step, load).mean()) - e

    undamped = contact_of(0.0)
    if undamped.spectral_radius(step) > 1 + engines.RADIUS_TOLERANCE:
        return None
    if excess(0.0) <= 0:
        # what lands without a dashpot spreads about its mean, and a mean that is e within that spread is as near as any
        is_near = e <= float(undamped.rebounds(step, load).max()) and not undamped.implicit
        return 0.0 if is_near else None
    high = 1.0
    while excess(high) > 0:
        high *= 2
        if high > 1e4 or _is_overshooting(contact_of(high), step):
            return None
    if _is_overshooting(contact_of(high), step):
        return None
    return float(brentq(excess, 0.0, high, xtol=REACHED))


def _is_overshooting(contact: SoftContact, step: float) -> bool:
    """Whether an explicit dashpot turns the velocity of a step round, from where on more of it is not less rebound."""
    return not contact.implicit and 2 * contact.ratio * contact.frequency * step >= 1


def _shorter(step: float, frequency: float, is_enough: Callable[[float], bool]) -> str:
    """Return in words which of the halves of a step is the first that is enough."""
    shorter = step / 2
    while shorter * frequency > FINEST_STEP:
        if is_enough(shorter):
            return f"a step of at most {shorter:.4g} s has it"
        shorter /= 2
    return f"no step from {FINEST_STEP / frequency:.2g} s on has it"


# ---- program by program ---------------------------------------------------------------------------------------------


def _box2d(question: _Question) -> EngineAdvice:
    """Hertz by the penetration; the rebound is that of the shapes, as the relaxation takes what the spring returns."""
    targets = question.targets
    step = question.step
    if targets.hidden is not None:
        raise InputError(
            "cannot be chosen in Box2D, whose contacts do not vibrate: each sub-step relaxes them",
            field="--hidden-damping",
            advice="leave it out; other programs have a contact that vibrates: pybullet, mujoco",
        )
    settings: Settings = {}
    notes = [f"step is a sub-step: world.step({SUBSTEPS} * {step:.6g}, {SUBSTEPS})"]
    contact = None
    lever = engines.lever(question.landing.box, question.points)
    if targets.penetration is not None:
        share = question.points / (1 + lever)
        hertz = math.sqrt(question.acceleration / (targets.penetration * share)) / (2 * math.pi * BOX2D_STATIC)
        limit = BOX2D_LIMIT / step
        if hertz > limit * (1 + 1e-9):
            least = targets.penetration * (hertz / limit) ** 2
            advice = f"the sub-step {step * limit / hertz:.4g} s has it, or a penetration of {least:.4g} m"
            raise InputError(
                f"cannot be had in Box2D, which takes at most {limit:.4g} Hz at the sub-step {step:.4g} s",
                field="--penetration",
                value=f"{targets.penetration:g} m",
                advice=advice,
            )
        ratio = question.program.default("damping_ratio")[0]
        settings |= {"hertz": hertz, "damping_ratio": ratio}
        contact = SoftContact.of_box2d(question.landing.mass, BOX2D_STATIC * hertz, ratio, question.points, lever)
        settling = 2 * contact.ratio / contact.frequency
        if settling > SETTLING:
            notes.append(
                f"it creeps into its rest with a time constant of {settling:.3g} s, and Box2D puts a slow body to "
                "sleep after 0.5 s: a sleep threshold of 0 lets it settle"
            )
    rebounds = None
    if targets.restitution is not None:
        e = targets.restitution
        speed = question.landing.speed
        settings |= {"restitution": e, "restitution_threshold": min(1.0, speed / 2)}
        if question.points == 1:
            # The speed is that at the start of a step: before the landing where the contact is seen ahead (20 mm), or
            # after it. A fall in sub-steps is faster or slower than the exact one by up to a sub-step besides.
            late = question.acceleration * (SUBSTEPS + 1) * step / speed
            rebounds = {"mean": e, "low": max(e * (1 - late), 0.0), "high": e * (1 + late)}
        else:
            notes.append(
                "the rebound of a flat box is not known: Box2D solves its corners one after the other; a circle has "
                "the restitution"
            )
        notes.append("restitution is that of both shapes: Box2D takes the larger one")
    return question.answer(contact, settings, step, rebounds, None, notes)


def _pybullet(question: _Question) -> EngineAdvice:
    """Stiffness by the penetration, damping by the restitution of the implicit steps."""
    targets = question.targets
    landing = question.landing
    step = question.step
    if targets.penetration is None:
        raise InputError(
            "must be given for pybullet, whose contact is rigid as it comes: 0.01 mm deep at rest and without rebound",
            field="--penetration",
            advice="add --penetration 0.001",
        )
    if targets.penetration <= PYBULLET_SLOP:
        raise InputError(
            f"must be above {PYBULLET_SLOP:g} m, by which PyBullet lets bodies overlap before a contact pushes",
            field="--penetration",
            value=f"{targets.penetration:g} m",
            advice="state a larger one, or leave the contact rigid as it comes: it stands that deep",
        )
    k = landing.load / (targets.penetration - PYBULLET_SLOP)
    w = math.sqrt(k / landing.mass)
    if targets.hidden is not None:
        longest = implicit_step(targets.hidden) / w
        if step > longest and question.is_step_stated:
            added = SoftContact(landing.mass, k, 0.0).numerical_ratio(step)
            raise InputError(
                f"cannot be had in PyBullet at the step {step:.4g} s, which adds {added:.4g}",
                field="--hidden-damping",
                value=f"{targets.hidden:g}",
                advice=f"a step of at most {longest:.4g} s has it",
            )
        step = min(step, longest)

    def contact_of(zeta: float) -> SoftContact:
        return SoftContact.of_pybullet(landing.mass, k, 2 * zeta * landing.mass * w, question.points > 1)

    def ratio_at(h: float) -> float | None:
        return ratio_for(targets.restitution or 0.0, contact_of, h, question.relative_load(h))

    zeta = CRITICAL
    if targets.restitution is not None:
        reached = ratio_at(step)
        if reached is None:
            shorter = _shorter(step, w, lambda h: ratio_at(h) is not None)
            most = float(contact_of(0.0).rebounds(step, question.relative_load(step)).mean())
            raise InputError(
                f"cannot be had in PyBullet at the step {step:.4g} s, whose steps leave {most:.4g} in the mean",
                field="--restitution",
                value=f"{targets.restitution:g}",
                advice=f"{shorter}, or a softer contact by a larger --penetration",
            )
        zeta = reached
    contact = contact_of(zeta)
    settings: Settings = {
        "contact_stiffness": k / question.points,
        "contact_damping": contact.damping / question.points,
    }
    notes = [
        "changeDynamics of the body; of the ground contactStiffness = 1e18 and contactDamping = 0: the stiffnesses act "
        "one behind the other, the dampings add up, and 0.1 is what a body comes with",
        "linearDamping = 0 of the body: as it comes 0.04 slows a free fall",
    ]
    if question.points > 1:
        notes.append(
            "on ground of GEOM_BOX, where a box has 4 contact points; on GEOM_PLANE it has 2 and lands otherwise"
        )
    elif targets.restitution is not None:
        notes.append(
            f"of a ball whose radius is {1 / PYBULLET_LOOKS_AHEAD:g} times {landing.speed * step:.4g} m at least"
        )
    return question.answer(
        contact, settings, step, question.spread(contact, step), contact.numerical_ratio(step), notes
    )


def _mujoco(question: _Question) -> EngineAdvice:
    """The reference by penetration and restitution at a constant impedance, which rises where refsafe would act."""
    targets = question.targets
    step = question.step
    stated = targets.penetration
    if stated is None:
        if question.acceleration <= 0:
            advice = "without a weight the penetration at rest states no stiffness: take a scene with gravity"
            raise InputError("must be positive", field="load", value=f"{question.landing.load:g} N", advice=advice)
        stated = _mujoco_own_penetration(question)

    contact = _mujoco_contact(question, stated, step)
    if contact is None:
        stiffest = math.sqrt(question.acceleration / stated)
        shorter = _shorter(step, stiffest, lambda h: _mujoco_contact(question, stated, h) is not None)
        fields = "--penetration" if targets.restitution is None else "--penetration, --restitution"
        raise InputError(
            f"cannot be had in MuJoCo at the step {step:.4g} s with a timeconst of two steps (refsafe) and an "
            f"impedance of at most {MUJOCO_IMPEDANCES[1]:g}",
            field=fields,
            value=f"{stated:g} m",
            advice=f"{shorter}, or a larger --penetration",
        )
    return _mujoco_answer(question, contact, step)


def _mujoco_own_penetration(question: _Question) -> float:
    """Return how deep the default solref stands at the constant impedance 0.95."""
    timeconst = question.program.default("timeconst")[0]
    return (1 - IMPEDANCE) / question.points * question.acceleration * timeconst**2


def _mujoco_contact(question: _Question, penetration: float, step: float) -> tuple[float, SoftContact] | None:
    """Return the least impedance from 0.95 on with a timeconst of two steps, and its contact; None if there is none."""
    landing = question.landing
    targets = question.targets
    load = question.relative_load(step)

    def contact_at(d: float) -> SoftContact | None:
        together = shared_impedance(d, question.points)
        w = math.sqrt((1 - together) * question.acceleration / penetration)

        def contact_of(zeta: float) -> SoftContact:
            spring = SoftContact.of_ratio(landing.mass, w, zeta)
            return replace(spring, load_share=1 - together, implicit=False)

        if targets.restitution is None:
            return contact_of(math.sqrt(together / d))  # dampratio = 1
        zeta = ratio_for(targets.restitution, contact_of, step, load)
        return None if zeta is None else contact_of(zeta)

    def spare(d: float) -> float:
        """Return timeconst over two steps, less 1; below 0 where there is no contact."""
        contact = contact_at(d)
        if contact is None:
            return -1.0
        if contact.damping == 0:
            return math.inf  # the direct format, which refsafe leaves as it is
        together = shared_impedance(d, question.points)
        return 2 * landing.mass * together / d / contact.damping / (MUJOCO_STEPS * step) - 1 - LAST_DIGITS

    most = MUJOCO_IMPEDANCES[1]
    d = IMPEDANCE
    if spare(d) < 0:
        if spare(most) < 0:
            return None
        low = d
        high = most
        for _ in range(50):  # a bisection: the mean rebound has small jumps
            middle = (low + high) / 2
            if spare(middle) < 0:
                low = middle
            else:
                high = middle
        d = high
    contact = contact_at(d)
    return None if contact is None else (d, contact)


def _mujoco_answer(question: _Question, solution: tuple[float, SoftContact], step: float) -> EngineAdvice:
    """Return the advice of an impedance and a contact."""
    d, contact = solution
    gain = shared_impedance(d, question.points) / d
    solref: tuple[float, ...]
    if contact.damping == 0:
        solref = (-contact.stiffness / contact.mass / gain, 0.0)
    else:
        timeconst = 2 * contact.mass * gain / contact.damping
        solref = (timeconst, math.sqrt(gain * contact.mass / contact.stiffness) / timeconst)
    defaults_of = question.program.default("solimp")
    settings: Settings = {"solref": solref, "solimp": (d, d, *defaults_of[2:])}
    notes = ["of both geoms, or of a contact pair: MuJoCo mixes the two by solmix"]
    if contact.damping == 0:
        notes.append("solref is (-stiffness, -damping) per mass; without damping a body swings about its depth of rest")
    if d > IMPEDANCE:
        notes.append(
            f"the impedance {d:.6g} is the least from {IMPEDANCE:g} on with which timeconst has two steps (refsafe) "
            "and the steps have the restitution"
        )
    return question.answer(contact, settings, step, question.spread(contact, step), 0.0, notes)


def _yade(question: _Question) -> EngineAdvice:
    """The damping of all forces by restitution or hidden damping, kn by the penetration, the step by kn."""
    targets = question.targets
    landing = question.landing
    alpha = 0.0
    if targets.restitution is not None:
        e = targets.restitution
        alpha = (1 - e**2) / (1 + e**2)
    if targets.hidden is not None:
        allowed = math.tanh(math.pi * targets.hidden)
        if targets.restitution is None:
            alpha = allowed
        elif alpha > allowed:
            raise InputError(
                f"cannot be had beside a restitution of {targets.restitution:g}: Yade's one damping makes both, "
                f"{math.atanh(min(alpha, 1 - 1e-15)) / math.pi:.4g}",
                field="--hidden-damping",
                value=f"{targets.hidden:g}",
                advice="leave one of them out, or take a contact with a dashpot (ViscElMat) and damping = 0",
            )
    if alpha >= 1:
        raise InputError(
            "must be above 0 in Yade, whose damping of all forces would stop every body",
            field="--restitution",
            value=f"{targets.restitution:g}",
            advice="state a small one, 0.01, or take pybullet or mujoco, whose dashpots stop a body nearly for good",
        )
    settings: Settings = {"local_damping": alpha}
    slower = math.sqrt(1 - alpha)
    notes = []
    if alpha:
        notes.append(f"the weight is damped as well: what falls lands at {slower:.4g} of its speed")
    if targets.penetration is None:
        unloaded = SoftContact.of_yade(1.0, 1.0, alpha)
        unloaded_rebounds = engines.spread(unloaded.rebounds(FINE_STEP))
        notes.append(f"at w dt = {FINE_STEP:g} and without the weight; --penetration states kn")
        hidden = unloaded.numerical_ratio(FINE_STEP)
        return question.answer(None, settings, None, unloaded_rebounds, hidden, notes)
    k = landing.load / targets.penetration
    w = math.sqrt(k / landing.mass)
    step = question.step if question.is_step_stated else FINE_STEP / w
    if w * step >= 2:
        raise InputError(
            f"cannot be taken in Yade, whose steps are explicit: w dt = {w * step:.4g} is not below 2",
            field="--step",
            value=f"{step:g} s",
            advice=f"at most {2 / w:.4g} s; GlobalStiffnessTimeStepper takes {YADE_SAFETY * math.sqrt(2) / w:.4g} s",
        )
    contact = SoftContact.of_yade(landing.mass, k, alpha)
    settings["normal_stiffness"] = k / question.points
    settings["dt"] = step
    notes.append("kn of FrictPhys; of a sphere of radius r on a wall of the same material young = kn / r")
    notes.append(f"stable below {2 / w:.4g} s; GlobalStiffnessTimeStepper takes {YADE_SAFETY * math.sqrt(2) / w:.4g} s")
    rebounds = question.spread(contact, step)
    return question.answer(contact, settings, step, rebounds, contact.numerical_ratio(step), notes)


def _opensees(question: _Question) -> EngineAdvice:
    """The penalty by the penetration; average acceleration hides no damping."""
    targets = question.targets
    landing = question.landing
    if targets.restitution not in (None, 1.0):
        raise InputError(
            "cannot be chosen in OpenSees, whose contact elements are springs without a dashpot",
            field="--restitution",
            value=f"{targets.restitution:g}",
            advice="only 1 can be had; zeroLengthImpact3D loses energy by a second stiffness, which is no restitution",
        )
    if targets.penetration is None:
        raise InputError(
            "must be given for opensees, which has no default penalty",
            field="--penetration",
            advice="add --penetration",
        )
    k = landing.load / targets.penetration
    contact = SoftContact(landing.mass, k, 0.0)
    w = contact.frequency
    step = question.step
    rebounds = None
    if targets.restitution is not None:
        statistics = rebound.rebound_statistics(rebound.spring_steps(stages.newmark(0.25, 0.5), w * step))
        rebounds = {"mean": statistics.mean, "low": statistics.least, "high": statistics.most}
    settings: Settings = {
        "penalty": k / question.points,
        "gamma": 0.5,
        "beta": 0.25,
        "dt": step,
    }
    notes = ["integrator('Newmark', 0.5, 0.25): a gamma of 1/2 + delta would hide about delta w dt of critical damping"]
    return question.answer(contact, settings, step, rebounds, 0.0, notes)


_ADVICE = {"box2d": _box2d, "mujoco": _mujoco, "opensees": _opensees, "pybullet": _pybullet, "yade": _yade}
