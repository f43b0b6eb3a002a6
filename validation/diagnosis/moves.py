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
HHT, CHUNG_HULBERT = (0.05, 0.15, 0.3), (0.2, 0.5, 0.8)  # e, and the spectral radius at high frequency
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
    scene_pair = (scene.alpha, scene.delta)
    candidates = [fixed("scheme", alpha=a, delta=d) for a, d in NAMED.values() if (a, d) != scene_pair]
    candidates += [Move("scheme", {"alpha": a, "delta": d}, ("alpha", "delta")) for a, d in (scene_pair, *UNNAMED)]
    if scene.gg < 1:
        candidates += [fixed("gg", gg=gg) for gg in (scene.gg**2, math.sqrt(scene.gg), 1.0)]
        candidates += [fixed("gg-in-one-formula", discounted=name) for name in ("velocity", "displacement")]
    candidates.append(fitted("gg", "gg", DISCOUNTS))
    other = "zero" if scene.start == "consistent" else "consistent"
    candidates.append(fixed("start", start=other))
    if scene.delta not in (0.5, 1.0):
        candidates.append(fixed("scheme", delta=1 - scene.delta))  # the two weights of (7) are swapped
    # integrators that are no pair of numbers of Newmark's, and other lengths of their steps
    candidates += [fixed("substeps", parts=parts) for parts in PARTS]
    if scene.opens:
        return candidates
    for start in (scene.start, other):
        candidates.append(fitted("hht", "spectral", HHT, family="hht", start=start))
        candidates.append(fitted("generalised-alpha", "spectral", CHUNG_HULBERT, family="chung-hulbert", start=start))
    if float(np.ptp(target.steps)) <= UNEQUAL * float(target.steps[0]):
        candidates.append(fixed("exact-in-time", exact=True, gg=1.0))
    return [*candidates, fixed("velocity", secant=True)]


def _model(target: Target, scene: Variant) -> list[Move]:
    """Return the changes of the model whose numbers are those of the scene or of its steps."""
    candidates = []
    if target.column.poisson:
        candidates.append(fixed("poisson", poisson=-target.column.poisson))
    if scene.opens:
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
    return [*candidates, *dead_bands(target, scene, BANDS)]


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
