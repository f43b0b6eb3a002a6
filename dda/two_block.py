"""The two-block model: one block on locked springs above a fixed base, pressed from above."""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from dda.block import Block
from dda.contact import Contact, contact_stiffness
from dda.gap_form import GapForm, gap_form

Array = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class TwoBlockModel:
    """Block A on block B: springs at both ends of the base edge, pressure on the top edge.

    Edge i runs from corner i to corner i + 1. The pressure acts vertically downwards
    (global -y) whatever the direction of the top edge. The model is linear,
    M D'' + K D = F, in D = (u, v, r, ex, ey, gxy).

    Raises
    ------
    ValueError
        If the pressure is not finite, or base and top are not two edges of the block.
    """

    block: Block
    contact: Contact
    pressure: float  # q [Pa]
    base: int = 0  # edge on the springs
    top: int = 2  # edge under pressure

    def __post_init__(self) -> None:
        """Check the load and the edges."""
        if not math.isfinite(self.pressure):
            raise ValueError(f"pressure: must be finite, got {self.pressure!r}")
        n = len(self.block.corners)
        for field in ("base", "top"):
            value = getattr(self, field)
            if not 0 <= value < n:
                raise ValueError(f"{field}: must be an edge between 0 and {n - 1}, got {value!r}")
        if self.base == self.top:
            raise ValueError(f"top: must differ from base, got {self.top!r}")

    @cached_property
    def mass(self) -> Array:
        """Inertia matrix M in D, 6 x 6, eq. (16) corrected."""
        return self.block.mass()

    @cached_property
    def stiffness(self) -> Array:
        """Stiffness matrix K in D, 6 x 6: elastic (21) corrected plus springs (27)."""
        return self.block.elastic() + contact_stiffness(self.block, self.contact, self.base)

    @cached_property
    def load(self) -> Array:
        """Load F in D, 6 entries, eq. (29) with (0, -q)."""
        return self.block.edge_load(self.top, (0.0, -self.pressure))

    @cached_property
    def gap_form(self) -> GapForm:
        """The same model under unit pressure in contact-gap coordinates, all six unknowns."""
        return gap_form(self.block, self.contact, self.base, self.top)

    def static(self) -> dict[str, float]:
        """Return the static value of every column, under the full pressure."""
        form = self.gap_form
        x = form.F / form.K
        return {name: float(row @ x) * self.pressure + 0.0 for name, row in form.observers.items()}
