"""The base of the bar on a no-tension spring, piece by piece, in the units of `Units`.

A new piece begins with the load, where the base closes or opens, and at every echo of these from the top.
"""

from __future__ import annotations

from collections import deque
from collections.abc import Iterator
from dataclasses import dataclass
from decimal import Decimal

from fem_reference.events.bar_model import Units
from fem_reference.events.decimals import ONE, TWO, ZERO
from fem_reference.events.exponential import NOISE, Exponential


@dataclass(frozen=True)
class Piece:
    """The base from an instant on; functions of the time since then, in travel times."""

    start: Decimal  # instant in travel times
    closed: bool  # whether the base is closed
    gap: Exponential  # gap w [m/s]
    rate: Exponential  # f' [m/s]
    wave: Exponential  # f, zero at t = 0 [m/s]
    impulse: Exponential  # integral of N / Z over the time so far [m/s]


@dataclass(frozen=True)
class Start:
    """What a piece begins with."""

    time: Decimal  # instant in travel times
    incoming: Exponential  # g' from then on [m/s]
    gap: Decimal  # gap w [m/s]
    wave: Decimal  # f [m/s]
    impulse: Decimal  # integral of N / Z over the time so far [m/s]


def pieces(units: Units, end: Decimal) -> Iterator[Piece]:
    """The pieces one after another, up to an instant in travel times."""
    still = Exponential(units.kappa, (units.V / 2,))
    arrivals = deque([(ONE, still.plus(-units.q))])
    start = Start(ZERO, still, units.gap, ZERO, ZERO)
    while start.time < end:
        piece = _begin(units, start)
        yield piece
        arrivals.append((start.time + TWO, piece.rate.plus(-units.q)))
        left = min(end, arrivals[0][0]) - start.time
        found = (piece.gap * -ONE if piece.closed else piece.gap).first_fall(left)
        if found is not None and left - found > NOISE * left:
            start = _next(piece, found, start.time + found, start.incoming.shifted(found), touching=True)
        elif start.time + left < end:
            start = _next(piece, left, *arrivals.popleft(), touching=found is not None)
        else:
            break


def _begin(units: Units, start: Start) -> Piece:
    """The functions of a piece: w' + kappa w = G where the base is closed, w' = G where it is open."""
    g = start.incoming.without_noise(units.scale)
    G = (g * TWO).plus(-units.b * start.time, -units.b).without_noise(units.scale)
    closed = start.gap < 0 or (start.gap == 0 and G.first_sign() <= 0)
    w = G.relaxed(start.gap) if closed else G.integral(start.gap)
    force = w * -units.kappa if closed else Exponential(units.kappa, ())
    f = (g + force).without_noise(units.scale)
    return Piece(start.time, closed, w, f, f.integral(start.wave), force.integral(start.impulse))


def _next(piece: Piece, s: Decimal, time: Decimal, incoming: Exponential, touching: bool) -> Start:
    """Start of the piece that follows after a time s; a gap that rounding gives the wrong sign is zero."""
    gap = piece.gap(s)
    if touching or (gap < 0) != piece.closed:
        gap = ZERO
    return Start(time, incoming, gap, piece.wave(s), piece.impulse(s))
