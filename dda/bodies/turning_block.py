"""Histories of a block that may turn by any angle: its model, its steps, and what is read from them.

A step is cut where the contacts have no single state.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from time import perf_counter
from typing import ClassVar

import numpy as np

from dda.bodies.turning_body import (
    EXACT,
    Body,
    RollingMotion,
    body,
    motion_of,
    strain_matrices,
    turned,
)
from dda.bodies.turning_step import STATE, RollingState, make_steps, rolling_march
from dda.bodies.unilateral import NEWMARK, UnilateralOptions
from dda.contact.rows import INSIDE, LOWER, Laws, laws_of
from dda.contact.unilateral import Unilateral
from dda.march.energy import IMPULSE, energies_of
from dda.march.run import run
from dda.march.step import Body as ModalBody
from dda.march.step import History, course_of, state_of
from dda.model.arrays import Array, ArrayPair, Columns
from dda.model.block import displacement_rows
from dda.model.checks import check_finite
from dda.model.load import BaseMotion, LoadedBlock, at_once, pressed_part
from dda.result.contact_result import ContactResult, run_fields
from dda.result.result import COLUMNS
from dda.scheme.newmark import Scheme, late_momentum


@dataclass(frozen=True, eq=False, init=False)
class RollingModel(LoadedBlock):
    """One convex block that slides, rocks, topples and rolls over the line of its base edge, prolonged both ways.

    Pressure and traction are dead loads: they keep size and direction and act on the material points of the top edge.

    Raises
    ------
    ValueError
        If a number is not finite, the outline is not convex, the contact has a band, the eccentricity leaves nothing
        of the top edge, or base and top are not two edges of the block.
    """

    contact: Unilateral  # at every corner of the outline
    tilt: float = 0.0  # counter-clockwise at t = 0, about the end of the base that stays down [rad]
    velocity: tuple[float, float] = (0.0, 0.0)  # of the centroid at t = 0, in x and y of the block's coordinates [m/s]
    spin: float = 0.0  # at t = 0, counter-clockwise [rad/s]
    rules: ClassVar[tuple[str, ...]] = (NEWMARK,)

    def check(self) -> None:
        """Check the numbers and the edges."""
        super().check()
        at_once(self.load, "updated geometry")
        check_finite(tilt=self.tilt, spin=self.spin, velocity=self.velocity)
        if any(self.contact.band):
            raise ValueError(f"band: must be zero where the geometry is updated, got {self.contact.band!r}")
        if self.contact.damping:
            raise ValueError(f"damping: must be zero where the geometry is updated, got {self.contact.damping!r}")
        _ = self.body

    @cached_property
    def body(self) -> Body:
        """Outline and matrices in the frame of the base."""
        return body(self.block, self.base)

    @property
    def weight(self) -> Array:
        """Acceleration of gravity along and away from the base [m/s^2]."""
        return self.body.to_base @ self.load.acceleration

    @property
    def dead(self) -> ArrayPair:
        """Return where the resultants of pressure and traction act, and these, along and across the base."""
        load = self.load
        start, end = self.block.edge(self.top)
        pressed = pressed_part(start, end, load.eccentricity)
        edge_loads = ((pressed, load.pressure, (0.0, -1.0)), ((start, end), load.traction, (1.0, 0.0)))
        local = self.body.to_base
        where = []
        forces = []
        for ends, size, direction in edge_loads:
            if size:
                where.append(local @ (np.mean(ends, axis=0) - self.block.section.centroid))
                forces.append(size * float(np.hypot(*(ends[1] - ends[0]))) * (local @ direction))
        return np.array(where).reshape(-1, 2), np.array(forces).reshape(-1, 2)

    def start(self, scheme: Scheme) -> RollingState:
        """Return the state at t = 0: unstrained, without contact force, at the starting gap."""
        body = self.body
        Q = turned(self.tilt)
        touching = body.base if self.tilt == 0 else body.base[:1] if self.tilt > 0 else body.base[1:]
        down = body.xi[touching[0]]
        q = np.zeros(6)
        q[:2] = body.centroid + down - Q @ down + np.array([0.0, self.contact.gap])
        gap = (q[:2] + body.xi @ Q.T)[:, 1]
        gap[list(touching)] = self.contact.gap
        V = np.zeros(6)
        V[:2] = body.to_base @ self.velocity
        V[2] = self.spin
        push = np.zeros(6)
        for (x, y), force in zip(*self.dead, strict=True):
            push += displacement_rows(x, y).T @ (Q.T @ force)  # in axes that turn with the block
        push[:2] = Q @ push[:2] + body.M[0, 0] * self.weight
        dt = scheme.step
        R = dt * dt * (body.shapes.T @ push)
        a = R.copy() if scheme.start == "consistent" else np.zeros(6)
        p = late_momentum(scheme, dt * (body.shapes.T @ body.M @ V), a)
        ways = len(gap) if self.contact.shear else 0
        opening = np.concatenate([gap, np.zeros(ways)])
        state = state_of(6, opening, np.where(opening > 0, LOWER, INSIDE))
        return RollingState(*state._replace(p=p, a=a, R=R), q, Q)

    def history(self, scheme: Scheme, steps: int, columns: Sequence[str], options: UnilateralOptions) -> RollingResult:
        """Make the steps."""
        began = perf_counter()
        body = self.body
        law = self.contact
        with np.errstate(all="ignore"):  # overflow is an outcome
            start = self.start(scheme)
        corners = laws_of(law, len(body.xi), len(start.path), options.solve_limit)
        base = base_motion(self)
        weight = body.shapes[:2].T @ (body.M[0, 0] * self.weight)
        rows = 4 if law.shear else 2
        march = rolling_march(
            ModalBody(
                k=body.k,
                loads=weight[None],
                stored=np.ones(1),
                first=np.zeros(rows, dtype=np.int64),
                weight=np.zeros((rows, 6)),
                ground=np.zeros((rows, 2)),
                mobility=np.ones(6),
            ),
            laws_of(law, 2, rows, options.solve_limit),
            corners,
            scheme,
            body.shapes,
            body.xi,
            *self.dead,
            options.rotation,
        )
        ready = perf_counter()
        ran = run(march, start, course_of(base, 0.0), steps, make_steps, STATE, energies=True, cut=options.cut)
        history = ran.history
        reached = len(history.solves) - 1
        motion = motion_of(history.motion)
        values = observed(body, motion, history)

        def slide() -> Array:
            placed = motion.points(body.xi)[:, :, 0].T
            if base is not None:
                placed = placed - base.at(scheme.step * np.arange(reached + 1.0))[:, 0]
            return placed[:, 1:] - placed[:, :1]

        note = f"stepped, {ran.how}: outline and contacts anew at every step, {options.rotation} rotation"
        return RollingResult(
            **run_fields(history, ran.outcome, scheme, [note], (began, ready)),
            columns={name: values[name] for name in columns},
            unknowns=6,
            nonzeros=int(np.count_nonzero(body.M)),
            factorisations=ran.lengths,
            contacts=len(body.xi),
            base_contacts=body.base,
            make_slide=slide,
            make_velocity=lambda: (motion.V[1:, :2] @ body.to_base).T,
            balance=lambda: energies(self, options.rotation, corners, motion, history),
            body=body,
            motion=motion,
        )


@dataclass(frozen=True, eq=False, kw_only=True)
class RollingResult(ContactResult):
    """Histories of a block that turns; the contacts are all corners of its outline, `base_contacts` M and N."""

    body: Body
    motion: RollingMotion  # from t = 0 on

    @property
    def angle(self) -> Array:
        """Sum of the steps' rotations, (steps,) [rad]."""
        return self.motion.r[1:]

    @property
    def impulse(self) -> Array:
        """Integral of the sum of N from t = 0 on, as the scheme takes it, (steps,) [N s]."""
        return self.history.sums[1:, IMPULSE]

    @cached_property
    def slipped(self) -> Array:
        """Distance that the shear reference moved by slip in each step, (contacts, steps) [m]."""
        return np.abs(super().slipped)

    @cached_property
    def slip(self) -> Array:
        """Largest movement of the shear reference of any corner by slip, summed while it was closed, (steps,) [m]."""
        return np.asarray(np.cumsum(self.slipped, axis=1).max(axis=0))

    @cached_property
    def outline(self) -> Array:
        """Corners in the frame of the base, (steps, corners, 2) [m]."""
        return self.motion.points(self.body.xi)[1:]

    @cached_property
    def area(self) -> Array:
        """Area of the outline over that of the start, (steps,) [-]."""
        e = self.motion.e[1:]
        strained = (1 + e[:, 0]) * (1 + e[:, 1]) - e[:, 2] ** 2 / 4
        return np.asarray(np.linalg.det(self.motion.Q[1:]) * strained)


