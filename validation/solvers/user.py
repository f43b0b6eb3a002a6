"""Adapter of solvers that users bring: ``module:attribute``, or a name of the entry-point group.

A user's solver runs in a process of its own, so that one that hangs, exits or crashes is a row with a name. Of a file
or a program no more is known than of it, see `validation.solvers.files`.
"""

from __future__ import annotations

import importlib.util
import os
import sys
from collections.abc import Mapping
from dataclasses import replace
from importlib.machinery import PathFinder
from pathlib import Path
from time import perf_counter
from typing import Any

import numpy as np

from validation.errors import InputError
from validation.runs.modes import Mode
from validation.runs.run import Outcome, Run
from validation.runs.threads import environment
from validation.scenes import features
from validation.scenes.scene import Scene
from validation.solvers.contract import REPORTABLE, NotReported, Prepared, Solver
from validation.solvers.dda import DDA
from validation.solvers.foreign import one_line, run_of_columns
from validation.solvers.hooks import SolvingHooks
from validation.solvers.processes.worker import WorkerDied, WorkerHangs, ask

TIME_LIMIT = 300.0  # s a case beside the steps
VARIABLE = "DDA_VALIDATE_TIMEOUT"  # sets another
# s a step of the scene: an interpreted loop over a small dense system takes some 0.03 ms, a code that writes a line of
# text some 0.1 ms; on a busy machine ten times that, with as much again in hand.
ALLOWANCE = 5e-3
ABOUT = ("program", "version", "recipe", "model", "settings")  # what a solver may say of itself, each in words
# The first argument is the directory of this package, on the path for the import of `validation` alone: no folder of
# that name beside the solver stands in the way, and no package beside ours hides one of Python.
START = (
    "import sys; sys.path.insert(0, sys.argv[1]); import validation; del sys.path[0]; "
    "from validation.solvers.processes.user_worker import main; main(sys.argv[2], sys.argv[3:])"
)
HOME = Path(__file__).resolve().parents[2]


class Outside(Solver):
    """A solver of which nothing is known but what it answers."""

    # what it is made of and reads cannot be known: it runs afresh, and scenes that differ anywhere are two cases
    sections = ("damping", "fem", "time", "run")
    cached = False

    def __init__(self, name: str) -> None:
        self.name = name

    def unhandled(self, scene: Scene) -> list[str]:
        """Return nothing: who answers knows what it is made for, and says so."""
        return []

    def build(self, scene: Scene, full: bool) -> Prepared:
        """Take the scene; it is read or run when it is asked."""
        return OutsideScene(self, scene)

    def parts(self) -> frozenset[str]:
        """Return nothing: a table holds no static solution and no modes."""
        return frozenset()

    def read(self, scene: Scene) -> Run:
        """Return the history of a scene."""
        raise NotImplementedError


class OutsideScene(Prepared):
    """A scene for such a solver."""

    def __init__(self, solver: Outside, scene: Scene) -> None:
        self.solver = solver
        self.scene = scene

    def history_run(self) -> Run:
        """Return the history."""
        return self.solver.read(self.scene)

    def assumed_static(self) -> Mapping[str, float]:
        """Return the static solution that settling is measured from where none is reported: the block's."""
        return DDA().prepare(self.scene).static()


