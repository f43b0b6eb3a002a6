"""The catalogue: causes of a departure that people make, each with what it changes in the scene's own computation.

A cause is one change, fixed or with one or two free numbers that a fit finds; where its numbers start is part of it.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from dda.one_block.variants import Variant
from validation.compare.fits.fit import NAMED
from validation.compare.fits.target import Target

BENIGN_COMPLIANCE = 0.05  # share of the static displacement that a base may add before the springs are in question
UNEXPLAINED = "unexplained"
DIVERGED = "diverged"


@dataclass(frozen=True)
class Cause:
    """A cause: its id, its description, and whether integrator and contact law are as they should be."""

    id: str
    words: str
    benign: bool = False


CAUSES = {
    cause.id: cause
    for cause in (
        Cause("sign", "a sign error: upwards is positive here"),
        Cause("unit", "a unit error"),
        Cause(DIVERGED, "the run diverged"),
        Cause("scheme", "a different scheme"),
        Cause("gg", "a different velocity discount gg"),
        Cause("gg-in-one-formula", "gg is applied in only one of the formulas (6) and (7)"),
        Cause("start", "the other initial acceleration (zero or consistent)"),
        Cause("time-shift", "the rows are shifted by one step"),
        Cause("pressure-shift", "the pressure belongs to another step than the displacement, or is a mean of steps"),
        Cause("pressure-factor", "the reported pressure wrong by a factor"),
        Cause("reported-point", "the displacement of another point than the centroid"),
        Cause("density-factor", "density wrong by a factor"),
        Cause("young-factor", "Young's modulus wrong by a factor"),
        Cause("poisson", "another Poisson's ratio"),
        Cause("hypothesis", "plane strain for plane stress, or the reverse"),
        Cause("side-factor", "side of the block wrong by a factor"),
        Cause("springs-factor", "contact stiffness wrong by a factor"),
        Cause("load-factor", "load or displacement wrong by a factor"),
        Cause("load-row", "the load has the wrong sign, or is missing, in the row of the vertical strain"),
        Cause("coupling", "the springs' coupling of displacement and strain is missing or has the wrong sign"),
        Cause("stress-not-kept", "the stress or the spring force of earlier steps is not carried over"),
        Cause("contact-opened", "the contact opened"),
        Cause("contact-locked", "the contact carries tension"),
        Cause("dead-band", "an open contact closes only beyond a penetration"),
        Cause("lagged-friction", "friction at a slipping corner is that of the step or iteration before"),
        Cause("base-compliance", "a slightly compliant base", benign=True),
        Cause("own-weight", "the block's own weight", benign=True),
        Cause("geometry-updated", "geometry updated at every step", benign=True),
        Cause(UNEXPLAINED, "no cause in the catalogue explains it"),
    )
}


# what is computed beside the catalogue, so that no cause is named where this would do as well
OUTSIDE = {
    "height-factor": "height of the block alone wrong by a factor",
    "viscous-damping": "viscous damping of the mass",
}


@dataclass(frozen=True)
class Move:
    """One way to put a cause into a computation."""

    id: str
    changes: tuple[tuple[str, Any], ...] = ()
    free: tuple[str, ...] = ()  # numbers that a fit finds
    starts: tuple[float, ...] = ()  # of the first of them


FACTORS = tuple(float(f) for f in np.geomspace(0.1, 10, 24))
SOFTNESSES = (0.02, *(float(s) for s in np.linspace(-math.log(30), math.log(30), 24)))
DISCOUNTS = (0.999, 0.99, 0.97, 0.93, 0.8, 0.5)
DRAGS = (1.0, 10.0, 100.0)  # 1/s
UNNAMED = ((0.3, 0.6), (0.4, 0.8), (0.6, 1.1))  # alpha, delta to begin with
LATE = (1.0, -1.0, 0.5, 2.0)  # steps, 1/2 the mean of two
BANDS = tuple(float(b) for b in np.geomspace(1e-4, 0.5, 38))  # over the static displacement
REOPENINGS = (0.0, 1e-3, 1.0)  # gap that opens over the penetration that closes; ntdda has 1e-3
PARTS = (0.0, -1.0)  # missing, of the wrong sign


def moves(target: Target, scene: Variant) -> list[Move]:
    """Return every way in which the catalogue's causes may be in a history of a scene."""
    found = [move for family in _FAMILIES for move in family(target, scene)]
    return (
        found
        if target.pressure is not None
        else [m for m in found if m.id not in ("pressure-shift", "pressure-factor")]
    )


def _integrator(target: Target, scene: Variant) -> list[Move]:
    own = (scene.alpha, scene.delta)
    pairs = [pair for pair in NAMED.values() if pair != own]
    found = [Move("scheme", (("alpha", a), ("delta", d))) for a, d in pairs]
    found += [Move("scheme", (("alpha", a), ("delta", d)), ("alpha", "delta")) for a, d in (own, *UNNAMED)]
    found += [Move("gg", (("gg", gg),)) for gg in (scene.gg**2, math.sqrt(scene.gg)) if gg < 1]
    found += [Move("gg", (("gg", 1.0),))] if scene.gg < 1 else []
    found.append(Move("gg", (), ("gg",), DISCOUNTS))
    if scene.gg < 1:
        found += [Move("gg-in-one-formula", (("discounted", name),)) for name in ("velocity", "displacement")]
    other = "zero" if scene.start == "consistent" else "consistent"
    return [*found, Move("start", (("start", other),))]


