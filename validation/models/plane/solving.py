"""Blocks in the plane in the solvers of several kinds, and the memory that they take."""

from __future__ import annotations

from typing import Any

from validation.models.plane.meshed import MovingMesh, refusal_of
from validation.models.plane.tables import PlaneSection
from validation.scenes.scene import Scene
from validation.solvers.contract import Prepared, Solver
from validation.solvers.hooks import SolvingHooks
from validation.solvers.memory import NUMBER, sparse

# s of a case of which a study has dozens, and s more for each second of motion and block, for which the slowest program
# takes some 0.5 s on a core of its own
TIME_LIMIT = 60.0
TIME_FACTOR = 3.0
STATE = 18  # numbers of a moving block at a step: pose, strain and velocity, and as many of its contacts


class HOOKS(SolvingHooks):
    """Blocks by `dda`, the elastic body of the outline of glued ones by elements."""

    def refusal(self, scene: Scene, solver: str) -> str | None:
        """Return what of moving blocks a solver does not take."""
        plane = scene.table(PlaneSection)
        if plane.contact is not None and plane.contact.restitution not in (None, 1.0):
            why = "no coefficient of restitution below 1: its springs give back everything"
            return f"{solver} has {why}, got {plane.contact.restitution:g}"
        return refusal_of(scene, plane) if plane.moves and solver == "fem" else None

    def build(self, scene: Scene, solver: str, full: bool) -> Prepared | None:
        """Return blocks for `dda`, a mesh for `fem`."""
        plane = scene.table(PlaneSection)
        if solver == "dda":
            from validation.models.plane.moving import MovingBlocks
            from validation.solvers.dda import scheme_of as dda_scheme
            from validation.solvers.plane.blocks import PlaneBlocks

            return (PlaneBlocks if plane.is_glued else MovingBlocks)(scene, plane, dda_scheme(scene))
        from validation.solvers.fem import scheme_of
        from validation.solvers.plane.mesh import PlaneMesh

        return (PlaneMesh if plane.is_glued else MovingMesh)(scene, plane, scheme_of(scene))

    def time_limit(self, scene: Scene) -> float | None:
        """Return the time that a user's function may take [s], of blocks that move."""
        plane = scene.table(PlaneSection)
        moving = len(plane.assembly.moving) if plane.moves else 0
        return TIME_LIMIT + TIME_FACTOR * scene.time.duration * moving if moving else None

    def request(self, scene: Scene) -> dict[str, Any]:
        """Return the elastic body of the outline on the mesh of `fem`, as the worker takes it."""
        plane = scene.table(PlaneSection)
        from validation.solvers.plane.mesh import body_of, points_and_cells

        body = body_of(scene, plane)
        points, cells = points_and_cells(body)
        names = ("density", "young", "poisson", "hypothesis", "clamps", "tractions", "stress", "gravity", "degree")
        observe = plane.observed
        return {
            **{name: getattr(body, name) for name in names},
            "points": points,
            "cells": cells,
            "observe": {"place": observe.place, "direction": observe.direction, "less": observe.less},
            "moved": None,
        }

    def memory(self, scene: Scene, solver: Solver) -> tuple[float, str]:
        """Return the bytes of sparse matrices and of states of moving blocks, or of a mesh along the shorter side."""
        plane = scene.table(PlaneSection)
        elements = scene.fem.per_side if solver.meshed else 0
        blocks = len(plane.polygons)
        if not elements:
            unknowns = 12.0 * blocks  # six of a block, and the forces of its joints
            field = "plane.block" if plane.rectangle is None else "plane.subdivide"
            if plane.body is not None:
                field = "plane.plate.cells" if plane.plate else "plane.disc.cells"
            states = float(STATE * NUMBER) * blocks * scene.time.steps if plane.moves else 0.0
            return states + sparse(unknowns), field
        sides = plane.rectangle or (1.0, 1.0)
        cells = elements**2 * max(sides) / min(sides) * len(plane.outline_polygons)
        unknowns = 8.0 * cells
        return sparse(unknowns), "fem.elements"
