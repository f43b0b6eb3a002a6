"""The programs of the field: those whose adapters the suite has, those that users bring, and the suite's own."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, field

from validation.solvers.registry import entry_points, get_solver
from validation.solvers.user import UserSolver

DEFAULT = "-default"  # ending of the name of a program as it comes
# The suite's own
HABIT = "dda"
FINE = "dda-fine"
ELEMENTS = "fem"
APT = "pip install examples/peers, and apt install"
RECIPES = {  # name to title and recipe
    "opensees": ("OpenSees", "pip install 'examples/peers[opensees]'"),
    "mujoco": ("MuJoCo", "pip install 'examples/peers[mujoco]'"),
    "siconos": ("Siconos", f"{APT} python3-siconos"),
    "yade": ("Yade", f"{APT} yade"),
    "calculix": ("CalculiX", f"{APT} calculix-ccx"),
    "ntdda": ("ntdda", "pip install examples/peers; its histories come with it"),
}
WITHOUT_DEFAULT = ("ntdda",)


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
    recipe: str
    kind: str
    installed: bool
    about: dict[str, str] = field(default_factory=dict)


OWN = (
    Program(
        HABIT,
        "DDA by habit",
        "",
        "suite",
        True,
        {
            "program": "dda of this suite",
            "model": "one strain a block, springs at its corners",
            "settings": "the scene's own: alpha = 1/2, delta = 1, one step an instant, as DDA codes are run by habit",
        },
    ),
    Program(
        FINE,
        "DDA, fine steps",
        "",
        "suite",
        True,
        {
            "program": "dda of this suite",
            "model": "one strain a block, springs at its corners; a column in four times as many blocks",
            "settings": "average acceleration (alpha = 1/4, delta = 1/2), consistent start, fine steps",
        },
    ),
    Program(
        ELEMENTS,
        "Finite elements",
        "",
        "suite",
        True,
        {
            "program": "fem_reference of this suite",
            "model": "another one: the block strains from point to point; base and springs are those of the block",
            "settings": "quadratic elements; average acceleration, consistent start, the fine steps of DDA beside it",
        },
    ),
)


def known() -> Iterator[Program]:
    """Yield the programs whose adapters the suite has, installed or not."""
    entry_point_names = entry_points()
    for name, (title, recipe) in RECIPES.items():
        yield Program(name, title, recipe, "chosen", name in entry_point_names)
        if name not in WITHOUT_DEFAULT:
            default_name = name + DEFAULT
            yield Program(default_name, f"{title}, as it comes", recipe, "default", default_name in entry_point_names)


def brought() -> Iterator[Program]:
    """Yield the solvers that other installed packages bring."""
    names = {program.name for program in known()}
    for name in entry_points():
        if name not in names:
            yield Program(name, name, "", "user", True)


def programs() -> tuple[Program, ...]:
    """Return all columns of the field."""
    return (*OWN, *known(), *brought())


def installed() -> tuple[str, ...]:
    """Return the names of the solvers that are there beside the suite's own."""
    return tuple(program.name for program in (*known(), *brought()) if program.installed)


def about(program: Program) -> dict[str, str]:
    """Return what a program says of itself, asked of its solver."""
    if not program.installed or program.kind == "suite":
        return dict(program.about)
    solver = get_solver(program.name)
    return solver.about() if isinstance(solver, UserSolver) else {}
