"""Values of a scene that no rock, soil or concrete has, which are most often values in another unit.

Limits and sentences are rows of `plausibility.toml`; here are the quantities of a scene that are held against them. A
scene that means its values says why: its key `extreme` holds the reason, and nothing is warned of.
"""

from __future__ import annotations

import math
import warnings
from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any

from validation.errors import PlausibilityWarning
from validation.runs.beside import table_beside
from validation.scenes.kinds import Hooks
from validation.scenes.scene import Scene

TABLE: dict[str, Any] = table_beside(__file__)
KINDS: dict[str, str] = TABLE.pop("kinds")
LEAST_PRESSURE, LEAST_STRESS_RATIO = 100.0, 1e-6  # Pa, and of the modulus: a pressure below both is looked at
EXPLAIN_A_SINK = ("gravity", "pressure", "density", "modulus", "size", "strain")
SLOWEST, FASTEST = 100.0, 1e4  # m/s: waves in rock and soil, to which another unit of the modulus would lead
UNIT_FACTORS = (1e-3, 1e-6, 1e-9, 1e3, 1e6, 1e9)  # between Pa, kPa, MPa and GPa


@dataclass(frozen=True)
class Implausible:
    """A value that was probably not meant, and what to write."""

    field: str
    kind: str  # "density", "modulus", "wave", "strain", "friction", "damping ratio", "gravity", "gg", "size" and so on
    sentence: str


def judged(quantity: str, field: str, value: float, **numbers: object) -> Iterator[Implausible]:
    """Yield what the rows of a quantity say of a value of the key `field`, with other numbers, beyond a limit."""
    for row in TABLE[quantity]:
        if row.get("above", -math.inf) < value < row.get("below", math.inf):
            name = field.rpartition(".")[2]
            words = {"field": field, "name": name, "value": value, "other": value * row.get("times", 1.0), **numbers}
            sentence = f'{row["says"].format(**words)}, or extreme = "why" if it is meant'
            yield Implausible(field, KINDS.get(quantity, quantity), sentence)
            return


class PlausibilityHooks(Hooks):
    """What the values of a kind of scene are held against."""

    module = "plausibility"

    def values(self, scene: Scene) -> Iterator[Implausible]:
        """Yield the values of a scene that were probably not meant, in the order in which they are told."""
        yield from ()

    def sinks(self, scene: Scene) -> Iterator[Implausible]:
        """Yield springs that give way by a tenth of the height at rest, unless another value explains it."""
        yield from ()


def implausible_values(scene: Scene) -> list[Implausible]:
    """Return the values of one case that were probably not meant, none where the scene says that they are."""
    if scene.extreme:
        return []
    hooks = PlausibilityHooks.of(scene)
    values = [*hooks.values(scene)]
    if not any(value.kind in EXPLAIN_A_SINK for value in values):
        values += hooks.sinks(scene)
    by_field: dict[str, Implausible] = {}
    for value in values:  # a second sentence on one value says nothing new
        by_field.setdefault(value.field, value)
    return list(by_field.values())


def plausibility_warnings(scene: Scene) -> list[str]:
    """Return a sentence for each value that was probably not meant; of a sweep with the number of its cases."""
    cases = scene.expand()
    sentences: dict[tuple[str, str], str] = {}
    counts: dict[tuple[str, str], int] = {}
    for case in cases:
        for value in implausible_values(case):
            key = value.field, value.kind
            sentences.setdefault(key, value.sentence)
            counts[key] = counts.get(key, 0) + 1
    number = "" if len(cases) == 1 else f" of {len(cases)} cases"
    return [f"{text} (in {counts[key]}{number})" if number else text for key, text in sentences.items()]


def warn_implausible(scene: Scene) -> None:
    """Warn of the values of a scene that were probably not meant, once in a process."""
    for sentence in plausibility_warnings(scene):
        if (scene.name, sentence) not in _WARNED:
            _WARNED.add((scene.name, sentence))
            warnings.warn_explicit(sentence, PlausibilityWarning, scene.name, 0)


_WARNED: set[tuple[str, str]] = set()  # Python's own record of warnings is cleared by every `catch_warnings`


# ---- what kinds share ----


def material(
    place: str, density: float, young: float, speed: float, strains: dict[str, float]
) -> Iterator[Implausible]:
    """Yield what a body's density [kg/m3] and modulus [Pa] say; else its wave and its strain, which follow from both.

    `place` is that of its keys, `speed` its wave's [m/s], `strains` are static ones [1] by the key of what causes them.
    """
    units = [
        *judged("density", f"{place}.density", density),
        *judged("modulus", f"{place}.young", young, speed=speed),
    ]
    yield from units
    if units:
        return
    factors = (factor for factor in UNIT_FACTORS if SLOWEST <= speed * math.sqrt(factor) <= FASTEST)
    factor = next(factors, None)
    advice = "check young and density" if factor is None else f"write young = {young * factor:.4g}"
    yield from judged("wave", f"{place}.young", speed, young=young, advice=advice)
    if strains:
        cause = max(strains, key=lambda field: strains[field])
        name = cause.rpartition(".")[2]
        advices = {"gravity": "gravity = 9.81", "velocity": "velocity in m/s"}
        advice = advices.get(name, f"{name} in Pa, 5e6 for 5 MPa, and young in Pa")
        yield from judged("strain", cause, sum(strains.values()), place=place, advice=advice)


def friction(field: str, angle: float | None) -> Iterator[Implausible]:
    """Yield what an angle of friction says [deg]; 0 is a contact without friction, on purpose."""
    if angle:
        yield from judged("friction", field, angle, slope=math.degrees(math.atan(angle)))


def stepping(scene: Scene) -> Iterator[Implausible]:
    """Yield what discount and weights of the scheme say."""
    t = scene.time
    gg = t.discount
    if t.gg_rate is None:
        yield from judged("gg", "time.gg", gg, lost=1 - gg, percent=100 * gg)
    else:
        yield from judged("gg_rate", "time.gg_rate", gg, rate=t.gg_rate)
    if t.scheme != "newmark":
        return
    alpha = t.stated_alpha
    delta = t.stated_delta
    yield from judged("weight", "time.alpha" if alpha >= delta else "time.delta", max(alpha, delta))
    yield from judged("interchanged", "time.alpha", alpha - delta, alpha=alpha, delta=delta)


def strength(field: str, stress: float, modulus: float) -> Iterator[Implausible]:
    """Yield what a strength says beside a modulus [Pa]."""
    yield from judged("strength", field, stress / modulus, pressure=stress)
    yield from pressure_values(field, stress, modulus)


def pressure_values(field: str, pressure: float, modulus: float) -> Iterator[Implausible]:
    """Yield what a pressure says that is small in itself and beside a modulus [Pa]."""
    share = max(abs(pressure) / LEAST_PRESSURE, abs(pressure) / modulus / LEAST_STRESS_RATIO)
    yield from judged("pressure", field, share, pressure=pressure, modulus=modulus)
