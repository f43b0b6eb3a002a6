"""The candidate changes: ways to put a cause into the scene's own computation, fixed or with numbers that are fitted.

Where its numbers start is part of it.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from validation.diagnosis.fits.fit import NAMED
from validation.diagnosis.fits.target import Target
from validation.diagnosis.stepping import UNEQUAL, histories
from validation.diagnosis.variant import Variant


@dataclass(frozen=True)
class Move:
    """One way to put a cause into a computation."""

    id: str
    changes: tuple[tuple[str, Any], ...] = ()
    free: tuple[str, ...] = ()  # numbers that a fit finds
    starts: tuple[float, ...] = ()  # of the first of them


UNITS = (1e-6, 1e-3, 1e3, 1e6)  # factors of data in other units
BY_HAND = tuple(float(f) for f in np.geomspace(0.1, 10, 24))
FACTORS = (*BY_HAND, *UNITS)
SOFTNESSES = (0.02, *(float(s) for s in np.linspace(-math.log(30), math.log(30), 24)), *np.log(UNITS).tolist())
DISCOUNTS = (0.999, 0.99, 0.97, 0.93, 0.8, 0.5)
DRAGS = (1.0, 10.0, 100.0)  # 1/s
STIFFNESS_DRAGS = (0.02, 0.2, 1.0)  # steps
RAMPS = (3.0, 8.0, 20.0)  # steps
INERTIAS = (1 / 12, 0.5, 3.0, 12.0)  # 3 is a mass in the corners, 12 a twelfth that is missing
HHT, CHUNG_HULBERT = (0.05, 0.15, 0.3), (0.2, 0.5, 0.8)  # e, and the spectral radius at high frequency
PARTS = (2, 3, 4, 5, 8, 10, 20)  # steps of a program in one of the scene's
UNNAMED = ((0.3, 0.6), (0.4, 0.8), (0.6, 1.1))  # alpha, delta to begin with
LATE = (1.0, -1.0, 0.5, 2.0)  # steps, 1/2 the mean of two
BANDS = tuple(float(b) for b in np.geomspace(1e-4, 2.0, 44))  # over the static displacement
FINE_BANDS = tuple(float(b) for b in np.geomspace(1e-4, 2.0, 131))  # between closings of successive steps
REOPENINGS = (0.0, 1e-3, 1.0)  # gap that opens over the penetration that closes; ntdda has 1e-3
WRONG = (0.0, -1.0)  # missing, of the wrong sign


def moves(target: Target, scene: Variant) -> list[Move]:
    """Return every way in which the catalogue's causes may be in a history of a scene."""
    candidates = [move for family in _FAMILIES for move in family(target, scene)]
    return (
        candidates
        if target.pressure is not None
        else [m for m in candidates if m.id not in ("pressure-shift", "pressure-factor")]
    )


def _integrator(target: Target, scene: Variant) -> list[Move]:
    scene_pair = (scene.alpha, scene.delta)
    pairs = [pair for pair in NAMED.values() if pair != scene_pair]
    candidates = [Move("scheme", (("alpha", a), ("delta", d))) for a, d in pairs]
    candidates += [Move("scheme", (("alpha", a), ("delta", d)), ("alpha", "delta")) for a, d in (scene_pair, *UNNAMED)]
    candidates += [Move("gg", (("gg", gg),)) for gg in (scene.gg**2, math.sqrt(scene.gg)) if gg < 1]
    candidates += [Move("gg", (("gg", 1.0),))] if scene.gg < 1 else []
    candidates.append(Move("gg", (), ("gg",), DISCOUNTS))
    if scene.gg < 1:
        candidates += [Move("gg-in-one-formula", (("discounted", name),)) for name in ("velocity", "displacement")]
    other = "zero" if scene.start == "consistent" else "consistent"
    candidates.append(Move("start", (("start", other),)))
    if scene.delta not in (0.5, 1.0):
        candidates.append(Move("scheme", (("delta", 1 - scene.delta),)))  # the two weights of (7) are swapped
    return candidates


def _other_integrators(target: Target, scene: Variant) -> list[Move]:
    """Return integrators that are no pair of numbers of Newmark's, and other lengths of their steps."""
    candidates = [Move("substeps", (("parts", parts),)) for parts in PARTS]
    if scene.opens:
        return candidates
    other = "zero" if scene.start == "consistent" else "consistent"
    for start in (scene.start, other):
        candidates.append(Move("hht", (("family", "hht"), ("start", start)), ("spectral",), HHT))
        candidates.append(
            Move("generalised-alpha", (("family", "chung-hulbert"), ("start", start)), ("spectral",), CHUNG_HULBERT)
        )
    if float(np.ptp(target.steps)) <= UNEQUAL * float(target.steps[0]):
        candidates.append(Move("exact-in-time", (("exact", True), ("gg", 1.0))))
    return [*candidates, Move("velocity", (("secant", True),))]


