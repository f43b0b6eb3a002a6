"""What the room of diagnosis asks of the kind of a scene."""

from __future__ import annotations

from collections.abc import Iterator

from validation.diagnosis.answer import Answer
from validation.diagnosis.numbers import AVERAGE, CandidateChange, Number, Values
from validation.diagnosis.reading import Foreign
from validation.errors import InputError
from validation.scenes.kinds import Hooks
from validation.scenes.scene import Scene


def unread(scene: Scene, value: str) -> InputError:
    """Return the error of a scene whose histories are not explained."""
    rule = "compare takes scenes of a block, or of a column whose contacts open or slip, only"
    return InputError(rule, source=scene.name, value=value)


class DiagnosisHooks(Hooks):
    """What of a scene may be wrong in a program, and how a history of it is judged."""

    module = "diagnosis"

    def numbers(self, scene: Scene) -> Iterator[Number]:
        """Yield the numbers of a scene that may be wrong by a factor, none that is zero or absent."""
        yield from ()

    def numbers_of_layers(self, scene: Scene) -> Iterator[Number]:
        """Yield the densities of layers, where they differ, each by itself."""
        yield from ()

    def laws(self, scene: Scene) -> Iterator[CandidateChange]:
        """Yield the laws of contact that a program may have in place of a scene's, and what it may have forgotten."""
        yield from ()

    def accurate(self, scene: Scene) -> Values:
        """Return a scheme that does not damp, and more blocks where they are many; the step is left to who asks."""
        return dict(AVERAGE)

    def judged(self, scene: Scene, foreign: Foreign, tolerance: float) -> Answer:
        """Judge a history of a scene that `check` lets pass; an `InputError` if it is all zero or does not fit."""
        raise unread(scene, scene.kind_in_words)

    def check(self, scene: Scene) -> None:
        """Refuse by an `InputError` what `compare` does not step, before anything of it is run."""
        raise unread(scene, scene.kind_in_words)
