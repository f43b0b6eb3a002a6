r"""Whole histories as matrix products over blocks of steps.

From step 1 on, M A + C V + K D = F, so that a mode's state is (u, p): the displacement over its static
value and, in the same measure, the momentum dt V. A step of the scheme is an affine map of (u, p),
and step jB + i of a history is the product of a row of i steps and a column of jB steps: the whole
history is one matrix product for each column. Rows and columns are doubled, from 1, 2, 4, ... steps
on; the maps of 1, 2, 4, ... steps are squared with all digits. An error therefore grows with the
logarithm of the number of steps, not with their number, and nothing is subtracted: a motion that has
hardly begun keeps its digits as it does when it is stepped.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import replace
from decimal import Context, Decimal, localcontext
from typing import Any

import numpy as np

from dda.model.arrays import Array, ArrayPair
from dda.scheme import newmark
from dda.scheme.newmark import Scheme
from dda.scheme.roots import polynomial
from dda.scheme.spectral import critical_omega
from dda.scheme.stage import Stage, Table

BLOCK = 1024  # most steps in a row: its products stay in the cache
PLACES = 192  # binary places of a map's entries: one from 1e-30 on keeps far more digits than a double
_DIGITS = Context(prec=80)  # of the one step from which they come
_RANGE = 1e15  # of w dt: its square has full digits
_ONE = 1 << PLACES
GROWTH_ROUNDING = 1e-14  # of the determinant, by which a scheme without damping may seem to grow

Map = tuple[int, int, int, int, int, int]
"""(a, b, c, d, e, g), times 2^PLACES, of (u, p) -> (a u + b p + e, c u + d p + g)."""


def why_stepped(scheme: Scheme, frequencies: Array) -> str | None:
    """Return why a history must be stepped, in words; None if it can be blocked.

    A power of a growing map overflows before the history does.
    """
    if scheme.averages:
        return f"{scheme.name} carries the acceleration beside displacement and momentum"
    omegas = [scheme.step * w for w in frequencies.tolist()]
    if not all(1 / _RANGE < omega < _RANGE for omega in omegas):
        return f"w dt is outside {1 / _RANGE:g} to {_RANGE:g}"
    return "a mode grows" if any(_grows(scheme, omega) for omega in omegas) else None


def _grows(scheme: Scheme, omega: float) -> bool:
    """Tell whether the step of a mode has a root outside the unit circle, or on it at -1."""
    if scheme.table is None and not scheme.damped:
        return not omega < critical_omega(scheme.alpha, scheme.delta, scheme.gg)
    _, slope, product = polynomial(scheme, omega).tolist()
    return not (4 - 2 * slope + product > 0 and product - slope <= GROWTH_ROUNDING)


def blocked_modes(scheme: Scheme, frequencies: Array, rows: Array, steps: int) -> Array:
    """Return the observed columns of every step from rest, (columns, steps).

    Parameters
    ----------
    frequencies : (n,) array
        w of every mode [rad/s].
    rows : (columns, n) array
        What a mode adds to a column at its static displacement.
    """
    levels = (steps - 1).bit_length()
    split = min(BLOCK.bit_length() - 1, (levels + 1) // 2)
    maps, first = _powers(scheme, frequencies, levels)
    observers = np.zeros((len(rows), len(first)))
    observers[:, :-1:2] = rows
    inner = doubled(observers, maps[:split]).reshape(-1, *observers.shape)
    blocks = doubled(first[None], maps[split:].transpose(0, 2, 1))[: -(-steps >> split)]
    history = np.empty((len(rows), len(blocks), 1 << split))
    for index, out in enumerate(history):
        np.matmul(blocks, inner[:, index].T, out=out)
    return history.reshape(len(rows), -1)[:, :steps]


def doubled(start: Array, maps: Array) -> Array:
    """Return the rows and, below them, their products with all maps made of those of 1, 2, 4, ... steps."""
    have = len(start)
    rows = np.empty((have << len(maps), start.shape[1]))
    rows[:have] = start
    for power in maps:
        np.matmul(rows[:have], power, out=rows[have : 2 * have])
        have *= 2
    return rows


def _powers(scheme: Scheme, frequencies: Array, levels: int) -> ArrayPair:
    """Return the maps of 1, 2, 4, ... steps of all modes together, and the state at step 1.

    The state holds u and the scaled p of every mode and a constant 1, so that the maps are linear.
    """
    n = 2 * len(frequencies)
    maps = np.zeros((levels, n + 1, n + 1))
    maps[:, n, n] = 1.0
    first = np.ones(n + 1)
    exact = with_all_digits(scheme)
    for i, w in enumerate(frequencies.tolist()):
        at = slice(2 * i, 2 * i + 2)
        table, first[at] = _mode(exact, w, levels)
        maps[:, at, at] = table[:, :4].reshape(-1, 2, 2)
        maps[:, at, n] = table[:, 4:]
    return maps, first


def with_all_digits(scheme: Scheme) -> Scheme:
    """Return the scheme in decimal numbers, which `staged_step` takes in place of doubles."""
    numbers = ("alpha", "delta", "gg", "step", "mass_damping", "stiffness_damping")
    fields: dict[str, Any] = {name: Decimal(getattr(scheme, name)) for name in numbers}
    if scheme.table is not None:
        rows: list[list[Any]] = [[Decimal(number) for number in stage] for stage in scheme.table.stages]
        lag: Any = Decimal(scheme.lag)
        fields["table"] = Table(tuple(Stage(*row) for row in rows), lag)
    with localcontext(_DIGITS):
        return replace(scheme, **fields)


def _mode(exact: Scheme, w: float, levels: int) -> tuple[Array, tuple[float, float]]:
    """Return the entries of the maps of one mode, (levels, 6), and (u, p) at step 1, p scaled.

    The momentum is measured in the power of two that makes the off-diagonal entries about equal. The scheme is that of
    `with_all_digits`.
    """
    step, (u, p) = _one_step(exact, w)
    b = step[1].bit_length()
    c = step[2].bit_length()
    unit = math.ldexp(1.0, (c - b) // 2) if b and c else 1.0
    scales = np.array([1.0, unit, 1 / unit, 1.0, 1.0, 1 / unit]) / _ONE
    entries = [list(map(float, power)) for power in _squared(step, levels)]
    return np.array(entries).reshape(-1, 6) * scales, (u / _ONE, p / _ONE / unit)


def _one_step(exact: Scheme, w: float) -> tuple[Map, tuple[int, int]]:
    """Return the map of one step, and (u, p) at step 1, from the scheme's own step.

    Under the load F = k the static displacement is 1, so that D is u and P is p; the inertia force of a state is
    k - k D - e P.
    """
    frequency: Any = Decimal(w)
    zero: Any = Decimal(0)
    one: Any = Decimal(1)
    with localcontext(_DIGITS):
        k = (frequency * exact.step) ** 2
        matrices = newmark.step_matrices(exact, one, k)
        loads = [k for _ in matrices]
        still = [zero for _ in matrices]

        def step(D: Any, P: Any, f: Any) -> tuple[int, int]:
            D, P, *_ = newmark.staged_step(exact, matrices, k, loads, still, (D, P, f, f))
            return int(D * _ONE), int(P * _ONE)

        e, g = step(zero, zero, k)
        a, c = step(one, zero, zero)
        b, d = step(zero, one, k - newmark.viscosity(exact, k))
        first = step(*newmark.rest(exact, k, zero, k)[:3])
        return (a - e, b - e, c - g, d - g, e, g), first


def _squared(power: Map, levels: int) -> Iterator[Map]:
    """Yield the maps of 1, 2, 4, ... steps."""
    for _ in range(levels):
        yield power
        a, b, c, d, e, g = power
        t = a + d
        bc = b * c
        power = (
            a * a + bc >> PLACES,
            b * t >> PLACES,
            c * t >> PLACES,
            d * d + bc >> PLACES,
            (a + _ONE) * e + b * g >> PLACES,
            c * e + (d + _ONE) * g >> PLACES,
        )
