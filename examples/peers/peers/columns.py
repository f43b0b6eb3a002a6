"""A column as other programs take it: stretches of one layer without a joint or an observed height inside."""

from __future__ import annotations

import itertools
import math
from dataclasses import dataclass
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from validation.models.column.tables import LayerSection

NEAR = 1e-9  # of a column's height, within which two levels are one


@dataclass(frozen=True)
class Stretch:
    """A stretch of a layer.

    Attributes
    ----------
    bottom, top
        Its ends [m].
    layer
        Of which it is.
    modulus
        Of the waves [Pa].
    spring
        Stiffness of the joint, or of the springs of the base, below it; None where there is none [Pa/m].
    """

    bottom: float
    top: float
    layer: LayerSection
    modulus: float
    spring: float | None

    @property
    def length(self):
        """Its length [m]."""
        return self.top - self.bottom

    @property
    def passing(self):
        """Time in which a wave passes it [s]."""
        return self.length * math.sqrt(self.layer.density / self.modulus)


def stretches(column, heights=()):
    """Return the stretches of a column from the base upwards, cut at heights as well."""
    joints = {joint.height: joint.stiffness for joint in column.springs}
    near = NEAR * column.height
    found = []
    bottom = 0.0
    for layer in column.layer:
        top = bottom + layer.thickness
        inside = sorted(height for height in {*joints, *heights} if bottom + near < height < top - near)
        for low, high in itertools.pairwise([bottom, *inside, top]):
            spring = next((stiffness for height, stiffness in joints.items() if abs(height - low) <= near), None)
            found.append(Stretch(low, high, layer, column.modulus(layer), spring))
        bottom = top
    return found
