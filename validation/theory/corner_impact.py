r"""A rigid rectangle that hits a plane with a corner: on springs by its equations of motion, and in the rigid limit.

With the arm r of the corner c = x + r, N = -p c_y while c_y < 0, and the spring along the plane stretched from the
place a where the corner last held,

    m x'' = T,   m y'' = N - m g,   I theta'' = r_x N - r_y T,    T = -ps (c_x - a) with |T| <= mu N.

While it slips, T = -/+ mu N and a follows; it sticks again where a would turn back. In the limit p, ps/p -> inf the
place does not change in the impact, and velocities are integrated along the normal impulse: the corner slips, and
sticks or slips backwards once its slip has come to rest.
"""

from __future__ import annotations

import cmath
import math
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from validation.runs.history import Array

MOST_MODES = 60
ROUNDING = 16 * float(np.finfo(float).eps)  # part of the lengths in it by which a height of a corner may be wrong
Point = tuple[float, float]


class HorizonError(ArithmeticError):
    """A rectangle does not go on from impact to impact of one corner."""

    def __init__(self, time: float, reason: str) -> None:
        super().__init__(f"exact up to {time:.6g} s only: {reason}")
        self.time = time  # the horizon [s]
        self.reason = reason


@dataclass(frozen=True)
class FallingRectangle:
    """A rectangle above the plane y = 0."""

    width: float  # m
    height: float  # m
    mass: float  # kg
    place: Point  # of the centroid [m]
    angle: float  # rad
    velocity: Point  # m/s
    spin: float  # rad/s
    gravity: float  # m/s2

    @property
    def inertia(self) -> float:
        """Of mass, about the centroid [kg m2]."""
        return self.mass * (self.width**2 + self.height**2) / 12

    @property
    def corners(self) -> tuple[Point, ...]:
        """The corners about the centroid before it is turned, counter-clockwise from the lower left one [m]."""
        x = self.width / 2
        y = self.height / 2
        return (-x, -y), (x, -y), (x, y), (-x, y)

    def arm(self, corner: int, angle: float | None = None) -> Point:
        """Return a corner about the centroid, at another angle if that is said [m]."""
        x, y = self.corners[corner]
        turn = self.angle if angle is None else angle
        cosine = math.cos(turn)
        sine = math.sin(turn)
        return x * cosine - y * sine, x * sine + y * cosine

    def flown(self, time: float) -> FallingRectangle:
        """Return it after a free flight."""
        x, y = self.place
        u, v = self.velocity
        return replace(
            self,
            place=(x + u * time, y + v * time - self.gravity * time**2 / 2),
            angle=self.angle + self.spin * time,
            velocity=(u, v - self.gravity * time),
        )

    def landing(self, until: float) -> tuple[float, int]:
        """Return when the first corner meets the plane [s], and its number."""
        time, _, corner = min((*self._comes_down(corner, until, 0.0), corner) for corner in range(4))
        return time, corner

    def next_impact(self, start: float, end: float) -> tuple[float, int] | None:
        """Return when a corner comes down first in a flight between two instants [s], and which; None where none does.

        Raises
        ------
        HorizonError
            If a corner comes to press on the plane without an impact, or two come down at once.
        """
        downs = []
        for number in range(4):
            elapsed, lands = self._comes_down(number, end - start, start)
            downs.append((start + elapsed, lands, number))
        (time, lands, corner), (then, *_), *_ = sorted(downs)
        if math.isinf(time):
            return None
        if not lands:
            raise HorizonError(time, "a corner presses on the ground without an impact, and slides on it")
        if then == time:
            raise HorizonError(time, "two corners come down at once, and the first one decides what follows")
        return time, corner

    def _comes_down(self, corner: int, duration: float, start: float) -> tuple[float, bool]:
        """Return when a corner is on the plane and does not rise, within a duration, and whether it falls on it.

        No step passes a landing: with K a bound of the acceleration the height s later is at least
        h + h' s - K s^2 / 2, and with K' one of its rate at least a s^2 / 2 - K' s^3 / 6 where h = h' = 0.
        """
        _, y = self.place
        _, v = self.velocity
        across, up = self.corners[corner]
        size = max(math.hypot(*place) for place in self.corners)
        bound = abs(self.gravity) + size * self.spin**2
        bound_of_rate = size * abs(self.spin) ** 3
        elapsed = 0.0
        while elapsed <= duration:
            turn = cmath.rect(1.0, self.angle + self.spin * elapsed)
            centre = y + v * elapsed - self.gravity * elapsed**2 / 2
            height = centre + across * turn.imag + up * turn.real
            rate = v - self.gravity * elapsed + self.spin * (across * turn.real - up * turn.imag)
            # what rounding leaves of a height, and the rate with which one falls through so little
            extent = size + abs(y) + abs(v) * elapsed + self.gravity * elapsed**2
            nothing = ROUNDING * (extent + abs(rate) * start)
            slow = math.sqrt(2 * bound * nothing)
            if height > nothing:
                root = math.sqrt(rate**2 + 2 * bound * height)
                if bound == 0 and rate >= 0:
                    break
                elapsed += 2 * height / (root - rate) if rate < 0 else (rate + root) / bound
            elif rate < -slow:
                return elapsed, True
            elif rate > slow:
                elapsed += rate / bound if bound else math.inf
            else:
                acceleration = -self.gravity - self.spin**2 * (height - centre)
                if acceleration < 0 or (acceleration == 0 and bound > 0):
                    return elapsed, False
                if bound_of_rate == 0:
                    break
                elapsed += acceleration / bound_of_rate
        return math.inf, True

    def rebounded(self, corner: int) -> FallingRectangle:
        """Return it after an impact of a smooth corner that gives all energy back."""
        arm, _ = self.arm(corner)
        u, v = self.velocity
        inverse_mass = 1 / self.mass
        inverse_inertia = 1 / self.inertia
        impulse = -2 * (v + self.spin * arm) / (inverse_mass + arm**2 * inverse_inertia)
        velocity = u, v + impulse * inverse_mass
        return replace(self, velocity=velocity, spin=self.spin + impulse * arm * inverse_inertia)


