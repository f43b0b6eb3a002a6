r"""Whether a history is sound: one finite number for each step, and no motion that the scene could not have driven.

What neither creates energy nor takes it from elsewhere (springs, closed, open or slipping contacts, damping) moves no
faster than its load alone would drive it: with E the energy of a body of mass m under a force F in the frame of its
base, dE/dt <= (|F| + m |y''|) v and v <= sqrt(2 E / m), so that

    s = sqrt(2 E / m),   s' <= |F| / m + |y''|,   |u| <= s0 T + |F| T^2 / (2 m) + T integral |y''| dt + max |y|.

A history beyond `MARGIN` times that bound is unbounded growth, whatever made it.
"""

from __future__ import annotations

import math
from dataclasses import replace
from pathlib import Path

import numpy as np

from validation.errors import InputError
from validation.models.column.tables import ColumnSection
from validation.runs.history import Array
from validation.runs.run import Outcome, Run
from validation.scenes.drive import motion_at, read_drive
from validation.scenes.record import base_record
from validation.scenes.scene import Scene

# The bound is of the mean over the body: a point of it may move further by the square root of the mass over that of
# the point's surroundings, and a scheme overshoots in its first steps. A growing step passes a thousandfold at once.
MARGIN = 1e3
ROUNDING = float(np.finfo(float).eps)  # part of its size that stands for the displacement of a body at rest
INSTANTS = 16  # of a period or pulse at which a drive is looked at
MOST_INSTANTS = 1_000_000
TINY = float(np.finfo(float).tiny)  # what stands for a mass or modulus that underflows
LENGTHS = ("displacement", "horizontal_displacement", "gap_", "slide_", "largest_")  # columns in m begin so


def checked(run: Run, scene: Scene) -> Run:
    """Check a run's history against its scene; a defect replaces the outcome."""
    if run.history is None or run.outcome is not Outcome.COMPLETED:
        return run
    steps = scene.time.steps
    for name in ("time", *scene.run.columns):
        values = run.history.time if name == "time" else run.history.columns.get(name)
        if values is None:
            continue
        if np.shape(values) != (steps,):
            return _failed(run, Outcome.WRONG_SHAPE, f"{name} has shape {np.shape(values)}, not ({steps},)")
        if np.isnan(values).any():
            return _failed(run, Outcome.NOT_A_NUMBER, f"{name} at step {int(np.argmax(np.isnan(values))) + 1}")
        if np.isinf(values).any():
            return _failed(run, Outcome.OVERFLOW, f"{name} at step {int(np.argmax(np.isinf(values))) + 1}")
    largest = MARGIN * reach(scene)
    for name in scene.run.columns:
        values = run.history.columns.get(name)
        if values is None or not name.startswith(LENGTHS):
            continue
        beyond = np.abs(values) > largest
        if beyond.any():
            step = int(np.argmax(beyond)) + 1
            note = f"{name} exceeds {largest:.3g} m, {MARGIN:g} times what the load can do, at step {step}"
            return _failed(run, Outcome.UNBOUNDED, note)
    return run


def _failed(run: Run, outcome: Outcome, note: str) -> Run:
    return replace(run, outcome=outcome, notes=(*run.notes, note))


def reach(scene: Scene) -> float:
    """Return the bound of the displacement that the load and the given energy of a scene can drive [m].

    It is infinite where the motion of the base cannot be read: the solver that ran the scene has not read it either;
    of rigid boxes, whose columns are positions, and of blocks in the plane.
    """
    if scene.kind.name in ("rigid", "plane"):
        return math.inf
    with np.errstate(all="ignore"):
        try:
            bound = _reach_of_block(scene) if scene.column is None else _reach_of_column(scene)
        except InputError:
            return math.inf
    return math.inf if math.isnan(bound) else bound


def _reach_of_block(scene: Scene) -> float:
    b = scene.block
    c = scene.contact
    q = scene.load
    start, end = b.edge(b.top)
    top = math.dist(start, end)
    mass = max(b.mass, TINY)
    acceleration = (abs(q.pressure) + abs(q.traction)) * top / mass + abs(q.gravity)
    # The surface moves before the mean does: as long as a wave takes through the block, the bound would be too small.
    travel = math.hypot(*b.extent) * math.sqrt(b.density / b.young)
    time = scene.time.duration + scene.time.step + travel
    base_displacement = _base_motion(scene, time)
    at_start = c.gap + sum(c.band) + ROUNDING * max(b.extent)
    return abs(b.velocity) * time + acceleration * time * time / 2 + base_displacement + at_start


def _base_motion(scene: Scene, time: float) -> float:
    """Return T integral |y''| dt + max |y| of a base whose record is read linearly between its instants [m]."""
    record = base_record(scene)
    if record is None:
        return 0.0
    displacement = np.column_stack([record.x, record.y])
    velocity = np.diff(displacement, axis=0) / np.diff(record.time)[:, None]
    at_rest = np.zeros((1, 2))
    jumps = np.diff(np.concatenate([at_rest, velocity, at_rest]), axis=0)
    changes = float(np.sum(np.hypot(*jumps.T)))
    return time * changes + float(np.max(np.hypot(*displacement.T)))


def _reach_of_column(scene: Scene) -> float:
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
    """Return instants of the run, close enough that a drive that varies within a step is seen [s]."""
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
