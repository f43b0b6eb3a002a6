"""The soft constraints of physics engines, translated to spring and dashpot, and back to each other."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import asdict, dataclass
from typing import Any

from validation.errors import InputError
from validation.theory.restitution import damping_ratio, restitution
from validation.theory.soft_contact import QUARTER, Impedance, SoftContact

GRAVITY = 9.81  # m/s2
BOX2D_LIMIT = 0.125  # of the rate of substeps: the greatest hertz of a contact between moving bodies
BOX2D_STATIC = 2.0  # a contact with a static body has this many times the hertz
MUJOCO_STEPS = 2.0  # steps that timeconst must have
PARAMETERS = {  # engine -> its parameters, those that have a default after the others
    "box2d": ("hertz", "damping_ratio"),
    "bullet": ("erp", "cfm"),
    "mujoco": ("timeconst", "dampratio", "dmax", "solimp"),
    "spring": ("stiffness", "damping", "restitution"),
}
OPTIONAL = {"dmax", "solimp", "damping", "restitution"}


@dataclass(frozen=True)
class Translation:
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
    forms: dict[str, dict[str, float]]  # engine -> its parameters for this spring and dashpot
    scene: dict[str, float]  # keys of the scene of a block on two corners
    notes: tuple[str, ...]

    def as_dict(self) -> dict[str, Any]:
        """Return plain data for JSON."""
        return asdict(self)


def translate(
    engine: str,
    *,
    mass: float | None = None,
    block_mass: float | None = None,
    step: float | None = None,
    gravity: float = GRAVITY,
    **parameters: Any,
) -> Translation:
    """Return what an engine's soft contact is as spring and dashpot, and in the words of the other engines.

    Parameters
    ----------
    engine
        "box2d", "bullet", "mujoco", or "spring" for the way back.
    mass
        Effective mass of the contact, m [kg]: of one body that meets the ground flat its mass, of two m1 m2/(m1 + m2).
    block_mass
        Instead: mass of a block of one strain on springs much stiffer than itself, of which the contact feels a
        quarter.
    step
        h [s]; Bullet's parameters have no meaning without.
    gravity
        g [m/s^2] of the weight that stands in the contact.
    **parameters
        Of the engine (`PARAMETERS`): hertz and damping_ratio; erp and cfm; timeconst, dampratio and dmax (0.95), or
        solimp = (dmin, dmax, width, midpoint, power); stiffness and damping or restitution.

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
    if engine not in PARAMETERS:
        raise InputError(f"must be one of {', '.join(PARAMETERS)}", field="engine", value=repr(engine))
    for name in parameters:
        if name not in PARAMETERS[engine]:
            rule = f"is no parameter of {engine}"
            raise InputError(rule, field=name, advice=f"it has {', '.join(PARAMETERS[engine])}")
    missing = [name for name in PARAMETERS[engine] if name not in parameters and name not in OPTIONAL]
    if missing:
        raise InputError(f"must be stated for {engine}", field=missing[0])
    effective, weight = _masses(mass, block_mass, gravity)
    if step is not None:
        _require(step > 0, "must be positive", "step", step)
    contact = _CONTACTS[engine](effective, weight, step, parameters)
    if contact.stiffness <= 0 or not math.isfinite(contact.stiffness):
        raise InputError("must be positive and finite", field="stiffness", value=f"{contact.stiffness:g}")
    return _translation(engine, contact, weight, block_mass or effective, step)


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
    _require(0 < total < math.inf, "must be positive and finite", name, total)
    _require(0 <= gravity < math.inf, "must not be negative", "gravity", gravity)
    effective = total if mass is not None else QUARTER * total
    return effective, total * gravity


Parameters = Mapping[str, Any]


def _box2d(mass: float, weight: float, step: float | None, parameters: Parameters) -> SoftContact:
    """Return the contact of hertz and damping ratio."""
    hertz = parameters["hertz"]
    ratio = parameters["damping_ratio"]
    _require(0 < hertz < math.inf, "must be positive and finite", "hertz", hertz)
    _require(0 <= ratio < math.inf, "must not be negative", "damping_ratio", ratio)
    return SoftContact.of_box2d(mass, hertz, ratio)


def _bullet(mass: float, weight: float, step: float | None, parameters: Parameters) -> SoftContact:
    """Return the contact of erp and cfm."""
    erp = parameters["erp"]
    cfm = parameters["cfm"]
    if step is None:
        advice = "erp and cfm are those of one step: --step 0.0041666667 for 240 a second"
        raise InputError("must be stated for bullet", field="step", advice=advice)
    _require(0 < erp <= 1, "must be above 0 and at most 1", "erp", erp)
    _require(0 < cfm < math.inf, "must be positive", "cfm", cfm, "cfm = 0 is a rigid contact: contact.stiffness = inf")
    return SoftContact.of_bullet(mass, erp, cfm, step)


