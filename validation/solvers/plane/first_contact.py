"""When two blocks of a scene first touch, as `dda` answers it beside its steps."""

from __future__ import annotations

from typing import TYPE_CHECKING

import dda

if TYPE_CHECKING:
    from validation.scenes.scene import Scene


def first_contact(scene: Scene) -> dda.FirstContact | None:
    """Return the first contact of the first two blocks of a scene in the time of its steps, or None.

    They move as they begin, without loads and other blocks (`dda.first_block_contact`).

    Raises
    ------
    ValueError
        The blocks overlap at t = 0, or one is driven.
    """
    blocks = [
        dda.PlaneBlock(block.vertices, block.density, velocity=block.velocity, spin=block.spin)
        for block in scene.plane.assembly.blocks[:2]
    ]
    return dda.first_block_contact(dda.PlaneModel(blocks), 0, 1, scene.time.duration)
