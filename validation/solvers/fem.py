"""Adapter of the finite elements of `fem_reference`."""

from __future__ import annotations

import time
from collections.abc import Mapping
from functools import cached_property
from typing import TYPE_CHECKING, Any

import fem_reference
from validation.runs import extras
from validation.runs.contact import LOST, STORED, ContactRecord
from validation.runs.history import DISPLACEMENT, PRESSURE, Array, Complex
from validation.runs.modes import Mode, Switch
from validation.runs.run import Run
from validation.scenes import features
from validation.scenes.record import base_direction, base_record
from validation.scenes.scene import Scene
from validation.solvers import opened, translation
from validation.solvers.columns.names import AT_HEIGHTS
from validation.solvers.contract import LineStyle, Prepared, Role, Solver
from validation.solvers.hooks import SolvingHooks
from validation.solvers.translation import check_columns, naming, switches_between_steps, to_modes, to_run

if TYPE_CHECKING:
    from fem_reference.history.unilateral import UnilateralResult
    from fem_reference.mesh.model import Model

MESH_SECTIONS = ("time", "run", "fem")
OF_CUTS = ("plane.subdivide", "plane.pattern", "plane.glue", "plane.clamp_glue")
OF_SUB_BLOCKS = ("block.subdivide", "block.pattern", "block.glue_ratio")  # the whole body stands for its parts


def problem_of(scene: Scene) -> fem_reference.Problem:
    """Return the finite-element problem of a scene; what it refuses is an `InputError`."""
    b = scene.block
    f = scene.fem
    c = scene.contact
    record = base_record(scene)
    motion = None if record is None else fem_reference.Motion(*map(tuple, (record.time, record.x, record.y)))
    with naming(scene):
        return fem_reference.Problem(
            vertices=b.outline,
            base=b.base,
            top=b.top,
            density=b.density,
            young=b.young,
            poisson=b.poisson,
            hypothesis=b.hypothesis,
            stiffness=c.stiffness,
            shear_stiffness=c.shear,
            elements=f.per_side,
            degree=f.degree,
            mesh=f.mesh,
            foundation=f.foundation,
            cells=f.cells,
            patch_width=f.patch_width,
            motion=motion,
            **scene.load.numbers,
        )


def missing_reader(scene: Scene) -> str | None:
    """Return None, or what the mesh file of a scene needs that is not installed."""
    return extras.missing(*extras.MESH) if scene.fem.mesh else None


def points_and_cells_of_file(path: str) -> Any:
    """Return the points and cells of a mesh file as meshio has them; a ValueError if it cannot be read."""
    from fem_reference.mesh.files import read_data

    return read_data(path)


def scheme_of(scene: Scene) -> fem_reference.Scheme:
    """Return the scheme of a scene."""
    scheme: fem_reference.Scheme = translation.scheme_of(scene, fem_reference)
    return scheme


def locked_frequency(problem: fem_reference.Problem, model: Model | None = None) -> float:
    """Return the largest frequency of a mesh on a locked base [rad/s]."""
    return fem_reference.highest_frequency(problem, model=model)


def opening_frequency(problem: fem_reference.Problem, full: bool) -> float:
    """Return the largest frequency while every point of a base that may open is closed and sticks [rad/s]."""
    from fem_reference.contact.points import highest_closed_frequency

    return highest_closed_frequency(problem, full)


class Mesh(Prepared):
    """A block meshed and assembled once."""

    has_fields = True

    def __init__(self, scene: Scene, full: bool) -> None:
        self.scene = scene
        self.full = full
        self.problem = problem_of(scene)
        self.scheme = scheme_of(scene)

    @cached_property
    def model(self) -> Model:
        """M D'' + K D = F of the mesh for a pressure of 1 Pa, with every exact saving unless `full`."""
        from fem_reference.mesh.model import build

        began = time.perf_counter()
        with naming(self.scene):
            model = build(self.problem, self.full)
        self.building = time.perf_counter() - began
        return model

    def highest_frequency(self) -> float:
        """Return the mesh's largest frequency [rad/s]."""
        return locked_frequency(self.problem, self.model)

    def history_run(self) -> Run:
        """Run the scene."""
        scene = self.scene
        columns: tuple[str, ...] = fem_reference.COLUMNS
        floor = None
        if features.ADAPTIVE in features.of(scene):
            columns = (*columns, *fem_reference.ADAPTIVE_COLUMNS)
            floor = scene.damping.floor
        check_columns(scene, columns)
        result = fem_reference.solve(
            self.problem,
            self.scheme,
            scene.time.steps,
            scene.run.columns,
            full=self.full,
            fields=self.fields,
            model=self.model,
            floor=floor,
        )
        return to_run(self.scene, result, built=self.building)

    def static(self) -> Mapping[str, float]:
        """Return the static solution."""
        return fem_reference.static(self.problem, model=self.model)

    def modes(self) -> tuple[Mode, ...]:
        """Return modes that the load reaches, the first axial one first."""
        return to_modes(fem_reference.modes(self.problem, self.scheme, model=self.model))

    def diagnostics(self) -> Mapping[str, float]:
        """Return spectral radii, condition number and residual of the mesh's step."""
        from fem_reference.scheme.diagnostics import diagnostics

        return vars(diagnostics(self.problem, self.scheme, model=self.model))

    def amplitudes(self, frequencies: Array, exact: bool) -> Mapping[str, Complex]:
        """Return the frequency response of the mesh."""
        from fem_reference.history.response import response

        columns = (DISPLACEMENT, PRESSURE)
        along = base_direction(self.scene)
        return response(self.problem, self.scheme, frequencies, columns, along, exact, self.model)


