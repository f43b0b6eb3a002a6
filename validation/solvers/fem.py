"""Adapter of the finite elements of `fem_reference`."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING

from validation.errors import InputError
from validation.runs.modes import Mode
from validation.runs.run import Run
from validation.scenes.record import base_record
from validation.scenes.scene import Scene
from validation.solvers.contract import Solver
from validation.solvers.translation import check_columns, named, to_run

if TYPE_CHECKING:
    import fem_reference
    import fem_reference.mesh.model
from validation.solvers.limits import check_step, conditional


class FiniteElements(Solver):
    """The same block as a fine mesh of scikit-fem elements."""

    name = "fem"
    sections = ("block", "contact", "load", "time", "run", "fem")
    unread = ("block.subdivide", "block.pattern", "block.glue_ratio")
    sources: tuple[str, ...] = ("fem_reference",)

    def columns(self) -> tuple[str, ...] | None:
        """Return the columns that this solver has."""
        import fem_reference

        return fem_reference.COLUMNS

    def problem(self, scene: Scene) -> fem_reference.Problem:
        """Return the finite-element problem of a scene."""
        import fem_reference

        b, f, c, q = scene.block, scene.fem, scene.contact, scene.load
        record = base_record(scene)
        motion = None if record is None else fem_reference.Motion(*map(tuple, (record.time, record.x, record.y)))
        try:
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
                pressure=q.pressure,
                elements=f.per_side,
                degree=f.degree,
                mesh=f.mesh,
                foundation=f.foundation,
                cells=f.cells,
                patch_width=f.patch_width,
                eccentricity=q.eccentricity,
                traction=q.traction,
                gravity=q.gravity,
                motion=motion,
            )
        except ValueError as error:
            raise InputError(f"{scene.name}: {error}") from None

    def equations(self, scene: Scene, full: bool = False) -> fem_reference.mesh.model.Model:
        """Return M D'' + K D = F of the mesh for a pressure of 1 Pa, with every exact saving unless `full`."""
        from fem_reference.mesh.model import build

        return build(self.problem(scene), full)

    def scheme(self, scene: Scene) -> fem_reference.Scheme:
        """Return the scheme of a scene."""
        import fem_reference

        t = scene.time
        return fem_reference.Scheme(t.alpha, t.delta, t.discount, t.step, t.start)

    def check_stable(self, scene: Scene) -> None:
        """Refuse a step beyond the stability limit at the mesh's highest frequency."""
        if conditional(scene):
            import fem_reference

            check_step(scene, fem_reference.highest_frequency(self.problem(scene)))

    @named
    def solve(self, scene: Scene, full: bool = False, fields: Path | None = None) -> Run:
        """Run the scene."""
        import fem_reference

        check_columns(scene, fem_reference.COLUMNS)
        problem = self.problem(scene)
        self.check_stable(scene)
        return to_run(
            scene,
            fem_reference.solve(
                problem, self.scheme(scene), scene.time.steps, scene.run.columns, full=full, fields=fields
            ),
        )

    def static(self, scene: Scene) -> Mapping[str, float]:
        """Return the static solution."""
        import fem_reference

        return fem_reference.static(self.problem(scene))

    def modes(self, scene: Scene) -> tuple[Mode, ...]:
        """Return the lowest modes that the load reaches, the first axial one first."""
        import fem_reference

        return _modes(fem_reference.modes(self.problem(scene), self.scheme(scene)))

    def diagnostics(self, scene: Scene) -> Mapping[str, float]:
        """Return spectral radii, condition number and residual of the mesh's step."""
        from fem_reference.scheme.diagnostics import diagnostics

        return vars(diagnostics(self.problem(scene), self.scheme(scene)))


def _modes(found: Sequence[fem_reference.Mode]) -> tuple[Mode, ...]:
    """Translate modes; of the three eigenvalues the two greatest count, the third is zero."""
    return tuple(Mode(m.frequency, m.share, (complex(m.eigenvalues[0]), complex(m.eigenvalues[1]))) for m in found)
