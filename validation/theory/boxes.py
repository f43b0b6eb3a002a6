"""Closed forms of rigid boxes on a plane: sliding, a shaken ground, a spring below."""

from __future__ import annotations

import itertools
import math
from dataclasses import dataclass

import numpy as np

from validation.runs.history import Array

# ---- on a slope ----


def sliding_acceleration(slope: float, friction: float, gravity: float) -> float:
    """Acceleration down a slope of a box at rest, g (sin s - tan(phi) cos s), angles in deg [m/s2]; 0 for phi >= s."""
    excess = math.tan(math.radians(slope)) - math.tan(math.radians(friction))
    return gravity * math.cos(math.radians(slope)) * max(excess, 0.0)


# ---- on a ground that moves ----


@dataclass(frozen=True)
class SlipPiece:
    """A time in which a box sticks to the ground that moves, or slips in one direction."""

    start: float  # first instant [s]
    displacement: float  # of the box at that instant [m]
    velocity: float  # [m/s]
    direction: int  # of its velocity against the ground, -1 or 1; 0 where it sticks


@dataclass(frozen=True)
class ShakenBox:
    """A box on ground that moves by A (1 - cos(2 pi f t)) along itself, from rest on it.

    While it slips its acceleration is -direction tan(phi) g. It sticks where both move alike and the ground's
    acceleration is at most tan(phi) g.
    """

    amplitude: float  # A [m]
    frequency: float  # f [Hz]
    friction: float  # tan(phi)
    gravity: float  # m/s2

    @property
    def rate(self) -> float:
        """2 pi f [rad/s]."""
        return 2 * math.pi * self.frequency

    @property
    def grip(self) -> float:
        """Greatest acceleration that friction gives the box [m/s2]."""
        return self.friction * self.gravity

    @property
    def peak(self) -> float:
        """Greatest acceleration of the ground [m/s2]."""
        return abs(self.amplitude) * self.rate**2

    def ground(self, time: Array) -> Array:
        """Displacement of the ground [m]."""
        return self.amplitude * (1 - np.cos(self.rate * time))

    def ground_velocity(self, time: float) -> float:
        """Velocity of the ground [m/s]."""
        return self.amplitude * self.rate * math.sin(self.rate * time)

    def ground_acceleration(self, time: float) -> float:
        """Acceleration of the ground [m/s2]."""
        return self.amplitude * self.rate**2 * math.cos(self.rate * time)

    def pieces(self, duration: float) -> tuple[SlipPiece, ...]:
        """Return the pieces of the motion from t = 0 on, those that begin before an instant [s]."""
        if self.peak <= self.grip:
            return (SlipPiece(0.0, 0.0, 0.0, 0),)
        pieces = [self._next(0.0, 0.0)]
        while True:
            piece = pieces[-1]
            end = self._slips_at(piece.start) if piece.direction == 0 else self._alike_at(piece)
            if end >= duration:
                return tuple(pieces)
            displacement = float(self._within(piece, np.array(end)))
            if piece.direction == 0:
                # where it begins to slip the ground outruns it
                direction = -1 if self.ground_acceleration(end) > 0 else 1
                velocity = self.ground_velocity(end)
                pieces.append(SlipPiece(end, displacement, velocity, direction))
            else:
                pieces.append(self._next(end, displacement))

    def _within(self, piece: SlipPiece, time: Array) -> Array:
        """Return the displacement of the box at instants of a piece [m]."""
        if piece.direction == 0:
            return np.asarray(piece.displacement + (self.ground(time) - self.ground(np.array(piece.start))))
        since = time - piece.start
        return np.asarray(piece.displacement + piece.velocity * since - piece.direction * self.grip * since**2 / 2)

    def _next(self, time: float, displacement: float) -> SlipPiece:
        """Return the piece that begins where box and ground move alike."""
        acceleration = self.ground_acceleration(time)
        velocity = self.ground_velocity(time)
        if abs(acceleration) <= self.grip:
            return SlipPiece(time, displacement, velocity, 0)
        return SlipPiece(time, displacement, velocity, -1 if acceleration > 0 else 1)

    def _slips_at(self, start: float) -> float:
        """Return the first instant from a start on at which the ground's acceleration is more than friction gives."""
        # |cos(phase)| reaches grip / peak, from below, before each multiple of pi
        before = math.acos(self.grip / self.peak)
        phase = self.rate * start
        cycle = math.ceil((phase + before) / math.pi - 1e-12)
        return max(start, (cycle * math.pi - before) / self.rate)

    def _alike_at(self, piece: SlipPiece) -> float:
        """Return when the box that slips moves as the ground does again [s]."""
        from scipy.optimize import brentq

        def relative(time: float) -> float:
            velocity = piece.velocity - piece.direction * self.grip * (time - piece.start)
            return piece.direction * (velocity - self.ground_velocity(time))

        # The relative velocity turns where the ground accelerates as the box does. It grows first, and is not above
        # zero again at the end of the second stretch between turns at the earliest.
        low, high = next(
            ends for ends in itertools.pairwise([piece.start, *self._turns(piece)]) if relative(ends[1]) <= 0
        )
        return float(brentq(relative, low, high, xtol=1e-300, rtol=4 * np.finfo(float).eps))

    def _turns(self, piece: SlipPiece) -> list[float]:
        """Return the instants after a start at which the ground accelerates as the slipping box does [s]."""
        cosine = -piece.direction * self.grip / (self.amplitude * self.rate**2)
        angle = math.acos(cosine)
        first = math.floor(self.rate * piece.start / (2 * math.pi))
        # the box's velocity changes by grip * t while the ground's returns: they are alike within these cycles
        last = first + 3 + math.ceil(self.peak / self.grip)
        turns = []
        for cycle in range(first, last):
            turns += [(2 * math.pi * cycle + sign * angle) / self.rate for sign in (1, -1)]
        return sorted(turn for turn in turns if turn > piece.start * (1 + 1e-12) + 1e-12 / self.rate)

    def displacement(self, time: Array) -> Array:
        """Return the displacement of the box at instants [m]."""
        pieces = self.pieces(float(time[-1]))
        index = np.searchsorted([piece.start for piece in pieces], time, side="right") - 1
        moved = np.empty_like(time)
        for number, piece in enumerate(pieces):
            inside = index == number
            moved[inside] = self._within(piece, time[inside])
        return moved

    def slip(self, time: Array) -> Array:
        """Return the displacement of the box against the ground at instants [m]."""
        return self.displacement(time) - self.ground(time)


