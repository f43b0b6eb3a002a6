"""The table of seams: where seeded faults and other stand-ins enter the code, by the function itself and not its name.

A seam names the module or class *through which* a function is called, since that is where another must stand. Here
`newmark.predictor` is the function: where it is renamed, moved or no longer imported, this module does not import.
"""

from dataclasses import dataclass, field
from typing import Any

import dda
import fem_reference.exact.bar as exact_bar
import fem_reference.exact.layers as layers
import fem_reference.mesh.elasticity as elasticity
from dda.bodies import block_system as system
from dda.bodies import column_history as column_contacts
from dda.bodies import column_march, gap_form, joints, subdivision
from dda.bodies import glued_blocks as glued
from dda.bodies import glued_step as system_step
from dda.bodies import locked_block as solution
from dda.bodies import locked_system as system_solution
from dda.bodies import turning_block as rolling
from dda.bodies import turning_body as rolling_body
from dda.bodies import turning_step as rolling_step
from dda.march import step as march_step
from dda.model.block import Block
from dda.plane import bodies as moving_bodies
from dda.result import result as dda_result
from dda.scheme import blocked, newmark
from fem_reference.column import mesh as line_mesh
from fem_reference.column import stepping as line_stepping
from fem_reference.contact import points as fem_points
from fem_reference.events import bar_events, bars_events, block_events, column_events
from fem_reference.exact import opening_bar
from fem_reference.exact import vibration as bar_vibration
from fem_reference.history import response as fem_vibration
from fem_reference.history import solver as fem_history
from fem_reference.mesh import model as fem_model
from fem_reference.plane import elements as plane_elements
from fem_reference.scheme import eigen as fem_eigen
from fem_reference.scheme import modal
from fem_reference.scheme import stage as fem_stage
from validation.diagnosis import other_solvers, reading
from validation.engine import origin
from validation.problems import models
from validation.solvers import dda as dda_adapter
from validation.solvers import fenicsx, registry
from validation.solvers.columns import blocks as dda_columns


@dataclass(frozen=True)
class Seam:
    """Something that a module or class holds under exactly one name, in whose place another is put.

    Attributes
    ----------
    owner
        The module or class.
    sound
        What it holds: a function, or a constant.
    name
        Under which name it holds it; found, never written.
    """

    owner: Any
    sound: Any
    name: str = field(init=False)

    def __post_init__(self):
        names = [name for name, value in vars(self.owner).items() if value is self.sound]
        if len(names) != 1:
            raise ValueError(f"{self.owner!r} holds {self.sound!r} under the names {names}: a seam has exactly one")
        object.__setattr__(self, "name", names[0])

    def put(self, patch, other):
        """Put something in the place of what is there, as long as the patch lasts."""
        patch.setattr(self.owner, self.name, other)

    def wrap(self, patch, replacement):
        """Put in its place what is made of it."""
        self.put(patch, replacement(getattr(self.owner, self.name)))


# One block of DDA: its scheme, its matrices, its histories
DDA_PREDICTOR = Seam(newmark, newmark.predictor)
DDA_VELOCITY = Seam(newmark, newmark.velocity_corrector)
DDA_START = Seam(newmark, newmark.initial_acceleration)
DDA_SQUARES = Seam(blocked, blocked._squared)
DDA_STIFFNESS = Seam(gap_form, gap_form._stiffness)
DDA_LOAD = Seam(gap_form, gap_form._load)
DDA_CARRIED = Seam(solution, solution.stepped_modes)
DDA_HISTORIES = Seam(solution, solution.modal_histories)
DDA_MODES = Seam(solution, solution.modal_form)
DDA_OVERFLOW = Seam(dda_result, dda_result.bound_overflow)
DDA_SEGMENT_LOAD = Seam(Block, Block.segment_load)
DDA_SOLVE = Seam(dda, dda.solve)
DDA_OPENED = Seam(dda, dda.solve_unilateral)
DDA_REFERENCES = Seam(march_step, march_step.end_paths)
DDA_TEXTBOOK = Seam(dda, dda.solve_textbook)
DDA_SCHEME = Seam(dda_adapter, dda_adapter.scheme_of)

# Answers to what vibrates
DDA_ANSWERING = Seam(gap_form, gap_form.answering)
FEM_ANSWERING = Seam(fem_vibration, fem_vibration.answering)
BAR_ANSWERING = Seam(bar_vibration, bar_vibration.answering)

