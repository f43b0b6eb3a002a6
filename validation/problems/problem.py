"""A problem: a scene, the question that it asks, and what answers are judged by: an exact motion, or exact numbers."""

from __future__ import annotations

import functools
import math
import re
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from validation.models.rigid.tables import POSE
from validation.problems import boxes
from validation.problems.boxes import BoxQuantity
from validation.problems.truth import Truth, truth_of
from validation.runs.columns import unit_of
from validation.runs.history import Array
from validation.runs.units import named
from validation.scenes.scene import Scene, load_scene

ROUNDING = 1e-12  # relative, of the last instant
PREFIX = "field-"  # of the scenes of problems


@dataclass(frozen=True)
class Problem:
    """A question to a program.

    Attributes
    ----------
    name
        What tables and answers call it.
    asks
        What a program has to get right, in a sentence.
    title
        The problem in words.
    scene
        The scene; its steps are the instants at which the answer is judged.
    truth
        The exact motion; None where numbers are judged.
    numbers
        What is measured on an answer of rigid boxes.
    """

    name: str
    asks: str
    title: str
    scene: Scene
    truth: Truth | None
    numbers: tuple[BoxQuantity, ...] = ()

    @property
    def columns(self) -> tuple[str, ...]:
        """Columns that an answer has to hold: those of the scene, of boxes their positions."""
        if self.scene.rigid is None:
            return self.scene.run.columns
        return tuple(f"{part}_{number}" for number in range(1, len(self.scene.rigid.box) + 1) for part in POSE)

    @property
    def further_columns(self) -> tuple[str, ...]:
        """Columns that an answer may hold, by which a number more is judged."""
        return tuple(name for name in self.scene.run.columns if name not in self.columns)

    def unit(self, column: str) -> str:
        """Return the SI unit of a column."""
        return unit_of(column, self.scene.kind.columns)

    def named(self, column: str) -> str:
        """Return a column as tables of answers name it, with its unit; a number of boxes has its own name."""
        return named(column, self.unit(column))

    @property
    def instants(self) -> Array:
        """Instants at which it is answered [s]: the steps of the scene up to where its exact motion ends."""
        steps = self.scene.time.step * np.arange(1.0, self.scene.time.steps + 1)
        until = math.inf if self.truth is None else self.truth.until
        return np.asarray(steps[steps <= until * (1 + ROUNDING)])


ASKS = {
    "locked": "An undamped vibration on springs that push and pull: its frequency, and that nothing damps it.",
    "opening": "The same block on springs that do not pull: when it lifts off, when it lands, and what is left of it.",
    "rebound": "A rigid block that falls on springs: how hard it lands and how high it bounces, twice.",
    "sliding": "A block on a slope steeper than its angle of friction: how far it slides.",
    "creep": "A block that friction could hold, suddenly loaded: how far it shifts while it rings on its springs.",
    "rocking": "A block let go from a large tilt: when it comes down on its base, its rotation not being small.",
    "column": "A wave through a column whose base lets it pass: its shape and its time of arrival.",
    "stack": "Five rigid blocks dropped together: which contact closes when and how hard, and what is thrown up again.",
    "spall": "A pulse that comes back from the free top of a column: which of its bars it tears off, and how fast.",
    "cradle": "An elastic bar that strikes three that touch: what the last one takes away, and what the others keep.",
    "joint": "A shear wave through a joint that slips: what passes, what is sent back, and the slip.",
    "mass-ratio": "A heavy block on one of a thousandth of its mass: the light one rings between stiff contacts.",
}


def _of_scene(name: str) -> Problem:
    scene = load_scene(PREFIX + name)
    return Problem(name, ASKS[name], scene.title or name, scene, truth_of(scene))


def _of_boxes(name: str, posed: boxes.BoxProblem, case: boxes.BoxCase) -> Problem:
    scene = posed.scene(case)
    title = ": ".join(part for part in (scene.title, case.label) if part)
    return Problem(name, boxes.ASKS[posed.name], title, scene, None, (case.quantities or posed.quantities)(scene))


@functools.cache
def _makers() -> dict[str, Callable[[], Problem]]:
    """Return what makes each problem of the pack, by name; a case of rigid boxes has its values in the name."""
    makers: dict[str, Callable[[], Problem]] = {name: functools.partial(_of_scene, name) for name in ASKS}
    for posed in boxes.box_problems().values():
        for case in posed.cases:
            label = re.sub(r"[^a-z0-9.]+", "-", case.label.lower()).strip("-")
            name = "-".join(part for part in (posed.name, label) if part)
            makers[name] = functools.partial(_of_boxes, name, posed, case)
    return makers


@functools.cache
def names() -> tuple[str, ...]:
    """Return the names of all problems of the pack, in its order."""
    return tuple(_makers())


@functools.cache
def problem(name: str) -> Problem:
    """Return a problem of the pack by name.

    Raises
    ------
    KeyError
        There is none of this name.
    """
    return _makers()[name]()


def problem_of(scene: Scene) -> Problem:
    """Return the problem that any scene poses.

    Raises
    ------
    InputError
        The scene has a sweep, no exact motion is known for it, or nothing is known that could be measured on it.
    """
    asks = f"The scene {scene.name}."
    title = scene.title or scene.name
    if scene.rigid is None:
        return Problem(scene.name, asks, title, scene, truth_of(scene))
    return Problem(scene.name, asks, title, scene, None, boxes.problem_posed(scene).quantities(scene))
