"""Data of the block that the paper's scenes never change: a short scene for each, and how a solver may misread them.

Every scene comes to rest: its gate is on where it rests, and no slip of the scheme shows in it. A solver that reads a
datum in another way rests where the scene with that datum would, by the same closed form: the misreading is named if
that holds to the gate's band in every scene that it changes.
"""

from __future__ import annotations

import functools
import math
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass
from typing import Any

from validation.gates.gate import Gate
from validation.scenes.scene import Scene, load_scene
from validation.suite.bands import near
from validation.theory import statics
from validation.theory.spectra import rounding

Values = dict[str, Any]
RESTING = "where a damped motion of some hundred steps ends, by the closed form of static equilibrium; rounding"
SAME = "same equations, rounding apart (see the core study)"
NAME = "block-data"  # of the scenes, before the values that each of them changes
ROUNDED = 1e-9  # relative, of a closed form of a few operations
NO_SPRINGS = 1e-6  # over the stiffness of the normal springs: nothing beside the block


@dataclass(frozen=True)
class Datum:
    """A datum of the block, and what a scene has in place of the plain one for it to show."""

    words: str
    values: Values


# Width and height differ, and so do springs and modulus: at p = E the two halves of the displacement are alike.
DATA = (
    Datum("a rectangle that is no square", {"block.width": 3.0, "block.height": 1.2, "contact.stiffness": 4.0e9}),
    Datum("Poisson's ratio", {"block.poisson": 0.25}),
    Datum("plane strain", {"block.poisson": 0.25, "block.hypothesis": "plane strain"}),
    Datum("shear springs of their own stiffness", {"block.poisson": 0.25, "contact.shear_stiffness": 3.0e8}),
    Datum("an off-centre load", {"load.eccentricity": 0.3}),
)


@functools.cache
def plain() -> Scene:
    """Return the paper's square, damped so that it is at rest long before its last step."""
    scene = load_scene("figures-3-4").with_values({"time.step": 0.002, "time.steps": 300, "time.gg": 0.9})
    return scene.model_copy(update={"name": NAME})


@functools.cache
def scenes() -> tuple[Scene, ...]:
    """Return the scene of each datum."""
    return tuple(plain().with_values(datum.values, label=True) for datum in DATA)


@functools.cache
def datum_of() -> dict[str, Datum]:
    """Return the datum of each scene, by the scene's name."""
    return {scene.name: datum for scene, datum in zip(scenes(), DATA, strict=True)}


def displacement_at_rest(scene: Scene) -> float:
    """Return where the centroid rests [m].

    A load whose middle lies beside the centroid presses a shorter part of the top edge. The centroid sinks less by that
    share; turning does not move it.
    """
    pressed = 1 - 2 * abs(scene.load.eccentricity) / statics.size(scene)[0]
    return statics.static_displacement(scene) * pressed


def gates(solver: str) -> Iterator[Gate]:
    """Yield the gates on where each scene rests, and on the steps of the rectangle until it does."""
    for scene in scenes():
        yield Gate(scene.name, (solver,), "displacement.static", *near(displacement_at_rest(scene), ROUNDED), RESTING)
    rectangle = scenes()[0]
    for metric in ("displacement.max", "pressure.max"):
        yield Gate(rectangle.name, (solver, "dda-textbook"), metric, 0, rounding(rectangle), SAME)


# ---- misreadings ----


@dataclass(frozen=True)
class Misreading:
    """A way to misread a scene: the scene for which such a solver takes it."""

    words: str
    values: Callable[[Scene], Values]


def _sides(scene: Scene, width: int, height: int) -> Values:
    """Return the keys of a rectangle whose sides are the scene's width (0) or height (1)."""
    sides = statics.size(scene)
    return {"block.width": sides[width], "block.height": sides[height]}


MISREADINGS = (
    Misreading("width and height are interchanged", lambda s: _sides(s, 1, 0)),
    Misreading("the width is taken for the height", lambda s: _sides(s, 0, 0)),
    Misreading("the height is taken for the width", lambda s: _sides(s, 1, 1)),
    Misreading("block.poisson is not read", lambda s: {"block.poisson": 0.0}),
    Misreading("plane stress is assumed, block.hypothesis is not read", lambda s: {"block.hypothesis": "plane stress"}),
    Misreading("plane strain is assumed, block.hypothesis is not read", lambda s: {"block.hypothesis": "plane strain"}),
    Misreading(
        "contact.shear_stiffness is not read, the shear springs are as stiff as the normal ones",
        lambda s: {"contact.shear_stiffness": s.contact.stiffness},
    ),
    Misreading("there are no shear springs", lambda s: {"contact.shear_stiffness": NO_SPRINGS * s.contact.stiffness}),
    Misreading(
        "load.eccentricity is not read, or the load is moved without being cut off at the edge",
        lambda s: {"load.eccentricity": 0.0},
    ),
)


def misread_displacement(scene: Scene, misreading: Misreading) -> float:
    """Return where the centroid rests in the scene that such a solver takes for this one [m]."""
    return displacement_at_rest(scene.with_values(misreading.values(scene)))


def is_misread(scene: Scene, misreading: Misreading) -> bool:
    """Whether a misreading changes where a scene rests, so that its gates may fail for no other reason."""
    if scene.block.vertices is not None:
        return False
    return not math.isclose(misread_displacement(scene, misreading), displacement_at_rest(scene), rel_tol=ROUNDED)


def misreadings(rests: Mapping[str, tuple[float, float]]) -> dict[Misreading, list[str]]:
    """Return what was misread, with the names of the scenes that show it.

    A misreading changes some of the scenes by more than their bands, and in each of those the solver rests where the
    scene so read would. `rests` is where it rests in each scene [m], and half the width of its gate's band [m].
    """
    named = {}
    by_name = {scene.name: scene for scene in scenes()}
    for misreading in MISREADINGS:
        shows = {}
        for name, (value, half_width) in rests.items():
            expected = misread_displacement(by_name[name], misreading)
            if not math.isclose(expected, displacement_at_rest(by_name[name]), abs_tol=half_width):
                shows[name] = abs(value - expected) <= half_width
        if shows and all(shows.values()):
            named[misreading] = list(shows)
    return named
