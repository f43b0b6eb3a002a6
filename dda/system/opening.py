r"""A block cut into sub-blocks over a base that carries no tension.

The sub-blocks and their glue are those of `dda.system.subdivision`; in place of the locked springs every base edge of
a sub-block has a contact point at each end, with its share p l / a of the corner springs. One step is that of
`dda.system.solution` without supports, and then the forces of the points,

    r = gg P + (1/2 - alpha) f + alpha (F - k D - B' mu)     ->  dD, dmu of the free system
    (w, s) = (w_f, s_f) + C lambda,    C = alpha dt^2 Bc S^-1 Bc'  with S^-1 the same solve,
    f1 = F - k D1 - B' mu1 + dt^2 Bc' lambda,

so that one factorisation, and as many solves with it as there are forces, serve every contact state.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from dda.contact.kernel import (
    FOUND,
    Contacts,
    Flexibility,
    Free,
    at_rest,
    find_contacts,
    law_of,
    set_paired_flexibility,
    work_for,
    zeros,
)
from dda.contact.springs import Contact, base_directions
from dda.contact.unilateral import OPEN, Unilateral
from dda.model.load import BaseMotion
from dda.one_block.two_block import TwoBlockModel
from dda.one_block.unilateral import UnilateralModel
from dda.scheme.newmark import Scheme, predictor, velocity_corrector
from dda.stepping.compiled import Compilable
from dda.stepping.driver import Counts, driver
from dda.system.joints import FIXED
from dda.system.solution import Stepper
from dda.system.subdivision import Pattern, subdivided
from dda.system.system import BlockSystem, Equations, inverses

Array = NDArray[np.float64]

LENGTHS = 16  # step lengths whose factors are kept
PLAIN_POINT = 3e-6  # seconds of a solve in plain Python for each pair of points


@dataclass(frozen=True, eq=False)
class OpeningSystem:
    """Sub-blocks, glue and the points of the base, in their order from M to N."""

    system: BlockSystem  # without supports
    law: Unilateral  # of each point
    normals: Array  # (points, unknowns) gap by D
    tangents: Array  # (points, unknowns) displacement along the base by D
    velocity: float  # at t = 0, upwards positive [m/s]
    axes: Array  # (2, 2) unit normal of the base, into the blocks, and its tangent from M to N
    motion: BaseMotion | None  # of the base

    def base(self, instants: ArrayLike) -> Array:
        """Return the displacement of the base along its normal and its tangent, (len(instants), 2) [m]."""
        moved = np.zeros((len(np.asarray(instants)), 2)) if self.motion is None else self.motion.at(instants)
        along: Array = moved @ self.axes.T
        return along

    @property
    def equations(self) -> Equations:
        """The equations in all unknowns."""
        return self.system.equations


def opening_subdivided(
    model: UnilateralModel, columns: int, rows: int, glue: float, pattern: Pattern = "squares"
) -> OpeningSystem:
    """Return the block over corners that open, cut into sub-blocks; see `dda.subdivided` for the parameters.

    Raises
    ------
    ValueError
        If the block is not a convex quadrilateral, or a number is out of range.
    """
    loads = model.pressure, model.base, model.top, model.eccentricity, model.traction, model.gravity, None, model.slope
    locked = subdivided(TwoBlockModel(model.block, Contact(1.0), *loads), columns, rows, glue, pattern)
    tangent, normal, _ = base_directions(model.block, model.base)
    supports = [joint for joint in locked.joints if joint.second == FIXED]
    supports.sort(key=lambda joint: float(tangent @ np.array(joint.start)))
    ends = [(joint.first, np.array(place)) for joint in supports for place in (joint.start, joint.end)]
    normals, tangents = np.zeros((2, len(ends), len(locked.blocks), 6))
    for i, (number, (x, y)) in enumerate(ends):
        T = locked.blocks[number].T(float(x), float(y))
        normals[i, number], tangents[i, number] = normal @ T, tangent @ T
    share = supports[0].normal  # a side that is cut evenly has edges of one length
    own = model.contact
    law = replace(own, stiffness=own.stiffness * share, shear=own.shear * share, cohesion=own.cohesion * share)
    return OpeningSystem(
        system=replace(locked, joints=[joint for joint in locked.joints if joint.second != FIXED]),
        law=law,
        normals=normals.reshape(len(ends), -1),
        tangents=tangents.reshape(len(ends), -1),
        velocity=model.velocity,
        axes=np.array([normal, tangent]),
        motion=model.motion,
    )


@dataclass(eq=False)
class SystemState:
    """Where the sub-blocks are, in units of the scheme's own step dt."""

    D: Array  # unknowns
    P: Array  # dt M V
    f: Array  # dt^2 M A
    mu: Array  # dt^2 times the forces of the glue
    contacts: Contacts  # of the points


