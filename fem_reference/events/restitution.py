"""Restitution of a rigid mass on a no-tension penalty contact under Newmark's scheme with kinetic damping.

A mass comes down at speed V, unloaded, on a spring k. In units of V, the time step and V times the time step,
with Omega = sqrt(k / m) dt, a step is::

    w* = w + gg v + (1/2 - alpha) A                    predictor; in contact where w* < 0
    A' = -Omega^2 w*/(1 + alpha Omega^2)               in contact, else A' = 0
    w' = w* + alpha A',   v' = gg v + (1 - delta) A + delta A'

The first step in contact starts with v = -1, A = 0 and w* = -theta. It starts above the spring and covers gg, so that
the overshoot theta of the predictor is at most gg, and uniform from 0 to gg where steps and impacts have nothing to do
with each other. The restitution e is the speed after the first step without contact. It is a continuous function of
theta made of straight lines.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from fem_reference.problem.checks import require, require_numbers
from fem_reference.problem.problem import Array

LIMIT = 100_000  # steps in contact after which the mass counts as stuck; also where it has come to rest
REST = 1e-18  # speed and acceleration below which the mass has come to rest, over those of the impact


@dataclass(frozen=True)
class ContactScheme:
    """Parameters of the scheme."""

    alpha: float  # weight of the new acceleration in the displacement [-], positive
    delta: float  # weight of the new acceleration in the velocity [-]; above alpha + 1/2 contact could end downwards
    gg: float = 1.0  # factor on the velocity at the start of each step [-]

    def __post_init__(self) -> None:
        require_numbers(self, positive=("alpha", "gg"))
        require(
            0.5 <= self.delta <= min(1.0, self.alpha + 0.5),
            "delta",
            "must be from 0.5 to min(1, alpha + 0.5)",
            self.delta,
        )
        require(self.gg <= 1, "gg", "must be at most 1", self.gg)

    def step(self, omega: float) -> Array:
        """A step in contact as a matrix on (w*, v, A), shape (3, 3)."""
        require(omega > 0, "omega", "must be positive", omega)
        k = 1 / (1 / omega / omega + self.alpha)  # Omega^2 / (1 + alpha Omega^2); 1 / alpha if stiff
        gg = self.gg
        delta = self.delta
        velocity = np.array([-delta * k, gg, 1 - delta])
        return np.array([np.array([1 - k / 2, 0.0, 0.0]) + gg * velocity, velocity, [-k, 0.0, 0.0]])


class Branch(NamedTuple):
    """One straight line of the restitution, e = constant + slope theta."""

    low: float  # least theta [-]
    high: float  # greatest theta [-]
    constant: float  # [-]
    slope: float  # [-]

    def __call__(self, theta: float) -> float:
        """Restitution."""
        return self.constant + self.slope * theta


class Statistics(NamedTuple):
    """Restitution over theta uniform from 0 to gg."""

    mean: float  # of e [-]
    low: float  # least [-]
    high: float  # greatest [-]
    mean_square: float  # of e^2, the share of the energy that is left [-]


def restitution(scheme: ContactScheme, omega: float, theta: float) -> float:
    """Restitution e of one overshoot of the predictor; 0 where the mass sticks.

    Parameters
    ----------
    omega
        Omega = sqrt(k / m) dt, `math.inf` for a rigid contact.
    theta
        Overshoot of the predictor, from 0 to gg.

    Raises
    ------
    ValueError
        If `omega` is not positive or theta is not from 0 to gg.
    """
    require(0 <= theta <= scheme.gg, "theta", f"must be from 0 to gg = {scheme.gg:g}", theta)
    return next(line(theta) for line in branches(scheme, omega) if theta <= line.high)


def branches(scheme: ContactScheme, omega: float) -> tuple[Branch, ...]:
    """All straight lines of the restitution, from theta = 0 to gg.

    The state is a straight line in theta as long as contact lasts; where the predictor changes its sign within
    an interval of theta, the interval is cut.
    """
    step = scheme.step(omega)
    last = np.array([0.0, scheme.gg, 1 - scheme.delta])  # the velocity after a first step without contact
    branches = []
    # intervals of theta, and there (w*, v, A) as columns of constants and slopes
    pending = [(0.0, scheme.gg, np.array([[0.0, -1.0], [-1.0, 0.0], [0.0, 0.0]]), 0)]
    while pending:
        low, high, state, steps = pending.pop()
        state = step @ state
        constant, slope = state[0].tolist()
        zero = -constant / slope if slope else low
        parts = [(low, zero), (zero, high)] if low < zero < high else [(low, high)]
        rests = np.abs(state[1:]).max() < REST or steps >= LIMIT
        for start, end in parts:
            if constant + slope * (start + end) / 2 >= 0:
                branches.append(Branch(start, end, *(last @ state).tolist()))
            elif rests:
                branches.append(Branch(start, end, 0.0, 0.0))
            else:
                pending.append((start, end, state, steps + 1))
    return tuple(sorted(branches, key=lambda branch: branch.low))


def statistics(scheme: ContactScheme, omega: float) -> Statistics:
    """Mean, range and mean square of the restitution, each line integrated exactly."""
    lines = branches(scheme, omega)
    ends = [((line.high - line.low) / scheme.gg, line(line.low), line(line.high)) for line in lines]
    values = [e for _, first, last in ends for e in (first, last)]
    return Statistics(
        mean=math.fsum(width * (first + last) / 2 for width, first, last in ends),
        low=min(values),
        high=max(values),
        mean_square=math.fsum(width * (first * first + first * last + last * last) / 3 for width, first, last in ends),
    )
