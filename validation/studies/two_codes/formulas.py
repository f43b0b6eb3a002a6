"""Two finite-element codes of different families on one mesh: scikit-fem and FEniCSx, on one rank and on two."""

from __future__ import annotations

import math
from collections.abc import Iterator

from validation.gates.gate import Gate
from validation.scenes.scene import Scene
from validation.suite.bands import APART, OTHER, cases, gate, near

SQUARES = ("two-codes-constant", "two-codes-average")
POLYGONS = ("quadrilateral", "pentagon")  # on meshes made by Gmsh
SCENES = (*SQUARES, *POLYGONS)
SAME = 1e-10  # of the maximum


def gates() -> tuple[Gate, ...]:
    """Return the gates: both codes give one history, rounding apart, and every code stands in equilibrium."""
    return (*equal(), *equilibrium())


def carried(scene: Scene) -> float:
    """Static contact pressure [Pa]: the vertical load q L on the top, resolved normal to the base, over its length."""
    (x0, y0), (x1, y1) = scene.block.edge(scene.block.top)
    (ax, _), (bx, _) = scene.block.edge(scene.block.base)
    return scene.load.pressure * math.hypot(x1 - x0, y1 - y0) * (bx - ax) / scene.block.base_length**2


def equilibrium() -> Iterator[Gate]:
    """Yield the gates on the static contact pressure of polygons, which no elasticity enters."""
    why = "equilibrium: the springs carry the load's part normal to the base; band: rounding"
    for scene in cases(*POLYGONS):
        value = carried(scene)
        for solver in scene.run.solvers:
            yield gate(scene, solver, "pressure.static", near(value, SAME), why)


def equal() -> Iterator[Gate]:
    """Yield the gates on the histories of the two codes."""
    why = (
        "same mesh, degree, quadrature and scheme: what is left is rounding, some eps times the condition of "
        "M + alpha dt^2 K and the steps"
    )
    for scene in cases(*SCENES):
        for solver in scene.run.solvers:
            if solver.startswith("fenicsx"):
                for metric in ("displacement.max", "pressure.max"):
                    yield gate(scene, (solver, "fem:full"), metric, (APART, SAME), why, OTHER)
