"""One step of the Newmark scheme with kinetic damping on a base that carries no tension.

With S = M + alpha dt^2 K of the block without the base's springs, factorised once for each length of step::

    D* = D + gg dt V + dt^2 (1/2 - alpha) A
    A1 = S^-1 (F - K D*) + S^-1 B' (N, T)          the free block, then the contact forces
    D1 = D* + alpha dt^2 A1
    V1 = gg V + dt ((1 - delta) A + delta A1)

so that M A1 = F - K D1 + B' (N, T) without a division by alpha dt^2. The gaps at the end are those of the free
block plus C N, C = alpha dt^2 B S^-1 B'. Nothing depends on the contact states but the small problem of the forces.
Where the base moves its own way is taken from the gaps and slips.

With implicit contact (Kane, Repetto, Ortiz and Marsden, 1999) A is the block's own, M A1 = F - K D1, under average
acceleration, and the forces of the step's end throw it besides, D by dt^2 / 2 and V by dt times Q = M^-1 B' (N, T)::

    D1 = D* + alpha dt^2 (A1 + Q / (2 alpha)),   V1 = gg V + dt ((1 - delta) A + delta A1) + dt Q
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field, replace

import numpy as np
from scipy.sparse import csr_array, vstack

from fem_reference.contact.open_close import OPEN, SLIP, STICK, Contact, Flags, FrictionlessBase, States, Trial
from fem_reference.contact.points import ContactModel
from fem_reference.contact.shear import Friction, ShearBase, ShearStep, sheared
from fem_reference.problem.problem import Array, Scheme
from fem_reference.scheme.newmark import State, Work, effective_matrix, initial_acceleration, predictor, velocity

SHEARS = ("frictionless", "glued")
RULES = ("newmark", "implicit")
AVERAGE = (0.25, 0.5)
"""Alpha and delta of average acceleration."""
KEPT = 8
"""Greatest number of shorter steps whose matrices are kept."""
DENSE = 256
"""Greatest number of forces whose responses are kept, eight bytes an unknown each."""


@dataclass(frozen=True)
class ContactState:
    """Motion and contact at the end of a step."""

    motion: State  # displacement [m], velocity [m/s] and acceleration [m/s2] of the unknowns
    gap: Array  # gap w of each point [m], negative where pressed, shape (points,)
    slip: Array  # displacement s of each point along the base [m]; zero where none is glued
    reference: Array  # slip r at which the shear spring of each point is unstrained [m]
    normal: Array  # normal force N of each point on the block [N]
    shear: Array  # tangential force T of each point on the block [N]
    states: States  # state of each point that the last step found
    slid: Array  # sum of what the reference of each point has moved while it was closed [m]
    time: float  # time of the state [s]
    base: Array  # way of the base's points since t = 0, normal to it and along it [m], shape (2,)
    given: float  # work that the moving base has done on the block since t = 0 [J]

    @property
    def closed(self) -> Flags:
        """Points that are closed."""
        closed: Flags = self.states != OPEN
        return closed


@dataclass(frozen=True)
class _Matrices:
    """What belongs to one length of step."""

    scheme: Scheme
    solve: Callable[[Array], Array]
    response: Array | None  # S^-1 B', shape (unknowns, forces); None for many forces, where steps solve twice
    C: Array  # alpha dt^2 B S^-1 B' [m/N], shape (forces, forces)
    small: FrictionlessBase | ShearBase  # the problem of the forces


@dataclass
class ContactStepper:
    """The scheme applied to the block on points, with its factorisations made once for each length of step.

    Raises
    ------
    ValueError
        If `shear` or `rule` is unknown, `limit` is below one, friction has no springs, or the scheme is not the rule's.
    """

    model: ContactModel
    scheme: Scheme
    shear: str = "frictionless"  # ``"frictionless"``, or ``"glued"``: shear springs hold the closed points
    limit: int = 6  # greatest number of solutions of the open-close iteration [-]
    rule: str = "newmark"  # or ``"implicit"``: the force of the step's end, and average acceleration of the block
    friction: Friction | None = None  # limit of the forces of glued points; none if absent
    work: Work = field(default_factory=Work)

    def __post_init__(self) -> None:
        if self.shear not in SHEARS:
            raise ValueError(f"shear: must be one of {SHEARS}, got {self.shear!r}")
        if self.rule not in RULES:
            raise ValueError(f"rule: must be one of {RULES}, got {self.rule!r}")
        if self.friction is not None and self.shear != "glued":
            raise ValueError(f"friction: goes with shear = 'glued' only, got it with {self.shear!r}")
        if self.limit < 1:
            raise ValueError(f"limit: must be at least 1, got {self.limit!r}")
        both = vstack([self.model.normal, self.model.tangential])
        self._B = csr_array(both if self.shear == "glued" else self.model.normal)
        self._weight = 1.0
        self._thrown: Callable[[Array], Array] | None = None
        if self.rule == "implicit":
            if (self.scheme.alpha, self.scheme.delta) != AVERAGE:
                raise ValueError(f"alpha, delta: must be {AVERAGE} for implicit contact, got {self.scheme}")
            self._weight = 1 / (2 * self.scheme.alpha)
            mass = self.work.factor(self.model.M)
            thrown = self._responses(mass)[0]
            self._thrown = (lambda f: mass(self._B.T @ f)) if thrown is None else (lambda f: thrown @ f)
        self._lengths: dict[float, _Matrices] = {}
        self._matrices(self.scheme.step)

    def start(self, gap: float = 0.0, speed: float = 0.0) -> ContactState:
        """State at t = 0: unstrained, a gap above the base [m], with one velocity upwards [m/s]."""
        zero, none = np.zeros_like(self.model.F), np.zeros(len(self.model.share))
        mass = self.work.factor(self.model.M) if self.scheme.start == "consistent" else None
        motion = State(zero, speed * self.model.upwards, initial_acceleration(self.model.F, mass))
        states = np.full(len(none), STICK if gap == 0 else OPEN, dtype=np.int8)
        return ContactState(motion, none + gap, none, none, none, none, states, none, 0.0, np.zeros(2), 0.0)

    def advance(self, state: ContactState, length: float | None = None) -> tuple[ContactState | None, Contact]:
        """One step, of a shorter `length` [s] where that is given.

        Returns
        -------
        state, contact
            The state at the end and the contact found; None where there is none, with the reason in `contact`.
        """
        own = self._matrices(self.scheme.step if length is None else length)
        scheme, old = own.scheme, state.motion
        ahead = predictor(old, scheme)
        residual = self.model.F - self.model.K @ ahead
        free = own.solve(residual)
        way = self._way(state.time + scheme.step) - state.base
        moved = self._B @ (ahead - old.D + scheme.alpha * scheme.step**2 * free)
        moved -= np.repeat(way, len(self.model.share))[: len(moved)]
        contact = self._contact(state, own, moved)
        if contact.trial is None:
            return None, contact
        N, T = contact.trial.normal, contact.trial.shear
        forces = np.concatenate([N, T]) if self.shear == "glued" else N
        A = free if not contact.states.any() else self._pushed(own, residual, free, forces)
        motion = self._moved(old, ahead, A, forces, scheme)
        # A pressed spring's gap from its force keeps the digits that the difference of displacements has not.
        gap = np.where(contact.states != OPEN, -N / self.model.stiffness, contact.trial.gap)
        sheared = state.slip, state.reference, state.slid
        if self.shear == "glued":
            sheared = self._slipped(state, contact.states, contact.trial, moved + own.C @ forces)
        ended = state.time + scheme.step, state.base + way, state.given + self._given(state, contact.trial, way)
        slip, reference, slid = sheared
        return ContactState(motion, gap, slip, reference, N, T, contact.states, slid, *ended), contact

    def _pushed(self, own: _Matrices, residual: Array, free: Array, forces: Array) -> Array:
        """Accelerations of the free block and of the forces."""
        if own.response is not None:
            return free + own.response @ forces
        return own.solve(residual + self._weight * (self._B.T @ forces))

    def _way(self, time: float) -> Array:
        """Way of the base since t = 0, normal to it and along it [m]."""
        if self.model.motion is None:
            return np.zeros(2)
        way: Array = self.model.axes @ self.model.motion(np.array([time]))[0]
        return way

    def _given(self, state: ContactState, trial: Trial, way: Array) -> float:
        """Work of the base on the block in a step, from the forces at both its ends [J]."""
        late = 1.0 if self.rule == "implicit" else self.scheme.delta
        before, after = (np.array([of.normal.sum(), of.shear.sum()]) for of in (state, trial))
        return float(way @ ((1 - late) * before + late * after))

    def _moved(self, old: State, ahead: Array, A: Array, forces: Array, scheme: Scheme) -> State:
        """Motion at the end of a step from the accelerations that D1 = D* + alpha dt^2 A holds."""
        D = ahead + scheme.alpha * scheme.step**2 * A
        if self._thrown is None:
            return State(D, velocity(old, A, scheme), A)
        thrown = self._thrown(forces)
        own = A - self._weight * thrown
        return State(D, velocity(old, own, scheme) + scheme.step * thrown, own)

    def scheme_of(self, length: float) -> Scheme:
        """The scheme for one length of step [s], with the share of gg that belongs to it."""
        return self._matrices(length).scheme

    def _contact(self, state: ContactState, own: _Matrices, moved: Array) -> Contact:
        points = len(self.model.share)
        free = state.gap + moved[:points]
        if isinstance(own.small, FrictionlessBase):
            return own.small.contact(free, state.states, self.limit)
        slip = state.slip - state.reference + moved[points:]
        return sheared(ShearStep(own.small, free, slip, state.gap, state.closed), state.states, self.limit)

    def _slipped(self, state: ContactState, states: States, trial: Trial, moved: Array) -> tuple[Array, Array, Array]:
        """Slips, references and sums of sliding at the end of a step; `moved` holds gaps, then slips."""
        slip = state.slip + moved[len(states) :]
        T, k_t = trial.shear, self.model.shear_stiffness
        sheared = slip + np.divide(T, k_t, out=np.zeros_like(T), where=k_t > 0)
        held = np.where(state.closed, state.reference, sheared)
        sliding = np.abs(states) == SLIP
        reference = np.where(states == STICK, held, np.where(sliding, sheared, slip))
        # it has slid from its reference, or from where it closed
        depth, above = trial.normal / self.model.stiffness, np.maximum(state.gap, 0.0)
        way = depth + above
        crossing = state.slip + (slip - state.slip) * np.divide(above, way, out=np.zeros_like(way), where=way > 0)
        slid = reference - np.where(state.closed, state.reference, crossing)
        onward = sliding & (slid * states > 0)
        return slip, reference, state.slid + np.where(onward, slid, 0.0)

    def _matrices(self, length: float) -> _Matrices:
        if length not in self._lengths:
            if len(self._lengths) > KEPT:
                self._lengths = {self.scheme.step: self._lengths[self.scheme.step]}
            share = length / self.scheme.step
            scheme = replace(self.scheme, step=length, gg=self.scheme.gg**share)
            solve = self.work.factor(effective_matrix(self.model.M, self.model.K, scheme))
            response, C = self._responses(solve)
            if response is not None:
                response *= self._weight
            C, compliance = self._weight * scheme.alpha * length**2 * (C + C.T) / 2, 1 / self.model.stiffness
            glued = self.shear == "glued"
            small = self._sheared(C, compliance) if glued else FrictionlessBase(C, compliance)
            self._lengths[length] = _Matrices(scheme, solve, response, C, small)
        return self._lengths[length]

    def _sheared(self, C: Array, compliance: Array) -> ShearBase:
        k_t, friction = self.model.shear_stiffness, self.friction
        if friction is None:
            return ShearBase(C, compliance, k_t)
        cohesion = friction.cohesion * self.model.length * self.model.share
        return ShearBase(C, compliance, k_t, friction.tangent, cohesion)

    def _responses(self, solve: Callable[[Array], Array]) -> tuple[Array | None, Array]:
        """S^-1 B', where it is kept, and B S^-1 B'."""
        count = self._B.shape[0]
        response = np.empty((self._B.shape[1], count)) if count <= DENSE else None
        C = np.empty((count, count))
        for i in range(count):
            found = solve(self._B[[i]].toarray()[0])
            C[:, i] = self._B @ found
            if response is not None:
                response[:, i] = found
        return response, C
