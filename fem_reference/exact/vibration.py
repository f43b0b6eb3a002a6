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

    Exact in time gg = 0 is a `ValueError`.
    """
    W2, factor = np.array(answering(frequencies, scheme, exact)).swapaxes(0, 1)
    root = bar.travel * np.sqrt(W2)
    theta = np.where(root.imag > 0, -root, root)
    whole = np.exp(-1j * theta)
    below = bar.kappa * (1 + whole**2) / 2 - theta**2 * _sine(theta)
    middle = np.exp(-0.5j * theta) * ((1 + whole) / 2 + bar.kappa / 2 * _sine(theta / 2))
    with np.errstate(divide="ignore", invalid="ignore"):
        amplitudes = {
            "displacement": -bar.pressure * bar.height / bar.young * middle / below,
            "contact_pressure": bar.pressure * bar.kappa * whole / below,
            "horizontal_displacement": np.zeros_like(theta),
        }
    return {name: (factor * amplitudes[name]).sum(axis=0) for name in columns}


def _sine(theta: Complex) -> Complex:
    """exp(-i theta) sin(theta) / theta."""
    ways = 2j * np.where(theta == 0, np.finfo(float).tiny, theta)
    return -np.expm1(-ways) / ways
