"""The blocks themselves, by `dda`."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING

import numpy as np

from validation.runs.history import DISPLACEMENT, STRESS_ERROR
from validation.runs.modes import Mode
from validation.runs.run import Run
from validation.scenes.plane import PlaneSection
from validation.scenes.scene import Scene
from validation.solvers.contract import Prepared
from validation.solvers.plane.observed import MODES, observed_row
from validation.solvers.translation import naming, to_run

if TYPE_CHECKING:
    import dda


class PlaneBlocks(Prepared):
    """The blocks, by `dda`."""

    def __init__(self, scene: Scene, plane: PlaneSection, scheme: dda.Scheme) -> None:
        import dda

        self.scene = scene
        self.plane = plane
        self.scheme = scheme
        with naming(scene):
            material = dda.Material(plane.density, plane.young, plane.poisson, plane.hypothesis)
            self.blocks = dda.GluedBlocks(
                dda.glued_blocks(
                    [dda.Block(polygon, material) for polygon in plane.polygons],
                    plane.glue * plane.young,
                    [clamp.edge for clamp in plane.clamp],
                    plane.clamp_glue * plane.young,
                    [dda.Traction(*load.edge, load.traction) for load in plane.load],
                    plane.stress,
                    plane.gravity,
                )
            )
            self.row = observed_row(plane, self.blocks.observer)

    def highest_frequency(self) -> float:
        """Return the highest natural frequency, joints included [rad/s]."""
        import dda

        return dda.highest_frequency(self.blocks.system)

    def history_run(self) -> Run:
        """Step the blocks from rest."""
        result = self.blocks.history(self.scheme, self.scene.time.steps, self.row[None])
        return to_run(self.scene, result, {DISPLACEMENT: result.columns["0"]})

    def static(self) -> Mapping[str, float]:
        """Return displacement and stress error at rest."""
        with naming(self.scene):
            values = {DISPLACEMENT: float(self.row @ self.blocks.rest.ravel())}
            if any(self.plane.stress):
                values[STRESS_ERROR] = self._stress_error()
        return values

    def _stress_error(self) -> float:
        stresses = self.blocks.strains @ self.blocks.system.blocks[0].material.elasticity().T
        error = abs(stresses - np.array(self.plane.stress))
        return float(np.max(error) / np.max(np.abs(self.plane.stress)))

    def modes(self) -> tuple[Mode, ...]:
        """Return the lowest modes, the one with the largest share of the static response first."""
        modes = sorted(self.blocks.modes(self.scheme, MODES), key=lambda mode: -mode.share)
        return tuple(Mode(mode.frequency, mode.share, mode.eigenvalues[:2]) for mode in modes)
