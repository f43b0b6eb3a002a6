"""What of a column may be wrong in a program."""

from __future__ import annotations

from collections.abc import Iterator

from validation.diagnosis.answer import Answer
from validation.diagnosis.columns import compare_column, laws
from validation.diagnosis.hooks import DiagnosisHooks, unread
from validation.diagnosis.numbers import (
    CandidateChange,
    Number,
    Values,
    numbers_of_column,
    numbers_of_layers,
    with_more_blocks,
)
from validation.diagnosis.reading import Foreign
from validation.scenes.scene import Scene


class HOOKS(DiagnosisHooks):
    """Layers, contacts and the input of a column."""

    def numbers(self, scene: Scene) -> Iterator[Number]:
        """Yield material, contacts, input and base."""
        return numbers_of_column(scene)

    def numbers_of_layers(self, scene: Scene) -> Iterator[Number]:
        """Yield the densities of layers, where they differ."""
        return numbers_of_layers(scene)

    def laws(self, scene: Scene) -> Iterator[CandidateChange]:
        """Yield contacts that hold or are not there, and what may be forgotten; none of a bonded column."""
        yield from () if scene.column.law == "bonded" else laws(scene)

    def accurate(self, scene: Scene) -> Values:
        """Return average acceleration and more blocks in each layer."""
        return with_more_blocks(scene)

    def check(self, scene: Scene) -> None:
        """Refuse a bonded column, which is judged by its wave."""
        if scene.column.law == "bonded":
            raise unread(scene, "one with a bonded column")

    def judged(self, scene: Scene, foreign: Foreign, tolerance: float) -> Answer:
        """Judge a history of the contacts of a column."""
        return compare_column(scene, foreign, tolerance)
