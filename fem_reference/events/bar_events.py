"""The bar on a no-tension base spring, exact in space and time through any number of openings.

With rho the density, c = sqrt(E / rho), Z = rho c, y from the base, b the acceleration of gravity and N the
contact pressure, waves f (up) and g (down) make up the displacement::

    u(y, t) = -b t^2 / 2 + f(t - y / c) + g(t + y / c)
    top     g'(t) = f'(t - 2 H / c) - q / Z      (before t = H / c: half the initial velocity)
    base    f' = g' + N / Z,  w = g0 + u(0, t),  N = max(0, -k w / W),  w' = -b t + 2 g' + N / Z

On each piece of the time all of them are polynomials plus exp(-kappa s) times polynomials, kappa = k / (W Z):
a new piece begins with the load, where the base closes or opens, and at every echo of these after 2 H / c.
The computation is in ball arithmetic, with velocities in m/s and times in travel times H / c.
"""

from __future__ import annotations

import math
from bisect import bisect_right
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from flint import arb
from numpy.typing import ArrayLike

from fem_reference.events.bar_march import Piece, pieces
from fem_reference.events.bar_model import BarProblem, Units
from fem_reference.events.enclosure import bits_of, precision, radius_of
from fem_reference.events.switches import (
    ProvenMotion,
    Switch,
    TooManySwitchesError,
    TooMuchWorkError,
    with_enough_digits,
)
from fem_reference.problem.instants import instants
from fem_reference.problem.problem import Array

DIGITS = 60
"""Decimal digits of the first computation."""
MOST_DIGITS = 960
"""Decimal digits of the last one, where round trips and switches cost those of the ones before."""
PROMISED = 1e-20
"""Part of the end of the motion to which the instant of each switch is enclosed; more digits are taken for it."""
PIECES = 6000
"""Greatest number of pieces; half of them, granite on stiff springs in four times the digits, took 32 s and 114 MB."""
FRONT = 4
"""Travel times between two arrivals of the load's front at the base."""


@dataclass(frozen=True)
class BarHistory:
    """The motion at given instants."""

    time: Array  # instants [s], shape (times,)
    displacement: Array  # displacement of the mid-height [m], shape (times,)
    gap: Array  # gap w under the base [m], negative when pressed, shape (times,)
    contact_pressure: Array  # N = max(0, -k w / W) [Pa], shape (times,)
    mean_velocity: Array  # velocity averaged over the height [m/s], shape (times,)
    impulse: Array  # integral of the contact pressure over the time so far [Pa s], shape (times,)
    momentum_residual: Array  # rho H (mean velocity - V0 + b t) + q t - impulse [Pa s], zero but for rounding, (times,)


@dataclass(frozen=True)
class BarFields:
    """The bar at one instant."""

    displacement: Array  # u [m], shape (points,)
    velocity: Array  # rate of u [m/s], shape (points,)
    stress: Array  # axial stress, tension positive [Pa], shape (points,)


@dataclass(frozen=True)
class BarMotion(ProvenMotion):
    """Exact motion of a bar from t = 0 to `end`."""

    problem: BarProblem
    end: float  # last instant [s]
    digits: int  # decimal digits of the computation
    closed_at_start: bool  # whether the base is closed just after t = 0; one that stays at zero gap counts as closed
    switches: tuple[Switch, ...]  # openings and closings of the base, ``corner`` being ``"base"``, in the order of time
    pieces: tuple[Piece, ...]  # the pieces of the motion in the order of time
    touches: tuple[float, ...] = ()  # instants at which a switch was neither proven nor excluded; none was taken [s]

    def at(self, times: ArrayLike) -> BarHistory:
        """The motion at instants in any order.

        Raises
        ------
        ValueError
            If an instant is not from 0 to `end`.
        """
        t = instants(times, self.end)
        with precision(bits_of(self.digits)):
            rows = np.array([self._row(arb(float(instant))) for instant in t]).reshape(len(t), 6).T
        return BarHistory(t, rows[0], rows[1], np.maximum(0.0, rows[2]), rows[3], rows[4], rows[5])

    def fields(self, time: float, points: ArrayLike) -> BarFields:
        """Displacement, velocity and stress at heights y above the base [m] at one instant.

        Raises
        ------
        ValueError
            If the instant is not from 0 to `end` or a point is not from 0 to the height.
        """
        instants([time], self.end)
        y: Array = np.atleast_1d(np.asarray(points, dtype=float))
        if y.ndim != 1 or not np.all((y >= 0) & (y <= self.problem.height)):
            raise ValueError(f"points: must be heights from 0 to {self.problem.height!r}, got {points!r}")
        with precision(bits_of(self.digits)):
            rows = np.array([self._point(arb(time), arb(float(height))) for height in y]).reshape(len(y), 3).T
        return BarFields(rows[0], rows[1], rows[2])

    def breaks(self, time: float) -> Array:
        """Heights at which velocity or stress is not smooth at an instant, and both ends [m]."""
        with precision(bits_of(self.digits)):
            now, height = arb(time) / self._units.travel, arb(self.problem.height)
            born = self._starts
            heights = [now - t for t in born] + [t + sign - now + 1 for t in born for sign in (-1, 1)]
            inside = sorted({float(height * x) for x in heights if 0 < x < 1})
        return np.array([0.0, *inside, self.problem.height])

    @cached_property
    def _units(self) -> Units:
        with precision(bits_of(self.digits)):
            return Units.of(self.problem)

    @cached_property
    def _starts(self) -> list[arb]:
        return [piece.start.mid() for piece in self.pieces]

    def _row(self, time: arb) -> tuple[float, ...]:
        """Displacement, gap, pressure, mean velocity, impulse and momentum residual."""
        units = self._units
        now = time / units.travel
        half = arb(1) / 2
        piece, s = self._piece(now)
        middle = self._up(now - half) + self._down(now + half) - units.b * now * now / 2
        mean = self._up(now) - self._down(now) + units.V - (units.q + units.b) * now
        gap, impulse = piece.gap(s), piece.impulse(s)
        residual = mean - units.V + (units.b + units.q) * now - impulse
        pressure = -units.kappa * gap if piece.closed else arb(0)
        Z, T = units.impedance, units.travel
        return tuple(map(float, (middle * T, gap * T, pressure * Z, mean, impulse * Z * T, residual * Z * T)))

    def _point(self, time: arb, y: arb) -> tuple[float, ...]:
        """Displacement, velocity and stress."""
        units = self._units
        now, height = time / units.travel, y / arb(self.problem.height)
        before, after = now - height, now + height
        u = self._up(before) + self._down(after) - units.b * now * now / 2
        up, down = self._up_rate(before), self._down_rate(after)
        return tuple(map(float, (u * units.travel, up + down - units.b * now, (down - up) * units.impedance)))

    def _piece(self, now: arb) -> tuple[Piece, arb]:
        """The piece of an instant, and the time since it began."""
        piece = self.pieces[bisect_right(self._starts, now.mid()) - 1]
        return piece, now - piece.start

    def _up(self, now: arb) -> arb:
        """Wave f at an argument, which is negative for what was on its way at t = 0."""
        if now < 0:
            return self._units.V * now / 2
        piece, s = self._piece(now)
        return piece.wave(s)

    def _up_rate(self, now: arb) -> arb:
        if now < 0:
            return self._units.V / 2
        piece, s = self._piece(now)
        return piece.rate(s)

    def _down(self, now: arb) -> arb:
        """Wave g at an argument, reflected at the top."""
        units = self._units
        if now < 1:
            return units.V * now / 2
        return units.V + self._up(now - 2) - units.q * (now - 1)

    def _down_rate(self, now: arb) -> arb:
        units = self._units
        return units.V / 2 if now < 1 else self._up_rate(now - 2) - units.q


