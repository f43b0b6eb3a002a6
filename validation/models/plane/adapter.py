"""Blocks in the plane by `dda`."""

from __future__ import annotations

import dda
from validation.models.plane.tables import PlaneSection
from validation.scenes.scene import Scene
from validation.solvers.contract import Prepared
from validation.solvers.dda import AdapterHooks
from validation.solvers.plane.blocks import PlaneBlocks


class HOOKS(AdapterHooks):
    """How `dda` takes blocks in the plane."""

    def build(self, scene: Scene, scheme: dda.Scheme, full: bool) -> Prepared:
        """Build glued blocks."""
        return PlaneBlocks(scene, scene.table(PlaneSection), scheme)
