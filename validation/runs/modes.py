"""Modes of a discrete model and of its one-step operator, and switches of a contact."""

from __future__ import annotations

import cmath
import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np


@dataclass(frozen=True)
class Mode:
    """One mode of a discrete model and of its one-step operator."""

    frequency: float  # natural circular frequency w of (K, M) [rad/s]
    share: float  # (phi'F)^2 / (w^2 F'D_static) of the static response [1]
    eigenvalues: tuple[complex, complex]  # of the one-step operator, those that are not identically zero [1]
    contact_share: float | None = None  # static contact pressure over the applied pressure [1]; None: not reported
    sampled: bool = False  # whether the eigenvalues are of a motion that is exact in time, and of no scheme

    @property
    def spectral_radius(self) -> float:
        """Largest modulus of the eigenvalues [1]."""
        return max(abs(value) for value in self.eigenvalues)

    def alias(self, step: float) -> float | None:
        """Frequency [rad/s] that samples every `step` [s] show of a motion beyond Nyquist's pi / dt, None below it."""
        if not self.sampled or 0 in self.eigenvalues or self.frequency * step <= math.pi:
            return None
        decay = sum(math.log(abs(value)) for value in self.eigenvalues) / 2  # of the motion in a step, negative [1]
        turned = (self.frequency * step) ** 2 - decay**2
        return abs(cmath.log(self.eigenvalues[0])) / step if turned > math.pi**2 else None


def contact_index(modes: Sequence[Mode]) -> int | None:
    """Index of the contact mode: of the modes after the first axial one, that with most of the contact pressure."""
    if len(modes) < 2 or modes[0].contact_share is None:
        return None
    return 1 + int(np.argmax([abs(mode.contact_share or 0.0) for mode in modes[1:]]))


@dataclass(frozen=True)
class Switch:
    """One change of a contact: it opens or closes, or while closed it begins to slip or sticks."""

    time: float  # s
    corner: str
    opens: bool | None  # else it closes; None: it stays closed
    slips: bool | None = None  # else it sticks; None: it opens or closes
