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
from validation.scenes.rigid import RigidSection
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
GREATEST_DENSITY = 25_000.0  # kg/m3: above any element's
UNIT_WEIGHTS = 2e5  # N/m3
LEAST_BODY, LARGEST_BODY = 1e-3, 100.0  # m, a block or box
LARGEST_COLUMN = 1e4  # m, a column
LEAST_GRAVITY, GREATEST_GRAVITY = 1.5, 500.0  # m/s2: below that of the Moon; above a centrifuge of 50 g
LEAST_DISCOUNT = 0.5  # of the velocity that is left after a step, unless nothing is
LEAST_PRESSURE = 100.0  # Pa, of a load or cohesion: below one centimetre of water
LEAST_STRESS_RATIO = 1e-6  # of a load over the modulus, below which it is looked at
LARGEST_SINK = 0.1  # of the height, at rest
EXPLAIN_A_SINK = ("gravity", "pressure", "density", "modulus", "size", "strain")
LEAST_SPRING = 1e-6  # of the modulus, where nothing loads the springs
GREATEST_SPRING = 1e9  # of the modulus: what the block itself does is lost in rounding
LARGEST_GAP, LARGEST_BAND = 10.0, 0.1  # times the height of a block
LARGEST_WEIGHT = 2.0  # alpha and delta of any scheme in use
GREATEST_FRICTION = 80.0  # deg
GREATEST_COHESION = 0.01  # of the modulus
LEAST_GLUE = 1e-3  # of the modulus
SLOWEST_INPUT = 1e-2  # of a period within the run
LARGEST_GROUND = 100.0  # m/s2, of the ground below boxes: ten times the Earth's gravity
LONGEST_STEP, SHORTEST_STEP = 1000.0, 1e-7  # times a wave's travel through the block
LONGEST_FALL = 10.0  # times a box's fall by its own height
LONGEST_RAMP = 10.0  # times the run
FASTEST_START = 0.01  # of the wave's speed: a strain of a per cent at landing
UNIT_FACTORS = (1e-3, 1e-6, 1e-9, 1e3, 1e6, 1e9)  # between Pa, kPa, MPa and GPa


@dataclass(frozen=True)
class Implausible:
    """A value that was probably not meant, and what to write."""

    field: str
    kind: str  # "density", "modulus", "wave", "strain", "friction", "damping ratio", "gravity", "gg", "size" and so on
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
        values += _of_block(scene)
    if scene.column is not None:
        values += _of_column(scene, scene.column)
    if scene.rigid is not None:
        values += _of_boxes(scene, scene.rigid)
    values += _discount(scene)
    values += _interchanged(scene)
    for field, size in _sizes(scene):
        values += _size(field, size, LARGEST_COLUMN if scene.kind == "column" else LARGEST_BODY)
    for field, gravity in _gravities(scene):
        values += _gravity(field, gravity)
    for field, pressure, modulus in _pressures(scene):
        values += _pressure(field, pressure, modulus)
    if not any(value.kind in EXPLAIN_A_SINK for value in values):
        values += _sink(scene)
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
    if body.density > GREATEST_DENSITY:
        field = f"{body.place}.density"
        meant = f"looks like g/m3 or a unit weight in N/m3: write density = {body.density / 1000:.4g}"
        if body.density < UNIT_WEIGHTS:
            meant = f"looks like a unit weight in N/m3: write density = {body.density / EARTH:.4g}"
        yield Implausible(field, "density", f"{field} = {body.density:g} kg/m3 {_or_meant(meant)}")
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
    if angle is not None and angle > GREATEST_FRICTION:
        advice = "is steeper than that of any joint: leave friction out, and contacts never slip"
        yield Implausible(field, "friction", f"{field} = {angle:g} deg {_or_meant(advice)}")
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


# ---- signs, sizes and what stands in another key's place -----------------------------------------------------------


def _gravities(scene: Scene) -> Iterator[tuple[str, float]]:
    if scene.kind == "block":
        yield "load.gravity", scene.load.gravity
    elif scene.column is not None:
        yield "column.gravity", scene.column.gravity
    elif scene.rigid is not None:
        yield "rigid.gravity", scene.rigid.gravity


