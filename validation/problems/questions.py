"""All problems of the pack by name: those with an exact motion, and each case of the problems of rigid boxes."""

from __future__ import annotations

import functools
import re
from collections.abc import Mapping
from dataclasses import dataclass
from typing import TypeAlias

import numpy as np

from validation.problems.boxes import ASKS, BoxQuantity, box_problems
from validation.problems.problem import PROBLEMS, Problem, problem
from validation.runs.history import Array
from validation.scenes.rigid import POSE
from validation.scenes.scene import Scene


@dataclass(frozen=True, eq=False)
class BoxQuestion:
    """A case of a problem of rigid boxes: its answer is positions, judged by numbers that are measured on them.

    Attributes
    ----------
    name
        What tables and submissions call it: the problem, and the case where it is not the problem's own scene.
    asks
        What a program has to get right, in a sentence.
    title
        The problem in words, and the case.
    scene
        The scene; its steps are the instants of the answer.
    quantities
        What is measured on the positions.
    """

    name: str
    asks: str
    title: str
    scene: Scene
    quantities: tuple[BoxQuantity, ...]

    @property
    def columns(self) -> tuple[str, ...]:
        """Columns of an answer: position and angle of each box."""
        count = len(self.scene.rigid.box) if self.scene.rigid is not None else 0
        return tuple(f"{part}_{number}" for number in range(1, count + 1) for part in POSE)

    @property
    def instants(self) -> Array:
        """Instants at which it is answered [s]."""
        return np.asarray(self.scene.time.step * np.arange(1.0, self.scene.time.steps + 1))


Question: TypeAlias = Problem | BoxQuestion


@functools.cache
def box_questions() -> Mapping[str, BoxQuestion]:
    """Return the cases of the problems of rigid boxes by name."""
    questions = {}
    for box_problem in box_problems().values():
        for case in box_problem.cases:
            scene = box_problem.scene(case)
            label = re.sub(r"[^a-z0-9.]+", "-", case.label.lower())
            name = "-".join(part for part in (box_problem.name, label.strip("-")) if part)
            title = ": ".join(part for part in (scene.title, case.label) if part)
            asked = tuple(
                box_problem
                for box_problem in (case.quantities or box_problem.quantities)(scene)
                if not box_problem.optional
            )
            questions[name] = BoxQuestion(name, ASKS[box_problem.name], title, scene, asked)
    return questions


@functools.cache
def names() -> tuple[str, ...]:
    """Return the names of all problems of the pack, in its order."""
    return (*PROBLEMS, *box_questions())


def question(name: str) -> Question:
    """Return a problem of the pack by name.

    Raises
    ------
    KeyError
        There is none of this name.
    """
    return problem(name) if name in PROBLEMS else box_questions()[name]
