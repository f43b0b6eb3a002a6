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

from flint import arb, arb_series

from fem_reference.exact.bar import Bar
from validation.solvers.sixty_digits.block import DIGITS, digits


def history(scene, names):
    """Return the columns of a scene at step 1 to the last, each proven to sixty digits of its largest value."""
    (_, _), (width, _), (_, height), _ = scene.block.outline
    block, stiffness = scene.block, 2 * scene.contact.stiffness
    bar = Bar(height, width, block.density, block.young, stiffness, scene.load.pressure)
    count = 2 * DIGITS
    while True:
        with digits(count, terms=scene.time.steps + 1):
            series = _series(bar, scene.time, arb(scene.time.discount))
            columns = {name: [series[name][n] for n in range(1, scene.time.steps + 1)] for name in names}
            if all(_is_proven(values) for values in columns.values()):
                return columns
        count *= 2


def _is_proven(values):
    largest = max(abs(value).lower() for value in values)
    return all(value.rad() <= largest * arb(10) ** -DIGITS for value in values)


def _series(bar, scheme, gg):
    """Return the generating functions of displacement and contact pressure."""
    z = arb_series([0, 1])
    half = arb(1) / 2 - scheme.alpha
    delta = arb(scheme.delta)
    damped = z * gg / (1 - z * gg)
    P = scheme.alpha + z * half + damped * (delta + z * (1 - delta))
    Q = z * half + damped * z * (1 - delta)
    load = z / (1 - z) + (Q / P if scheme.start == "consistent" else 0)

    E, height, q = arb(bar.young), arb(bar.height), arb(bar.pressure)
    kappa = arb(bar.base_stiffness) * height / (E * bar.width)
    theta = ((1 - z) / P).sqrt() * (height / scheme.step * (arb(bar.density) / E).sqrt())
    x = (theta * (arb(-1) / 2)).exp()
    square = x * x
    scale = load * x / (theta * (1 - square * square) + kappa * (1 + square * square))
    middle = 1 + square + kappa / theta * (1 - square)
    return {"displacement": scale * middle * (-q * height / E), "contact_pressure": scale * x * (2 * q * kappa)}
