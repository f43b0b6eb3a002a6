"""A problem of blocks in the plane: its scene, its cases, and what is measured on answers to them."""

from __future__ import annotations

import functools
from collections.abc import Callable, Iterable, Mapping
from typing import Any, NamedTuple

from validation.models.plane.boxes import boxes_of
from validation.problems.numbered import UNKNOWN, JudgedNumber, around
from validation.runs.beside import table_beside
from validation.runs.history import History
from validation.scenes.scene import Scene, load_scene

PREFIX = "rigid-"  # of the scenes of problems
EITHER_WAY = (1 - UNKNOWN, 1 + UNKNOWN)
FRICTION = "tan(phi), which is not known better,"

TABLE = table_beside(__file__, "problems.toml")
Numbers = Callable[[Scene], tuple[JudgedNumber, ...]]  # what is measured on answers to a scene
Measure = Callable[[History], float | None]


def within(
    name: str, unit: str, exact: float, scale: float, reason: str, measure: Measure, **others: Any
) -> JudgedNumber:
    """Return a number whose band reaches to both sides of its exact value by one per cent of a scale."""
    half = UNKNOWN * scale
    return JudgedNumber(name, unit, exact, exact - half, exact + half, scale, reason, measure, **others)


def at_most(name: str, unit: str, scale: float, reason: str, measure: Measure) -> JudgedNumber:
    """Return a number that is exactly zero, and never negative, to one per cent of a scale."""
    return JudgedNumber(name, unit, 0.0, 0.0, UNKNOWN * scale, scale, reason, measure)


def decided(name: str, is_so: bool, reason: str, measure: Callable[[History], bool]) -> JudgedNumber:
    """Return whether something happens, as 1 or 0."""
    exact = float(is_so)
    return JudgedNumber(name, "1", exact, exact, exact, 1.0, reason, lambda history: float(measure(history)))


def varied(
    name: str, unit: str, value: Callable[[float], float], datum: str, measure: Measure, **others: Any
) -> JudgedNumber:
    """Return a number whose band is what one per cent of a datum makes of its value."""
    exact, *changed = (value(factor) for factor in (1.0, *EITHER_WAY))
    return around(
        name, unit, exact, changed, f"one per cent of {datum} changes it by as much", measure=measure, **others
    )


class PlaneCase(NamedTuple):
    """A case of a problem."""

    label: str  # the values that it differs by from the problem's own scene, in words; empty for that one
    values: Mapping[str, Any] = {}  # as keys of a scene
    quantities: Numbers | None = None  # where they are others than those of the problem's own scene


class PlaneProblem(NamedTuple):
    """A problem of blocks in the plane."""

    name: str  # its scene is `PREFIX` + name
    asks: str
    quantities: Numbers
    cases: tuple[PlaneCase, ...]  # the problem's own scene first
    forces: bool  # whether forces are asked for where a program reports them
    changeable: tuple[str, ...]  # keys of `[plane]` that may be others than in the problem's scene

    def scene(self, case: PlaneCase | None = None) -> Scene:
        """Return the scene of a case; the problem's own by default."""
        label, values, _ = case or PlaneCase("")
        scene = own_scene(self.name).with_values(dict(values))
        if self.forces:
            scene = scene.with_values({"run.columns": list(boxes_of(scene).columns)})
        return scene.model_copy(update={"name": f"{PREFIX}{self.name}{f'[{label}]' if label else ''}"})


@functools.cache
def own_scene(name: str) -> Scene:
    """Return the scene of a problem."""
    return load_scene(PREFIX + name)


def problems_of(
    group: str, numbers: Mapping[str, Numbers], more: Mapping[str, Iterable[PlaneCase]]
) -> dict[str, PlaneProblem]:
    """Return the problems of a group of `problems.toml` by name, with more cases than the table's.

    `numbers` are the functions that say what is measured.
    """
    problems = {}
    for name, stated in TABLE[group].items():
        cases = [PlaneCase(label, values) for label, values in stated.get("cases", {}).items()]
        problems[name] = PlaneProblem(
            name,
            stated["asks"],
            numbers[stated.get("numbers", name)],
            (PlaneCase(""), *cases, *more.get(name, ())),
            stated.get("forces", False),
            stated.get("changeable", ()),
        )
    return problems