@dataclass(frozen=True)
class Rebound:
    """What an impact leaves behind."""

    time: float  # at which the corner leaves [s]
    state: tuple[float, ...]  # x, y, angle, and their rates then
    impulse: tuple[float, float]  # along the plane and across it [N s]


def on_springs(body: FallingRectangle, p: float, ps: float, mu: float | None, until: float) -> Rebound:
    """Return how a rectangle leaves springs p across and ps along the plane; mu None: smooth, where ps is zero.

    Every mode (sticks, slips either way) is integrated up to the event that ends it, by a method of order 8.
    """
    from scipy.integrate import solve_ivp

    time, number = body.landing(until)
    start = body.flown(time)
    rough = mu is not None and ps > 0
    coefficient = mu or 0.0

    def corner(q: Array) -> tuple[float, float, float, float]:
        along, across = body.arm(number, q[2])
        return q[0] + along, q[1] + across, q[3] - q[5] * across, q[4] + q[5] * along

    def shear(q: Array, mode: int, held: float) -> float:
        x, y, *_ = corner(q)
        if not rough:
            return 0.0
        return mode * coefficient * p * y if mode else -ps * (x - held)

    def rate(_: float, q: Array, mode: int, held: float) -> list[float]:
        arm = body.arm(number, q[2])
        normal = -p * corner(q)[1]
        along = shear(q, mode, held)
        turning = (arm[0] * normal - arm[1] * along) / body.inertia
        return [*q[3:6], along / body.mass, normal / body.mass - body.gravity, turning, along, normal]

    def leaves(_: float, q: Array, mode: int, held: float) -> float:
        return corner(q)[1]

    def ends(_: float, q: Array, mode: int, held: float) -> float:
        _, y, u, v = corner(q)
        return (
            mode * (u + mode * coefficient * p / ps * v) if mode else -coefficient * p * y - abs(shear(q, mode, held))
        )

    events: Any = [leaves, ends] if rough else [leaves]
    for event, direction in zip(events, (1.0, -1.0), strict=False):
        event.terminal = True
        event.direction = direction
    state = np.array([*start.place, start.angle, *start.velocity, start.spin, 0.0, 0.0])
    held, _, u, v = corner(state)
    # at N = T = 0 it sticks if the spring along the plane is loaded slowly enough beside that across it
    slips = rough and ps * abs(u) > coefficient * p * abs(v)
    mode = int(np.sign(u)) if slips else 0
    for _ in range(MOST_MODES):
        solution = solve_ivp(
            rate, (time, until), state, method="DOP853", rtol=1e-12, atol=1e-14, events=events, args=(mode, held)
        )
        time = solution.t[-1]
        state = solution.y[:, -1]
        if len(solution.t_events[0]) or solution.status == 0:
            break
        if mode == 0:
            mode = int(np.sign(corner(state)[0] - held))
        else:
            held = corner(state)[0] + shear(state, mode, held) / ps
            mode = 0
    *state_there, along, across = state.tolist()
    return Rebound(float(time), tuple(state_there), (along, across))


def rigid_impulse(body: FallingRectangle, mu: float, until: float) -> tuple[float, float]:
    """Return the impulses along and across the plane of a rigid corner with Coulomb friction, no normal work lost.

    The corner's velocity changes by A J with the inverse masses A of the corner, piece by piece along J_n.
    """
    landing, number = body.landing(until)
    landed = body.flown(landing)
    x, y = landed.arm(number)
    inverse = np.array([[1 / body.mass + y**2 / body.inertia, -x * y / body.inertia],
                        [-x * y / body.inertia, 1 / body.mass + x**2 / body.inertia]])  # fmt: skip
    velocity = np.array(landed.velocity) + landed.spin * np.array([-y, x])
    impulse = np.zeros(2)
    work = 0.0  # of the normal impulse: what compression takes, restitution gives back
    holds = abs(inverse[0, 1] / inverse[0, 0]) <= mu
    mode = float(np.sign(velocity[0]))
    while True:
        along = -inverse[0, 1] / inverse[0, 0] if mode == 0 else -mode * mu
        direction = np.array([along, 1.0])
        change = inverse @ direction
        to_rest = -velocity[0] / change[0] if mode != 0 and velocity[0] * change[0] < 0 else math.inf
        # work + v_n J + c_n J^2/2 = 0 ends the impact
        end = (-velocity[1] + math.sqrt(velocity[1] ** 2 - 2 * change[1] * work)) / change[1]
        piece = min(to_rest, end)
        work += velocity[1] * piece + change[1] * piece**2 / 2
        velocity = velocity + change * piece
        if piece == to_rest:
            velocity[0] = 0.0  # of which no rounding may turn the slip round again
        impulse = impulse + direction * piece
        if piece == end:
            return float(impulse[0]), float(impulse[1])
        mode = 0.0 if holds else -mode
