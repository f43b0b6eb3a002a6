"""The forces that a law of friction gives for a recorded motion, beside those that the motion shows.

Centroid and resultants are known from the file, by the scheme that made it. What it does not hold, rotation and
strains, follows from the resultants by the block's own equations, and how the corners share them from their springs. So
gaps and slides of both corners are known at every step, and with them the force of each law:

    stick   T = -p_s (s - reference)
    slip    T = sigma (tan(phi) N + c), N of this step where rules are consistent, of the step before where they lag
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import NamedTuple

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

    def limit(self, normal: float) -> float:
        """Return the limit of friction of a corner under a normal force [N]."""
        return self.coefficient * max(normal, 0.0) + self.cohesion

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
    D = V = np.zeros(2)
    A = body.load / body.mass * (time.start == "consistent")
    accelerations = np.empty_like(place)
    for n, there in enumerate(place):
        A1 = (there - D - gg * dt * V - dt**2 * (0.5 - alpha) * A) / (alpha * dt**2)
        V = gg * V + dt * ((1 - delta) * A + delta * A1)
        D = there
        A = accelerations[n] = A1
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


class _StepEnd(NamedTuple):
    """The end of a step: closed corners, their gaps and slides [m], normal forces [N], and the internal unknowns."""

    closed: Closed
    gap: Array
    slide: Array
    normal: Array
    unknowns: Array
    acceleration: Array


class _Response(NamedTuple):
    """What a law asks of a corner: its shear force [N], `slip_force` where it slips, and its state after the step."""

    force: float
    slip_force: float | None
    state: int
    reference: float  # m


def follow(body: Body, motion: Motion, lagged: bool) -> Followed:
    """Follow a motion with a law of friction.

    Parameters
    ----------
    lagged
        Whether a slipping corner has the friction of the step before, and forgets its shear.
    """
    observer = _Observer(body, motion)
    at_rest = _Response(0.0, None, STICK, 0.0)
    corners = [at_rest, at_rest]
    resultants = motion.forces(body)
    rows = []
    for place, force in zip(motion.place, resultants, strict=True):
        before = observer.end
        shears = [_sliding_force(body, corner.state, before.normal[c]) for c, corner in enumerate(corners)]
        for _ in range(TRIES):
            end = observer.step(place, force, corners, shears)
            responses = [_response(body, corner, before, end, c, lagged) for c, corner in enumerate(corners)]
            slip_forces = [response.slip_force for response in responses]
            if lagged or slip_forces == shears:
                break
            shears = slip_forces
        observer.accept(end)
        unbalanced = force[0] - sum(response.force for response in responses)
        sticks = [response for response in responses if response.force and response.slip_force is None]
        corners = [
            # what the law leaves is taken for a reference that is off
            corner._replace(reference=corner.reference + unbalanced / (body.shear * len(sticks)))
            if corner in sticks and corner.state == STICK
            else corner
            for corner in responses
        ]
        springs = -body.stiffness * sum(end.gap[c] for c in (0, 1) if end.closed[c])
        slips = any(response.slip_force is not None for response in responses)
        rows.append((force[0] - unbalanced, springs, end.gap, end.closed, end.closed == before.closed, slips))
    columns = [np.array(column) for column in zip(*rows, strict=True)]
    return Followed(resultants, np.column_stack(columns[:2]), *columns[2:])


def _sliding_force(body: Body, state: int, normal: float) -> float | None:
    """Return the shear force of a corner that slips on as in the step before, None if it sticks or is open."""
    if abs(state) <= STICK:
        return None
    return math.copysign(body.limit(normal), state)


def _response(body: Body, corner: _Response, before: _StepEnd, end: _StepEnd, c: int, lagged: bool) -> _Response:
    """Return what a law asks of a corner at the end of a step."""
    slide = end.slide[c]
    gap = end.gap[c]
    if not end.closed[c]:
        return _Response(0.0, None, OPEN, slide)
    state = corner.state
    reference = corner.reference
    if state == OPEN:  # it has touched down where the gap was crossed
        past = before.gap[c] / (before.gap[c] - gap) if before.gap[c] > 0 > gap else 0.0
        state = STICK
        reference = before.slide[c] + past * (slide - before.slide[c])
    if lagged and state != STICK:
        late = _sliding_force(body, state, before.normal[c])
        if state * (slide - before.slide[c]) > 0:  # it has turned round: it sticks from where the step began
            return _Response(late or 0.0, late, STICK, before.slide[c])
        return _Response(late or 0.0, late, state, slide)
    shear = -body.shear * (slide - reference)
    limit = body.limit(end.normal[c])
    if abs(shear) <= limit:
        return _Response(shear, None, STICK, reference)
    sliding = int(math.copysign(2, shear))
    if lagged:
        return _Response(shear, None, sliding, slide)
    slip_force = math.copysign(limit, shear)
    return _Response(slip_force, slip_force, sliding, slide + slip_force / body.shear)


class _Observer:
    """Rotation and strains that a motion must have had, (r, ex, ey, gxy)."""

    def __init__(self, body: Body, motion: Motion) -> None:
        self.body = body
        self.time = motion.time
        self.scale = float(np.mean(np.abs(motion.forces(body)[:, 1])))
        self.e = self.time.alpha * self.time.step**2
        self.V = np.zeros(4)
        A = np.asarray(
            np.linalg.solve(body.inertia, body.internal) * (self.time.start == "consistent"), dtype=np.float64
        )
        self.end = _StepEnd(CLOSED[0], np.zeros(2), np.zeros(2), np.zeros(2), np.zeros(4), A)
        self.inverses: dict[tuple[bool, ...], Array] = {}

    def step(
        self, place: Array, force: Array, corners: Sequence[_Response], shears: Sequence[float | None]
    ) -> _StepEnd:
        """Return the end of the next step.

        Those corners are closed whose springs come nearest to the normal resultant. The sum of the shear forces is
        known; `shears` says how corners share it that slip, the others follow their springs.
        """
        t = self.time
        body = self.body
        before = self.end.closed
        normal = force[1]
        ahead = self.end.unknowns + t.discount * t.step * self.V + t.step**2 * (0.5 - t.alpha) * self.end.acceleration
        # resultants at the middle of the base
        loads = body.internal + force[0] * body.along.mean(axis=0) + normal * body.across.mean(axis=0)
        right = body.inertia @ ahead + self.e * loads

        def end(closed: Closed) -> tuple[Array, Array, float]:
            """Return unknowns, gaps, and how far the springs are from the normal resultant."""
            x = self._unknowns(right, closed, place, normal, corners, shears)
            gap = place[1] + body.across @ x
            pulls = sum(max(gap[c], 0.0) for c in (0, 1) if closed[c])
            springs = -sum(gap[c] for c in (0, 1) if closed[c])
            return x, gap, float(abs(body.stiffness * springs - normal) + body.stiffness * pulls)

        closed = before
        x, gap, off = end(before)
        if off > NEAR * self.scale:
            ends = {corners_closed: end(corners_closed) for corners_closed in CLOSED}
            least = min(off for _, _, off in ends.values())
            near = [closed for closed, (_, _, off) in ends.items() if off <= max(2 * least, NEAR * self.scale)]
            # of two that fit alike those nearer to what was closed before
            closed = min(near, key=lambda one: (sum(a != b for a, b in zip(one, before, strict=True)), ends[one][2]))
            x, gap, _ = ends[closed]
        A: Array = (x - ahead) / self.e
        if sum(closed) == 1:  # the block is turned to where its one spring gives the normal resultant
            c = closed.index(True)
            x += np.array([(-normal / body.stiffness - gap[c]) / body.x[c], 0.0, 0.0, 0.0])
            gap = place[1] + body.across @ x
        half = body.stiffness * (gap[1] - gap[0]) / 2
        shared = np.where(closed, normal, 0.0)
        if all(closed):
            shared = np.array([normal / 2 + half, normal / 2 - half])
        return _StepEnd(closed, gap, place[0] + body.along @ x, shared, x, A)

    def accept(self, end: _StepEnd) -> None:
        """Move to the end of a step."""
        t = self.time
        rate = (1 - t.delta) * self.end.acceleration + t.delta * end.acceleration
        self.V = t.discount * self.V + t.step * rate
        self.end = end

    def _unknowns(
        self,
        right: Array,
        closed: Closed,
        place: Array,
        normal: float,
        corners: Sequence[_Response],
        shears: Sequence[float | None],
    ) -> Array:
        """Return the unknowns at the end of a step for some closed corners."""
        right = right.copy()
        body = self.body
        stuck = tuple(closed[c] and shears[c] is None for c in (0, 1))
        if sum(closed) == 1:
            right += self.e * normal * body.x[closed.index(True)] * BOTH
        for c, corner in enumerate(corners):
            if stuck[c]:
                right[1] -= self.e * body.shear * body.x[c] * (place[0] - corner.reference)
            elif closed[c]:
                right[1] += self.e * body.x[c] * (shears[c] or 0.0)
        key = (*closed, *stuck)
        if key not in self.inverses:
            S = body.inertia + self.e * body.elastic
            if all(closed):
                S += self.e * body.stiffness * (body.x[1] - body.x[0]) ** 2 / 2 * np.outer(BOTH, BOTH)
            for c in (0, 1):
                if stuck[c]:
                    S[1] += self.e * body.shear * body.x[c] * body.along[c]
            self.inverses[key] = np.asarray(np.linalg.inv(S), dtype=np.float64)
        return self.inverses[key] @ right