# Systems of blocks
SYSTEM_BASE = Seam(subdivision, subdivision.base_share)
SYSTEM_GLUE = Seam(dda, dda.subdivided)
SYSTEM_JOINT_ROWS = Seam(joints, joints._value)
SYSTEM_MASS = Seam(system, system._without_rounding)
SYSTEM_LOAD = Seam(system.BlockSystem, system.BlockSystem._load)
SYSTEM_FLEXIBILITY = Seam(system_step, system_step.joint_flexibility)
SYSTEM_VELOCITY = Seam(system_step, system_step.velocity_corrector)
SYSTEM_RUN = Seam(system_solution, system_solution.observed_steps)

# Glued blocks in the plane, and the body of their outline
GLUED_EDGES = Seam(glued, glued.shared_edges)
GLUED_LOAD = Seam(glued, glued._traction_of)
PLANE_MATERIAL = Seam(dda, dda.Material)
TRACTION = Seam(dda, dda.Traction)
FEM_PLANE_STIFFNESS = Seam(plane_elements.BodyElements, plane_elements.BodyElements.elastic)

# Blocks that move in the plane
PLANE = Seam(dda, dda.solve_plane)
PLANE_PULL = Seam(moving_bodies, moving_bodies.pull_of)

# Blocks that turn
ROLLING_WEIGHT = Seam(rolling.RollingModel, rolling.RollingModel.weight)
ROLLING_LAWS = Seam(rolling, rolling.laws_of)
ROLLING_MODES = Seam(rolling_body, rolling_body.free_block)
ROLLING_START = Seam(rolling.RollingModel, rolling.RollingModel.start)
ROLLING_STEPS = Seam(rolling, rolling.make_steps)
ROLLING_BASE = Seam(rolling, rolling.base_motion)
ROLLING_OBSERVED = Seam(rolling, rolling.observed)
ROLLING_TURN = Seam(rolling_step, rolling_step.turn)
ROLLING_LATE = Seam(rolling_step, rolling_step.late_share)

# Finite elements
FEM_PREDICTOR = Seam(fem_stage, fem_stage.predicted_change)
FEM_VELOCITY = Seam(fem_stage, fem_stage.velocity_at_end)
FEM_STEPPER = Seam(fem_history, fem_history.Stepper)
FEM_BOUNDED = Seam(fem_history, fem_history.bounded)
FEM_RUN = Seam(fem_history, fem_history.run)
FEM_FOUNDATION = Seam(elasticity, elasticity._carried)
FEM_MASS = Seam(elasticity, elasticity.mass)
FEM_LOAD = Seam(elasticity, elasticity.load)
FEM_ROTATION = Seam(elasticity, elasticity._rotation)
FEM_BASIS = Seam(elasticity, elasticity.vector_basis)
FEM_COLUMN = Seam(fem_model, fem_model.column)
FEM_DENSE = Seam(fem_eigen, fem_eigen.DENSE)
FEM_OPENED_COLUMN = Seam(fem_points, fem_points.column)
FENICSX_WORKER = Seam(fenicsx, fenicsx.WORKER)

# The bar
BAR_WAVE_NUMBERS = Seam(exact_bar, exact_bar.wave_numbers)
BAR_HISTORIES = Seam(exact_bar, exact_bar.weighted_response)
BAR_ROOTS = Seam(exact_bar, exact_bar.roots)
BAR_STEP = Seam(modal, modal.step_increment)
BAR_CONTINUUM = Seam(exact_bar.Bar, exact_bar.Bar.continuum)
BAR_OPENED = Seam(opening_bar, opening_bar.closed_forms)

# The exact motions with contact that opens
EVENTS_BLOCK = Seam(block_events, block_events.solve)
EVENTS_BAR = Seam(bar_events, bar_events.solve)

# Columns
COLUMN_INERTIA = Seam(column_march, column_march.inertia)
COLUMN_STIFFNESS = Seam(column_march, column_march.stiffness)
COLUMN_BASE = Seam(column_march, column_march.impedance)
COLUMN_SPRINGS = Seam(column_march, column_march.springs_of)
COLUMN_VELOCITY = Seam(march_step, march_step.velocity_corrector)
CONTACT_BODY = Seam(column_contacts, column_contacts.body_of)
CONTACT_COLUMN = Seam(dda_columns, dda_columns.solve_column)
EVENTS_COLUMN = Seam(column_events, column_events.solve)
EVENTS_BARS = Seam(bars_events, bars_events.solve)
LINE_SPRINGS = Seam(line_mesh, line_mesh._springs)
LINE_HISTORIES = Seam(line_stepping, line_stepping.histories)
LAYERS_THROUGH = Seam(layers, layers.through)

# The suite itself
RIVAL_SLIPS = Seam(other_solvers, other_solvers.CANDIDATES)
READING_COLUMNS = Seam(reading, reading.columns_of)
PROBLEM_RUNS = Seam(models, models.run_of)
ORIGIN = Seam(origin, origin._here)
IMPORTED_SOLVER = Seam(registry, registry._imported)
