"""Response of the two-block model to a steady vibration, mode by mode, without a step."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import ArrayLike

from dda.model.arrays import Array
from dda.one_block.natural_modes import modal_form
from dda.one_block.solution import check_request
from dda.one_block.two_block import TwoBlockModel
from dda.scheme.harmonic import Complex, answering, staged_amplitude
from dda.scheme.newmark import Scheme

_OWN = {"horizontal_displacement": 0, "displacement": 1}  # what a moving base adds to the columns


def response(
    model: TwoBlockModel,
    scheme: Scheme,
    frequencies: ArrayLike,
    columns: Sequence[str] = ("displacement", "contact_pressure"),
    along: tuple[float, float] | None = None,
    exact: bool = False,
) -> dict[str, Complex]:
    """Return the complex amplitudes of the columns, (K - W2 M) D = F in the model's own modes.

    Parameters
    ----------
    frequencies : (n,) array_like
        Of the load [Hz].
    along : pair of float
        The base moves along this vector with an amplitude of its length [m], and no load acts; None: the loads act
        with their own amplitudes, all in phase.
    exact : bool
        As the system that is exact in time answers, not as the scheme steps it.

    Raises
    ------
    ValueError
        If a column is unknown, or gg = 0 has no limit that is exact in time.
    """
    check_request(1, columns)
    modal = modal_form(model.gap_form.reduced())
    rows = np.array([model.gap_form.reduced().observers[name] @ modal.shapes for name in columns])
    if len(scheme.stages) > 1 and not exact:
        omega = 2 * np.pi * np.atleast_1d(np.asarray(frequencies, float))
        loads = scheme.step**2 * modal.load * (model.load_size if along is None else 0.0)
        carried = np.zeros_like(loads) if along is None else modal.translation @ along
        squares = (scheme.step * modal.frequencies) ** 2
        parts = zip(squares.tolist(), loads.tolist(), carried.tolist(), strict=True)
        amplitudes = rows @ np.array([staged_amplitude(scheme, omega, *part) for part in parts])
        return dict(zip(columns, amplitudes + _of_base(columns, along), strict=True))
    W2, factor = answering(scheme, frequencies, exact)
    apart = modal.frequencies[:, None] ** 2 - W2
    if along is None:
        amplitudes = rows @ ((modal.load * model.load_size)[:, None] / apart) * factor
    else:
        amplitudes = rows @ ((modal.translation @ along)[:, None] * (W2 / apart))
        amplitudes += _of_base(columns, along)
    return dict(zip(columns, amplitudes, strict=True))


def _of_base(columns: Sequence[str], along: tuple[float, float] | None) -> Array:
    """Return what a moving base adds to the columns, (columns, 1)."""
    if along is None:
        return np.zeros((len(columns), 1))
    return np.array([along[_OWN[name]] if name in _OWN else 0.0 for name in columns])[:, None]
