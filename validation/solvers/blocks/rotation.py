"""A block of the package `dda` that may turn by any angle."""

from __future__ import annotations

import math
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from validation.runs.contact import ContactRecord
from validation.runs.history import Array
from validation.runs.modes import Switch
from validation.runs.run import Run
from validation.scenes import features
from validation.scenes.scene import Scene
from validation.solvers import opened
from validation.solvers.blocks.closed import dda_limit, load_of, rolling_frequency
from validation.solvers.blocks.opening import FORCES, GAPS, OPENING, SLIDES, STATES, friction
from validation.solvers.contract import NotReported, Prepared
from validation.solvers.limits import StepLimit
from validation.solvers.translation import check_columns, flips, naming, no_fields, opened_run

if TYPE_CHECKING:
    import dda
    from dda.rotation.result import RollingResult

AREA = "area"  # column: of the outline, over that of the start [-]
OWN = (*OPENING, AREA)
TOGETHER = features.LOADS | {features.ROTATION, features.UNILATERAL, features.RIGID, features.FRICTION, features.SLOPE}


def rotation_apart(scene: Scene) -> str | None:
    """Return None, or what does not go together with a block that turns."""
    own = set(features.of(scene))
    if features.UNILATERAL not in own:
        return f"it does not handle {features.ROTATION} without {features.UNILATERAL}"
    if others := own - TOGETHER:
        return f"it does not handle {min(others)} together with {features.ROTATION}"
    return None


class RollingBlock(Prepared):
    """A whole block whose outline, contact points and directions are taken anew at every step."""

    def __init__(self, scene: Scene, scheme: dda.Scheme, motion: dda.BaseMotion | None) -> None:
        import dda
        from dda.rotation.model import RollingModel, RollingOptions

        self.scene, self.scheme = scene, scheme
        self.result: RollingResult | None = None
        b, c = scene.block, scene.contact
        with naming(scene):
            block = dda.Block(b.outline, dda.Material(b.density, b.young, b.poisson, b.hypothesis))
            law = dda.Unilateral(c.stiffness, c.shear, c.gap, c.band, *friction(scene), c.rules)
            self.model = RollingModel(
                block,
                law,
                load_of(scene, motion),
                b.base,
                b.top,
                tilt=math.radians(b.tilt),
                velocity=(0.0, b.velocity),
            )
            self.options = RollingOptions(scene.run.rotation, c.solve_limit, c.cut)

    def step_limit(self) -> StepLimit:
        """Return the limit of the scheme while the block stands on any of its edges."""
        return dda_limit(lambda: rolling_frequency(self.scene, self.scheme))

    def history_run(self, fields: Path | None) -> Run:
        """Run the scene."""
        import dda
        from dda.rotation.solution import solve_rolling

        no_fields("dda", self.scene, fields)
        check_columns(self.scene, (*dda.COLUMNS, *OWN))
        asked = self.scene.run.columns
        with naming(self.scene):
            r = solve_rolling(
                self.model, self.scheme, self.scene.time.steps, [n for n in asked if n in dda.COLUMNS], self.options
            )
        self.result = r
        columns = of_corners(r)
        return opened_run(self.scene, r, r.columns | {name: columns[name] for name in asked if name in OWN})

    def switches(self) -> tuple[Switch, ...]:
        """Return the switches of the base corners M and N, and of the others by number, between the steps."""
        r = self._made()
        names = dict(zip(r.base_contacts, "MN", strict=True))
        closed = r.closed.astype(float)
        return flips({names.get(i, f"corner {i}"): state for i, state in enumerate(closed)}, r.time)

    def contact_record(self) -> ContactRecord:
        """Return what the contact did in the history that was run."""
        r = self._made()
        base = list(r.base_contacts)
        force = r.normal.sum(axis=0)
        return opened.record(
            self.scene,
            time=r.time,
            force=force,
            impulse=r.impulse,
            penetration=np.maximum(0.0, -r.gap).max(axis=0),
            gap=np.maximum(0.0, r.gap[base]).max(axis=0),
            open_share=1 - np.mean(r.closed[base], axis=0),
            velocity=r.velocity,
            rebounds=opened.rebounds(r.gap, self.scheme.step),
            energies=r.energies or {},
            solves=r.step_solves.astype(float),
            cuts=r.step_cuts.astype(float),
            slip=r.slip,
        )

    def _made(self) -> RollingResult:
        if self.result is None:
            raise NotReported("dda: the scene was not run")
        return self.result


def of_corners(r: RollingResult) -> dict[str, Array]:
    """Return the columns of the base corners and of the iteration."""
    own, names = list(r.base_contacts), (*FORCES, *GAPS, *SLIDES, *STATES)
    by_corner = (*r.normal[own], *r.shear[own], *r.gap[own], *r.slide[own], *r.states[own].astype(float))
    return dict(zip(names, by_corner, strict=True)) | {
        "solves": r.step_solves.astype(float),
        "cuts": r.step_cuts.astype(float),
        AREA: r.area,
    }
