"""What of a block may be wrong in a program."""

from __future__ import annotations

from collections.abc import Iterator

from validation.diagnosis.answer import Answer
from validation.diagnosis.hooks import DiagnosisHooks
from validation.diagnosis.judgement import check_block, judged_block
from validation.diagnosis.numbers import CandidateChange, Number, laws, numbers_of_block
from validation.diagnosis.reading import Foreign
from validation.scenes.scene import Scene


class HOOKS(DiagnosisHooks):
    """Outline, material, springs, friction and loads of a block."""

    def numbers(self, scene: Scene) -> Iterator[Number]:
        """Yield material, size, springs and friction."""
        return numbers_of_block(scene)

    def laws(self, scene: Scene) -> Iterator[CandidateChange]:
        """Yield contact that opens or does not, and what may be forgotten."""
        return laws(scene)

    def judged(self, scene: Scene, foreign: Foreign, tolerance: float) -> Answer:
        """Judge a history of displacement, and of pressure where it has it."""
        return judged_block(scene, foreign, tolerance)

    def check(self, scene: Scene) -> None:
        """Refuse outlines, loads and schemes that `compare` does not step."""
        check_block(scene)
