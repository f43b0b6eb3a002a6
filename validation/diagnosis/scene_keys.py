"""What to type for the suite to step a scene as a history was: the keys of schemes and contact methods."""

from __future__ import annotations

from collections.abc import Sequence

from validation.diagnosis.causes import CAUSES, CONTACT_METHODS
from validation.diagnosis.schemes import scheme_numbers
from validation.diagnosis.variant import Variant

OF_STEP = frozenset({"scheme", "start", "gg"})  # causes that keys of `time` state, besides the schemes of other names
NOT_IN_SCENES = frozenset({"theta", "symplectic-euler"})
Keys = dict[str, float | str]


def assignments(ids: Sequence[str], v: Variant, scene: Variant) -> str:
    """Return the options by which a scene is stepped as the causes of an answer say; empty where keys cannot say it."""
    known = OF_STEP | CONTACT_METHODS | {name for name, cause in CAUSES.items() if cause.family}
    if not ids or not set(ids) <= known or set(ids) & NOT_IN_SCENES or v.contact == "mean gap" or not v.clipped:
        return ""
    if _of_contact(v) and not scene.opens:
        return ""
    values: Keys = {}
    for part, own in zip(_keys(v), _keys(scene), strict=True):
        if part != own:
            values |= {key: value for key, value in part.items() if key != "time.scheme" or value != own.get(key)}
    # with the digits that a fit tells of a number
    return " ".join(
        f"--set {key}={value if isinstance(value, str) else f'{value:.7g}'}" for key, value in values.items()
    )


def _keys(v: Variant) -> tuple[Keys, ...]:
    return _of_scheme(v), _of_contact(v), {"time.start": v.start}, {"time.gg": v.gg}


def _of_scheme(v: Variant) -> Keys:
    if v.contact == "impact":
        return {"time.scheme": "newmark", "time.alpha": v.spectral**2, "time.delta": 2 * v.spectral - 0.5}
    if v.family == "newmark":
        return {"time.scheme": "newmark", "time.alpha": v.alpha, "time.delta": v.delta}
    numbers = {f"time.{key}": value for key, value in scheme_numbers(v).items() if key in ("rho_inf", "split")}
    return {"time.scheme": v.family, **numbers}


def _of_contact(v: Variant) -> Keys:
    rigid: Keys = {"contact.stiffness": "inf", "contact.shear_stiffness": "0"}
    if v.contact == "impact":
        return {"contact.rule": "impact", "contact.restitution": v.restitution, **rigid}
    if v.contact == "dashpot":
        return {"contact.damping_ratio": v.dashpot}
    if v.contact == "rigid":
        return rigid
    return {"contact.rule": v.contact} if v.contact in ("implicit", "energy-conserving") else {}
