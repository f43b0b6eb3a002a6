"""The numbers of a scene that may be wrong, and the laws that a program may have in place of the scene's.

One table for every kind of scene: what a candidate changes, by which name people know it, and its id. A change is the
keys and values that carry it, so that any solver runs it.
"""

from __future__ import annotations

import math
import tomllib
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from typing import Any

from validation.diagnosis.constants import UNBOUNDED
from validation.scenes import features
from validation.scenes.scene import Scene

Values = dict[str, Any]
TABLE = tomllib.loads(Path(__file__).with_suffix(".toml").read_text(encoding="utf-8"))
AVERAGE: Values = {"time.alpha": 0.25, "time.delta": 0.5, "time.start": "consistent"}  # given
MORE_BLOCKS = 4  # times as many of a column in an accurate run
EVERYWHERE, WITHOUT_JOINT = "everywhere", "without a joint"  # of a column's contacts


def springs(scene: Scene, factor: float) -> Values:
    """Return the springs larger by a factor, the shear springs with them where they are stated."""
    c = scene.contact
    stiffness = {"contact.stiffness": c.stiffness * factor}
    return stiffness | ({"contact.shear_stiffness": c.shear_stiffness * factor} if c.shear_stiffness else {})


def steeper(angle: float, factor: float) -> float:
    """Return the angle [deg] whose tangent is larger by a factor."""
    return math.degrees(math.atan(factor * math.tan(math.radians(angle))))


def layers(scene: Scene, key: str, factor: float, place: int | None = None) -> Values:
    """Return a datum of all layers of a column, or of one, larger by a factor."""
    stated = scene.definition()["column"]["layer"]
    larger = [_larger(layer, key, factor) if place in (None, number) else layer for number, layer in enumerate(stated)]
    return {"column.layer": larger}


def contacts(scene: Scene, key: str, factor: float, place: str = EVERYWHERE) -> Values:
    """Return a datum of a column's contacts, of a friction angle the tangent, larger by a factor.

    `key` is its name in ``[column]`` and ``[[column.joint]]``, `place` where: at all contacts, at those without a joint
    of their own, or at the height of one [m].
    """
    column = scene.definition()["column"]
    values: Values = {}
    if place != WITHOUT_JOINT and column.get("joint"):
        values["column.joint"] = [
            _larger(joint, key, factor) if place in (EVERYWHERE, f"{joint['height']:g}") else joint
            for joint in column["joint"]
        ]
    if place in (EVERYWHERE, WITHOUT_JOINT) and column.get(key):
        values[f"column.{key}"] = _larger(column, key, factor)[key]
    if place == EVERYWHERE and key == "stiffness" and column.get("base_stiffness"):
        values["column.base_stiffness"] = column["base_stiffness"] * factor
    return values


def _larger(table: Values, key: str, factor: float) -> Values:
    """Return a table with a datum that it has larger by a factor, of a friction angle the tangent."""
    if not table.get(key):
        return table
    value = float(table[key])  # plain data have "inf" for rigid contacts
    return table | {key: steeper(value, factor) if key.endswith("friction") else value * factor}


def places(scene: Scene, key: str) -> dict[str, str]:
    """Return where a datum of a column's contacts is stated, with the words for it: everywhere, then one by one."""
    column = scene.column
    of_base = column.base_stiffness if key == "stiffness" else None
    alone = {WITHOUT_JOINT: "the contacts without a joint"} if _is_number(getattr(column, key)) else {}
    heights = [joint.height for joint in column.joint if _is_number(getattr(joint, key))]
    alone |= {f"{height:g}": f"the contact at {height:g} m" for height in heights[:MOST_JOINTS]}
    if len(alone) + (of_base is not None) > 1:
        return {EVERYWHERE: "all contacts", **alone}
    only = "all contacts" if not column.joint else "the contacts without a joint"
    return alone if WITHOUT_JOINT not in alone else {WITHOUT_JOINT: only}


def sized(scene: Scene, wider: float, higher: float) -> Values:
    """Return the outline, stretched."""
    if scene.block.vertices is not None:
        return {"block.vertices": [[x * wider, y * higher] for x, y in scene.block.vertices]}
    width, height = scene.block.outline[2]
    return {"block.width": width * wider, "block.height": height * higher}


def with_more_blocks(scene: Scene) -> Values:
    """Return a scheme that does not damp and more blocks of a column; the step is left to who asks."""
    layers_of_scene = scene.definition()["column"]["layer"]
    return AVERAGE | {"column.layer": [one | {"blocks": MORE_BLOCKS * one.get("blocks", 1)} for one in layers_of_scene]}


@dataclass(frozen=True, eq=False)
class CandidateChange:
    """One thing changed; with `starts` it has a number u that is fitted."""

    id: str  # of the cause
    words: Callable[[float], str]  # the sentence of the cause by its number
    value: Callable[[float], float]  # the number that people understand, of u
    changed: Callable[[float], Values]  # what of the scene is so, of u
    starts: tuple[float, ...] = ()  # values of u that a fit begins from
    nudge: float = 1e-3  # of u, for the first derivative


