"""Histories of a meshed column whose contacts open or slip."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from time import perf_counter

import numpy as np

from fem_reference.column.contact_model import ContactColumn
from fem_reference.column.contact_system import column_at_start, model_of, stepper_of, system_of
from fem_reference.column.problem import DISPLACEMENT, NEAR, PRESSURE, Excitation
from fem_reference.column.stepping import MEAN_VELOCITY, observed_by
from fem_reference.contact import compilation
from fem_reference.contact.driver import OUTCOMES, histories
from fem_reference.contact.iteration import CONVERGED, NONE, OVERFLOW
from fem_reference.contact.law import States
from fem_reference.contact.march import Record
from fem_reference.problem.checks import require
from fem_reference.problem.problem import Array, Scheme
from fem_reference.problem.result import Result, just_ended

OF_CONTACTS = ("force", "gap", "slip")


@dataclass(frozen=True, kw_only=True)
class ColumnContactResult(Result):
    """Histories of the steps that were reached; element 0 is step 1."""

    step_solves: Array  # solutions of the contacts in each step, the confirming one included [-], shape (steps,)
    states: States  # (contacts, steps)
    openings: Array  # gap y, or slip r [m], (contacts, steps)
    mean_velocity: Array  # of the centre of mass [m/s], (steps,)


def solve_contacts(
    column: ContactColumn,
    elements: Sequence[int],
    degree: int,
    scheme: Scheme,
    excitation: Excitation,
    columns: Sequence[str] = (DISPLACEMENT, PRESSURE),
    heights: Sequence[float] = (),
) -> ColumnContactResult:
    """Step a column of contacts from its starting velocities; what is not named here is as in `solve_line`.

    A numerical failure is an outcome: the history then ends with the last step that was reached.

    Parameters
    ----------
    columns
        ``displacement`` of the top [m], ``contact_pressure``, the force of the base on the column [Pa], and at the
        heights ``displacement_1`` ... [m], ``velocity_1`` ... [m/s], ``stress_1`` ... [Pa, compression positive], and
        where a contact is ``force_1`` ... [Pa, on what is above], ``gap_1`` ... and ``slip_1`` ... [m].
    heights
        Above the base [m]; where two faces meet, the lower one is observed.
    """
    column.ground.check_request(columns, heights, ("displacement", "velocity", "stress", *OF_CONTACTS))
    of_contacts = [_contact_of(column, name, heights) for name in columns]
    began = perf_counter()
    model = model_of(column, elements, degree)
    model.check_scheme(scheme)
    observed = observed_by(model, [*columns, MEAN_VELOCITY], heights)
    stages = len(scheme.stages)
    steps = (len(excitation.pressure) - 1) // stages
    system, compiled, _ = compilation.prepared(system_of(column, model, scheme, excitation, observed), steps)
    stepper = stepper_of(column, system, scheme, compiled)
    with np.errstate(all="ignore"):
        state = column_at_start(stepper, column, model)
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
    opens = column.law == "unilateral"
    openings = record.place if opens else record.slid
    parts = {"force": record.force, "gap": np.maximum(openings, 0.0) * opens, "slip": openings * (not opens)}
    rows_of_steps = record.displacements + record.velocities + record.accelerations
    rows_of_steps += excitation.parts[stages : reached * stages + 1 : stages] @ observed.parts.T
    for number, of_contact in enumerate(of_contacts):
        if of_contact:
            rows_of_steps[:, number] += parts[of_contact[0]][:, of_contact[1]]
        if columns[number] == PRESSURE and model.holds_base:
            rows_of_steps[:, number] += column.gravity * model.mesh.M[[model.mesh.base_node]].sum()
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


def _contact_of(column: ContactColumn, name: str, heights: Sequence[float]) -> tuple[str, int] | None:
    """Part and number of the contact that a column of the history is of, None where it is of the bodies."""
    if name == PRESSURE:
        return ("force", 0) if column.foot_contact else None
    part, _, number = name.rpartition("_")
    if part not in OF_CONTACTS:
        return None
    height = heights[int(number) - 1]
    distances = [abs(contact.height - height) for contact in column.contacts]
    near = min(distances) <= NEAR * column.ground.height
    require(near, "columns", f"must be of a height where a contact is, {name!r} is not", height)
    return part, int(np.argmin(distances))
