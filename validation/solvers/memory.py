"""Memory that a run will take, estimated before it is taken; a scene that cannot fit is refused with the estimate."""

from __future__ import annotations

import math
import os
from pathlib import Path

from validation.errors import InputError
from validation.scenes.scene import Scene
from validation.solvers.contract import Solver

NUMBER = 8  # bytes
COPIES = 4  # of a history while it is made, observed, checked and kept
UNKNOWN = 3000  # bytes of assembly for each unknown: element matrices, indices, M, K and S
FILL = 150  # bytes of the factor for each unknown and doubling of the mesh
MODES = 6  # of one block, stepped together
GIGABYTE = 1e9


def needed(scene: Scene, solver: Solver) -> tuple[float, str]:
    """Return the bytes that a run will take, and the field that they come from most."""
    steps = float(scene.time.steps) * NUMBER * (COPIES * (len(scene.run.columns) + 1) + MODES)
    model = _mesh(scene, solver) if solver.meshed else _blocks(scene)
    return steps + model[0], "time.steps" if steps > model[0] else model[1]


def _mesh(scene: Scene, solver: Solver) -> tuple[float, str]:
    """Bytes of assembly and factor of the mesh."""
    if scene.fem.mesh is not None:
        try:
            return 200.0 * Path(scene.fem.mesh).stat().st_size, "fem.mesh"
        except OSError:
            return 0.0, "fem.mesh"  # that it cannot be read is said where it is read
    along = float(scene.fem.degree) * scene.fem.per_side + 1
    uniform = scene.block.poisson == 0 and scene.block.vertices is None and scene.fem.foundation == "distributed"
    saves = solver.saves and scene.fem.cells == "quadrilaterals"
    unknowns = 2 * along if saves and uniform and scene.load.centred else 2 * along * along
    return unknowns * (UNKNOWN + FILL * math.log2(unknowns)), "fem.elements"


def _blocks(scene: Scene) -> tuple[float, str]:
    """Bytes of the dense matrices of sub-blocks."""
    if scene.block.subdivide is None:
        return 0.0, "time.steps"
    along, up = scene.block.subdivide
    unknowns = 6.0 * along * up * (2 if scene.block.pattern == "triangles" else 1)
    return COPIES * NUMBER * unknowns**2, "block.subdivide"


def available() -> float:
    """Return the bytes that can be had without swapping; infinite where the system does not say."""
    try:
        lines = Path("/proc/meminfo").read_text(encoding="ascii").splitlines()
        return next(1024.0 * int(line.split()[1]) for line in lines if line.startswith("MemAvailable"))
    except (OSError, StopIteration, ValueError):
        pass
    try:
        return float(os.sysconf("SC_PAGE_SIZE")) * os.sysconf("SC_PHYS_PAGES")
    except (AttributeError, OSError, ValueError):
        return math.inf


def check(scene: Scene, solver: Solver) -> None:
    """Refuse a scene whose run cannot fit.

    Raises
    ------
    InputError
        With the field, the estimate and what is there.
    """
    size, field = needed(scene, solver)
    there = available()
    if size > there:
        section, _, key = field.partition(".")
        value = getattr(getattr(scene, section), key)
        raise InputError(
            f"{scene.name}: {field}: must fit into memory, {solver.name} needs about {size / GIGABYTE:.3g} GB and "
            f"{there / GIGABYTE:.3g} GB are there, got {value}"
        )
