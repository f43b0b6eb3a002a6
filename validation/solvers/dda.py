"""Adapters of the package `dda`: the robust form and the printed recursion."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np

import dda
from validation.errors import InputError
from validation.runs.history import DISPLACEMENT, PRESSURE, Array, Complex
from validation.runs.modes import Mode
from validation.runs.run import Run
from validation.scenes import features
from validation.scenes.record import base_direction, base_record
from validation.scenes.scene import Scene
from validation.solvers import translation
from validation.solvers.blocks.closed import block_of, load_of
from validation.solvers.blocks.opening import OPENING, PASSES, OpeningBlock, OpeningSubBlocks
from validation.solvers.blocks.rotation import AREA, COMPATIBLE, RollingBlock
from validation.solvers.columns.names import AT_HEIGHTS
from validation.solvers.contract import LineStyle, NotReported, Prepared, Role, Solver
from validation.solvers.hooks import SolvingHooks
from validation.solvers.translation import check_columns, naming, to_run


def base_motion(scene: Scene) -> dda.BaseMotion | None:
    """Return the motion of a scene's base, or None where it is fixed."""
    record = base_record(scene)
    return None if record is None else dda.BaseMotion(record.time, np.column_stack([record.x, record.y]))


def model_of(scene: Scene) -> dda.TwoBlockModel:
    """Return the two-block model of a scene."""
    b = scene.block
    contact = dda.Contact(scene.contact.stiffness, scene.contact.shear)
    return dda.TwoBlockModel(block_of(scene), contact, load_of(scene, base_motion(scene)), b.base, b.top)


def scheme_of(scene: Scene) -> dda.Scheme:
    """Return the scheme of a scene."""
    scheme: dda.Scheme = translation.scheme_of(scene, dda)
    return scheme


class OneBlock(Prepared):
    """A whole block on its springs."""

    def __init__(self, scene: Scene, full: bool) -> None:
        self.scene = scene
        self.full = full
        with naming(scene):
            self.model = model_of(scene)
            self.scheme = scheme_of(scene)
        self.body: dda.TwoBlockModel | dda.BlockSystem = self.model

    def history_run(self) -> Run:
        """Run the scene."""
        adaptive = features.ADAPTIVE in features.of(self.scene)
        check_columns(self.scene, (*dda.COLUMNS, *dda.ADAPTIVE_COLUMNS) if adaptive else dda.COLUMNS)
        return to_run(self.scene, self.solve_steps(self.scene.time.steps, self.scene.run.columns))

    def solve_steps(self, steps: int, columns: Sequence[str]) -> dda.Result:
        """Return the history of some steps; a discount may follow the kinetic energy."""
        floor = self.scene.damping.floor if features.ADAPTIVE in features.of(self.scene) else None
        return dda.solve(self.model, self.scheme, steps, columns, self.full, floor)

    def highest_frequency(self) -> float:
        """Return the highest natural frequency that the load reaches, joints included [rad/s]."""
        return dda.highest_frequency(self.body)

    def static(self) -> Mapping[str, float]:
        """Return the static solution."""
        return dda.static(self.body)

    def modes(self) -> tuple[Mode, ...]:
        """Return the modes that the load reaches, of sub-blocks the lowest."""
        return tuple(Mode(m.frequency, m.share, m.eigenvalues, m.contact_share) for m in self.package_modes())

    def package_modes(self) -> Sequence[dda.Mode]:
        """Return the modes as DDA gives them."""
        return dda.modes(self.body, self.scheme)

    def diagnostics(self) -> Mapping[str, float]:
        """Return spectral radius, condition numbers and residual."""
        return vars(dda.diagnostics(self.model, self.scheme))

    def amplitudes(self, frequencies: Array, exact: bool) -> Mapping[str, Complex]:
        """Return the frequency response."""
        along = base_direction(self.scene)
        return dda.response(self.body, self.scheme, frequencies, (DISPLACEMENT, PRESSURE), along, exact)


class SubBlocks(OneBlock):
    """A block cut into glued sub-blocks."""

    def __init__(self, scene: Scene, full: bool) -> None:
        super().__init__(scene, full)
        b = scene.block
        with naming(scene):
            self.system = dda.subdivided(self.model, *b.cuts, b.glue_ratio * b.young, b.pattern)
        self.body = self.system

    def solve_steps(self, steps: int, columns: Sequence[str]) -> dda.Result:
        """Return the history of some steps."""
        return dda.solve_system(self.system, self.scheme, steps, columns, self.full)

    def diagnostics(self) -> Mapping[str, float]:
        """Raise: diagnostics are those of one whole block."""
        raise NotReported("dda reports diagnostics of a whole block only")


