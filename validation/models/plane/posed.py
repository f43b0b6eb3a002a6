"""A problem of blocks in the plane: its scene, its cases, and what is measured on answers to them."""

from __future__ import annotations

import functools
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from typing import Any

from validation.models.plane.boxes import boxes_of
from validation.problems.numbered import UNKNOWN, JudgedNumber
from validation.scenes.scene import Scene, load_scene

PREFIX = "rigid-"  # of the scenes of problems
EITHER_WAY = (1 - UNKNOWN, 1 + UNKNOWN)


@dataclass(frozen=True)
class PlaneCase:
    """A case of a problem.

    Attributes
    ----------
    label
        The values that it differs by from the problem's own scene, in words; empty for that one.
    values
        The same as keys of a scene.
    quantities
        What is measured on its answers, where it is another question than that of the problem's own scene.
    """

    label: str
    values: Mapping[str, Any] = field(default_factory=dict)
    quantities: Callable[[Scene], tuple[JudgedNumber, ...]] | None = None


@dataclass(frozen=True)
class PlaneProblem:
    """A problem of blocks in the plane.

    Attributes
    ----------
    name
        Of the problem; its scene is `PREFIX` + name.
    quantities
        Function of a scene that returns what is measured on its answers.
    variants
        The cases beside the problem's own scene.
    forces
        Whether forces are asked for where a program reports them.
    changeable
        Keys of `[plane]` that may be others than in the problem's scene, so that the same numbers answer the question.
    """

    name: str
    quantities: Callable[[Scene], tuple[JudgedNumber, ...]]
    variants: tuple[PlaneCase, ...] = ()
    forces: bool = False
    changeable: tuple[str, ...] = ()

    @property
    def cases(self) -> tuple[PlaneCase, ...]:
        """All cases, the problem's own scene first."""
        return (PlaneCase(""), *self.variants)

    def scene(self, case: PlaneCase | None = None) -> Scene:
        """Return the scene of a case; the problem's own by default."""
        stated = own_scene(self.name)
        if case is None or not case.label:
            return self._with_forces(stated)
        changed = stated.with_values(dict(case.values))
        return self._with_forces(changed).model_copy(update={"name": f"{PREFIX}{self.name}[{case.label}]"})

    def _with_forces(self, scene: Scene) -> Scene:
        if not self.forces:
            return scene
        return scene.with_values({"run.columns": list(boxes_of(scene).columns)})


@functools.cache
def own_scene(name: str) -> Scene:
    """Return the scene of a problem."""
    return load_scene(PREFIX + name)
