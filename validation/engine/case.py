"""A case: one scene, one solver, savings on or off; its key covers everything that decides its row."""

from __future__ import annotations

import functools
import hashlib
import importlib.util
import json
from dataclasses import dataclass
from importlib.metadata import PackageNotFoundError, version
from pathlib import Path
from typing import Any

from validation.errors import InputError
from validation.scenes.kinds import MODELS
from validation.scenes.scene import Scene, named_files
from validation.solvers.contract import Solver
from validation.solvers.registry import FULL, get_solver

SOURCES = (  # of this package: what reads a scene, runs it and measures the run
    "validation.errors",
    "validation.runs",
    "validation.scenes",
    "validation.metrics",
    "validation.solvers",
    "validation.engine",
)
LIBRARIES = ("numpy", "scipy", "scikit-fem", "meshio", "python-flint")
MEASURES = ("history", "modes")  # what is measured on a run unless a study asks for more or less


@dataclass(frozen=True)
class Case:
    """One scene (without a sweep) for one solver."""

    scene: Scene
    solver: str
    without_savings: bool = False
    ranks: int = 1  # of the solvers that can be distributed
    measures: tuple[str, ...] = MEASURES  # of "history", "modes", "stability", "energy", "limit"
    repeats: int = 0  # of a timed case, after two runs, one of which counts lines and one warms up
    only: frozenset[str] | None = None  # the metrics that are measured, all that `measures` name where None

    @property
    def full(self) -> bool:
        """Whether the numerical savings are off."""
        return self.without_savings or self.solver.endswith(FULL)

    def make_solver(self) -> Solver:
        """Return the solver, importing its adapter."""
        solver = get_solver(self.solver)
        return solver.option(str(self.ranks)) if self.ranks > 1 and solver.distributed else solver

    def key(self) -> str:
        """Hash of what decides the row: the tables that the solver reads, options, measures, sources, versions."""
        solver = self.make_solver()
        of_kind = f"{MODELS}.{self.scene.kind.name}"
        state = {
            "solver": solver.name,
            "full": self.full,
            "scene": self._read(solver),
            "measures": sorted(self.measures),
            "only": None if self.only is None else sorted(self.only),
            "repeats": self.repeats,
            "sources": {name: source_digest(name) for name in (*solver.sources, *SOURCES, of_kind)},
            "versions": {**library_versions(), **solver.versions()},
        }
        return hashlib.sha256(json.dumps(state, sort_keys=True).encode()).hexdigest()[:24]

    def _read(self, solver: Solver) -> dict[str, Any]:
        """Return the part of the scene that the solver reads, files by their content."""
        data = self.scene.model_dump(mode="json", by_alias=True)
        names = (*solver.sections, *self.scene.kind.tables)
        table_data: dict[str, Any] = {name: dict(data[name]) for name in names if data[name] is not None}
        for section, _, key in (name.partition(".") for name in solver.unread):
            table_data.get(section, {}).pop(key, None)
        table_data["run"] = dict(data["run"], columns=sorted(self.scene.run.columns))
        del table_data["run"]["solvers"]  # which others run decides nothing
        for place, role, table, key in [*named_files(table_data)]:
            table_data[f"{place}.{key}"] = _file_digest(Path(table[key]), role)
        return table_data


def _file_digest(path: Path, role: str) -> str:
    try:
        return hashlib.sha256(path.read_bytes()).hexdigest()
    except OSError as error:
        raise InputError(f"{role} cannot be read: {error.strerror}", source=path) from None


@functools.cache
def source_digest(module: str) -> str:
    """Hash of a module's file, or of all files of a package, without importing it."""
    spec = importlib.util.find_spec(module)
    if spec is not None and spec.submodule_search_locations:
        root = Path(spec.submodule_search_locations[0])
        files = sorted(root.rglob("*.py"))
    elif spec is not None and spec.origin is not None:
        root = Path(spec.origin).parent
        files = [Path(spec.origin)]
    else:
        raise InputError("its source cannot be found, so that its results cannot be kept", source=module)
    digest = hashlib.sha256()
    for file in files:
        digest.update(f"{file.relative_to(root).as_posix()}\0".encode())
        digest.update(hashlib.sha256(file.read_bytes()).digest())
    return digest.hexdigest()


@functools.cache
def library_versions() -> dict[str, str]:
    """Return the versions of the libraries that rows are computed with."""
    versions = {}
    for name in LIBRARIES:
        try:
            versions[name] = version(name)
        except PackageNotFoundError:
            versions[name] = "not installed"
    return versions
