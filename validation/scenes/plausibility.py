"""Values of a scene that no rock, soil or concrete has, which are most often values in another unit.

A scene that means them says why: its key `extreme` holds the reason, and nothing is warned of.
"""

from __future__ import annotations

import math
import warnings
from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from validation.errors import PlausibilityWarning
from validation.scenes.column import ColumnSection
from validation.scenes.plane import PlaneSection
from validation.scenes.scene import Scene

LARGEST_STRAIN = 0.1  # static; DDA's blocks are linear elastic
SLOWEST, FASTEST = 100.0, 1e4  # m/s, waves: loose sand to diamond
LEAST_DENSITY = 100.0  # kg/m3
LEAST_UNIT_WEIGHT = 10.0  # kN/m3: what is below in the place of a density is taken for t/m3
LEAST_MODULUS = 1e6  # Pa
LARGEST_IN_GPA = 200.0  # what is below in the place of a modulus is taken for GPa, from here on for MPa
LEAST_FRICTION = 5.0  # deg
LARGEST_COEFFICIENT = 1.5  # of friction
LARGEST_DAMPING_RATIO = 1.0  # of dashpots: critical
EARTH = 9.81  # m/s2
UNIT_FACTORS = (1e-3, 1e-6, 1e-9, 1e3, 1e6, 1e9)  # between Pa, kPa, MPa and GPa


@dataclass(frozen=True)
class Implausible:
    """A value that was probably not meant, and what to write."""

    field: str
    kind: str  # "density", "modulus", "wave", "strain", "friction" or "damping ratio"
    sentence: str


@dataclass(frozen=True)
class _Body:
    """What is elastic: a block or a layer."""

    place: str  # of its keys
    density: float
    young: float
    speed: float  # of its wave [m/s]
    strains: dict[str, float]  # static strain by the key of what causes it


def implausible_values(scene: Scene) -> list[Implausible]:
    """Return the values of one case that were probably not meant, none where the scene says that they are."""
    if scene.extreme:
        return []
    values: list[Implausible] = []
    for body in _bodies(scene):
        units = [*_density(body), *_modulus(body)]
        # Speed and strain follow from both; with a wrong unit they say nothing new.
        values += units or [*_wave(body), *_strain(body)]
    for field, angle in _friction_angles(scene):
        values += _friction(field, angle)
    if scene.kind == "block":
        values += _damping_ratio(scene.contact.damping_ratio)
    return values


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


def _bodies(scene: Scene) -> Iterator[_Body]:
    if scene.rigid is not None:  # no modulus, and so neither speed nor strain
        return
    if scene.plane is not None:
        yield _of_plane(scene.plane)
        return
    if scene.column is not None:
        yield from _layers(scene, scene.column)
        return
    block = scene.block
    load = scene.load
    modulus = block.young
    if block.hypothesis == "plane strain":
        modulus /= 1 - block.poisson**2
    height = float(np.ptp([y for _, y in block.outline]))
    strains = {
        "load.pressure": abs(load.pressure) / modulus,
        "load.traction": abs(load.traction) * 2 * (1 + block.poisson) / block.young,
        "load.gravity": block.density * abs(load.gravity) * height / modulus,
    }
    yield _Body("block", block.density, block.young, math.sqrt(modulus / block.density), strains)


def _of_plane(plane: PlaneSection) -> _Body:
    largest = max([*map(abs, plane.stress), *(math.hypot(*load.traction) for load in plane.load)])
    speed = math.sqrt(plane.young / plane.density)
    return _Body("plane", plane.density, plane.young, speed, {"plane.load": largest / plane.young})


def _layers(scene: Scene, column: ColumnSection) -> Iterator[_Body]:
    excitation = scene.stated_input
    foot = 0.0
    for number, layer in enumerate(column.layer):
        if math.isfinite(layer.young):
            modulus = column.modulus(layer)
            speed = math.sqrt(modulus / layer.density)
            strains = {}
            if excitation is not None:
                strains["input.pressure"] = abs(excitation.pressure or 0.0) / modulus
                strains["input.velocity"] = abs(excitation.velocity or 0.0) / speed
            if column.motion == "pressure":
                strains["column.gravity"] = column.static_stress(foot) / modulus
            yield _Body(f"column.layer.{number}", layer.density, layer.young, speed, strains)
        foot += layer.thickness


