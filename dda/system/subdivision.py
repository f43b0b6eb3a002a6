"""A quadrilateral block cut into sub-blocks that are glued by stiff springs, on the base's springs."""

from __future__ import annotations

import functools
import math
from collections.abc import Callable
from typing import Literal

import numpy as np

from dda.contact.springs import base_directions
from dda.model.arrays import Array
from dda.model.block import Block
from dda.model.load import at_once, pressed_part
from dda.one_block.two_block import TwoBlockModel
from dda.system.joints import FIXED, Joint
from dda.system.system import BlockSystem, SurfaceLoad

Pattern = Literal["squares", "triangles"]
Corner = tuple[int, int]
Point = tuple[float, float]


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
    place = _corner_map(model, columns, rows)
    cells = _cells(columns, rows, pattern)
    material = model.block.material
    blocks = [Block([place(corner) for corner in cell], material) for cell in cells]
    _, normal, a = base_directions(model.block, model.base)
    edges = {
        (cell[i], cell[(i + 1) % len(cell)]): number for number, cell in enumerate(cells) for i in range(len(cell))
    }
    joints = [
        Joint(number, edges[end, start], place(start), place(end), glue, glue)
        for (start, end), number in edges.items()
        if (end, start) in edges and number < edges[end, start]
    ]
    supports, loads = [], []
    for (start, end), number in edges.items():
        ends = place(start), place(end)
        if start[1] == end[1] == 0:
            share = base_share(math.dist(*ends), a)
            supports.append(Joint(number, FIXED, *ends, model.contact.normal * share, model.contact.shear * share))
        if _on_side(start, end, (model.top - model.base) % 4, columns, rows):
            loads += _surface_loads(model, number, ends)
    centroid = model.block.section.centroid
    return BlockSystem(
        blocks,
        joints + supports,
        centroid,
        a,
        loads,
        model.load.gravity,
        model.load.motion,
        base_normal=(float(normal[0]), float(normal[1])),
        slope=model.load.slope,
    )


def base_share(length: float, a: float) -> float:
    """Return the share of the corner springs' stiffness that each end of a base edge of some length carries."""
    return length / a


def _check(model: TwoBlockModel, columns: int, rows: int, glue: float, pattern: str) -> None:
    at_once(model.load, "sub-blocks")
    for field, count in (("columns", columns), ("rows", rows)):
        if count < 1:
            raise ValueError(f"{field}: must be at least 1, got {count!r}")
    if not (math.isfinite(glue) and glue > 0):
        raise ValueError(f"glue: must be finite and positive, got {glue!r}")
    if pattern not in ("squares", "triangles"):
        raise ValueError(f"pattern: must be 'squares' or 'triangles', got {pattern!r}")
    corners = model.block.corners
    side = np.roll(corners, -1, axis=0) - corners
    after = np.roll(side, -1, axis=0)
    if len(corners) != 4 or np.any(side[:, 0] * after[:, 1] - side[:, 1] * after[:, 0] <= 0):
        raise ValueError(f"vertices: only convex quadrilaterals are cut into sub-blocks, got {len(corners)} corners")


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
            a, b, c, d = (i, j), (i + 1, j), (i + 1, j + 1), (i, j + 1)
            cells += [(a, b, c, d)] if pattern == "squares" else [(a, b, c), (a, c, d)]
    return cells


def _on_side(start: Corner, end: Corner, side: int, columns: int, rows: int) -> bool:
    """Tell whether an edge lies on a side of the block, counted from the base."""
    axis, value = ((1, 0), (0, columns), (1, rows), (0, 0))[side]
    return start[axis] == end[axis] == value


def _surface_loads(model: TwoBlockModel, number: int, ends: tuple[Point, Point]) -> list[SurfaceLoad]:
    """Return traction and pressure on one sub-block's part of the top edge."""
    start, end = np.array(ends[0]), np.array(ends[1])
    loads = []
    if model.load.traction:
        loads.append(SurfaceLoad(number, ends[0], ends[1], (model.load.traction, 0.0)))
    part: tuple[Point, Point] | None = ends
    if model.load.eccentricity != 0:
        part = _overlap(start, end, *pressed_part(*model.block.edge(model.top), model.load.eccentricity))
    if part and model.load.pressure:
        loads.append(SurfaceLoad(number, *part, (0.0, -model.load.pressure)))
    return loads


def _overlap(start: Array, end: Array, low: Array, high: Array) -> tuple[Point, Point] | None:
    """Return the part of the edge start-end between two points of its line, or None."""
    side = end - start
    length2 = float(side @ side)
    first, last = sorted(float((p - start) @ side) / length2 for p in (low, high))
    first, last = max(first, 0.0), min(last, 1.0)
    if not last > first:
        return None
    (x1, y1), (x2, y2) = start + first * side, start + last * side
    return (float(x1), float(y1)), (float(x2), float(y2))
