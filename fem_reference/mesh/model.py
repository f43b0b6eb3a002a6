"""The equations M D'' + K D = F of the block, with the savings that are exact.

Each saving leaves the history of the whole block unchanged:

one column of elements
    An upright rectangle with mu = 0 on a distributed foundation under a vertical load moves alike on
    every vertical line. The tensor-product elements restricted to functions that are constant in x
    are line elements of the same degree, so the column holds u(y) and v(y) only.
half the block
    An upright rectangle is symmetric about its vertical middle line; u = 0 there.
unreachable unknowns
    Connected components of the graph of the structural non-zeros of K and M (entries of terms whose
    coefficient is not zero) that the load does not touch stay at rest.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from scipy.sparse import block_diag, csr_array
from scipy.sparse.csgraph import connected_components
from skfem import Basis, ElementLineP1, ElementLineP2, MeshLine
from skfem.models.poisson import laplace
from skfem.models.poisson import mass as line_mass

from fem_reference.mesh import elasticity
from fem_reference.mesh.mesh import TaggedMesh, block_mesh, structured
from fem_reference.problem import digits
from fem_reference.problem.checks import require
from fem_reference.problem.problem import Array, Flags, Problem

CORNER_WARNING = (
    "corner point springs have no fine-mesh limit: the displacement drifts with the logarithm of the "
    'element size; use foundation = "distributed" or "patch"'
)


@dataclass(frozen=True)
class Model:
    """M D'' + K D = F + base_force y for a load of unit size, and what is observed of D."""

    M: csr_array  # consistent mass matrix [kg], shape (unknowns, unknowns)
    K: csr_array  # stiffness matrix with the springs [N/m]
    F: Array  # constant load over the problem's `load_size` [m2], shape (unknowns,)
    base_force: Array  # load of a unit displacement of the base in x and in y [N/m], shape (unknowns, 2)
    base_pressure: Array  # contact pressure of a unit displacement of the base, the block held [Pa/m], shape (2,)
    observers: dict[str, Array]  # row of each column of a history, shape (unknowns,)
    places: Array  # x, y relative to the start of the base [m] and component (0: u, 1: v), shape (3, unknowns)
    kind: str  # ``"whole"``, ``"half"`` or ``"column"``
    notes: tuple[str, ...]  # savings used and warnings, in words

    def rows(self, columns: tuple[str, ...]) -> Array:
        """Rows that observe columns, shape (columns, unknowns)."""
        return np.array([self.observers[name] for name in columns]).reshape(len(columns), len(self.F))


@dataclass(frozen=True)
class Assembled:
    """Matrices of the block in the scikit-fem basis."""

    M: csr_array  # mass [kg]
    K: csr_array  # elastic stiffness without the springs [N/m]
    springs: csr_array  # of the foundation [N/m]
    F: Array  # constant load of the problem [N]
    basis: Basis
    observers: dict[str, Array]  # row of each column of a history


def build(problem: Problem, full: bool = False) -> Model:
    """Assemble the model, with every exact saving unless `full`.

    Raises
    ------
    ValueError
        If the block cannot be meshed.
    """
    if full:
        model = whole_block(problem)
    elif column_applies(problem):
        model = reachable(column(problem))
    elif problem.rectangle is not None and problem.vertical and _tensor(problem) and problem.elements % 2 == 0:
        model = reachable(half_block(problem))
    else:
        model = reachable(whole_block(problem))
    warning = (CORNER_WARNING,) if problem.foundation == "corner" else ()
    return replace(model, notes=model.notes + warning + digits.warnings(problem))


def assemble(problem: Problem) -> Assembled:
    """Assemble the whole block."""
    return _assemble_on(problem, block_mesh(problem))


def _assemble_on(problem: Problem, tagged: TaggedMesh, half: bool = False, congruent: bool = False) -> Assembled:
    basis = elasticity.vector_basis(tagged.mesh, problem.degree)
    rule = elasticity.foundation_rule(problem, basis, tagged.base, half)
    springs, pressure = elasticity.springs(basis, problem, rule)
    u, v, rotation = elasticity.point_values(basis, problem.centroid)
    M = elasticity.mass(basis, problem.density, congruent)
    return Assembled(
        M=M,
        K=elasticity.stiffness(basis, problem, congruent),
        springs=springs,
        F=elasticity.load(basis, problem, tagged.top, M),
        basis=basis,
        observers={
            "displacement": v,
            "contact_pressure": pressure,
            "horizontal_displacement": u,
            "rotation": rotation,
        },
    )


def whole_block(problem: Problem) -> Model:
    """Model of the whole block on its mesh."""
    return _model(problem, assemble(problem.unit), "whole", ())


def column_applies(problem: Problem) -> bool:
    """Whether nothing depends on x: rectangle, structured mesh, mu = 0, distributed foundation, vertical load."""
    uniform = problem.poisson == 0 and problem.foundation == "distributed" and _tensor(problem)
    return uniform and problem.rectangle is not None and problem.vertical


@dataclass(frozen=True)
class ColumnLine:
    """One column of elements as a line of the block's width W."""

    width: float  # W [m]
    mass: csr_array  # rho W (u, v) [kg]
    stretch: csr_array  # W (u', v') [-]
    height: Array  # y of each unknown [m]
    base: Array  # row that gives the value at the base
    top: Array  # at the top
    middle: Array  # at mid-height

    def load(self, problem: Problem) -> Array:
        """Pressure and weight of a problem on v [N]."""
        weight = problem.pull[1] * (self.mass @ np.ones(len(self.height)))
        return np.asarray(-problem.pressure * self.width * self.top + weight)


