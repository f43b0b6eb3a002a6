"""The contract of a solver and the registry of solvers, which imports none of them."""

from __future__ import annotations

import functools
import importlib
import importlib.metadata
from collections.abc import Mapping
from pathlib import Path

from validation import memory
from validation.history import Mode, Run
from validation.scene import Scene, SceneError


class NotReported(LookupError):
    """A solver does not offer this part of the contract."""


class Solver:
    """Base of all solvers; a new one is this checklist.

    1. `name`: how the command line and the tables call it.
    2. `sections`: the tables of a scene that it reads, and `unread`: keys in them that it does not; a change
       elsewhere does not make it run again.
    3. `sources`: modules or packages whose files enter the key of its results.
    4. `applicable(scene)`: None, or the reason in words why it cannot run this scene.
    5. `solve(scene, full)`: a `Run` whose history holds one value per step, from the first step on, for every
       column in `scene.run.columns`; numerical failure is an outcome, bad input a `SceneError`.
    6. `columns()`: the columns that it has; a scene's further columns are not asked of it.
    7. Optional: `static(scene)`, `modes(scene)` and `diagnostics(scene)`; `NotReported` where absent.
    """

    name: str = ""
    sections: tuple[str, ...] = ("block", "contact", "load", "time", "run")
    unread: tuple[str, ...] = ()
    sources: tuple[str, ...] = ()
    cached: bool = True  # whether a finished case is kept for the next run

    def option(self, text: str) -> Solver:
        """Return this solver with the option that ``name:option`` gives, such as a number of ranks.

        Raises
        ------
        SceneError
            The solver takes no option, or not this one.
        """
        raise SceneError(f"solver: {self.name} takes no option, got {text!r}")

    def applicable(self, scene: Scene) -> str | None:
        """Return None, or why this solver cannot run the scene."""
        return None

    def solve(self, scene: Scene, full: bool = False, fields: Path | None = None) -> Run:
        """Run the scene; `full` switches the numerical savings off, `fields` names a file for the fields."""
        raise NotImplementedError

    def columns(self) -> tuple[str, ...] | None:
        """Return the columns that this solver has, or None where it takes whatever a scene asks for."""
        return None

    def static(self, scene: Scene) -> Mapping[str, float]:
        """Return the static solution, column name to value."""
        raise NotReported(f"{self.name} reports no static solution")

    def assumed_static(self, scene: Scene) -> Mapping[str, float]:
        """Return the static solution that settling is measured from where `static` is not reported."""
        return {}

    def modes(self, scene: Scene) -> tuple[Mode, ...]:
        """Return the modes, the one with the largest share of the static response first."""
        raise NotReported(f"{self.name} reports no modes")

    def diagnostics(self, scene: Scene) -> Mapping[str, float]:
        """Return spectral radius, condition number and residual."""
        raise NotReported(f"{self.name} reports no diagnostics")


BUILT_IN = {
    "dda": "validation.adapters:DDA",
    "dda-textbook": "validation.adapters:Textbook",
    "fem": "validation.adapters:FiniteElements",
    "fenicsx": "validation.adapters_fenicsx:FEniCSx",
    "bar": "validation.adapters:ExactBar",
    "continuum": "validation.adapters:Continuum",
    "dda-60": "validation.precise:PreciseDDA",
    "fem-60": "validation.precise:PreciseFiniteElements",
    "bar-60": "validation.precise:PreciseBar",
}
DISTRIBUTED = ("fenicsx",)  # solvers whose option is a number of ranks
REFERENCES = ("continuum", "bar", "fem")  # by priority; the continuum where the time error counts as well


GROUP = "dda_validation.solvers"  # entry points of other packages: name = "module:attribute"


@functools.cache
def entry_points() -> Mapping[str, str]:
    """Return the solvers that installed packages bring, name to ``module:attribute``."""
    found = importlib.metadata.entry_points(group=GROUP)
    return {point.name: point.value for point in sorted(found, key=lambda p: p.name) if point.name not in BUILT_IN}


def solver_names() -> list[str]:
    """Return the names of all solvers: the built-in ones and those of installed packages."""
    return [*BUILT_IN, *entry_points()]


def is_solver(name: str) -> bool:
    """Whether a name is a solver's, with or without an option, or names one as ``module:attribute``."""
    plain, _, attribute = name.partition(":")
    return plain in BUILT_IN or name in entry_points() or _is_target(plain, attribute)


def _is_target(module: str, attribute: str) -> bool:
    return all(part.isidentifier() for text in (module, attribute) for part in text.split("."))


def get_solver(name: str) -> Solver:
    """Return a solver by name, importing its adapter now.

    ``name:option`` gives a built-in solver an option, ``module:attribute`` names a user's own.

    Raises
    ------
    SceneError
        There is no such solver, or it does not take the option.
    """
    plain, colon, option = name.partition(":")
    if plain not in BUILT_IN and is_solver(name):
        from validation.adapters_user import UserSolver

        return UserSolver(name, entry_points().get(name, name))
    if plain not in BUILT_IN:
        raise SceneError(f"solver: must be one of {', '.join(solver_names())}, or module:attribute, got {name!r}")
    module, _, attribute = BUILT_IN[plain].partition(":")
    solver: Solver = getattr(importlib.import_module(module), attribute)()
    return solver.option(option) if colon else solver


def solve(scene: Scene, solver: str | Solver, full: bool = False) -> Run:
    """Run one scene with one solver.

    Parameters
    ----------
    scene
        A scene without a sweep; pick a case with `Scene.expand` or `Scene.with_values`.
    solver
        A solver or its name.
    full
        Switch the numerical savings off.

    Raises
    ------
    SceneError
        The scene has a sweep, the solver is unknown or refuses the scene.

    Examples
    --------
    >>> from validation import load_scene, solve
    >>> run = solve(load_scene("figures-3-4").expand()[0], "dda")
    >>> round(float(run.displacement[-1]), 6)
    -0.01
    """
    chosen = get_solver(solver) if isinstance(solver, str) else solver
    if scene.sweep:
        fields = ", ".join(field for field in scene.sweep if field != "mode")
        raise SceneError(f"{scene.name}: sweep: one value must be picked for {fields}; use --set key=value")
    if reason := chosen.applicable(scene):
        raise SceneError(f"{scene.name}: solver {chosen.name} does not apply: {reason}")
    memory.check(scene, chosen.name)
    return chosen.solve(scene, full=full)