def fixed(name: str, words: str, values: Values, number: float = math.nan) -> CandidateChange:
    """Return a change without a fitted number; `number` is what it stands for, nan where there is none."""
    return CandidateChange(name, lambda _: words, lambda _: number, lambda _: values)


@dataclass(frozen=True)
class Number:
    """A number of a scene that may be wrong by a factor."""

    id: str
    name: str
    changed: Callable[[float], Values]  # factor to keys and values


def numbers_of_column(scene: Scene) -> Iterator[Number]:
    """Yield the numbers of a column, as `DiagnosisHooks.numbers`."""
    if any(math.isfinite(layer.young) for layer in scene.column.layer):
        yield Number("young-factor", OF_WAVES, partial(layers, scene, "young"))
    yield Number("density-factor", "the density", partial(layers, scene, "density"))
    yield from _of_contacts(scene)
    yield from _plain(scene, "input")
    if scene.column.impedance is not None:
        yield Number(
            "base-factor", "the impedance below the base, density times speed of the waves,", partial(_impedance, scene)
        )


def numbers_of_block(scene: Scene) -> Iterator[Number]:
    """Yield the numbers of a block, as `DiagnosisHooks.numbers`."""
    yield from _plain(scene, "block", *(["turning"] if features.ROTATION in features.of(scene) else []))
    yield Number("width-factor", "the width", lambda f: sized(scene, f, 1.0))
    yield Number("height-factor", "the height", lambda f: sized(scene, 1.0, f))
    c = scene.contact
    if math.isfinite(c.stiffness):
        yield Number("springs-factor", "the stiffness of the springs", partial(springs, scene))
        if c.shear_stiffness and c.friction is not None:
            key = "contact.shear_stiffness"
            yield Number("shear-springs-factor", "the shear stiffness of the springs", lambda f: {key: c.shear * f})


def numbers_of_layers(scene: Scene) -> Iterator[Number]:
    """Yield the densities of a column's layers, where they differ."""
    stated = scene.column.layer[:MOST_JOINTS]
    for place, _ in enumerate(stated) if len({layer.density for layer in stated}) > 1 else ():
        yield Number(
            "density-factor", f"the density of layer {place + 1}", partial(layers, scene, "density", place=place)
        )


OF_WAVES = "the modulus of the waves, by Young's modulus or Poisson's ratio,"
MOST_JOINTS = 8  # or layers, whose numbers are tried one by one: of more, hardly one stands out


def _of_contacts(scene: Scene) -> Iterator[Number]:
    """Yield the numbers of contacts that open or slip, and what moves them: starting velocities and weight."""
    column = scene.column
    if column.law == "bonded":
        return
    if any(layer.velocity for layer in column.layer):
        yield Number("velocity-factor", "the starting velocity", partial(layers, scene, "velocity"))
    if column.gravity and column.law == "unilateral":  # in shear gravity is in the strengths by friction alone
        yield Number("gravity-factor", "gravity", lambda f: {"column.gravity": column.gravity * f})
    yield from _plain(scene, "input_of_contacts")
    for key, (cause, name) in TABLE["contacts"].items():
        for place, words in places(scene, key).items():
            yield Number(cause, f"{name} of {words}", partial(contacts, scene, key, place=place))


def _is_number(value: float | None) -> bool:
    return bool(value) and math.isfinite(value or 0.0)


def _stated(scene: Scene, key: str) -> Any:
    """Return what a scene states of a key, ``block.density``; None where it has no such section or entry."""
    section, _, entry = key.partition(".")
    return scene.definition().get(section, {}).get(entry)


def _plain(scene: Scene, *tables: str) -> Iterator[Number]:
    """Yield the keys of tables that may be wrong by a factor; later tables have other names for them."""
    rows = {key: row for table in tables for key, row in TABLE[table].items()}
    for key, (cause, name) in rows.items():
        value = _stated(scene, key)
        if isinstance(value, int | float) and value:
            yield Number(cause, name, partial(_larger, {key: value}, key))


def _impedance(scene: Scene, factor: float) -> dict[str, Any]:
    """Return the keys by which (rho E)^(1/2), or rho c, below the base is larger by a factor."""
    base = scene.definition()["column"]
    return {"column.base_density": base["base_density"] * (factor if "base_speed" in base else factor**2)}


def laws(scene: Scene) -> Iterator[CandidateChange]:
    """Yield the laws of contact that a program may have in place of a scene's, and what it may have forgotten."""
    if features.ROTATION in features.of(scene):
        return
    for row in TABLE["forgotten"]:
        if _stated(scene, row["key"]):
            _, _, entry = row["key"].partition(".")
            yield fixed(f"no-{entry}", f"{row['name']} is forgotten", row["values"])
    if scene.contact.law == "locked":
        yield fixed("contact-opened", "the contact opens, where the scene's is locked", {"contact.law": "unilateral"})
    elif scene.contact.friction is None:
        yield fixed("contact-locked", "the contact pulls, where the scene's opens", {"contact.law": "locked"})
    if scene.contact.friction:
        yield fixed("no-friction", "there is no friction", {"contact.friction": 0.0})
        yield fixed("no-slip", "the contact does not slip", {"contact.friction": math.degrees(math.atan(UNBOUNDED))})
