"""Columns in the solvers of several kinds, and what a run of one needs and reaches."""

from __future__ import annotations

import math
from pathlib import Path
from typing import Any

import numpy as np

from validation.models.column.tables import ColumnSection
from validation.runs.history import Array
from validation.scenes.drive import motion_at, read_drive
from validation.scenes.scene import Scene
from validation.solvers.contract import Prepared, Solver
from validation.solvers.hooks import SolvingHooks
from validation.solvers.memory import UNKNOWN
from validation.solvers.soundness import ROUNDING, TINY

INSTANTS = 16  # of a period or pulse at which a drive is looked at
MOST_INSTANTS = 1_000_000


class HOOKS(SolvingHooks):
    """Bonded columns, and those whose contacts open or slip."""

    def build(self, scene: Scene, solver: str, full: bool) -> Prepared | None:
        """Return blocks of one strain for `dda`, elements for `fem`."""
        is_bonded = scene.table(ColumnSection).law == "bonded"
        if solver == "dda":
            from validation.solvers.columns.blocks import BlockColumn, ContactColumn
            from validation.solvers.dda import scheme_of as dda_scheme

            return (BlockColumn if is_bonded else ContactColumn)(scene, dda_scheme(scene))
        from validation.solvers.columns.elements import ContactLineColumn, LineColumn
        from validation.solvers.fem import scheme_of

        return (LineColumn if is_bonded else ContactLineColumn)(scene, scheme_of(scene))

    def scaled(self, scene: Scene, factor: float) -> dict[str, Any]:
        """Return the densities of all layers times a factor."""
        layers = scene.definition()["column"]["layer"]
        return {"column.layer": [layer | {"density": layer["density"] * factor} for layer in layers]}

    def memory(self, scene: Scene, solver: Solver) -> tuple[float, str]:
        """Return the bytes of the few diagonals of a column's matrices."""
        blocks = float(sum(layer.blocks for layer in scene.table(ColumnSection).layer))
        unknowns_of_block = scene.fem.degree * scene.fem.per_side if solver.meshed else 2
        return UNKNOWN * blocks * unknowns_of_block, "column.layer"

    def reach(self, scene: Scene) -> float:
        """Return how far input, weight, velocities and gaps drive a column [m]."""
        column = scene.table(ColumnSection)
        masses = [layer.thickness * layer.density for layer in column.layer]  # kg/m2
        kinetic_energy = sum(mass * layer.velocity**2 / 2 for mass, layer in zip(masses, column.layer, strict=True))
        # where contacts open, the lightest block may take all that is put in
        of_blocks = [mass / layer.blocks for mass, layer in zip(masses, column.layer, strict=True)]
        mass = max(sum(masses) if column.law == "bonded" else min(of_blocks), TINY)
        speeds = [math.sqrt(max(column.modulus(layer), TINY) / layer.density) for layer in column.layer]
        travel = sum(layer.thickness / speed for layer, speed in zip(column.layer, speeds, strict=True))
        time = scene.time.duration + scene.time.step + travel
        instants = _drive_instants(scene)
        drive = motion_at(scene, instants)
        pressure_displacement = float(np.max(np.abs(drive.pressure))) / mass * time * time / 2
        jumps = float(np.sum(np.abs(np.diff(drive.velocity, prepend=0.0))))
        # A base moves the column while it runs; how long a wave takes through a soft layer adds nothing.
        run_time = scene.time.duration + scene.time.step
        base_displacement = run_time * jumps + float(np.max(np.abs(drive.displacement)))
        # A transmitting base takes in at most Z v^2 of the incident wave.
        incident_energy = float(np.sum(np.diff(instants) * drive.velocity[1:] ** 2))
        settlement, stored_energy = _at_rest(column) if column.settled else (0.0, 0.0)
        input_energy = (column.impedance or 0.0) * incident_energy + kinetic_energy + stored_energy
        fall = column.gravity * run_time * run_time
        gaps = sum(contact.gap for contact in column.contacts)
        at_start = gaps + settlement + ROUNDING * column.height
        driven = pressure_displacement + 2 * base_displacement + time * math.sqrt(2 * input_energy / mass)
        return at_start + fall + driven


def _drive_instants(scene: Scene) -> Array:
    """Return instants of the run, close enough for a drive that varies within a step [s]."""
    t = scene.time
    instants = t.step * np.arange(t.steps + 1.0)
    if scene.stated_input is None:
        return instants
    drive = scene.input
    if drive.record is not None:
        rows = read_drive(Path(drive.record), drive.at)[0]
        within = rows[(rows > 0) & (rows < t.duration)]
        return np.unique(np.concatenate([instants, within]))
    period = drive.duration if drive.frequency is None else 1 / drive.frequency
    span = t.duration if drive.frequency is not None else min(t.duration, drive.duration or t.duration)
    count = min(MOST_INSTANTS, math.ceil(INSTANTS * span / (period or span)))
    return np.unique(np.concatenate([instants, np.linspace(0.0, span, count + 1)]))


def _at_rest(column: ColumnSection) -> tuple[float, float]:
    """Return bounds of how far a column settles under its weight [m], and of the energy in it then [J/m2]."""
    stress = column.static_stress(0.0)  # on its foot, the greatest in it
    flexibility = sum(1 / contact.stiffness for contact in column.contacts)
    flexibility += sum(layer.thickness / column.modulus(layer) for layer in column.layer)
    return stress * flexibility, stress**2 * flexibility / 2
