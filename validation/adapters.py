"""Adapters of the built-in solvers: the one module that knows both `dda` and `fem_reference`.

Each translates a scene into the solver's own problem and the solver's result into a `Run`. The solver packages are
imported by the adapter that needs them and by no other.
"""

from __future__ import annotations

import cmath
import math
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from validation.history import Mode, Run
from validation.record import base_record
from validation.scene import Scene, SceneError
from validation.solvers import NotReported, Solver
from validation.translation import check_columns, named, no_fields, to_run

if TYPE_CHECKING:
    import dda
    import fem_reference
    import fem_reference.model

BAR_COLUMNS = ("displacement", "contact_pressure")


def check_step(scene: Scene, frequency: float) -> None:
    """Refuse a step beyond the limit of a conditionally stable scheme.

    Raises
    ------
    SceneError
        w dt exceeds the critical value of the scheme and the scene does not allow it.
    """
    from dda.spectral import critical_omega

    t = scene.time
    limit = critical_omega(t.alpha, t.delta, t.discount) / frequency
    if t.step > limit * (1 + 1e-12) and not t.allow_unstable:
        raise SceneError(
            f"{scene.name}: time.step: must not exceed {limit:.6g} s, the stability limit of "
            f"alpha = {t.alpha:g}, delta = {t.delta:g} at the largest frequency {frequency:.6g} rad/s, "
            f"got {t.step:g}; make it smaller, choose 2 alpha >= delta, or set allow_unstable = true"
        )


def conditional(scene: Scene) -> bool:
    """Whether the scheme of a scene has a stability limit."""
    from dda.spectral import critical_omega

    return bool(np.isfinite(critical_omega(scene.time.alpha, scene.time.delta, scene.time.discount)))


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
            raise SceneError(f"{scene.name}: {error}") from None

    def equations(self, scene: Scene, full: bool = False) -> fem_reference.model.Model:
        """Return M D'' + K D = F of the mesh for a pressure of 1 Pa, with every exact saving unless `full`."""
        from fem_reference.model import build

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
        from fem_reference.diagnostics import diagnostics

        return vars(diagnostics(self.problem(scene), self.scheme(scene)))


class ExactBar(FiniteElements):
    """Exact in space, Newmark in time."""

    name = "bar"

    def columns(self) -> tuple[str, ...] | None:
        """Return the columns that this solver has."""
        return BAR_COLUMNS

    def bar(self, scene: Scene) -> fem_reference.Bar:
        """Return the bar of a scene."""
        from fem_reference.bar import Bar

        return Bar.of(self.problem(scene))

    def applicable(self, scene: Scene) -> str | None:
        """Return None, or why the bar is not exact for this scene."""
        from fem_reference import bar, bar_scheme

        return bar.applicable(self.problem(scene)) or bar_scheme.applicable(self.scheme(scene))

    @named
    def solve(self, scene: Scene, full: bool = False, fields: Path | None = None) -> Run:
        """Run the scene; there is nothing to save, so `full` changes nothing."""
        no_fields(self.name, scene, fields)
        check_columns(scene, BAR_COLUMNS)
        return to_run(scene, self.bar(scene).solve(self.scheme(scene), scene.time.steps, scene.run.columns))

    def static(self, scene: Scene) -> Mapping[str, float]:
        """Return the static solution."""
        return self.bar(scene).static()

    def modes(self, scene: Scene) -> tuple[Mode, ...]:
        """Return the lowest modes."""
        return _modes(self.bar(scene).modes(self.scheme(scene)))

    def diagnostics(self, scene: Scene) -> Mapping[str, float]:
        """Refuse: the bar has no matrix and modes without end."""
        raise NotReported("bar: an exact bar has no matrix, and its frequencies have no largest one")


class Continuum(ExactBar):
    """Exact in space and time; gg is the rate -ln(gg) / dt."""

    name = "continuum"

    def applicable(self, scene: Scene) -> str | None:
        """Return None, or why there is no closed form for this scene."""
        from fem_reference import bar

        stopped = "gg = 0 has no rate -ln(gg) / dt" if scene.time.discount == 0 else None
        return bar.applicable(self.problem(scene)) or stopped

    @named
    def solve(self, scene: Scene, full: bool = False, fields: Path | None = None) -> Run:
        """Run the scene; there is nothing to save, so `full` changes nothing."""
        no_fields(self.name, scene, fields)
        check_columns(scene, BAR_COLUMNS)
        return to_run(scene, self.bar(scene).continuum(self.scheme(scene), scene.time.steps, scene.run.columns))

    def modes(self, scene: Scene) -> tuple[Mode, ...]:
        """Return the lowest modes with the eigenvalues exp((-c/2 +- sqrt(c^2/4 - w^2)) dt), c = -ln(gg) / dt."""
        t = scene.time
        half_rate = -math.log(t.discount) / t.step / 2

        def pair(w: float) -> tuple[complex, complex]:
            root = cmath.sqrt(half_rate**2 - w**2)
            return cmath.exp((root - half_rate) * t.step), cmath.exp((-root - half_rate) * t.step)

        return tuple(Mode(m.frequency, m.share, pair(m.frequency)) for m in super().modes(scene))


def _modes(found: Sequence[fem_reference.Mode]) -> tuple[Mode, ...]:
    """Translate modes; of the three eigenvalues the two greatest count, the third is zero."""
    return tuple(Mode(m.frequency, m.share, (complex(m.eigenvalues[0]), complex(m.eigenvalues[1]))) for m in found)
