"""What adapters of blocks read of a scene in the same way."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from validation.scenes.scene import Scene


def turn_of(angle: float) -> NDArray[np.float64]:
    """Return the matrix of a rotation by an angle [rad]."""
    return np.array([[math.cos(angle), -math.sin(angle)], [math.sin(angle), math.cos(angle)]])


def tangent_of(scene: Scene, glued: float) -> float:
    """Return the coefficient of friction of the contact; `glued` where a closed corner never slips."""
    friction = scene.contact.friction
    return glued if friction is None else math.tan(math.radians(friction))


def push_of(scene: Scene) -> float:
    """Return the force of the pressure on the top edge, downwards [N]."""
    return scene.load.pressure * (scene.block.base_length - 2 * abs(scene.load.eccentricity))
