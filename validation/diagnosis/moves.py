"""The candidate changes: ways to put a cause into the scene's own computation, fixed or with numbers that are fitted.

Where its numbers start is part of it.
"""

from __future__ import annotations

import math
import tomllib
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np

from validation.diagnosis.fits.fit import NAMED
from validation.diagnosis.fits.target import Target
from validation.diagnosis.schemes import EXPLICIT, SHARED, Family
from validation.diagnosis.stepping import UNEQUAL, histories
from validation.diagnosis.variant import Variant


@dataclass(frozen=True, eq=False)
class Move:
    """One way to put a cause into a computation."""

    id: str
    changes: Mapping[str, Any] = field(default_factory=dict)
    free: tuple[str, ...] = ()  # numbers that a fit finds
    starts: Sequence[float] = ()  # of the first of them


def fixed(name: str, **changes: Any) -> Move:
    """Return a cause that has no number to fit."""
    return Move(name, changes)


def fitted(name: str, number: str, starts: Sequence[float], **changes: Any) -> Move:
    """Return a cause with one number that a fit finds."""
    return Move(name, changes, (number,), starts)


UNITS = (1e-6, 1e-3, 1e3, 1e6)  # factors of data in other units
BY_HAND = np.geomspace(0.1, 10, 24).tolist()
STARTS = {
    "by hand": BY_HAND,
    "factors": [*BY_HAND, *UNITS],
    "softnesses": [0.02, *np.linspace(-math.log(30), math.log(30), 24).tolist(), *np.log(UNITS).tolist()],
}
DISCOUNTS = (0.999, 0.99, 0.97, 0.93, 0.8, 0.5)
STIFFNESS_DRAGS = np.array([0.02, 0.2, 1.0])  # steps
RAMPS = np.array([3.0, 8.0, 20.0])  # steps
ALPHA_F = (0.05, 0.15, 0.3)  # of HHT
RHO_INF = (0.2, 0.5, 0.8)
THETA = (0.55, 0.7, 0.9)
SPLITS = (0.35, 0.5, 0.65)  # of a composite scheme
DASHPOTS = tuple(np.geomspace(0.01, 5.0, 22).tolist())  # c / (2 sqrt(k m))
RESTITUTIONS = tuple(round(0.05 * i, 2) for i in range(21))
AVERAGE_ACCELERATION = {"alpha": 0.25, "delta": 0.5, "start": "consistent"}
CONSTANT_ACCELERATION = {"alpha": 0.5, "delta": 1.0, "start": "zero"}
PARTS = (2, 3, 4, 5, 8, 10, 20)  # steps of a program in one of the scene's
UNNAMED = ((0.3, 0.6), (0.4, 0.8), (0.6, 1.1))  # alpha, delta to begin with
BANDS = np.geomspace(1e-4, 2.0, 44).tolist()  # over the static displacement
FINE_BANDS = np.geomspace(1e-4, 2.0, 131).tolist()  # between closings of successive steps
REOPENINGS = (0.0, 1e-3, 1.0)  # gap that opens over the penetration that closes; ntdda has 1e-3


TABLE = tomllib.loads(Path(__file__).with_suffix(".toml").read_text(encoding="utf-8"))


def moves(target: Target, scene: Variant) -> list[Move]:
    """Return every way in which the catalogue's causes may be in a history of a scene."""
    return [
        *_integrator(target, scene),
        *_of_table("output", target, scene),
        *_of_table("model", target, scene),
        *_model(target, scene),
        *_contact(target, scene),
    ]


def _of_table(part: str, target: Target, scene: Variant) -> Iterator[Move]:
    """Yield the changes of the table that a scene and what is recorded of it allow."""
    met = {
        "": True,
        "locked": not scene.opens,
        "pressure": target.pressure is not None,
        "gravity": bool(target.column.gravity),
        "poisson": bool(target.column.poisson),
    }
    for row in TABLE[part]:
        if not met[row.get("when", "")]:
            continue
        for name, values in row.get("each", {}).items():
            for value in values:
                yield fixed(row["cause"], **{name: value})
        if "free" in row:
            starts = row["starts"]
            starts = STARTS[starts] if isinstance(starts, str) else starts
            yield fitted(row["cause"], row["free"], starts, **row.get("with", {}))