def base_motion(model: RollingModel) -> BaseMotion | None:
    """Return the motion of the base, along and away from it."""
    return model.load.motion and model.load.motion.along(model.body.to_base)


def observed(body: Body, states: RollingMotion, history: History) -> Columns:
    """Return all of `dda.COLUMNS`."""
    out = body.to_base.T
    moved = (states.c[1:] - states.c[0]) @ out.T
    E = np.einsum("ai,kij,bj->abk", out, strain_matrices(states.e[1:]), out)
    a = np.hypot(*(body.xi[body.base[1]] - body.xi[body.base[0]]))
    pressure = history.force[1:, : len(body.xi)] @ np.ones(len(body.xi)) / a
    values = (moved[:, 1], pressure, moved[:, 0], states.r[1:], E[0, 0], E[1, 1], 2 * E[0, 1])
    return dict(zip(COLUMNS, values, strict=True))


def energies(model: RollingModel, rotation: str, laws: Laws, states: RollingMotion, history: History) -> Columns:
    """Return the energies [J] from t = 0 on, the losses summed.

    They are those of `dda.march.energy`, but for the algorithmic loss, which is what the others leave of the total:
    at delta = 1 and alpha >= 1/2 none of them is negative, however far the block turns.
    """
    M = model.body.M
    V = states.V
    growth = np.ones(len(V)) if rotation == EXACT else np.linalg.det(states.Q)
    moving = growth * np.einsum("ki,ij,kj->k", V[:, :2], M[:2, :2], V[:, :2])
    turning = growth**2 * np.einsum("ki,ij,kj->k", V[:, 2:], M[2:, 2:], V[:, 2:])
    load = -(M[0, 0] * growth) * ((states.c - states.c[0]) @ model.weight)
    where, dead = model.dead
    loaded = states.points(where)
    load -= np.einsum("kma,ma->k", loaded - loaded[0], dead)
    strain = growth * np.einsum("ki,ij,kj->k", states.e, model.body.K, states.e) / 2
    springs = (history.force * history.force) @ laws.compliance / 2
    return energies_of(((moving + turning) / 2, strain, springs, load), history.sums, by_balance=True)
