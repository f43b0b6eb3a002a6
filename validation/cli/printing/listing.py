"""What ``list`` prints: studies, scenes, solvers and metrics in columns, one line each where it fits."""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING

from validation.advice.plain import Line

if TYPE_CHECKING:
    from validation.metrics.catalogue import Metric
    from validation.scenes.scene import Scene
    from validation.suite.declaration import Study

BREAK: Line = ()  # an empty line between two groups


def metrics() -> list[Line]:
    """Return id, unit, needs and meaning of every metric, a group for each first part of the ids."""
    heads = ("metric", "unit", "needs", "meaning")
    return [heads, *_grouped(lambda m: (m.id, m.unit, ", ".join(sorted(m.needs)), m.says))]


def _grouped(line: Callable[[Metric], Line]) -> list[Line]:
    from validation.metrics.catalogue import CATALOGUE

    groups: dict[str, list[Line]] = {}
    for metric in CATALOGUE.values():
        groups.setdefault(metric.id.partition(".")[0], []).append(line(metric))
    lines: list[Line] = []
    for group in groups.values():
        lines += [BREAK, *group]
    return lines[1:]


def studies() -> list[Line]:
    """Return name, number of scenes and title of every study."""
    return [("study", "scenes", "title"), *((s.name, str(len(s.scenes)), s.title) for s in _studies())]


def scenes() -> list[Line]:
    """Return name, number of cases, solvers and title of every built-in scene."""
    heads = ("scene", "cases", "solvers", "title")
    return [heads, *((s.name, str(len(s.expand())), ", ".join(s.run.solvers), _title(s)) for s in _scenes())]


def solvers() -> list[Line]:
    """Return name, role, a description and the features handled of every solver."""
    from validation.solvers.registry import BUILT_IN, entry_points, get_solver

    lines: list[Line] = [("solver", "role", "description", "handles")]
    for name in BUILT_IN:
        solver = get_solver(name)
        description = (type(solver).__doc__ or "").partition("\n")[0]
        lines.append((name, str(solver.role), description, ", ".join(sorted(solver.handles)) or "-"))
    return [*lines, *((name, "other", target, "decides itself") for name, target in entry_points().items())]


def keys() -> list[Line]:
    """Return name, unit, default, range and meaning of every key of a scene, a group for each table."""
    from validation.scenes.keys import default_of, keys_of, range_of
    from validation.scenes.scene import tables_of_scenes

    lines: list[Line] = [("key", "unit", "default", "range", "meaning")]
    for place, table in tables_of_scenes().items():
        described_keys = list(keys_of(table))
        lines += [BREAK] * bool(described_keys)
        for name, field, key in described_keys:
            goes_with = f"; goes with {', '.join(key.needs)}" if key.needs else ""
            lines.append((f"{place}.{name}", key.unit, default_of(field), range_of(field), key.text + goes_with))
    return lines


def schemes() -> list[Line]:
    """Return name, parameters, order, solves a step and description of every time scheme."""
    from validation.theory.schemes import CARDS

    lines: list[Line] = [("scheme", "parameters", "order", "solves", "description")]
    for name, card in CARDS.items():
        description = "good: {good}. bad: {bad}. the same as: {aliases}".format(**card)
        lines += [BREAK, (name, card["parameters"], card["order"], str(card["solves"]), description)]
    return lines


def _studies() -> list[Study]:
    from validation.suite.folders import get_study, study_names

    return [get_study(name) for name in study_names()]


def _scenes() -> list[Scene]:
    from validation.scenes.scene import load_scene, scene_names

    return [load_scene(name) for name in scene_names()]


def _title(scene: Scene) -> str:
    return scene.title or scene.name


LISTS: dict[str, Callable[[], list[Line]]] = {
    "studies": studies,
    "scenes": scenes,
    "solvers": solvers,
    "schemes": schemes,
    "metrics": metrics,
    "keys": keys,
}


def short() -> list[Line]:
    """Return a line for each list: how much it holds, and the names that tell what it is about."""
    from validation.scenes.scene import scene_names
    from validation.suite.folders import study_names

    ends = {"scenes": "-", "metrics": ".", "keys": "."}  # of the first part of such names
    named = {"studies": study_names(), "scenes": scene_names()}  # whose files take seconds to read
    lines: list[Line] = []
    for title, make in LISTS.items():
        names = named.get(title) or [line[0] for line in make()[1:] if line]
        families = dict.fromkeys(name.partition(ends.get(title, " "))[0] for name in names)
        lines.append((title, str(len(names)), ", ".join(families)))
    return lines
