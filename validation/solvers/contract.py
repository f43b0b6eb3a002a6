"""The contract that every solver fulfils."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path

from validation.errors import InputError
from validation.runs.modes import Mode
from validation.runs.run import Run
from validation.scenes.scene import Scene


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
       column in `scene.run.columns`; numerical failure is an outcome, bad input a `InputError`.
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
        InputError
            The solver takes no option, or not this one.
        """
        raise InputError(f"solver: {self.name} takes no option, got {text!r}")

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
