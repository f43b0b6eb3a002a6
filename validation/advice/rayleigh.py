r"""The Rayleigh damping that a scheme hides, and the scheme that hides a target one.

A step answers a vibration as the undamped system does at the complex frequency W = sqrt(W2); its damping ratio is
xi = -Im W / |W|, the *steady ratio* (that of a free vibration is `damping_ratio` of `validation.advice.spectra`). For
w dt -> 0 it is Rayleigh's xi = a0 / (2 w) + a1 w / 2, small ratios taken for granted, with

    a0 = 2 (1 - gg) / ((1 + gg) dt)   (kinetic damping, C = a0 M),
    a1 = (delta - 1/2) dt             (algorithmic damping, C = a1 K; for gg near 1).

The free decay of the discount is -ln(gg) / dt, and a0 = 2 tanh(-ln(gg) / 2) / dt: the same to second order in 1 - gg.
To this order neither part is negative and no ratio rises faster than the frequency; at w dt of order one it may:
(1/2, 0.6) at 2 ms has 3.47 times the ratio at 100 Hz that it has at 50 Hz. Codes that take a least ratio at a frequency
are given xi_min = sqrt(a0 a1) at f_min = sqrt(a0 / a1) / (2 pi).
"""

from __future__ import annotations

import contextlib
import itertools
import math
from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import ArrayLike

from validation.advice.limits import Limit
from validation.errors import InputError
from validation.runs.history import Array
from validation.scenes.scene import Scene
from validation.theory.stepping import Stepping

STARTS = 20  # steps, or delta, from which a scheme is looked for
TOLERANCES = {"xtol": 1e-15, "ftol": 1e-15, "gtol": 1e-15}
LARGE = 1e3  # times a ratio: in place of one that no step has
ROUNDING = 1e-9  # of a discount that is 0 or 1, or of a ratio
WRITTEN = 0.005  # of a ratio: what the digits in which it is written leave open

Point = tuple[float, float]  # frequency [Hz] and damping ratio [1]


@dataclass(frozen=True)
class Rayleigh:
    """C = a0 M + a1 K."""

    a0: float  # of the mass [1/s]
    a1: float  # of the stiffness [s]

    def ratio(self, frequency: ArrayLike) -> Array:
        """Return the damping ratio xi = a0 / (2 w) + a1 w / 2 at frequencies in Hz."""
        w = 2 * np.pi * np.asarray(frequency, float)
        return np.asarray(self.a0 / (2 * w) + self.a1 * w / 2)

    @property
    def least(self) -> Point | None:
        """The frequency [Hz] of the least ratio, and that ratio; None where not both parts damp."""
        if not (self.a0 > 0 and self.a1 > 0):
            return None
        return math.sqrt(self.a0 / self.a1) / (2 * math.pi), math.sqrt(self.a0 * self.a1)

    @classmethod
    def through(cls, first: Point, second: Point) -> Rayleigh:
        """Return the damping with given ratios at two frequencies; a part may come out negative.

        Raises
        ------
        InputError
            The frequencies are equal, or a number is out of range.
        """
        _check_points(first, second)
        (w1, x1), (w2, x2) = ((2 * math.pi * f, xi) for f, xi in (first, second))
        determinant = (w2 - w1) * (w2 + w1)
        mass = _difference(w2 * x1, w1 * x2)
        stiffness = _difference(w2 * x2, w1 * x1)
        return cls(2 * w1 * w2 * mass / determinant, 2 * stiffness / determinant)


def _difference(a: float, b: float) -> float:
    """Return a - b, exactly zero where only rounding is left of it."""
    return 0.0 if abs(a - b) <= 1e-14 * max(abs(a), abs(b)) else a - b


def scheme_of(scene: Scene) -> Stepping:
    """Return the scheme of a scene, which must be Newmark's.

    Raises
    ------
    InputError
        It is another.
    """
    stepping = Stepping.of(scene)
    if stepping.scheme != "newmark":
        rule = "must be newmark, whose damping near w dt = 0 has the form of Rayleigh's"
        raise InputError(rule, source=scene.name, field="time.scheme", value=repr(stepping.scheme))
    return stepping


