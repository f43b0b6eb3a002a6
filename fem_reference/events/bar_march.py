"""The base of the bar on a no-tension spring, piece by piece, in the units of `Units`.

A new piece begins with the load, where the base closes or opens, and at every echo of these from the top.
"""

from __future__ import annotations

from collections import deque
from collections.abc import Iterator
from dataclasses import dataclass

from flint import arb, arb_poly, ctx

from fem_reference.events.bar_model import Units
from fem_reference.events.enclosure import is_blank, radius_of
from fem_reference.events.exponential import Exponential
from fem_reference.events.switches import LostDigitsError


@dataclass(frozen=True)
class Piece:
    """The base from an instant on; functions of the time since then, in travel times."""

    start: arb  # encloses the instant in travel times
    closed: bool  # whether the base is closed
    gap: Exponential  # gap w [m/s]
    rate: Exponential  # f' [m/s]
    wave: Exponential  # f, zero at t = 0 [m/s]
    impulse: Exponential  # integral of N / Z over the time so far [m/s]


@dataclass(frozen=True)
class Start:
    """What a piece begins with."""

    time: arb  # instant in travel times
    incoming: Exponential  # g' from then on [m/s]
    gap: arb  # gap w [m/s]
    wave: arb  # f [m/s]
    impulse: arb  # integral of N / Z over the time so far [m/s]


def pieces(units: Units, end: arb, touches: list[arb]) -> Iterator[Piece]:
    """The pieces one after another, up to an instant in travel times.

    Parameters
    ----------
    units
        The bar.
    end
        The instant.
    touches
        Takes the instants at which a switch is neither proven nor excluded.

    Raises
    ------
    LostDigitsError
        If the gap at the start of a piece is known to less than a third of the digits.
    """
    still = Exponential(units.kappa, arb_poly([units.V / 2]))
    arrivals = deque([(arb(1), still.plus(-units.q))])
    start = Start(arb(0), still, units.gap, arb(0), arb(0))
    finest = arb(2) ** (-ctx.prec // 3)
    while start.time.mid() < end.mid():
        if radius_of(start.gap) + radius_of(start.wave) > units.scale * finest:
            raise LostDigitsError(float(start.time * units.travel), "the switches have cost most of the digits")
        piece = _begin(units, start)
        yield piece
        arrivals.append((start.time + 2, piece.rate.plus(-units.q)))
        arrival = arrivals[0][0]
        remainder = (arrival if arrival.mid() < end.mid() else end) - start.time
        near: list[arb] = []
        fall = (piece.gap * -1 if piece.closed else piece.gap).first_fall(remainder.upper(), near)
        touches += [start.time + s for s in near if s > remainder * finest]  # the start itself is none
        if fall is not None and remainder - fall.at > finest * remainder:
            start = _next(piece, fall.at, start.time + fall.at, start.incoming.shifted(fall.at), touching=True)
        elif (start.time + remainder).mid() < end.mid():
            start = _next(piece, remainder, *arrivals.popleft(), touching=fall is not None)
        else:
            break


def _begin(units: Units, start: Start) -> Piece:
    """The functions of a piece: w' + kappa w = G where the base is closed, w' = G where it is open."""
    g = start.incoming.without_noise(units.scale)
    G = (g * 2).plus(-units.b * start.time, -units.b).without_noise(units.scale)
    closed = bool(start.gap < 0) or (bool(start.gap == 0) and G.first_sign() <= 0)
    w = (G.relaxed(start.gap) if closed else G.integral(start.gap)).without_noise(units.scale)
    force = w * -units.kappa if closed else Exponential(units.kappa, arb_poly([]))
    f = (g + force).without_noise(units.scale)
    return Piece(start.time, closed, w, f, f.integral(start.wave), force.integral(start.impulse))


def _next(piece: Piece, s: arb, time: arb, incoming: Exponential, touching: bool) -> Start:
    """Start of the piece that follows after a time s; a gap that rounding gives the wrong sign is zero."""
    gap = piece.gap(s)
    if touching or is_blank(gap) or bool(gap < 0) != piece.closed:
        gap = arb(0)
    return Start(time, incoming, gap, piece.wave(s), piece.impulse(s))
