r"""The bar on a spring under a pressure that vibrates, exact in space.

With theta = h sqrt(rho W2 / E), kappa = k h / (E W) and y from the base the bar moves as

    v(y) = -(q h / E) [cos(theta y / h) + (kappa / theta) sin(theta y / h)] / (kappa cos theta - theta sin theta)

and presses on its base with q kappa / (kappa cos theta - theta sin theta). Numerator and denominator are taken times
exp(-i theta), Im theta <= 0, so that nothing overflows where the wave has died on its way.
"""

from __future__ import annotations

import numpy as np

from fem_reference.exact.bar import Bar
from fem_reference.problem.problem import Array, Scheme
from fem_reference.scheme.harmonic import Complex, answering


def response(
    bar: Bar,
    scheme: Scheme,
    frequencies: Array,
    columns: tuple[str, ...] = ("displacement", "contact_pressure"),
    exact: bool = False,
) -> dict[str, Complex]:
    """Complex amplitudes of the columns under the bar's pressure at frequencies in Hz, stepped or exact in time.

    Raises
    ------
    ValueError
        If gg = 0 where the response that is exact in time is asked for.
    """
    parts = answering(frequencies, scheme, exact)
    amplitudes = [(factor, _undamped(bar, W2)) for W2, factor in parts]
    return {name: np.asarray(sum(factor * part[name] for factor, part in amplitudes)) for name in columns}


def _undamped(bar: Bar, W2: Complex) -> dict[str, Complex]:
    """Amplitudes of all columns at squared frequencies W2."""
    root = bar.travel * np.sqrt(W2)
    theta: Complex = np.where(root.imag > 0, -root, root)
    whole = np.exp(-1j * theta)
    cosine = (1 + whole**2) / 2
    sine = theta * _sine(theta, whole**2)
    below = bar.kappa * cosine - theta * sine
    half = np.exp(-0.5j * theta)
    middle = half * ((1 + whole) / 2 + bar.kappa / 2 * _sine(theta / 2, whole))
    with np.errstate(divide="ignore", invalid="ignore"):
        return {
            "displacement": -bar.pressure * bar.height / bar.young * middle / below,
            "contact_pressure": bar.pressure * bar.kappa * whole / below,
            "horizontal_displacement": np.zeros_like(theta),
        }


def _sine(theta: Complex, square: Complex) -> Complex:
    """exp(-i theta) sin(theta) / theta, where `square` is exp(-2 i theta)."""
    small = np.abs(theta) < 1e-4
    safe = np.where(small, 1.0, theta)
    near = np.exp(-1j * theta) * (1 - theta * theta / 6)
    return np.asarray(np.where(small, near, (1 - square) / (2j * safe)))
