"""The exact motion of a column of blocks of one strain, or rigid, whose contacts open or slip, as a solver."""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator
from dataclasses import replace
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from validation.models.column.tables import NEAR, ColumnSection
from validation.runs import extras
from validation.runs.contact import LOST, STORED, ContactRecord
from validation.runs.history import DISPLACEMENT, PRESSURE, Array
from validation.scenes import features
from validation.scenes.drive import read_drive
from validation.scenes.scene import Scene
from validation.solvers.columns.names import AT_HEIGHTS, FORCE, GAP, SLIP, STRESS, column_of
from validation.solvers.contract import OF_SCHEMES, LineStyle, Prepared, Role, Solver, completed
from validation.solvers.events import MOST_TERMS, Motion
from validation.solvers.translation import naming

if TYPE_CHECKING:
    from fem_reference.events.column_drive import Drive
    from fem_reference.events.column_events import ColumnHistory, ColumnMotion
    from fem_reference.events.column_model import ColumnBlock, ColumnJoint, ColumnProblem


def blocks_of(section: ColumnSection) -> tuple[ColumnBlock, ...]:
    """Return the blocks of a column from the base upwards."""
    from fem_reference.events.column_model import ColumnBlock

    blocks: list[ColumnBlock] = []
    for layer in section.layer:
        height = layer.thickness / layer.blocks
        blocks += [ColumnBlock(height, layer.density, section.modulus(layer), layer.velocity)] * layer.blocks
    return tuple(blocks)


def joints_of(section: ColumnSection) -> tuple[ColumnJoint | None, ...]:
    """Return the contact at the foot of each block, None where faces move alike.

    A contact that is not where two blocks, or block and base, meet is a ValueError.
    """
    from fem_reference.events.column_model import ColumnJoint

    feet = np.array(section.faces[:-1])
    joints: list[ColumnJoint | None] = [None] * len(feet)
    for contact in section.contacts:
        number = int(np.argmin(np.abs(feet - contact.height)))
        if abs(feet[number] - contact.height) > NEAR * section.height:
            raise ValueError(f"column.joint.height: must be where blocks meet, below the top, got {contact.height!r}")
        strength = contact.strength if math.isfinite(contact.strength) else None
        joints[number] = ColumnJoint(contact.stiffness, contact.gap, strength)
    return tuple(joints)


def drive_of(scene: Scene, at: str, integral: bool) -> Drive:
    """Return what acts at an end of the column, or its integral from t = 0; nothing where the scene states no input."""
    from fem_reference.events import column_drive as drives

    if scene.stated_input is None or scene.input.at != at:
        return drives.still
    section = scene.input
    if section.record is not None:
        times, values, order = read_drive(Path(section.record), section.at)
        return drives.integrated(drives.recorded(times.tolist(), values.tolist()), order - 1 + integral)
    shapes = {"half-sine": drives.half_sine, "triangle": drives.triangle, "ricker": drives.ricker}
    shapes |= {"sine": drives.sine, "cosine": partial(drives.sine, quarters=1)}
    return drives.integrated(shapes[str(section.shape)](*section.pulse), int(integral))


def problem_of(scene: Scene) -> ColumnProblem:
    """Return the column of a scene as a problem.

    A record of a pressure is of order 1, as one of velocities is, so that it is not integrated where it acts.
    """
    from fem_reference.events.column_model import ColumnProblem

    section = column_of(scene)
    return ColumnProblem(
        blocks=blocks_of(section),
        joints=joints_of(section),
        law=section.law,
        base="rigid" if section.base == "springs" else section.base,
        impedance=section.impedance or 0.0,
        gravity=section.gravity if section.law == "unilateral" else 0.0,
        at_rest=section.settled,
        base_motion=drive_of(scene, "base", integral=True),
        pressure=drive_of(scene, "top", integral=False),
    )


