"""The numbers of a scene that may be wrong, and the laws that a program may have in place of the scene's.

One table for every kind of scene: what a candidate changes, by which name people know it, and its id. A change is the
keys and values that carry it, so that any solver runs it.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass
from typing import Any

from validation.scenes import features
from validation.scenes.scene import Scene

Values = dict[str, Any]
AVERAGE: Values = {"time.alpha": 0.25, "time.delta": 0.5, "time.start": "consistent"}
MORE_BLOCKS = 4


def springs(scene: Scene, factor: float) -> Values:
    """Return the springs, the shear springs with them where they are stated."""
    c = scene.contact
    stiffness = {"contact.stiffness": c.stiffness * factor}
    return stiffness | ({"contact.shear_stiffness": c.shear_stiffness * factor} if c.shear_stiffness else {})


def friction(scene: Scene, factor: float) -> Values:
    """Return the angle of friction [deg] whose tangent is larger by a factor."""
    tangent = factor * math.tan(math.radians(scene.contact.friction or 0.0))
    return {"contact.friction": math.degrees(math.atan(tangent))}


def layers(key: str) -> Callable[[Scene, float], Values]:
    """Return the function that makes a datum of all layers of a column larger by a factor."""
    return lambda s, f: {"column.layer": [layer | {key: layer[key] * f} for layer in s.definition()["column"]["layer"]]}


def sized(scene: Scene, wider: float, higher: float) -> Values:
    """Return the outline, stretched."""
    if scene.block.vertices is not None:
        return {"block.vertices": [[x * wider, y * higher] for x, y in scene.block.vertices]}
    width, height = scene.block.outline[2]
    return {"block.width": width * wider, "block.height": height * higher}


def accurate(scene: Scene) -> Values:
    """Return a scheme that does not damp and, of a column, more blocks; the step is left to who asks."""
    if scene.column is None:
        return dict(AVERAGE)
    layers_of_scene = scene.definition()["column"]["layer"]
    return AVERAGE | {"column.layer": [one | {"blocks": MORE_BLOCKS * one.get("blocks", 1)} for one in layers_of_scene]}


@dataclass(frozen=True)
class Number:
    """A number of a scene that may be wrong by a factor."""

    id: str
    name: str
    changed: Callable[[Scene, float], dict[str, Any]]  # scene and factor to keys and values


def numbers(scene: Scene) -> Iterator[Number]:
    """Yield the numbers of a scene that may be wrong by a factor, none that is zero or absent."""
    if scene.column is not None:
        yield Number("young-factor", OF_WAVES, layers("young"))
        yield Number("density-factor", "the density", layers("density"))
        yield from _plain(scene, INPUT)
        if scene.column.impedance is not None:
            yield Number("base-factor", "the impedance below the base, density times speed of the waves,", _impedance)
        return
    turns = {"load.gravity": ("gravity-factor", TURNS)} if features.ROTATION in features.of(scene) else {}
    yield from _plain(scene, BLOCK | turns)
    yield Number("width-factor", "the width", lambda s, f: sized(s, f, 1.0))
    yield Number("height-factor", "the height", lambda s, f: sized(s, 1.0, f))
    c = scene.contact
    if math.isfinite(c.stiffness):
        yield Number("springs-factor", "the stiffness of the springs", springs)
        if c.shear_stiffness and c.friction is not None:
            key = "contact.shear_stiffness"
            yield Number("shear-springs-factor", "the shear stiffness of the springs", lambda s, f: {key: c.shear * f})
    if c.friction:
        yield Number("friction-factor", "tan(phi) of friction", friction)


# What gives the same rows has one name, since a program may be wrong in either: a column knows the modulus of its waves
# alone, and a rigid block turns by g m R / I, of which local damping takes a part.
OF_WAVES = "the modulus of the waves, by Young's modulus or Poisson's ratio,"
TURNS = "the moment over the inertia of the block that turns (gravity, size, moment of inertia, damping of its forces)"
BLOCK = {
    "block.density": ("density-factor", "the density"),
    "block.young": ("young-factor", "Young's modulus"),
    "block.velocity": ("velocity-factor", "the initial velocity"),
    "block.tilt": ("tilt-factor", "the initial tilt"),
    "contact.gap": ("gap-factor", "the gap"),
    "load.pressure": ("load-factor", "the pressure"),
    "load.gravity": ("gravity-factor", "gravity"),
    "load.slope": ("slope-factor", "the slope"),
}
INPUT = {
    "input.pressure": ("load-factor", "the pressure"),
    "input.frequency": ("frequency-factor", "the input's frequency"),
    "column.base_stiffness": ("base-springs-factor", "the stiffness of the base"),
}


def _plain(scene: Scene, keys: Mapping[str, tuple[str, str]]) -> Iterator[Number]:
    data = scene.definition()
    for key, (cause, name) in keys.items():
        section, _, entry = key.partition(".")
        value = data.get(section, {}).get(entry)
        if isinstance(value, int | float) and value:
            yield Number(cause, name, lambda s, f, key=key, value=value: {key: value * f})  # type: ignore[misc]


def _impedance(scene: Scene, factor: float) -> dict[str, Any]:
    """Return the keys by which (rho E)^(1/2), or rho c, below the base is larger by a factor."""
    base = scene.definition()["column"]
    return {"column.base_density": base["base_density"] * (factor if "base_speed" in base else factor**2)}


@dataclass(frozen=True)
class Law:
    """Another law of the contact."""

    id: str
    words: str
    values: dict[str, Any]


FORGOTTEN = {
    "load.gravity": ("the weight", {"load.gravity": 0.0, "load.slope": 0.0}),
    "load.traction": ("the traction", {"load.traction": 0.0}),
    "load.eccentricity": ("the eccentricity of the pressure", {"load.eccentricity": 0.0}),
    "contact.gap": ("the gap", {"contact.gap": 0.0}),
    "contact.cohesion": ("the cohesion", {"contact.cohesion": 0.0}),
    "block.poisson": ("Poisson's ratio", {"block.poisson": 0.0}),
}
GLUED = 89.0  # deg: no block slips on such friction


def laws(scene: Scene) -> Iterator[Law]:
    """Yield the laws of contact that a program may have in place of a scene's, and what it may have forgotten."""
    if scene.column is not None or features.ROTATION in features.of(scene):
        return
    data = scene.definition()
    for key, (name, values) in FORGOTTEN.items():
        section, _, entry = key.partition(".")
        if data[section].get(entry):
            yield Law(f"no-{entry}", f"{name} is forgotten", values)
    if scene.contact.law == "locked":
        yield Law("contact-opened", "the contact opens, where the scene's is locked", {"contact.law": "unilateral"})
    elif scene.contact.friction is None:
        yield Law("contact-locked", "the contact pulls, where the scene's opens", {"contact.law": "locked"})
    if scene.contact.friction:
        yield Law("no-friction", "there is no friction", {"contact.friction": 0.0})
        yield Law("no-slip", "the contact does not slip", {"contact.friction": GLUED})