class UserSolver(Outside):
    """A user's ``solve(scene)``, or an object or class with it and, where it likes, `static` and `modes`."""

    def __init__(self, name: str, target: str) -> None:
        super().__init__(name)
        self.target = target

    def build(self, scene: Scene, full: bool) -> Prepared:
        """Take the scene; the solver sees it when it is run."""
        return UserScene(self, scene)

    def command(self) -> list[str]:
        """Return the command of the process that the solver runs in."""
        return [sys.executable, "-P", "-c", START, str(HOME), self.target, os.getcwd(), *filter(None, sys.path)]

    def parts(self) -> frozenset[str]:
        """Return what the solver can report beside its history; all that one may where it cannot even be imported."""
        return frozenset(self._introduced().get("parts", REPORTABLE))

    def check_module(self) -> None:
        """Refuse by an `InputError` a module that is nowhere where its process looks; nothing is imported for it."""
        first, *inner = self.target.partition(":")[0].split(".")
        spec = PathFinder.find_spec(first, [os.getcwd(), *filter(None, sys.path)])
        if spec is None:
            spec = importlib.util.find_spec(first)  # what an editable install finds by a hook of its own
        for part in inner:
            folders = None if spec is None else spec.submodule_search_locations
            spec = PathFinder.find_spec(part, folders) if folders else None
        if spec is None:
            stated = [os.getcwd(), *filter(None, os.environ.get("PYTHONPATH", "").split(os.pathsep))]
            rule = f"must be a module that Python finds{', without .py' if inner[-1:] == ['py'] else ''}"
            looked_in = f"looked in {', '.join(stated)} and the installed packages"
            raise InputError(rule, field="solver", value=repr(self.name), advice=looked_in)

    def check_loads(self) -> None:
        """Refuse by an `InputError` what is nowhere, or cannot be loaded."""
        self.check_module()
        answer = self._introduced()
        if "raised" in answer:
            reason = one_line(str(answer["raised"]))
            raise InputError(f"cannot be loaded: {reason}", field="solver", value=repr(self.name))

    def about(self) -> dict[str, str]:
        """Return what the solver says of itself under `ABOUT`; nothing where it says nothing or cannot be imported."""
        statements = self._introduced().get("about", {})
        return {name: one_line(str(text)) for name, text in statements.items()}

    def _introduced(self) -> dict[str, Any]:
        """Return what the solver has beside a history and says of itself; one that dies or hangs has "raised" that."""
        request = {"parts": sorted(REPORTABLE), "about": ABOUT}
        try:
            return ask(self.command(), environment(), request, base_limit())
        except (WorkerHangs, WorkerDied) as error:
            return {"raised": str(error)}


class UserScene(OutsideScene):
    """A scene for a user's solver; what it reports beside the history comes with it."""

    solver: UserSolver

    def __init__(self, solver: UserSolver, scene: Scene) -> None:
        super().__init__(solver, scene)
        self._answer: dict[str, Any] = {}

    def history_run(self) -> Run:
        """Run the scene in the solver's own process."""
        start = perf_counter()
        limit = base_limit(self.scene) + ALLOWANCE * self.scene.time.steps
        request = {"scene": self.scene.definition(), "features": features.of(self.scene)}
        try:
            self._answer = ask(self.solver.command(), environment(), request, limit)
        except WorkerHangs:
            note = f"no history within {limit:g} s, the time limit for {self.scene.time.steps} steps"
            return Run(Outcome.TIMEOUT, notes=(note,))
        except WorkerDied as error:
            return Run(Outcome.RAISED, notes=(one_line(f"crashed: {error}"),))
        if "inapplicable" in self._answer:
            return Run(Outcome.NOT_APPLICABLE, notes=(one_line(str(self._answer["inapplicable"])),))
        if "raised" in self._answer:
            place = f" ({one_line(str(self._answer['at']))})" if self._answer.get("at") else ""
            return Run(Outcome.RAISED, notes=(one_line(str(self._answer["raised"])) + place,))
        seconds = {"setup": 0.0, "stepping": perf_counter() - start}
        columns = {name: np.asarray(x, float) for name, x in self._answer["columns"].items()}
        return replace(run_of_columns(self.scene, columns), seconds=seconds)

    def static(self) -> Mapping[str, float]:
        """Return the static solution that the solver reports."""
        if self._answer.get("static") is None:
            raise NotReported(f"{self.solver.name} reports no static solution")
        values = {str(name): float(value) for name, value in dict(self._answer["static"]).items()}
        for name, value in values.items():
            if value != 0 and not sys.float_info.min <= abs(value) <= sys.float_info.max:
                raise InputError(
                    "must be zero or a normal number", field="static", value=f"{value!r} for {one_line(name)}"
                )
        return values

    def modes(self) -> tuple[Mode, ...]:
        """Return the modes that the solver reports."""
        if not self._answer.get("modes"):
            raise NotReported(f"{self.solver.name} reports no modes")
        return tuple(Mode(w, share, (complex(*a), complex(*b))) for w, share, (a, b, *_) in self._answer["modes"])


def base_limit(scene: Scene | None = None) -> float:
    """Return the time limit of a case beside what its steps add [s]."""
    usual = None if scene is None else SolvingHooks.of(scene).time_limit(scene)
    return float(os.environ.get(VARIABLE, TIME_LIMIT if usual is None else usual))