# J, in the order of `STORED` and `LOST`
ENERGY_COLUMNS = ("kinetic_energy", "strain_energy", "spring_energy", "load_energy")
LOSS_COLUMNS = ("algorithmic_loss", "kinetic_damping_loss", "switching_loss", "friction_loss")


class OpeningMesh(Prepared):
    """A block on a foundation that carries no tension, point by point of its base."""

    def __init__(self, scene: Scene, full: bool) -> None:
        from fem_reference import Friction, Unilateral

        self.scene = scene
        self.full = full
        self.problem = problem_of(scene)
        self.scheme = scheme_of(scene)
        c = scene.contact
        glue = "glued" if c.shear else "frictionless"
        with naming(scene):
            friction = None if c.friction is None else Friction(c.friction, c.cohesion)
            velocity = scene.block.velocity
            self.contact = Unilateral(c.gap, velocity, glue, c.solve_limit, c.cut, c.rule, friction=friction)

    def highest_frequency(self) -> float:
        """Return the largest frequency while every point of the base is closed [rad/s]."""
        return opening_frequency(self.problem, self.full)

    def history_run(self) -> Run:
        """Run the scene."""
        from fem_reference.contact.columns import UNILATERAL_COLUMNS

        check_columns(self.scene, UNILATERAL_COLUMNS)
        result = self._solved((*self.scene.run.columns, "contact_pressure"))
        self.is_open = ~(result.columns["contact_pressure"] > 0)
        self.time = result.time
        return to_run(self.scene, result)

    def _solved(self, columns: tuple[str, ...]) -> UnilateralResult:
        from fem_reference.history.unilateral import solve_unilateral

        steps = self.scene.time.steps
        with naming(self.scene):
            return solve_unilateral(self.problem, self.scheme, steps, self.contact, self.full, columns=columns)

    def switches(self) -> tuple[Switch, ...]:
        """Return the switches of the whole base between the steps: no point presses, or some do."""
        return switches_between_steps({"base": self.is_open}, self.time)

    def contact_record(self) -> ContactRecord:
        """Return what the contact did, from the same steps with their energies."""
        from fem_reference.contact.columns import UNILATERAL_COLUMNS

        result = self._solved(UNILATERAL_COLUMNS)
        columns = result.columns
        energies = zip((*STORED, *LOST), (*ENERGY_COLUMNS, *LOSS_COLUMNS), strict=True)
        force = columns["contact_pressure"] * self.scene.block.base_length
        slip = None if self.contact.friction is None else columns["largest_slide"]
        return opened.record(
            self.scene,
            time=result.time,
            force=force,
            impulse=opened.impulse_of_contact(self.scene, force, columns["velocity"]),
            penetration=columns["largest_penetration"],
            gap=columns["largest_gap"],
            slip=slip,
            open_share=columns["open_share"],
            velocity=columns["velocity"],
            energies={name: columns[column] for name, column in energies},
            solves=columns["solves"],
            cuts=columns["cuts"],
        )


class FiniteElements(Solver):
    """The same block as a fine mesh of scikit-fem elements."""

    name = "fem"
    handles = (
        features.LOADS
        | features.COURSES
        | features.SCHEMES
        | frozenset(
            {
                features.SLOPE,
                features.FRICTION,
                features.SUB_BLOCKS,
                features.UNILATERAL,
                features.IMPLICIT,
                features.COLUMN,
                features.PLANE,
                features.MOVING_BLOCKS,
                features.UNILATERAL_COLUMN,
                features.FRICTIONAL_COLUMN,
                features.RIGID_JOINTS,
                features.DAMPING,
                features.ADAPTIVE,
            }
        )
    )
    apart = (
        (features.UNILATERAL, features.COURSES),
        (features.ADAPTIVE, features.COURSES),
        *features.DAMPING_APART,
    )
    sections: tuple[str, ...] = (*MESH_SECTIONS, "damping")
    unread = (*OF_SUB_BLOCKS, *OF_CUTS, "column.glue")
    sources: tuple[str, ...] = ("fem_reference",)
    meshed = True
    role = Role.REFERENCE
    rank = 2.0
    line: LineStyle | None = LineStyle("#0072b2", (4.0, 1.5), 1.1, 4)

    def columns(self) -> tuple[str, ...] | None:
        """Return the columns that this solver has."""
        from fem_reference.contact.columns import UNILATERAL_COLUMNS

        locked_columns = (*fem_reference.COLUMNS, *fem_reference.ADAPTIVE_COLUMNS)
        return tuple(dict.fromkeys((*locked_columns, *UNILATERAL_COLUMNS, *AT_HEIGHTS)))

    def applicable(self, scene: Scene) -> str | None:
        """Return None, or what a kind of scene says of elements."""
        return SolvingHooks.of(scene).refusal(scene, self.name)

    def missing(self, scene: Scene) -> str | None:
        """Return None, or what a mesh file needs that is not installed."""
        return missing_reader(scene)

    def build(self, scene: Scene, full: bool) -> Prepared:
        """Mesh the block, on locked springs or on a base that opens."""
        if (prepared := SolvingHooks.of(scene).build(scene, self.name, full)) is not None:
            return prepared
        return OpeningMesh(scene, full) if features.UNILATERAL in features.of(scene) else Mesh(scene, full)