class Length:
    """Everything of a step that depends on its length alone, factorised once."""

    def __init__(self, opening: OpeningSystem, scheme: Scheme, ratio: float) -> None:
        self.ratio = ratio
        self.scheme = scheme if ratio == 1 else replace(scheme, gg=scheme.gg**ratio, step=scheme.step * ratio)
        self.stepper = Stepper(opening.equations, self.scheme)
        h2 = self.scheme.step**2
        self.F = h2 * opening.equations.F * opening.system.load_size
        self.rows = np.concatenate([opening.normals, opening.tangents]) if opening.law.shear else opening.normals
        self.still = np.zeros(len(opening.equations.pressure))
        self.push = h2 * self.rows.T
        responses = [self.stepper.increments(self.scheme.alpha * row, self.still) for row in self.push.T]
        self.moved, self.glued = (np.array([pair[i] for pair in responses]).T for i in (0, 1))
        C = self.rows @ self.moved
        C = (C + C.T) / 2
        self.flexible = Flexibility(C, C.copy())
        if len(C) == 4 and len(opening.normals) == 2:
            set_paired_flexibility(C, self.flexible.C_paired)


class SystemHistory(NamedTuple):
    """What is kept of every step, a row each."""

    columns: Array  # (steps, columns)
    momentum: Array  # (steps, 2) dt times the momentum in x and y
    stored: Array  # (steps, 4) kinetic, strain, spring and load energy [J]; (0, 4) if they are not asked for
    normal: Array  # (steps, points)
    shear: Array
    gap: Array
    slide: Array
    slipped: Array
    state: NDArray[np.int8]