def solve(problem: BarProblem, end: float, digits: int = DIGITS, limit: int = 10_000) -> BarMotion:
    """The exact motion of a bar from t = 0 to `end` [s].

    Parameters
    ----------
    problem
        The bar, its base spring and its loads.
    end
        Last instant [s].
    digits
        Decimal digits of the computation, at least 50; twice as many are taken, up to `MOST_DIGITS`, where the instants
        of the switches are not enclosed to `PROMISED`.
    limit
        Greatest number of switches.

    Raises
    ------
    ValueError
        If `end` is not positive and finite or `digits` is below 50.
    TooManySwitchesError
        If there are more switches than `limit`.
    LostDigitsError
        If round trips and switches amplify what the motion may be off until nothing can be decided.
    TooMuchWorkError
        If there are more pieces than `PIECES`; see `most_pieces`.
    """
    if not (math.isfinite(end) and end > 0):
        raise ValueError(f"end: must be positive and finite, got {end!r}")
    if digits < 50:
        raise ValueError(f"digits: must be at least 50, got {digits!r}")
    digits += math.ceil(2.5 * max(0.0, -math.log10(problem.kappa)))  # integration divides by kappa, twice a piece
    return with_enough_digits(
        lambda digits: _solved(problem, float(end), digits, limit), digits, MOST_DIGITS, PROMISED * end
    )


def _solved(problem: BarProblem, end: float, digits: int, limit: int) -> BarMotion:
    """The motion in so many digits."""
    done: list[Piece] = []
    touches: list[arb] = []
    switches: list[Switch] = []
    with precision(bits_of(digits)):
        units = Units.of(problem)
        for piece in pieces(units, arb(end) / units.travel, touches):
            time = piece.start * units.travel
            if done and piece.closed != done[-1].closed:
                kind = "closes" if piece.closed else "opens"
                switches.append(Switch(float(time), "base", kind, time.mid().str(40, radius=False), radius_of(time)))
            done.append(piece)
            if len(switches) > limit:
                raise TooManySwitchesError(float(time), f"more than {limit} switches")
            if len(done) > PIECES:
                count = f"up to {most_pieces(problem, end):.3g} pieces until {end:g} s, of which {PIECES} are the limit"
                raise TooMuchWorkError(float(time), f"a stiff base opens and closes in {count}")
        near = tuple(float(touch * units.travel) for touch in touches)
    return BarMotion(problem, end, digits, done[0].closed, tuple(switches), tuple(done), near)


def most_pieces(problem: BarProblem, end: float) -> float:
    """Pieces that a motion of a stiff base may have, before it is computed.

    The n-th front of the load at the base rings 2 n times, Laguerre's polynomial of degree n in 2 kappa s; if the base
    opens and closes in each swing, as under a light weight, and each of these switches comes back as an echo after
    every round trip, (2/3) n^3 pieces follow by the n-th front.
    """
    return 2 / 3 * (end / problem.travel / FRONT + 1) ** 3