def points(texts: Sequence[str], a0: float | None, a1: float | None) -> list[Point]:
    """Return the two points of ``HZ=XI`` texts; none where a0 and a1 are given instead.

    Raises
    ------
    InputError
        Not two points, or points beside a0 and a1, or what is no number.
    """
    both = a0 is not None or a1 is not None
    if both and texts:
        raise InputError("exclude each other", field="--ratio, and --a0 or --a1", value="both")
    if not both and len(texts) != 2:
        raise InputError("must be given twice", field="--ratio", value=f"{len(texts)} of them")
    pairs = []
    for text in texts:
        parts = text.split("=")
        try:
            f, xi = map(float, parts)
        except ValueError:
            raise InputError(
                "must be a frequency and a ratio, as in 5=0.02", field="--ratio", value=repr(text)
            ) from None
        pairs.append((f, xi))
    return pairs


def wanted(points: Sequence[Point], a0: float | None, a1: float | None) -> Rayleigh:
    """Return the damping that is stated by two points, or by a0 and a1, zero where one is absent."""
    if points:
        return Rayleigh.through(points[0], points[1])
    target = Rayleigh(a0 or 0.0, a1 or 0.0)
    if not (math.isfinite(target.a0) and math.isfinite(target.a1)):
        raise InputError("a0 and a1 must be finite", field="damping", value=f"{target.a0:g} and {target.a1:g}")
    return target


def check_band(low: float, high: float, step: float) -> None:
    """Refuse the ends of a range of frequencies that is none, or that a step does not sample."""
    if not (math.isfinite(low) and math.isfinite(high) and 0 < low < high):
        raise InputError("must be positive and in this order", field="--from, --to", value=f"{low:g} and {high:g}")
    check_sampled(high, step, "--to")


def check_sampled(frequency: float, step: float, field: str) -> None:
    """Refuse a frequency that a time step samples less than twice a period: the steps see its alias, a lower one.

    Raises
    ------
    InputError
        The frequency is above 1 / (2 dt).
    """
    limit = 0.5 / step
    if frequency > limit * (1 + 1e-12):
        raise InputError(
            f"must be at most {limit:.6g} Hz, 1 / (2 dt) of the time step {step:g} s, "
            "beyond which the steps see an alias",
            field=field,
            value=f"{frequency:g}",
            advice="take a lower frequency or a smaller step",
        )


def hidden(stepping: Stepping) -> Rayleigh:
    """Return the Rayleigh damping of a scheme in the limit w dt -> 0."""
    return Rayleigh(*stepping.rayleigh())


def ratio(stepping: Stepping, frequency: ArrayLike) -> Array:
    """Return the steady ratio xi = -Im W / |W| of a scheme at frequencies in Hz."""
    W = np.sqrt(stepping.squared_frequency(2 * np.pi * np.asarray(frequency, float)))
    return np.asarray(-W.imag / np.abs(W))


def matched(stepping: Stepping, first: float, second: float) -> Rayleigh:
    """Return the Rayleigh damping with the scheme's own ratios at two frequencies in Hz."""
    exact = ratio(stepping, [first, second])
    return Rayleigh.through((first, float(exact[0])), (second, float(exact[1])))


def settings(target: Rayleigh, scheme: Stepping, keep_step: bool = False) -> Stepping:
    """Return the scheme that hides a target damping, to leading order.

    Parameters
    ----------
    target
        The damping.
    scheme
        The scheme to change: its dt for a given delta; or its delta for a given dt (`keep_step`), with alpha raised
        to delta / 2 where the scheme would be unstable.
    keep_step
        Whether dt stays.

    Raises
    ------
    InputError
        To leading order no scheme hides it: a part is negative, delta = 1/2 has no algorithmic damping, or the discount
        is not positive.
    """
    if target.a0 < 0 or target.a1 < 0:
        part = "mass" if target.a0 < 0 else "stiffness"
        raise InputError(
            f"to leading order in w dt no scheme hides a negative {part} part",
            field="damping",
            value=f"a0 = {target.a0:g}, a1 = {target.a1:g}",
        )
    if keep_step:
        delta = 0.5 + target.a1 / scheme.step
        stepping = replace(scheme, delta=delta, alpha=max(scheme.alpha, delta / 2))
    elif target.a1 == 0 and scheme.delta == 0.5:
        stepping = scheme  # any step does
    elif target.a1 == 0 or scheme.delta <= 0.5:
        raise InputError(
            f"{scheme.delta:g} hides, to leading order, no a1 = {target.a1:g} s at any step",
            field="delta",
            advice="keep dt and vary delta",
        )
    else:
        stepping = replace(scheme, step=target.a1 / (scheme.delta - 0.5))
    half = target.a0 * stepping.step / 2  # (1 - gg) / (1 + gg)
    gg = (1 - half) / (1 + half)
    if gg <= 0:
        raise InputError(
            f"a0 = {target.a0:g} 1/s takes more than the whole velocity in a step of {stepping.step:g} s",
            field="damping",
        )
    return replace(stepping, gg=gg)