# ---- on a spring ----


@dataclass(frozen=True)
class SpringImpact:
    """A rigid mass that lands on a spring without loss, under its weight.

    With w = sqrt(k / m) the sinking of the contact is (g / w^2) (1 - cos(w t)) + (v / w) sin(w t).
    """

    mass: float  # kg
    stiffness: float  # k [N/m]
    gravity: float  # m/s2
    speed: float  # v of the landing [m/s]

    @property
    def rate(self) -> float:
        """W, the circular frequency on the spring [rad/s]."""
        return math.sqrt(self.stiffness / self.mass)

    @property
    def peak_force(self) -> float:
        """Greatest force m g + sqrt((m g)^2 + k m v^2) [N]."""
        weight = self.mass * self.gravity
        return weight + math.sqrt(weight**2 + self.stiffness * self.mass * self.speed**2)

    @property
    def duration(self) -> float:
        """Time of contact (2 / w) (pi - atan(v w / g)) [s]: pi / w without weight, a whole period without speed."""
        return 2 / self.rate * (math.pi - math.atan2(self.speed * self.rate, self.gravity))

    def sinking(self, time: Array) -> Array:
        """Return how far the spring is pressed at instants since the landing [m]."""
        phase = self.rate * time
        return self.gravity / self.rate**2 * (1 - np.cos(phase)) + self.speed / self.rate * np.sin(phase)
