"""The programs of the field: those whose adapters the suite has, those that users bring, and the suite's own."""

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
TABLE: dict[str, Any] = tomllib.loads(Path(__file__).with_suffix(".toml").read_text(encoding="utf-8"))


@dataclass(frozen=True)
class Known:
    """A program whose adapter the suite has; see ``programs.toml``."""

    name: str
    title: str
    recipe: str
    default: bool = True


KNOWN = tuple(Known(**entry) for entry in TABLE["program"])


@dataclass(frozen=True)
class Program:
    """A column of the field.

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
    about
        What it says of itself: program, version, recipe, model, settings.
    """

    name: str
    title: str
    recipe: str = ""
    kind: str = "suite"
    installed: bool = True
    about: Mapping[str, str] = field(default_factory=dict)


def known() -> Iterator[Program]:
    """Yield the programs whose adapters the suite has, installed or not."""
    there = entry_points()
    for program in KNOWN:
        columns = [(program.name, program.title, "chosen")]
        if program.default:
            columns.append((program.name + DEFAULT, f"{program.title}, as it comes", "default"))
        for name, title, kind in columns:
            yield Program(name, title, program.recipe, kind, name in there)


def brought() -> Iterator[Program]:
    """Yield the solvers that other installed packages bring."""
    names = {name for program in KNOWN for name in (program.name, program.name + DEFAULT)}
    for name in entry_points():
        if name not in names:
            yield Program(name, name, kind="user")


def programs() -> tuple[Program, ...]:
    """Return all columns of the field."""
    return (*(Program(**entry) for entry in TABLE["own"]), *known(), *brought())


def installed() -> tuple[str, ...]:
    """Return the names of the solvers that are there beside the suite's own."""
    return tuple(program.name for program in (*known(), *brought()) if program.installed)


def line(program: Program) -> dict[str, Any]:
    """Return fields of a program as plain data, and what it says of itself, asked of its solver."""
    about = dict(program.about)
    if program.installed and program.kind != "suite":
        solver = get_solver(program.name)
        about = solver.about() if isinstance(solver, UserSolver) else {}
    fields = ("name", "title", "recipe", "kind", "installed")
    return {name: getattr(program, name) for name in fields} | {"about": about}
