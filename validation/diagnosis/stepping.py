"""The linear steps of many variants of a block at once, with the matrices of `dda`.

An upright rectangle of width a and height h moves by (v, ey, ex) and, on a base of mass m_b and spring kb, by b. Its
matrices are those of `dda.TwoBlockModel`; a variant multiplies their entries. The springs' gap g = v - (h/2) ey - b is
summed up by itself, so that a stiff spring keeps its digits. With U = dt V and W = dt^2 A a step is

    x1 - x = gg U + (1/2 - alpha) W + alpha W1,     U1 = gg U + (1 - delta) W + delta W1
    M ((1 - a_m) W1 + a_m W) + dt^2 f((1 - a_f) x1 + a_f x) + dt C ((1 - a_f) U1 + a_f gg U) = dt^2 F

with the internal force f and viscous damping C = a0 M + a1 K; other schemes have other numbers in these places, and
composite ones two such stages (`validation.diagnosis.schemes`). A step is linear in (g, s, x, U, W, n, 1), s the shear
of the closed contact and n the gap by which the springs press at its start, as long as contact and geometry stay: such
histories are sums of powers of one matrix, which is had by stepping the unit vectors, and cost no loop over the steps.
Where the contact opens or the geometry moves, the same step is made one by one, as `dda.solve_unilateral` does. A
variant that is exact in time has the exponential of its matrix. Contact methods with a force of their own take the step
with open contact and add that force's (`validation.diagnosis.contact_force`).
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, fields, replace
from types import SimpleNamespace
from typing import Any

import numpy as np
from numpy.typing import NDArray

import dda
from validation.diagnosis.contact_force import FORCED, Contact, force_of, linear_force
from validation.diagnosis.schemes import EXPLICIT, Stage, stages
from validation.diagnosis.variant import GRAVITY, Array, Flags, Histories, Rectangle, Variant

OPEN_CLOSE_ITERATIONS = 6  # as in other DDA programs
BLOCK = 32  # steps that are summed up at once
UNEQUAL = 1e-9  # relative difference of two time steps
PLACES = [1, 4, 3]  # of v, ey and ex among the six unknowns


def histories(rectangle: Rectangle, variants: Sequence[Variant], steps: Array) -> Histories:
    """Return the histories of all variants from rest.

    Parameters
    ----------
    rectangle
        The block, its springs and its load.
    variants
        What is computed.
    steps
        Length of each time step [s], shape (n,).
    """
    n = len(steps)
    # loads that come on in time act on a block that has, or has not, the acceleration of the full load to start from
    started = [j for j, v in enumerate(variants) if v.ramp and v.start == "consistent"]
    requested = variants
    variants = [*requested, *(replace(requested[j], start="zero") for j in started)]
    beyond = max(0, *(-v.shift - min(0, math.floor(v.late)) for v in variants))  # steps that the last rows report of
    longer = np.concatenate([steps, np.repeat(steps[-1:], beyond)])
    equal = n > 0 and float(np.ptp(steps)) <= UNEQUAL * float(steps[0])
    groups: dict[tuple[Any, ...], list[int]] = {}
    for j, v in enumerate(variants):
        powers = equal and not (v.opens or v.updated)
        force = v.contact if v.contact in FORCED else "springs"
        alike = (powers, v.updated, _unknowns(rectangle, v), v.parts, v.exact, len(stages(v)), force)
        groups.setdefault(alike, []).append(j)
    displacement = np.empty((len(longer), len(variants)))
    pressure = np.empty_like(displacement)
    opened = np.zeros(displacement.shape, dtype=bool)
    with np.errstate(all="ignore"):
        for (powers, _, unknowns, parts, *_), members in groups.items():
            stepper = Stepper(rectangle, [variants[j] for j in members], unknowns)
            if powers:
                columns = stepper.powers(float(longer[0]), len(longer), parts)
                displacement[:, members], pressure[:, members] = columns
            else:
                every = np.repeat(longer / parts, parts)
                columns_of_loop = stepper.loop(every)
                displacement[:, members], pressure[:, members], opened[:, members] = (
                    c[parts - 1 :: parts] for c in columns_of_loop
                )
        from_rest = dict(zip(started, range(len(requested), len(variants)), strict=True))
        for j, v in enumerate(requested):
            if v.ramp:
                for values in (displacement, pressure):
                    at_once = values[:, from_rest.get(j, j)]
                    values[:, j] += _ramped(at_once, v.ramp / float(longer[0])) - at_once
        whole = len(requested)
        return reported(Histories(displacement[:, :whole], pressure[:, :whole], opened[:, :whole]), requested, n)


def _unknowns(rectangle: Rectangle, v: Variant) -> int:
    """Return how many unknowns a variant moves: all six, with a base, with lateral strain, or without it."""
    if v.one_spring:
        return 6
    if v.base > 0 and v.softness > 0:
        return 4
    return 3 if rectangle.poisson + v.poisson or v.other_plane else 2


@dataclass(frozen=True, eq=False)
class Equations:
    """What a step holds apart from the motion, one of each for every variant; d unknowns."""

    mass: Array  # M, (variants, d, d)
    stiffness: Array  # K, (variants, d, d)
    carried: Array  # by which x is carried from step to step, (variants, d, d)
    spring: Array  # by which the gap is carried [N/m], (variants,)
    pressed: Array  # by which the gap that pressed at the start of a step is carried [N/m], (variants,)
    shear: Array  # by which the shear of the contact is carried, on ex [N m], (variants,)
    gap: Array  # row of the gap in x, (variants, d)
    load: Array  # F, (variants, d)


class Stepper:
    """The steps of variants with equally many unknowns."""

    def __init__(self, rectangle: Rectangle, variants: Sequence[Variant], unknowns: int) -> None:
        self.rectangle, self.variants, self.d = rectangle, variants, unknowns
        # every number of the variants by its name, one array each
        numbers = {field.name: np.array([getattr(v, field.name) for v in variants]) for field in fields(Variant)}
        self.of = of = SimpleNamespace(**numbers)
        numbers_of_stages = np.array([stages(v) for v in variants])  # (variants, stages, numbers)
        self.stages = []  # of each its numbers, (variants, 1)
        for of_stage in np.moveaxis(numbers_of_stages, 1, 0):
            self.stages.append(Stage(*(number[:, None] for number in of_stage.T)))
        self.size = 4 + 3 * unknowns
        self.presses = np.array([v.contact != "mean gap" for v in variants])  # by the gap of the end of the step before
        self.force = variants[0].contact if variants[0].contact in FORCED else "springs"
        self.gg_displacement = np.where(of.discounted == "velocity", 1.0, of.gg)[:, None]
        self.gg_velocity = np.where(of.discounted == "displacement", 1.0, of.gg)[:, None]
        self.keeps_stress = of.kept != "springs"
        self.keeps_springs = of.kept != "stress"
        self.gravity = of.gravity * rectangle.gravity + of.weight * GRAVITY
        is_heavy = (of.base > 0) & (of.softness > 0)
        soft = np.where(is_heavy, 0.0, of.softness)
        self.heavy = is_heavy.astype(float)
        self.normal = np.exp(-soft)  # over the scene's
        self.tangential = np.exp(-soft * of.tied)
        self.base_mass = np.where(is_heavy, of.base, 1.0)
        self.base_spring = np.where(is_heavy, rectangle.normal / np.expm1(np.where(is_heavy, of.softness, 1.0)), 1.0)
        self.elasticity = rectangle.elasticity(variants)
        self.wide = of.side  # at rest, over the scene's
        self.high = of.side * of.tall
        self.damped = bool(np.any(of.viscous) or np.any(of.structural))
        # what the scene's own matrices hold of every variant's
        model = rectangle.model
        normal, shear = dda.spring_vectors(model.block, 0)
        if self.d == 6:  # the springs of the first corner alone
            self.corner = normal[0]
            self.without_gap = model.block.elastic() + rectangle.shear / 2 * np.outer(shear[0], shear[0])
            return
        self.masses = model.mass[PLACES, PLACES][:, None] * of.density
        self.masses[1:] *= of.inertia
        self.moduli = model.block.section.area * self.elasticity
        self.lever, self.top = normal[0, 4], model.block.corners[2, 1] / 2
        self.springs = rectangle.normal * self.normal
        self.shear_springs = rectangle.shear * self.tangential * shear[0, 3] ** 2
        self.pressed = of.load * rectangle.pressure * rectangle.width * self.wide
        self.base_inertia = self.base_mass * self.masses[0] * self.wide * self.high

    # ---- matrices ---------------------------------------------------------------------------------------------------

    def equations(self, on: Flags, wide: Array, high: Array) -> Equations:
        """Return the equations of a step.

        Parameters
        ----------
        on
            Whether the contact is closed, (variants,).
        wide, high
            Width and height over the scene's, (variants,).
        """
        if self.d == 6:
            return self._on_one_spring(len(on))
        n, d, area = len(on), self.d, wide * high
        M = np.zeros((n, d, d))
        M[:, 0, 0] = self.masses[0] * area
        M[:, 1, 1] = self.masses[1] * area * high**2
        K = np.zeros((n, d, d))
        strains = min(d, 3)
        K[:, 1:strains, 1:strains] = area[:, None, None] * self.moduli[:, : strains - 1, : strains - 1]
        carried = K * self.keeps_stress[:, None, None]
        k = self.springs * on
        c = np.zeros((n, d))
        c[:, 0] = 1.0
        c[:, 1] = self.lever * high
        kx = self.shear_springs * wide**2 * on
        F = np.zeros((n, d))
        F[:, 0] = -self.pressed - M[:, 0, 0] * self.gravity
        F[:, 1] = -self.pressed * self.of.strain_load * self.top * high
        if d > 2:
            M[:, 2, 2] = self.masses[2] * area * wide**2
            K[:, 2, 2] += kx
        if d > 3:
            c[:, 3] = -self.heavy
            M[:, 3, 3] = self.base_inertia
            K[:, 3, 3] = carried[:, 3, 3] = self.base_spring
            F[:, 3] = -self.heavy * M[:, 3, 3] * self.gravity
        K += k[:, None, None] * c[:, :, None] * c[:, None, :]
        lost = k * (1 - self.of.coupling) * c[:, 1]  # of the springs' entry between v and ey
        K[:, 0, 1] -= lost
        K[:, 1, 0] -= lost
        carried[:, 0, 1] -= lost * self.keeps_springs
        carried[:, 1, 0] -= lost * self.keeps_springs
        pressed = np.where(self.presses, self.springs, k) * self.keeps_springs
        return Equations(M, K, carried, k * self.keeps_springs, pressed, kx * self.keeps_springs, c, F)

    def _on_one_spring(self, n: int) -> Equations:
        model = self.rectangle.model
        spring = self.rectangle.normal / 2
        whole = self.without_gap + spring * np.outer(self.corner, self.corner)
        k = np.array(spring)
        of_variant = (model.mass, whole, self.without_gap, k, k, np.zeros(()), self.corner, model.force)
        return Equations(*(np.repeat(array[None], n, axis=0) for array in of_variant))

    # ---- one step ---------------------------------------------------------------------------------------------------

    def step(self, q: Equations, inverse: Array, dt: float, state: Array, middle: Array | None = None) -> Array:
        """Return the state at the end of a stage, before the contact is looked at.

        Parameters
        ----------
        inverse
            Of the matrix of the stage, see `inverse`.
        state
            At the start of the step, (..., variants, 4 + 3 d).
        middle
            At the end of the first stage; None if this is the first.
        """
        d = self.d
        x, U, W = state[..., 2 : 2 + d], state[..., 2 + d : 2 + 2 * d], state[..., 2 + 2 * d : 2 + 3 * d]
        one = state[..., -1:]
        c = self.stages[0 if middle is None else 1]
        af = c.mean_force
        ahead = self.gg_displacement * c.d_u * U + c.e_0 * W
        discounted = self.gg_velocity * U
        rate = discounted + c.g_0 * W
        if middle is not None:
            ahead = ahead + c.d_g * middle[..., 2 + d : 2 + 2 * d] + c.e_g * middle[..., 2 + 2 * d : 2 + 3 * d]
            rate = rate + c.g_g * middle[..., 2 + 2 * d : 2 + 3 * d]
        pressing = q.spring * (1 - af[:, 0]) * state[..., 0] + q.pressed * af[:, 0] * state[..., -2]
        internal = times(q.carried, x) + pressing[..., None] * q.gap
        if d > 2:
            internal[..., 2 if d < 6 else 3] += q.shear * state[..., 1]
        pull = one * q.load - internal - (1 - af) * times(q.stiffness, ahead)
        right = dt * dt * pull - times(q.mass, c.mean_mass * W)
        if self.damped:
            right = right - dt * times(self._damping(q), (1 - af) * rate + af * discounted)
        W1 = times(inverse, right)
        increment = ahead + c.beta * W1
        U1 = np.where(self.of.secant[:, None], increment, rate + c.gamma * W1)
        gap = state[..., 0] + np.sum(q.gap * increment, axis=-1)
        sheared = state[..., 1] + (increment[..., 2] if d > 2 else 0.0)
        return np.concatenate([gap[..., None], sheared[..., None], x + increment, U1, W1, gap[..., None], one], axis=-1)

    def _damping(self, q: Equations) -> Array:
        return np.asarray(self.of.viscous[:, None, None] * q.mass + self.of.structural[:, None, None] * q.stiffness)

    def matrix(self, q: Equations, dt: float) -> Array:
        """Return the matrix of a step in which contact stays, by stepping the unit vectors, (variants, size, size)."""
        first = self.stage_matrix(q, dt, 0)
        if len(self.stages) == 1:
            return first
        second = self.stage_matrix(q, dt, 1)
        return np.asarray(second[..., : self.size] + second[..., self.size :] @ first)

    def stage_matrix(self, q: Equations, dt: float, stage: int) -> Array:
        """Return the matrix of a stage, by its unit vectors: of the start and, of a second one, of the middle."""
        n = len(self.variants)
        inverse = self.inverse(q, dt, stage)
        if stage == 0:
            units = np.repeat(np.eye(self.size)[:, None, :], n, axis=1)
            return np.moveaxis(self.step(q, inverse, dt, units), 0, -1)
        units = np.repeat(np.eye(2 * self.size)[:, None, :], n, axis=1)
        columns = self.step(q, inverse, dt, units[..., : self.size], units[..., self.size :])
        return np.moveaxis(columns, 0, -1)

    def inverse(self, q: Equations, dt: float, stage: int = 0) -> Array:
        """Return the inverse of the matrix of a stage, (variants, d, d)."""
        c = Stage(*(np.expand_dims(number, -1) for number in self.stages[stage]))
        part = c.beta * dt * dt * q.stiffness
        if self.damped:
            part = part + c.gamma * dt * self._damping(q)
        return np.asarray(np.linalg.inv((1 - c.mean_mass) * q.mass + (1 - c.mean_force) * part))

    def forced_matrix(self, dt: float) -> tuple[Array, Array]:
        """Return the matrix of a step with open contact, and the state that a unit contact force adds.

        In an implicit, an energy-conserving and an impact law the contact's force is no part of M A: it enters the
        displacement by 1/2 dt^2 (by theta dt of an impulse), the velocity by dt, and A what the block's strain gives.
        """
        d = self.d
        q = self.equations(np.zeros(len(self.variants), dtype=bool), self.wide, self.high)
        T = self.matrix(q, dt)
        (c,) = self.stages
        unit = dt * dt * q.gap
        inverse = self.inverse(q, dt)
        if self.force in ("dashpot", "rigid"):
            W = times(inverse, unit)
            x = c.beta * W
            U = c.gamma * W
        else:
            inverse_mass = np.linalg.inv(q.mass)
            if self.force == "impact":
                U = times(inverse, unit)
                x = c.gamma * U
                W = -dt * dt * times(inverse_mass @ q.stiffness, x)
            else:
                x = times(inverse, unit) / 2
                W = -dt * dt * times(inverse_mass @ q.stiffness, x)
                U = c.gamma * W + times(inverse_mass, unit)
        gap = np.sum(q.gap * x, axis=-1)
        push = np.zeros((len(self.variants), self.size))
        push[:, 0] = push[:, -2] = gap
        push[:, 2 : 2 + d] = x
        push[:, 2 + d : 2 + 2 * d] = U
        push[:, 2 + 2 * d : 2 + 3 * d] = W
        return T, push

    def start(self, q: Equations, dt: float) -> Array:
        """Return the state at rest, (variants, 4 + 3 d)."""
        n, d = len(self.variants), self.d
        state = np.zeros((n, self.size))
        acceleration = times(np.linalg.inv(q.mass), q.load)
        explicit = np.array([v.family in EXPLICIT for v in self.variants])
        started = explicit | (self.of.start == "consistent")
        state[:, 2 + 2 * d : 2 + 3 * d] = dt * dt * started[:, None] * acceleration
        half_step = np.array([v.family == "leapfrog" for v in self.variants])[:, None] / (2 * self.gg_velocity)
        state[:, 2 + d : 2 + 2 * d] = -half_step * dt * dt * acceleration
        state[:, -1] = 1.0
        return state

    def observers(self, q: Equations) -> Array:
        """Return the rows of displacement and pressure in a state, (variants, 2, 4 + 3 d)."""
        rows = np.zeros((len(self.variants), 2, self.size))
        if self.d == 6:
            rows[:, 0, 3] = 1.0
            rows[:, 0, 6] = self.of.point * self.rectangle.height / 2
            rows[:, 1, 0] = -self.rectangle.normal / 2 / self.rectangle.width
            return rows
        rows[:, 0, 2] = 1.0
        rows[:, 0, 3] = self.of.point * self.rectangle.height * self.high / 2
        rows[:, 1, 0] = -self.rectangle.normal * self.normal / (self.rectangle.width * self.wide)
        return rows

    # ---- histories --------------------------------------------------------------------------------------------------

    def powers(self, dt: float, steps: int, parts: int) -> tuple[Array, Array]:
        """Return displacement and pressure of locked contact in equal steps, each (steps, variants)."""
        n = len(self.variants)
        q = self.equations(np.ones(n, dtype=bool), self.wide, self.high)
        small = dt / parts
        observers = self.observers(q)
        if self.variants[0].exact:
            T = self._exponential(q, dt)
            rows = observers @ T  # of the first step, then of more and more of them
        elif self.force == "springs":
            T = self.matrix(q, small)
            T = np.linalg.matrix_power(T, parts) if parts > 1 else T
            rows = observers @ T
        else:
            T, pressure = self._with_force(small)
            whole = np.linalg.matrix_power(T, parts - 1)  # of the last of the parts, by the start of the first
            rows = np.concatenate([observers[:, :1] @ T @ whole, pressure[:, None] @ whole], axis=1)
            T = T @ whole
        state = self.start(q, small)
        power, length = T, 1
        while length < min(BLOCK, steps):
            rows = np.concatenate([rows, rows @ power], axis=1)
            power, length = power @ power, 2 * length
        blocks = []
        for _ in range(math.ceil(steps / length)):
            blocks.append(times(rows, state).reshape(n, length, 2))
            state = times(power, state)
        observed = np.concatenate(blocks, axis=1)[:, :steps]
        return observed[..., 0].T, observed[..., 1].T

    def _with_force(self, dt: float) -> tuple[Array, Array]:
        """Return the matrix of a step with the force of locked contact, and its pressure as a row by the start."""
        free, push = self.forced_matrix(dt)
        contact = self._contact(dt, push)
        force = linear_force(self.force, contact, self._gap_rows(free))
        T = free + push[:, :, None] * force[:, None, :]
        pressure = force
        if self.force == "energy-conserving":
            pressure = -contact.stiffness[:, None] * T[:, 0]
        return T, np.asarray(pressure / (self.rectangle.width * self.wide)[:, None])

    def _contact(self, dt: float, push: Array) -> Contact:
        """Return what the contact's force follows from in steps of one length."""
        mass = self.masses[0] * self.wide * self.high
        dashpot = 2 * self.of.dashpot * np.sqrt(self.springs * mass) / dt
        rate = np.sum(self._gap_of_velocity() * push, axis=-1)
        return Contact(self.springs, dashpot, self.of.restitution, self.of.clipped, push[:, 0], rate)

    def _gap_of_velocity(self) -> Array:
        """Return the row of the gap's rate in a state, (variants, size)."""
        row = np.zeros((len(self.variants), self.size))
        q = self.equations(np.zeros(len(self.variants), dtype=bool), self.wide, self.high)
        row[:, 2 + self.d : 2 + 2 * self.d] = q.gap
        return row

    def _gap_rows(self, free: Array) -> tuple[Array, Array, Array, Array]:
        """Return gap and rate at the start and at the end of a step without contact force, as rows by the start."""
        gap = np.zeros((len(self.variants), self.size))
        gap[:, 0] = 1.0
        rate = self._gap_of_velocity()
        free_rate = np.einsum("vi,vij->vj", rate, free)
        return gap, self.gg_velocity * rate, free[:, 0], free_rate

    def forced_loop(self, steps: Array) -> tuple[Array, Array, Flags]:
        """Return displacement, pressure and open flags of contact that opens and has a force of its own."""
        n = len(self.variants)
        first = self.equations(np.ones(n, dtype=bool), self.wide, self.high)
        state = self.start(first, float(steps[0]))
        displacement_row = self.observers(first)[:, 0]
        width = self.rectangle.width * self.wide
        before = 0.0
        displacements = []
        pressures = []
        flags = []
        for dt in steps.tolist():
            if dt != before:
                free, push = self.forced_matrix(dt)
                contact = self._contact(dt, push)
                gap_rows = self._gap_rows(free)
            if before and dt != before:
                state[:, 2 + self.d : 2 + 2 * self.d] *= dt / before
                state[:, 2 + 2 * self.d : 2 + 3 * self.d] *= (dt / before) ** 2
            before = dt
            w0, rate, w_f, rate_f = (np.sum(row * state, axis=-1) for row in gap_rows)
            force, closed = force_of(self.force, contact, (w0, rate, w_f, rate_f))
            state = times(free, state) + push * force[:, None]
            if self.force == "energy-conserving":
                force = np.maximum(-contact.stiffness * state[:, 0], 0.0)
            displacements.append(np.sum(displacement_row * state, axis=-1))
            pressures.append(force / width)
            flags.append(~closed)
        return np.array(displacements), np.array(pressures), np.array(flags)

    def _exponential(self, q: Equations, dt: float) -> Array:
        """Return the matrix of a step that is exact in time: of x' = U, M U' = dt^2 (F - f) - dt C U, t over dt."""
        from scipy.linalg import expm

        d, n = self.d, len(self.variants)
        G = np.zeros((n, self.size, self.size))
        over_mass = dt * dt * np.linalg.inv(q.mass)
        G[:, 0, 2 + d : 2 + 2 * d] = q.gap
        G[:, 2 : 2 + d, 2 + d : 2 + 2 * d] = np.eye(d)
        speed = slice(2 + d, 2 + 2 * d)
        G[:, speed, 0] = -times(over_mass, q.spring[:, None] * q.gap)
        G[:, speed, 2 : 2 + d] = -over_mass @ q.carried
        G[:, speed, speed] = -over_mass @ self._damping(q) / dt
        G[:, speed, -1] = times(over_mass, q.load)
        if 2 < d < 6:
            G[:, 1, 2 + d + 2] = 1.0
            G[:, speed, 1] = -over_mass[:, :, 2] * q.shear[:, None]
        return np.array([expm(one) for one in G])

    def loop(self, steps: Array) -> tuple[Array, Array, Flags]:
        """Return displacement, pressure and open flags of contact that opens or geometry that moves."""
        if self.force != "springs":
            return self.forced_loop(steps)
        n, moves = len(self.variants), bool(np.any(self.of.updated))
        wide, high, on = self.wide, self.high, np.ones(n, dtype=bool)
        first = self.equations(on, wide, high)
        state, observers = self.start(first, float(steps[0])), self.observers(first)
        weighted_gap = ~self.presses & self.of.opens
        before, rows, flags = 0.0, [], []
        for dt in steps.tolist():
            if dt != before and not moves:
                closed, opened = (
                    [
                        self.stage_matrix(self.equations(np.full(n, contact), wide, high), dt, stage)
                        for stage in range(len(self.stages))
                    ]
                    for contact in (True, False)
                )
            if before and dt != before:
                state[:, 2 + self.d : 2 + 2 * self.d] *= dt / before
                state[:, 2 + 2 * self.d : 2 + 3 * self.d] *= (dt / before) ** 2
            before, was_closed = dt, on
            middle: Array | None = None
            for stage, numbers in enumerate(self.stages):
                start = state if middle is None else np.concatenate([state, middle], axis=-1)
                for _ in range(OPEN_CLOSE_ITERATIONS):
                    if moves:
                        q = self.equations(on, wide, high)
                        end = self.step(q, self.inverse(q, dt, stage), dt, state, middle)
                    else:
                        T = np.where(on[:, None, None], closed[stage], opened[stage])
                        end = times(T, start)
                    limit = np.where(on, self.of.band * self.of.reopening, -self.of.band)
                    af = numbers.mean_force[:, 0]
                    gap = np.where(weighted_gap, (1 - af) * end[:, 0] + af * state[:, 0], end[:, 0])
                    new = np.where(self.of.opens, gap < limit, True)
                    if np.array_equal(new, on):
                        break
                    on = new
                middle = end
            landing = on & ~was_closed & ~self.of.reset
            if self.d > 2 and np.any(landing):
                T = self.matrix(q, dt) if moves else T
                end += landing[:, None] * _shear_from_touch(T, state, end)[:, None] * T[:, :, 1]
            if moves:
                strain = end[:, 2 : 2 + self.d] - state[:, 2 : 2 + self.d]
                high = high * (1 + self.of.updated * strain[:, 1])
                wide = wide * (1 + self.of.updated * (strain[:, 2] if self.d > 2 else 0.0))
            end[:, 1] = np.where(on, end[:, 1], 0.0)
            end[:, -2] = np.where(on | weighted_gap, end[:, 0], 0.0)
            state = end
            observed = times(observers, state)
            pressing = np.where(weighted_gap, end[:, 0] < 0, on)
            rows.append(np.column_stack([observed[:, 0], np.where(pressing, observed[:, 1], 0.0)]))
            flags.append(~pressing)
        columns = np.array(rows)
        return columns[..., 0], columns[..., 1], np.array(flags)


