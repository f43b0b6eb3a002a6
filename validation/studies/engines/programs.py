"""The programs that are asked the problems of rigid boxes: the suite's own, those with adapters, and users' own."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field

from validation.solvers.registry import entry_points, get_solver
from validation.solvers.user import UserSolver
from validation.studies.field.programs import DEFAULT, KNOWN, brought

EXACT = "rigid-exact"
HABIT = "dda"
OWN_HALVINGS = 4  # of DDA's step


@dataclass(frozen=True)
class BoxProgram:
    """A column of the field of engines; see `validation.studies.field.table.ProgramLine`.

    Attributes
    ----------
    halvings
        How often its step is halved for the curves of error over cost; None: it has no curves, since nobody knows
        whether it takes `rigid.refine`, or since it makes no steps.
    """

    name: str
    title: str
    recipe: str
    kind: str
    family: str
    installed: bool
    halvings: int | None
    about: Mapping[str, str] = field(default_factory=dict)


OWN = (
    BoxProgram(
        EXACT,
        "Exact motion",
        "",
        "suite",
        "suite",
        True,
        None,
        {"program": "this suite", "model": "closed forms and exact events", "settings": "none: no step enters"},
    ),
    BoxProgram(
        HABIT,
        "DDA by habit",
        "",
        "suite",
        "suite",
        True,
        OWN_HALVINGS,
        {
            "program": "dda of this suite",
            "model": "blocks of one strain on penalty springs at their corners, p = 1E",
            "settings": "alpha = 1/2, delta = 1, steps of 2 ms, as DDA codes are run by habit",
        },
    ),
)


def box_programs() -> tuple[BoxProgram, ...]:
    """Return all columns."""
    available = entry_points()
    columns = [*OWN]
    for program in KNOWN:
        if not program.boxes:
            continue
        columns.append(
            BoxProgram(
                program.name,
                program.title,
                program.recipe,
                "chosen",
                program.family,
                program.name in available,
                program.halvings,
            )
        )
        if program.default:
            name = program.name + DEFAULT
            title = f"{program.title}, as it comes"
            columns.append(
                BoxProgram(name, title, program.recipe, "default", program.family, name in available, program.halvings)
            )
    for user_program in brought():
        columns.append(BoxProgram(user_program.name, user_program.title, "", "user", "user", True, None))
    return tuple(columns)


def about(program: BoxProgram) -> dict[str, str]:
    """Return what a program says of itself, asked of its solver."""
    if not program.installed or program.kind == "suite":
        return dict(program.about)
    solver = get_solver(program.name)
    return solver.about() if isinstance(solver, UserSolver) else {}