class SystemLosses:
    """Energy of sub-blocks: the entries of `dda.one_block.unilateral_energy`; `dt` is the step of their units [s].

    Strain counts the sub-blocks and their glue. The losses of a step are those of one block, with D' K0 D the energy of
    both, D' Ke D + lambda' kappa^-1 lambda.
    """

    def __init__(self, opening: OpeningSystem, dt: float) -> None:
        self.opening, self.dt = opening, dt
        e = opening.equations
        self.inverse, self.elastic = e.blockwise(inverses(e.mass)), e.blockwise(e.elastic)
        self.F = e.F * opening.system.load_size

    def stored(self, state: SystemState) -> tuple[float, ...]:
        """Return kinetic, strain, spring and load energy, without what the base gave."""
        strain = self._stiff(state.D, state.mu / self.dt**2) / 2
        springs = float(np.sum(self._springs(state.contacts)))
        return self._kinetic(state.P / self.dt), strain, springs, -float(self.F @ state.D)

    def of_part(self, length: Length, before: SystemState, after: SystemState, carried: Array) -> tuple[float, ...]:
        """Return the losses of a part in which the base moved by `carried`, along its normal and tangent."""
        late, gg = length.scheme.delta, length.scheme.gg
        old, new = before.contacts, after.contacts
        N = (1 - late) * np.array(old.normal) + late * np.array(new.normal)
        T = (1 - late) * np.array(old.shear) + late * np.array(new.shear)
        slid = self.opening.tangents @ (after.D - before.D) - carried[1]
        given = float(np.sum(N)) * carried[0] + float(np.sum(T)) * carried[1]
        friction = -np.array(new.shear) * np.array(new.slipped)
        work = N * np.subtract(new.gap, old.gap) + T * slid
        lost = self._springs(old) - self._springs(new) - work - friction
        same = (np.array(old.state) == OPEN) == (np.array(new.state) == OPEN)
        algorithmic = self._bulk(length, before, after) + np.sum(lost[same])
        damped = (1 - gg**2) * self._kinetic(before.P / self.dt)
        return float(algorithmic), damped, float(np.sum(lost[~same])), float(np.sum(friction)), given

    def _bulk(self, length: Length, before: SystemState, after: SystemState) -> float:
        """Return the loss of the sub-blocks, with what A0 adds where M A0 was not F - K0 D0."""
        scheme, dt2 = length.scheme, self.dt**2
        c, over = scheme.alpha - scheme.delta / 2, scheme.delta - 0.5
        moved, R0, R1 = after.D - before.D, before.f / dt2, after.f / dt2
        loss = over * self._stiff(moved, (after.mu - before.mu) / dt2)
        held = self.elastic @ before.D + self.opening.equations.B.T @ (before.mu / dt2)
        normal, shear = np.array(before.contacts.normal), np.array(before.contacts.shear)
        pressed = self.opening.normals.T @ normal + self.opening.tangents.T @ shear
        loss += (1 - scheme.delta) * float(moved @ (self.F - held + pressed - R0))
        if c:
            stored = self._kinetic(R1) - self._kinetic(R0)
            loss += c * scheme.step**2 * (stored + 2 * over * self._kinetic(R1 - R0))
        return loss

    def _kinetic(self, momentum: Array) -> float:
        return float(momentum @ (self.inverse @ momentum)) / 2

    def _stiff(self, D: Array, force: Array) -> float:
        """Return D' Ke D + lambda' kappa^-1 lambda."""
        return float(D @ (self.elastic @ D) + force @ (self.opening.equations.C @ force))

    def _springs(self, contacts: Contacts) -> Array:
        law = self.opening.law
        shear = np.square(contacts.shear) / law.shear if law.shear else 0.0
        energy: Array = (np.square(contacts.normal) * law.compliance + shear) / 2
        return energy


class OpeningBody:
    """The sub-blocks as the loop over steps takes them: `advance`, `account` and `keep` are for `driver`."""

    def __init__(
        self, opening: OpeningSystem, scheme: Scheme, limit: int, columns: Sequence[str], steps: int, energies: bool
    ) -> None:
        self.opening, self.scheme, self.limit = opening, scheme, limit
        points = len(opening.normals)
        self.points, self.made = points, 0
        self.lengths: dict[float, Length] = {}
        self.observers = opening.equations.rows(columns)[0]
        pressure = np.array([name == "contact_pressure" for name in columns], dtype=float)
        self.pressure = pressure / opening.system.base_length
        self.find = Compilable(find_contacts, steps * PLAIN_POINT * points**2)
        self.law, self.work = self.find.room(law_of(opening.law)), self.find.room(work_for(points))
        self.losses = SystemLosses(opening, scheme.step) if energies else None

    def length(self, ratio: float) -> Length:
        """Return what belongs to a length, over the scheme's step; that of the whole step is always kept."""
        if ratio not in self.lengths:
            if len(self.lengths) >= LENGTHS:
                self.lengths = {1.0: self.lengths[1.0]}
            length = self.lengths[ratio] = Length(self.opening, self.scheme, ratio)
            length.flexible = self.find.room(length.flexible)
            self.made += 1
        return self.lengths[ratio]

    def start_state(self) -> SystemState:
        """Return the state at t = 0: unstrained, without contact force, the points at the starting gap."""
        e, dt = self.opening.equations, self.scheme.step
        upwards = np.zeros((len(e.mass), 6))
        upwards[:, 1] = dt * self.opening.velocity
        P = np.einsum("nij,nj->ni", e.mass, upwards).ravel()
        F = dt * dt * e.F * self.opening.system.load_size
        f = F if self.scheme.start == "consistent" else np.zeros_like(F)
        contacts = at_rest(np.full(self.points, self.opening.law.gap), self.points)
        return SystemState(np.zeros_like(F), P, f, np.zeros(len(e.pressure)), self.find.room(contacts))

    def history(self, steps: int) -> SystemHistory:
        """Return room for so many steps."""
        stored = steps if self.losses else 0
        points = [(steps, self.points)] * 5
        rows = zeros((steps, len(self.observers)), (steps, 2), (stored, 4), *points)
        return SystemHistory(*(rows + zeros((steps, self.points), dtype=np.int8)))

    def base(self, begun: float, ratio: float) -> Array:
        """Return how far the base moves in a part of a step, along its normal and its tangent [m]."""
        start, end = self.opening.base([begun * self.scheme.step, (begun + ratio) * self.scheme.step])
        moved: Array = end - start
        return moved


