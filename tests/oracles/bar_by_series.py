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

With x = exp(-theta / 2) for the hyperbolic functions these are power series in z, in ball arithmetic (python-flint) of
as many digits as prove sixty of the histories.
"""

from __future__ import annotations

from flint import arb, arb_series

from validation.scenes.scene import Scene
from validation.solvers.sixty_digits.block import DIGITS, NewmarkNumbers, digits


def history(scene: Scene, names: tuple[str, ...]) -> dict[str, list[arb]]:
    """Return the columns at step 1 to the last, each proven to sixty digits of its largest value."""
    steps = scene.time.steps
    count = 2 * DIGITS
    while True:
        with digits(count, terms=steps + 1):
            series = _series(scene)
            columns = {name: [series[name][n] for n in range(1, steps + 1)] for name in names}
            if all(_is_proven(values) for values in columns.values()):
                return columns
        count *= 2


def _is_proven(values: list[arb]) -> bool:
    largest = max(abs(value).lower() for value in values)
    return all(value.rad() <= largest * arb(10) ** -DIGITS for value in values)


def _series(scene: Scene) -> dict[str, arb_series]:
    """Return the generating functions of displacement and contact pressure."""
    s = NewmarkNumbers.of(scene)
    z = arb_series([0, 1])
    half = arb(1) / 2 - s.alpha
    damped = z * s.gg / (1 - z * s.gg)
    P = s.alpha + z * half + damped * (s.delta + z * (1 - s.delta))
    Q = z * half + damped * z * (1 - s.delta)
    load = z / (1 - z) + (Q / P if s.consistent else 0)

    (_, _), (width, _), (_, height), _ = scene.block.outline
    E = arb(scene.block.young)
    q = arb(scene.load.pressure)
    kappa = 2 * arb(scene.contact.stiffness) * height / (E * width)
    theta = ((1 - z) / P).sqrt() * (height / s.step * (arb(scene.block.density) / E).sqrt())
    x = (theta * (arb(-1) / 2)).exp()
    square = x * x
    scale = load * x / (theta * (1 - square * square) + kappa * (1 + square * square))
    middle = 1 + square + kappa / theta * (1 - square)
    return {"displacement": scale * middle * (-q * height / E), "contact_pressure": scale * x * (2 * q * kappa)}
