"""The spectrum of a history that has come and gone: its sum with e^{-iwt}, which obeys every law of the steps."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray

from validation.runs.history import Array

Complex = NDArray[np.complex128]


def spectrum(time: Array, values: Array, omega: ArrayLike) -> Complex:
    """Return the sum of the values, shape (..., steps), times e^{-i w t} at angular frequencies w [rad/s].

    Of a history that begins and ends at rest, from before the load to after the last wave, this sum satisfies the
    steps' recurrence with z = e^{iw dt} exactly: it is the steady amplitude at w, and no transient is in it.
    """
    return np.asarray(np.asarray(values) @ np.exp(-1j * np.multiply.outer(time, np.asarray(omega, float))))
