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

import functools

from mpmath import mp, mpf

from validation.scenes.scene import Scene
from validation.solvers.sixty_digits.block import DIGITS, NewmarkNumbers, Number

CARRIED = DIGITS + 20
ALIAS = 35  # digits below which the transform's wrapped-around values stay
BITS = 270  # of the transform's whole numbers, 81 digits below the largest value
Pair = tuple[int, int]  # real and imaginary part, whole numbers


def history(scene: Scene, names: tuple[str, ...]) -> dict[str, list[Number]]:
    """Return the columns at step 1 to the last; absolute errors stay 30 decades below the static values."""
    with mp.workdps(CARRIED):
        size = 1 << (scene.time.steps * 3 // 2).bit_length()
        radius = mpf(10) ** (-mpf(ALIAS) / size)
        t = scene.time
        points = _circle(size, ALIAS, t.alpha, t.delta, t.discount, t.start == "consistent")
        values = [_transforms(scene, square / mpf(t.step) ** 2, load) for square, load in points]
        columns = dict(zip(("displacement", "contact_pressure"), zip(*values, strict=True), strict=True))
        return {name: _coefficients(list(columns[name]), radius, scene.time.steps) for name in names}


@functools.lru_cache(maxsize=8)
def _circle(
    size: int, alias: int, alpha: float, delta: float, gg: float, consistent: bool
) -> list[tuple[Number, Number]]:
    """Return s^2 dt^2 and the load's generating function on the upper half of the circle."""
    radius = mpf(10) ** (-mpf(alias) / size)
    scheme = NewmarkNumbers(mpf(alpha), mpf(delta), mpf(gg), mpf(1), consistent)
    return [_variable(radius * mp.expjpi(mpf(2 * j) / size), scheme) for j in range(size // 2 + 1)]


def _variable(z: Number, s: NewmarkNumbers) -> tuple[Number, Number]:
    """Return s^2 dt^2 and the load's generating function at one point."""
    half = mpf(1) / 2 - s.alpha
    damped = s.gg * z / (1 - s.gg * z)
    P = s.alpha + half * z + damped * (s.delta + (1 - s.delta) * z)
    Q = half * z + damped * (1 - s.delta) * z
    return (1 - z) / P, z / (1 - z) + (Q / P if s.consistent else 0)


def _transforms(scene: Scene, square: Number, load: Number) -> tuple[Number, Number]:
    """Return the generating functions of displacement and contact pressure where s^2 and the load are given."""
    (_, _), (width, _), (_, height), _ = scene.block.outline
    E = mpf(scene.block.young)
    q = mpf(scene.load.pressure)
    kappa = 2 * mpf(scene.contact.stiffness) * mpf(height) / (E * mpf(width))
    theta = mp.sqrt(square) * (mpf(height) * mp.sqrt(mpf(scene.block.density) / E))
    half = mp.exp(theta / 2)
    back = 1 / half
    cosh = (half * half + back * back) / 2
    sinh = (half * half - back * back) / 2
    scale = load / (theta * sinh + kappa * cosh)
    middle = ((half + back) + kappa / theta * (half - back)) / 2
    return -(q * mpf(height) / E) * scale * middle, q * kappa * scale


def _coefficients(half: list[Number], radius: Number, steps: int) -> list[Number]:
    """Return the coefficients 1 to `steps` of a real series from its values on the upper half of a circle."""
    size = 2 * (len(half) - 1)
    top = max(map(abs, half)) or mpf(1)
    whole = [(int(mp.ldexp(v.real / top, BITS)), int(mp.ldexp(v.imag / top, BITS))) for v in half]
    spectrum = _fourier(whole + [(x, -y) for x, y in whole[-2:0:-1]])
    unit = mp.ldexp(top, -BITS) / size
    return [spectrum[n][0] * unit / radius**n for n in range(1, steps + 1)]


def _fourier(values: list[Pair]) -> list[Pair]:
    """Return the sums of values[j] exp(-2 pi i j n / size), size a power of two, in whole numbers."""
    size = len(values)
    if size == 1:
        return values
    even = _fourier(values[::2])
    odd = _fourier(values[1::2])
    turned = [
        ((x * c - y * s) >> BITS, (x * s + y * c) >> BITS) for (x, y), (c, s) in zip(odd, _roots(size), strict=True)
    ]
    both = list(zip(even, turned, strict=True))
    return [(a + c, b + d) for (a, b), (c, d) in both] + [(a - c, b - d) for (a, b), (c, d) in both]


@functools.cache
def _roots(size: int) -> list[Pair]:
    """Return exp(-2 pi i n / size) for n < size / 2 as whole numbers."""
    with mp.workdps(CARRIED + 10):
        turns = [mp.expjpi(-mpf(2 * n) / size) for n in range(size // 2)]
        return [(int(mp.ldexp(w.real, BITS)), int(mp.ldexp(w.imag, BITS))) for w in turns]
