"""Histories of a meshed column whose contacts open or slip."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from time import perf_counter
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from fem_reference.column.contact_model import ContactColumn
from fem_reference.column.contact_system import column_at_start, mesh_of, stepper_of, system_of
from fem_reference.column.mesh import LineMesh
from fem_reference.column.problem import DISPLACEMENT, NEAR, PRESSURE, Excitation
from fem_reference.column.stepping import Model, Observation, observed_by, row_of
from fem_reference.contact import compilation
from fem_reference.contact.driver import OUTCOMES, histories
from fem_reference.contact.iteration import CONVERGED, NONE, OVERFLOW
from fem_reference.contact.march import Record
from fem_reference.problem.problem import Array, Scheme
from fem_reference.problem.result import Result, just_ended

OF_CONTACTS = ("force", "gap", "slip")


@dataclass(frozen=True, kw_only=True)
class ColumnContactResult(Result):
    """Histories of the steps that were reached; element 0 is step 1."""

    step_solves: Array  # solutions of the contacts in each step, the confirming one included [-], shape (steps,)
    states: NDArray[np.int8]  # (contacts, steps)
    openings: Array  # gap y, or slip r [m], (contacts, steps)
    mean_velocity: Array  # of the centre of mass [m/s], (steps,)


class ColumnRow(NamedTuple):
    """A column of the history: what observes the bodies, and what a contact adds."""

    motion: Observation
    contact: int = 0
    of_contact: str = ""  # among `OF_CONTACTS`; nothing if empty


def solve_contacts(
    column: ContactColumn,
    elements: Sequence[int],
    degree: int,
    scheme: Scheme,
    excitation: Excitation,
    columns: Sequence[str] = (DISPLACEMENT, PRESSURE),
    heights: Sequence[float] = (),
) -> ColumnContactResult:
    """Step a column of contacts from its starting velocities.

    A numerical failure is an outcome, not an exception: the history then ends with the last step that was reached.

    Parameters
    ----------
    elements, degree
        Number of elements of each stratum, and their degree.
    excitation
        What drives it at the scheme's `stage_times`: t = 0 and the ends of all stages.
    columns
        ``displacement`` of the top [m], ``contact_pressure``, the force of the base on the column [Pa], and at the
        heights ``displacement_1`` ... [m], ``velocity_1`` ... [m/s], ``stress_1`` ... [Pa, compression positive], and
        where a contact is ``force_1`` ... [Pa, on what is above], ``gap_1`` ... and ``slip_1`` ... [m].
    heights
        Above the base [m]; where two faces meet, the lower one is observed.

    Raises
    ------
    ValueError
        For an unknown column, a height outside, or a mesh that is not possible.
    """
    column.ground.check_heights(heights)
    began = perf_counter()
    mesh, model = mesh_of(column, elements, degree)
    model.check_scheme(scheme)
    rows = [_row(column, mesh, model, name, heights) for name in columns]
    mass = model.M @ np.ones(mesh.size)
    none = np.zeros(mesh.size)
    mean = Observation(none, mass / mass.sum(), none, np.zeros(4))
    observed = observed_by(model, [*(row.motion for row in rows), mean])
    stages = len(scheme.stages)
    steps = (len(excitation.pressure) - 1) // stages
    system = system_of(column, mesh, model, scheme, excitation, observed)
    system, compiled, _ = compilation.prepared(system, steps)
    stepper = stepper_of(column, system, scheme, compiled)
    with np.errstate(all="ignore"):
        state = column_at_start(stepper, column, mesh, model)
    ready = perf_counter()
    kept, marched = histories(stepper, state, steps, None, Record._asdict)
    record = Record(**kept)
    reached = len(record.solves)
    completed = marched.outcome == CONVERGED
    notes: tuple[str, ...] = ()
    if not completed:
        reason = f"the open-close iteration has not ended after {marched.solves} solves"
        if marched.outcome == OVERFLOW:
            reason = "the forces of the contacts are no numbers"
        notes = (f"step {reached + 1}: {reason}",)
    openings = record.place if column.law == "unilateral" else record.slid
    rows_of_steps = record.displacements + record.velocities + record.accelerations
    rows_of_steps += excitation.parts[stages : reached * stages + 1 : stages] @ observed.excitation.T
    for number, row in enumerate(rows):
        if row.of_contact == "force":
            rows_of_steps[:, number] += record.force[:, row.contact]
        elif row.of_contact:
            rows_of_steps[:, number] += (
                np.maximum(openings[:, row.contact], 0.0) if row.of_contact == "gap" else openings[:, row.contact]
            )
        if columns[number] == PRESSURE and model.holds_base:
            rows_of_steps[:, number] += column.gravity * mass[model.base]
    return ColumnContactResult(
        **just_ended(scheme.step, reached, began, ready),
        columns=dict(zip(columns, rows_of_steps.T[:-1], strict=True)),
        unknowns=len(model.free),
        **vars(stepper.work),
        notes=notes,
        outcome=OUTCOMES[CONVERGED if completed else NONE],
        step_solves=record.solves,
        states=record.states.T,
        openings=openings.T,
        mean_velocity=rows_of_steps[:, -1],
    )


def _row(column: ContactColumn, mesh: LineMesh, model: Model, name: str, heights: Sequence[float]) -> ColumnRow:
    """How a column of the history is observed."""
    none = np.zeros(mesh.size)
    nothing = Observation(none, none, none, np.zeros(4))
    if name == PRESSURE and column.foot_contact:
        return ColumnRow(nothing, 0, "force")
    if name == PRESSURE and column.unsupported:
        return ColumnRow(nothing)
    if name in (DISPLACEMENT, PRESSURE):
        return ColumnRow(row_of(mesh, model, name, heights))
    part, _, digits = name.rpartition("_")
    known = part in ("displacement", "velocity", "stress", *OF_CONTACTS)
    if not (known and digits.isdigit() and 1 <= int(digits) <= len(heights)):
        raise ValueError(f"columns: must be of the top, the base or one of {len(heights)} heights, got {name!r}")
    if part not in OF_CONTACTS:
        return ColumnRow(row_of(mesh, model, name, heights))
    height = heights[int(digits) - 1]
    distances = [abs(contact.height - height) for contact in column.contacts]
    nearest = int(np.argmin(distances))
    if distances[nearest] > NEAR * column.ground.height:
        raise ValueError(f"columns: must be of a height where a contact is, got {name!r} at {height!r}")
    opens = column.law == "unilateral"
    is_kept = part == "force" or (part == "gap") == opens
    return ColumnRow(nothing, nearest, part if is_kept else "")
