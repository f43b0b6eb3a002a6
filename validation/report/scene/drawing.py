"""The model of a scene, drawn in text with its parameters beside it."""

from __future__ import annotations

from collections.abc import Iterator

from validation.report.scene.hooks import Rows, ShowingHooks
from validation.scenes.scene import Scene

INSIDE = 15  # characters of a block's width in the drawing
NARROWEST = 5  # the same of a tall block
BESIDE = 7  # characters of a line of the drawing besides the block's width, before its text


def drawing(scene: Scene, width: int | None) -> Iterator[str]:
    """Yield the model of a scene, drawn in text."""
    across, rows = ShowingHooks.of(scene).drawing(scene, width)
    for art, words in rows:
        yield (art.ljust(across + BESIDE) + words).rstrip()


def body_width(slenderness: float) -> int:
    """Return the characters of a body across; a tall one has fewer."""
    return INSIDE if slenderness >= 0.5 else max(NARROWEST, round(2 * INSIDE * slenderness))


def box_rows(across: int, height: int, beside: list[str]) -> Rows:
    """Return a box of so many characters and rows, words beside its first rows."""
    edge = (f"  +{'-' * across}+", "")
    inside = [(f"  |{' ' * across}|", text) for text in (*beside, *[""] * (height - len(beside)))]
    return [edge, *inside, edge]


def body_height(across: int, slenderness: float) -> int:
    """Return the rows inside a body; a row is as high as two columns are wide."""
    return min(max(3, round(across / slenderness / 2)), INSIDE // 2)
