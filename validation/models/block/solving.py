"""What a run of a block needs and reaches; its models are those of each solver."""

from __future__ import annotations

import math
from pathlib import Path
from typing import Any

import numpy as np

from validation.scenes.record import base_record
from validation.scenes.scene import Scene
from validation.solvers.contract import Solver
from validation.solvers.hooks import SolvingHooks
from validation.solvers.memory import COPIES, NUMBER, sparse
from validation.solvers.soundness import ROUNDING, TINY


class HOOKS(SolvingHooks):
    """Memory and reach of a block."""

    def memory(self, scene: Scene, solver: Solver) -> tuple[float, str]:
        """Return the bytes of assembly and factor of a mesh, or of the dense matrices of sub-blocks."""
        if not solver.meshed:
            return _blocks(scene)
        if scene.fem.mesh is not None:
            try:
                return 200.0 * Path(scene.fem.mesh).stat().st_size, "fem.mesh"
            except OSError:
                return 0.0, "fem.mesh"  # that it cannot be read is said where it is read
        along = float(scene.fem.degree) * scene.fem.per_side + 1
        uniform = scene.block.poisson == 0 and scene.block.vertices is None and scene.fem.foundation == "distributed"
        saves = solver.saves and scene.fem.cells == "quadrilaterals"
        unknowns = 2 * along if saves and uniform and scene.load.centred else 2 * along * along
        return sparse(unknowns), "fem.elements"

    def reach(self, scene: Scene) -> float:
        """Return how far load, velocity and base drive a block [m]."""
        b = scene.block
        c = scene.contact
        q = scene.load
        start, end = b.edge(b.top)
        top = math.dist(start, end)
        mass = max(b.mass, TINY)
        acceleration = (abs(q.pressure) + abs(q.traction)) * top / mass + abs(q.gravity)
        # The surface moves before the mean does: while a wave crosses the block, the bound would be too small.
        travel = math.hypot(*b.extent) * math.sqrt(b.density / b.young)
        time = scene.time.duration + scene.time.step + travel
        base_displacement = _base_motion(scene, time)
        at_start = c.gap + sum(c.band) + ROUNDING * max(b.extent)
        return abs(b.velocity) * time + acceleration * time * time / 2 + base_displacement + at_start

    def scaled(self, scene: Scene, factor: float) -> dict[str, Any]:
        """Return the springs times a factor; the density beside rigid stops."""
        if math.isinf(scene.contact.stiffness):
            return {"block.density": scene.block.density * factor}
        return {"contact.stiffness": scene.contact.stiffness * factor}


def _blocks(scene: Scene) -> tuple[float, str]:
    """Bytes of the dense matrices of sub-blocks."""
    if scene.block.subdivide is None:
        return 0.0, "time.steps"
    along, up = scene.block.subdivide
    unknowns = 6.0 * along * up * (2 if scene.block.pattern == "triangles" else 1)
    return COPIES * NUMBER * unknowns**2, "block.subdivide"


def _base_motion(scene: Scene, time: float) -> float:
    """Return T integral |y''| dt + max |y| of a base whose record is read linearly between its instants [m]."""
    record = base_record(scene)
    if record is None:
        return 0.0
    displacement = np.column_stack([record.x, record.y])
    velocity = np.diff(displacement, axis=0) / np.diff(record.time)[:, None]
    at_rest = np.zeros((1, 2))
    jumps = np.diff(np.concatenate([at_rest, velocity, at_rest]), axis=0)
    changes = float(np.sum(np.hypot(*jumps.T)))
    return time * changes + float(np.max(np.hypot(*displacement.T)))
