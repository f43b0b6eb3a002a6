"""What the adapters of blocks in the plane do alike with their models."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from validation.models.plane.tables import PlaneSection
from validation.runs.history import DISPLACEMENT, STRESS_ERROR
from validation.runs.modes import Mode
from validation.runs.run import Run
from validation.scenes.scene import Scene
from validation.solvers.contract import Prepared
from validation.solvers.plane.observed import MODES, observed_row
from validation.solvers.translation import naming, to_modes, to_run


class PlaneModelled(Prepared):
    """Blocks in the plane by a model that steps, rests and vibrates."""

    model: Any  # of a solver package, with `history`, `modes`, `observer` and `rest`

    def __init__(self, scene: Scene, plane: PlaneSection, scheme: Any) -> None:
        self.scene = scene
        self.plane = plane
        self.scheme = scheme
        with naming(scene):
            self.model = self.built()
            self.row = observed_row(plane, self.model.observer)

    def built(self) -> Any:
        """Return the model."""
        raise NotImplementedError

    def stress_error(self) -> float:
        """Return the largest error of a stress component at rest over the largest component of the loads' stress."""
        raise NotImplementedError

    def history_run(self) -> Run:
        """Step the model from rest."""
        result = self.model.history(self.scheme, self.scene.time.steps, self.row[None])
        return to_run(self.scene, result, {DISPLACEMENT: result.columns["0"]})

    def static(self) -> Mapping[str, float]:
        """Return displacement and stress error at rest."""
        with naming(self.scene):
            values = {DISPLACEMENT: float(self.row @ self.model.rest.ravel())}
            if any(self.plane.stress):
                values[STRESS_ERROR] = self.stress_error()
        return values

    def modes(self) -> tuple[Mode, ...]:
        """Return the lowest modes, the one with the largest share of the static response first."""
        return to_modes(sorted(self.model.modes(self.scheme, MODES), key=lambda mode: -mode.share))