def _rows(target: Target, scene: Variant) -> list[Move]:
    found = [Move("time-shift", (("shift", late),)) for late in (1, -1, 2, -2)]
    found += [Move("pressure-shift", (("late", late),)) for late in LATE]
    found.append(Move("pressure-factor", (), ("pressure_factor",), (0.5, 2.0)))
    found += [Move("reported-point", (("point", place),)) for place in (1.0, -1.0)]
    return [*found, Move("reported-point", (), ("point",), (0.5, -0.5))]


def _model(target: Target, scene: Variant) -> list[Move]:
    found = [Move(f"{name}-factor", (), (name,), FACTORS) for name in ("density", "young", "side", "load")]
    found += [Move("height-factor", (), ("tall",), FACTORS), Move("viscous-damping", (), ("viscous",), DRAGS)]
    if target.pressure is not None:
        found.append(Move("load-factor", (), ("displacement_factor",), (0.5, 2.0)))
    found.append(Move("springs-factor", (), ("softness",), SOFTNESSES))
    if target.column.poisson:
        found.append(Move("springs-factor", (("tied", False),), ("softness",), SOFTNESSES))
        found.append(Move("hypothesis", (("other_plane", True),)))
        found.append(Move("poisson", (("poisson", -target.column.poisson),)))
    found.append(Move("poisson", (), ("poisson",), (0.05, 0.15, 0.3)))
    found += [Move("load-row", (("strain_load", part),)) for part in PARTS]
    found += [Move("coupling", (("coupling", part),)) for part in PARTS]
    return [*found, *(Move("stress-not-kept", (("kept", name),)) for name in ("springs", "stress"))]


def _surroundings(target: Target, scene: Variant) -> list[Move]:
    return [Move("own-weight", (), ("weight",), (0.5, 1.0)), Move("geometry-updated", (("updated", True),))]


def _contact(target: Target, scene: Variant) -> list[Move]:
    """Return what the contact may do; a history that never pulls is the same with a contact that opens."""
    size = abs(target.column.static)
    name = () if scene.opens else (("opens", True),)
    found = [Move("contact-locked", (("opens", False),))] if scene.opens else []
    if scene.opens or pulls(target, scene):
        found += [Move("contact-opened", name)] if not scene.opens else []
        if target.column.poisson and not scene.opens:  # programs differ in the shear of a contact that closes again
            found.append(Move("contact-opened", (*name, ("reset", True))))
        found += [
            Move("dead-band", (*name, ("band", share * size), ("reopening", part)))
            for share in BANDS
            for part in REOPENINGS
        ]
    return found


_FAMILIES: tuple[Callable[[Target, Variant], list[Move]], ...] = (_integrator, _rows, _model, _surroundings, _contact)


def pulls(target: Target, variant: Variant) -> bool:
    """Whether the contact of a variant is in tension in some step, if it carries any."""
    from validation.compare.fits.responses import computed

    pressure = computed(target.column, [variant], target.steps).pressure[:, 0]
    return bool(np.any(pressure < -1e-9 * np.max(np.abs(pressure))))


# ---- what a fitted variant says -------------------------------------------------------------------------------------


def compliance(target: Target, variant: Variant) -> float:
    """Return the static displacement that softer springs add, over the scene's own static displacement [-]."""
    c = target.column
    return -c.force / c.normal * math.expm1(variant.softness) / c.static


def benign_springs(target: Target, variant: Variant) -> bool:
    """Whether the springs are the scene's, on a slightly compliant base or one that is seen to swing."""
    soft = compliance(target, variant)
    return -BENIGN_COMPLIANCE / 5 <= soft <= BENIGN_COMPLIANCE * (1 if variant.base == 0 else 4)


def causes_of(target: Target, ids: Sequence[str], variant: Variant, scene: Variant) -> list[str]:
    """Return the ids of what was found, in the catalogue's order; springs are called by what they stand for."""
    found = set(ids)
    if "springs-factor" in found and benign_springs(target, variant):
        found = found - {"springs-factor"} | {"base-compliance"}
    if "dead-band" in found and not scene.opens:
        found |= {"contact-opened"}
    return [name for name in (*CAUSES, *OUTSIDE) if name in found]


def values_of(target: Target, ids: Sequence[str], v: Variant) -> dict[str, float]:
    """Return the number of every cause that has one, as docs/compare.md says."""
    h = target.column.height
    load = v.load if v.load != 1 else v.displacement_factor
    known = {
        "gg": v.gg,
        "time-shift": float(v.shift),
        "pressure-shift": v.late,
        "pressure-factor": v.pressure_factor,
        "reported-point": v.point * h / 2,
        "density-factor": v.density,
        "young-factor": v.young,
        "poisson": target.column.poisson + v.poisson,
        "side-factor": v.side,
        "height-factor": v.tall,
        "viscous-damping": v.viscous,
        "springs-factor": math.exp(-v.softness),
        "load-factor": load,
        "load-row": v.strain_load,
        "coupling": v.coupling,
        "dead-band": v.band,
        "base-compliance": compliance(target, v),
        "own-weight": v.weight,
    }
    return {name: float(f"{known[name]:.8g}") for name in ids if name in known}
