"""What a step must follow of a column, its layers for a wave, and the alarms of its contacts."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping, Sequence

from validation.advice.alarm import Alarm, first_row
from validation.advice.columns import column_alarms, limits
from validation.advice.hooks import AdviceHooks, ColumnLimits, Layer, Motion
from validation.models.column.tables import ColumnSection
from validation.runs.row import Row
from validation.scenes.scene import Scene
from validation.solvers.contract import Role
from validation.theory import columns


class HOOKS(AdviceHooks):
    """The first mode of a column and the wave that drives it."""

    def motions(self, scene: Scene, frequency: float | None = None) -> Iterator[Motion]:
        """Yield the first mode and the input."""
        first = columns.first_frequency(scene.table(ColumnSection)) if frequency is None else frequency
        if first is not None and 0 < first < math.inf:
            yield Motion("the first mode", first)
        driven = scene.stated_input
        if driven is not None and driven.frequency is not None:
            yield Motion("the input", 2 * math.pi * driven.frequency)

    def alarms(self, scene: Scene, rows: Mapping[str, Row] | None = None) -> Iterator[Alarm]:
        """Yield the alarms of contacts that open or slip, after a run those of the judged method's."""
        row = None if rows is None else first_row(rows, Role.JUDGED)
        if rows is None or row is not None:
            yield from column_alarms(scene, row)

    def contact_limits(self, scene: Scene) -> ColumnLimits | None:
        """Return what is known of contacts that open or slip, None of a bonded column."""
        return limits(scene)

    def layers(self, scene: Scene) -> tuple[Layer, ...]:
        """Return the layers with the joints inside them."""
        column = scene.table(ColumnSection)
        layers = []
        foot = 0.0
        for layer in column.layer:
            shares = [(joint.height - foot) / layer.thickness for joint in column.joint]
            inside = tuple(share for share in shares if 0 < share < 1)
            modulus = column.modulus(layer)
            layers.append(Layer(layer.thickness, layer.density, modulus, layer.blocks, column.glue, inside))
            foot += layer.thickness
        return tuple(layers)

    def cut(self, scene: Scene, counts: Sequence[int]) -> Scene:
        """Return the scene with so many blocks in each layer."""
        layers = zip(scene.table(ColumnSection).layer, counts, strict=True)
        return scene.with_values({"column.layer": [layer.model_dump() | {"blocks": count} for layer, count in layers]})