def _gravity(field: str, gravity: float) -> Iterator[Implausible]:
    if gravity < 0:  # tables of boxes and columns refuse it
        sentence = f"{field} = {gravity:g} m/s2 pulls upwards, since gravity acts downwards where it is positive"
        yield Implausible(field, "gravity", f"{sentence}: {_or_meant(f'write gravity = {-gravity:g}')}")
    elif gravity > GREATEST_GRAVITY or 0 < gravity < LEAST_GRAVITY:
        sentence = f"{field} = {gravity:g} m/s2 looks like another unit"
        yield Implausible(field, "gravity", f"{sentence}: {_or_meant(f'write gravity = {EARTH:g}')}")


def _discount(scene: Scene) -> Iterator[Implausible]:
    gg = scene.time.discount
    if not 0 < gg < LEAST_DISCOUNT or scene.kind == "rigid":
        return
    if scene.time.gg_rate is not None:
        field = "time.gg_rate"
        stated = f"{field} = {scene.time.gg_rate:g} 1/s leaves gg = {gg:.3g} of the velocity"
        advice = "write the rate in 1/s, 2 w1 xi for the damping ratio xi"
    else:
        field = "time.gg"
        stated = f"{field} = {gg:g} leaves {gg:g} of the velocity"
        advice = f"write gg = {1 - gg:g} to take {100 * gg:g} %, or gg = 0 to take all of it"
    yield Implausible(field, "gg", f"{stated} after every step: {_or_meant(advice)}")


def _interchanged(scene: Scene) -> Iterator[Implausible]:
    t = scene.time
    if scene.kind == "rigid" or t.scheme != "newmark":
        return
    greatest = max(t.stated_alpha, t.stated_delta)
    if greatest > LARGEST_WEIGHT:
        name = "alpha" if t.stated_alpha == greatest else "delta"
        advice = _or_meant("write alpha = 0.5, delta = 1 for constant acceleration, 0.25, 0.5 for average acceleration")
        yield Implausible(f"time.{name}", "scheme", f"time.{name} = {greatest:g} is no scheme's in use: {advice}")
        return
    if t.stated_alpha <= t.stated_delta:
        return
    sentence = f"time.alpha = {t.stated_alpha:g} is above time.delta = {t.stated_delta:g}, interchanged?"
    advice = f"write alpha = {t.stated_delta:g} and delta = {t.stated_alpha:g}"
    yield Implausible("time.alpha", "scheme", f"{sentence} {_or_meant(advice)}")


def _sizes(scene: Scene) -> Iterator[tuple[str, float]]:
    if scene.kind == "block":
        width, height = np.ptp(scene.block.outline, axis=0)
        names = ("side", "width", "height", "vertices")
        stated = [name for name in names if name in scene.block.model_fields_set]
        if "side" in stated or "vertices" in stated:
            yield f"block.{stated[0]}", float(max(width, height))
        else:
            yield "block.width", float(width)
            yield "block.height", float(height)
    elif scene.column is not None:
        for number, layer in enumerate(scene.column.layer):
            yield f"column.layer.{number}.thickness", layer.thickness
    elif scene.rigid is not None:
        for number, box in enumerate(scene.rigid.box):
            yield f"rigid.box.{number}.width", box.width
            yield f"rigid.box.{number}.height", box.height


def _size(field: str, size: float, largest: float) -> Iterator[Implausible]:
    if LEAST_BODY <= size <= largest:
        return
    name = field.rpartition(".")[2]
    written = "the vertices in m" if name == "vertices" else f"{name} = {size / 1000:g}"
    advice = f"looks like mm: write {written}"
    if size < LEAST_BODY:
        advice = "is below a millimetre: write it in m"
    yield Implausible(field, "size", f"{field} = {size:g} m {_or_meant(advice)}")


