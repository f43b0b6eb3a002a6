"""The two-block model: one block on locked springs above a fixed base, pressed from above."""

from __future__ import annotations

import math
from collections.abc import Iterable
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
from numpy.typing import ArrayLike

from dda.bodies.gap_form import GapForm, gap_form
from dda.contact.springs import Contact, contact_stiffness
from dda.model.arrays import Array, Columns
from dda.model.load import BaseMotion, LoadedBlock, directions_of, pressed_part
from dda.result.result import COLUMNS


@dataclass(frozen=True, eq=False, init=False)
class TwoBlockModel(LoadedBlock):
    """Block A on block B: springs at both ends of the base edge, loads on the top edge and on the mass.

    The pressure acts vertically downwards (global -y) whatever the direction of the top edge. The model is linear,
    M D'' + K D = F, in D = (u, v, r, ex, ey, gxy).
    """

    contact: Contact

    @property
    def names(self) -> tuple[str, ...]:
        """Names of all columns."""
        return COLUMNS

    @property
    def motion(self) -> BaseMotion | None:
        """Motion of the base."""
        return self.load.motion

    @property
    def moving(self) -> Array:
        """Whether the base moves in x and in y, 1 or 0 each."""
        return directions_of(self.motion)

    @cached_property
    def load_size(self) -> float:
        """Largest of the constant loads as a stress, gravity as rho g sqrt(area) [Pa]."""
        return self.load.size(self.block.material.density * math.sqrt(self.block.section.area))

    @cached_property
    def mass(self) -> Array:
        """Inertia matrix M in D, 6 x 6, eq. (16) corrected."""
        return self.block.mass()

    @cached_property
    def stiffness(self) -> Array:
        """Stiffness matrix K in D, 6 x 6: elastic (21) corrected plus springs (27)."""
        return self.block.elastic() + contact_stiffness(self.block, self.contact, self.base)

    @cached_property
    def force(self) -> Array:
        """Constant load F in D, 6 entries: eq. (29) with (0, -q), the traction and the weight."""
        pressed = pressed_part(*self.block.edge(self.top), self.load.eccentricity)
        weight = np.zeros(6)
        weight[:2] = self.block.total_mass * self.load.gravity * np.array(self.load.falling)
        traction = self.block.edge_load(self.top, (self.load.traction, 0.0))
        return self.block.segment_load(*pressed, (0.0, -self.load.pressure)) + traction + weight

    @cached_property
    def gap_form(self) -> GapForm:
        """The same model in contact-gap coordinates, all six unknowns, under the load over `load_size`.

        Without a load it is the form under a pressure of 1 Pa.
        """
        load = self.load
        size = self.load_size
        if size:
            unit = replace(
                load, pressure=load.pressure / size, traction=load.traction / size, gravity=load.gravity / size
            )
        else:
            unit = replace(load, pressure=1.0, traction=0.0, gravity=0.0)
        return gap_form(self.block, self.contact, self.base, self.top, unit)

    @property
    def equations(self) -> GapForm:
        """The equations in all six unknowns."""
        return self.gap_form

    @cached_property
    def reached(self) -> GapForm:
        """The equations without the unknowns that the load cannot reach."""
        return self.gap_form.reduced()


def carried(motion: BaseMotion | None, instants: ArrayLike, names: Iterable[str]) -> Columns:
    """Return what a moving base adds to columns of some names: its own displacement [m]."""
    if motion is None:
        return {}
    records = zip(("horizontal_displacement", "displacement"), np.transpose(motion.displacement), strict=True)
    return {name: np.interp(instants, motion.time, record) for name, record in records if name in names}
