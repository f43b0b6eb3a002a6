"""Adapters of glued blocks in the plane: `dda` takes the blocks, `fem` the elastic body of their outline."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import TYPE_CHECKING, Any

import numpy as np

import dda
import fem_reference
from validation.runs.history import DISPLACEMENT, STRESS_ERROR, Array
from validation.runs.modes import Mode
from validation.runs.run import Run
from validation.scenes.plane import PlaneSection, Point
from validation.scenes.scene import Scene
from validation.solvers.contract import Prepared
from validation.solvers.translation import naming, to_modes, to_run

if TYPE_CHECKING:
    from fem_reference.plane.body import PlaneBody
    from fem_reference.plane.model import PlaneModel

MODES = 4  # that are reported
ELEMENTS = 8  # along the shorter side, if the scene does not say: a slender cantilever's tip to 2e-6


class PlaneModelled(Prepared):
    """Blocks in the plane by a model that steps, rests and vibrates."""

    model: Any  # of a solver package, with `history`, `modes`, `observer` and `rest`

    def __init__(self, scene: Scene, plane: PlaneSection, scheme: dda.Scheme | fem_reference.Scheme) -> None:
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


class PlaneBlocks(PlaneModelled):
    """The blocks, by `dda`."""

    def built(self) -> dda.GluedBlocks:
        """Return the blocks."""
        plane = self.plane
        material = dda.Material(plane.density, plane.young, plane.poisson, plane.hypothesis)
        return dda.GluedBlocks(
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

    def highest_frequency(self) -> float:
        """Return the highest natural frequency, joints included [rad/s]."""
        return dda.highest_frequency(self.model.system)

    def stress_error(self) -> float:
        """Return the largest error of a stress component at rest over the largest component of the loads' stress."""
        stresses = self.model.strains @ self.model.system.blocks[0].material.elasticity().T
        error = abs(stresses - np.array(self.plane.stress))
        return float(np.max(error) / np.max(np.abs(self.plane.stress)))


class PlaneMesh(PlaneModelled):
    """The elastic body of the blocks' outline, by `fem`."""

    def built(self) -> PlaneModel:
        """Return the elements."""
        return elastic_model(self.scene, self.plane)

    def highest_frequency(self) -> float:
        """Return the highest natural frequency of the mesh [rad/s]."""
        return float(self.model.highest_frequency())

    def stress_error(self) -> float:
        """Return the largest error of a stress component at rest over the largest component of the loads' stress."""
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


def observed_row(plane: PlaneSection, observer: Callable[[Point, Point], Array]) -> Array:
    """Return the row of the displacement that a scene observes."""
    observe = plane.observe
    rows = observer(*observe.place)
    for edge in observe.less:
        rows = rows - observer(*edge) / len(observe.less)
    return np.array(observe.direction) @ rows