def line_of(problem: Problem) -> ColumnLine:
    """One column of elements of an upright rectangle; a `ValueError` for another block."""
    width, height = problem.rectangle or (0.0, 0.0)
    require(width > 0, "vertices", "must be an upright rectangle for one column", problem.vertices)
    mesh = MeshLine(height * np.arange(problem.elements + 1) / problem.elements)
    basis = Basis(mesh, (ElementLineP1 if problem.degree == 1 else ElementLineP2)())
    y = basis.doflocs[0]
    return ColumnLine(
        width=width,
        mass=problem.density * width * csr_array(line_mass.assemble(basis)),
        stretch=width * csr_array(laplace.assemble(basis)),
        height=y,
        base=np.eye(1, basis.N, int(np.argmin(np.abs(y))))[0],
        top=np.eye(1, basis.N, int(np.argmin(np.abs(y - height))))[0],
        middle=basis.probes(np.array([[height / 2]])).toarray()[0],
    )


def column(problem: Problem) -> Model:
    """Model of one column of elements: u(y) and v(y) on a line of length h.

    With the width W and line matrices L = (u', v') and B = (u, v), rho W B for the mass, and
    E W L + 2 p b b' for v, G W L + 2 p_s b b' for u, with b the value at the base.
    """
    line = line_of(problem)
    size = len(line.height)
    spring = 2 * problem.stiffness
    at_base = csr_array(np.outer(line.base, line.base))
    # With mu = 0 the modulus of a bar, lam + 2 G, is E.
    K_v = problem.young * line.stretch + spring * at_base
    K_u = problem.shear_modulus * line.stretch + 2 * problem.shear_stiffness * at_base
    none = np.zeros(size)
    moves = np.array([0.0, float(problem.motion is not None)])
    return Model(
        M=csr_array(block_diag((line.mass, line.mass))),
        K=csr_array(block_diag((K_u, K_v))),
        F=np.concatenate([none, line.load(problem.unit)]),
        base_force=spring * np.outer(np.concatenate([none, line.base]), moves),
        base_pressure=spring / line.width * moves,
        observers={
            "displacement": np.concatenate([none, line.middle]),
            "contact_pressure": np.concatenate([none, -spring / line.width * line.base]),
            "horizontal_displacement": np.concatenate([line.middle, none]),
            "rotation": np.zeros(2 * size),
        },
        places=np.array([np.zeros(2 * size), np.tile(line.height, 2), np.repeat([0.0, 1.0], size)]),
        kind="column",
        notes=("one column of elements",),
    )


def _tensor(problem: Problem) -> bool:
    return problem.mesh is None and problem.cells == "quadrilaterals"


def half_block(problem: Problem) -> Model:
    """Model of the half next to the start of the base, with u = 0 on the mirror line."""
    assembled = _assemble_on(problem.unit, structured(problem, half=True), half=True, congruent=True)
    # The other half's springs press as much: the mean over the base counts each half once. Nothing turns the middle.
    doubled = {"contact_pressure": 2 * assembled.observers["contact_pressure"]}
    observers = assembled.observers | doubled | {"rotation": np.zeros(assembled.basis.N)}
    model = _model(problem, replace(assembled, observers=observers), "half", ("half the block",))
    x = model.places[0]
    component = model.places[2]
    mirror = (component == 0) & (x > problem.base_length / 2 * (1 - 1e-9))
    return restrict(model, ~mirror)


def _model(problem: Problem, assembled: Assembled, kind: str, notes: tuple[str, ...]) -> Model:
    motion = problem.motion
    moves = np.array([motion is not None and motion.sideways, motion is not None], float)
    R = elasticity.rigid_motions(assembled.basis)[:, :2] * moves
    pressure = -(assembled.observers["contact_pressure"] @ R)
    K = csr_array(assembled.K + assembled.springs)
    places = np.vstack([assembled.basis.doflocs, elasticity.components(assembled.basis)])
    return Model(assembled.M, K, assembled.F, assembled.springs @ R, pressure, assembled.observers, places, kind, notes)


def restrict(model: Model, keep: Flags) -> Model:
    """The model with the unknowns of `keep` only, the others held at zero."""
    unknowns = np.flatnonzero(keep)
    return replace(
        model,
        M=model.M[unknowns][:, unknowns],
        K=model.K[unknowns][:, unknowns],
        F=model.F[unknowns],
        base_force=model.base_force[unknowns],
        observers={name: row[unknowns] for name, row in model.observers.items()},
        places=model.places[:, unknowns],
    )


def reachable(model: Model) -> Model:
    """The model without the unknowns that the load cannot reach through K and M."""
    pattern = abs(model.K) + abs(model.M)
    count, label = connected_components(pattern, directed=False)
    touched = np.zeros(count, dtype=bool)
    touched[label[(model.F != 0) | np.any(model.base_force != 0, axis=1)]] = True
    keep = touched[label]
    dropped = int(np.count_nonzero(~keep))
    total = len(keep)
    if dropped == 0:
        return model
    note = f"dropped {dropped} of {total} unknowns"
    return replace(restrict(model, keep), notes=(*model.notes, note))