class ColumnEventMotion(Motion):
    """A column whose motion is found from switch to switch."""

    motion: ColumnMotion
    most_terms = MOST_TERMS
    radius: float  # greatest proven distance of a displacement from the true one [m]

    def __init__(self, scene: Scene, name: str, full: bool) -> None:
        super().__init__(scene, name, full)
        self.section = column_of(scene)
        self.names = scene.run.columns
        with naming(scene):
            self.problem = problem_of(scene)

    def solve_motion(self) -> Iterable[Array]:
        """Find the motion and its switches; return the columns of the scene."""
        from fem_reference.events.column_events import least_terms, solve
        from fem_reference.events.switches import TooMuchWorkError

        work = self.work()
        least, closed = least_terms(self.problem, self.end)
        if least > work.limit:
            reason = f"its series would have at least {least:.3g} terms, more than {work.limit:.3g}"
            raise TooMuchWorkError(self.end * work.limit / closed, reason)
        self.motion = solve(self.problem, self.end, work=work)
        feet = self.section.faces
        self.switch_events = tuple(replace(event, corner=f"{feet[event.joint]:g} m") for event in self.motion.switches)
        state = self.motion.at(self.instants())
        self.radius = float(state.displacement_radius.max())
        return [self._column(name, state) for name in self.names]

    def _column(self, name: str, state: ColumnHistory) -> Array:
        """Return a column of the history; of two blocks that meet at a height it is the lower one's."""
        if name == DISPLACEMENT:
            return np.asarray(state.top[-1])
        if name == PRESSURE:
            return state.base_force
        part, _, number = name.rpartition("_")
        block, share = self._block_at(self.section.heights[int(number) - 1])
        if part in (FORCE, GAP, SLIP):
            # a contact's height is the top of the block below it; the base's is the foot of the first block
            joint = block if share == 0 else block + 1
            return np.asarray({FORCE: state.force, GAP: state.gap, SLIP: state.slip}[part][joint])
        if part == STRESS:
            modulus = self.problem.blocks[block].modulus
            if math.isinf(modulus):
                return np.asarray(state.face_force[block : block + 2].mean(axis=0))
            return np.asarray(modulus / self.problem.blocks[block].height * (state.foot[block] - state.top[block]))
        faces = (state.foot, state.top) if part == DISPLACEMENT else (state.foot_velocity, state.top_velocity)
        return np.asarray((1 - share) * faces[0][block] + share * faces[1][block])

    def _block_at(self, height: float) -> tuple[int, float]:
        """Return the block at a height, of two the lower one, and the share of its height below."""
        feet = np.array(self.section.faces)
        near = np.flatnonzero(np.abs(feet - height) <= NEAR * self.section.height)
        if len(near):
            face = int(near[0])
            return (face - 1, 1.0) if face else (0, 0.0)
        block = int(np.searchsorted(feet, height)) - 1
        return block, (height - float(feet[block])) / self.problem.blocks[block].height

    def bounds(self) -> Iterator[str]:
        """Yield as well the proven radius of the displacements, and what rests at zero gap or switches together."""
        motion = self.motion
        yield from super().bounds()
        yield f"proven: each displacement is off by at most {self.radius:.1e} m, of which floats round the most"
        if motion.simultaneous:
            yield f"several contacts switch within one ball {len(motion.simultaneous)} times"
        if motion.resting:
            heights = ", ".join(f"{self.section.faces[joint]:g}" for joint in motion.resting)
            yield f"at zero gap without force for a while: the contacts at {heights} m"

    def starts_closed(self, corner: str) -> bool:
        """Whether a contact is closed just after t = 0."""
        joints = [contact.number for contact in self.motion.model.contacts]
        names = [f"{self.section.faces[joint]:g} m" for joint in joints]
        return bool(self.motion.states_at_start[names.index(corner)])

    def contact_record(self) -> ContactRecord:
        """Return what the contacts did, per unit of area; the force is the base's, its impulse that of the momentum.

        Energies are told where nothing drives the column and no half-space takes them.
        """
        events = completed(self.switch_events)
        problem = self.problem
        contacts = [contact.number for contact in self.motion.model.contacts]
        t = self.sampling_instants(*dict.fromkeys(event.corner for event in events))
        state = self.motion.at(t)
        start = self.motion.at([0.0])
        masses = np.array([block.density * block.height for block in problem.blocks])
        momentum = masses @ state.velocity
        start_momentum = float(masses @ start.velocity[:, 0])
        pressure_impulse = np.array([self._pressure_impulse(moment) for moment in t.tolist()])
        impulse = momentum - start_momentum + masses.sum() * problem.gravity * t + pressure_impulse
        stretch = state.stretch[contacts]
        deepest = np.maximum(0.0, -stretch).max(axis=0)
        open_share = np.asarray(state.states[contacts] == 0, dtype=float).mean(axis=0)
        energies: dict[str, Array] = {}
        if self.scene.stated_input is None and problem.base != "transmitting":
            energies = {"kinetic": state.kinetic, "strain": state.strain, "springs": state.springs}
            energies |= {STORED[-1]: state.potential}
            energies |= dict.fromkeys(LOST[:-1], np.zeros_like(t)) | {LOST[-1]: state.friction}
        start_energy = float(start.kinetic[0])
        return ContactRecord(
            time=t,
            force=state.base_force,
            impulse=impulse,
            penetration=deepest,
            gap=state.gap[contacts].max(axis=0),
            open_share=open_share,
            start_velocity=start_momentum / float(masses.sum()),
            start_energy=start_energy,
            input_energy=start_energy + float(np.abs(state.potential - start.potential[0]).max()),
            velocity=momentum / masses.sum(),
            energies=energies,
            slip=np.abs(state.slip[contacts]).max(axis=0),
        )

    def _pressure_impulse(self, time: float) -> float:
        """Integral of the pressure on the top from t = 0 on [Pa s]."""
        from flint import arb

        values = []
        course = drive_of(self.scene, "top", integral=True)()
        for moment in (0.0, time):
            piece = course.piece_at(moment)
            values.append(float(piece.series(arb(moment), 1.0, 1)[0]))
        return values[1] - values[0]


class ColumnEvents(Solver):
    """A column of blocks of one strain, or rigid, whose contacts open or slip, exact in time: `dda` as dt -> 0."""

    name = "column-events"
    handles = features.OF_MOVING_COLUMN | features.SCHEMES | {features.COLUMN, features.RIGID_BLOCKS}
    only = features.COLUMN
    unread = ("column.glue", "column.solve_limit", *OF_SCHEMES)
    sources = ("fem_reference.events", "fem_reference.problem")
    role = Role.LIMIT
    rank = 5.6
    line: LineStyle | None = LineStyle("#cc79a7", (6.0, 1.5), 0.9, 3)
    own_columns = (DISPLACEMENT, PRESSURE, *AT_HEIGHTS)
    libraries = extras.EXACT

    def applicable(self, scene: Scene) -> str | None:
        """Return None, or why the motion from switch to switch is not that of the scene."""
        column = scene.table(ColumnSection)
        if column.law == "bonded":
            return 'it requires column.law = "unilateral" or "frictional"; layers is exact for bonded columns'
        return None if scene.time.discount == 1 else "the exact motion has no kinetic damping, and gg is below 1"

    def build(self, scene: Scene, full: bool) -> Prepared:
        """Take the scene."""
        return ColumnEventMotion(scene, self.name, full)
