"""Values of a scene that no rock, soil or concrete has, which are most often values in another unit.

Limits and sentences are rows of `plausibility.toml`; here are the quantities of a scene that are held against them. A
scene that means its values says why: its key `extreme` holds the reason, and nothing is warned of.
"""

from __future__ import annotations

import math
import tomllib
import warnings
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from validation.errors import PlausibilityWarning
from validation.models.column.tables import ColumnSection
from validation.models.rigid.tables import RigidSection
from validation.scenes.scene import Scene

TABLE: dict[str, Any] = tomllib.loads(Path(__file__).with_suffix(".toml").read_text(encoding="utf-8"))
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
    """Yield what a row of the table says of a quantity, if its value lies beyond a limit.

    Parameters
    ----------
    quantity
        Name of the rows.
    field
        The key of the scene that the sentence is about.
    value
        What is held against the limits.
    numbers
        What the sentence tells beside it.
    """
    for row in TABLE[quantity]:
        if row.get("above", -math.inf) < value < row.get("below", math.inf):
            name = field.rpartition(".")[2]
            words = {"field": field, "name": name, "value": value, "other": value * row.get("times", 1.0), **numbers}
            sentence = f'{row["says"].format(**words)}, or extreme = "why" if it is meant'
            yield Implausible(field, KINDS.get(quantity, quantity), sentence)
            return


def implausible_values(scene: Scene) -> list[Implausible]:
    """Return the values of one case that were probably not meant, none where the scene says that they are."""
    if scene.extreme:
        return []
    values = [*_materials(scene), *_frictions(scene)]
    if scene.column is not None:
        values += [*_of_column(scene, scene.column), *_time(scene), *_column_loads(scene, scene.column)]
    elif scene.rigid is not None:
        values += [*_of_boxes(scene, scene.rigid), *_box_sizes(scene.rigid)]
    elif scene.plane is not None:
        values += _time(scene)
    else:
        values += [*_of_block(scene), *_time(scene), *_block_loads(scene)]
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


# ---- what is elastic ------------------------------------------------------------------------------------------------


def _materials(scene: Scene) -> Iterator[Implausible]:
    if scene.plane is not None:
        plane = scene.plane
        largest = max([*map(abs, plane.stress), *(math.hypot(*load.traction) for load in plane.load)])
        speed = math.sqrt(plane.young / plane.density)
        yield from _material("plane", plane.density, plane.young, speed, {"plane.load": largest / plane.young})
    elif scene.column is not None:
        yield from _of_layers(scene, scene.column)
    elif scene.rigid is None:
        block = scene.block
        load = scene.load
        modulus = block.young
        if block.hypothesis == "plane strain":
            modulus /= 1 - block.poisson**2
        strains = {
            "load.pressure": abs(load.pressure) / modulus,
            "load.traction": abs(load.traction) * 2 * (1 + block.poisson) / block.young,
            "load.gravity": block.density * abs(load.gravity) * scene.block.extent[1] / modulus,
        }
        yield from _material("block", block.density, block.young, math.sqrt(modulus / block.density), strains)


def _of_layers(scene: Scene, column: ColumnSection) -> Iterator[Implausible]:
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
            yield from _material(f"column.layer.{number}", layer.density, layer.young, speed, strains)
        foot += layer.thickness


