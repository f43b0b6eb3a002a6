"""Blocks in the plane before anything runs: drawn in text, masses, waves of glued ones, contacts of moving ones."""

from __future__ import annotations

import itertools
import math
import string
from collections.abc import Collection, Iterator, Sequence
from pathlib import Path

import numpy as np

from validation.models.plane.assembly import Assembly
from validation.models.plane.geometry import inside
from validation.models.plane.tables import BODIES, PlaneSection, Segment
from validation.report.scene.drawing import body_height, body_width, box_rows
from validation.report.scene.hooks import Number, Numbers, Rows, ShowingHooks
from validation.runs.numbers import short
from validation.runs.texts import Texts
from validation.scenes.keys import described, stated
from validation.scenes.outline import area
from validation.scenes.scene import Scene

TEXTS = Texts(__file__)
ACROSS, MOST_ROWS = 30, 16  # characters and lines of the drawing; a line is as high as two characters are wide
FIXED = "/"
LETTERS = string.ascii_letters


class HOOKS(ShowingHooks):
    """What is said of blocks in the plane."""

    no_data = frozenset({"fem.foundation"})

    def bodies(self, scene: Scene, varied: Collection[str]) -> Iterator[str]:
        """Yield the number of blocks."""
        if not {"plane.block", "plane.subdivide", "plane.plate.cells", "plane.disc.cells"} & {*varied}:
            yield f"{len(scene.table(PlaneSection).polygons)} blocks"

    def drawing(self, scene: Scene, width: int | None) -> tuple[int, Rows]:
        """Return the blocks in text, with what they are beside them."""
        plane = scene.table(PlaneSection)
        if plane.is_glued:
            return _glued_rows(plane)
        assembly = plane.assembly
        rows = itertools.zip_longest(_raster(assembly), _words(plane, assembly), fillvalue="")
        return ACROSS, [(f"  {line}", text) for line, text in rows]

    def springs(self, scenes: Sequence[Scene], numbers: Numbers) -> str:
        """Return the glue."""
        plane = scenes[0].table(PlaneSection)
        return f"Glue of {short(plane.glue)} E at each end of a shared edge." if plane.is_glued else ""

    def first_frequency(self, scene: Scene, of_run: float | None) -> None:
        """Return none: glued blocks are read at rest, and moving ones have no modes."""

    def numbers(self, scene: Scene) -> Iterator[Number]:
        """Yield the numbers of one case."""
        plane = scene.table(PlaneSection)
        return glued_numbers(plane) if plane.is_glued else moving_numbers(plane, scene.time.step)


def _glued_rows(plane: PlaneSection) -> tuple[int, Rows]:
    """Return the outline of blocks in the plane with what they are beside it."""
    wide, high = np.ptp(np.vstack(plane.polygons), axis=0)
    slenderness = wide / high
    across = body_width(slenderness)
    cut = TEXTS.text("stated-blocks" if plane.subdivide is None else "cut", plane, len(plane.polygons))
    beside = [TEXTS.text("size", wide, high, cut), TEXTS.text("material", plane), TEXTS.text("glue", plane)]
    if plane.clamp:
        beside.append(f"clamped along {', '.join(_segment(clamp.edge) for clamp in plane.clamp)}")
    if any(plane.stress):
        beside.append(TEXTS.text("stress", plane))
    if any(plane.gravity):
        beside.append(TEXTS.text("gravity", *plane.gravity))
    beside += [TEXTS.text(name, getattr(plane, name)) for name in BODIES if getattr(plane, name)]
    beside += [TEXTS.text("traction", *load.vector, _segment(load.edge)) for load in plane.load if load.edge]
    return across, box_rows(across, body_height(across, slenderness), beside)


def _segment(edge: Segment) -> str:
    return " to ".join(f"({x:g}, {y:g})" for x, y in edge)


def _raster(assembly: Assembly) -> list[str]:
    """Return lines in which each character is a block: that at the middle of its cell."""
    corners = np.vstack([block.vertices for block in assembly.blocks])
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
    return [FIXED if block.held else next(moving) for block in assembly.blocks]


def _words(plane: PlaneSection, assembly: Assembly) -> list[str]:
    """Return what the blocks are, what joins them and what drives them, a line each."""
    moving = assembly.moving
    legend = zip(assembly.blocks, letters(assembly), strict=True)
    names = ", ".join(f"{letter} {block.name}" for block, letter in legend) if len(moving) <= MOST_ROWS // 2 else ""
    material = "rigid" if math.isinf(plane.young) else TEXTS.text("elastic", plane)
    driven = [block for block in assembly.blocks if block.motion is not None]
    fixed = len(assembly.blocks) - len(moving) - len(driven)
    lines = [names, TEXTS.text("blocks", len(moving), fixed, plane.density, material)]
    lines += [TEXTS.text("driven", block.name, Path(str(block.motion)).name) for block in driven]
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
        lines.append(TEXTS.text("force" if load.force else "traction", *load.vector, where))
    for block in moving[: MOST_ROWS // 2]:
        if block.spin or any(block.velocity):
            lines.append(TEXTS.text("velocity", block.name, *block.velocity, block.spin))
    return [line for line in lines if line]


def glued_numbers(plane: PlaneSection) -> Iterator[Number]:
    """Yield the numbers of glued blocks."""
    size = float(np.max(np.ptp(np.vstack(plane.polygons), axis=0)))
    speed = math.sqrt(plane.young / plane.density)
    yield Number("blocks", len(plane.polygons), "", "blocks of one strain")
    yield Number("m", plane.density * sum(map(area, plane.polygons)), "kg", "mass of all blocks")
    yield Number("c", speed, "m/s", "speed of a wave along a bar, sqrt(E/rho)")
    yield Number("L/c", size / speed, "s", "travel time of the wave along the larger side")


def moving_numbers(plane: PlaneSection, step: float) -> Iterator[Number]:
    """Yield the numbers of moving blocks: a corner of the lightest one on the stiffest spring is the fastest motion."""
    assembly = plane.assembly
    moving = assembly.moving
    masses = [block.mass for block in moving]
    yield Number("blocks", len(moving), "", "blocks that move")
    yield Number("m", sum(masses), "kg", "mass of all that move")
    springs = assembly.all_springs
    if not springs or not masses:
        return
    stiffest = max(contact.stiffness for contact in springs)
    if math.isinf(stiffest):
        return
    if weight := sum(masses) * math.hypot(*plane.gravity):
        softest = min(contact.stiffness for contact in springs)
        yield Number("W/p", weight / softest, "m", "compression of one spring under the weight of all that moves")
    frequency = math.sqrt(stiffest / min(masses))
    yield Number("wc", frequency, "rad/s", "lightest block on the stiffest spring, sqrt(p/m)")
    yield Number("wc dt", frequency * step, "", "times the step; a period takes 2 pi over this many steps")
