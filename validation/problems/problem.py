"""A problem: a scene, the question that it asks, and what answers are judged by: an exact motion, or exact numbers."""

from __future__ import annotations

import functools
import math
from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace

import numpy as np

from validation.diagnosis.numbers import Values
from validation.problems.numbered import JudgedNumber
from validation.problems.truth import Truth, truth_of
from validation.runs.columns import unit_of
from validation.runs.history import Array, History
from validation.runs.units import named
from validation.scenes.kinds import Hooks, kinds
from validation.scenes.scene import Scene, load_scene

ROUNDING = 1e-12  # relative, of the last instant
PREFIX = "field-"  # of the scenes of problems


@dataclass(frozen=True)
class Number:
    """A number that a column shows."""

    name: str
    unit: str
    column: str
    of: Callable[[Array, Array], float | None]  # of time [s] and column


@dataclass(frozen=True)
class Problem:
    """A question to a program."""

    name: str  # by which tables and answers call it
    asks: str  # what a program has to get right, in a sentence
    title: str  # the problem in words
    scene: Scene  # whose steps are the instants at which the answer is judged
    truth: Truth | None  # the exact motion; None where numbers are judged
    numbers: tuple[JudgedNumber, ...] = ()  # that are measured on an answer in place of the motion

    @property
    def columns(self) -> tuple[str, ...]:
        """Columns that an answer has to hold: those of the scene, or what its numbers need."""
        return ProblemHooks.of(self.scene).answer_columns(self.scene)

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


class ProblemHooks(Hooks):
    """What an answer to a kind of scene has to hold, and what it is judged by."""

    module = "problems"

    def problems(self) -> Iterator[tuple[str, Callable[[], Problem]]]:
        """Yield name and maker of the problems of the pack that are answered by numbers."""
        yield from ()

    def answer_columns(self, scene: Scene) -> tuple[str, ...]:
        """Return the columns that an answer has to hold."""
        return scene.run.columns

    def judged_numbers(self, scene: Scene) -> tuple[JudgedNumber, ...]:
        """Return the numbers that answers to a scene are judged by; none where the exact motion judges.

        Raises InputError where nothing is known of the scene that could be measured.
        """
        return ()

    def changes(self, scene: Scene) -> dict[str, Values] | None:
        """Return what one per cent of each datum is, by its name; None where bodies and springs tell it."""
        return None

    def shown_numbers(self, scene: Scene) -> Iterator[Number] | None:
        """Return the numbers that a motion is understood by, the first ones first; None of a block."""
        return None

    def other_units(self, scene: Scene, history: History) -> Iterator[tuple[str, str]] | None:
        """Return columns that begin in another unit, each with a sentence; None where the exact motion shows it."""
        return None


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
    return replace(problem_of(load_scene(PREFIX + name)), name=name, asks=ASKS[name])


@functools.cache
def _makers() -> dict[str, Callable[[], Problem]]:
    """Return what makes each problem of the pack, by name; a case that numbers judge has its values in the name."""
    makers: dict[str, Callable[[], Problem]] = {name: functools.partial(_of_scene, name) for name in ASKS}
    for kind in kinds():
        makers.update(ProblemHooks.of_kind(kind).problems())
    return makers


@functools.cache
def names() -> tuple[str, ...]:
    """Return the names of all problems of the pack, in its order."""
    return tuple(_makers())


@functools.cache
def problem(name: str) -> Problem:
    """Return a problem of the pack by name, or raise KeyError."""
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
    numbers = ProblemHooks.of(scene).judged_numbers(scene)
    return Problem(scene.name, asks, title, scene, None if numbers else truth_of(scene), numbers)
