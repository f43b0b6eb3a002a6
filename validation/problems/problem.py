"""A problem: a scene, the question that it asks, and the exact motion that answers it."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from validation.problems import boxes
from validation.problems.truth import Truth, truth_of
from validation.runs.history import Array
from validation.scenes.scene import Scene, load_scene

ROUNDING = 1e-12  # relative, of the last instant
PREFIX = "field-"  # of the scenes of problems


@dataclass(frozen=True)
class Problem:
    """A question to a program.

    Attributes
    ----------
    name
        What tables and submissions call it.
    asks
        What a program has to get right, in a sentence.
    scene
        The scene; its steps are the instants at which the answer is judged, its columns are what is judged.
    truth
        The exact motion.
    """

    name: str
    asks: str
    scene: Scene
    truth: Truth

    @property
    def title(self) -> str:
        """Title of the scene."""
        return self.scene.title or self.name

    @property
    def columns(self) -> tuple[str, ...]:
        """Columns of an answer."""
        return self.scene.run.columns

    @property
    def instants(self) -> Array:
        """Instants at which it is answered [s]: the steps of the scene up to where its exact motion ends."""
        steps = self.scene.time.step * np.arange(1.0, self.scene.time.steps + 1)
        return np.asarray(steps[steps <= self.truth.until * (1 + ROUNDING)])


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
PROBLEMS = tuple(ASKS)  # of blocks and columns; those of rigid boxes are in `validation.problems.boxes`


def scene_name(name: str) -> str:
    """Return the name of a problem's scene."""
    return (boxes.PREFIX if name in boxes.ASKS else PREFIX) + name


def problem(name: str) -> Problem:
    """Return a problem of the suite by name.

    Raises
    ------
    KeyError
        There is none of this name.
    """
    asks = {**ASKS, **boxes.ASKS}[name]
    scene = load_scene(scene_name(name))
    return Problem(name, asks, scene, truth_of(scene))


def problem_of(scene: Scene) -> Problem:
    """Return the problem that any scene poses.

    Raises
    ------
    InputError
        The scene has a sweep, no exact motion is known for it, or nothing is known that could be measured on it.
    """
    if scene.rigid is not None:
        boxes.problem_posed(scene)
    return Problem(scene.name, f"The scene {scene.name}.", scene, truth_of(scene))
