"""Locked contact springs between an edge of a block and a fixed base."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from dda.model.arrays import Array, ArrayPair
from dda.model.block import Block
from dda.model.checks import check_positive


@dataclass(frozen=True)
class Contact:
    """Locked corner springs: they neither open nor slide.

    Raises
    ------
    ValueError
        If a stiffness is not finite and positive.
    """

    stiffness: float  # p, of each normal spring [N/m]
    shear_stiffness: float | None = None  # of each shear spring [N/m]; p if absent

    def __post_init__(self) -> None:
        """Check the ranges."""
        check_positive(stiffness=self.stiffness)
        if self.shear_stiffness is not None:
            check_positive(shear_stiffness=self.shear_stiffness)

    @property
    def normal(self) -> float:
        """Stiffness p_n of each normal spring [N/m]."""
        return self.stiffness

    @property
    def shear(self) -> float:
        """Stiffness p_s of each shear spring [N/m]."""
        return self.stiffness if self.shear_stiffness is None else self.shear_stiffness


def base_axes(block: Block, base: int) -> Array:
    """Return unit tangent and unit inward normal of an edge, a row each."""
    start, end = block.edge(base)
    x, y = (end - start) / np.hypot(*(end - start))
    return np.array([[x, y], [-y, x]])


def spring_vectors(block: Block, base: int) -> ArrayPair:
    """Return the spring vectors of eq. (24) and (26) for any base edge.

    Returns
    -------
    normal, shear : (2, 6) arrays
        Rows for the edge's first end M and second end N; a row times D is the spring's stretch [m].
    """
    tangent, normal = base_axes(block, base)
    T = [block.T(*end) for end in block.edge(base)]
    return np.array([normal @ t for t in T]), np.array([tangent @ t for t in T])


def contact_stiffness(block: Block, contact: Contact, base: int) -> Array:
    """Return the 6 x 6 spring stiffness, eq. (27), for any base edge."""
    normal, shear = spring_vectors(block, base)
    return contact.normal * normal.T @ normal + contact.shear * shear.T @ shear
