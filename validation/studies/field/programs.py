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
LMGC90 = "pip install 'examples/peers[lmgc90]' && pip install --no-deps compas_lmgc90==0.1.11"
NEWTON = "pip install 'examples/peers[newton]'"


@dataclass(frozen=True)
class Known:
    """A program whose adapter the suite has.

    Attributes
    ----------
    name, title
        Of the solver, and what people call the program.
    recipe
        How it is installed.
    springs, boxes
        Whether it is asked the problems of blocks on springs, and those of rigid boxes.
    default
        Whether it stands there as it comes as well.
    family
        What it is made for: ``"mechanics"``, ``"robotics"`` or ``"games"``; the curves mark the best of each.
    halvings
        How often its own step is halved for the curves of error over cost: as often as `BUDGET` allows, measured, and
        not below three, since an order is fitted over four steps.
    """

    name: str
    title: str
    recipe: str
    springs: bool = False
    boxes: bool = False
    default: bool = True
    family: str = "mechanics"
    halvings: int = 3


KNOWN = (
    Known("opensees", "OpenSees", "pip install 'examples/peers[opensees]'", springs=True),
    Known(
        "mujoco",
        "MuJoCo",
        "pip install 'examples/peers[mujoco]'",
        springs=True,
        boxes=True,
        family="robotics",
        halvings=4,
    ),
    Known("siconos", "Siconos", f"{APT} python3-siconos", springs=True, boxes=True),
    Known("yade", "Yade", f"{APT} yade", springs=True),
    Known("calculix", "CalculiX", f"{APT} calculix-ccx", springs=True),
    Known("ntdda", "ntdda", "pip install examples/peers; its histories come with it", springs=True, default=False),
    Known("lmgc90", "LMGC90", LMGC90, boxes=True, halvings=4),
    Known("exudyn", "Exudyn", "pip install 'examples/peers[exudyn]'", boxes=True),
    Known("drake", "Drake", "pip install 'examples/peers[drake]'", boxes=True, family="robotics", halvings=3),
    Known("dart", "DART", "pip install 'examples/peers[dart]'", boxes=True, family="robotics", halvings=4),
    Known("bullet", "Bullet", "pip install 'examples/peers[bullet]'", boxes=True, family="robotics"),
    Known("newton-xpbd", "Newton XPBD", NEWTON, boxes=True, family="robotics", halvings=3),
    Known("newton-semi-implicit", "Newton SemiImplicit", NEWTON, boxes=True, family="robotics", halvings=5),
    Known("box2d", "Box2D", "pip install 'examples/peers[box2d]'", boxes=True, family="games", halvings=4),
    Known("pymunk", "pymunk", "pip install 'examples/peers[pymunk]'", boxes=True, family="games", halvings=4),
)
BUDGET = 20.0  # s that the finest run of a curve may take, about, on one core


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
    """Yield the programs of blocks on springs whose adapters the suite has, installed or not."""
    entry_point_names = entry_points()
    for program in KNOWN:
        if not program.springs:
            continue
        yield Program(program.name, program.title, program.recipe, "chosen", program.name in entry_point_names)
        if program.default:
            default_name = program.name + DEFAULT
            title = f"{program.title}, as it comes"
            yield Program(default_name, title, program.recipe, "default", default_name in entry_point_names)


def brought() -> Iterator[Program]:
    """Yield the solvers that other installed packages bring."""
    names = {name for known_program in KNOWN for name in (known_program.name, known_program.name + DEFAULT)}
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