def _integrator(target: Target, scene: Variant) -> list[Move]:
    is_newmark = scene.family == "newmark"
    scene_pair = (scene.alpha, scene.delta) if is_newmark else None
    other = "zero" if scene.start == "consistent" else "consistent"
    starts = (scene.start, other)
    candidates = []
    for start in starts:
        newmark = {"family": "newmark", "start": start}
        candidates += [fixed("scheme", alpha=a, delta=d, **newmark) for a, d in NAMED.values() if (a, d) != scene_pair]
        pairs = (*((scene_pair,) if scene_pair else ()), *UNNAMED)
        candidates += [Move("scheme", {"alpha": a, "delta": d, **newmark}, ("alpha", "delta")) for a, d in pairs]
    if scene.gg < 1:
        candidates += [fixed("gg", gg=gg) for gg in (scene.gg**2, math.sqrt(scene.gg), 1.0)]
        candidates += [fixed("gg-in-one-formula", discounted=name) for name in ("velocity", "displacement")]
    candidates.append(fitted("gg", "gg", DISCOUNTS))
    if has_start(scene):
        candidates.append(fixed("start", start=other))
    if is_newmark and scene.delta not in (0.5, 1.0):
        candidates.append(fixed("scheme", delta=1 - scene.delta))  # the two weights of (7) are swapped
    # integrators that are no pair of numbers of Newmark's, and other lengths of their steps
    candidates += [fixed("substeps", parts=parts) for parts in PARTS]
    has_equal_steps = float(np.ptp(target.steps)) <= UNEQUAL * float(target.steps[0])
    if has_equal_steps and not (scene.opens and target.column.poisson):
        candidates += other_families(scene, starts)
    if scene.opens:
        return candidates
    if has_equal_steps:
        candidates.append(fixed("exact-in-time", exact=True, gg=1.0))
    return [*candidates, fixed("velocity", secant=True)]


def has_start(v: Variant) -> bool:
    """Whether a scheme starts from an acceleration that may be zero or consistent."""
    return v.family not in EXPLICIT and not (v.family == "theta" and v.spectral == 1)


def other_families(scene: Variant, starts: Sequence[str]) -> Iterator[Move]:
    """Yield the schemes that are no pair of numbers of Newmark's, where two names are one scheme at fixed numbers too.

    Where contact opens, the force of generalised alpha is the mean of those at both ends, or that of the mean gap.
    """
    forms: dict[Family, list[dict[str, Any]]] = {}
    families: list[tuple[str, Family, Sequence[float]]] = [
        ("hht", "hht", ALPHA_F),
        ("generalised-alpha", "chung-hulbert", RHO_INF),
        ("wbz", "wbz", RHO_INF),
    ]
    for _, family, _ in families:
        has_forms = scene.opens and family != "wbz"  # WBZ has alpha_f = 0
        forms[family] = [{"contact": name} for name in ("springs", "mean gap")] if has_forms else [{}]
    for start in starts:
        for cause, family, numbers in families:
            for form in forms[family]:
                changes = {"family": family, "start": start, **form}
                yield fitted(cause, "spectral", numbers, **changes)
                for number in SHARED[family]:
                    yield fixed(cause, spectral=number, **changes)
        composite = {"family": "composite", "start": start}
        yield fitted("composite", "spectral", RHO_INF, split=0.0, **composite)
        yield fitted("composite", "split", SPLITS, spectral=0.0, **composite)
        for split in SPLITS:
            yield Move("composite", {"split": split, **composite}, ("spectral", "split"), RHO_INF)
        for split in (0.0, 0.5):
            yield fixed("composite", split=split, spectral=0.0, **composite)
    consistent = {"start": "consistent"}
    yield fitted("theta", "spectral", THETA, family="theta", **consistent)
    for number in SHARED["theta"]:
        yield fixed("theta", family="theta", spectral=number, **consistent)
    for family in EXPLICIT:
        yield fixed(family, family=family, **consistent)


