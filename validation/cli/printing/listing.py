"""What ``list WORD`` prints: one line for each metric, study, scene or solver, in columns."""

from __future__ import annotations

from collections.abc import Callable, Sequence

Line = tuple[str, ...]


def metrics() -> list[Line]:
    """Return id, unit, needs and meaning of every metric."""
    from validation.metrics.catalogue import CATALOGUE

    heads = ("metric", "unit", "needs", "meaning")
    return [heads, *((m.id, m.unit, ", ".join(sorted(m.needs)), m.says) for m in CATALOGUE.values())]


def studies() -> list[Line]:
    """Return name, number of scenes and title of every study."""
    from validation.studies.catalogue import STUDIES, get_study

    declared = [get_study(name) for name in STUDIES]
    return [("study", "scenes", "title"), *((s.name, str(len(s.scenes)), s.title) for s in declared)]


def scenes() -> list[Line]:
    """Return name, number of cases, solvers and title of every built-in scene."""
    from validation.scenes.scene import load_scene, scene_names

    known = [load_scene(name) for name in scene_names()]
    heads = ("scene", "cases", "solvers", "title")
    return [heads, *((s.name, str(len(s.expand())), ", ".join(s.run.solvers), s.title or s.name) for s in known)]


def solvers() -> list[Line]:
    """Return name, role, features handled and a description of every solver."""
    from validation.solvers.registry import BUILT_IN, entry_points, get_solver

    heads, lines = ("solver", "role", "handles", "description"), []
    for name in BUILT_IN:
        solver = get_solver(name)
        lines.append((name, str(solver.role), ", ".join(sorted(solver.handles)) or "-", _first_line(solver)))
    return [heads, *lines, *((name, "other", "decides itself", target) for name, target in entry_points().items())]


def _first_line(value: object) -> str:
    return (type(value).__doc__ or "").partition("\n")[0]


LISTS: dict[str, Callable[[], list[Line]]] = {
    "metrics": metrics,
    "studies": studies,
    "scenes": scenes,
    "solvers": solvers,
}


def in_columns(lines: Sequence[Line]) -> str:
    """Return lines with their columns aligned; the last one is as long as it likes."""
    widths = [max(map(len, column)) for column in zip(*lines, strict=True)]
    widths[-1] = 0
    return "\n".join("  ".join(cell.ljust(n) for cell, n in zip(line, widths, strict=True)).rstrip() for line in lines)
