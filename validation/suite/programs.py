"""The programs of both fields: those whose adapters the suite has, those that users bring, and the suite's own."""

from __future__ import annotations

import tomllib
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from validation.solvers.registry import entry_points, get_solver
from validation.solvers.user import UserSolver

DEFAULT = "-default"  # ending of the name of a program as it comes
# The suite's own
HABIT = "dda"
FINE = "dda-fine"
ELEMENTS = "fem"
SPRINGS = "springs"  # the field of blocks on springs
BOXES = "boxes"  # the field of rigid boxes
TABLE: dict[str, Any] = tomllib.loads(Path(__file__).with_suffix(".toml").read_text(encoding="utf-8"))


@dataclass(frozen=True)
class Known:
    """A program whose adapter the suite has; see ``programs.toml``."""

    name: str
    title: str
    recipe: str
    springs: bool = False
    boxes: bool = False
    default: bool = True
    family: str = "mechanics"  # "mechanics", "robotics" or "games"
    halvings: int = 3


KNOWN = tuple(Known(**entry) for entry in TABLE["program"])


@dataclass(frozen=True)
class Program:
    """A column of a field.

    Attributes
    ----------
    name
        Of the solver; for `FINE`, of the suite's own run at fine steps.
    title
        What people call it.
    recipe
        How it is installed; empty for what is there.
    kind
        ``"suite"``, ``"chosen"`` (parameters chosen for accuracy), ``"default"`` (its own) or ``"user"``.
    installed
        Whether there is a solver of this name.
    family
        ``"suite"``, ``"user"``, or what it is made for.
    halvings
        How often its step is halved for the curves of error over cost; None: it has no curves, since nobody knows
        whether it takes `rigid.refine`, or since it makes no steps.
    about
        What it says of itself: program, version, recipe, model, settings.
    """

    name: str
    title: str
    recipe: str = ""
    kind: str = "suite"
    installed: bool = True
    family: str = "suite"
    halvings: int | None = None
    about: Mapping[str, str] = field(default_factory=dict)


def known(asked: str = SPRINGS) -> Iterator[Program]:
    """Yield the programs of a field whose adapters the suite has, installed or not."""
    there = entry_points()
    for program in KNOWN:
        if not getattr(program, asked):
            continue
        columns = [(program.name, program.title, "chosen")]
        if program.default:
            columns.append((program.name + DEFAULT, f"{program.title}, as it comes", "default"))
        for name, title, kind in columns:
            yield Program(name, title, program.recipe, kind, name in there, program.family, program.halvings)


def brought() -> Iterator[Program]:
    """Yield the solvers that other installed packages bring."""
    names = {name for program in KNOWN for name in (program.name, program.name + DEFAULT)}
    for name in entry_points():
        if name not in names:
            yield Program(name, name, kind="user", family="user")


def programs(asked: str) -> tuple[Program, ...]:
    """Return all columns of a field."""
    return (*(Program(**entry) for entry in TABLE["own"][asked]), *known(asked), *brought())


def installed() -> tuple[str, ...]:
    """Return the names of the solvers of blocks on springs that are there beside the suite's own."""
    return tuple(program.name for program in (*known(), *brought()) if program.installed)


def line(program: Program, *names: str) -> dict[str, Any]:
    """Return fields of a program as plain data, and what it says of itself, asked of its solver."""
    about = dict(program.about)
    if program.installed and program.kind != "suite":
        solver = get_solver(program.name)
        about = solver.about() if isinstance(solver, UserSolver) else {}
    fields = ("name", "title", "recipe", "kind", *names, "installed")
    return {name: getattr(program, name) for name in fields} | {"about": about}
