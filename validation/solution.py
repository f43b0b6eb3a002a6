"""What Python's `validation.solve` gives back: a run that knows its scene and its solver, prints shortly and plots."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field, fields
from pathlib import Path
from typing import TYPE_CHECKING

from validation.errors import InputError
from validation.runs import extras
from validation.runs.columns import unit_of
from validation.runs.files import check_ending
from validation.runs.history import DISPLACEMENT
from validation.runs.run import Outcome, Run
from validation.scenes.scene import Scene
from validation.solvers.contract import Solver

if TYPE_CHECKING:
    from validation.report.figures.solution import Figure


@dataclass(frozen=True, repr=False)
class Solution(Run):
    """The run of a scene by a solver.

    Attributes
    ----------
    scene
        The scene that was run.
    solver
        The solver's name.
    """

    scene: Scene = field(kw_only=True)
    solver: str = field(kw_only=True)

    def __repr__(self) -> str:
        """Return solver, scene, steps, the greatest displacement and the seconds of the run in one line."""
        parts = [f"{self.solver} on {self.scene.name}", f"{self.scene.time.steps} steps"]
        if self.outcome is not Outcome.COMPLETED:
            parts.append(str(self.outcome))
        if self.history is not None:
            name = DISPLACEMENT if DISPLACEMENT in self.history.columns else next(iter(self.history.columns))
            values = self.history.columns[name]
            peak = max(map(float, values), key=abs, default=0.0)
            unit = unit_of(name, self.scene.kind.columns)
            parts.append(f"peak {name} {peak:.4g} {unit}".rstrip())
        parts.append(f"{sum(self.seconds.values()):.2g} s")
        return f"<Solution: {', '.join(parts)}>"

    def plot(self, columns: Sequence[str] | None = None, path: str | Path | None = None) -> Figure:
        """Draw columns over time, a panel each, in the style of the report.

        Parameters
        ----------
        columns
            Names of columns of the history; all by default.
        path
            A file .svg, .pdf or .png to write as well.

        Returns
        -------
        Figure
            A figure of matplotlib, which a notebook shows.

        Raises
        ------
        InputError
            The history has no such column, the file's ending is another, or matplotlib is not installed.
        ValueError
            The run has no history.
        """
        history = self._finished()
        names = list(history.columns) if columns is None else list(columns)
        for name in names:
            if name not in history.columns:
                raise InputError(f"must be among {', '.join(history.columns)}", field="columns", value=repr(name))
        target = None if path is None else Path(path)
        check_ending(target, "path")
        extras.require("plot", *extras.FIGURES)
        from validation.report.figures.response import save_as
        from validation.report.figures.solution import solution_figure

        figure = solution_figure(history, names, self.solver, self.scene.kind.columns)
        if target is not None:
            save_as(figure, target)
        return figure


def solve(scene: Scene, solver: str | Solver, full: bool = False) -> Solution:
    """Run one scene with one solver.

    Parameters
    ----------
    scene
        A scene without a sweep; pick a case with `Scene.expand` or `Scene.with_values`.
    solver
        A solver or its name.
    full
        Switch the numerical savings off.

    Returns
    -------
    Solution
        The run, with its history, outcome, work and seconds.

    Raises
    ------
    InputError
        The scene has a sweep, the solver is unknown or refuses the scene.

    Examples
    --------
    >>> from validation import load_scene, solve
    >>> solution = solve(load_scene("figures-3-4").expand()[0], "dda")
    >>> round(float(solution.displacement[-1]), 6)
    -0.01
    """
    from validation.solvers.registry import solve as run_solver

    run = run_solver(scene, solver, full)
    values = {part.name: getattr(run, part.name) for part in fields(Run)}
    return Solution(**values, scene=scene, solver=solver if isinstance(solver, str) else solver.name)