def exact_settings(first: Point, second: Point, scheme: Stepping, keep_step: bool = False) -> Stepping:
    """Return the scheme whose steady ratios at two frequencies in Hz are the target ones.

    The search begins at `settings` and on a grid of all steps (or all delta) and discounts: at w dt of order one a
    scheme may have ratios that none has to leading order. Of several the one with the smallest
    step (or delta) is taken. A scheme without discount is an edge of what can be had: where it alone has both ratios to
    the few digits in which ratios are written, it is returned.

    Raises
    ------
    InputError
        No scheme with its step below half a period of the higher frequency has them.
    """
    from scipy.optimize import least_squares

    shortest_period = 1 / max(first[0], second[0])

    def candidate(x: Array) -> Stepping:
        size, gg = map(float, x)
        if keep_step:
            delta = 0.5 + size
            return replace(scheme, delta=delta, alpha=max(scheme.alpha, delta / 2), gg=gg)
        return replace(scheme, step=size, gg=gg)

    def residuals(x: Array) -> Array:
        with np.errstate(all="ignore"):  # a trial may lie where no step exists
            errors = [float(ratio(candidate(x), f)) / max(xi, ROUNDING) - 1 for f, xi in (first, second)]
        return np.nan_to_num(errors, nan=LARGE, posinf=LARGE, neginf=-LARGE)

    starts = []
    with contextlib.suppress(InputError):
        leading = settings(Rayleigh.through(first, second), scheme, keep_step)
        starts.append((leading.delta - 0.5 if keep_step else leading.step, leading.gg))
    # of delta - 1/2, or of the step [s]
    low, high = (1e-4, 10.0) if keep_step else (shortest_period * 5e-7, shortest_period / 2)
    starts += itertools.product(np.geomspace(low, high, STARTS), (1.0, 0.9))
    bounds = ([0.0 if keep_step else low, 0.0], [high, 1.0])
    edge = None
    for start in starts:
        inside = np.clip(start, *bounds)
        x = least_squares(residuals, inside, bounds=bounds, method="dogbox", x_scale="jac", **TOLERANCES).x
        stepping = candidate(x)
        missed = misfit(stepping, first, second)
        if missed <= ROUNDING:
            return stepping
        if stepping.gg == 1 and missed <= WRITTEN:
            edge = stepping
    if edge is not None:
        return edge
    fixed = f"dt = {scheme.step:g} s" if keep_step else f"alpha = {scheme.alpha:g}, delta = {scheme.delta:g}"
    raise InputError(
        f"no scheme with {fixed} has these two ratios", field="damping", advice="ask for smaller or closer ones"
    )


def misfit(scheme: Stepping, *points: Point) -> float:
    """Return by how much the steady ratios of a scheme miss target ones, the largest as a share of its target."""
    return max(abs(float(ratio(scheme, f)) - xi) / max(xi, ROUNDING) for f, xi in points)


def _check_points(*points: Point) -> None:
    """Refuse frequencies and ratios out of range."""
    for f, xi in points:
        Limit("damping", "a frequency must be finite and positive").check(f)
        Limit("damping", "a ratio must be from 0 to below 1", below=1.0, ends=(0.0,)).check(xi)
    if len({f for f, _ in points}) < len(points):
        raise InputError("two frequencies must differ", field="damping", value=f"{points[0][0]:g} twice")
