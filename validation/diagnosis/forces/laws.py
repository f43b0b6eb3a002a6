"""The forces that a law of friction gives for a recorded motion, beside those that the motion shows.

Centroid and resultants are known from the file, by the scheme that made it. What it does not hold, rotation and
strains, follows from the resultants by the block's own equations, and how the corners share them from their springs. So
gaps and slides of both corners are known at every step, and with them the force of each law:

    stick   T = -p_s (s - reference)
    slip    T = sigma (tan(phi) N + c), N of this step where rules are consistent, of the step before where they lag
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np

import dda
from validation.runs.history import Array
from validation.scenes.scene import Scene
from validation.scenes.tables import TimeSection
from validation.solvers.dda import model_of
from validation.theory.friction import coefficient
from validation.theory.statics import size

STANDARD = 9.81  # m/s2
INTERNAL = slice(2, 6)  # r, ex, ey, gxy among the six unknowns of a block
OPEN, STICK = 0, 1  # slip is +2 or -2, the sign of the force
Closed = tuple[bool, bool]  # of the two corners
CLOSED: tuple[Closed, ...] = ((True, True), (True, False), (False, True), (False, False))
BOTH = np.array([1.0, 0.0, 0.0, 0.5])  # of r and gxy in the difference of the corners' gaps, over the width
TRIES = 4  # of how corners share the shear force, where friction is that of the same step
NEAR = 0.001  # of the mean normal resultant: of closed corners that fit it so well, those of the step before are taken


@dataclass(frozen=True, eq=False)
class Body:
    """A rectangle on its two corners: M and K of (r, ex, ey, gxy), its loads, and what the corners follow."""

    mass: float  # kg
    inertia: Array  # (4, 4)
    elastic: Array  # (4, 4)
    load: Array  # (2,), on the centroid, along and across the base [N]
    internal: Array  # (4,), of pressure and traction on the internal unknowns [N m]
    x: tuple[float, float]  # of the corners from the centroid [m]
    along: Array  # (2, 4), how the internal unknowns move the corners along the base
    across: Array  # (2, 4), and across it
    stiffness: float  # p [N/m]
    shear: float  # p_s [N/m]
    coefficient: float  # tan(phi) [-]
    cohesion: float  # N a corner

    def heavier(self, weight: float) -> Body:
        """Return it under a share of its own weight as well, which acts across the base."""
        return replace(self, load=self.load - np.array([0.0, weight * STANDARD * self.mass]))

    def softer(self, softness: float) -> Body:
        """Return it on a base that lets the normal springs be stiff by exp(-softness) only."""
        return replace(self, stiffness=self.stiffness * float(np.exp(-softness)))


def body_of(scene: Scene) -> Body:
    """Return the rectangle of a scene, with the matrices of DDA's own model of it."""
    model, c = model_of(scene), scene.contact
    normal, shear = dda.spring_vectors(model.block, 0)
    half = size(scene)[0] / 2
    return Body(
        mass=scene.block.mass,
        inertia=model.mass[INTERNAL, INTERNAL],
        elastic=model.block.elastic()[INTERNAL, INTERNAL],
        load=model.force[:2],
        internal=model.force[INTERNAL],
        x=(-half, half),
        along=shear[:, INTERNAL],
        across=normal[:, INTERNAL],
        stiffness=c.stiffness,
        shear=c.shear,
        coefficient=coefficient(scene),
        cohesion=c.cohesion * half,
    )


@dataclass(frozen=True, eq=False)
class Motion:
    """Displacements of the centroid along and across the base, and its accelerations, (steps, 2)."""

    time: TimeSection  # of the scheme that made it
    place: Array  # m
    acceleration: Array  # m/s2

    def forces(self, body: Body) -> Array:
        """Return the resultants of the contact along and across the base [N], (steps, 2)."""
        return np.asarray(body.mass * self.acceleration - body.load)


def motion_of(place: Array, time: TimeSection, body: Body) -> Motion:
    """Return what a scheme must have had as accelerations for the displacements to be its own.

    A1 = (D1 - D0 - gg dt V0 - dt^2 (1/2 - alpha) A0) / (alpha dt^2), from rest.
    """
    dt, gg, alpha, delta = time.step, time.discount, time.alpha, time.delta
    D, V = np.zeros(2), np.zeros(2)
    A = body.load / body.mass if time.start == "consistent" else np.zeros(2)
    accelerations = np.empty_like(place)
    for n, there in enumerate(place):
        A1 = (there - D - gg * dt * V - dt**2 * (0.5 - alpha) * A) / (alpha * dt**2)
        V = gg * V + dt * ((1 - delta) * A + delta * A1)
        D, A, accelerations[n] = there, A1, A1
    return Motion(time, place, accelerations)


