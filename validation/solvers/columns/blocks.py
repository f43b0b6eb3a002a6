"""Adapters of the columns of `dda`: blocks on each other, bonded, or on contacts that open or slip."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

import dda
from dda.bodies.column import Column, Layer, Spring
from dda.bodies.column_equations import equations
from dda.bodies.column_history import ColumnOptions, ColumnResult, solve_column
from dda.bodies.column_march import Drive
from dda.bodies.column_step import DEEPEST, FURTHEST, KINETIC, MOMENTUM, OPEN_SHARE, WIDEST
from dda.contact.unilateral import OPEN, SLIP
from validation.models.column.tables import ColumnSection
from validation.runs.contact import ContactRecord
from validation.runs.history import DISPLACEMENT, PRESSURE, Array, Complex
from validation.runs.modes import Switch
from validation.runs.run import Run
from validation.scenes.drive import motion_at
from validation.scenes.scene import Scene
from validation.solvers import opened
from validation.solvers.columns.names import amplitude, column_of
from validation.solvers.contract import NotReported, Prepared, completed
from validation.solvers.translation import naming, switches_between_steps, to_run


def dda_column(section: ColumnSection) -> Column:
    """Return the column of blocks of a scene."""
    layers = [
        Layer(layer.thickness, layer.density, layer.young, layer.poisson, layer.blocks, layer.velocity)
        for layer in section.layer
    ]
    if section.law == "bonded":
        springs = [Spring(joint.height, joint.stiffness) for joint in section.springs]
        return Column(layers, section.motion, section.glue, springs, section.impedance)
    contacts = [Spring(one.height, one.stiffness, one.gap, one.strength) for one in section.contacts]
    return Column(
        layers,
        section.motion,
        joints=contacts,
        impedance=section.impedance,
        law=section.law,
        gravity=section.gravity if section.law == "unilateral" else 0.0,
        unsupported=section.base == "free",
    )


class BlockColumn(Prepared):
    """A column of DDA blocks whose springs are bonded."""

    def __init__(self, scene: Scene, scheme: dda.Scheme) -> None:
        self.scene = scene
        self.scheme = scheme
        self.section = column_of(scene)
        with naming(scene):
            self.column = dda_column(self.section)

    def highest_frequency(self) -> float:
        """Return the column's highest frequency: glue, joints, contacts and base springs included [rad/s]."""
        return dda.highest_frequency(equations(self.column))

    def drive(self) -> Drive:
        """Return what drives the column at t = 0 and at the end of every stage."""
        return Drive(**vars(motion_at(self.scene, self.scheme.instants(self.scene.time.steps))))

    def history_run(self) -> Run:
        """Run the scene."""
        result = solve_column(self.column, self.scheme, self.drive(), self.scene.run.columns, self.section.heights)
        return to_run(self.scene, result)

    def amplitudes(self, frequencies: Array, exact: bool) -> Mapping[str, Complex]:
        """Return the frequency response per metre at the base, or under the pressure on the top."""
        along = (1.0, 0.0) if self.scene.input.at == "base" else None
        system = equations(self.column)
        amplitudes = dda.response(system, self.scheme, frequencies, (DISPLACEMENT, PRESSURE), along, exact)
        return {name: amplitude(self.scene) * values for name, values in amplitudes.items()}


class ContactColumn(BlockColumn):
    """A column of DDA blocks whose contacts open or slip; forces and energies are per unit of area."""

    result: ColumnResult | None = None

    def history_run(self) -> Run:
        """Run the scene."""
        self.result = self.solved(self.keeps_contact_record)
        return to_run(self.scene, self.result)

    def solved(self, energies: bool) -> ColumnResult:
        """Make the steps; the energies take longer than these."""
        names = list(dict.fromkeys((*self.scene.run.columns, PRESSURE)))
        options = ColumnOptions(self.section.solve_limit, self.section.settled, states=True, energies=energies)
        return solve_column(self.column, self.scheme, self.drive(), names, self.section.heights, options)

    def amplitudes(self, frequencies: Array, exact: bool) -> Mapping[str, Complex]:
        """Raise: what opens or slips has no frequency response."""
        raise NotReported("dda: a column whose contacts open or slip has no frequency response")

    def switches(self) -> tuple[Switch, ...]:
        """Return the switches between the steps of the history that was run."""
        result = completed(self.result)
        slips = self.column.law == "frictional"
        contact_states = {}
        for joint in self.column.joints:
            states = result.state_of(self.column.face_of(joint))
            contact_states[f"{joint.height:g} m"] = (
                np.where(np.abs(states) == SLIP, states, 0) if slips else states == OPEN
            )
        return switches_between_steps(contact_states, result.time, slips)

    def contact_record(self) -> ContactRecord:
        """Return what the contacts did in the history that was run; its steps are made again where energies lack."""
        result = completed(self.result)
        if result.record is None:
            result = self.solved(energies=True)
        record = np.asarray(result.record)
        mass = float(np.sum(self.column.densities * self.column.heights))
        energies = result.energies or {}
        start_energy = float(record[KINETIC, 0])
        given = float(np.max(np.abs(energies["load"]), initial=0.0))
        force = result.columns[PRESSURE]
        return ContactRecord(
            time=result.time,
            force=force,
            impulse=opened.impulse_of_force(force, self.scheme.step, opened.end_weight_of_column(self.scene)),
            penetration=record[DEEPEST, 1:],
            gap=record[WIDEST, 1:],
            open_share=record[OPEN_SHARE, 1:],
            start_velocity=float(record[MOMENTUM, 0]) / mass,
            start_energy=start_energy,
            input_energy=start_energy + given,
            velocity=record[MOMENTUM, 1:] / mass,
            energies=energies,
            solves=result.step_solves.astype(float),
            cuts=np.zeros(len(result.time)),
            slip=record[FURTHEST, 1:],
        )
