"""What programs in space need beside those in the plane: angles that are not folded, and that the plane is kept."""

import math

OUT_OF_PLANE = 0.05  # rad: tilt of a box's depth from which on its motion is no longer a plane one


def check_plane(cosine):
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

    def __init__(self, start):
        self.angle = start

    def follow(self, folded):
        """Return the angle nearest to the last one that differs from a folded one by full turns [rad]."""
        self.angle += math.remainder(folded - self.angle, 2 * math.pi)
        return self.angle
