"""The bar on a no-tension base spring, exact in space and time: one bar of `bars_events` on a base at rest.

With rho the density, c = sqrt(E / rho), Z = rho c, b the acceleration of gravity, N the contact pressure and w the gap
under the base::

    N = max(0, -k w / W),   rho H (mean velocity - V0 + b t) + q t = integral of N over the time so far

A base that touches and carries nothing counts as closed until it lifts off.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, fields, replace

import numpy as np
from numpy.typing import ArrayLike

from fem_reference.events import bars_events
from fem_reference.events.bars_events import BarsMotion
from fem_reference.events.bars_march import CLOSED, OPEN, JointPiece
from fem_reference.events.bars_model import Bar, BarJoint, BarsProblem
from fem_reference.events.column_drive import constant
from fem_reference.events.switches import Switch
from fem_reference.problem.instants import instants
from fem_reference.problem.problem import Array

ADVANCES = 12_000
"""Times that the base or the top goes on at most; so many, of granite on stiff springs, took a minute."""
POSITIVE = ("height", "width", "density", "young", "base_stiffness")


@dataclass(frozen=True)
class BarProblem:
    """An elastic bar that is dropped on or pressed against a no-tension base spring.

    At t = 0 the bar is unstrained, its base a gap above the spring, and all loads are switched on.

    Raises
    ------
    ValueError
        For a value out of its range, naming field, rule and value.
    """

    height: float  # length H of the bar [m]
    width: float  # width W [m], unit thickness
    density: float  # mass density rho [kg/m3]
    young: float  # axial modulus: E in plane stress, E / (1 - mu^2) in plane strain [Pa]
    base_stiffness: float  # stiffness k = 2 p of the base spring [N/m]
    pressure: float = 0.0  # pressure q on the top [Pa], downwards, from t = 0 on
    gravity: float = 0.0  # acceleration of gravity, downwards [m/s2]
    gap: float = 0.0  # gap g0 under the base at t = 0 [m]
    velocity: float = 0.0  # velocity of the bar at t = 0 [m/s], upwards positive: an impact has a negative one

    def __post_init__(self) -> None:
        for field in fields(self):
            value = getattr(self, field.name)
            if not math.isfinite(value):
                raise ValueError(f"{field.name}: must be a finite number, got {value!r}")
            if field.name in POSITIVE and value <= 0:
                raise ValueError(f"{field.name}: must be positive, got {value!r}")
        if self.gap < 0:
            raise ValueError(f"gap: must not be negative, got {self.gap!r}")

    @property
    def travel(self) -> float:
        """Time H / c of a wave from top to base [s]."""
        return self.height * math.sqrt(self.density / self.young)

    @property
    def kappa(self) -> float:
        """Stiffness of the spring over that of the bar, k H / (E W) [-]."""
        return self.base_stiffness / self.young * (self.height / self.width)


@dataclass(frozen=True)
class BarHistory:
    """The motion at given instants, each array of shape (times,)."""

    time: Array  # instants [s]
    displacement: Array  # displacement of the mid-height [m]
    gap: Array  # gap w under the base [m], negative when pressed
    contact_pressure: Array  # N [Pa]
    mean_velocity: Array  # velocity averaged over the height [m/s]
    impulse: Array  # integral of the contact pressure over the time so far [Pa s]


@dataclass(frozen=True)
class BarMotion:
    """Exact motion of a bar from t = 0 on."""

    problem: BarProblem
    bars: BarsMotion  # the motion of the one bar as `bars_events` gives it
    closed_at_start: bool  # whether the base is closed just after t = 0
    switches: tuple[Switch, ...]  # openings and closings of the base, ``corner`` being ``"base"``, in the order of time

    def at(self, times: ArrayLike) -> BarHistory:
        """The motion at instants in any order.

        Raises
        ------
        ValueError
            If an instant is not from 0 to the end.
        """
        problem = self.problem
        t = instants(times, self.bars.end)
        state = self.bars.at(t)
        return BarHistory(
            time=t,
            displacement=self.bars.point(0, problem.height / 2, t).displacement,
            gap=state.gap[0],
            contact_pressure=np.maximum(0.0, state.force[0]),
            mean_velocity=state.mean_velocity[0],
            impulse=self.bars.impulse(0, t),
        )


def solve(problem: BarProblem, end: float, limit: int = 10_000) -> BarMotion:
    """The exact motion of a bar from t = 0 to `end` [s].

    Parameters
    ----------
    problem
        The bar, its base spring and its loads.
    end
        Last instant [s].
    limit
        Greatest number of switches.

    Raises
    ------
    ValueError
        If `end` is not positive and finite.
    HorizonError
        If the motion cannot be followed to its end; see `bars_events.solve`.
    """
    bar = Bar(problem.height, problem.density, problem.young, problem.velocity)
    spring = BarJoint("unilateral", problem.base_stiffness / problem.width, problem.gap)
    one_bar = BarsProblem((bar,), (spring,), problem.gravity, top=constant(problem.pressure))
    bars = bars_events.solve(one_bar, end, limit=limit, advances=ADVANCES)
    base = bars.joints[0]
    pieces = [] if base is None else base.pieces
    closed_at_start, switches = _from_rest(pieces, bars.switches)
    return BarMotion(problem, bars, closed_at_start, tuple(replace(switch, corner="base") for switch in switches))


def _from_rest(pieces: list[JointPiece], switches: tuple[Switch, ...]) -> tuple[bool, tuple[Switch, ...]]:
    """Whether the base is closed at first, and its switches, where one that only touches counts as closed."""
    moving = next((piece for piece in pieces if piece.opening or piece.state == CLOSED), None)
    if moving is None:
        return True, ()
    if moving is pieces[0]:
        return moving.state == CLOSED, switches
    if moving.state == OPEN:
        return True, (Switch(float(moving.start), "base", "opens", moving.start.str(40, radius=False)), *switches)
    return True, switches[1:]
