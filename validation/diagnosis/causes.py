"""The catalogue of `causes.toml`: causes of a departure that people make, with their words and numbers."""

from __future__ import annotations

import math
import tomllib
from collections import defaultdict
from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from validation.diagnosis.constants import SAME_NUMBER, SEEN
from validation.diagnosis.fits.fit import SPAN, Fit, changed, fit, fit_one, intervals
from validation.diagnosis.fits.target import Target
from validation.diagnosis.moves import FINE_BANDS
from validation.diagnosis.variant import Rectangle, Variant
from validation.metrics.contact import AGREED
from validation.runs.numbers import significant
from validation.theory.edges import edge

BENIGN_COMPLIANCE = 0.05  # of the static displacement, that a base may add before the springs are in question
ROUND_DIGITS = 2  # significant digits of a factor that a person types, and no base has by chance
HALF = 0.5  # given: steps late: a mean of two
UNEXPLAINED = "unexplained"
SWAPPED = "swapped"
DIVERGED = "diverged"
SINGLE_ROWS = "single-rows"


@dataclass(frozen=True)
class Cause:
    """A cause of the catalogue; what each of its fields is stands at the head of `causes.toml`."""

    words: str
    sentence: str = "{words}"
    number: str = ""
    further_scene: str = ""
    of_columns: str = ""
    benign: bool = False
    integrator: bool = False
    output: bool = False
    usual: bool = False
    alone: bool = False
    family: bool = False


TABLE = tomllib.loads(Path(__file__).with_suffix(".toml").read_text(encoding="utf-8"))
CAUSES = {name: Cause(**fields) for name, fields in TABLE.items()}
CONTACT_METHODS = frozenset(
    {"contact-dashpot", "implicit-contact", "energy-conserving-contact", "rigid-contact", "impact-law"}
)
FORMULAS = {
    "velocity": "velocity, V1 = gg V + ...",
    "displacement": "displacement, d = gg dt V + ...",
    "(6)": "acceleration, (6) as printed",
    "(7)": "velocity, (7) as printed",
}
INTERCHANGED = ": alpha and delta are interchanged"
BAND_FIELDS = {"dead-band": "band", "opening-tension": "hold"}  # limits of the contact, of which rows tell an interval
DERIVED: dict[str, Callable[[Rectangle, Variant], float]] = {  # numbers that are no field of a variant
    "reported-point": lambda c, v: v.point * c.height / 2,
    "poisson": lambda c, v: c.poisson + v.poisson,
    "springs-factor": lambda _, v: math.exp(-v.softness),
    "load-factor": lambda _, v: v.load if v.load != 1 else v.displacement_factor,
    "base-compliance": lambda c, v: compliance(c, v),
    "opening-tension": lambda c, v: c.normal * math.exp(-v.softness) * v.hold / c.width,
}


def all_benign(ids: Iterable[str]) -> bool:
    """Whether no cause is a fault of integrator or contact law."""
    return all(CAUSES[name].benign for name in ids)


# ---- what a fitted variant says ----


def compliance(c: Rectangle, variant: Variant) -> float:
    """Return the static displacement that softer springs add, over the scene's own static displacement [-]."""
    return -c.force / c.normal * math.expm1(variant.softness) / c.static


def benign_springs(rectangle: Rectangle, variant: Variant) -> bool:
    """Whether the springs may be the scene's, on a base that adds little compliance, or more if it is seen to swing."""
    soft = compliance(rectangle, variant)
    return 0 <= soft <= BENIGN_COMPLIANCE * (1 if variant.base == 0 else 4)


def round_factor(factor: float, error: float) -> bool:
    """Whether a factor, or one over it, is a round number within what its relative error leaves open."""
    if error > SEEN:
        return False
    for value in (factor, 1 / factor):
        typed = float(f"{value:.{ROUND_DIGITS - 1}e}")
        if abs(value / typed - 1) <= max(error, AGREED):
            return True
    return False


def is_base(rectangle: Rectangle, variant: Variant, softness_error: float) -> bool:
    """Whether softer springs are called a base: one that swings, or benign ones whose factor no person would type."""
    if not benign_springs(rectangle, variant):
        return False
    return variant.base > 0 or not round_factor(math.exp(-variant.softness), softness_error)


def causes_of(
    rectangle: Rectangle, ids: Sequence[str], variant: Variant, scene: Variant, softness_error: float = 0.0
) -> list[str]:
    """Return the ids of what was found, in the catalogue's order; springs are called by what they stand for.

    The half width of the 95 % interval of the softness is the relative error of the springs' factor [-].
    """
    names = set(ids)
    if "springs-factor" in names and is_base(rectangle, variant, softness_error):
        names = names - {"springs-factor"} | {"base-compliance"}
    if names & {*BAND_FIELDS} and not scene.opens:
        names |= {"contact-opened"}
    if names & {"scheme", "contact-dashpot", "rigid-contact"} and variant.family == "newmark":
        if (scene.family, scene.alpha, scene.delta) != ("newmark", variant.alpha, variant.delta):
            names |= {"scheme"}
        if scene.start != variant.start:
            names |= {"start"}
    return [name for name in CAUSES if name in names]


