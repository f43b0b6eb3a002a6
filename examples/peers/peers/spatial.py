"""What programs in space need beside those in the plane: unfolded angles, the plane of motion, a long enough ground."""

from __future__ import annotations

import math

from peers.boxes import boxes_of
from validation.scenes.scene import Scene

MARGIN = 10.0  # m on each side
OUT_OF_PLANE = 0.05  # rad: tilt of a box's depth from which on its motion is no longer a plane one


def check_plane(cosine: float) -> None:
    """Refuse to answer for a box that has left the plane of its problem.

    What is read of its motion in the plane lacks a part of its energy and its turns then.

    Parameters
    ----------
    cosine
        Of the angle between the box's depth and the normal of the plane.

    Raises
    ------
    NotImplementedError
        The box has left it.
    """
    if cosine < math.cos(OUT_OF_PLANE):
        raise NotImplementedError(
            "a box, free in space here, left the plane of the problem: its motion in the plane is no answer any more"
        )


class Rotation:
    """An angle that goes on beyond half a turn, of a program that folds it.

    Between two looks at it a box must turn by less than half a turn.
    """

    def __init__(self, start: float) -> None:
        self.angle = start

    def follow(self, folded: float) -> float:
        """Return the angle nearest to the last one that differs from a folded one by full turns [rad]."""
        self.angle += math.remainder(folded - self.angle, 2 * math.pi)
        return self.angle


def accelerated_reach(scene: Scene) -> float:
    """Return how far from x = 0 a box of the scene can be at most [m].

    Its speed is at most what its energy at the start gives it, what the slope adds, and twice the ground's.
    """
    boxes = boxes_of(scene)
    time = scene.time.step * scene.time.steps
    along, upwards = boxes.pull
    _, peak = boxes.base(1 / (4 * boxes.base_frequency))
    reach = 0.0
    for box, (x, y, _) in zip(boxes.box, boxes.starts, strict=True):
        diagonal = math.hypot(box.width, box.height)
        energy = math.hypot(*box.velocity) ** 2 + (box.spin * diagonal) ** 2 + 2 * abs(upwards) * y
        speed = math.sqrt(energy) + 2 * abs(peak)
        reach = max(reach, abs(x) + diagonal + speed * time + abs(along) * time**2 / 2)
    return reach + MARGIN