def _pressures(scene: Scene) -> Iterator[tuple[str, float, float]]:
    """Yield the field of each load or strength in Pa, its value and the modulus beside it."""
    if scene.kind == "block":
        young = scene.block.young
        yield "load.pressure", scene.load.pressure, young
        yield "load.traction", scene.load.traction, young
        yield "contact.cohesion", scene.contact.cohesion, young
    elif scene.column is not None:
        moduli = [layer.young for layer in scene.column.layer if math.isfinite(layer.young)]
        if moduli:
            driven = scene.stated_input
            yield "input.pressure", (driven.pressure or 0.0) if driven else 0.0, min(moduli)
            yield "column.strength", scene.column.strength or 0.0, min(moduli)
            for number, joint in enumerate(scene.column.joint):
                yield f"column.joint.{number}.strength", joint.strength or 0.0, min(moduli)


def _pressure(field: str, pressure: float, modulus: float) -> Iterator[Implausible]:
    name = field.rpartition(".")[2]
    if name == "pressure" and field.startswith("load") and pressure < 0:
        sentence = f"{field} = {pressure:g} Pa pulls the top edge upwards, since pressure acts downwards where positive"
        yield Implausible(field, "pressure", f"{sentence}: {_or_meant(f'write pressure = {-pressure:g}')}")
        return
    if name in ("cohesion", "strength") and pressure > GREATEST_COHESION * modulus:
        sentence = f"{field} = {pressure:g} Pa is {pressure / modulus:.2g} of the modulus, above any rock's"
        yield Implausible(field, "pressure", f"{sentence}: {_or_meant(f'write {name} in Pa, 1e6 for 1 MPa')}")
        return
    if pressure == 0 or abs(pressure) >= LEAST_PRESSURE or abs(pressure) >= LEAST_STRESS_RATIO * modulus:
        return
    sentence = f"{field} = {pressure:g} Pa beside a modulus of {modulus:g} Pa looks like MPa"
    yield Implausible(field, "pressure", f"{sentence}: {_or_meant(f'write {name} = {pressure:g}e6')}")


def _sink(scene: Scene) -> Iterator[Implausible]:
    """Yield springs that give way by a tenth of the height, at rest."""
    if scene.kind == "block" and math.isfinite(scene.contact.stiffness):
        c = scene.contact
        b = scene.block
        height = float(np.ptp([y for _, y in b.outline]))
        load = abs(scene.load.pressure) * b.base_length + b.mass * abs(scene.load.gravity)
        sink = load / (2 * c.stiffness)
        if sink > LARGEST_SINK * height:
            sentence = f"contact.stiffness = {c.stiffness:g} N/m lets the block sink by {sink:.3g} m at rest"
            advice = f"write stiffness in N/m, such as {b.young:g} to {10 * b.young:g}"
            yield Implausible("contact.stiffness", "stiffness", f"{sentence}: {_or_meant(advice)}")
        elif load == 0 and c.stiffness < LEAST_SPRING * b.young:
            sentence = f"contact.stiffness = {c.stiffness:g} N/m is {c.stiffness / b.young:.1g} of the modulus"
            advice = f"write stiffness in N/m, such as {b.young:g} to {10 * b.young:g}"
            yield Implausible("contact.stiffness", "stiffness", f"{sentence}: {_or_meant(advice)}")
    elif scene.column is not None:
        yield from _column_sinks(scene, scene.column)
    elif scene.rigid is not None and scene.rigid.stiffness is not None:
        rigid = scene.rigid
        sink = sum(box.mass for box in rigid.box) * abs(rigid.gravity) / (rigid.stiffness or 1.0)
        if sink > LARGEST_SINK * rigid.box[0].height:
            sentence = f"rigid.stiffness = {rigid.stiffness:g} N/m lets the boxes sink by {sink:.3g} m at rest"
            yield Implausible("rigid.stiffness", "stiffness", f"{sentence}: {_or_meant('write it in N/m')}")


