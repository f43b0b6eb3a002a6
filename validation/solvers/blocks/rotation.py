"""A block of the package `dda` that may turn by any angle."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import dda
from validation.runs.contact import ContactRecord
from validation.runs.modes import Switch
from validation.runs.run import Run
from validation.scenes import features
from validation.scenes.scene import Scene
from validation.solvers.blocks.closed import block_of, load_of, rolling_frequency
from validation.solvers.blocks.opening import OPENING, contact_column, law_of, record_of_steps
from validation.solvers.contract import Prepared, completed
from validation.solvers.translation import check_columns, naming, switches_between_steps, to_run

if TYPE_CHECKING:
    from dda.bodies.turning_block import RollingResult

AREA = "area"  # column: of the outline, over that of the start [-]
ROLLING_COLUMNS = (*OPENING, AREA)
COMPATIBLE = (
    features.LOADS
    | features.SCHEMES
    | {
        features.ROTATION,
        features.UNILATERAL,
        features.RIGID,
        features.FRICTION,
        features.SLOPE,
    }
)


class RollingBlock(Prepared):
    """A whole block whose outline, contact points and directions are taken anew at every step."""

    def __init__(self, scene: Scene, scheme: dda.Scheme, motion: dda.BaseMotion | None) -> None:
        from dda.bodies.turning_block import RollingModel

        self.scene = scene
        self.scheme = scheme
        self.result: RollingResult | None = None
        b = scene.block
        c = scene.contact
        with naming(scene):
            self.model = RollingModel(
                block_of(scene),
                law_of(scene),
                load_of(scene, motion),
                b.base,
                b.top,
                tilt=math.radians(b.tilt),
                velocity=(0.0, b.velocity),
            )
            self.options = dda.UnilateralOptions(solve_limit=c.solve_limit, cut=c.cut, rotation=scene.run.rotation)

    def highest_frequency(self) -> float:
        """Return the largest frequency of the block on any of its edges [rad/s]."""
        return rolling_frequency(self.scene)

    def history_run(self) -> Run:
        """Run the scene."""
        check_columns(self.scene, (*dda.COLUMNS, *ROLLING_COLUMNS))
        requested_columns = self.scene.run.columns
        model_columns = [name for name in requested_columns if name in dda.COLUMNS]
        result = dda.solve_unilateral(self.model, self.scheme, self.scene.time.steps, model_columns, self.options)
        self.result = result
        columns = {name: contact_column(result, name) for name in requested_columns if name in OPENING}
        if AREA in requested_columns:
            columns[AREA] = result.area
        return to_run(self.scene, result, result.columns | columns)

    def switches(self) -> tuple[Switch, ...]:
        """Return the switches of the base corners M and N, and of the others by number, between the steps."""
        result = completed(self.result)
        names = dict(zip(result.base_contacts, "MN", strict=True))
        is_open = {names.get(i, f"corner {i}"): ~closed for i, closed in enumerate(result.closed)}
        return switches_between_steps(is_open, result.time)

    def contact_record(self) -> ContactRecord:
        """Return what the contact did in the history that was run."""
        result = completed(self.result)
        return record_of_steps(self.scene, result, result.impulse, list(result.base_contacts))
