"""The soft constraints of physics engines, translated to spring and dashpot, and back to each other."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

from validation.advice.engine_table import (
    BOX2D_LIMIT,
    BOX2D_STATIC,
    GRAVITY,
    MUJOCO_STEPS,
    OPTIONAL,
    PARAMETERS,
    PROGRAMS,
    TRANSLATED,
)
from validation.advice.limits import Limit, check_choice
from validation.advice.plain import PlainAnswer
from validation.errors import InputError
from validation.runs.history import Array
from validation.theory.restitution import damping_ratio, restitution
from validation.theory.soft_contact import QUARTER, Impedance, SoftContact, local_damping_restitution

RADIUS_TOLERANCE = 1e-12  # of the spectral radius of a step that keeps the amplitude


@dataclass(frozen=True)
class Translation(PlainAnswer):
    """One contact in the words of each engine and of the suite."""

    engine: str  # whose numbers were stated, or "spring"
    mass: float  # effective, m [kg]
    weight: float  # that stands on it [N]
    stiffness: float  # k [N/m]
    damping: float  # c [N s/m]
    frequency: float  # w = sqrt(k/m) [rad/s]
    damping_ratio: float  # zeta = c / (2 sqrt(k m)) [-]
    restitution: float  # of an unloaded landing, exact in time, force not below 0 [-]
    rest_penetration: float  # under the weight [m]
    load_share: float  # of the weight that the spring carries [-]
    step: float | None  # h [s]
    omega_step: float | None  # W = w h [-]
    determinant: float | None  # of a closed step of the engine [-]
    spectral_radius: float | None  # [-]
    rebound: dict[str, float] | None  # of the engine's steps, over the phase: mean, low, high [-]
    numerical_ratio: float | None  # damping ratio that the steps add to a free vibration of the spring [-]
    forms: dict[str, dict[str, float]]  # engine -> its parameters for this spring and dashpot
    scene: dict[str, float]  # keys of the scene of a block on two corners
    notes: tuple[str, ...]


def translate(
    engine: str,
    *,
    mass: float | None = None,
    block_mass: float | None = None,
    step: float | None = None,
    gravity: float = GRAVITY,
    points: int = 1,
    box: tuple[float, ...] | None = None,
    static: bool = False,
    **parameters: Any,
) -> Translation:
    """Return what an engine's soft contact is as spring and dashpot, and in the words of the other engines.

    Without any parameter the program is taken as it comes, at its own step where none is stated.

    Parameters
    ----------
    engine
        "box2d", "bullet", "pybullet", "mujoco", "yade", "opensees", or "spring" for the way back.
    mass
        Effective mass of the contact, m [kg]: of one body that meets the ground flat its mass, of two m1 m2/(m1 + m2).
    block_mass
        Instead: mass of a block of one strain on springs much stiffer than itself, of which the contact feels a
        quarter.
    step
        h [s]; Bullet's parameters have no meaning without.
    gravity
        g [m/s^2] of the weight that stands in the contact.
    points
        Contact points that share the body, each with these parameters.
    box
        Width and height [m] of a flat box on two points of Box2D, where a point feels less than the mass.
    static
        Whether the other body of Box2D's contact is a static one, where the hertz count twice.
    **parameters
        Of the engine (`PARAMETERS`): hertz and damping_ratio; erp and cfm; contact_stiffness and contact_damping;
        timeconst, dampratio and dmax (0.95), or solimp = (dmin, dmax, width, midpoint, power); normal_stiffness and
        local_damping; penalty; stiffness and damping or restitution.

    Raises
    ------
    InputError
        A parameter is missing, unknown, or out of its range.

    Examples
    --------
    >>> from validation import translate
    >>> contact = translate("box2d", hertz=30, damping_ratio=10, mass=2700, step=1 / 240)
    >>> round(1e3 * contact.rest_penetration, 6), round(contact.determinant, 8)
    (0.2761, 0.05772068)
    """
    check_choice("engine", engine, PARAMETERS)
    for name in parameters:
        if name not in PARAMETERS[engine]:
            rule = f"is no parameter of {engine}"
            raise InputError(rule, field=name, advice=f"it has {', '.join(PARAMETERS[engine])}")
    notes = []
    program = PROGRAMS.get(engine)
    if program is not None and not parameters and program.defaults:
        parameters = program.defaults
        step = program.step if step is None else step
        at_step = "" if step is None else f", step {step:.6g} s"
        stated_parameters = ", ".join(f"{name} = {_in_words(value)}" for name, value in parameters.items())
        notes.append(f"{program.title} as it comes: {stated_parameters}{at_step}")
    described = TRANSLATED[engine].parameters
    missing = [one for one in described if one.name not in parameters and one.name not in OPTIONAL]
    if engine == "mujoco" and [one.name for one in missing] == ["solimp"]:
        missing = []  # dmax stands in its place
    if missing:
        raise InputError(f"must be stated for {engine}", field=missing[0].name, advice=missing[0].absent)
    Limit("points", "must be at least 1").check(points)
    if box is not None:
        _require(len(box) == 2 and min(box) > 0, "must be a positive width and height", "box", box)
    Limit("step", "must be positive").check(step)
    effective, weight = _masses(mass, block_mass, gravity)
    body = Body(effective, weight, step, points, lever(box, points), static)
    contact = contact_of(engine, body, parameters)
    Limit("stiffness").check(contact.stiffness)
    solimp = parameters.get("solimp")
    has_constant_numbers = solimp is None or solimp[0] == solimp[1]
    if not has_constant_numbers:
        notes.append("k, c and the restitution are those of the impedance at rest, which a landing passes through")
    return _translation(engine, contact, body, block_mass or effective, has_constant_numbers, notes)


@dataclass(frozen=True)
class Body:
    """What stands on a contact."""

    mass: float  # effective [kg]
    weight: float  # [N]
    step: float | None = None  # [s]
    points: int = 1  # contact points that share it
    lever: float = 0.0  # r^2 m / I of a point at the arm r [-]
    static: bool = False  # whether the other body is static


def lever(box: tuple[float, ...] | None, points: int) -> float:
    """Return r^2 m / I of a corner of a flat box: 3 w^2 / (w^2 + h^2); 0 of a point below the centre."""
    if box is None or points == 1:
        return 0.0
    width, height = box
    return 3 * width**2 / (width**2 + height**2)


def _in_words(value: float | tuple[float, ...]) -> str:
    return " ".join(f"{number:g}" for number in value) if isinstance(value, tuple) else f"{value:g}"


def _require(holds: bool, rule: str, field: str, value: object, advice: str | None = None) -> None:
    """Refuse a value; NaN holds no rule."""
    if not holds:
        raise InputError(rule, field=field, value=f"{value:g}" if isinstance(value, float) else value, advice=advice)


def _masses(mass: float | None, block_mass: float | None, gravity: float) -> tuple[float, float]:
    """Return effective mass [kg] and weight [N]."""
    if (mass is None) == (block_mass is None):
        raise InputError(
            "one of them must be stated",
            field="mass, block_mass",
            value="neither" if mass is None else "both",
            advice="stiffness follows the mass: mass = m of one body, m1 m2/(m1 + m2) of two; "
            "block_mass of a DDA block, whose contact feels a quarter",
        )
    name, value = ("mass", mass) if mass is not None else ("block_mass", block_mass)
    total = float(value or 0.0)
    Limit(name).check(total)
    Limit("gravity", "must not be negative", ends=(0.0,)).check(gravity)
    effective = total if mass is not None else QUARTER * total
    return effective, total * gravity


def contact_of(engine: str, body: Body, parameters: Mapping[str, Any]) -> SoftContact:
    """Return the contact that a body has with parameters of an engine.

    Raises
    ------
    InputError
        A parameter is out of its range.
    """
    for parameter in TRANSLATED[engine].parameters:
        if parameter.limit is not None:
            parameter.limit.check(parameters.get(parameter.name))
    mass = body.mass
    points = body.points
    if engine == "box2d":
        hertz = BOX2D_STATIC * parameters["hertz"] if body.static else parameters["hertz"]
        return SoftContact.of_box2d(mass, hertz, parameters["damping_ratio"], points, body.lever)
    if engine == "bullet":
        if body.step is None:
            advice = "erp and cfm are those of one step: --step 0.0041666667 for 240 a second"
            raise InputError("must be stated for bullet", field="step", advice=advice)
        return SoftContact.of_bullet(mass, parameters["erp"], parameters["cfm"] / points, body.step)
    if engine == "pybullet":
        stiffness = points * parameters["contact_stiffness"]
        return SoftContact.of_pybullet(mass, stiffness, points * parameters["contact_damping"], points > 1)
    if engine == "yade":
        return SoftContact.of_yade(mass, points * parameters["normal_stiffness"], parameters["local_damping"])
    if engine == "opensees":
        return SoftContact(mass, points * parameters["penalty"], 0.0)
    return _mujoco(body, parameters) if engine == "mujoco" else _spring(body, parameters)


def _mujoco(body: Body, parameters: Mapping[str, Any]) -> SoftContact:
    """Return the contact of solref and solimp."""
    timeconst = parameters["timeconst"]
    dampratio = parameters["dampratio"]
    is_direct = timeconst < 0 and dampratio <= 0
    if not is_direct:
        advice = "(-stiffness, -damping) per mass is MuJoCo's other form, both not above 0"
        Limit("timeconst", "must be positive", advice=advice).check(timeconst)
        Limit("dampratio", "must be positive", advice=advice).check(dampratio)
    if body.step is not None and not is_direct:
        least = MUJOCO_STEPS * body.step
        advice = f"MuJoCo takes {least:g} instead (refsafe): state that, or a step of at most {timeconst / 2:g} s"
        _require(timeconst >= least, f"must be at least two steps, {least:g} s", "timeconst", timeconst, advice)
    if parameters.get("solimp") is None:
        return SoftContact.of_mujoco(body.mass, timeconst, dampratio, parameters.get("dmax", 0.95), 1.0, body.points)
    if "dmax" in parameters:
        raise InputError("must not be stated beside solimp, whose second number it is", field="dmax")
    numbers = tuple(parameters["solimp"])
    _require(len(numbers) == 5, "must be dmin, dmax, width, midpoint, power", "solimp", numbers)
    curve = Impedance(*numbers)
    ranges = 0 < curve.least <= curve.greatest < 1 and curve.width > 0 and 0 < curve.midpoint < 1 and curve.power >= 1
    rule = "must have 0 < dmin <= dmax < 1, a positive width, a midpoint between 0 and 1 and a power of at least 1"
    _require(ranges, rule, "solimp", numbers)
    frequency = math.sqrt(-timeconst) if is_direct else 1 / (timeconst * dampratio)
    # a point of n carries an n-th of the load, and the shared impedance has (1 - d') / d' = (1 - d) / (n d)
    impedance = curve.at_rest(frequency, body.weight / body.mass / body.points)
    share = impedance / curve.greatest
    return SoftContact.of_mujoco(body.mass, timeconst, dampratio, impedance, share, body.points)


def _spring(body: Body, parameters: Mapping[str, Any]) -> SoftContact:
    """Return the contact of k and c, or of k and the restitution that it shall have."""
    stiffness = parameters["stiffness"]
    e = parameters.get("restitution")
    if e is None:
        return SoftContact(body.mass, stiffness, parameters.get("damping", 0.0))
    if "damping" in parameters:
        raise InputError("one of them can be stated", field="damping, restitution", value="both")
    return SoftContact.of_ratio(body.mass, math.sqrt(stiffness / body.mass), damping_ratio(e))


OWN_STEPS = ("bullet", "pybullet", "mujoco", "yade", "spring")
"""Whose landing is that of `SoftContact.rebounds`; Box2D's relaxation takes the spring's speed again."""


def _translation(
    engine: str,
    contact: SoftContact,
    body: Body,
    body_mass: float,
    has_constant_numbers: bool,
    notes: list[str],
) -> Translation:
    """Return all that follows from a spring, a dashpot and how they are stepped."""
    w = contact.frequency
    ratio = contact.ratio
    step = body.step
    rebound = None
    numerical_ratio = None
    if step is not None and engine in OWN_STEPS and has_constant_numbers:
        numerical_ratio = contact.numerical_ratio(step)
        if contact.spectral_radius(step) <= 1 + RADIUS_TOLERANCE:
            rebound = spread(contact.rebounds(step))
    has_step_matrix = engine not in ("yade", "opensees")  # damped by a sign; average acceleration
    e = restitution(ratio)
    if contact.local_damping:
        e = local_damping_restitution(contact.local_damping)
    return Translation(
        engine=engine,
        mass=contact.mass,
        weight=body.weight,
        stiffness=contact.stiffness,
        damping=contact.damping,
        frequency=w,
        damping_ratio=ratio,
        restitution=e,
        rest_penetration=contact.rest_penetration(body.weight),
        load_share=contact.load_share,
        step=step,
        omega_step=None if step is None else w * step,
        determinant=contact.determinant(step) if step is not None and has_step_matrix else None,
        spectral_radius=contact.spectral_radius(step) if step is not None and has_step_matrix else None,
        rebound=rebound,
        numerical_ratio=numerical_ratio,
        forms=_forms(contact, step),
        # both corners of the block act at once, and the scene's ratio is that of its whole mass
        scene={
            "contact.stiffness": contact.stiffness / 2,
            "contact.damping_ratio": contact.damping / (2 * math.sqrt(contact.stiffness * body_mass)),
        },
        notes=(*notes, *_notes(engine, contact, body)),
    )


def spread(values: Array) -> dict[str, float]:
    """Return mean, least and greatest of the rebounds over the phase."""
    return {"mean": float(values.mean()), "low": float(values.min()), "high": float(values.max())}


def _forms(contact: SoftContact, step: float | None) -> dict[str, dict[str, float]]:
    """Return the parameters with which each engine has this spring and dashpot."""
    w = contact.frequency
    ratio = contact.ratio
    forms = {"box2d": {"hertz": w / (2 * math.pi), "damping_ratio": ratio}}
    if step is not None:
        W = w * step
        a1 = 2 * ratio + W
        a2 = W * a1
        forms["box2d"] |= {"bias_rate": w / a1, "mass_scale": a2 / (1 + a2), "impulse_scale": 1 / (1 + a2)}
        resistance = step * contact.stiffness + contact.damping
        forms["bullet"] = {"erp": step * contact.stiffness / resistance, "cfm": 1 / resistance}
    forms["pybullet"] = {"contact_stiffness": contact.stiffness, "contact_damping": contact.damping}
    if ratio > 0:  # without a dashpot timeconst = 1 / (w zeta) is infinite
        forms["mujoco"] = {"timeconst": 1 / (w * ratio), "dampratio": ratio}
    return forms


def _notes(engine: str, contact: SoftContact, body: Body) -> list[str]:
    """Return what a user of these numbers should know."""
    notes = []
    step = body.step
    if engine == "box2d":
        notes.append(
            "the restitution is that of the spring: Box2D relaxes every sub-step, its contact rebounds by the "
            "restitution of the shapes alone"
        )
        if step is not None:
            hertz = contact.frequency / math.sqrt(body.points / (1 + body.lever)) / (2 * math.pi)
            limit = BOX2D_LIMIT / step * (BOX2D_STATIC if body.static else 1.0)
            if hertz > limit * (1 + 1e-6):
                fixed = "" if body.static else f", {BOX2D_STATIC * limit:.4g} Hz on a static body"
                notes.append(f"Box2D gives a contact at this substep at most {limit:.4g} Hz{fixed}")
    if engine == "mujoco":
        notes.append(
            f"MuJoCo's spring carries {contact.load_share:.4g} of the load, its impedance the rest: the other engines "
            f"stand {1 / contact.load_share:.4g} times as deep on the same spring"
        )
    if engine == "yade":
        notes.append(
            "Yade damps the sum of all forces, the weight in free fall too: what falls lands more slowly, at "
            f"{math.sqrt(1 - contact.local_damping):.4g} of the speed"
        )
    if step is not None and engine != "opensees":
        radius = contact.spectral_radius(step)
        if radius > 1 + RADIUS_TOLERANCE:
            notes.append(f"the closed step grows by {radius:.4g}: take a shorter step or a softer contact")
    return notes
