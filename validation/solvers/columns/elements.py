"""Adapter of the columns of `fem_reference`: line elements."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np

from fem_reference.column.problem import Excitation, Ground, Stratum
from fem_reference.problem.problem import Array, Scheme
from validation.runs.contact import ContactRecord
from validation.runs.history import DISPLACEMENT, PRESSURE, Complex
from validation.runs.modes import Switch
from validation.runs.run import Run
from validation.scenes.drive import motion_at
from validation.scenes.scene import Scene
from validation.solvers import opened
from validation.solvers.columns.names import amplitude, column_of
from validation.solvers.contract import NotReported, Prepared, completed
from validation.solvers.translation import naming, switches_between_steps, to_run

if TYPE_CHECKING:
    from fem_reference.column.contact_model import ContactColumn
    from fem_reference.column.contacts import ColumnContactResult


def ground_of(scene: Scene) -> Ground:
    """Return the layered column of a scene; how its blocks are glued is no part of it."""
    c = column_of(scene)
    strata = tuple(Stratum(x.thickness, x.density, x.young, x.poisson) for x in c.layer)
    joints = tuple((joint.height, joint.stiffness) for joint in c.springs)
    with naming(scene):
        return Ground(strata, c.motion, joints, c.impedance)


def contact_column_of(scene: Scene) -> ContactColumn:
    """Return the column of a scene whose contacts open or slip."""
    from fem_reference.column.contact_model import ColumnContact, ContactColumn

    c = column_of(scene)
    strata = tuple(Stratum(x.thickness, x.density, x.young, x.poisson) for x in c.layer)
    with naming(scene):
        return ContactColumn(
            ground=Ground(strata, c.motion, impedance=c.impedance),
            law="unilateral" if c.law == "unilateral" else "frictional",
            contacts=tuple(ColumnContact(one.height, one.stiffness, one.gap, one.strength) for one in c.contacts),
            velocities=tuple(layer.velocity for layer in c.layer),
            gravity=c.gravity if c.law == "unilateral" else 0.0,
            unsupported=c.base == "free",
            settled=c.settled,
            solve_limit=c.solve_limit,
        )


def excitation(scene: Scene, instants: Array) -> Excitation:
    """Return the drive of a scene at some instants [s]."""
    return Excitation(**vars(motion_at(scene, instants)))


class LineColumn(Prepared):
    """A column of line elements, `fem.elements` of them for each block."""

    def __init__(self, scene: Scene, scheme: Scheme) -> None:
        self.scene = scene
        self.scheme = scheme
        self.ground = ground_of(scene)
        section = column_of(scene)
        self.elements = [layer.blocks * scene.fem.per_side for layer in section.layer]
        self.heights = section.heights

    def highest_frequency(self) -> float:
        """Return the largest frequency of the elements, all springs closed [rad/s]."""
        from fem_reference.column.stepping import highest_frequency

        return highest_frequency(self.ground, self.elements, self.scene.fem.degree)

    def drive(self) -> Excitation:
        """Return what drives the column at t = 0 and at the end of every stage of every step."""
        return excitation(self.scene, self.scheme.stage_times(self.scene.time.steps))

    def history_run(self) -> Run:
        """Run the scene."""
        from fem_reference.column.stepping import solve_line

        degree = self.scene.fem.degree
        columns = self.scene.run.columns
        result = solve_line(self.ground, self.elements, degree, self.scheme, self.drive(), columns, self.heights)
        return to_run(self.scene, result)

    def amplitudes(self, frequencies: Array, exact: bool) -> Mapping[str, Complex]:
        """Return the frequency response per metre at the base, or under the pressure on the top."""
        from fem_reference.column.vibration import line_response

        degree = self.scene.fem.degree
        on_top = self.scene.input.at == "top"
        columns = (DISPLACEMENT, PRESSURE)
        amplitudes = line_response(self.ground, self.elements, degree, self.scheme, frequencies, on_top, columns, exact)
        return {name: amplitude(self.scene) * values for name, values in amplitudes.items()}


class ContactLineColumn(LineColumn):
    """A column of line elements whose contacts open or slip; forces are per unit of area."""

    result: ColumnContactResult | None = None

    def __init__(self, scene: Scene, scheme: Scheme) -> None:
        super().__init__(scene, scheme)
        self.column = contact_column_of(scene)
        springs = [(one.height, one.stiffness) for one in self.column.contacts if np.isfinite(one.stiffness)]
        self.ground = replace(self.column.ground, joints=tuple(springs))

    def history_run(self) -> Run:
        """Run the scene."""
        from fem_reference.column.contacts import solve_contacts

        names = list(dict.fromkeys((*self.scene.run.columns, PRESSURE)))
        degree = self.scene.fem.degree
        self.result = solve_contacts(self.column, self.elements, degree, self.scheme, self.drive(), names, self.heights)
        return to_run(self.scene, self.result)

    def amplitudes(self, frequencies: Array, exact: bool) -> Mapping[str, Complex]:
        """Raise: what opens or slips has no frequency response."""
        raise NotReported("fem: a column whose contacts open or slip has no frequency response")

    def switches(self) -> tuple[Switch, ...]:
        """Return the switches between the steps of the history that was run."""
        result = completed(self.result)
        slips = self.column.law == "frictional"
        contacts = zip(self.column.contacts, result.states, strict=True)
        states = {f"{contact.height:g} m": states for contact, states in contacts}
        return switches_between_steps(states, result.time, slips)

    def contact_record(self) -> ContactRecord:
        """Return what the contacts did in the history that was run; there are no energies."""
        result = completed(self.result)
        column = self.column
        masses = np.array([stratum.density * stratum.thickness for stratum in column.ground.strata])
        velocities = np.array(column.velocities)
        start_energy = float(masses @ velocities**2) / 2
        force = result.columns[PRESSURE]
        opens = column.law == "unilateral"
        openings = result.openings if opens else np.zeros_like(result.openings)
        return ContactRecord(
            time=result.time,
            force=force,
            impulse=opened.impulse_of_force(force, self.scheme.step, opened.end_weight_of_column(self.scene)),
            penetration=np.maximum(0.0, -openings).max(axis=0),
            gap=np.maximum(0.0, openings).max(axis=0),
            open_share=np.asarray((result.states < 0).mean(axis=0) if opens else np.zeros(len(result.time))),
            start_velocity=float(masses @ velocities / masses.sum()),
            start_energy=start_energy,
            input_energy=start_energy,
            velocity=result.mean_velocity,
            solves=result.step_solves,
            cuts=np.zeros(len(result.time)),
            slip=None if opens else np.abs(result.openings).max(axis=0),
        )
