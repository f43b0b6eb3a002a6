"""Blocks of the package `dda` on contact that opens: one block, and glued sub-blocks."""

from __future__ import annotations

import math
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from validation.runs.contact import ContactRecord
from validation.runs.history import Array
from validation.runs.modes import Switch
from validation.runs.run import Run
from validation.scenes.scene import Scene
from validation.solvers import opened
from validation.solvers.blocks.closed import dda_limit, load_of, opening_frequency, opening_system_frequency
from validation.solvers.contract import NotReported, Prepared
from validation.solvers.limits import StepLimit
from validation.solvers.translation import check_columns, flips, naming, no_fields, opened_run

if TYPE_CHECKING:
    import dda

FORCES = ("normal_force_m", "normal_force_n", "shear_force_m", "shear_force_n")  # N, on the block
GAPS = ("gap_m", "gap_n")  # m, negative where the contact is pressed
SLIDES = ("slide_m", "slide_n")  # m, along the base, less its own displacement
STATES = ("state_m", "state_n")  # 0 open, 1 stick (closed without friction, too), 2 and -2 slip towards N and M
COUNTS = ("solves", "cuts")  # of the open-close iteration, a step
OPENING = (*GAPS, *FORCES, *SLIDES, *STATES, *COUNTS)


class OpeningBlock(Prepared):
    """A whole block on corners that carry no tension."""

    def __init__(self, scene: Scene, scheme: dda.Scheme, motion: dda.BaseMotion | None, full: bool) -> None:
        import dda

        self.scene, self.scheme, self.full = scene, scheme, full
        self.result: dda.ContactResult | None = None
        b, c = scene.block, scene.contact
        with naming(scene):
            block = dda.Block(b.outline, dda.Material(b.density, b.young, b.poisson, b.hypothesis))
            law = dda.Unilateral(c.stiffness, c.shear, c.gap, c.band, *friction(scene), c.rules)
            self.model = dda.UnilateralModel(block, law, load_of(scene, motion), b.base, b.top, velocity=b.velocity)
            self.options = dda.UnilateralOptions(c.rule, c.solve_limit, c.cut, energies=True, full=full)

    def solve(self, columns: Sequence[str]) -> dda.ContactResult:
        """Make the steps."""
        import dda

        return dda.solve_unilateral(self.model, self.scheme, self.scene.time.steps, columns, self.options)

    def step_limit(self) -> StepLimit:
        """Return the limit of the scheme while the block stands on both corners."""
        return dda_limit(lambda: opening_frequency(self.scene, self.scheme))

    def history_run(self, fields: Path | None) -> Run:
        """Run the scene."""
        import dda

        no_fields("dda", self.scene, fields)
        check_columns(self.scene, (*dda.COLUMNS, *OPENING))
        asked = [name for name in self.scene.run.columns if name in dda.COLUMNS]
        with naming(self.scene):
            r = self.solve(asked)
        self.result = r
        return opened_run(self.scene, r, {**r.columns, **self._contact(r)})

    def _contact(self, r: dda.ContactResult) -> dict[str, Array]:
        """Return the asked columns of the contacts, which are made when they are asked for."""
        counts = {"solves": "step_solves", "cuts": "step_cuts"}
        names = [name for name in self.scene.run.columns if name in OPENING]
        return {name: np.asarray(getattr(r, counts.get(name, name)), dtype=float) for name in names}

    def switches(self) -> tuple[Switch, ...]:
        """Return the switches between the steps of the history that was run."""
        if self.result is None:
            raise NotReported("dda: the scene was not run")
        r = self.result
        return flips({"M": r.closed_m.astype(float), "N": r.closed_n.astype(float)}, r.time)

    def contact_record(self) -> ContactRecord:
        """Return what the contact did in the history that was run."""
        if self.result is None:
            raise NotReported("dda: the scene was not run")
        r, gaps, force = self.result, self.result.gap, self.result.normal.sum(axis=0)
        return opened.record(
            self.scene,
            time=r.time,
            force=force,
            impulse=self._impulse(r, force),
            penetration=np.maximum(0.0, -gaps).max(axis=0),
            gap=np.maximum(0.0, gaps).max(axis=0),
            open_share=1 - np.mean(r.closed, axis=0),
            velocity=r.velocity,
            rebounds=opened.rebounds(gaps, self.scheme.step),
            energies=r.energies or {},
            solves=r.step_solves.astype(float),
            cuts=r.step_cuts.astype(float),
            slip=r.slip,
        )

    def _impulse(self, r: dda.ContactResult, force: Array) -> Array:
        """Return the impulse of the contact; the force over a step is no sum of those at its ends in the last rule."""
        late = {"newmark": self.scheme.delta, "implicit": 1.0}.get(self.options.rule)
        if late is None:
            return opened.balanced(self.scene, r.velocity)
        return opened.summed(force, self.scheme.step, late)


def friction(scene: Scene) -> tuple[float | None, float]:
    """Return tan(phi) and the cohesion of one corner, half of that of the whole base [N]."""
    c = scene.contact
    tangent = None if c.friction is None else math.tan(math.radians(c.friction))
    return tangent, c.cohesion * scene.block.base_length / 2


class OpeningSubBlocks(OpeningBlock):
    """Glued sub-blocks on points that carry no tension."""

    def __init__(self, scene: Scene, scheme: dda.Scheme, motion: dda.BaseMotion | None, full: bool) -> None:
        import dda

        super().__init__(scene, scheme, motion, full)
        b = scene.block
        with naming(scene):
            columns, rows = b.subdivide or (1, 1)
            self.opening = dda.opening_subdivided(self.model, columns, rows, b.glue_ratio * b.young, b.pattern)

    def step_limit(self) -> StepLimit:
        """Return the limit of the scheme while all points of the base are closed."""
        return dda_limit(lambda: opening_system_frequency(self.scene))

    def solve(self, columns: Sequence[str]) -> dda.ContactResult:
        """Make the steps."""
        import dda

        return dda.solve_opening_system(self.opening, self.scheme, self.scene.time.steps, columns, self.options)
