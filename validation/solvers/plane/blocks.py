"""Blocks in the plane by `dda`."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

import dda
from validation.runs.history import STRESSES, Array
from validation.solvers.plane.modelled import PlaneModelled


class PlaneBlocks(PlaneModelled):
    """The blocks themselves."""

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
                [dda.Traction(*edge, traction) for edge, traction in plane.tractions],
                plane.stress,
                plane.gravity,
            )
        )

    def highest_frequency(self) -> float:
        """Return the highest natural frequency, joints included [rad/s]."""
        return dda.highest_frequency(self.model.system)

    def stress_error(self) -> float:
        """Return the error of the blocks' stress."""
        error = abs(self.stresses() - np.array(self.plane.stress))
        return float(np.max(error) / np.max(np.abs(self.plane.stress)))

    def stresses(self) -> Array:
        """Return s_xx, s_yy, s_xy of each block at rest [Pa], shape (blocks, 3)."""
        stresses: Array = self.model.strains @ self.model.system.blocks[0].material.elasticity().T
        return stresses

    def static(self) -> Mapping[str, float]:
        """Return displacement, stress error and the stress where it is observed, at rest."""
        values = dict(super().static())
        if self.plane.observed.stress is not None:
            mean = np.mean(self.stresses()[self.plane.stressed_blocks], axis=0)
            values |= zip(STRESSES, mean.tolist(), strict=True)
        return values


def first_contact(
    outlines: tuple[Array, Array], motions: tuple[tuple[float, ...], tuple[float, ...]], until: float
) -> dda.FirstContact | None:
    """Return the first contact of two polygons in uniform motion as `dda` has it, None where there is none.

    Outlines are corners about their own origins [m]; a motion is place [m], angle [rad], velocity [m/s] and spin
    [rad/s]; `until` is the last instant that is looked at [s].
    """
    return dda.first_contact(outlines[0], outlines[1], motions[0], motions[1], until)