def _friction_angles(scene: Scene) -> Iterator[tuple[str, float | None]]:
    if scene.rigid is not None:
        yield "rigid.friction", scene.rigid.friction
        return
    if scene.plane is not None:
        return
    if scene.column is None:
        yield "contact.friction", scene.contact.friction
        return
    yield "column.friction", scene.column.friction
    for number, joint in enumerate(scene.column.joint):
        yield f"column.joint.{number}.friction", joint.friction


def _or_meant(advice: str) -> str:
    return f'{advice}, or extreme = "why" if it is meant'


def _density(body: _Body) -> Iterator[Implausible]:
    if body.density >= LEAST_DENSITY:
        return
    unit, factor = ("t/m3", 1000.0) if body.density < LEAST_UNIT_WEIGHT else ("a unit weight in kN/m3", 1000 / EARTH)
    sentence = (
        f"{body.place}.density = {body.density:g} kg/m3 is below {LEAST_DENSITY:g} and looks like {unit}: "
        + _or_meant(f"write density = {body.density * factor:.4g}")
    )
    yield Implausible(f"{body.place}.density", "density", sentence)


def _modulus(body: _Body) -> Iterator[Implausible]:
    if body.young >= LEAST_MODULUS:
        return
    unit, power = ("GPa", 9) if body.young < LARGEST_IN_GPA else ("MPa", 6)
    sentence = (
        f"{body.place}.young = {body.young:g} Pa looks like {unit}, waves run at {body.speed:.3g} m/s: "
        + _or_meant(f"write young = {body.young:g}e{power}")
    )
    yield Implausible(f"{body.place}.young", "modulus", sentence)


def _wave(body: _Body) -> Iterator[Implausible]:
    if SLOWEST <= body.speed <= FASTEST:
        return
    limit = f"slower than {SLOWEST:g} m/s" if body.speed < SLOWEST else f"faster than {FASTEST / 1000:g} km/s"
    factors = (factor for factor in UNIT_FACTORS if SLOWEST <= body.speed * math.sqrt(factor) <= FASTEST)
    factor = next(factors, None)
    advice = "check young and density" if factor is None else f"write young = {body.young * factor:.4g}"
    sentence = (
        f"{body.place}.young = {body.young:g} Pa lets waves run at {body.speed:.3g} m/s, {limit}; "
        f"it looks like another unit: {_or_meant(advice)}"
    )
    yield Implausible(f"{body.place}.young", "wave", sentence)


def _strain(body: _Body) -> Iterator[Implausible]:
    total = sum(body.strains.values())
    if total <= LARGEST_STRAIN:
        return
    cause = max(body.strains, key=lambda field: body.strains[field])
    name = cause.rpartition(".")[2]
    advice = {
        "gravity": f"write {name} = {EARTH:g}",
        "velocity": f"write {name} in m/s",
    }.get(name, f"write {name} in Pa, 5e6 for 5 MPa, and young in Pa")
    sentence = (
        f"{cause} strains {body.place} by {100 * total:.3g} % at rest, above {100 * LARGEST_STRAIN:g} %, and is not "
        f"linear elastic: {_or_meant(advice)}"
    )
    yield Implausible(cause, "strain", sentence)


def _friction(field: str, angle: float | None) -> Iterator[Implausible]:
    if angle is None or angle == 0 or angle >= LEAST_FRICTION:  # 0 is a contact without friction, on purpose
        return
    if angle <= LARGEST_COEFFICIENT:
        degrees = math.degrees(math.atan(angle))
        meaning = f"looks like a coefficient or radians: write friction = {degrees:.4g} for the coefficient"
        advice = f"{meaning}, {math.degrees(angle):.4g} for radians"
    else:
        advice = f"is below {LEAST_FRICTION:g} deg, lower than that of any rock joint: write the angle in degrees"
    yield Implausible(field, "friction", f"{field} = {angle:g} deg {_or_meant(advice)}")


def _damping_ratio(ratio: float) -> Iterator[Implausible]:
    if ratio <= LARGEST_DAMPING_RATIO:
        return
    field = "contact.damping_ratio"
    advice = _or_meant(f"write damping_ratio = {ratio / 100:.4g}")
    sentence = f"{field} = {ratio:g} is above critical damping and looks like per cent: {advice}"
    yield Implausible(field, "damping ratio", sentence)
