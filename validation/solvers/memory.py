"""Memory that a run will take, estimated before it is taken; a scene that cannot fit is refused with the estimate."""

from __future__ import annotations

import math
from collections.abc import Iterable
from pathlib import Path

from validation.errors import InputError
from validation.scenes.scene import Scene
from validation.solvers.contract import Solver
from validation.solvers.limits_of_memory import available

NUMBER = 8  # bytes
COPIES = 4  # of a history while it is made, observed, checked and kept
UNKNOWN = 3000  # bytes of assembly for each unknown: element matrices, indices, M, K and S
FILL = 150  # bytes of the factor for each unknown and doubling of the mesh
REFUSED = "must fit into memory"  # what a refusal says; it holds for the moment and is not kept
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
            f"{scene.name}: {field}: {REFUSED}, {solver.name} needs about {size / GIGABYTE:.3g} GB and "
            f"{there / GIGABYTE:.3g} GB are there, got {value}"
        )


def refused(notes: Iterable[str]) -> bool:
    """Whether a row was refused for want of memory, which may be there the next time."""
    return any(f": {REFUSED}, " in note for note in notes)
