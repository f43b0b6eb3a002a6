"""Rigid boxes in the solvers of several kinds."""

from __future__ import annotations

from validation.models.rigid.tables import RigidSection
from validation.scenes.scene import Scene
from validation.solvers.contract import Prepared
from validation.solvers.hooks import SolvingHooks

# s of a case of which a study has dozens, and s more for each second of motion, box and halving of the step: the
# slowest program takes some 0.5 s for it on a core of its own
TIME_LIMIT = 60.0
TIME_FACTOR = 3.0


class HOOKS(SolvingHooks):
    """Boxes that are alone, or at rest on each other, as blocks on springs by `dda`."""

    def refusal(self, scene: Scene, solver: str) -> str | None:
        """Return None, or why DDA cannot express rigid boxes.

        Springs give back what they took, less what the scheme damps: that is restitution 1. A lower one cannot be set,
        and is refused where a box falls.
        """
        rigid = scene.table(RigidSection)
        if rigid.restitution < 1 and rigid.stiffness is None and any(box.lift for box in rigid.box):
            why = "DDA has no coefficient of restitution below 1: its springs give back everything"
            return f"{why}, got {rigid.restitution:g}"
        if len(rigid.box) == 1:
            return None
        if any(box.lift or box.spin or any(box.velocity) for box in rigid.box) or rigid.slope or rigid.base_amplitude:
            return "several boxes are a column of blocks: at rest, on level ground that does not move"
        if len({(box.width, box.x) for box in rigid.box}) > 1:
            return "several boxes are a column of blocks: of one width, above each other"
        return None

    def build(self, scene: Scene, solver: str, full: bool) -> Prepared | None:
        """Return blocks on springs."""
        from validation.models.rigid.blocks import BlocksOfBoxes
        from validation.solvers.dda import scheme_of

        return BlocksOfBoxes(scene, scene.table(RigidSection), scheme_of(scene))

    def time_limit(self, scene: Scene) -> float:
        """Return the time that a user's function may take [s]."""
        rigid = scene.table(RigidSection)
        limit: float = TIME_LIMIT + TIME_FACTOR * scene.time.duration * len(rigid.box) * 2**rigid.refine
        return limit