def _mujoco(mass: float, weight: float, step: float | None, parameters: Parameters) -> SoftContact:
    """Return the contact of solref and solimp."""
    timeconst = parameters["timeconst"]
    dampratio = parameters["dampratio"]
    advice = "a negative solref is (-stiffness, -damping) per mass: translate spring takes k and c"
    _require(0 < timeconst < math.inf, "must be positive", "timeconst", timeconst, advice)
    _require(0 < dampratio < math.inf, "must be positive", "dampratio", dampratio, advice)
    if step is not None:
        least = MUJOCO_STEPS * step
        advice = f"MuJoCo takes {least:g} instead (refsafe): state that, or a step of at most {timeconst / 2:g} s"
        _require(timeconst >= least, f"must be at least two steps, {least:g} s", "timeconst", timeconst, advice)
    if parameters.get("solimp") is None:
        impedance = parameters.get("dmax", 0.95)
        _require(0 < impedance < 1, "must be between 0 and 1", "dmax", impedance)
        return SoftContact.of_mujoco(mass, timeconst, dampratio, impedance, 1.0)
    if "dmax" in parameters:
        raise InputError("must not be stated beside solimp, whose second number it is", field="dmax")
    numbers = tuple(parameters["solimp"])
    _require(len(numbers) == 5, "must be dmin, dmax, width, midpoint, power", "solimp", numbers)
    curve = Impedance(*numbers)
    ranges = 0 < curve.least <= curve.greatest < 1 and curve.width > 0 and 0 < curve.midpoint < 1 and curve.power >= 1
    rule = "must have 0 < dmin <= dmax < 1, a positive width, a midpoint between 0 and 1 and a power of at least 1"
    _require(ranges, rule, "solimp", numbers)
    impedance = curve.at_rest(1 / (timeconst * dampratio), weight / mass)
    return SoftContact.of_mujoco(mass, timeconst, dampratio, impedance, impedance / curve.greatest)


def _spring(mass: float, weight: float, step: float | None, parameters: Parameters) -> SoftContact:
    """Return the contact of k and c, or of k and the restitution that it shall have."""
    stiffness = parameters["stiffness"]
    damping = parameters.get("damping")
    e = parameters.get("restitution")
    _require(0 < stiffness < math.inf, "must be positive and finite", "stiffness", stiffness)
    if damping is not None and e is not None:
        raise InputError("one of them can be stated", field="damping, restitution", value="both")
    if e is not None:
        _require(0 < e <= 1, "must be above 0 and at most 1", "restitution", e, "a dashpot always returns something")
        return SoftContact.of_ratio(mass, math.sqrt(stiffness / mass), damping_ratio(e))
    damping = 0.0 if damping is None else damping
    _require(0 <= damping < math.inf, "must not be negative", "damping", damping)
    return SoftContact(mass, stiffness, damping)


_CONTACTS = {"box2d": _box2d, "bullet": _bullet, "mujoco": _mujoco, "spring": _spring}


def _translation(engine: str, contact: SoftContact, weight: float, body_mass: float, step: float | None) -> Translation:
    """Return all that follows from a spring, a dashpot and how they are stepped."""
    w = contact.frequency
    ratio = contact.ratio
    rebound = None
    if step is not None and contact.spectral_radius(step) <= 1:
        values = contact.rebounds(step)
        rebound = {"mean": float(values.mean()), "low": float(values.min()), "high": float(values.max())}
    return Translation(
        engine=engine,
        mass=contact.mass,
        weight=weight,
        stiffness=contact.stiffness,
        damping=contact.damping,
        frequency=w,
        damping_ratio=ratio,
        restitution=restitution(ratio),
        rest_penetration=contact.rest_penetration(weight),
        load_share=contact.load_share,
        step=step,
        omega_step=None if step is None else w * step,
        determinant=None if step is None else contact.determinant(step),
        spectral_radius=None if step is None else contact.spectral_radius(step),
        rebound=rebound,
        forms=_forms(contact, step),
        # both corners of the block act at once, and the scene's ratio is that of its whole mass
        scene={
            "contact.stiffness": contact.stiffness / 2,
            "contact.damping_ratio": contact.damping / (2 * math.sqrt(contact.stiffness * body_mass)),
        },
        notes=tuple(_notes(engine, contact, step)),
    )


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
    if ratio > 0:  # without a dashpot timeconst = 1 / (w zeta) is infinite
        forms["mujoco"] = {"timeconst": 1 / (w * ratio), "dampratio": ratio}
    return forms


def _notes(engine: str, contact: SoftContact, step: float | None) -> list[str]:
    """Return what a user of these numbers should know."""
    notes = []
    hertz = contact.frequency / (2 * math.pi)
    if engine == "box2d" and step is not None:
        limit = min(30.0, BOX2D_LIMIT / step)
        if hertz > limit * (1 + 1e-6):
            fixed = BOX2D_STATIC * limit
            notes.append(
                f"Box2D gives a contact at this substep at most {limit:.4g} Hz, {fixed:.4g} Hz on a static body"
            )
    if engine == "mujoco":
        notes.append(
            f"MuJoCo's spring carries {contact.load_share:.4g} of the load, its impedance the rest: the other engines "
            f"stand {1 / contact.load_share:.4g} times as deep on the same spring"
        )
    if step is not None:
        radius = contact.spectral_radius(step)
        if radius > 1 + 1e-12:
            notes.append(f"the closed step grows by {radius:.4g}: take a shorter step or a softer contact")
    return notes
