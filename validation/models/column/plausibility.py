"""Values of a column that no rock or soil has."""

from __future__ import annotations

import math
from collections.abc import Iterator

from validation.models.column.tables import ColumnSection
from validation.scenes.plausibility import (
    Implausible,
    PlausibilityHooks,
    friction,
    judged,
    material,
    pressure_values,
    stepping,
    strength,
)
from validation.scenes.scene import Scene


class HOOKS(PlausibilityHooks):
    """What a column's values are held against."""

    def values(self, scene: Scene) -> Iterator[Implausible]:
        """Yield what materials, frictions, times, springs and loads say."""
        column = scene.table(ColumnSection)
        driven = scene.stated_input
        foot = 0.0
        for number, layer in enumerate(column.layer):
            if math.isfinite(layer.young):
                modulus = column.modulus(layer)
                speed = math.sqrt(modulus / layer.density)
                strains = {}
                if driven is not None:
                    strains["input.pressure"] = abs(driven.pressure or 0.0) / modulus
                    strains["input.velocity"] = abs(driven.velocity or 0.0) / speed
                if column.motion == "pressure":
                    strains["column.gravity"] = column.static_stress(foot) / modulus
                yield from material(f"column.layer.{number}", layer.density, layer.young, speed, strains)
            foot += layer.thickness
        yield from friction("column.friction", column.friction)
        for number, joint in enumerate(column.joint):
            yield from friction(f"column.joint.{number}.friction", joint.friction)
        # times, springs and gaps that are out of proportion to the column
        t = scene.time
        moduli = [column.modulus(layer) for layer in column.layer]
        travel = sum(layer.thickness * math.sqrt(layer.density / column.modulus(layer)) for layer in column.layer)
        if travel > 0:
            yield from judged("column_step", "time.step", t.step / travel, step=t.step)
        if driven is not None and driven.frequency is not None:
            periods = driven.frequency * t.duration
            yield from judged("frequency", "input.frequency", periods, frequency=driven.frequency)
        for name, stiffness in (("glue", column.glue), ("base_stiffness", column.base_stiffness)):
            if stiffness is not None and math.isfinite(min(moduli)):
                share = stiffness * column.height / min(moduli)
                yield from judged("column_springs", f"column.{name}", share, stiffness=stiffness)
        gaps = {"column.gap": column.gap} | {f"column.joint.{i}.gap": joint.gap for i, joint in enumerate(column.joint)}
        for field, gap in gaps.items():
            yield from judged("column_gap", field, gap / column.height, gap=gap)
        yield from stepping(scene)
        # sizes, gravity, pressure and strengths
        for number, layer in enumerate(column.layer):
            yield from judged("thickness", f"column.layer.{number}.thickness", layer.thickness)
        yield from judged("gravity", "column.gravity", column.gravity)
        youngs = [layer.young for layer in column.layer if math.isfinite(layer.young)]
        if youngs:
            yield from pressure_values("input.pressure", _input_pressure(scene), min(youngs))
            yield from strength("column.strength", column.strength or 0.0, min(youngs))
            for number, joint in enumerate(column.joint):
                yield from strength(f"column.joint.{number}.strength", joint.strength or 0.0, min(youngs))

    def sinks(self, scene: Scene) -> Iterator[Implausible]:
        """Yield springs that give way by a tenth of the height."""
        column = scene.table(ColumnSection)
        pressure = abs(_input_pressure(scene))
        springs = [
            (f"column.joint.{i}.stiffness", joint.height, joint.stiffness) for i, joint in enumerate(column.joint)
        ]
        for name in ("base_stiffness", "stiffness", "glue"):
            springs.append((f"column.{name}", 0.0, getattr(column, name) or math.inf))
        for field, height, stiffness in springs:
            sink = (column.static_stress(height) + pressure) / stiffness
            yield from judged("column_sink", field, sink / column.height, stiffness=stiffness, sink=sink)


def _input_pressure(scene: Scene) -> float:
    driven = scene.stated_input
    return 0.0 if driven is None or driven.pressure is None else driven.pressure
