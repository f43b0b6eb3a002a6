"""Adapters of the package `dda`: the robust form and the printed recursion."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from validation.runs.modes import Mode
from validation.runs.run import Run
from validation.scenes.record import base_record
from validation.scenes.scene import Scene
from validation.solvers.contract import NotReported, Solver
from validation.solvers.translation import check_columns, named, no_fields, to_run

if TYPE_CHECKING:
    import dda
from validation.solvers.limits import check_step, conditional


def base_motion(scene: Scene) -> dda.BaseMotion | None:
    """Return the motion of a scene's base, or None where it is fixed."""
    import dda

    record = base_record(scene)
    return None if record is None else dda.BaseMotion(record.time, np.column_stack([record.x, record.y]))


class DDA(Solver):
    """Discontinuous deformation analysis in its robust form."""

    name = "dda"
    sources: tuple[str, ...] = ("dda",)
    _kept: tuple[Scene, dda.BlockSystem] | None = None

    def columns(self) -> tuple[str, ...] | None:
        """Return the columns that this solver has."""
        import dda

        return dda.COLUMNS

    def model(self, scene: Scene) -> dda.TwoBlockModel:
        """Return the two-block model of a scene."""
        import dda

        b = scene.block
        block = dda.Block(b.outline, dda.Material(b.density, b.young, b.poisson, b.hypothesis))
        contact = dda.Contact(scene.contact.stiffness, scene.contact.shear)
        q = scene.load
        return dda.TwoBlockModel(
            block, contact, q.pressure, b.base, b.top, q.eccentricity, q.traction, q.gravity, base_motion(scene)
        )

    def system(self, scene: Scene) -> dda.BlockSystem | None:
        """Return the system of sub-blocks of a scene, or None where the block is whole; the last one is kept."""
        import dda

        b = scene.block
        if b.subdivide is None:
            return None
        if self._kept is None or self._kept[0] is not scene:
            self._kept = scene, dda.subdivided(self.model(scene), *b.subdivide, b.glue_ratio * b.young, b.pattern)
        return self._kept[1]

    def scheme(self, scene: Scene) -> dda.Scheme:
        """Return the scheme of a scene."""
        import dda

        t = scene.time
        return dda.Scheme(t.alpha, t.delta, t.discount, t.step, t.start)

    @named
    def solve(self, scene: Scene, full: bool = False, fields: Path | None = None) -> Run:
        """Run the scene."""
        import dda

        no_fields(self.name, scene, fields)
        self._check(scene, dda.COLUMNS)
        asked = self.scheme(scene), scene.time.steps, scene.run.columns, full
        system = self.system(scene)
        return to_run(scene, dda.solve_system(system, *asked) if system else dda.solve(self.model(scene), *asked))

    def _check(self, scene: Scene, known: tuple[str, ...]) -> None:
        import dda

        check_columns(scene, known)
        if conditional(scene):
            system = self.system(scene)
            fastest = dda.highest_frequency(system) if system else max(mode.frequency for mode in self.modes(scene))
            check_step(scene, fastest)

    def static(self, scene: Scene) -> Mapping[str, float]:
        """Return the static solution."""
        import dda

        system = self.system(scene)
        return dda.static_system(system) if system else self.model(scene).static()

    def modes(self, scene: Scene) -> tuple[Mode, ...]:
        """Return the modes that the load reaches, of sub-blocks the lowest ones."""
        import dda

        system, scheme = self.system(scene), self.scheme(scene)
        found = dda.system_modes(system, scheme) if system else dda.modes(self.model(scene), scheme)
        return tuple(Mode(m.frequency, m.share, m.eigenvalues, m.contact_share) for m in found)

    def diagnostics(self, scene: Scene) -> Mapping[str, float]:
        """Return spectral radius, condition numbers and residual of a whole block."""
        import dda

        if scene.block.subdivide is not None:
            raise NotReported("dda reports diagnostics of a whole block only")
        return vars(dda.diagnostics(self.model(scene), self.scheme(scene)))


class Textbook(DDA):
    """The printed recursion, equations (6) to (9), (31) and (32)."""

    name = "dda-textbook"

    def applicable(self, scene: Scene) -> str | None:
        """Return None, or why the printed recursion does not apply."""
        import dda

        return scene.beyond_two_blocks or dda.textbook_applicable(self.model(scene), self.scheme(scene))

    @named
    def solve(self, scene: Scene, full: bool = False, fields: Path | None = None) -> Run:
        """Run the scene; there is nothing to save, so `full` changes nothing."""
        import dda

        no_fields(self.name, scene, fields)
        self._check(scene, dda.COLUMNS)
        model, scheme = self.model(scene), self.scheme(scene)
        return to_run(scene, dda.solve_textbook(model, scheme, scene.time.steps, scene.run.columns))