def _column_sinks(scene: Scene, column: ColumnSection) -> Iterator[Implausible]:
    driven = scene.stated_input
    pressure = abs(driven.pressure or 0.0) if driven else 0.0
    springs = [(f"column.joint.{i}.stiffness", joint.height, joint.stiffness) for i, joint in enumerate(column.joint)]
    springs += [("column.base_stiffness", 0.0, column.base_stiffness or math.inf)]
    springs += [("column.stiffness", 0.0, column.stiffness or math.inf), ("column.glue", 0.0, column.glue or math.inf)]
    for field, height, stiffness in springs:
        sink = (column.static_stress(height) + pressure) / stiffness
        if sink > LARGEST_SINK * column.height:
            sentence = f"{field} = {stiffness:g} Pa/m gives way by {sink:.3g} m at rest"
            advice = "write it in Pa/m, of the order of the modulus over the height of a block"
            yield Implausible(field, "stiffness", f"{sentence}: {_or_meant(advice)}")


def _of_block(scene: Scene) -> Iterator[Implausible]:
    """Yield times, speeds and lengths of a block that are out of proportion to it."""
    b = scene.block
    t = scene.time
    speed = math.sqrt(b.young / b.density)
    height = float(np.ptp([y for _, y in b.outline]))
    if not 0 < speed / height < math.inf:  # said already of the modulus
        return
    travel = height / speed
    if not SHORTEST_STEP * travel <= t.step <= LONGEST_STEP * travel and SLOWEST <= speed <= FASTEST:
        size = "longer" if t.step > travel else "shorter"
        ratio = t.step / travel if t.step > travel else travel / t.step
        sentence = f"time.step = {t.step:g} s is {ratio:.3g} times {size} than a wave takes through the block"
        yield Implausible("time.step", "step", f"{sentence}: {_or_meant('write step in s, 0.001 for 1 ms')}")
    if scene.load.ramp > LONGEST_RAMP * t.duration:
        sentence = f"load.ramp = {scene.load.ramp:g} s ends long after the run of {t.duration:g} s"
        yield Implausible("load.ramp", "ramp", f"{sentence}: {_or_meant('write ramp in s')}")
    if abs(b.velocity) > FASTEST_START * speed:
        sentence = f"block.velocity = {b.velocity:g} m/s is above a hundredth of the wave's speed, {speed:.3g} m/s"
        yield Implausible("block.velocity", "velocity", f"{sentence}: {_or_meant('write velocity in m/s')}")
    if b.poisson < 0:
        sentence = f"block.poisson = {b.poisson:g} is negative, which no rock has"
        yield Implausible("block.poisson", "poisson", f"{sentence}: {_or_meant(f'write poisson = {-b.poisson:g}')}")
    c = scene.contact
    if math.isfinite(c.stiffness) and c.stiffness > GREATEST_SPRING * b.young:
        sentence = f"contact.stiffness = {c.stiffness:g} N/m is {c.stiffness / b.young:.2g} times the modulus"
        advice = f"write stiffness in N/m, such as {b.young:g} to {100 * b.young:g}, or inf where contact opens"
        yield Implausible("contact.stiffness", "stiffness", f"{sentence}: {_or_meant(advice)}")
    if c.shear_stiffness and math.isfinite(c.stiffness) and c.shear_stiffness < LEAST_SPRING * c.stiffness:
        sentence = f"contact.shear_stiffness = {c.shear_stiffness:g} N/m is {c.shear_stiffness / c.stiffness:.1g} of p"
        advice = f"write shear_stiffness = {c.stiffness:g}, or 0 without shear springs"
        yield Implausible("contact.shear_stiffness", "stiffness", f"{sentence}: {_or_meant(advice)}")
    if b.subdivide is not None and b.glue_ratio < LEAST_GLUE:
        sentence = f"block.glue_ratio = {b.glue_ratio:g} lets the sub-blocks part"
        yield Implausible("block.glue_ratio", "stiffness", f"{sentence}: {_or_meant('write it over young, 1 to 1e6')}")
    lengths = {"contact.gap": (c.gap, LARGEST_GAP), "contact.band": (max(c.band), LARGEST_BAND)}
    for field, (length, largest) in lengths.items():
        if length > largest * height:
            sentence = f"{field} = {length:g} m is {length / height:.3g} times the height of the block"
            yield Implausible(field, "gap", f"{sentence}: {_or_meant('write it in m, 0.001 for 1 mm')}")
    frequency = math.sqrt(3) * speed / height  # of the block of one strain on a rigid base
    ratio = scene.damping.mass / (2 * frequency) + scene.damping.stiffness * frequency / 2
    if ratio > LARGEST_DAMPING_RATIO:
        by_mass = scene.damping.mass / frequency > scene.damping.stiffness * frequency
        field = "damping.mass" if by_mass else "damping.stiffness"
        sentence = f"{field} damps a mode of {frequency:.3g} rad/s at {ratio:.3g} times critical"
        advice = "write a0 = 2 w xi in 1/s or a1 = 2 xi / w in s for the damping ratio xi"
        yield Implausible(field, "damping ratio", f"{sentence}: {_or_meant(advice)}")