def advance(
    body: OpeningBody, state: SystemState, after: SystemState, base: object, begun: float, ratio: float
) -> tuple[int, int]:
    """Make a step, or a part of one, from `state` to `after`; return the outcome and the number of solves."""
    length = body.length(ratio)
    scheme, stepper = length.scheme, length.stepper
    P, f, mu = ratio * state.P, ratio * ratio * state.f, ratio * ratio * state.mu
    held = stepper.k @ state.D + stepper.Bt @ mu
    dD, dmu = stepper.increments(predictor(scheme, P, f) + scheme.alpha * (length.F - held), length.still)
    moved = length.rows @ dD
    carried = body.base(begun, ratio)
    n = body.points
    free = Free(np.array(state.contacts.gap) + moved[:n] - carried[0], np.zeros(n), np.zeros(n))
    if len(moved) > n:
        free.slide[:] = moved[n:] - carried[1]
        free.paired[:2] = (free.slide[0] + free.slide[-1]) / 2, free.slide[-1] - free.slide[0]
    outcome, solves = body.find(body.law, state.contacts, free, length.flexible, body.limit, after.contacts, body.work)
    if outcome != FOUND:
        return outcome, solves
    forces = np.array([*after.contacts.normal, *after.contacts.shear])[: len(moved)]
    after.D = state.D + dD
    mu = mu + dmu
    pressed = np.zeros_like(dD)
    if np.any(forces):
        after.D = after.D + length.moved @ forces
        mu = mu + length.glued @ forces
        pressed = length.push @ forces
    f1 = length.F - (stepper.k @ after.D + stepper.Bt @ mu) + pressed
    after.P = velocity_corrector(scheme, P, f, f1) / ratio
    after.f = f1 / (ratio * ratio)
    after.mu = mu / (ratio * ratio)
    return FOUND, solves


def account(
    body: OpeningBody,
    state: SystemState,
    after: SystemState,
    base: object,
    begun: float,
    ratio: float,
    history: SystemHistory,
    counts: Counts,
    number: int,
) -> None:
    """Add what an accepted part of a step slips and loses."""
    history.slipped[number] += after.contacts.slipped
    if body.losses:
        length = body.length(ratio)
        counts.losses[number] += body.losses.of_part(length, state, after, body.base(begun, ratio))


def keep(body: OpeningBody, state: SystemState, history: SystemHistory, number: int) -> bool:
    """Write the state at the end of a step; tell whether it is finite."""
    contacts = state.contacts
    history.columns[number] = body.observers @ state.D + body.pressure * np.sum(contacts.normal)
    history.momentum[number] = state.P.reshape(-1, 6)[:, :2].sum(axis=0)
    history.normal[number] = contacts.normal
    history.shear[number] = contacts.shear
    history.gap[number] = contacts.gap
    history.state[number] = contacts.state
    history.slide[number] = body.opening.tangents @ state.D - body.base(0.0, number + 1.0)[1]
    if body.losses:
        history.stored[number] = body.losses.stored(state)
    return bool(np.isfinite(state.D).all())


make_steps = driver(advance, account, keep)
