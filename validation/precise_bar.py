r"""The bar under the Newmark scheme in sixty-digit arithmetic, without its modes.

The generating function of the histories is known in closed form. With D(z) = sum of D(n) z^n, n >= 1, the scheme
(6), (7) and M A + K D = F from step 1 on say

    [ (1 - z) / (dt^2 P) M + K ] D = F [ z / (1 - z) + chi Q / P ]
    P = alpha + (1/2 - alpha) z + gg z (delta + (1 - delta) z) / (1 - gg z)
    Q = (1/2 - alpha) z + gg (1 - delta) z^2 / (1 - gg z),        M A(0) = chi F

so that s^2 = (1 - z) / (dt^2 P) takes the place of the square of Laplace's variable, and the bar of length h on its
spring, kappa = k h / (E W), theta = s h / c, has

    pressure / (q L) = kappa / N,   v / (-(q h / E) L) = (cosh(theta/2) + (kappa / theta) sinh(theta/2)) / N,
    N = theta sinh(theta) + kappa cosh(theta)

The values are the coefficients, found by a discrete Fourier transform on a circle inside the unit disk.
"""

from __future__ import annotations

from mpmath import mp, mpf

from validation.precise_block import DIGITS, NewmarkNumbers, Number
from validation.scene import Scene

ALIAS = 35  # digits below which the transform's wrapped-around values stay


def history(scene: Scene, names: tuple[str, ...]) -> dict[str, list[Number]]:
    """Return the columns at step 1 to the last; absolute errors stay 30 decades below the static values."""
    with mp.workdps(DIGITS + 20):
        size = 1 << (scene.time.steps * 3 // 2).bit_length()
        radius = mpf(10) ** (-mpf(ALIAS) / size)
        values = [_transforms(scene, radius * mp.expjpi(mpf(2 * j) / size)) for j in range(size // 2 + 1)]
        found = {}
        for index, name in enumerate(("displacement", "contact_pressure")):
            if name in names:
                half = [pair[index] for pair in values]
                found[name] = _coefficients(half, radius, scene.time.steps)
        return found


def _transforms(scene: Scene, z: Number) -> tuple[Number, Number]:
    """Return the generating functions of displacement and contact pressure at one point."""
    scheme = NewmarkNumbers.of(scene)
    (_, _), (width, _), (_, height), _ = scene.block.outline
    E, q = mpf(scene.block.young), mpf(scene.load.pressure)
    kappa = 2 * mpf(scene.contact.stiffness) * mpf(height) / (E * mpf(width))
    travel = mpf(height) * mp.sqrt(mpf(scene.block.density) / E)
    square, load = _variable(z, scheme)
    theta = mp.sqrt(square) * travel
    half = mp.exp(theta / 2)
    back = 1 / half
    cosh, sinh = (half * half + back * back) / 2, (half * half - back * back) / 2
    N = theta * sinh + kappa * cosh
    middle = ((half + back) + kappa / theta * (half - back)) / 2
    return -(q * mpf(height) / E) * load * middle / N, q * load * kappa / N


def _variable(z: Number, s: NewmarkNumbers) -> tuple[Number, Number]:
    """Return s^2 and the load's generating function."""
    half, damped = mpf(1) / 2 - s.alpha, s.gg * z / (1 - s.gg * z)
    P = s.alpha + half * z + damped * (s.delta + (1 - s.delta) * z)
    Q = half * z + damped * (1 - s.delta) * z
    return (1 - z) / (s.step**2 * P), z / (1 - z) + (Q / P if s.consistent else 0)


def _coefficients(half: list[Number], radius: Number, steps: int) -> list[Number]:
    """Return the coefficients 1 to `steps` of a real series from its values on the upper half of a circle."""
    size = 2 * (len(half) - 1)
    full = half + [mp.conj(value) for value in half[-2:0:-1]]
    spectrum = _fourier(full)
    return [spectrum[n].real / size / radius**n for n in range(1, steps + 1)]


def _fourier(values: list[Number]) -> list[Number]:
    """Return the sums of values[j] exp(-2 pi i j n / size), size a power of two."""
    size = len(values)
    if size == 1:
        return values
    even, odd = _fourier(values[::2]), _fourier(values[1::2])
    turned = [_root(n, size) * value for n, value in enumerate(odd)]
    return [a + b for a, b in zip(even, turned, strict=True)] + [a - b for a, b in zip(even, turned, strict=True)]


_ROOTS: dict[tuple[int, int], Number] = {}


def _root(n: int, size: int) -> Number:
    """Return exp(-2 pi i n / size), kept."""
    if (n, size) not in _ROOTS:
        _ROOTS[n, size] = mp.expjpi(-mpf(2 * n) / size)
    return _ROOTS[n, size]
