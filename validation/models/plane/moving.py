"""Moving blocks in the plane by `dda`: the scene as its model, the columns of its result."""

from __future__ import annotations

import math
import time
from dataclasses import replace
from pathlib import Path

import numpy as np

import dda
from validation.models.plane.assembly import Assembly
from validation.models.plane.history import ENERGY, GAP, OF_BLOCK, OF_MOMENTUM, contact_column, numbers_of, place_of
from validation.models.plane.joints import PlaneContactSection
from validation.models.plane.tables import OWN_STEP, OWN_STIFFNESS, PlaneSection
from validation.runs.history import Array, History
from validation.runs.run import Outcome, Run
from validation.scenes.record import read_record
from validation.scenes.scene import Scene
from validation.solvers.contract import Prepared
from validation.solvers.translation import naming

ROUNDING = 1e-9
OF_BLOCKS = ("vertices", "density", "young", "poisson", "hypothesis", "fixed", "velocity", "spin", "name")
PARTS = {  # where a result has what a column of a block tells
    "x": ("centroid", 0),
    "y": ("centroid", 1),
    "vx": ("velocity", 0),
    "vy": ("velocity", 1),
    "spin": ("velocity", 2),
    "ex": ("strain", 0),
    "ey": ("strain", 1),
    "gxy": ("strain", 2),
}


def springs_of(contact: PlaneContactSection) -> dda.ContactSprings:
    """Return the springs of a corner as `dda` takes them; its own in the place of rigid ones, which would not rebound.

    A rigid stop on displacements turns back as its steps happen to fall.
    """
    return dda.ContactSprings(
        stiffness=OWN_STIFFNESS if math.isinf(contact.stiffness) else contact.stiffness,
        shear=OWN_STIFFNESS if math.isinf(contact.shear) else contact.shear,
        friction=contact.friction_coefficient if contact.shear else None,
        cohesion=contact.cohesion,
        tension=contact.tension,
    )


def model_of(plane: PlaneSection) -> dda.PlaneModel:
    """Return the model of a scene; weight that grows is a load of each block."""
    assembly = plane.assembly
    blocks = [
        dda.PlaneBlock(
            motion=None if block.motion is None else _driven(block.motion),
            **{name: getattr(block, name) for name in OF_BLOCKS},
        )
        for block in assembly.blocks
    ]
    loads = [dda.PlaneLoad(*load) for load in assembly.loads]
    if plane.ramp:
        for number, block in enumerate(assembly.blocks):
            mass = block.mass
            weight = mass * plane.gravity[0], mass * plane.gravity[1]
            loads += [] if block.held else [dda.PlaneLoad(number, weight, ramp=plane.ramp)]
    return dda.PlaneModel(
        blocks,
        contacts=[dda.CornerOnEdge(*contact[:4], springs_of(contact.springs)) for contact in assembly.contacts],
        bonds=[
            dda.EdgeBond(bond.first, bond.second, *bond.edge, bond.stiffness, bond.shear) for bond in assembly.bonds
        ],
        loads=loads,
        gravity=(0.0, 0.0) if plane.ramp else plane.gravity,
        found=None if plane.touch else _found(assembly),
    )


def _driven(path: str) -> dda.BaseMotion:
    record = read_record(Path(path))
    return dda.BaseMotion(record.time, np.column_stack([record.x, record.y]))


def _found(assembly: Assembly) -> object:
    """Return the springs of contacts that are found, by pair of blocks where pairs have their own."""
    if assembly.springs is None:
        return None
    common = springs_of(assembly.springs)
    own = {pair: springs_of(springs) for pair, springs in assembly.springs_of_pairs.items()}
    if not own:
        return common
    return lambda first, second: own.get((min(first, second), max(first, second)), common)


class MovingBlocks(Prepared):
    """Blocks that move, turn and touch each other."""

    has_fields = True

    def __init__(self, scene: Scene, plane: PlaneSection, scheme: dda.Scheme) -> None:
        self.scene = scene
        self.plane = plane
        self.steps_per_row = 1
        if plane.contact is not None and math.isinf(plane.contact.stiffness):  # the scene's steps are rows alone
            self.steps_per_row = max(1, math.ceil(scene.time.step / OWN_STEP - ROUNDING))
        self.scheme = replace(scheme, step=scene.time.step / self.steps_per_row)
        with naming(scene):
            self.model = model_of(plane)

    def history_run(self) -> Run:
        """Run the scene."""
        began = time.perf_counter()
        result = dda.solve_plane(self.model, self.scheme, self.scene.time.steps * self.steps_per_row)
        seconds = {"stepping": time.perf_counter() - began}
        names = [block.name for block in self.plane.assembly.blocks]
        columns = {name: self._column(result, names, name) for name in self.scene.run.columns}
        outcome, _, step = result.outcome.partition(" at ")
        if self.fields is not None and outcome == Outcome.COMPLETED:
            self._write_fields(result, names)
        work = {"steps": result.reached, "solves": int(np.sum(result.solves)), "cuts": int(np.sum(result.cuts))}
        notes = (result.note, *([f"ended at {step}"] if step else []))
        return Run(Outcome(outcome), History(result.time[self.rows], columns), work, seconds, notes)

    @property
    def rows(self) -> slice:
        """The steps of a result that are rows of a history: the last of each, without t = 0."""
        return slice(self.steps_per_row, None, self.steps_per_row)

    def _column(self, result: dda.PlaneResult, names: list[str], column: str) -> Array:
        """Return a column of a result by its name; a contact that never carried a force has carried none."""
        place = place_of(column)
        if place.whole == ENERGY:
            values = result.energy[place.part.replace("_", " ")]
        elif place.whole:
            values = result.momentum[:, [*OF_MOMENTUM].index(place.part)]
        elif place.pair is not None:
            pair = {names.index(name) for name in place.pair}
            between = [{contact.block, contact.on} == pair for contact in result.contacts]
            values = result.normal[:, between].sum(axis=1)
        elif place.contact is None:
            values = self._of_block(result, names.index(place.block), place.part)
        else:
            contact = numbers_of(place.contact, names)
            if contact not in result.contacts:  # named tuples, which equal plain ones
                values = np.full(len(result.time), np.nan if place.part == GAP else 0.0)  # whose gap nobody looked at
                return values[self.rows]
            values = getattr(result, place.part)[:, result.contacts.index(dda.PlaneContact(*contact))]
        return np.asarray(values)[self.rows]

    def _of_block(self, result: dda.PlaneResult, block: int, part: str) -> Array:
        if part == "angle":
            return np.asarray(self.plane.assembly.blocks[block].angle + result.angle[:, block])
        field, number = PARTS[part]
        return np.asarray(getattr(result, field)[:, block, number])

    def _write_fields(self, result: dda.PlaneResult, names: list[str]) -> None:
        """Write outlines, strains and contact forces of all blocks."""
        from validation.models.plane.fields import write_fields

        parts = [(f"{name}.{part}", k, part) for k, name in enumerate(names) for part in OF_BLOCK]
        columns = {name: self._of_block(result, k, part)[self.rows] for name, k, part in parts}
        for number, (block, corner, on, edge) in enumerate(result.contacts):
            for part, values in (("normal", result.normal), ("shear", result.shear)):
                columns[contact_column(names[block], corner, names[on], edge, part)] = values[self.rows, number]
        if self.fields is not None:
            write_fields(self.fields, self.plane.assembly, History(result.time[self.rows], columns))
