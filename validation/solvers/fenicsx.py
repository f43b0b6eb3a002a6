"""Adapter of FEniCSx: finds an interpreter that has dolfinx and asks the worker there.

The worker is the folder `fem_reference/fenicsx`; dolfinx is never imported here, nor by anything outside that folder.
"""

from __future__ import annotations

import functools
import importlib.util
import os
import re
import shutil
import subprocess
import sys
import tempfile
from collections.abc import Iterator, Mapping
from dataclasses import fields
from pathlib import Path
from typing import Any

import numpy as np

from validation.errors import InputError
from validation.runs.history import History
from validation.runs.run import Outcome, Run
from validation.scenes import features
from validation.scenes.record import base_record
from validation.scenes.scene import Scene
from validation.solvers.contract import LineStyle, Prepared, Role, Solver
from validation.solvers.fem import (
    MESH_SECTIONS,
    OF_CUTS,
    OF_SUB_BLOCKS,
    locked_frequency,
    missing_reader,
    points_and_cells_of_file,
    problem_of,
)
from validation.solvers.hooks import SolvingHooks
from validation.solvers.processes.worker import ask
from validation.solvers.translation import check_columns, tension_note

VARIABLE = "DDA_VALIDATE_FENICSX_PYTHON"
INSTALL_HINT = (
    "needs FEniCSx (how to get it: apt-get install python3-dolfinx, or conda install -c conda-forge fenics-dolfinx"
)
HAS_DOLFINX = "import importlib.util as u, sys; sys.exit(not all(map(u.find_spec, ('dolfinx', 'petsc4py', 'mpi4py'))))"
COLUMNS = ("displacement", "contact_pressure", "horizontal_displacement")
WORKER = Path(importlib.util.find_spec("fem_reference").origin).with_name("fenicsx")  # type: ignore[union-attr,arg-type]
MOST_RANKS = 256  # processes on one machine
# One thread a rank; more ranks than cores and root in a container are the user's own choice. dolfinx stops at a path
# that is not of the locale's characters, unless Python reads paths as UTF-8.
ENVIRONMENT = {
    "OMP_NUM_THREADS": "1",
    "PYTHONSAFEPATH": "1",
    "PYTHONUTF8": "1",
    "OMPI_ALLOW_RUN_AS_ROOT": "1",
    "OMPI_ALLOW_RUN_AS_ROOT_CONFIRM": "1",
    "OMPI_MCA_rmaps_base_oversubscribe": "1",
    "PRTE_MCA_rmaps_default_mapping_policy": ":oversubscribe",
}


def candidates() -> Iterator[str]:
    """Yield interpreters that may have dolfinx: the one that is named, or this one and those on the PATH.

    Scripts come last: the shims of a manager of versions take ten times as long to start.
    """
    if chosen := os.environ.get(VARIABLE):
        yield chosen
        return
    yield sys.executable
    paths = []
    for directory in os.get_exec_path():
        try:
            names = os.listdir(directory)
        except OSError:  # absent, or another user's
            continue
        for name in sorted(names):
            if re.fullmatch(r"python3(\.\d+)?", name) and (path := shutil.which(name, path=directory)):
                paths.append(path)
    yield from sorted(paths, key=_is_script)


def _is_script(path: str) -> bool:
    try:
        with open(path, "rb") as file:
            return file.read(2) == b"#!"
    except OSError:  # it may be run, but not read
        return False


@functools.cache
def has_dolfinx(python: str) -> bool:
    """Whether an interpreter finds dolfinx, petsc4py and mpi4py."""
    try:
        process = subprocess.run([python, "-c", HAS_DOLFINX], capture_output=True, timeout=60)
    except (OSError, subprocess.SubprocessError):
        return False
    return process.returncode == 0


@functools.cache
def dolfinx_version(python: str) -> str:
    """Return the version of an interpreter's dolfinx, as its package says it."""
    code = "import importlib.metadata as m; print(m.version('fenics-dolfinx'))"
    process = subprocess.run([python, "-c", code], capture_output=True, text=True, timeout=60, check=False)
    return process.stdout.strip() or "unknown"


