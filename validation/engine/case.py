"""A case: one scene, one solver, savings on or off; its key."""

from __future__ import annotations

import functools
import hashlib
import importlib.util
import json
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from validation.errors import InputError
from validation.scenes.scene import Scene
from validation.solvers.contract import Solver
from validation.solvers.registry import DISTRIBUTED, get_solver

FULL = ":full"  # a solver's name with this ending runs without numerical savings
JUDGING_SOURCES = (
    "validation.solvers",
    "validation.engine",
    "validation.metrics",
)
MEASURES = ("history", "modes")  # what is measured on a run unless a study asks for more or less


@dataclass(frozen=True)
class Case:
    """One scene (without a sweep) for one solver."""

    scene: Scene
    solver: str
    without_savings: bool = False
    ranks: int = 1  # of the solvers that can be distributed
    measures: tuple[str, ...] = MEASURES  # of "history", "modes", "stability", "energy", "limit"
    repeats: int = 0  # of a timed case, after a run that warms up

    @property
    def full(self) -> bool:
        """Whether the numerical savings are off."""
        return self.without_savings or self.solver.endswith(FULL)

    def make_solver(self) -> Solver:
        """Return the solver, importing its adapter."""
        name = self.solver.removesuffix(FULL)
        return get_solver(f"{name}:{self.ranks}" if self.ranks > 1 and name in DISTRIBUTED else name)

    def key(self) -> str:
        """Hash of what decides the result: the tables that the solver reads, its options, its sources."""
        solver = self.make_solver()
        data = self.scene.model_dump(mode="json")
        read: dict[str, Any] = {section: dict(data[section]) for section in solver.sections}
        for section, _, key in (name.partition(".") for name in solver.unread):
            read[section].pop(key, None)
        read["run"] = sorted(self.scene.run.columns)
        if self.scene.fem.mesh and "fem" in solver.sections:
            read["mesh"] = _file_digest(Path(self.scene.fem.mesh), "mesh file")
        if self.scene.load.base_motion:
            read["base_motion"] = _file_digest(Path(self.scene.load.base_motion), "record of the base's motion")
        state = [
            solver.name,
            self.full,
            read,
            *([] if self.measures == MEASURES else self.measures),
            *(source_digest(name) for name in (*solver.sources, *JUDGING_SOURCES)),
        ]
        return hashlib.sha256(json.dumps(state, sort_keys=True).encode()).hexdigest()[:24]


def _file_digest(path: Path, what: str) -> str:
    try:
        return hashlib.sha256(path.read_bytes()).hexdigest()
    except OSError as error:
        raise InputError(f"{path}: {what} cannot be read: {error.strerror}") from None


@functools.cache
def source_digest(module: str) -> str:
    """Hash of a module's file, or of all files of a package, without importing it."""
    spec = importlib.util.find_spec(module)
    if spec is None or spec.origin is None:
        return ""
    origin = Path(spec.origin)
    files = sorted(origin.parent.rglob("*.py")) if origin.name == "__init__.py" else [origin]
    return hashlib.sha256(b"".join(f.name.encode() + f.read_bytes() for f in files)).hexdigest()
