"""Adapters of the package `dda`: the robust form and the printed recursion."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from validation.errors import InputError
from validation.runs.contact import ContactRecord
from validation.runs.history import DISPLACEMENT, PRESSURE, Array, Complex
from validation.runs.modes import Mode, Switch
from validation.runs.run import Run
from validation.scenes import features
from validation.scenes.record import base_direction, base_record
from validation.scenes.scene import Scene
from validation.solvers import opened
from validation.solvers.columns.names import AT_HEIGHTS
from validation.solvers.contract import LineStyle, NotReported, Prepared, Role, Solver
from validation.solvers.limits import check_step
from validation.solvers.translation import check_columns, flips, naming, no_fields, opened_run, to_run

if TYPE_CHECKING:
    import dda


def base_motion(scene: Scene) -> dda.BaseMotion | None:
    """Return the motion of a scene's base, or None where it is fixed."""
    import dda

    record = base_record(scene)
    return None if record is None else dda.BaseMotion(record.time, np.column_stack([record.x, record.y]))


def model_of(scene: Scene) -> dda.TwoBlockModel:
    """Return the two-block model of a scene."""
    import dda

    b, q = scene.block, scene.load
    block = dda.Block(b.outline, dda.Material(b.density, b.young, b.poisson, b.hypothesis))
    contact = dda.Contact(scene.contact.stiffness, scene.contact.shear)
    return dda.TwoBlockModel(
        block, contact, q.pressure, b.base, b.top, q.eccentricity, q.traction, q.gravity, base_motion(scene)
    )


def scheme_of(scene: Scene) -> dda.Scheme:
    """Return the scheme of a scene."""
    import dda

    t, d = scene.time, scene.damping
    return dda.Scheme(t.alpha, t.delta, t.discount, t.step, t.start, d.mass, d.stiffness)


class OneBlock(Prepared):
    """A whole block on its springs."""

    def __init__(self, scene: Scene, full: bool) -> None:
        self.scene, self.full = scene, full
        with naming(scene):
            self.model, self.scheme = model_of(scene), scheme_of(scene)

    def run(self, fields: Path | None = None) -> Run:
        """Run the scene."""
        import dda

        self.check(fields)
        with naming(self.scene):
            return to_run(
                self.scene,
                dda.solve(self.model, self.scheme, self.scene.time.steps, self.scene.run.columns, self.full),
            )

    def check(self, fields: Path | None) -> None:
        """Refuse fields, columns that DDA does not have, and steps beyond the scheme's limit."""
        import dda

        no_fields("dda", self.scene, fields)
        check_columns(self.scene, dda.COLUMNS)
        check_step(self.scene, dda.spectral.critical_omega, self.fastest)

    def fastest(self) -> float:
        """Return the largest frequency that the load reaches [rad/s]."""
        return max(mode.frequency for mode in self.modes())

    def static(self) -> Mapping[str, float]:
        """Return the static solution."""
        return self.model.static()

    def modes(self) -> tuple[Mode, ...]:
        """Return the modes that the load reaches."""
        import dda

        found = dda.modes(self.model, self.scheme)
        return tuple(Mode(m.frequency, m.share, m.eigenvalues, m.contact_share) for m in found)

    def diagnostics(self) -> Mapping[str, float]:
        """Return spectral radius, condition numbers and residual."""
        import dda

        return vars(dda.diagnostics(self.model, self.scheme))

    def response(self, frequencies: Array, exact: bool = False) -> Mapping[str, Complex]:
        """Return the frequency response, mode by mode."""
        import dda

        check_step(self.scene, dda.spectral.critical_omega, self.fastest)
        along = base_direction(self.scene)
        with naming(self.scene):
            return dda.response(self.model, self.scheme, frequencies, (DISPLACEMENT, PRESSURE), along, exact)