def _shear_from_touch(T: Array, state: Array, end: Array) -> Array:
    """Return the shear s with which a closing contact starts a step, for it to count from where the gap was crossed.

    By the share g0 / (g0 - g1) of the step, with g the gap, the lateral strain has then grown from e0 to e1, and
    s = -(e1 - e0) g0 / (g0 - g1). Both e1 and g1 are linear in s: e1 = e + e' s and g1 = g + g' s, which leaves
    g' s^2 - b s - c = 0, b = g0 - g + g0 e', c = g0 (e - e0).
    """
    gap_rate, strain_rate = T[:, 0, 1], T[:, 4, 1]
    open_gap = np.maximum(state[:, 0], 0.0)  # what starts in the base has crossed already
    b = open_gap * (1 + strain_rate) - end[:, 0]
    c = open_gap * (end[:, 4] - state[:, 4])
    root = -2 * c / (b + np.sqrt(b * b + 4 * gap_rate * c))  # b > 0: the gap has been crossed
    return np.asarray(np.nan_to_num(root))


def times(matrix: NDArray[np.floating[Any]], vector: NDArray[np.floating[Any]]) -> Array:
    """Return the product of matrices (variants, m, n) and vectors (..., variants, n)."""
    return np.asarray((matrix @ vector[..., None])[..., 0])


