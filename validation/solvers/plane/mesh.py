"""The elastic body of the blocks' outline, by `fem`."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING

from validation.runs.history import DISPLACEMENT, STRESS_ERROR
from validation.runs.modes import Mode
from validation.runs.run import Run
from validation.scenes.plane import PlaneSection
from validation.scenes.scene import Scene
from validation.solvers.contract import Prepared
from validation.solvers.plane.observed import MODES, observed_row
from validation.solvers.translation import naming, to_run

if TYPE_CHECKING:
    import fem_reference
    from fem_reference.plane.body import PlaneBody
    from fem_reference.plane.model import PlaneModel

ELEMENTS = 8  # along the shorter side, if the scene does not say: a slender cantilever's tip to 2e-6


class PlaneMesh(Prepared):
    """The elastic body of the blocks' outline, by `fem`."""

    def __init__(self, scene: Scene, plane: PlaneSection, scheme: fem_reference.Scheme) -> None:
        self.scene = scene
        self.plane = plane
        self.scheme = scheme
        with naming(scene):
            self.model = elastic_model(scene, plane)
            self.row = observed_row(plane, self.model.observer)

    def highest_frequency(self) -> float:
        """Return the highest natural frequency of the mesh [rad/s]."""
        return self.model.highest_frequency()

    def history_run(self) -> Run:
        """Step the mesh from rest."""
        result = self.model.history(self.scheme, self.scene.time.steps, self.row[None])
        return to_run(self.scene, result, {DISPLACEMENT: result.columns["0"]})

    def static(self) -> Mapping[str, float]:
        """Return displacement and stress error at rest."""
        with naming(self.scene):
            values = {DISPLACEMENT: float(self.row @ self.model.rest)}
            if any(self.plane.stress):
                values[STRESS_ERROR] = self.model.stress_error()
        return values

    def modes(self) -> tuple[Mode, ...]:
        """Return the lowest modes, the one with the largest share of the static response first."""
        modes = sorted(self.model.modes(self.scheme, MODES), key=lambda mode: -mode.share)
        return tuple(
            Mode(mode.frequency, mode.share, (complex(mode.eigenvalues[0]), complex(mode.eigenvalues[1])))
            for mode in modes
        )


def body_of(scene: Scene, plane: PlaneSection) -> PlaneBody:
    """Return the elastic body of a scene's blocks."""
    from fem_reference.plane.body import PlaneBody

    return PlaneBody(
        polygons=plane.outline_polygons,
        density=plane.density,
        young=plane.young,
        poisson=plane.poisson,
        hypothesis=plane.hypothesis,
        rectangle=plane.rectangle is not None,
        clamps=tuple(clamp.edge for clamp in plane.clamp),
        tractions=tuple((load.edge, load.traction) for load in plane.load),
        stress=plane.stress,
        gravity=plane.gravity,
        elements=ELEMENTS if scene.fem.elements is None else scene.fem.elements,
        degree=scene.fem.degree,
    )


def elastic_model(scene: Scene, plane: PlaneSection) -> PlaneModel:
    """Return the elements of a scene's body."""
    from fem_reference.plane.model import PlaneModel

    return PlaneModel(body_of(scene, plane))


def points_and_cells(body: PlaneBody) -> tuple[list[list[float]], list[list[int]]]:
    """Return the points [m] and the cells of a body's mesh, for another program."""
    from fem_reference.plane.body import mesh_of

    mesh = mesh_of(body)
    return mesh.p.T.tolist(), mesh.t.T.tolist()
