"""Memory that blocks in the plane take."""

from __future__ import annotations

import math

from validation.models.plane.tables import PlaneSection
from validation.scenes.scene import Scene
from validation.solvers.contract import Solver
from validation.solvers.memory import FILL, NUMBER, UNKNOWN, MemoryHooks

STATE = 18  # numbers of a block at a step: pose, strain and velocity, and as many of its contacts
FIELD = "plane.block"


class HOOKS(MemoryHooks):
    """The memory of matrices of blocks and joints, of a mesh, or of all states of moving blocks."""

    def model(self, scene: Scene, solver: Solver) -> tuple[float, str]:
        """Return the bytes of sparse matrices, and of the states that moving blocks keep of every step."""
        plane = scene.table(PlaneSection)
        blocks = len(plane.polygons)
        if not solver.meshed:
            unknowns = 12.0 * blocks  # six of a block, and the forces of its joints
            states = float(STATE * NUMBER) * blocks * scene.time.steps if plane.moves else 0.0
            field = FIELD if plane.rectangle is None else "plane.subdivide"
            return states + unknowns * (UNKNOWN + FILL * math.log2(unknowns)), field
        sides = plane.rectangle or (1.0, 1.0)
        cells = scene.fem.per_side**2 * max(sides) / min(sides) * len(plane.outline_polygons)
        unknowns = 8.0 * cells
        return unknowns * (UNKNOWN + FILL * math.log2(unknowns)), "fem.elements"