class SubBlocks(OneBlock):
    """A block cut into glued sub-blocks."""

    def __init__(self, scene: Scene, full: bool) -> None:
        import dda

        super().__init__(scene, full)
        b = scene.block
        with naming(scene):
            self.system = dda.subdivided(self.model, *b.subdivide or (1, 1), b.glue_ratio * b.young, b.pattern)

    def run(self, fields: Path | None = None) -> Run:
        """Run the scene."""
        import dda

        self.check(fields)
        with naming(self.scene):
            return to_run(
                self.scene,
                dda.solve_system(self.system, self.scheme, self.scene.time.steps, self.scene.run.columns, self.full),
            )

    def fastest(self) -> float:
        """Return the largest frequency that the load reaches [rad/s]."""
        import dda

        return dda.highest_frequency(self.system)

    def static(self) -> Mapping[str, float]:
        """Return the static solution."""
        import dda

        return dda.static_system(self.system)

    def modes(self) -> tuple[Mode, ...]:
        """Return the lowest modes that the load reaches."""
        import dda

        found = dda.system_modes(self.system, self.scheme)
        return tuple(Mode(m.frequency, m.share, m.eigenvalues, m.contact_share) for m in found)

    def diagnostics(self) -> Mapping[str, float]:
        """Raise: diagnostics are those of one whole block."""
        raise NotReported("dda reports diagnostics of a whole block only")

    def response(self, frequencies: Array, exact: bool = False) -> Mapping[str, Complex]:
        """Return the frequency response of the system."""
        import dda

        check_step(self.scene, dda.spectral.critical_omega, self.fastest)
        along = base_direction(self.scene)
        with naming(self.scene):
            return dda.system_response(self.system, self.scheme, frequencies, (DISPLACEMENT, PRESSURE), along, exact)


FORCES = ("normal_force_m", "normal_force_n", "shear_force_m", "shear_force_n")  # N, on the block
GAPS = ("gap_m", "gap_n")  # m, negative where the contact is pressed
COUNTS = ("solves", "cuts")  # of the open-close iteration, a step


class OpeningBlock(Prepared):
    """A whole block on corners that carry no tension."""

    def __init__(self, scene: Scene, full: bool) -> None:
        import dda

        self.scene, self.full = scene, full
        self.result: dda.UnilateralResult | None = None
        b, c, q = scene.block, scene.contact, scene.load
        with naming(scene):
            block = dda.Block(b.outline, dda.Material(b.density, b.young, b.poisson, b.hypothesis))
            law = dda.Unilateral(c.stiffness, c.shear, c.gap, c.band)
            loads = q.pressure, b.base, b.top, q.eccentricity, q.traction, q.gravity
            self.model = dda.UnilateralModel(block, law, *loads, b.velocity)
            self.scheme = scheme_of(scene)
            self.options = dda.UnilateralOptions(c.rule, c.solve_limit, c.cut, full=full)

    def run(self, fields: Path | None = None) -> Run:
        """Run the scene."""
        import dda

        no_fields("dda", self.scene, fields)
        check_columns(self.scene, (*dda.COLUMNS, *GAPS, *FORCES, *COUNTS))
        asked = [name for name in self.scene.run.columns if name in dda.COLUMNS]
        with naming(self.scene):
            r = dda.solve_unilateral(self.model, self.scheme, self.scene.time.steps, asked, self.options)
        self.result = r
        return opened_run(self.scene, r, {**r.columns, **self._contact(r)})

    def _contact(self, r: dda.UnilateralResult) -> dict[str, NDArray[np.float64]]:
        """Return the asked columns of the contacts, which are made when they are asked for."""
        counts = {"solves": "step_solves", "cuts": "step_cuts"}
        names = [name for name in self.scene.run.columns if name in (*GAPS, *FORCES, *COUNTS)]
        return {name: np.asarray(getattr(r, counts.get(name, name)), dtype=float) for name in names}

    def switches(self) -> tuple[Switch, ...]:
        """Return the switches between the steps of the history that was run."""
        if self.result is None:
            raise NotReported("dda: the scene was not run")
        r = self.result
        return flips({"M": r.closed_m.astype(float), "N": r.closed_n.astype(float)}, r.time)

    def contact_record(self) -> ContactRecord:
        """Return what the contact did, from the same steps with their energies."""
        import dda

        scheme, steps = scheme_of(self.scene), self.scene.time.steps
        r = dda.solve_unilateral(self.model, scheme, steps, (), replace(self.options, energies=True))
        gaps, force = np.array([r.gap_m, r.gap_n]), r.normal_force_m + r.normal_force_n
        return ContactRecord(
            time=r.time,
            force=force,
            impulse=opened.summed(force, scheme.step, 1.0 if self.options.rule != "newmark" else scheme.delta),
            penetration=np.maximum(0.0, -gaps).max(axis=0),
            gap=np.maximum(0.0, gaps).max(axis=0),
            open_share=1 - np.mean([r.closed_m, r.closed_n], axis=0),
            start_velocity=self.model.velocity,
            start_energy=opened.start_energy(self.scene),
            given=opened.given_energy(self.scene),
            velocity=r.velocity,
            rebounds=opened.rebounds(gaps, scheme.step),
            energies=r.energies or {},
            solves=r.step_solves.astype(float),
            cuts=r.step_cuts.astype(float),
        )