def _rows(target: Target, scene: Variant) -> list[Move]:
    candidates = [Move("time-shift", (("shift", late),)) for late in (1, -1, 2, -2)]
    candidates += [Move("pressure-shift", (("late", late),)) for late in LATE]
    candidates.append(Move("pressure-factor", (), ("pressure_factor",), (0.5, 2.0)))
    candidates += [Move("reported-point", (("point", place),)) for place in (1.0, -1.0)]
    return [*candidates, Move("reported-point", (), ("point",), (0.5, -0.5))]


def _model(target: Target, scene: Variant) -> list[Move]:
    candidates = [Move(f"{name}-factor", (), (name,), FACTORS) for name in ("density", "young", "side")]
    candidates.append(Move("load-factor", (), ("load",), BY_HAND))
    candidates += [Move("height-factor", (), ("tall",), FACTORS), Move("viscous-damping", (), ("viscous",), DRAGS)]
    step = float(np.mean(target.steps))
    if not scene.opens:
        candidates.append(
            Move("stiffness-damping", (), ("structural",), tuple(step * drag for drag in STIFFNESS_DRAGS))
        )
        ramps = tuple(step * ramp for ramp in RAMPS)
        # the loads of a ramp begin with none; a program may start from the acceleration of the full load all the same
        for start in dict.fromkeys(("zero", scene.start)):
            candidates.append(Move("load-ramp", (("start", start),), ("ramp",), ramps))
        candidates.append(Move("inertia", (), ("inertia",), INERTIAS))
        candidates.append(Move("one-spring", (("one_spring", True),)))
    if target.column.gravity:
        candidates += [Move("gravity-factor", (("gravity", part),)) for part in WRONG]
        candidates.append(Move("gravity-factor", (), ("gravity",), (0.5, 2.0)))
    if target.pressure is not None:
        candidates.append(Move("load-factor", (), ("displacement_factor",), (0.5, 2.0)))
    candidates.append(Move("springs-factor", (), ("softness",), SOFTNESSES))
    if target.column.poisson:
        candidates.append(Move("springs-factor", (("tied", False),), ("softness",), SOFTNESSES))
        candidates.append(Move("hypothesis", (("other_plane", True),)))
        candidates.append(Move("poisson", (("poisson", -target.column.poisson),)))
    candidates.append(Move("poisson", (), ("poisson",), (0.05, 0.15, 0.3)))
    candidates += [Move("load-row", (("strain_load", part),)) for part in WRONG]
    candidates += [Move("coupling", (("coupling", part),)) for part in WRONG]
    return [*candidates, *(Move("stress-not-kept", (("kept", name),)) for name in ("springs", "stress"))]


def _surroundings(target: Target, scene: Variant) -> list[Move]:
    return [Move("own-weight", (), ("weight",), (0.5, 1.0)), Move("geometry-updated", (("updated", True),))]


def _contact(target: Target, scene: Variant) -> list[Move]:
    """Return what the contact may do; a history that never pulls is the same with a contact that opens."""
    candidates = [Move("contact-locked", (("opens", False),))] if scene.opens else []
    if not scene.opens and pulls(target, scene):
        candidates.append(Move("contact-opened", (("opens", True),)))
        if target.column.poisson:  # programs differ in the shear of a contact that closes again
            candidates.append(Move("contact-opened", (("opens", True), ("reset", True))))
    return [*candidates, *dead_bands(target, scene, BANDS)]


def dead_bands(target: Target, scene: Variant, shares: Sequence[float]) -> list[Move]:
    """Return dead bands by their shares of the static displacement; none where the contact never pulls."""
    if not (scene.opens or pulls(target, scene)):
        return []
    opens = () if scene.opens else (("opens", True),)
    size = abs(target.column.static)
    return [
        Move("dead-band", (*opens, ("band", share * size), ("reopening", part)))
        for share in shares
        for part in REOPENINGS
    ]


_FAMILIES: tuple[Callable[[Target, Variant], list[Move]], ...] = (
    *(_integrator, _other_integrators, _rows, _model, _surroundings, _contact),
)


def pulls(target: Target, variant: Variant) -> bool:
    """Whether the contact of a variant is in tension in some step, if it carries any."""
    pressure = histories(target.column, [variant], target.steps).pressure[:, 0]
    return bool(np.any(pressure < -1e-9 * np.max(np.abs(pressure))))