def _model(target: Target, scene: Variant) -> list[Move]:
    """Return the changes of the model whose numbers are those of the scene or of its steps."""
    candidates = []
    if target.column.poisson:
        candidates.append(fixed("poisson", poisson=-target.column.poisson))
    if scene.opens or scene.family != "newmark":
        return candidates
    step = np.mean(target.steps)
    candidates.append(fitted("stiffness-damping", "structural", (step * STIFFNESS_DRAGS).tolist()))
    # the loads of a ramp begin with none; a program may start from the acceleration of the full load all the same
    for start in dict.fromkeys(("zero", scene.start)):
        candidates.append(fitted("load-ramp", "ramp", (step * RAMPS).tolist(), start=start))
    return candidates


def _contact(target: Target, scene: Variant) -> list[Move]:
    """Return what the contact may do; a history that never pulls is the same with a contact that opens."""
    candidates = [fixed("contact-locked", opens=False)] if scene.opens else []
    if not scene.opens and pulls(target, scene):
        candidates.append(fixed("contact-opened", opens=True))
        if target.column.poisson:  # programs differ in the shear of a contact that closes again
            candidates.append(fixed("contact-opened", opens=True, reset=True))
    if not target.column.poisson:
        candidates += contact_methods(scene)
    return [*candidates, *dead_bands(target, scene, BANDS)]


def contact_methods(scene: Variant) -> Iterator[Move]:
    """Yield contact methods with a force of their own, under the scene's scheme and those in which they are used.

    Of locked contact only those that act in it: a dashpot, and the implicit force.
    """
    schemes: list[dict[str, Any]] = [AVERAGE_ACCELERATION, CONSTANT_ACCELERATION]
    if scene.family == "newmark":
        schemes.insert(0, {"alpha": scene.alpha, "delta": scene.delta, "start": scene.start})
    schemes = [scheme for i, scheme in enumerate(schemes) if scheme not in schemes[:i]]
    plain = {"family": "newmark", "spectral": 0.0, "band": 0.0, "reopening": 0.0}
    for scheme in schemes:
        for clipped in (True, False) if scene.opens else (True,):
            changes = {"contact": "dashpot", "clipped": clipped, **plain, **scheme}
            yield fitted("contact-dashpot", "dashpot", DASHPOTS, **changes)
        if scene.opens:
            yield fixed("rigid-contact", contact="rigid", **plain, **scheme)
    yield fixed("implicit-contact", contact="implicit", **plain, **AVERAGE_ACCELERATION)
    if not scene.opens:
        return
    yield fixed("energy-conserving-contact", contact="energy-conserving", **plain, **AVERAGE_ACCELERATION)
    for theta in (0.5, 0.6, 0.75, 1.0):
        changes = {"contact": "impact", **plain, "family": "theta", "spectral": theta, "start": "consistent"}
        yield fitted("impact-law", "restitution", RESTITUTIONS, **changes)
        for e in (0.0, 1.0):
            yield fixed("impact-law", restitution=e, **changes)
        if theta not in (0.5, 1.0):
            yield Move("impact-law", changes, ("restitution", "spectral"), RESTITUTIONS)


def dead_bands(target: Target, scene: Variant, shares: Sequence[float]) -> list[Move]:
    """Return dead bands by their shares of the static displacement; none where the contact never pulls."""
    if not (scene.opens or pulls(target, scene)):
        return []
    opens = {} if scene.opens else {"opens": True}
    size = abs(target.column.static)
    return [fixed("dead-band", **opens, band=share * size, reopening=part) for share in shares for part in REOPENINGS]


def pulls(target: Target, variant: Variant) -> bool:
    """Whether the contact of a variant is in tension in some step, if it carries any."""
    pressure = histories(target.column, [variant], target.steps).pressure[:, 0]
    return bool(np.any(pressure < -1e-9 * np.max(np.abs(pressure))))