# ---- what is written ------------------------------------------------------------------------------------------------


def reported(computed: Histories, variants: Sequence[Variant], n: int) -> Histories:
    """Return the n rows that the variants write of what they computed: shifted, late, by a factor."""
    for j, v in enumerate(variants):
        if v.late:
            whole = math.floor(v.late)
            part = v.late - whole
            P = computed.pressure[:, j]
            computed.pressure[:, j] = (1 - part) * _shifted(P, whole) + (part * _shifted(P, whole + 1) if part else 0.0)
        if v.shift:
            for values in (computed.displacement, computed.pressure, computed.open):
                values[:, j] = _shifted(values[:, j], v.shift)
    displacement_factors = np.array([v.displacement_factor for v in variants])
    pressure_factors = np.array([v.pressure_factor for v in variants])
    return Histories(
        displacement_factors * computed.displacement[:n], pressure_factors * computed.pressure[:n], computed.open[:n]
    )


def _ramped(values: Array, steps: float) -> Array:
    """Return the response to loads that come on within so many steps, of the response to loads that are there at once.

    The load of step n is min(1, n / steps): a sum of loads that each come on at once, a share of 1 / steps every step.
    """
    shares = np.diff(np.minimum(np.arange(math.ceil(steps) + 1) / steps, 1.0)) if steps > 1 else np.ones(1)
    return np.asarray(np.convolve(values, shares)[: len(values)])


def _shifted(values: NDArray[Any], late: int) -> NDArray[Any]:
    """Return the rows some steps late (the first rows at rest) or early."""
    shifted = np.roll(values, late)
    shifted[: max(late, 0)] = 0
    return shifted
