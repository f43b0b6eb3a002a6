"""A meshed column on its contacts as a system of rows (`fem_reference.contact.system`), and where it begins.

The runs of elements between the contacts are meshes of their own, the bodies of the system. What is prescribed are the
four parts of an `Excitation`.
"""

from __future__ import annotations

from collections.abc import Sequence
from functools import partial
from typing import Any

import numpy as np
from scipy.sparse import block_array, csr_array, diags_array
from scipy.sparse.linalg import splu

from fem_reference.column.contact_model import ContactColumn
from fem_reference.column.mesh import LineMesh, line_mesh
from fem_reference.column.problem import Excitation, Ground
from fem_reference.column.stepping import Model, Observation
from fem_reference.contact.iteration import CONVERGED, fall_back, find_contact
from fem_reference.contact.law import AT_LOWER, INSIDE, Law, States, equations_of
from fem_reference.contact.march import ContactState
from fem_reference.contact.stepper import SINGLY_UNIQUE, ContactStepper
from fem_reference.contact.system import ContactRows, ContactSystem, opening_rows, slipping_rows
from fem_reference.problem.problem import Array, Indices, Scheme
from fem_reference.scheme.stage import Motion

TOGETHER = 2
"""Solves for each contact, and three more, in which all states change at once."""
AT_REST = 1e-12
"""Of the fastest contact at t = 0: what the nodes' means leave between two bodies of one velocity."""


def model_of(column: ContactColumn, elements: Sequence[int], degree: int) -> Model:
    """Mesh a column cut at its contacts, without springs; all unknowns are free but those of a prescribed base."""
    ground = column.ground
    cuts = tuple((contact.height, 1.0) for contact in column.contacts if contact.height > 0)
    mesh = line_mesh(Ground(ground.strata, ground.motion, cuts, ground.impedance), elements, degree, springs=False)
    return Model(mesh, ground.impedance, column.unsupported or column.foot_contact)


def system_of(
    column: ContactColumn, model: Model, scheme: Scheme, excitation: Excitation, observed: Observation
) -> ContactSystem:
    """The column on rows that open, or slip at their strength."""
    M, C, K = model.matrices()
    compliance = np.array([1 / contact.stiffness for contact in column.contacts])
    rows = opening_rows(compliance)
    if column.law == "frictional":
        rows = slipping_rows(compliance, np.array([contact.strength for contact in column.contacts]))
    ground = np.zeros((len(compliance), 4))
    ground[0, 0] = column.foot_contact
    parts = excitation.parts

    def prescribed(positions: Array, times: Array) -> Array:
        stages = times.shape[1]
        return np.asarray(parts[np.rint(positions).astype(int)[:, None] * stages + np.arange(1, stages + 1)])

    mesh = model.mesh
    held = int(model.holds_base)
    weight = -column.gravity * (mesh.M @ np.ones(mesh.size))
    B = np.zeros((len(compliance), mesh.size))  # relative displacement of the faces of each contact, less the base's
    above = mesh.parts if column.foot_contact else mesh.parts[1:]
    B[np.arange(len(B)), [run.end(top=False) for run in above]] = 1.0
    inner = np.arange(int(column.foot_contact), len(B))
    B[inner, [run.end(top=True) for run in mesh.parts[:-1]]] = -1.0
    return ContactSystem(
        M=M,
        K=K,
        C=None if model.impedance is None else C,
        F=weight[model.free],
        B=csr_array(B[:, model.free]),
        rows=rows,
        watch=Motion(*observed.motion),
        pushes=model.loads(),
        ground=ground,
        prescribed=prescribed,
        start_parts=parts[0],
        motions=(
            *[np.zeros((run.size - 1, 0)) for run in mesh.parts[:held]],
            *[np.ones((run.size, 1)) for run in mesh.parts[held:]],
        ),
    )


def stepper_of(column: ContactColumn, system: ContactSystem, scheme: Scheme, compiled: Any = None) -> ContactStepper:
    """The scheme on the column; a `ValueError` if a contact is rigid and the scheme explicit."""
    if scheme.explicit and np.any(system.rows.compliance == 0):
        field, value = ("alpha", 0) if scheme.table is None else ("scheme", scheme.name)
        raise ValueError(f"{field}: must be positive where contacts are rigid, got {value}")
    limit = TOGETHER * len(column.contacts) + 3
    single_limit = None
    if column.solve_limit is not None:
        limit = min(limit, column.solve_limit)
        single_limit = column.solve_limit - limit
    return ContactStepper(system, scheme, limit, single_limit, compiled=compiled)


