"""Response of the two-block model to a steady vibration, mode by mode, without a step."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import ArrayLike

from dda.one_block.natural_modes import modal_form
from dda.one_block.solution import check_request
from dda.one_block.two_block import TwoBlockModel
from dda.scheme.harmonic import Complex, answering
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
    W2, factor = answering(scheme, frequencies, exact)
    modal = modal_form(model.gap_form.reduced())
    rows = np.array([model.gap_form.reduced().observers[name] @ modal.shapes for name in columns])
    apart = modal.frequencies[:, None] ** 2 - W2
    if along is None:
        amplitudes = rows @ ((modal.load * model.load_size)[:, None] / apart) * factor
    else:
        amplitudes = rows @ ((modal.translation @ along)[:, None] * (W2 / apart))
        amplitudes += np.array([along[_OWN[name]] if name in _OWN else 0.0 for name in columns])[:, None]
    return dict(zip(columns, amplitudes, strict=True))
