"""What to type for the suite to step a scene as a history was: the keys of schemes and contact methods."""

from __future__ import annotations

from collections.abc import Sequence

from validation.diagnosis.causes import CONTACT_METHODS, LISTED
from validation.diagnosis.schemes import split_of
from validation.diagnosis.variant import Variant

OF_STEP = frozenset({"scheme", "start", "gg"})  # causes that keys of `time` state, besides the schemes of other names
NOT_IN_SCENES = frozenset({"theta", "symplectic-euler"})


def assignments(ids: Sequence[str], v: Variant, scene: Variant) -> str:
    """Return the options by which a scene is stepped as the causes say; empty where its keys cannot say it.

    Parameters
    ----------
    ids
        Causes of the answer.
    v, scene
        The explanation, and the scene's own scheme and contact.
    """
    known = OF_STEP | CONTACT_METHODS | {name for name, cause in LISTED.items() if cause.family}
    if not ids or not set(ids) <= known or set(ids) & NOT_IN_SCENES or v.contact == "mean gap" or not v.clipped:
        return ""
    values: dict[str, str] = {}
    if v.contact == "impact":
        values |= {"contact.rule": "impact", "contact.stiffness": "inf", "contact.restitution": _number(v.restitution)}
        values |= {"time.alpha": _number(v.spectral**2), "time.delta": _number(2 * v.spectral - 0.5)}
    elif v.family == "newmark":
        if scene.family != "newmark":
            values["time.scheme"] = "newmark"
        if (scene.family, scene.alpha, scene.delta) != ("newmark", v.alpha, v.delta):
            values |= {"time.alpha": _number(v.alpha), "time.delta": _number(v.delta)}
    elif v.family != scene.family or (v.spectral, v.split) != (scene.spectral, scene.split):
        values["time.scheme"] = v.family
        if v.family != "leapfrog":
            rho_inf = (1 - v.spectral) / (1 + v.spectral) if v.family == "hht" else v.spectral
            values["time.rho_inf"] = _number(rho_inf)
        if v.family == "composite":
            values["time.split"] = _number(split_of(v))
    if v.contact in ("implicit", "energy-conserving"):
        values["contact.rule"] = v.contact
    if v.contact == "rigid":
        values["contact.stiffness"] = "inf"
    if v.contact in ("rigid", "impact"):
        values["contact.shear_stiffness"] = "0"
    if v.contact == "dashpot":
        values["contact.damping_ratio"] = _number(v.dashpot)
    if v.start != scene.start:
        values["time.start"] = v.start
    if v.gg != scene.gg:
        values["time.gg"] = _number(v.gg)
    if any(key.startswith("contact.") for key in values) and not scene.opens:
        return ""
    return " ".join(f"--set {key}={value}" for key, value in values.items())


def _number(value: float) -> str:
    """Return a fitted number with the digits that a fit tells."""
    return f"{value:.7g}"
