"""The catalogue: causes of a departure that people make, each with what it changes in the scene's own computation.

A cause is one change, fixed or with one or two free numbers that a fit finds; where its numbers start is part of it.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from validation.diagnosis.fits.fit import NAMED, SPAN, Fit, changed, fit, intervals
from validation.diagnosis.fits.target import Target
from validation.diagnosis.stepping import UNEQUAL, histories
from validation.diagnosis.variant import Variant

BENIGN_COMPLIANCE = 0.05  # share of the static displacement that a base may add before the springs are in question
ROUND_EXACT = 1e-6  # relative error that a fit without noise leaves of a factor
ROUND_DIGITS = 2  # significant digits of a factor that a person types, and that no base has by chance
ROUND_ERROR = 1e-3  # relative error of a factor, beyond which its digits are not known well enough to be called round
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
        Cause("hht", "the scheme of Hilber, Hughes and Taylor"),
        Cause("generalised-alpha", "the generalised-alpha scheme of Chung and Hulbert"),
        Cause("substeps", "the program makes several steps in one of the scene's"),
        Cause("exact-in-time", "no scheme: exact in time"),
        Cause("velocity", "the velocity at the end of a step is d/dt, not that of formula (7)"),
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
        Cause("load-ramp", "the load comes on in time, not at once"),
        Cause("gravity-factor", "gravity is missing, acts upwards, or is wrong by a factor"),
        Cause("inertia", "the inertia of the strains is lumped, or lacks its twelfth"),
        Cause("one-spring", "only one of the two corner springs acts"),
        Cause("viscous-damping", "viscous damping of the mass"),
        Cause("stiffness-damping", "viscous damping of the stiffness"),
        Cause("coupling", "the springs' coupling of displacement and strain is missing or has the wrong sign"),
        Cause("stress-not-kept", "the stress or the spring force of earlier steps is not carried over"),
        Cause("friction-factor", "tan(phi) of friction wrong by a factor"),
        Cause("cohesion", "another cohesion"),
        Cause("slope-factor", "the slope wrong by a factor"),
        Cause("shear-springs-factor", "shear stiffness of the contact wrong by a factor"),
        Cause("normal-springs-factor", "normal stiffness of the contact alone wrong by a factor"),
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
}


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
TRIALS = 21  # dead bands that are tried on either side for the interval in which one lies
WIDEST_BAND = 5.0  # over the fitted one, that is tried
HALVINGS = 8  # of the ratio between two trials, 1.084: an end is known to some 1e-4
SAME_MISFIT = 1e-3  # relative: rows that are no better and no worse
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


# ---- what a fitted variant says -------------------------------------------------------------------------------------


def compliance(target: Target, variant: Variant) -> float:
    """Return the static displacement that softer springs add, over the scene's own static displacement [-]."""
    c = target.column
    return -c.force / c.normal * math.expm1(variant.softness) / c.static


def benign_springs(target: Target, variant: Variant) -> bool:
    """Whether the springs may be the scene's, on a slightly compliant base or one that is seen to swing.

    No base adds a negative compliance.
    """
    soft = compliance(target, variant)
    return 0 <= soft <= BENIGN_COMPLIANCE * (1 if variant.base == 0 else 4)


def round_factor(factor: float, error: float) -> bool:
    """Whether a factor, or one over it, is a round number within what its relative error leaves open."""
    if error > ROUND_ERROR:
        return False
    for value in (factor, 1 / factor):
        typed = float(f"{value:.{ROUND_DIGITS - 1}e}")
        if abs(value / typed - 1) <= max(error, ROUND_EXACT):
            return True
    return False


def is_base(target: Target, variant: Variant, softness_error: float) -> bool:
    """Whether softer springs are called a base: benign ones whose factor no person would type.

    A base of its own mass is known by its swing, whatever the factor.
    """
    if not benign_springs(target, variant):
        return False
    return variant.base > 0 or not round_factor(math.exp(-variant.softness), softness_error)