def interpreter() -> str | None:
    """Return the first interpreter that has dolfinx, or None."""
    return next(filter(has_dolfinx, candidates()), None)


def launcher(python: str) -> str | None:
    """Return the mpirun that belongs to an interpreter: the one beside it, else the one on the PATH."""
    beside = os.pathsep.join([str(Path(python).parent), os.environ.get("PATH", os.defpath)])
    return shutil.which("mpirun", path=beside) or shutil.which("mpiexec", path=beside)


@functools.cache
def _temporary_home() -> tempfile.TemporaryDirectory[str]:
    return tempfile.TemporaryDirectory(prefix="dda-validate-fenicsx-")


def worker_directories() -> dict[str, str]:
    """Return where a worker keeps its files: compiled forms, settings, the launcher's session.

    They are the user's own where dolfinx can write its compiled forms there, else they last as long as this process.
    """
    temporary = {"TMPDIR": tempfile.gettempdir()}  # of TMPDIR and what else there is, the first that can be written
    try:
        forms = Path(os.environ.get("XDG_CACHE_HOME") or Path.home() / ".cache") / "fenics"
        forms.mkdir(parents=True, exist_ok=True)
        if os.access(forms, os.R_OK | os.W_OK | os.X_OK):
            return temporary
    except (OSError, RuntimeError):  # a user without a home is a RuntimeError
        pass
    home = _temporary_home().name
    return temporary | dict.fromkeys(("HOME", "XDG_CACHE_HOME", "XDG_CONFIG_HOME"), home)


class FEniCSx(Solver):
    """The same block by FEniCSx, in another interpreter, on one rank or more."""

    name = "fenicsx"
    handles = features.LOADS | {features.SUB_BLOCKS, features.SLOPE, features.PLANE}
    sections = MESH_SECTIONS
    unread = (*OF_SUB_BLOCKS, *OF_CUTS)
    sources = ("fem_reference.fenicsx",)
    distributed = True
    meshed = True
    saves = False
    role = Role.SECOND_CODE
    rank = 3.0
    line = LineStyle("#56b4e9", (1.0, 1.5), 1.2, 4)
    own_columns = COLUMNS

    def __init__(self) -> None:
        self.ranks = 1

    def option(self, text: str) -> Solver:
        """Return the solver for ``fenicsx:N``, N ranks."""
        if not (text.isdecimal() and len(text) < 9 and 1 <= int(text) <= MOST_RANKS):
            raise InputError(f"fenicsx:N takes 1 to {MOST_RANKS} ranks", field="solver", value=repr(text))
        self.ranks = int(text)
        if self.ranks > 1:
            self.name = f"fenicsx:{self.ranks}"
            self.rank = type(self).rank + 0.5
        return self

    def applicable(self, scene: Scene) -> str | None:
        """Return None, or which springs this solver does not take."""
        if scene.fem.foundation == "nodes":
            return "it takes springs spread over edges or at the corners, and none at nodes"
        return None

    def missing(self, scene: Scene) -> str | None:
        """Return None, or what is not installed and how to get it."""
        return self.missing_program() or missing_reader(scene)

    def missing_program(self) -> str | None:
        """Return None, or which program is not installed."""
        python = interpreter()
        if python is None:
            chosen = os.environ.get(VARIABLE)
            return f"{INSTALL_HINT}; {chosen}, which {VARIABLE} names, has none)" if chosen else f"{INSTALL_HINT})"
        if self.ranks > 1 and launcher(python) is None:
            return f"needs mpirun for {self.ranks} ranks (how to get it: apt-get install openmpi-bin)"
        return None

    def versions(self) -> Mapping[str, str]:
        """Return the version of dolfinx, where it is installed."""
        python = interpreter()
        return {} if python is None else {"dolfinx": dolfinx_version(python)}

    def build(self, scene: Scene, full: bool) -> Prepared:
        """Take the scene; its model is built where dolfinx is."""
        return RemoteMesh(self, scene)

    def command(self) -> list[str]:
        """Return the command that starts the worker."""
        python = interpreter() or sys.executable
        mpi = [launcher(python) or "mpirun", "-n", str(self.ranks)] if self.ranks > 1 else []
        return [*mpi, python, str(WORKER)]