@dataclass(frozen=True, eq=False)
class Followed:
    """A motion with the forces of a law, at each step."""

    motion_forces: Array  # resultants that the motion shows, along and across [N], (steps, 2)
    law_forces: Array  # resultants of the law [N], (steps, 2)
    gap: Array  # of the corners [m], (steps, 2)
    closed: np.ndarray  # (steps, 2)
    settled: np.ndarray  # (steps,), whether the corners that are closed were so a step before
    slips: np.ndarray  # (steps,), whether some corner slips

    @property
    def scale(self) -> float:
        """Mean size of the normal resultant [N]."""
        return float(np.mean(np.abs(self.motion_forces[:, 1]))) or 1.0


class _Corner:
    """State, reference [m], and normal force [N], slide and gap [m] of the step before."""

    def __init__(self) -> None:
        self.state, self.reference, self.normal, self.slide, self.gap = STICK, 0.0, 0.0, 0.0, 0.0


@dataclass(frozen=True, eq=False)
class _StepEnd:
    """The end of a step: closed corners, their gaps and slides [m], normal forces [N], and the internal unknowns."""

    closed: Closed
    gap: Array
    slide: Array
    normal: Array
    unknowns: Array
    acceleration: Array


def follow(body: Body, motion: Motion, lagged: bool) -> Followed:
    """Follow a motion with a law of friction.

    Parameters
    ----------
    lagged
        Whether a slipping corner has the friction of the step before, and forgets its shear.
    """
    observer, corners = _Observer(body, motion), (_Corner(), _Corner())
    resultants, rows, before = motion.forces(body), [], CLOSED[0]
    for place, force in zip(motion.place, resultants, strict=True):
        shears = tuple(_sliding_force(body, corner) for corner in corners)
        for _ in range(TRIES):
            end = observer.step(place, force, corners, shears, before)
            responses = [_corner_response(body, corner, end, c, lagged) for c, corner in enumerate(corners)]
            new_shears = tuple(response.slip_force for response in responses)
            if lagged or new_shears == shears:
                break
            shears = new_shears
        observer.accept(end)
        unbalanced = force[0] - sum(response.force for response in responses)
        sticks = [response for response in responses if response.force and response.slip_force is None]
        for c, (corner, response) in enumerate(zip(corners, responses, strict=True)):
            corner.state, corner.reference = response.state, response.reference
            corner.normal, corner.slide, corner.gap = end.normal[c], end.slide[c], end.gap[c]
            # what the law leaves is taken for a reference that is off
            if response in sticks and response.state == STICK:
                corner.reference += unbalanced / (body.shear * len(sticks))
        springs = -body.stiffness * sum(end.gap[c] for c in (0, 1) if end.closed[c])
        slips = any(response.slip_force is not None for response in responses)
        rows.append((force[0] - unbalanced, springs, end.gap, end.closed, end.closed == before, slips))
        before = end.closed
    columns = [np.array(column) for column in zip(*rows, strict=True)]
    return Followed(resultants, np.column_stack(columns[:2]), *columns[2:])


@dataclass(frozen=True)
class _CornerResponse:
    """What a law asks of a corner: its shear force [N], `slip_force` where it slips, and its state after the step."""

    force: float
    slip_force: float | None
    state: int
    reference: float  # m


def _sliding_force(body: Body, corner: _Corner) -> float | None:
    """Return the shear force of a corner that slips on as in the step before, None if it sticks or is open."""
    if abs(corner.state) <= STICK:
        return None
    return math.copysign(body.coefficient * max(corner.normal, 0.0) + body.cohesion, corner.state)


def _corner_response(body: Body, corner: _Corner, end: _StepEnd, c: int, lagged: bool) -> _CornerResponse:
    """Return what a law asks of a corner at the end of a step."""
    slide, gap = end.slide[c], end.gap[c]
    if not end.closed[c]:
        return _CornerResponse(0.0, None, OPEN, slide)
    state, reference = corner.state, corner.reference
    if state == OPEN:  # it has touched down where the gap was crossed
        past = corner.gap / (corner.gap - gap) if corner.gap > 0 > gap else 0.0
        state, reference = STICK, corner.slide + past * (slide - corner.slide)
    shear = -body.shear * (slide - reference)
    limit = body.coefficient * max(end.normal[c], 0.0) + body.cohesion
    if not lagged:
        if abs(shear) <= limit:
            return _CornerResponse(shear, None, STICK, reference)
        slip_force = math.copysign(limit, shear)
        return _CornerResponse(slip_force, slip_force, int(math.copysign(2, shear)), slide + slip_force / body.shear)
    if state == STICK:
        if abs(shear) <= limit:
            return _CornerResponse(shear, None, STICK, reference)
        return _CornerResponse(shear, None, int(math.copysign(2, shear)), slide)
    late = _sliding_force(body, corner)
    if state * (slide - corner.slide) <= 0:
        return _CornerResponse(late or 0.0, late, state, slide)
    return _CornerResponse(
        late or 0.0, late, STICK, corner.slide
    )  # it has turned round: it sticks from where the step began


