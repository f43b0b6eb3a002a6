"""The elastic body of the blocks' outline, by `fem`."""

from __future__ import annotations

from typing import TYPE_CHECKING

from validation.models.plane.tables import PlaneSection
from validation.scenes.scene import Scene
from validation.solvers.plane.modelled import PlaneModelled

if TYPE_CHECKING:
    from fem_reference.plane.body import PlaneBody
    from fem_reference.plane.model import PlaneModel

ELEMENTS = 8  # along the shorter side, if the scene does not say: a slender cantilever's tip to 2e-6


class PlaneMesh(PlaneModelled):
    """The elastic body as a mesh."""

    def built(self) -> PlaneModel:
        """Return the elements."""
        return elastic_model(self.scene, self.plane)

    def highest_frequency(self) -> float:
        """Return the highest natural frequency of the mesh [rad/s]."""
        return float(self.model.highest_frequency())

    def stress_error(self) -> float:
        """Return the error of the mesh's stress."""
        return float(self.model.stress_error())


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
        tractions=plane.tractions,
        stress=plane.stress,
        gravity=plane.gravity,
        elements=ELEMENTS if scene.fem.elements is None else scene.fem.elements,
        degree=scene.fem.degree,
    )


def elastic_model(scene: Scene, plane: PlaneSection) -> PlaneModel:
    """Return the elements of a scene's body."""
    from fem_reference.plane.model import PlaneModel

    return PlaneModel((body_of(scene, plane),))


def points_and_cells(body: PlaneBody) -> tuple[list[list[float]], list[list[int]]]:
    """Return the points [m] and the cells of a body's mesh, for another program."""
    from fem_reference.plane.body import mesh_of

    mesh = mesh_of(body)
    return mesh.p.T.tolist(), mesh.t.T.tolist()
