"""The bar on a no-tension base spring, exact in space and time: one bar of `bars_events` on a base at rest.

With rho the density, c = sqrt(E / rho), Z = rho c, b the acceleration of gravity, N the contact pressure and w the gap
under the base::

    N = max(0, -k w / W),   rho H (mean velocity - V0 + b t) + q t = integral of N over the time so far

A base that touches and carries nothing counts as closed until it lifts off.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import ArrayLike

from fem_reference.events import bars_events
from fem_reference.events.bars_events import BarsMotion
from fem_reference.events.bars_march import CLOSED, OPEN, JointPiece
from fem_reference.events.bars_model import Bar, BarJoint, BarsProblem
from fem_reference.events.column_drive import constant
from fem_reference.events.switches import Switch, Work
from fem_reference.problem.bar import BarProblem
from fem_reference.problem.instants import instants
from fem_reference.problem.problem import Array


@dataclass(frozen=True)
class BarHistory:
    """The motion at given instants, each array of shape (times,)."""

    time: Array  # instants [s]
    displacement: Array  # of the mid-height [m]
    gap: Array  # gap w under the base [m], negative when pressed
    contact_pressure: Array  # N [Pa]
    mean_velocity: Array  # over the height [m/s]
    impulse: Array  # of the contact pressure so far [Pa s]


@dataclass(frozen=True)
class BarMotion:
    """Exact motion of a bar from t = 0 on."""

    problem: BarProblem
    bars: BarsMotion  # the motion of the one bar as `bars_events` gives it
    closed_at_start: bool  # whether the base is closed just after t = 0
    switches: tuple[Switch, ...]  # openings and closings of the base, ``corner`` being ``"base"``, in the order of time

    def at(self, times: ArrayLike) -> BarHistory:
        """The motion at instants from 0 to the end, in any order."""
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


def solve(problem: BarProblem, end: float, limit: int = 10_000, work: Work | None = None) -> BarMotion:
    """The exact motion of a bar from t = 0 to `end` [s]; arguments and errors are those of `bars_events.solve`."""
    bar = Bar(problem.height, problem.density, problem.young, problem.velocity)
    spring = BarJoint("unilateral", problem.base_stiffness / problem.width, problem.gap)
    one_bar = BarsProblem((bar,), (spring,), problem.gravity, top=constant(problem.pressure))
    bars = bars_events.solve(one_bar, end, limit=limit, work=work)
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
