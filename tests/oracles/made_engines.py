"""A made field of engines: every kind of program and of cell, curves that fall, that stay and that stop."""

from __future__ import annotations

import itertools

from validation.studies.engines.table import EngineCell, EngineTable, Quantity, WorkPoint
from validation.studies.field.table import FAIL, NOT_APPLICABLE, NOT_RUN, PASS, ProblemLine, ProgramLine

PROBLEMS = tuple(
    ProblemLine(name, f"rigid-{name}", f"made {name}", f"What of {name}?")
    for name in ("standing", "restitution", "bouncing", "pile")
)


def program(name: str, title: str, family: str, default: bool = False, **about: str) -> ProgramLine:
    ending = ("-default", ", as it comes", "default") if default else ("", "", "chosen")
    information = {"program": title, "version": "1.5", "model": "impulses", "settings": f"settings of {title}"} | about
    return ProgramLine(name + ending[0], title + ending[1], f"pip install {name}", ending[2], True, information, family)


PROGRAMS = (
    ProgramLine("rigid-exact", "Exact motion", "", "suite", True, {"settings": "none"}, "suite"),
    program("siconos", "Siconos", "mechanics"),
    program("siconos", "Siconos", "mechanics", default=True, settings="its defaults"),
    program("newton-xpbd", "Newton XPBD", "robotics"),
    program("newton-xpbd", "Newton XPBD", "robotics", default=True),
    program("box2d", "Box2D", "games"),
    ProgramLine("drake", "Drake", "pip install drake", "chosen", False, family="robotics"),
)


def curve(first: float, factor: float, price: float, count: int = 4) -> tuple[WorkPoint, ...]:
    """Return a curve whose error is multiplied by a factor at every halving of the step."""
    points = []
    for refine in range(count):
        steps = 100 * 2**refine
        points.append(WorkPoint(refine, 1 / steps, steps, price * 2**refine, first * factor**refine, "completed"))
    return tuple(points)


def creep(value: float) -> Quantity:
    word = FAIL if value > 0.2 else PASS
    return Quantity("creep", "mm/s", "friction 22 deg", value, 0.0, (0.0, 0.2), word, "one per cent of the width")


def gain(value: float) -> Quantity:
    word = FAIL if value > 0.01 else PASS
    return Quantity("largest gain of energy", "1", "", value, 0.0, (0.0, 0.01), word, "one per cent of the height")


def _cells() -> list[EngineCell]:
    falls = "the error falls at each of 3 halvings of the step, order 1.0"
    stays = "the error does not shrink with the step: 240 of its band at first, 240 after 3 halvings"
    no_restitution = {"verdict": NOT_APPLICABLE, "reason": "it has no restitution"}
    return [
        _standing("rigid-exact", 0.0, "", ()),
        _standing("siconos", 0.1, falls, curve(4, 0.5, 0.01)),
        _standing("siconos-default", 48.0, stays, curve(240, 1, 0.005)),
        _standing("newton-xpbd", 6.0, falls, curve(30, 0.5, 0.02)),
        _standing("box2d", 0.0, "no error at any step", curve(0, 1, 0.002)),
        _bouncing("siconos", 0.0),
        _bouncing("newton-xpbd", 0.12),
        _bouncing("siconos-default", 30.0),
        EngineCell("pile", "siconos", PASS, "drift 0 mm", error=0.0, seconds=0.1),
        EngineCell("pile", "newton-xpbd", PASS, "drift 1 mm", error=0.1, seconds=0.1),
        EngineCell("pile", "box2d", NOT_RUN, NOT_RUN, reason="Stopped: no memory"),
        EngineCell("restitution", "newton-xpbd", **no_restitution),
        EngineCell("restitution", "newton-xpbd-default", **no_restitution),
    ]


def _standing(name: str, value: float, finding: str, points: tuple[WorkPoint, ...]) -> EngineCell:
    one = creep(value)
    says = f"creep {value:g} mm/s"
    return EngineCell("standing", name, one.word, says, finding, value / 0.2, 0.5, "", (one,), points)


def _bouncing(name: str, value: float) -> EngineCell:
    one = gain(value)
    return EngineCell("bouncing", name, one.word, f"gain {value:g}", "", value / 0.01, 0.1, "", (one,))


def table() -> EngineTable:
    """Return the field, what is not listed without an answer."""
    cells = {(cell.problem, cell.program): cell for cell in _cells()}
    for problem, one in itertools.product(PROBLEMS, PROGRAMS):
        reason = "was not run" if one.installed else f"not installed: {one.recipe}"
        cells.setdefault((problem.name, one.name), EngineCell(problem.name, one.name, NOT_RUN, NOT_RUN, reason=reason))
    return EngineTable(PROBLEMS, PROGRAMS, cells)