class DDA(Solver):
    """Discontinuous deformation analysis in its robust form."""

    name = "dda"
    handles = (
        frozenset({features.SUB_BLOCKS, features.UNILATERAL, features.DEAD_BAND, features.COLUMN, features.DAMPING})
        | features.LOADS
        | features.RULES
    )
    sections: tuple[str, ...] = ("block", "contact", "load", "damping", "column", "input", "time", "run")
    sources: tuple[str, ...] = ("dda",)
    role, rank = Role.JUDGED, 0.0
    line: LineStyle | None = LineStyle("#d55e00", (), 1.1, 5)

    def columns(self) -> tuple[str, ...] | None:
        """Return the columns that this solver has."""
        import dda

        return (*dda.COLUMNS, *GAPS, *FORCES, *COUNTS, *AT_HEIGHTS)

    def applicable(self, scene: Scene) -> str | None:
        """Return None, or which features do not go together."""
        own = set(features.of(scene))
        apart = own & {features.SUB_BLOCKS, features.BASE_MOTION}
        if features.UNILATERAL in own and apart:
            return f"it does not handle {', '.join(sorted(apart))} together with {features.UNILATERAL}"
        return features.damping_apart(scene)

    def build(self, scene: Scene, full: bool) -> Prepared:
        """Build the block, on locked springs or on corners that open, or its sub-blocks."""
        if reason := self.applicable(scene):
            raise InputError(f"{scene.name}: solver {self.name}: {reason}")
        if scene.column is not None:
            from validation.solvers.columns.blocks import BlockColumn

            return BlockColumn(scene, scheme_of(scene))
        if features.UNILATERAL in features.of(scene):
            return OpeningBlock(scene, full)
        return OneBlock(scene, full) if scene.block.subdivide is None else SubBlocks(scene, full)


class Printed(OneBlock):
    """A whole block stepped by the printed recursion; there is nothing to save."""

    def run(self, fields: Path | None = None) -> Run:
        """Run the scene."""
        import dda

        self.check(fields)
        with naming(self.scene):
            found = dda.solve_textbook(self.model, self.scheme, self.scene.time.steps, self.scene.run.columns)
            return to_run(self.scene, found)

    def response(self, frequencies: Array, exact: bool = False) -> Mapping[str, Complex]:
        """Raise: the printed recursion is no M D'' + K D = F where mu is not zero."""
        raise NotReported("dda-textbook reports no frequency response: the printed recursion is stepped only")


class Textbook(DDA):
    """The printed recursion, equations (6) to (9), (31) and (32)."""

    name = "dda-textbook"
    handles = frozenset()
    role, rank = Role.REPEAT, 1.0
    line = LineStyle("#e69f00", (2.5, 2.5), 1.1, 6)

    def columns(self) -> tuple[str, ...] | None:
        """Return the columns that this solver has."""
        import dda

        return dda.COLUMNS

    def applicable(self, scene: Scene) -> str | None:
        """Return None, or why the printed recursion does not apply."""
        import dda

        return dda.textbook_applicable(model_of(scene), scheme_of(scene))

    def build(self, scene: Scene, full: bool) -> Prepared:
        """Build the block."""
        return Printed(scene, full)