def _of_column(scene: Scene, column: ColumnSection) -> Iterator[Implausible]:
    """Yield times, springs and gaps of a column that are out of proportion to it."""
    t = scene.time
    moduli = [column.modulus(layer) for layer in column.layer]
    travel = sum(layer.thickness * math.sqrt(layer.density / column.modulus(layer)) for layer in column.layer)
    if travel > 0 and t.step > LONGEST_STEP / 10 * travel:
        sentence = f"time.step = {t.step:g} s is {t.step / travel:.3g} times as long as a wave in the column"
        yield Implausible("time.step", "step", f"{sentence}: {_or_meant('write step in s, 0.001 for 1 ms')}")
    driven = scene.stated_input
    if driven is not None and driven.frequency is not None and driven.frequency * t.duration < SLOWEST_INPUT:
        sentence = f"input.frequency = {driven.frequency:g} Hz shows {driven.frequency * t.duration:.1g} of a period"
        yield Implausible("input.frequency", "frequency", f"{sentence}: {_or_meant('write frequency in Hz')}")
    least = LEAST_SPRING * min(moduli) / column.height
    springs = {"column.glue": column.glue, "column.base_stiffness": column.base_stiffness}
    for field, stiffness in springs.items():
        if stiffness is not None and math.isfinite(least) and stiffness < least:
            sentence = (
                f"{field} = {stiffness:g} Pa/m is {stiffness * column.height / min(moduli):.1g} of E over the height"
            )
            advice = "write it in Pa/m, of the order of the modulus over the height of a block"
            yield Implausible(field, "stiffness", f"{sentence}: {_or_meant(advice)}")
    gaps = {"column.gap": column.gap} | {f"column.joint.{i}.gap": joint.gap for i, joint in enumerate(column.joint)}
    for field, gap in gaps.items():
        if gap > column.height:
            sentence = f"{field} = {gap:g} m is wider than the column is high"
            yield Implausible(field, "gap", f"{sentence}: {_or_meant('write it in m, 0.001 for 1 mm')}")


def _of_boxes(scene: Scene, rigid: RigidSection) -> Iterator[Implausible]:
    """Yield times and motions of the ground that are out of proportion to boxes."""
    t = scene.time
    fall = math.sqrt(2 * max(box.height for box in rigid.box) / rigid.gravity) if rigid.gravity > 0 else math.inf
    if t.step > LONGEST_FALL * fall:
        sentence = f"time.step = {t.step:g} s is {t.step / fall:.3g} times as long as a box falls by its height"
        yield Implausible("time.step", "step", f"{sentence}: {_or_meant('write step in s, 0.001 for 1 ms')}")
    rate = 2 * math.pi * rigid.base_frequency
    peak = abs(rigid.base_amplitude) * rate * rate
    if peak > LARGEST_GROUND:
        sentence = (
            f"rigid.base_amplitude = {rigid.base_amplitude:g} m at {rigid.base_frequency:g} Hz is {peak:.3g} m/s2"
        )
        advice = "write base_amplitude in m and base_frequency in Hz"
        yield Implausible("rigid.base_amplitude", "ground", f"{sentence}: {_or_meant(advice)}")
