r"""Response of a column to a steady vibration, without a step, and its highest natural frequency.

With V = S D and A = -W2 D of one frequency (`dda.scheme.harmonic`) the equations are (K + S C - W2 M) D = F. A base of
prescribed motion has its own acceleration -w^2 y, whatever the scheme makes of the others.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Literal

import numpy as np
from numpy.typing import ArrayLike

from dda.column.column import Column
from dda.column.equations import equations
from dda.column.stepping import DISPLACEMENT, PRESSURE, Loading, observers
from dda.scheme.harmonic import Complex, Elimination, acceleration_share, chosen, largest_frequency
from dda.scheme.newmark import Scheme

Driven = Literal["base", "top"]


def column_response(
    column: Column,
    scheme: Scheme,
    frequencies: ArrayLike,
    at: Driven,
    columns: Sequence[str] = (DISPLACEMENT, PRESSURE),
    exact: bool = False,
) -> dict[str, Complex]:
    """Return the complex amplitudes of columns of a history.

    Parameters
    ----------
    frequencies : (n,) array_like
        Of the drive [Hz].
    at : str
        ``base``: per metre of the base's displacement, or above a half-space of that of the wave that comes up;
        ``top``: per pascal of pressure on the top.
    exact : bool
        As the system that is exact in time answers.

    Raises
    ------
    ValueError
        If gg = 0 has no limit that is exact in time.
    """
    w = 2 * np.pi * np.atleast_1d(np.asarray(frequencies, float))
    W2, S = chosen(scheme, frequencies, exact)
    accelerations = W2 if exact or not scheme.averages else W2 * acceleration_share(scheme, w)
    system = equations(column)
    loading = Loading(system)
    rows = observers(system, columns, ())
    drive = np.zeros((len(w), 4), complex)
    drive[:, :3] = np.stack([np.ones_like(w), 1j * w, -w * w], axis=1) if at == "base" else 0.0
    drive[:, 3] = at == "top"
    driven = drive @ loading.prescribed(rows).T
    by_D, by_V, by_A = loading.free(rows)
    elimination = Elimination(loading.K, loading.M, loading.C)
    for i, (w2, s, a) in enumerate(zip(W2, S, accelerations, strict=True)):
        D = elimination.solve(loading.push @ drive[i], w2, s)
        driven[i] += by_D @ D + s * (by_V @ D) - a * (by_A @ D)
    return dict(zip(columns, driven.T, strict=True))


def highest_frequency(column: Column) -> float:
    """Return the highest natural frequency [rad/s] with all springs closed, which limits an explicit scheme.

    Rigid contacts that may open or slip are left out: they only lower it. So is the dashpot of a half-space, which
    leaves the foot of a column free, or a spring below it on a base at rest.

    Raises
    ------
    OverflowError
        If mass or stiffness leave the range of double precision.
    """
    system = equations(column)
    first = int(system.prescribed or column.springs[0] is not None)
    return largest_frequency(system.K[first:, first:], system.M[first:, first:])
