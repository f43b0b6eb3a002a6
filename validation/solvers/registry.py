"""The registry of solvers, which imports none of them."""

from __future__ import annotations

import functools
import importlib
import importlib.metadata
import os
from collections.abc import Mapping
from typing import Any

import numpy as np

from validation.errors import InputError
from validation.runs.run import Run
from validation.runs.threads import one_thread
from validation.scenes import features
from validation.scenes.kinds import kinds
from validation.scenes.scene import Scene
from validation.solvers import memory
from validation.solvers.contract import Role, Solver
from validation.solvers.soundness import checked

BUILT_IN = {
    "dda": "validation.solvers.dda:DDA",
    "dda-textbook": "validation.solvers.dda:Textbook",
    "fem": "validation.solvers.fem:FiniteElements",
    "fenicsx": "validation.solvers.fenicsx:FEniCSx",
    "bar": "validation.solvers.bar:ExactBar",
    "continuum": "validation.solvers.bar:Continuum",
    "layers": "validation.solvers.columns.layers:ExactLayers",
    "block-events": "validation.solvers.events:BlockEvents",
    "bar-events": "validation.solvers.events:BarEvents",
    "column-events": "validation.solvers.columns.events:ColumnEvents",
    "bars-events": "validation.solvers.columns.bars:BarsEvents",
    **{name: target for kind in kinds().values() for name, target in kind.solvers.items()},
    "dda-60": "validation.solvers.sixty_digits.adapters:PreciseDDA",
}
USERS = "validation.solvers.user:UserSolver"
FILES = "validation.solvers.files:HistoryFiles"
PROGRAM = "validation.solvers.files:Program"
OF_STUDIES = "validation.studies."  # how the name of a solver begins that a study brings in its folder, a class
FULL = ":full"  # a solver's name with this ending runs without numerical savings
GROUP = "dda_validation.solvers"  # entry points of other packages: name = "module:attribute"


@functools.cache
def entry_points() -> Mapping[str, str]:
    """Return the solvers of installed packages, name to ``module:attribute``."""
    points = importlib.metadata.entry_points(group=GROUP)
    return {point.name: point.value for point in sorted(points, key=lambda p: p.name) if point.name not in BUILT_IN}


def solver_names() -> list[str]:
    """Return the names of all solvers: the built-in ones and those of installed packages."""
    return [*BUILT_IN, *entry_points()]


def is_solver(name: str) -> bool:
    """Whether a name is a solver's, with or without an option, or names one as ``module:attribute``."""
    plain, _, attribute = name.removesuffix(FULL).partition(":")
    return plain in BUILT_IN or name in entry_points() or _is_target(plain, attribute) or _is_place(name)


def _is_place(name: str) -> bool:
    """Whether a name is the path of a program, or of a file or a folder of histories."""
    return os.sep in name.rstrip(os.sep) or name.endswith((os.sep, ".csv"))


def _is_target(module: str, attribute: str) -> bool:
    return all(part.isidentifier() for part in (*module.split("."), *attribute.split(".")))


def is_program(name: str) -> bool:
    """Whether a name is the path of a file that can be started."""
    return _is_place(name) and os.path.isfile(name) and os.access(name, os.X_OK) and not name.endswith(".csv")


def get_solver(name: str) -> Solver:
    """Return a solver by name, importing its adapter now.

    ``name:option`` gives a built-in solver an option, ``module:attribute`` names a user's own or a study's,
    ``./program`` a program, ``history.csv`` and ``folder/`` what one has left in files.

    Raises
    ------
    InputError
        There is no such solver, or it does not take the option.
    """
    plain, colon, option = name.removesuffix(FULL).partition(":")
    if plain.startswith(OF_STUDIES):
        brought: Solver = _imported(name)()
        return brought
    if plain not in BUILT_IN and name not in entry_points() and _is_place(name):
        outside: Solver = _imported(PROGRAM if is_program(name) else FILES)(name)
        return outside
    if plain not in BUILT_IN and is_solver(name):
        user: Solver = _imported(USERS)(name, entry_points().get(name, name))
        return user
    if plain not in BUILT_IN:
        others = "module:attribute, ./program, or a file or folder/ of histories"
        rule = f"must be one of {', '.join(solver_names())}, {others}"
        raise InputError(rule, field="solver", value=repr(name))
    solver: Solver = _imported(BUILT_IN[plain])()
    return solver.option(option) if colon else solver


def _imported(target: str) -> Any:
    module, _, attribute = target.partition(":")
    return getattr(importlib.import_module(module), attribute)


def rank(name: str) -> float:
    """Return the place of a solver among the references; its run without savings follows it at once."""
    if not is_solver(name):  # a row that another installation has left
        return Solver.rank
    return get_solver(name).rank + (0.25 if name.endswith(FULL) else 0.0)


def role(name: str) -> Role:
    """Return the role of a solver; a run without savings repeats the one with them."""
    if not is_solver(name):
        return Role.OTHER
    return Role.REPEAT if name.endswith(FULL) else get_solver(name).role


def distributed() -> list[str]:
    """Return the built-in solvers whose option is a number of ranks."""
    return [name for name in BUILT_IN if get_solver(name).distributed]


def by_role(required_role: Role) -> list[str]:
    """Return the built-in solvers of a role, the highest rank first."""
    names = [name for name in BUILT_IN if get_solver(name).role == required_role]
    return sorted(names, key=rank, reverse=True)


def solve(scene: Scene, solver: str | Solver, full: bool = False) -> Run:
    """Run one scene, without a sweep (`Scene.expand`, `Scene.with_values`); `full` switches numerical savings off.

    Raises
    ------
    InputError
        The scene has a sweep, the solver is unknown or refuses the scene.

    Examples
    --------
    >>> from validation import load_scene, solve
    >>> run = solve(load_scene("figures-3-4").expand()[0], "dda")
    >>> round(float(run.displacement[-1]), 6)
    -0.01
    """
    adapter = get_solver(solver) if isinstance(solver, str) else solver
    features.refuse_sweep(scene)
    if reason := adapter.refusal(scene):
        raise InputError(f"solver {adapter.name} does not apply: {reason}", source=scene.name)
    memory.check(scene, adapter)
    with one_thread(), np.errstate(all="ignore"):  # what overflows is named by `checked`, not warned of
        return checked(adapter.solve(scene, full=full), scene)
