"""Adapters of the exact bar: under the Newmark scheme and in continuous time."""

from __future__ import annotations

import cmath
import math
from collections.abc import Mapping
from pathlib import Path
from typing import TYPE_CHECKING

from validation.runs.modes import Mode
from validation.runs.run import Run
from validation.scenes.scene import Scene
from validation.solvers.contract import NotReported
from validation.solvers.translation import check_columns, named, no_fields, to_run

if TYPE_CHECKING:
    import fem_reference
    import fem_reference.mesh.model
from validation.solvers.fem import FiniteElements, _modes

BAR_COLUMNS = ("displacement", "contact_pressure")


class ExactBar(FiniteElements):
    """Exact in space, Newmark in time."""

    name = "bar"

    def columns(self) -> tuple[str, ...] | None:
        """Return the columns that this solver has."""
        return BAR_COLUMNS

    def bar(self, scene: Scene) -> fem_reference.Bar:
        """Return the bar of a scene."""
        from fem_reference.exact.bar import Bar

        return Bar.of(self.problem(scene))

    def applicable(self, scene: Scene) -> str | None:
        """Return None, or why the bar is not exact for this scene."""
        from fem_reference.exact import bar
        from fem_reference.scheme import modal as bar_scheme

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
        from fem_reference.exact import bar

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