def _material(
    place: str, density: float, young: float, speed: float, strains: dict[str, float]
) -> Iterator[Implausible]:
    """Yield what a body's density and modulus say; else its wave and its strain, which follow from both.

    Parameters
    ----------
    place
        Of its keys.
    density, young, speed
        Density [kg/m3], modulus [Pa] and speed of its wave [m/s].
    strains
        Static strain by the key of what causes it [1].
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


def _frictions(scene: Scene) -> Iterator[Implausible]:
    angles: dict[str, float | None] = {}
    if scene.rigid is not None:
        angles["rigid.friction"] = scene.rigid.friction
    elif scene.column is not None:
        angles["column.friction"] = scene.column.friction
        angles |= {f"column.joint.{i}.friction": joint.friction for i, joint in enumerate(scene.column.joint)}
    elif scene.plane is None:
        angles["contact.friction"] = scene.contact.friction
    for field, angle in angles.items():
        if angle:  # 0 is a contact without friction, on purpose
            yield from judged("friction", field, angle, slope=math.degrees(math.atan(angle)))


# ---- steps and schemes ----------------------------------------------------------------------------------------------


def _time(scene: Scene) -> Iterator[Implausible]:
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


# ---- blocks ---------------------------------------------------------------------------------------------------------


def _of_block(scene: Scene) -> Iterator[Implausible]:
    """Yield times, speeds and lengths of a block that are out of proportion to it."""
    b = scene.block
    c = scene.contact
    t = scene.time
    yield from judged("damping_ratio", "contact.damping_ratio", c.damping_ratio)
    speed = math.sqrt(b.young / b.density)
    height = scene.block.extent[1]
    if not 0 < speed / height < math.inf:  # said already of the modulus
        return
    travel = height / speed
    if SLOWEST <= speed <= FASTEST:
        yield from judged("step", "time.step", t.step / travel, step=t.step, inverse=travel / t.step)
    yield from judged("ramp", "load.ramp", scene.load.ramp / t.duration, ramp=scene.load.ramp, duration=t.duration)
    yield from judged("velocity", "block.velocity", abs(b.velocity) / speed, velocity=b.velocity, speed=speed)
    yield from judged("poisson", "block.poisson", b.poisson)
    if math.isfinite(c.stiffness):
        springs = {"stiffness": c.stiffness, "young": b.young, "hundredfold": 100 * b.young}
        yield from judged("springs", "contact.stiffness", c.stiffness / b.young, **springs)
        shear = c.shear_stiffness or 0.0
        shear_springs = {"shear": shear, "stiffness": c.stiffness}
        yield from judged("shear_springs", "contact.shear_stiffness", shear / c.stiffness, **shear_springs)
    if b.subdivide is not None:
        yield from judged("glue_ratio", "block.glue_ratio", b.glue_ratio)
    for name, length in (("gap", c.gap), ("band", max(c.band))):
        yield from judged(name, f"contact.{name}", length / height, length=length)
    frequency = math.sqrt(3) * speed / height  # of the block of one strain on a rigid base
    by_mass = scene.damping.mass / (2 * frequency)
    by_stiffness = scene.damping.stiffness * frequency / 2
    field = "damping.mass" if by_mass > by_stiffness else "damping.stiffness"
    yield from judged("rayleigh", field, by_mass + by_stiffness, frequency=frequency)


def _block_loads(scene: Scene) -> Iterator[Implausible]:
    """Yield sizes, gravity, loads and strength of a block."""
    b = scene.block
    width, height = b.extent
    stated = [name for name in ("side", "vertices") if name in b.model_fields_set]
    if stated:
        yield from judged("vertices" if b.vertices is not None else "size", f"block.{stated[0]}", max(width, height))
    else:
        yield from judged("size", "block.width", width)
        yield from judged("size", "block.height", height)
    yield from judged("gravity", "load.gravity", scene.load.gravity)
    yield from judged("tension", "load.pressure", scene.load.pressure)
    yield from _pressure("load.pressure", scene.load.pressure, b.young)
    yield from _pressure("load.traction", scene.load.traction, b.young)
    yield from _strength("contact.cohesion", scene.contact.cohesion, b.young)


def _strength(field: str, strength: float, modulus: float) -> Iterator[Implausible]:
    yield from judged("strength", field, strength / modulus, pressure=strength)
    yield from _pressure(field, strength, modulus)


def _pressure(field: str, pressure: float, modulus: float) -> Iterator[Implausible]:
    share = max(abs(pressure) / LEAST_PRESSURE, abs(pressure) / modulus / LEAST_STRESS_RATIO)
    yield from judged("pressure", field, share, pressure=pressure, modulus=modulus)


# ---- columns --------------------------------------------------------------------------------------------------------


def _of_column(scene: Scene, column: ColumnSection) -> Iterator[Implausible]:
    """Yield times, springs and gaps of a column that are out of proportion to it."""
    t = scene.time
    moduli = [column.modulus(layer) for layer in column.layer]
    travel = sum(layer.thickness * math.sqrt(layer.density / column.modulus(layer)) for layer in column.layer)
    if travel > 0:
        yield from judged("column_step", "time.step", t.step / travel, step=t.step)
    driven = scene.stated_input
    if driven is not None and driven.frequency is not None:
        periods = driven.frequency * t.duration
        yield from judged("frequency", "input.frequency", periods, frequency=driven.frequency)
    for name, stiffness in (("glue", column.glue), ("base_stiffness", column.base_stiffness)):
        if stiffness is not None and math.isfinite(min(moduli)):
            share = stiffness * column.height / min(moduli)
            yield from judged("column_springs", f"column.{name}", share, stiffness=stiffness)
    gaps = {"column.gap": column.gap} | {f"column.joint.{i}.gap": joint.gap for i, joint in enumerate(column.joint)}
    for field, gap in gaps.items():
        yield from judged("column_gap", field, gap / column.height, gap=gap)


def _column_loads(scene: Scene, column: ColumnSection) -> Iterator[Implausible]:
    """Yield sizes, gravity, pressure and strengths of a column."""
    for number, layer in enumerate(column.layer):
        yield from judged("thickness", f"column.layer.{number}.thickness", layer.thickness)
    yield from judged("gravity", "column.gravity", column.gravity)
    moduli = [layer.young for layer in column.layer if math.isfinite(layer.young)]
    if moduli:
        yield from _pressure("input.pressure", _input_pressure(scene), min(moduli))
        yield from _strength("column.strength", column.strength or 0.0, min(moduli))
        for number, joint in enumerate(column.joint):
            yield from _strength(f"column.joint.{number}.strength", joint.strength or 0.0, min(moduli))


def _input_pressure(scene: Scene) -> float:
    driven = scene.stated_input
    return 0.0 if driven is None or driven.pressure is None else driven.pressure


# ---- boxes ----------------------------------------------------------------------------------------------------------


def _of_boxes(scene: Scene, rigid: RigidSection) -> Iterator[Implausible]:
    """Yield times and motions of the ground that are out of proportion to boxes."""
    step = scene.time.step
    if rigid.gravity > 0:
        fall = math.sqrt(2 * max(box.height for box in rigid.box) / rigid.gravity)
        yield from judged("box_step", "time.step", step / fall, step=step)
    rate = 2 * math.pi * rigid.base_frequency
    peak = abs(rigid.base_amplitude) * rate * rate
    motion = {"amplitude": rigid.base_amplitude, "frequency": rigid.base_frequency}
    yield from judged("ground", "rigid.base_amplitude", peak, **motion)


def _box_sizes(rigid: RigidSection) -> Iterator[Implausible]:
    for number, box in enumerate(rigid.box):
        yield from judged("size", f"rigid.box.{number}.width", box.width)
        yield from judged("size", f"rigid.box.{number}.height", box.height)
    yield from judged("gravity", "rigid.gravity", rigid.gravity)


# ---- at rest --------------------------------------------------------------------------------------------------------


def _sink(scene: Scene) -> Iterator[Implausible]:
    """Yield springs that give way by a tenth of the height, at rest."""
    if scene.column is not None:
        yield from _column_sinks(scene, scene.column)
    elif scene.rigid is not None:
        rigid = scene.rigid
        if rigid.stiffness is not None:
            sink = sum(box.mass for box in rigid.box) * abs(rigid.gravity) / (rigid.stiffness or 1.0)
            share = sink / rigid.box[0].height
            yield from judged("box_sink", "rigid.stiffness", share, stiffness=rigid.stiffness, sink=sink)
    elif scene.plane is None and math.isfinite(scene.contact.stiffness):
        b = scene.block
        p = scene.contact.stiffness
        load = abs(scene.load.pressure) * b.base_length + b.mass * abs(scene.load.gravity)
        springs = {"stiffness": p, "young": b.young, "tenfold": 10 * b.young}
        if load:
            sink = load / (2 * p)
            yield from judged("sink", "contact.stiffness", sink / scene.block.extent[1], sink=sink, **springs)
        else:
            yield from judged("unloaded", "contact.stiffness", p / b.young, **springs)


def _column_sinks(scene: Scene, column: ColumnSection) -> Iterator[Implausible]:
    pressure = abs(_input_pressure(scene))
    springs = [(f"column.joint.{i}.stiffness", joint.height, joint.stiffness) for i, joint in enumerate(column.joint)]
    for name in ("base_stiffness", "stiffness", "glue"):
        springs.append((f"column.{name}", 0.0, getattr(column, name) or math.inf))
    for field, height, stiffness in springs:
        sink = (column.static_stress(height) + pressure) / stiffness
        yield from judged("column_sink", field, sink / column.height, stiffness=stiffness, sink=sink)
