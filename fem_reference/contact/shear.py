"""Contact of a base whose closed points are held along it by shear springs, without a limit or up to friction.

A closed point that sticks bears T = -k_t (s - r) with its slip s and reference r. While it is open its reference
follows its slip; where it closes within a step, from a gap w0 >= 0 to w1 < 0, the reference is the slip at the
crossing, r = s0 + (s1 - s0) w0 / (w0 - w1), which stores no energy while open and loses no slip of the step. Hence

    T = -k_t phi (s1 - r0),    phi = w1 / (w1 - w0) for a point that closes, 1 for one that was closed.

For any phi from 0 to 1 the spring gains no more energy than a step of delta = 1 puts into it. With friction (Coulomb)
the point sticks where |T| <= tan(angle) N + c, c its part of the base's cohesion, and slides otherwise,

    T = -d (tan(angle) N + c),    r = s1 + T / k_t,    d = 1 towards +x or -1, with d dr >= 0,

which takes the energy -T dr >= 0. An open point has no cohesion, and has it again where it closes.
Neither is a linear complementarity problem: some steps have no consistent states, some have several.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass, field, replace
from itertools import product
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy.linalg.lapack import dgetrf, dgetrs

from fem_reference.contact.open_close import (
    KEPT,
    NONE,
    OPEN,
    SEVERAL,
    SLIP,
    STICK,
    Contact,
    Flags,
    States,
    Trial,
    corrected,
    iterate,
)
from fem_reference.problem.problem import Array

ENUMERATED = 256
"""Greatest number of sets of states that are all tried: eight points that hold, four that may slide."""
SINGLY = 4
"""Greatest number of changes of one point after the other, over the number of points."""
PASSES = 60
"""Greatest number of corrections of the crossings for given states."""
SETTLED = 1e-13
"""Change of phi at which the crossings are settled [-]."""
ROUNDED = 1e-12
"""Share of the friction by which a sliding point may miss it."""
ALIKE = 1e-9
"""Difference of forces below which two sets of states are one contact, over the largest force."""


@dataclass(frozen=True)
class Friction:
    """Coulomb's friction along the base, |T| <= tan(angle) N + cohesion times a point's length of the base.

    Raises
    ------
    ValueError
        For a value out of its range, naming field, rule and value.
    """

    angle: float  # friction angle [deg], from 0 to below 90
    cohesion: float = 0.0  # shear stress that a closed base bears without any pressure [Pa]

    def __post_init__(self) -> None:
        if not 0 <= self.angle < 90:
            raise ValueError(f"friction: must be at least 0 and below 90, got {self.angle!r}")
        if not (math.isfinite(self.cohesion) and self.cohesion >= 0):
            raise ValueError(f"cohesion: must be finite and not negative, got {self.cohesion!r}")

    @property
    def tangent(self) -> float:
        """Tangent of the angle [-]."""
        return math.tan(math.radians(self.angle))


class Factor(NamedTuple):
    """Factorised equations of the closed points."""

    rows: NDArray[np.int64]  # which of the forces (N, T) are unknown
    weight: Array  # factors of their free gaps and slips on the right-hand side
    constant: Array  # what cohesion adds to it
    lu: Array
    pivots: NDArray[np.int64]


@dataclass(frozen=True)
class ShearBase:
    """What a base is in every step of one length, with the factors of its closed points kept."""

    C: Array  # gaps, then slips, of unit normal, then tangential, forces [m/N], shape (2 points, 2 points)
    compliance: Array  # 1 / k of each point [m/N], shape (points,)
    shear_stiffness: Array  # k_t of each point [N/m], shape (points,)
    tangent: float = math.inf  # of the angle of friction; infinite where nothing slides [-]
    cohesion: Array | None = None  # c of each point [N], shape (points,); none if absent
    _factors: dict[bytes, Factor] = field(default_factory=dict)

    @property
    def slides(self) -> bool:
        """Whether there is a limit to the tangential forces."""
        return self.tangent < math.inf

    def bound(self, normal: Array) -> Array:
        """Greatest tangential forces under normal ones [N], shape (points,)."""
        most: Array = self.tangent * normal + (0.0 if self.cohesion is None else self.cohesion)
        return most

    def factor(self, states: States, phi: Array | None) -> Factor:
        """The equations of the closed points, N / k + w = 0 and the law of T, factorised; phi = 1 if None."""
        if phi is not None:
            return self._factorised(states, phi)
        key = states.tobytes()
        if key not in self._factors:
            if len(self._factors) >= KEPT:
                self._factors.clear()
            self._factors[key] = self._factorised(states, np.ones(len(states)))
        return self._factors[key]

    def _factorised(self, states: States, phi: Array) -> Factor:
        """T + k_t phi s = 0 of points that stick, T + d tan(angle) N = -d c of those that slide."""
        points = len(states)
        sliding = np.flatnonzero(np.abs(states) == SLIP)
        direction = np.sign(states[sliding])
        kappa = self.shear_stiffness * phi
        kappa[sliding] = 0.0
        # Divided by its size each row is as good as any other for the pivots; phi may be zero.
        flexibility = np.diag(self.C)
        size = np.concatenate([self.compliance + flexibility[:points], 1 + kappa * flexibility[points:]])
        weight = np.concatenate([np.ones(points), kappa]) / size
        matrix = weight[:, None] * self.C + np.diag(np.concatenate([self.compliance, np.ones(points)]) / size)
        constant = np.zeros(2 * points)
        if len(sliding):
            matrix[points + sliding, sliding] += direction * self.tangent
            constant[points + sliding] = -direction * self.bound(np.zeros(points))[sliding]
        rows = np.flatnonzero(np.concatenate([states, states]))
        own = matrix[np.ix_(rows, rows)]
        return Factor(rows, -weight[rows], constant[rows], *(dgetrf(own)[:2] if len(rows) else (own, rows)))


@dataclass(frozen=True)
class ShearStep:
    """The base in one step: gaps and slips are (w, s) = (free_gap, free_slip) + C (N, T)."""

    base: ShearBase
    free_gap: Array  # gaps without forces at the end of the step [m], shape (points,)
    free_slip: Array  # slips without forces beyond the references at the start of the step, s - r0 [m], shape (points,)
    gap: Array  # gaps at the start of the step [m], shape (points,)
    closed: Flags  # points that were closed at the start of the step, shape (points,)

    def forces(self, states: States) -> Trial:
        """Forces and gaps for given states, with the crossings that belong to them: phi for phi(forces(phi))."""
        closing = (states == STICK) & ~self.closed
        if not closing.any():
            return self._linear(states, None)
        phi = np.where(closing, 0.5, 1.0)
        weight, last = 1.0, np.inf
        for _ in range(PASSES):
            trial = self._linear(states, phi)
            change = np.where(closing, self._crossed(trial.normal) - phi, 0.0)
            size = float(np.max(np.abs(change), initial=0.0))
            if size <= SETTLED:
                return trial
            # A crossing that is passed to and fro is approached by smaller corrections.
            weight, last = weight / 2 if size >= last else weight, size
            phi = phi + weight * change
        return replace(trial, settled=False)

    def asked(self, trial: Trial, states: States) -> States:
        """States that the forces, gaps and slips of given states ask for."""
        closed = corrected(trial, states)
        if not self.base.slides:
            return closed
        normal = np.where(states != OPEN, trial.normal, np.maximum(-trial.gap, 0.0) / self.base.compliance)
        held = self._held(trial, normal)
        held = np.where(states == STICK, trial.shear, held)
        bound = self.base.bound(np.maximum(normal, 0.0))
        least = (1 - ROUNDED) * bound
        # what slides on against its friction keeps its direction; what would turn round is held first, as it may rest
        was = np.abs(states) == SLIP
        onward = was & (-np.sign(states) * held >= least)
        slides = onward | (~was & (np.abs(held) > bound))
        direction = np.where(onward, np.sign(states), -np.sign(held))
        return np.where(closed == OPEN, OPEN, np.where(slides, SLIP * direction, STICK)).astype(np.int8)

    def _held(self, trial: Trial, normal: Array) -> Array:
        """Tangential forces that would hold the points at their references, -k_t phi (s1 - r0)."""
        phi = np.where(self.closed, 1.0, self._crossed(normal))
        held: Array = -self.base.shear_stiffness * phi * trial.slip
        return held

    def _crossed(self, normal: Array) -> Array:
        """Share phi of the step for which each point has been closed."""
        depth = np.maximum(normal, 0.0) * self.base.compliance
        way = depth + np.maximum(self.gap, 0.0)
        return np.divide(depth, way, out=np.ones_like(way), where=way > 0)

    def _linear(self, states: States, phi: Array | None) -> Trial:
        """Forces for given states and crossings."""
        points, factor = len(states), self.base.factor(states, phi)
        found, free = np.zeros(2 * points), np.concatenate([self.free_gap, self.free_slip])
        if len(factor.rows):
            right = factor.weight * free[factor.rows] + factor.constant
            found[factor.rows] = dgetrs(factor.lu, factor.pivots, right)[0]
        moved = free + self.base.C @ found
        return Trial(found[:points], found[points:], moved[:points], moved[points:])


def sheared(step: ShearStep, states: States, limit: int) -> Contact:
    """Contact of a base with shear springs, from the states at the start of the step.

    All states are set at once. Where that does not converge all sets of states are tried if there are few, and
    otherwise, with friction, the first wrong state is set again and again.
    """
    found = iterate(step.forces, states, limit, step.asked)
    if found.trial is not None:
        return found
    choices = (OPEN, STICK, SLIP, -SLIP) if step.base.slides else (OPEN, STICK)
    if len(choices) ** len(states) > ENUMERATED:
        return _singly(step, found) if step.base.slides else found
    consistent = _distinct(_consistent(step, choices))
    if len(consistent) == 1:
        return Contact(*consistent[0], limit + 1)
    return Contact(None, states, limit + 1, SEVERAL if consistent else NONE)


def _singly(step: ShearStep, found: Contact) -> Contact:
    """Set the first state that is wrong until none is, from where all at once have led."""
    states, most = found.states.copy(), SINGLY * len(found.states)
    for solves in range(found.solves + 1, found.solves + most + 1):
        trial = step.forces(states)
        asked = step.asked(trial, states)
        wrong = np.flatnonzero(asked != states)
        if not len(wrong) and trial.settled:
            return Contact(trial, states, solves)
        if not len(wrong):
            break
        states = states.copy()
        states[wrong[0]] = asked[wrong[0]]
    return replace(found, solves=solves)


def _consistent(step: ShearStep, choices: tuple[int, ...]) -> Iterator[tuple[Trial, States]]:
    """All sets of states that their own forces, gaps and slips ask for."""
    for choice in product(choices, repeat=len(step.closed)):
        states = np.array(choice, dtype=np.int8)
        trial = step.forces(states)
        if trial.settled and np.array_equal(step.asked(trial, states), states):
            yield trial, states


def _distinct(found: Iterator[tuple[Trial, States]]) -> list[tuple[Trial, States]]:
    """Those with forces of their own: a point without any force has several names for its state."""
    kept: list[tuple[Trial, States]] = []
    for trial, states in found:
        own = np.concatenate([trial.normal, trial.shear])
        others = [np.concatenate([other.normal, other.shear]) for other, _ in kept]
        size = max((float(np.max(np.abs(each))) for each in (own, *others)), default=0.0)
        if all(np.max(np.abs(own - other)) > ALIKE * size for other in others):
            kept.append((trial, states))
    return kept
