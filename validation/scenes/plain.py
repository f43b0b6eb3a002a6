"""A scene as plain data, for programs in any language: what its motion depends on, the units in the names."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping
from dataclasses import fields
from typing import Any

from validation.errors import InputError
from validation.models.column.tables import Contact, InputSection, JointSection, LayerSection
from validation.models.rigid.tables import BoxSection, RigidSection
from validation.runs.units import named
from validation.scenes.keys import Section, keys_of, stated, stated_value
from validation.scenes.scene import Scene
from validation.scenes.tables import BlockSection, ContactSection, LoadSection

# Keys that the motion does not depend on: how a solver of this suite steps or cuts, and what another key says.
UNSTATED: Mapping[type[Section], frozenset[str]] = {
    BlockSection: frozenset({"side", "vertices", "base", "top", "subdivide", "pattern", "glue_ratio"}),
    ContactSection: frozenset(
        {"rule", "damping_ratio", "restitution", "penetration", "rules", "band", "solve_limit", "cut"}
    ),
    LoadSection: frozenset({"ramp", "base_motion"}),
    LayerSection: frozenset({"blocks"}),
    JointSection: frozenset({"gap", "strength", "friction"}),
    InputSection: frozenset({"record"}),
    BoxSection: frozenset({"x", "lift", "tilt"}),
    RigidSection: frozenset({"refine"}),
}
OF_COLUMN = ("motion", "law", "gravity", "settled", "base", "base_density", "base_speed", "heights")
OF_SHAPE = frozenset({"side", "width", "height"})  # of a block: what its width and height say


def scene_data(scene: Scene) -> dict[str, Any]:
    """Return what a scene states of a problem, table by table: what the motion depends on, and not how it is solved.

    Raises
    ------
    InputError
        A record drives it, which plain data do not hold.
    """
    if scene.rigid is not None:
        return {"rigid": _rigid_data(scene.rigid)}
    if scene.column is not None:
        return _column_data(scene)
    if scene.kind.name != "block":
        raise InputError("must be a block, a column or rigid boxes", source=scene.name, value=scene.kind_in_words)
    (left, low), (right, high) = scene.block.outline[0], scene.block.outline[2]
    block = {"width_m": right - left, "height_m": high - low, **_table(scene.block, "width", "height")}
    contact = _table(scene.contact) | {"shear_stiffness_N_per_m": _plain(scene.contact.shear)}
    geometry = "large rotation" if scene.run.geometry == "updated" else "small"
    return {"block": block, "contact": contact, "load": _table(scene.load), "geometry": geometry}


def words() -> Iterator[tuple[str, str]]:
    """Yield the names of the data of problems and what they mean, as the keys of scenes say it."""
    tables: Mapping[str, type[Section]] = {
        "block": BlockSection,
        "contact": ContactSection,
        "load": LoadSection,
        "column.layers": LayerSection,
        "column.joints": JointSection,
        "input": InputSection,
        "rigid": RigidSection,
        "rigid.boxes": BoxSection,
    }
    for place, table in tables.items():
        for name, _, key in keys_of(table):
            if name not in UNSTATED.get(table, ()):
                yield f"{place}.{named(name, key.unit)}", key.text


def _table(section: Section, *without: str) -> dict[str, Any]:
    """Return the keys of a table with their units in the names; a key that is absent is null."""
    unstated = UNSTATED.get(type(section), frozenset()) | {*without}
    data = {}
    for name, _, key in keys_of(type(section)):
        if name not in unstated:
            data[named(name, key.unit)] = _plain(stated_value(section, name))
    return data


def _plain(value: Any) -> Any:
    """Return a value as JSON has it, which knows no infinity."""
    if isinstance(value, tuple):
        return [_plain(part) for part in value]
    return "inf" if value == math.inf else value


def _column_data(scene: Scene) -> dict[str, Any]:
    column = scene.column
    drive = scene.stated_input
    if column is None or (drive is not None and drive.shape is None):
        raise InputError(
            "must be a shape in a problem, whose data hold no record",
            source=scene.name,
            field="input.shape",
            value="a record",
        )
    data = {}
    for name, _, key in keys_of(type(column)):
        if name in OF_COLUMN:
            data[named(name, key.unit)] = _plain(stated_value(column, name))
    if column.base == "springs":  # the lowest of the joints or contacts
        data["base"] = "rigid"
    data["layers"] = [_table(layer) for layer in column.layer]
    if column.law == "bonded":
        data["glue_Pa_per_m"] = column.glue
        data["joints"] = [_table(spring) for spring in column.springs]
    else:
        data["contacts"] = [_contact_data(contact) for contact in column.contacts]
    return {"column": data, "input": None if drive is None else _table(drive)}


def _contact_data(contact: Contact) -> dict[str, Any]:
    """Return a contact of a column; friction is the strength that it amounts to."""
    units = {name: key.unit for name, _, key in keys_of(JointSection)}
    return {named(field.name, units[field.name]): _plain(getattr(contact, field.name)) for field in fields(contact)}


def _rigid_data(rigid: RigidSection) -> dict[str, Any]:
    """Return rigid boxes on a plane, each where it is at t = 0."""
    boxes = []
    for box, (x, y, angle) in zip(rigid.box, rigid.starts, strict=True):
        boxes.append(_table(box) | {"x_m": x, "y_m": y, "angle_rad": angle})
    return _table(rigid) | {"boxes": boxes}


def lines(scene: Scene) -> Iterator[str]:
    """Yield a scene for a program that reads words: a key and its values in a line, ``contact.stiffness_N_per_m 1e9``.

    What is null is left out. A key that problems never state follows the word ``also`` where it is not at its default:
    a program that does not know it refuses the scene.
    """
    time = scene.time
    data = scene_data(scene)
    data["time"] = {
        "step_s": time.step,
        "steps": time.steps,
        "scheme": time.scheme,
        "alpha": time.alpha,
        "delta": time.delta,
        "gg": time.discount,
        "start": time.start,
    }
    data["columns"] = list(scene.run.columns)
    yield from _flat("", data)
    sections: dict[str, Section] = {"damping": scene.damping}
    if scene.kind.name == "block":
        sections |= {"block": scene.block, "contact": scene.contact, "load": scene.load}
    for place, section in sections.items():
        for name, value, key in stated(section):
            if name not in OF_SHAPE and name in UNSTATED.get(type(section), (name,)):
                yield from _flat(f"also {place}.{named(name, key.unit)}", _plain(value))


def _flat(place: str, value: Any) -> Iterator[str]:
    if isinstance(value, dict):
        for name, part in value.items():
            yield from _flat(f"{place}.{name}" if place else name, part)
    elif isinstance(value, list) and value and isinstance(value[0], dict):
        for number, part in enumerate(value, start=1):
            yield from _flat(f"{place}.{number}", part)
    elif value is not None:
        words = value if isinstance(value, list) else [value]
        yield f"{place} {' '.join(str(word).replace(' ', '-') for word in words)}"
