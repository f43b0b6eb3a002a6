"""Waves in the histories of a column: wavenumber, what a joint lets through, what a base sends back.

All rests on the spectrum of pulses that have come and gone (`validation.metrics.transform`): at each frequency the
steps' own law holds without a transient, and a field is one wave up and one wave down.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from validation.metrics.transform import spectrum
from validation.runs.history import History
from validation.scenes.scene import Scene
from validation.solvers.columns.names import column_of
from validation.theory import waves
from validation.theory.stepping import Stepping


@dataclass(frozen=True)
class Guide:
    """A column of like blocks, its closed forms and its histories at one frequency."""

    column: waves.Column
    speed: float  # of waves in the continuum [m/s]
    impedance: float  # rho c [Pa s/m]
    stepping: Stepping
    omega: float  # [rad/s]

    @classmethod
    def of(cls, scene: Scene, blocks: float) -> Guide:
        """Return the guide of a scene at so many blocks a wavelength of the continuum."""
        section = column_of(scene)
        layer = section.layer[0]
        height = layer.thickness / layer.blocks
        modulus = section.modulus(layer)
        column = waves.Column(height, layer.density, modulus, section.glue)
        speed = (modulus / layer.density) ** 0.5
        omega = 2 * np.pi * speed / (blocks * height)
        return cls(column, speed, layer.density * speed, Stepping.of(scene), omega)

    @property
    def wavenumber(self) -> complex:
        """Wavenumber of the closed form [rad/m]."""
        return complex(self.column.wavenumber(self.stepping.squared_frequency(self.omega)))

    def speed_error_and_share(self, k: complex, wavelengths: float = 10.0) -> tuple[float, float]:
        """Return the error of a wavenumber's phase speed, and the share left after some wavelengths."""
        distance = wavelengths * 2 * np.pi * self.speed / self.omega
        return self.omega / k.real / self.speed - 1, float(np.exp(-abs(k.imag) * distance))

    def amplitudes(self, history: History, names: Sequence[str]) -> list[complex]:
        """Return the spectrum of columns at the frequency."""
        return [complex(spectrum(history.time, history.columns[name], self.omega)) for name in names]

    def measured(self, history: History, names: Sequence[str]) -> complex:
        """Return k from three equal steps along the column, x- + x+ = 2 cos(kh) x [rad/m]."""
        low, middle, high = self.amplitudes(history, names)
        sine = np.sqrt((2 * middle - low - high) / middle) / 2
        return complex(2 * np.arcsin(sine) / self.column.height)

    def parts(self, history: History, names: Sequence[str], heights: ArrayLike) -> tuple[complex, complex]:
        """Return the waves up and down, from two columns at heights above where they are wanted."""
        values = self.amplitudes(history, names)
        turns = np.exp(-1j * self.wavenumber * np.asarray(heights, float))
        up, down = np.linalg.solve(np.column_stack([turns, 1 / turns]), values)
        return complex(up), complex(down)


def joint_parts(guide: Guide, scene: Scene, history: History) -> tuple[complex, complex]:
    """Return (T, R) of the joint of a column from two columns of the history below it and two above.

    Waves come from below (the pulse) and from above (its echo from the top): those that leave the joint are T and R
    times those that meet it, alike from both sides.
    """
    section = column_of(scene)
    apart = np.asarray(section.heights) - section.joint[0].height
    names = [f"displacement_{number + 1}" for number in range(4)]
    up, back = guide.parts(history, names[:2], apart[:2])
    through, down = guide.parts(history, names[2:], apart[2:])
    transmitted, reflected = np.linalg.solve([[up, down], [down, up]], [through, back])
    return complex(transmitted), complex(reflected)
