"""What adapters of blocks read of a scene in the same way."""

import math

import numpy as np


def turn_of(angle):
    """Return the matrix of a rotation by an angle [rad]."""
    return np.array([[math.cos(angle), -math.sin(angle)], [math.sin(angle), math.cos(angle)]])


def tangent_of(scene, glued):
    """Return the coefficient of friction of the contact; `glued` where a closed corner never slips."""
    friction = scene.contact.friction
    return glued if friction is None else math.tan(math.radians(friction))


def push_of(scene):
    """Return the force of the pressure on the top edge, downwards [N]."""
    return scene.load.pressure * (scene.block.base_length - 2 * abs(scene.load.eccentricity))
