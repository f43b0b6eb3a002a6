"""What a page makes of the samples that `validation.gallery.histories` packs."""

from __future__ import annotations

import base64

import numpy as np

from validation.gallery.histories import NONE, STEPS
from validation.runs.history import Array


def unpacked(low: float, high: float, text: str) -> Array:
    """Return the values that `packed` stored, NaN for none."""
    numbers = np.frombuffer(base64.b64decode(text), "<u2").astype(float)
    values = low * (1 - numbers / STEPS) + high * (numbers / STEPS)
    return np.where(numbers == NONE, np.nan, values)