class _Observer:
    """Rotation and strains that a motion must have had, (r, ex, ey, gxy)."""

    def __init__(self, body: Body, motion: Motion) -> None:
        self.body, self.time = body, motion.time
        self.scale = float(np.mean(np.abs(motion.forces(body)[:, 1])))
        self.e = self.time.alpha * self.time.step**2
        self.plain = body.inertia + self.e * body.elastic
        self.x, self.V = np.zeros(4), np.zeros(4)
        self.A = np.linalg.solve(body.inertia, body.internal) if self.time.start == "consistent" else np.zeros(4)
        self.inverses: dict[tuple[bool, ...], Array] = {}

    def step(
        self, place: Array, force: Array, corners: Sequence[_Corner], shears: Sequence[float | None], before: Closed
    ) -> _StepEnd:
        """Return the end of the next step.

        Those corners are closed whose springs come nearest to the normal resultant. The sum of the shear forces is
        known; `shears` says how corners share it that slip, the others follow their springs.
        """
        t, dt, body = self.time, self.time.step, self.body
        ahead = self.x + t.discount * dt * self.V + dt * dt * (0.5 - t.alpha) * self.A
        # resultants at the middle of the base
        loads = body.internal + force[0] * body.along.mean(axis=0) + force[1] * body.across.mean(axis=0)
        right = body.inertia @ ahead + self.e * loads
        closed, (x, gap) = before, self._end(right, before, place, force, corners, shears)
        if self._off(before, gap, force[1]) > NEAR * self.scale:
            ends = {closed: self._end(right, closed, place, force, corners, shears) for closed in CLOSED}
            closed = self._nearest(ends, before, force[1])
            x, gap = ends[closed]
        A = (x - ahead) / self.e
        if sum(closed) == 1:
            x, gap = self._turned(closed.index(True), x, gap, place, force[1])
        slide = place[0] + body.along @ x
        return _StepEnd(closed, gap, slide, self._shared(closed, gap, force[1]), x, A)

    def _nearest(self, ends: Mapping[Closed, tuple[Array, Array]], before: Closed, normal: float) -> Closed:
        """Return the closed corners that fit the normal resultant; of two that do so alike, those nearer to before."""
        off = {closed: self._off(closed, gap, normal) for closed, (_, gap) in ends.items()}
        near = [closed for closed in CLOSED if off[closed] <= max(2 * min(off.values()), NEAR * self.scale)]
        return min(near, key=lambda closed: (sum(a != b for a, b in zip(closed, before, strict=True)), off[closed]))

    def accept(self, end: _StepEnd) -> None:
        """Move to the end of a step."""
        t = self.time
        self.V = t.discount * self.V + t.step * ((1 - t.delta) * self.A + t.delta * end.acceleration)
        self.x, self.A = end.unknowns, end.acceleration

    def _turned(self, c: int, x: Array, gap: Array, place: Array, normal: float) -> tuple[Array, Array]:
        """Return unknowns and gaps once the block is turned to where its one spring gives the normal resultant."""
        off = (-normal / self.body.stiffness - gap[c]) / self.body.x[c]
        x = x + np.array([off, 0.0, 0.0, 0.0])
        return x, place[1] + self.body.across @ x

    def _off(self, closed: Closed, gap: Array, normal: float) -> float:
        pulls = sum(max(gap[c], 0.0) for c in (0, 1) if closed[c])
        springs = -sum(gap[c] for c in (0, 1) if closed[c])
        return float(abs(self.body.stiffness * springs - normal) + self.body.stiffness * pulls)

    def _end(
        self,
        right: Array,
        closed: Closed,
        place: Array,
        force: Array,
        corners: Sequence[_Corner],
        shears: Sequence[float | None],
    ) -> tuple[Array, Array]:
        """Return the unknowns and the gaps at the end of a step for some closed corners."""
        right, body = right.copy(), self.body
        stuck = tuple(closed[c] and shears[c] is None for c in (0, 1))
        if sum(closed) == 1:
            right += self.e * force[1] * body.x[closed.index(True)] * BOTH
        for c, corner in enumerate(corners):
            if stuck[c]:
                right[1] -= self.e * body.shear * body.x[c] * (place[0] - corner.reference)
            elif closed[c]:
                right[1] += self.e * body.x[c] * (shears[c] or 0.0)
        x = self._inverse(closed, stuck) @ right
        return x, place[1] + self.body.across @ x

    def _inverse(self, closed: Closed, stuck: tuple[bool, ...]) -> Array:
        key = (*closed, *stuck)
        if key not in self.inverses:
            S, body = self.plain.copy(), self.body
            if all(closed):
                S += self.e * body.stiffness * (body.x[1] - body.x[0]) ** 2 / 2 * np.outer(BOTH, BOTH)
            for c in (0, 1):
                if stuck[c]:
                    S[1] += self.e * body.shear * body.x[c] * body.along[c]
            self.inverses[key] = np.asarray(np.linalg.inv(S), dtype=np.float64)
        return self.inverses[key]

    def _shared(self, closed: Closed, gap: Array, normal: float) -> Array:
        """Return the normal forces of the corners [N]."""
        if not all(closed):
            return np.where(closed, normal, 0.0)
        half = -self.body.stiffness * (gap[1] - gap[0]) / 2
        return np.array([normal / 2 - half, normal / 2 + half])