# Dashpots, impact law and augmented Lagrangian are of the corners of one block, which open at once.
NOT_WITH_METHODS = frozenset({features.SUB_BLOCKS, features.DEAD_BAND})


class DDA(Solver):
    """Discontinuous deformation analysis in its robust form."""

    name = "dda"
    handles = (
        frozenset({features.SUB_BLOCKS, features.UNILATERAL, features.DEAD_BAND, features.RIGID, features.COLUMN})
        | {features.DAMPING, features.ADAPTIVE, features.SLOPE, features.FRICTION, features.LAGGED, features.ROTATION}
        | {features.RIGID_BLOCKS, features.RIGID_JOINTS, features.PLANE, features.MOVING_BLOCKS}
        | features.OF_MOVING_COLUMN
        | features.LOADS
        | features.COURSES
        | features.RULES
        | features.SCHEMES
        | features.CONTACT_METHODS
    )
    apart: features.Apart = (
        (features.ROTATION, handles - COMPATIBLE),
        (features.DASHPOTS, NOT_WITH_METHODS),
        (features.AUGMENTED, NOT_WITH_METHODS),
        (features.IMPACT, NOT_WITH_METHODS | {features.BASE_MOTION}),
        (features.SUB_BLOCKS, features.RULES | features.COURSES | {features.RIGID, features.LAGGED}),
        (features.CONSERVING, features.COURSES | {features.BASE_MOTION}),
        (features.ADAPTIVE, features.COURSES | {features.SUB_BLOCKS}),
        *features.DAMPING_APART,
    )
    sections: tuple[str, ...] = ("damping", "time", "run")
    sources: tuple[str, ...] = ("dda",)
    role = Role.JUDGED
    rank = 0.0
    line: LineStyle | None = LineStyle("#d55e00", (), 1.1, 5)

    def columns(self) -> tuple[str, ...] | None:
        """Return the columns that this solver has."""
        return (*dda.COLUMNS, *dda.ADAPTIVE_COLUMNS, *OPENING, PASSES, AREA, *AT_HEIGHTS)

    def applicable(self, scene: Scene) -> str | None:
        """Return None, or why a band and friction do not go together, or what of its kind DDA does not take."""
        if reason := SolvingHooks.of(scene).refusal(scene, self.name):
            return reason
        consistent = {features.FRICTION, features.DEAD_BAND} <= set(features.of(scene)) and (
            scene.contact.rules == "consistent"
        )
        if consistent and scene.contact.band[1]:
            return "a corner in tension within its band is frictional under lagged rules only"
        return None

    def build(self, scene: Scene, full: bool) -> Prepared:
        """Build the block, on locked springs or on corners that open, or its sub-blocks."""
        if reason := self.applicable(scene):
            raise InputError(f"solver {self.name}: {reason}", source=scene.name)
        if (prepared := SolvingHooks.of(scene).build(scene, self.name, full)) is not None:
            return prepared
        if features.ROTATION in features.of(scene):
            return RollingBlock(scene, scheme_of(scene), base_motion(scene))
        if features.UNILATERAL in features.of(scene):
            kind = OpeningBlock if scene.block.subdivide is None else OpeningSubBlocks
            return kind(scene, scheme_of(scene), base_motion(scene), full)
        return OneBlock(scene, full) if scene.block.subdivide is None else SubBlocks(scene, full)


class Printed(OneBlock):
    """A whole block stepped by the printed recursion; there is nothing to save."""

    def solve_steps(self, steps: int, columns: Sequence[str]) -> dda.Result:
        """Return the history of some steps."""
        return dda.solve_textbook(self.model, self.scheme, steps, columns)

    def amplitudes(self, frequencies: Array, exact: bool) -> Mapping[str, Complex]:
        """Raise: the printed recursion is no M D'' + K D = F where mu is not zero."""
        raise NotReported("dda-textbook reports no frequency response: the printed recursion is stepped only")


class Textbook(DDA):
    """The printed recursion, equations (6) to (9), (31) and (32)."""

    name = "dda-textbook"
    handles = frozenset()
    role = Role.REPEAT
    rank = 1.0
    line = LineStyle("#e69f00", (2.5, 2.5), 1.1, 6)

    def columns(self) -> tuple[str, ...] | None:
        """Return the columns that this solver has."""
        return dda.COLUMNS

    def applicable(self, scene: Scene) -> str | None:
        """Return None, or why the printed recursion does not apply."""
        return dda.textbook_applicable(model_of(scene), scheme_of(scene))

    def build(self, scene: Scene, full: bool) -> Prepared:
        """Build the block."""
        return Printed(scene, full)
