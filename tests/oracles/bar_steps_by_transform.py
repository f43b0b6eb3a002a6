"""The bar under the Newmark scheme by its closed form at complex frequencies, in many digits: no modes, no doubles."""

from __future__ import annotations

from collections.abc import Sequence

from mpmath import mp, mpf

from fem_reference.exact.bar import Bar
from fem_reference.problem.problem import Scheme

DIGITS, DAMPED = 60, 20  # digits, and those by which the circle's radius damps the last step


def at_steps(bar: Bar, scheme: Scheme, steps: Sequence[int]) -> dict[str, list[mpf]]:
    """Return displacement and contact pressure at some steps.

    With z one step's delay the scheme turns sigma^2 D + L D = G f into an ordinary differential equation along the
    bar, c^2 dt^2 P(z) D'' = D away from the load; its solution is inverted by the trapezoidal rule on a circle,
    whose radius makes aliasing and rounding smaller than the digits that are kept.
    """
    with mp.workdps(DIGITS):
        count = 2 * max(steps)
        radius = mpf(10) ** (-mpf(DAMPED) / max(steps))
        points = [radius * mp.expjpi(mpf(2 * m) / count) for m in range(count)]
        values = [_transforms(bar, scheme, z) for z in points]
        found: dict[str, list[mpf]] = {}
        for i, name in enumerate(("displacement", "contact_pressure")):
            found[name] = [
                mp.fsum((v[i] * z**-k).real for v, z in zip(values, points, strict=True)) / count for k in steps
            ]
        return found


def _transforms(bar: Bar, scheme: Scheme, z: mpf) -> tuple[mpf, mpf]:
    a, d, gg, dt = (mpf(x) for x in (scheme.alpha, scheme.delta, scheme.gg, scheme.step))
    start = 1 if scheme.start == "consistent" else 0
    P = (gg * z * ((1 - d) * z + d) / (1 - gg * z) + (mpf(1) / 2 - a) * z + a) / (1 - z)
    Q = (gg * z * d / (1 - gg * z) + a) / (1 - z)
    G = start + z / (1 - z) - Q * start / P
    h, E = mpf(bar.height), mpf(bar.young)
    gamma = h / mp.sqrt(E / mpf(bar.density)) / (dt * mp.sqrt(P))
    kappa = mpf(bar.base_stiffness) * h / (E * mpf(bar.width))
    below = gamma * mp.sinh(gamma) + kappa * mp.cosh(gamma)
    base = -mpf(bar.pressure) * h / E * G / below
    middle = base * (mp.cosh(gamma / 2) + kappa / gamma * mp.sinh(gamma / 2))
    return middle, -mpf(bar.base_stiffness) / mpf(bar.width) * base
