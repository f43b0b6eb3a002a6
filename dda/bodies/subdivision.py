"""A quadrilateral block cut into sub-blocks that are glued by stiff springs, on the base's springs."""

from __future__ import annotations

import functools
import math
from collections.abc import Callable
from typing import Literal

import numpy as np

from dda.bodies.block_system import BlockSystem, SurfaceLoad
from dda.bodies.joints import FIXED, Joint, Point, common_part
from dda.bodies.two_block import TwoBlockModel
from dda.contact.springs import base_axes
from dda.model.block import Block
from dda.model.checks import check_among, check_count, check_positive
from dda.model.load import at_once, pressed_part

Pattern = Literal["squares", "triangles"]
Corner = tuple[int, int]
SLIVER = 1e-9  # of the base: how far the pressed part may lie beside an edge, and what is too short to be pressed


def subdivided(model: TwoBlockModel, columns: int, rows: int, glue: float, pattern: Pattern = "squares") -> BlockSystem:
    """Return the two-block model with its block cut into sub-blocks.

    The unit square, cut into columns x rows squares (each cut once more from its lower left to its
    upper right corner for `pattern` "triangles"), is mapped bilinearly onto the block, its lower
    side onto the base. The base's springs are shared over the sub-blocks' base edges in proportion
    to length: p l / a at each end of an edge of length l.

    Parameters
    ----------
    glue : float
        Stiffness of the normal and of the shear spring at each end of a joint [N/m].

    Raises
    ------
    ValueError
        If the block is not a convex quadrilateral, or a number is out of range.
    """
    _check(model, columns, rows, glue, pattern)
    load = model.load
    contact = model.contact
    place = _corner_map(model, columns, rows)
    cells = _cells(columns, rows, pattern)
    a = model.base_length
    _, normal = base_axes(model.block, model.base)
    pressed = [end.tolist() for end in pressed_part(*model.block.edge(model.top), load.eccentricity)]
    edges: dict[tuple[Corner, Corner], int] = {}
    for number, cell in enumerate(cells):
        for i, start in enumerate(cell):
            edges[start, cell[(i + 1) % len(cell)]] = number
    joints: list[Joint] = []
    supports: list[Joint] = []
    loads: list[SurfaceLoad] = []
    for (start, end), number in edges.items():
        ends = place(start), place(end)
        neighbour = edges.get((end, start), FIXED)
        if number < neighbour:
            joints.append(Joint(number, neighbour, *ends, glue, glue))
        if start[1] == end[1] == 0:
            share = base_share(math.dist(*ends), a)
            supports.append(Joint(number, FIXED, *ends, contact.normal * share, contact.shear * share))
        if _on_side(start, end, (model.top - model.base) % 4, columns, rows):
            if load.traction:
                loads.append(SurfaceLoad(number, *ends, (load.traction, 0.0)))
            part = ends if load.eccentricity == 0 else common_part(ends, pressed, SLIVER * a)
            if part and load.pressure:
                loads.append(SurfaceLoad(number, *part, (0.0, -load.pressure)))
    return BlockSystem(
        blocks=[Block([place(corner) for corner in cell], model.block.material) for cell in cells],
        joints=joints + supports,
        observed=model.block.section.centroid,
        base_length=a,
        loads=loads,
        gravity=load.acceleration,
        motion=load.motion,
        base_normal=(float(normal[0]), float(normal[1])),
    )


def base_share(length: float, a: float) -> float:
    """Return the share of the corner springs' stiffness that each end of a base edge of some length carries."""
    return length / a


def _check(model: TwoBlockModel, columns: int, rows: int, glue: float, pattern: str) -> None:
    at_once(model.load, "sub-blocks")
    check_count(columns=columns, rows=rows)
    check_positive(glue=glue)
    check_among(("squares", "triangles"), pattern=pattern)
    turns = model.block.turns
    if len(turns) != 4 or np.any(turns <= 0):
        raise ValueError(f"vertices: only convex quadrilaterals are cut into sub-blocks, got {len(turns)} corners")


def _corner_map(model: TwoBlockModel, columns: int, rows: int) -> Callable[[Corner], Point]:
    """Return the map from a corner's numbers (i, j) to its place [m]."""
    a, b, c, d = np.roll(model.block.corners, -model.base, axis=0)

    @functools.cache  # a corner belongs to several sub-blocks
    def place(corner: Corner) -> Point:
        i, j = corner
        # numerators are whole numbers: opposite corners of a rectangle keep equal coordinates
        low = ((columns - i) * a + i * b) / columns
        high = ((columns - i) * d + i * c) / columns
        x, y = ((rows - j) * low + j * high) / rows
        return float(x), float(y)

    return place


def _cells(columns: int, rows: int, pattern: Pattern) -> list[tuple[Corner, ...]]:
    """Return the corners of every sub-block, counter-clockwise."""
    cells: list[tuple[Corner, ...]] = []
    for j in range(rows):
        for i in range(columns):
            a = (i, j)
            b = (i + 1, j)
            c = (i + 1, j + 1)
            d = (i, j + 1)
            cells += [(a, b, c, d)] if pattern == "squares" else [(a, b, c), (a, c, d)]
    return cells


def _on_side(start: Corner, end: Corner, side: int, columns: int, rows: int) -> bool:
    """Tell whether an edge lies on a side of the block, counted from the base."""
    axis, value = ((1, 0), (0, columns), (1, rows), (0, 0))[side]
    return start[axis] == end[axis] == value
