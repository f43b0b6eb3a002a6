"""Blocks in the plane, drawn in text with what they are beside it."""

from __future__ import annotations

import itertools
import math
import string

import numpy as np

from validation.models.plane.assembly import Assembly
from validation.models.plane.geometry import inside
from validation.models.plane.joints import Segment
from validation.models.plane.tables import PlaneSection
from validation.report.scene.drawing import Rows, TextHooks, across_of, box_rows, height_of
from validation.report.texts import Texts
from validation.scenes.keys import described, stated
from validation.scenes.scene import Scene

TEXTS = Texts(__file__)
ACROSS, MOST_ROWS = 30, 16  # characters and lines of the drawing; a line is as high as two characters are wide
FIXED = "/"
LETTERS = string.ascii_letters


class HOOKS(TextHooks):
    """How blocks in the plane are drawn in text."""

    def rows(self, scene: Scene, width: int | None) -> tuple[int, Rows]:
        """Return how many characters the body is wide, and the drawing's lines with their words."""
        plane = scene.table(PlaneSection)
        return glued_rows(plane) if plane.is_glued else moving_rows(plane)


def glued_rows(plane: PlaneSection) -> tuple[int, Rows]:
    """Return the outline of blocks in the plane with what they are beside it."""
    corners = np.vstack([np.array(polygon) for polygon in plane.polygons])
    wide, high = np.ptp(corners, axis=0)
    slenderness = wide / high
    across = across_of(slenderness)
    cut = TEXTS.text("stated-blocks" if plane.subdivide is None else "cut", plane, len(plane.polygons))
    beside = [TEXTS.text("size", wide, high, cut), TEXTS.text("material", plane), TEXTS.text("glue", plane)]
    if plane.clamp:
        beside.append(f"clamped along {', '.join(_segment(clamp.edge) for clamp in plane.clamp)}")
    if any(plane.stress):
        beside.append(TEXTS.text("stress", plane))
    if any(plane.gravity):
        beside.append(TEXTS.text("gravity", *plane.gravity))
    beside += [TEXTS.text("traction", *traction, _segment(edge)) for edge, traction in plane.tractions]
    return across, box_rows(across, height_of(across, slenderness), beside)


def _segment(edge: Segment) -> str:
    return " to ".join(f"({x:g}, {y:g})" for x, y in edge)


def moving_rows(plane: PlaneSection) -> tuple[int, Rows]:
    """Return how many characters the drawing is wide, and its lines with words beside them."""
    assembly = plane.assembly
    art = _raster(assembly)
    rows = itertools.zip_longest(art, _words(plane, assembly), fillvalue="")
    return ACROSS, [(f"  {line}", text) for line, text in rows]


def _raster(assembly: Assembly) -> list[str]:
    """Return lines in which each character is a block: that at the middle of its cell."""
    corners = np.vstack([np.array(block.vertices) for block in assembly.blocks])
    low, size = corners.min(axis=0), np.ptp(corners, axis=0)
    cell = max(size[0] / ACROSS, size[1] / (2 * MOST_ROWS))
    columns, lines = max(1, round(size[0] / cell)), max(1, round(size[1] / (2 * cell)))
    x, y = np.meshgrid(np.arange(columns) + 0.5, np.arange(lines) + 0.5)
    places = low + size * np.column_stack([x.ravel() / columns, y.ravel() / lines])
    cells = np.full(len(places), " ")
    for block, letter in zip(assembly.blocks, letters(assembly), strict=True):
        cells[inside(places, block.vertices)] = letter
    return ["".join(line) for line in cells.reshape(lines, columns)[::-1]]


def letters(assembly: Assembly) -> list[str]:
    """Return the character that each block is drawn by; after fifty-two of them they repeat."""
    moving = itertools.cycle(LETTERS)
    return [FIXED if block.fixed else next(moving) for block in assembly.blocks]


def _words(plane: PlaneSection, assembly: Assembly) -> list[str]:
    """Return what the blocks are, what joins them and what drives them, a line each."""
    moving = [block for block in assembly.blocks if not block.fixed]
    legend = zip(assembly.blocks, letters(assembly), strict=True)
    names = ", ".join(f"{letter} {block.name}" for block, letter in legend) if len(moving) <= MOST_ROWS // 2 else ""
    material = "rigid" if math.isinf(plane.young) else TEXTS.text("elastic", plane)
    lines = [names, TEXTS.text("blocks", len(moving), len(assembly.blocks) - len(moving), plane.density, material)]
    if plane.contact is not None:
        keys = ", ".join(described(name, value, key) for name, value, key in stated(plane.contact))
        lines += [TEXTS.text("stated" if plane.touch else "found", len(plane.touch)), f"  {keys}"]
    for pair in plane.pair:
        keys = ", ".join(described(name, value, key) for name, value, key in stated(pair) if name != "blocks")
        lines.append(f"  {' and '.join(pair.blocks)}: {keys}")
    if assembly.bonds:
        lines.append(TEXTS.text("bonds", len(assembly.bonds)))
    if any(plane.gravity):
        lines.append(TEXTS.text("gravity", *plane.gravity) + (TEXTS.text("ramp", plane.ramp) if plane.ramp else ""))
    for load in plane.load:
        where = load.block or "the outline"
        vector = load.traction if load.force is None else load.force
        lines.append(TEXTS.text("force" if load.force else "traction", *(vector or (0.0, 0.0)), where))
    for block in moving[: MOST_ROWS // 2]:
        if block.spin or any(block.velocity):
            lines.append(TEXTS.text("velocity", block.name, *block.velocity, block.spin))
    return [line for line in lines if line]
