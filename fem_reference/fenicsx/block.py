"""The block on its springs: nodes of its mesh, what carries springs and what is loaded."""

from __future__ import annotations

from typing import Any

import dolfinx
import numpy as np
import ufl
from mpi4py import MPI
from petsc4py import PETSc

from .model import COMM, SLACK, Elements, Inapplicable, Request, assembled


def nodes_and_cells(request: Request, corners: np.ndarray, origin: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Points from the start of the base on [m], and cells, their corners counter-clockwise."""
    if request.get("points") is not None:
        return np.asarray(request["points"], float) - origin, np.asarray(request["cells"])
    n = request["elements"]
    up, right = np.indices((n + 1, n + 1)).reshape(2, -1, 1) / n
    a, b, c, d = corners
    points = (1 - up) * ((1 - right) * a + right * b) + up * ((1 - right) * d + right * c)
    first = (np.arange(n) + (n + 1) * np.arange(n)[:, None]).reshape(-1, 1)
    if request["cells"] == "triangles":  # each square cut from its lower left to its upper right corner
        return points, np.vstack([first + np.array([0, 1, n + 2]), first + np.array([0, n + 2, n + 1])])
    return points, first + np.array([0, 1, n + 2, n + 1])


class Block(Elements):
    """The block, its corners from the start of its base on and relative to that [m]."""

    def __init__(self, request: Request) -> None:
        base = request["base"]
        vertices = np.asarray(request["vertices"], float)
        self.corners = np.roll(vertices, -base, axis=0) - vertices[base]
        super().__init__(request, *nodes_and_cells(request, self.corners, vertices[base]))
        x, y = self.corners.T
        cross = x * np.roll(y, -1) - np.roll(x, -1) * y
        area = cross.sum() / 2
        self._check("area", self.dx, area)
        self._check("perimeter", ufl.Measure("ds", domain=self.mesh), sum(self._side(i)[2] for i in range(len(x))))
        self._put_loads((request["top"] - base) % len(x))
        self._put_springs()
        across, down = self.point_rows(np.array([cross @ (z + np.roll(z, -1)) for z in (x, y)]) / (6 * area))
        self.observers |= {"displacement": down, "horizontal_displacement": across}

    def _side(self, index: int) -> tuple[np.ndarray, np.ndarray, float]:
        """Start, unit direction and length of an edge."""
        start = self.corners[index]
        along = self.corners[(index + 1) % len(self.corners)] - start
        length = float(np.hypot(*along))
        return start, along / length, length

    def _part(self, side: int, low: float, high: float) -> np.ndarray:
        """Facets of an edge between two arc lengths."""
        start, along, _ = self._side(side)
        return self.on((start + low * along, start + high * along))

    def _differs(self, measure: Any, expected: float) -> bool:
        form = dolfinx.fem.form(self.constant(1.0) * measure)
        return bool(abs(COMM.allreduce(dolfinx.fem.assemble_scalar(form), MPI.SUM) - expected) > SLACK * expected)

    def _check(self, name: str, measure: Any, expected: float) -> None:
        """Refuse a mesh that is not the block's."""
        if self._differs(measure, expected):
            raise ValueError(f"mesh: outline must be the block's, but its {name} differs")

    def _put_loads(self, side: int) -> None:
        """Load the top, its pressed part as long as it can be about its shifted middle, and the whole block."""
        r = self.request
        _, along, length = self._side(side)
        top = self._part(side, 0.0, length)
        self._check("top", self.over(top), length)
        forward = along[0] > 0 or (along[0] == 0 and along[1] > 0)
        shift = r["eccentricity"] if forward else -r["eccentricity"]
        ends = max(0.0, 2 * shift), min(length, length + 2 * shift)
        pressed = self._part(side, *ends)
        if self._differs(self.over(pressed), ends[1] - ends[0]):
            raise Inapplicable(
                "the pressed part of the top ends inside an element's edge, and fenicsx integrates whole edges only"
            )
        angle = np.radians(r["slope"])
        weight = r["gravity"] * np.array([np.sin(angle), -np.cos(angle)])
        self.F = self.loads(weight, [(top, (r["traction"], 0.0)), (pressed, (0.0, -r["pressure"]))])

    def _put_springs(self) -> None:
        """Put the springs on edges of the base, or at its corners."""
        r = self.request
        _, tangent, length = self._side(0)
        normal = np.array([-tangent[1], tangent[0]])
        spring = r["stiffness"] * np.outer(normal, normal) + r["shear_stiffness"] * np.outer(tangent, tangent)
        w = r["patch_width"]
        spans = [(0.0, length)] if w is None or 2 * w >= length else [(0.0, w), (length - w, length)]
        pressure = r["stiffness"] / length * normal
        vectors = *spring, -pressure
        if r["foundation"] == "corner":
            self.K = assembled(self.elastic())
            corners = [pair for point in self.corners[:2] for pair in self._owned(point)]
            for pair in corners:
                self.K.setValues(pair, pair, spring, addv=PETSc.InsertMode.ADD_VALUES)
            self.K.assemble()
            rows = [self._at(corners, vector) for vector in vectors]
        else:
            carried = sum(high - low for low, high in spans)
            base = self.over(self.joined([self._part(0, *span) for span in spans]))
            if self._differs(base, carried):
                if r["foundation"] == "patch":
                    raise Inapplicable(
                        "the patches end inside an element's edge, and fenicsx integrates whole edges only"
                    )
                raise ValueError("mesh: the base must be covered by edges of elements exactly")
            spread = 2 / carried
            form = ufl.dot(ufl.dot(self.constant(spread * spring), self.u), self.v) * base
            self.K = assembled(self.elastic() + form)
            rows = [self.weighted(spread * vector, base) for vector in vectors]
        self.pushes = rows[:2]
        self.observers = {"contact_pressure": rows[2]}
        self.base_pressure = 2 * pressure

    def _owned(self, point: np.ndarray) -> np.ndarray:
        """Unknowns of the node at a corner, where this rank owns it."""

        def here(x: np.ndarray) -> np.ndarray:
            return np.asarray(np.hypot(x[0] - point[0], x[1] - point[1]) <= self.slack)

        local = dolfinx.fem.locate_dofs_geometrical(self.space, here)
        return self.unknowns_of(local[local < self.space.dofmap.index_map.size_local])

    def _at(self, corners: list[np.ndarray], value: np.ndarray) -> Any:
        """Vector that has a value at the corners of the base."""
        vector = self.M.createVecRight()
        for pair in corners:
            vector.setValues(pair, value, addv=PETSc.InsertMode.ADD_VALUES)
        vector.assemble()
        return vector
