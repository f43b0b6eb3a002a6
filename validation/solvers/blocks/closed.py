"""The largest frequency of blocks of the package `dda` on contact that opens: that of the closed, sticking contact."""

from __future__ import annotations

import math
from dataclasses import replace

import dda
from validation.scenes.scene import Scene

# A locked corner must have a shear spring; one so soft moves no digit of the largest frequency.
FRICTIONLESS = 1e-12  # of the normal stiffness


def closed_corners(stiffness: float, shear: float) -> dda.Contact:
    """Return corners that stay closed and stick."""
    return dda.Contact(stiffness, shear or FRICTIONLESS * stiffness)


def block_of(scene: Scene) -> dda.Block:
    """Return the block of a scene."""
    b = scene.block
    return dda.Block(b.outline, dda.Material(b.density, b.young, b.poisson, b.hypothesis))


def load_of(scene: Scene, motion: dda.BaseMotion | None = None) -> dda.Load:
    """Return the loads of a scene, over a base that moves or not."""
    return dda.Load(motion=motion, **scene.load.numbers)


def closed_model(scene: Scene) -> dda.TwoBlockModel:
    """Return the block of a scene on its base with both corners closed and sticking.

    A block without pressure, such as one that is thrown, is given one: its impact moves the same unknowns.
    """
    b = scene.block
    corners = closed_corners(scene.contact.stiffness, scene.contact.shear)
    load = replace(load_of(scene), pressure=scene.load.pressure or 1.0)
    return dda.TwoBlockModel(block_of(scene), corners, load, b.base, b.top)


def opening_frequency(scene: Scene) -> float:
    """Return the largest frequency of a whole block that may leave its base [rad/s]."""
    if math.isinf(scene.contact.stiffness):
        return math.inf
    return dda.highest_frequency(closed_model(scene))


def opening_system_frequency(scene: Scene) -> float:
    """Return the largest frequency of glued sub-blocks that may leave their base [rad/s]."""
    b = scene.block
    if math.isinf(scene.contact.stiffness):
        return math.inf
    return dda.highest_frequency(dda.subdivided(closed_model(scene), *b.cuts, b.glue_ratio * b.young, b.pattern))


def rolling_frequency(scene: Scene) -> float:
    """Return the largest frequency of a block that may turn on to any of its edges [rad/s].

    The springs turn against the block, so that the stiffer one acts along both directions. A pressure and a traction
    move all six unknowns, as a block that turns does.
    """
    c = scene.contact
    if math.isinf(c.stiffness):
        return math.inf
    block = block_of(scene)
    stiffness = max(c.stiffness, c.shear)
    corners = closed_corners(stiffness, stiffness)
    frequencies = []
    for base in range(len(scene.block.outline)):
        top = 0 if base else 1  # any other edge
        model = dda.TwoBlockModel(block, corners, pressure=1.0, base=base, top=top, traction=1.0)
        frequencies.append(dda.highest_frequency(model))
    return max(frequencies)