def values_of(rectangle: Rectangle, ids: Sequence[str], v: Variant) -> dict[str, float]:
    """Return the number of every cause that has one, as docs/judge.md says."""
    values = {}
    for name in ids:
        if name in DERIVED:
            values[name] = DERIVED[name](rectangle, v)
        elif CAUSES[name].number:
            values[name] = float(getattr(v, CAUSES[name].number))
    return {name: significant(value, 8) for name, value in values.items()}


def intervals_of(target: Target, explanation: Fit, ids: Sequence[str]) -> dict[str, tuple[float, float]]:
    """Return the 95 % interval of every value of an explanation that was fitted or is left open."""
    values = values_of(target.column, ids, explanation.variant)
    ends: dict[str, tuple[float, float]] = {}
    for name, interval in intervals(explanation).items():
        if not math.isfinite(interval.half_width):
            continue
        low, high, elsewhere = (
            values_of(target.column, ids, changed(explanation.variant, {name: interval.value + by}))
            # an exact fit has no width, and still belongs to its value
            for by in (-interval.half_width, interval.half_width, SPAN[name])
        )
        for cause, value in values.items():
            if elsewhere[cause] != value:
                ends[cause] = (min(low[cause], high[cause]), max(low[cause], high[cause]))
    for name in BAND_FIELDS.keys() & values.keys():
        ends[name] = band_interval(target, explanation.variant, name)
    return ends


def band_interval(target: Target, variant: Variant, cause: str) -> tuple[float, float]:
    """Return the penetrations, or tensions, that give the same rows: a limit lies between two that happened."""
    least = fit_one(target, variant).misfit
    field = BAND_FIELDS[cause]
    fitted = float(getattr(variant, field))

    def same(bands: Sequence[float]) -> list[bool]:
        misfits = [one.misfit for one in fit(target, [(changed(variant, {field: band}), ()) for band in bands])]
        return [abs(misfit - least) <= SEEN * max(least, target.floor) for misfit in misfits]

    def end(widens: float) -> float:
        trials = [fitted * (band / FINE_BANDS[0]) ** widens for band in FINE_BANDS[1:]]
        inner = fitted
        for outer, alike in zip(trials, same(trials), strict=True):
            if not alike:
                break
            inner = outer
        at_end = changed(variant, {field: edge(lambda band: same([band])[0], inner, outer, SAME_NUMBER)})
        return significant(values_of(target.column, [cause], at_end)[cause], 4)

    return end(-1.0), end(1.0)


def roundest(low: float, high: float) -> float:
    """Return the number between two positive ones that has the fewest digits, of these the nearest to their mean."""
    middle = math.sqrt(low * high)
    power = 10.0 ** round(math.log10(middle))
    if low <= power <= high:
        return power
    rounded = (float(f"{middle:.{digits}e}") for digits in range(8))
    return next((value for value in rounded if low <= value <= high), middle)


# ---- in words ----


def words_of(name: str, value: float, v: Variant | None = None, scene: Variant | None = None, **further: str) -> str:
    """Return a cause with its number, by the fitted variant and the scene's own where there are such.

    `further` is what else a sentence holds: the scene's `scheme`, `open_steps`, `between`.
    """
    cause = CAUSES[name]
    words: dict[str, Any] = {
        "words": cause.words,
        "lateness": _lateness(value),
        "gravity": {0.0: "is missing", -1.0: "acts upwards"}.get(value, f"is {value:.5g} times the scene's"),
        "lacking": "is missing" if value == 0 else "has the wrong sign",
        "rho_inf": (1 - value) / (1 + value) if value > -1 else math.nan,
        "implicit_euler": ": implicit Euler" if value == 1 else "",
        "twelfth": {3.0: ", of a mass in the corners", 12.0: ", without its twelfth"}.get(round(value, 3), ""),
    }
    if v is not None and scene is not None:
        squared = scene.gg < 1 and abs(v.gg - scene.gg**2) < AGREED
        words |= {
            "square": ", its square" if squared else "",
            "formula": FORMULAS.get(v.discounted, ""),
            "interchanged": INTERCHANGED if _is_interchanged(v, scene) else "",
            "place": {1.0: ", the top edge", -1.0: ", the base"}.get(round(v.point, 6), ""),
            "carried": "force of the springs" if v.kept == "springs" else "stress",
        }
    numbers = {"value": value, "per_cent": 100 * value, "v": v, "scene": scene}
    return cause.sentence.format_map(defaultdict(str, words | further | numbers))


def _is_interchanged(v: Variant, scene: Variant) -> bool:
    """Whether a scheme has the scene's alpha and delta in each other's place."""
    if {v.family, scene.family} != {"newmark"} or scene.alpha == scene.delta:
        return False
    return abs(v.alpha - scene.delta) <= SAME_NUMBER and abs(v.delta - scene.alpha) <= SAME_NUMBER


def _lateness(steps: float) -> str:
    if steps == HALF:
        return "the mean of this step and the one before"
    return f"{abs(steps):g} step{'s' * (abs(steps) > 1)} {'late' if steps > 0 else 'early'}"