class RemoteMesh(Prepared):
    """A scene on its whole mesh, in a worker; there are no savings."""

    def __init__(self, solver: FEniCSx, scene: Scene) -> None:
        self.solver = solver
        self.scene = scene

    def highest_frequency(self) -> float | None:
        """Return the largest frequency of the same mesh [rad/s]."""
        if (prepared := SolvingHooks.of(self.scene).build(self.scene, "fem", True)) is not None:
            return prepared.highest_frequency()
        return locked_frequency(problem_of(self.scene))

    def history_run(self) -> Run:
        """Run the scene."""
        scene = self.scene
        check_columns(scene, COLUMNS)
        if "refused" in self.answer:
            raise InputError(self.answer["refused"], source=scene.name)
        for word, outcome in (("raised", Outcome.RAISED), ("inapplicable", Outcome.NOT_APPLICABLE)):
            if word in self.answer:
                return Run(outcome, notes=(str(self.answer[word]),))
        return self._run(self.answer)

    def _run(self, answer: Mapping[str, Any]) -> Run:
        columns = {name: np.asarray(values, float) for name, values in answer["columns"].items()}
        history = History(np.asarray(answer["time"], float), columns)
        counters = ("unknowns", "nonzeros", "factorisations", "solves")
        work = {name: int(answer[name]) for name in counters}
        work |= {"steps": len(answer["time"]), "ranks": self.solver.ranks}
        seconds = {part: float(answer[f"{part}_seconds"]) for part in ("setup", "stepping")}
        where = f"dolfinx {answer['version']}, {answer['memory'] / 1e6:.0f} MB at the peak over all ranks"
        return Run(Outcome.COMPLETED, history, work, seconds, (where, *tension_note(history)))

    def static(self) -> Mapping[str, float]:
        """Return the static solution, which the worker gives with every history."""
        return dict(self.answer["static"])

    @functools.cached_property
    def answer(self) -> dict[str, Any]:
        """The worker's answer."""
        return ask(self.solver.command(), os.environ | ENVIRONMENT | worker_directories(), request(self.scene))


def request(scene: Scene) -> dict[str, Any]:
    """Return a scene as the worker takes it; a mesh file becomes points and cells."""
    t = scene.time
    stepping = {
        "alpha": t.alpha,
        "delta": t.delta,
        "gg": t.discount,
        "step": t.step,
        "start": t.start,
        "steps": t.steps,
    }
    if (body := SolvingHooks.of(scene).request(scene)) is not None:
        return stepping | body
    problem = problem_of(scene)
    record = base_record(scene)
    displacement_of_steps = None
    if record is not None:
        instants = t.step * np.arange(t.steps + 1.0)
        displacement_of_steps = np.column_stack(
            [np.interp(instants, record.time, part) for part in (record.x, record.y)]
        ).tolist()
    names = [field.name for field in fields(problem) if field.name not in ("motion", "mesh")]
    return {
        **{name: getattr(problem, name) for name in names},
        "moved": displacement_of_steps,
        "last": (0.0, 0.0) if record is None else (float(record.x[-1]), float(record.y[-1])),
        **stepping,
        "columns": scene.run.columns,
        **(_mesh_of(scene) if problem.mesh else {}),
    }


def _mesh_of(scene: Scene) -> dict[str, Any]:
    """Read points and cells of a mesh file."""
    path = str(scene.fem.mesh)
    try:
        data = points_and_cells_of_file(path)
    except ValueError as error:
        raise InputError(str(error).removeprefix("mesh: "), source=scene.name, field="fem.mesh") from None
    kinds = [kind for kind in ("triangle", "quad") if kind in data.cells_dict]
    if len(kinds) != 1:
        raise InputError(
            "must hold straight triangles or quadrilaterals", source=scene.name, field="fem.mesh", value=kinds
        )
    cells = data.cells_dict[kinds[0]]
    used, local = np.unique(cells, return_inverse=True)
    return {"points": data.points[used, :2].tolist(), "cells": local.reshape(cells.shape).tolist()}