def column_at_start(stepper: ContactStepper, column: ContactColumn, model: Model) -> ContactState:
    """State at t = 0: unstrained with the gaps of the contacts, or at rest under the weight."""
    system = stepper.system
    n = len(column.contacts)
    opens = column.law == "unilateral"
    place = np.array([contact.gap for contact in column.contacts]) if opens else np.zeros(n)
    states = np.full(n, AT_LOWER if opens else INSIDE, dtype=np.int8)
    V = system.unknowns(_velocities(column, model.mesh)[model.free])
    D = np.zeros_like(V)
    force = np.zeros(n)
    if column.settled:
        D, force = _at_rest(system, float(system.start_parts[0]), place)
        place = -force * system.rows.compliance
        states = np.zeros(n, dtype=np.int8)
    touching = np.flatnonzero((system.rows.compliance == 0) & (place == 0))
    pull = partial(_at_once, system, states, touching, V, force)
    return stepper.start(V, place, states, D, force, pull if len(touching) and not column.settled else None)


def _at_once(
    system: ContactSystem, states: States, touching: Indices, V: Array, force: Array, mass: Any, A: Array
) -> tuple[Array, Array]:
    """Acceleration and forces at t = 0 with those of rigid contacts that touch, which come at once.

    A contact that slips already bears its strength against the slip, one whose faces part bears nothing; the others
    keep their faces together.
    """
    rows = system.rows
    speed = system.B @ V - system.ground[:, 0] * system.start_parts[1]
    no_speed = AT_REST * np.max(np.abs(speed))
    leaves = (speed > no_speed) & np.isfinite(rows.lower)  # what never slips cannot move
    returns = (speed < -no_speed) & rows.slips & np.isfinite(rows.upper)
    moving = np.zeros(len(speed), dtype=bool)
    moving[touching] = (leaves | returns)[touching]
    borne = np.where(moving, np.where(leaves, rows.lower, rows.upper), 0.0)
    A = A + mass * (system.B.T @ borne)
    force = force + borne
    touching = touching[~moving[touching]]
    if not len(touching):
        return A, force
    B = system.B[touching] if system.to_modes is not None else system.B[touching].toarray()
    mobility = np.array([mass * row for row in B]).T
    count = len(touching)
    touching_rows = ContactRows._make(part[touching] for part in rows)._replace(partner=np.arange(count))
    law = Law(B @ mobility, *touching_rows, limit=TOGETHER * count + 3, single_limit=SINGLY_UNIQUE * count)
    q = B @ A - system.ground[touching, 0] * system.start_parts[2]
    begun = states[touching]
    equations = equations_of(law, begun, np.ones(count))
    trial, _, _, outcome = find_contact(law, equations, q, np.zeros(count), begun, fall_back)
    together = force.copy()
    if outcome == CONVERGED:
        together[touching] += trial.force
        A = A + mobility @ trial.force
    return A, together


def _velocities(column: ContactColumn, mesh: LineMesh) -> Array:
    """Velocity of each unknown at t = 0: that of its stratum, between two the mean by their masses."""
    V = np.zeros(mesh.size)
    for run in mesh.parts:
        ends = run.basis.mesh.p[0][run.basis.mesh.t]
        stratum = np.searchsorted(column.ground.tops, ends.mean(axis=0))
        dofs = run.basis.element_dofs
        share = np.broadcast_to(run.densities * np.ptp(ends, axis=0), dofs.shape)
        momentum = share * np.asarray(column.velocities)[stratum]
        weights = [np.bincount(dofs.ravel(), part.ravel()) for part in (momentum, share)]
        V[run.first : run.first + run.size] = weights[0] / weights[1]
    return V


def _at_rest(system: ContactSystem, base: float, gap: Array) -> tuple[Array, Array]:
    """Displacements and forces under the weight with all contacts closed: K D - B' N = F,  B D + c N = -gap."""
    K = system.K if system.to_modes is None else diags_array(system.K)
    B = csr_array(system.B)
    scale = float(abs(K.diagonal()).max())  # so that both equations are of one size
    compliance = diags_array(scale**2 * system.rows.compliance)
    matrix = block_array([[K, -scale * B.T], [scale * B, compliance]], format="csc")
    moved = base * system.ground[:, 0] - gap
    solution = splu(matrix).solve(np.concatenate([system.F + base * system.pushes[:, 0], scale * moved]))
    return solution[: len(system.F)], scale * solution[len(system.F) :]
