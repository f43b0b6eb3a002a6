"""How to cut what is made of blocks, for its wave or its static answer: run by `dda`, and compared."""

from __future__ import annotations

from validation.advice.goals import Recommendation
from validation.errors import InputError
from validation.scenes.kinds import Hooks
from validation.scenes.scene import Scene


class CutHooks(Hooks):
    """Into how many blocks to cut a scene that is no single block."""

    module = "cuts"

    def recommended(self, scene: Scene, error: float, frequency: float | None = None) -> tuple[str, Recommendation]:
        """Return in words what the present blocks do, and which to take for an error.

        Raises
        ------
        InputError
            Nothing is known of such a scene.
        """
        raise InputError("advise takes scenes of a block only", source=scene.name, value=scene.kind_in_words)
