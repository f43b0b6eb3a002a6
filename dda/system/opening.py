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

from dda.contact.points import Found, FreePoints, Points
from dda.contact.rubbing_points import find_points
from dda.contact.springs import Contact, base_directions
from dda.contact.unilateral import Unilateral
from dda.model.load import BaseMotion
from dda.one_block.two_block import TwoBlockModel
from dda.one_block.unilateral import UnilateralModel
from dda.scheme.newmark import Scheme, predictor, velocity_corrector
from dda.system.joints import FIXED
from dda.system.solution import Stepper
from dda.system.subdivision import Pattern, subdivided
from dda.system.system import BlockSystem, Equations

Array = NDArray[np.float64]


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


class SystemState(NamedTuple):
    """Where the sub-blocks are, in units of the scheme's own step dt."""

    D: Array  # unknowns
    P: Array  # dt M V
    f: Array  # dt^2 M A
    mu: Array  # dt^2 times the forces of the glue
    points: Points


class Length:
    """Everything of a step that depends on its length alone, factorised once."""

    def __init__(self, opening: OpeningSystem, scheme: Scheme, ratio: float) -> None:
        self.ratio = ratio
        self.scheme = scheme if ratio == 1 else replace(scheme, gg=scheme.gg**ratio, step=scheme.step * ratio)
        self.law, self.stepper = opening.law, Stepper(opening.equations, self.scheme)
        h2 = self.scheme.step**2
        self.F = h2 * opening.equations.F * opening.system.load_size
        self.rows = np.concatenate([opening.normals, opening.tangents]) if opening.law.shear else opening.normals
        self.still = np.zeros(len(opening.equations.pressure))
        self.push = h2 * self.rows.T
        responses = [self.stepper.increments(self.scheme.alpha * row, self.still) for row in self.push.T]
        self.moved, self.glued = (np.array([pair[i] for pair in responses]).T for i in (0, 1))
        C = self.rows @ self.moved
        self.C = (C + C.T) / 2

    def advance(
        self, state: SystemState, limit: int, carried: Sequence[float] = (0.0, 0.0)
    ) -> tuple[SystemState | None, Found]:
        """Return the state one step later, or None where the points have no single state; `state` stays as it is.

        The base moves by `carried` in the step, along its normal and its tangent [m].
        """
        s, stepper, r = self.scheme, self.stepper, self.ratio
        D, P, f, mu, before = state.D, r * state.P, r * r * state.f, r * r * state.mu, state.points
        held = stepper.k @ D + stepper.Bt @ mu
        dD, dmu = stepper.increments(predictor(s, P, f) + s.alpha * (self.F - held), self.still)
        way = self.rows @ dD
        n = len(before.gap)
        found = find_points(
            self.law, before, FreePoints(before.gap + way[:n] - carried[0], way[n:] - carried[1], self.C), limit
        )
        if found.points is None:
            return None, found
        forces = np.concatenate([found.points.normal, found.points.shear])[: len(way)]
        D, mu, pressed = D + dD, mu + dmu, np.zeros_like(D)
        if np.any(forces):
            D, mu, pressed = D + self.moved @ forces, mu + self.glued @ forces, self.push @ forces
        f1 = self.F - (stepper.k @ D + stepper.Bt @ mu) + pressed
        P = velocity_corrector(s, P, f, f1)
        return SystemState(D, P / r, f1 / (r * r), mu / (r * r), found.points), found


def start_state(opening: OpeningSystem, scheme: Scheme) -> SystemState:
    """Return the state at t = 0: unstrained, without contact force, the points at the starting gap."""
    e, dt = opening.equations, scheme.step
    upwards = np.zeros((len(e.mass), 6))
    upwards[:, 1] = dt * opening.velocity
    P = np.einsum("nij,nj->ni", e.mass, upwards).ravel()
    F = dt * dt * e.F * opening.system.load_size
    f = F if scheme.start == "consistent" else np.zeros_like(F)
    points = Points.at_rest(opening.law, len(opening.normals))
    return SystemState(np.zeros_like(F), P, f, np.zeros(len(e.pressure)), points)