def causes_of(
    target: Target, ids: Sequence[str], variant: Variant, scene: Variant, softness_error: float = 0.0
) -> list[str]:
    """Return the ids of what was found, in the catalogue's order; springs are called by what they stand for.

    Parameters
    ----------
    softness_error
        Half width of the 95 % interval of the softness, which is the relative error of the springs' factor [-].
    """
    names = set(ids)
    if "springs-factor" in names and is_base(target, variant, softness_error):
        names = names - {"springs-factor"} | {"base-compliance"}
    if "dead-band" in names and not scene.opens:
        names |= {"contact-opened"}
    return [name for name in (*CAUSES, *OUTSIDE) if name in names]


def values_of(target: Target, ids: Sequence[str], v: Variant) -> dict[str, float]:
    """Return the number of every cause that has one, as docs/compare.md says."""
    h = target.column.height
    load = v.load if v.load != 1 else v.displacement_factor
    numbers = {
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
        "stiffness-damping": v.structural,
        "hht": v.spectral,
        "generalised-alpha": v.spectral,
        "substeps": float(v.parts),
        "load-ramp": v.ramp,
        "gravity-factor": v.gravity,
        "inertia": v.inertia,
        "springs-factor": math.exp(-v.softness),
        "load-factor": load,
        "load-row": v.strain_load,
        "coupling": v.coupling,
        "dead-band": v.band,
        "base-compliance": compliance(target, v),
        "own-weight": v.weight,
    }
    return {name: float(f"{numbers[name]:.8g}") for name in ids if name in numbers}


def intervals_of(target: Target, explanation: Fit, ids: Sequence[str]) -> dict[str, tuple[float, float]]:
    """Return the 95 % interval of every value of an explanation that was fitted, or that the rows leave open."""
    values = values_of(target, ids, explanation.variant)
    ends: dict[str, tuple[float, float]] = {}
    for name, interval in intervals(explanation).items():
        if not math.isfinite(interval.half_width):
            continue

        def moved(by: float, name: str = name, value: float = interval.value) -> dict[str, float]:
            return values_of(target, ids, changed(explanation.variant, {name: value + by}))

        low = moved(-interval.half_width)
        high = moved(interval.half_width)
        elsewhere = moved(SPAN[name])  # an exact fit has no width, and still belongs to its value
        for cause, value in values.items():
            if elsewhere[cause] != value:
                ends[cause] = (min(low[cause], high[cause]), max(low[cause], high[cause]))
    if "dead-band" in values:
        ends["dead-band"] = band_interval(target, explanation.variant)
    return ends


def band_interval(target: Target, variant: Variant) -> tuple[float, float]:
    """Return the penetrations between which a dead band gives the same rows: it lies between two that happened."""
    least = fit(target, [(variant, ())])[0].misfit

    def same(bands: Sequence[float]) -> list[bool]:
        misfits = [one.misfit for one in fit(target, [(replace(variant, band=band), ()) for band in bands])]
        return [abs(misfit - least) <= SAME_MISFIT * max(least, target.floor) for misfit in misfits]

    def end(farthest: float) -> float:
        trials = np.geomspace(variant.band, variant.band * farthest, TRIALS)[1:].tolist()
        inner = variant.band
        outer = trials[-1]
        for band, alike in zip(trials, same(trials), strict=True):
            if not alike:
                outer = band
                break
            inner = band
        for _ in range(HALVINGS):
            middle = math.sqrt(inner * outer)
            if same([middle])[0]:
                inner = middle
            else:
                outer = middle
        return float(f"{inner:.4g}")

    return end(1 / WIDEST_BAND), end(WIDEST_BAND)


def roundest(low: float, high: float) -> float:
    """Return the number between two positive ones that has the fewest digits, of these the nearest to their mean."""
    middle = math.sqrt(low * high)
    power = 10.0 ** round(math.log10(middle))
    if low <= power <= high:
        return power
    for digits in range(1, 8):
        unit = 10.0 ** (math.floor(math.log10(middle)) - digits + 1)
        inside = [k * unit for k in range(math.ceil(low / unit), math.floor(high / unit) + 1)]
        if inside:
            return float(f"{min(inside, key=lambda value: abs(math.log(value / middle))):.8g}")
    return middle
