"""The linear steps of many variants of a block at once, with the matrices of `dda`.

An upright rectangle of width a and height h moves by (v, ey, ex) and, on a base of mass m_b and spring kb, by b. Its
matrices are those of `dda.TwoBlockModel`, with entries multiplied by the variant. The springs' gap g = v - (h/2) ey - b
is summed up by itself, so that a stiff spring keeps its digits. With U = dt V and W = dt^2 A a step is

    x1 - x = gg U + (1/2 - alpha) W + alpha W1,     U1 = gg U + (1 - delta) W + delta W1
    M ((1 - a_m) W1 + a_m W) + dt^2 f((1 - a_f) x1 + a_f x) + dt C ((1 - a_f) U1 + a_f gg U) = dt^2 F

with the internal force f and viscous damping C = a0 M + a1 K; other schemes have other numbers in these places, and
composite ones two such stages (`validation.diagnosis.schemes`). A step is linear in (g, s, x, U, W, n, 1), s the shear
of the closed contact and n the gap by which the springs press at its start, as long as contact and geometry stay: such
histories are sums of powers of one matrix, which is had by stepping the unit vectors. Where the contact opens or the
geometry moves, the same step is made one by one, as `dda.solve_unilateral` does. A variant that is exact in time has
the exponential of its matrix. Contact methods with a force of their own take the step with open contact and add that
force's (`validation.diagnosis.contact_force`).
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
from validation.diagnosis.constants import ARITHMETIC
from validation.diagnosis.contact_force import FORCED, Contact, Gaps, closed_force, force_of
from validation.diagnosis.schemes import EXPLICIT, stages
from validation.diagnosis.variant import GRAVITY, Array, Flags, Histories, Rectangle, Variant
from validation.theory.stages import Stage

OPEN_CLOSE_ITERATIONS = 6  # given: as in other DDA programs
PLACES = [1, 4, 3]  # given: of v, ey and ex among the six unknowns of a block
WITH_BASE = 4  # given: unknowns
FALLS = np.array([1.0, 0.0, 0.0, 1.0])  # given: which of them have a weight: v and b


def histories(rectangle: Rectangle, variants: Sequence[Variant], steps: Array) -> Histories:
    """Return the histories of all variants from rest, in time steps of these lengths [s], (n,)."""
    beyond = max(
        0, *(-math.floor(v.shift) - min(0, math.floor(v.late)) for v in variants)
    )  # steps that the last rows report of
    longer = np.concatenate([steps, np.repeat(steps[-1:], beyond)])
    with np.errstate(all="ignore"):
        computed = _stepped(rectangle, variants, longer)
        ramped = [j for j, v in enumerate(variants) if v.ramp]
        if ramped:  # a program may have, or not have, the acceleration of the full load to start from
            at_once = _stepped(rectangle, [replace(variants[j], start="zero") for j in ramped], longer)
            for i, j in enumerate(ramped):
                ramp = variants[j].ramp / float(longer[0])
                for values, full in (
                    (computed.displacement, at_once.displacement),
                    (computed.pressure, at_once.pressure),
                ):
                    values[:, j] += _ramped(full[:, i], ramp) - full[:, i]
        return reported(computed, variants, len(steps))


def _stepped(rectangle: Rectangle, variants: Sequence[Variant], steps: Array) -> Histories:
    """Return what variants compute under loads that are there at once."""
    is_equal = len(steps) > 0 and float(np.ptp(steps)) <= ARITHMETIC * float(steps[0])
    groups: dict[tuple[Any, ...], list[int]] = {}
    for j, v in enumerate(variants):
        by_powers = is_equal and not (v.opens or v.updated)
        force = v.contact if v.contact in FORCED else "springs"
        kind = (by_powers, v.updated, _unknowns(rectangle, v), v.parts, v.exact, len(stages(v)), force)
        groups.setdefault(kind, []).append(j)
    displacement = np.empty((len(steps), len(variants)))
    pressure = np.empty_like(displacement)
    is_open = np.zeros(displacement.shape, dtype=bool)
    for (by_powers, _, unknowns, parts, *_), members in groups.items():
        stepper = Stepper(rectangle, [variants[j] for j in members], unknowns)
        if by_powers:
            displacement[:, members], pressure[:, members] = stepper.powers(float(steps[0]), len(steps), parts)
        else:
            columns = stepper.loop(np.repeat(steps / parts, parts))
            last_part = slice(parts - 1, None, parts)
            displacement[:, members] = columns.displacement[last_part]
            pressure[:, members] = columns.pressure[last_part]
            is_open[:, members] = columns.open[last_part]
    return Histories(displacement, pressure, is_open)


def _unknowns(rectangle: Rectangle, v: Variant) -> int:
    """Return how many unknowns a variant moves: with a base, with lateral strain, or without it."""
    if v.base > 0 and v.softness > 0:
        return WITH_BASE
    return 3 if rectangle.poisson + v.poisson or v.other_plane else 2


@dataclass(frozen=True, eq=False)
class Equations:
    """What a step holds apart from the motion, of every variant; d unknowns."""

    mass: Array  # M, (variants, d, d)
    stiffness: Array  # K, (variants, d, d)
    carried: Array  # by which x is carried from step to step, (variants, d, d)
    spring: Array  # by which the gap is carried [N/m], (variants,)
    pressed: Array  # by which the gap that pressed at the start of a step is carried [N/m], (variants,)
    shear: Array  # by which the shear of the contact is carried, on ex [N m], (variants,)
    damping: Array  # C, (variants, d, d)
    gap: Array  # row of the gap in x, (variants, d)
    load: Array  # F, (variants, d)


@dataclass(eq=False)
class Moving:
    """Where the variants are at the start of a step: width and height are over the scene's."""

    state: Array
    closed: Flags
    wide: Array
    high: Array


class Stepper:
    """The steps of variants with equally many unknowns."""

    def __init__(self, rectangle: Rectangle, variants: Sequence[Variant], unknowns: int) -> None:
        self.rectangle = rectangle
        self.variants = variants
        self.d = unknowns
        self.size = 4 + 3 * unknowns
        # places in a state
        self.x = slice(2, 2 + unknowns)
        self.U = slice(2 + unknowns, 2 + 2 * unknowns)
        self.W = slice(2 + 2 * unknowns, 2 + 3 * unknowns)
        numbers = {field.name: np.array([getattr(v, field.name) for v in variants]) for field in fields(Variant)}
        self.of = of = SimpleNamespace(**numbers)
        numbers_of_stages = np.array([stages(v) for v in variants])  # (variants, stages, numbers)
        self.stages: list[Any] = [Stage._make(one.T[..., None]) for one in np.moveaxis(numbers_of_stages, 1, 0)]
        self.force = variants[0].contact if variants[0].contact in FORCED else "springs"
        self.gg_displacement = np.where(np.isin(of.discounted, ("velocity", "(7)")), 1.0, of.gg)[:, None]
        self.gg_velocity = np.where(of.discounted == "displacement", 1.0, of.gg)[:, None]
        # by the increment d, (6) is A1 = d / (alpha dt^2) - gg V / (alpha dt) - ... and (7) V1 = delta d / (alpha dt)
        # + gg (1 - delta / alpha) V + ...: with gg in one of them V1 has another share of V
        is_printed = np.isin(of.discounted, ("(6)", "(7)"))
        if np.any(is_printed):
            ratio = of.delta / np.where(is_printed, of.alpha, 1.0)
            share = np.where(of.discounted == "(6)", 1 - ratio * (1 - of.gg), ratio + (1 - ratio) * of.gg)
            self.gg_velocity = np.where(is_printed[:, None], share[:, None], self.gg_velocity)
        self.keeps_springs = of.kept != "stress"
        self.gravity = of.gravity * rectangle.gravity + of.weight * GRAVITY
        self.wide = of.side  # at rest, over the scene's
        self.high = of.side * of.tall
        self.is_damped = bool(np.any(of.viscous) or np.any(of.structural))
        soft = 0.0 if unknowns == WITH_BASE else of.softness
        self.springs = rectangle.normal * np.exp(-soft)
        self.base_width = rectangle.width * self.wide  # at rest [m]
        model = rectangle.model
        normal, shear = dda.spring_vectors(model.block, 0)
        of_block = model.mass[PLACES, PLACES][:, None] * of.density
        of_block[1:] *= of.inertia
        self.masses = np.concatenate([of_block, of.base * of_block[:1]])
        self.moduli = model.block.section.area * rectangle.elasticity(variants)
        self.lever = normal[0, 4]
        self.top = model.block.corners[2, 1] / 2
        self.shear_springs = rectangle.shear * of.sheared * np.exp(-soft * of.tied) * shear[0, 3] ** 2
        self.load = of.load * rectangle.pressure * self.base_width

    # ---- matrices ----

    def equations(self, closed: Flags, wide: Array, high: Array) -> Equations:
        """Return the equations of a step, of width and height over the scene's; all arguments (variants,)."""
        d = self.d
        area = wide * high
        nothing = np.zeros_like(area)
        masses = np.array([area, area * high**2, area * wide**2, self.wide * self.high]) * self.masses
        M = masses.T[:, :d, None] * np.eye(d)
        gap = np.array([nothing + 1.0, self.lever * high, nothing, nothing - 1.0]).T[:, :d]
        top = np.array([nothing + 1.0, self.of.strain_load * self.top * high, nothing, nothing]).T[:, :d]
        F = -self.load[:, None] * top - self.gravity[:, None] * masses.T[:, :d] * FALLS[:d]
        k = self.springs * closed
        kx = self.shear_springs * wide**2 * closed
        K = np.zeros_like(M)
        strains = min(d, 3)
        K[:, 1:strains, 1:strains] = area[:, None, None] * self.moduli[:, : strains - 1, : strains - 1]
        carried = K * (self.of.kept != "springs")[:, None, None]
        if d > 2:
            K[:, 2, 2] += kx
        if d == WITH_BASE:
            K[:, 3, 3] = carried[:, 3, 3] = self.rectangle.normal / np.expm1(self.of.softness)
        K += k[:, None, None] * gap[:, :, None] * gap[:, None, :]
        lost = k * (1 - self.of.coupling) * gap[:, 1]  # of the springs' entry between v and ey
        for i, j in ((0, 1), (1, 0)):
            K[:, i, j] -= lost
            carried[:, i, j] -= lost * self.keeps_springs
        pressed = np.where(self.of.contact == "mean gap", k, self.springs) * self.keeps_springs
        C = self.of.viscous[:, None, None] * M + self.of.structural[:, None, None] * K
        return Equations(M, K, carried, k * self.keeps_springs, pressed, kx * self.keeps_springs, C, gap, F)

    def at_rest(self, closed: bool = True) -> Equations:
        """Return the equations of blocks that have not moved yet."""
        return self.equations(np.full(len(self.variants), closed), self.wide, self.high)

    # ---- one step ----

    def step(self, q: Equations, c: Any, dt: float, state: Array, middle: Array | None = None) -> Array:
        """Return the state at the end of a stage, before the contact is looked at.

        The numbers of the stage c are arrays, (variants, 1); states are (..., variants, 4 + 3 d), `state` that at the
        start of the step, `middle` that at the end of the first stage, None if this is the first.
        """
        x = state[..., self.x]
        U = state[..., self.U]
        W = state[..., self.W]
        a_f = c.af
        ahead = self.gg_displacement * c.d_u * U + c.e_0 * W
        discounted = self.gg_velocity * U
        rate = discounted + c.g_0 * W
        if middle is not None:
            ahead = ahead + c.d_g * middle[..., self.U] + c.e_g * middle[..., self.W]
            rate = rate + c.g_g * middle[..., self.W]
        pressing = q.spring * (1 - a_f[:, 0]) * state[..., 0] + q.pressed * a_f[:, 0] * state[..., -2]
        internal = times(q.carried, x) + pressing[..., None] * q.gap
        if self.d > 2:
            internal[..., 2] += q.shear * state[..., 1]
        pull = state[..., -1:] * q.load - internal - (1 - a_f) * times(q.stiffness, ahead)
        right = dt * dt * pull - times(q.mass, c.am * W)
        if self.is_damped:
            right = right - dt * times(q.damping, (1 - a_f) * rate + a_f * discounted)
        W1 = times(self.inverse(q, c, dt), right)
        increment = ahead + c.beta * W1
        end = np.empty((*W1.shape[:-1], self.size))
        end[..., 0] = state[..., 0] + np.sum(q.gap * increment, axis=-1)
        end[..., 1] = state[..., 1] + (increment[..., 2] if self.d > 2 else 0.0)
        end[..., self.x] = x + increment
        end[..., self.U] = np.where(self.of.secant[:, None], increment, rate + c.gamma * W1)
        end[..., self.W] = W1
        end[..., -2] = end[..., 0]
        end[..., -1] = state[..., -1]
        return end

    def inverse(self, q: Equations, c: Any, dt: float) -> Array:
        """Return the inverse of the matrix of a stage, (variants, d, d)."""
        beta, gamma, a_m, a_f = (number[..., None] for number in (c.beta, c.gamma, c.am, c.af))
        part = beta * dt * dt * q.stiffness
        if self.is_damped:
            part = part + gamma * dt * q.damping
        return np.asarray(np.linalg.inv((1 - a_m) * q.mass + (1 - a_f) * part))

    def stage_matrix(self, q: Equations, dt: float, stage: int) -> Array:
        """Return the matrix of a stage by unit vectors of the start and, of a second one, of the middle."""
        units = np.eye((1 + stage) * self.size)[:, None, :]
        middle = units[..., self.size :] if stage else None
        return np.moveaxis(self.step(q, self.stages[stage], dt, units[..., : self.size], middle), 0, -1)

    def matrix(self, q: Equations, dt: float) -> Array:
        """Return the matrix of a step in which contact stays, (variants, size, size)."""
        first = self.stage_matrix(q, dt, 0)
        if len(self.stages) == 1:
            return first
        second = self.stage_matrix(q, dt, 1)
        return np.asarray(second[..., : self.size] + second[..., self.size :] @ first)

    def exponential(self, q: Equations, dt: float) -> Array:
        """Return the matrix of a step that is exact in time: of x' = U, M U' = dt^2 (F - f) - dt C U, t over dt."""
        from scipy.linalg import expm

        n = len(self.variants)
        nothing = Stage._make(np.zeros((len(Stage._fields), n, 1)))  # whose W1 is the acceleration at the start
        units = np.eye(self.size)[:, None, :]
        accelerations = np.moveaxis(self.step(q, nothing, dt, units)[..., self.W], 0, -1)
        G = np.zeros((n, self.size, self.size))
        G[:, 0, self.U] = q.gap
        G[:, self.x, self.U] = np.eye(self.d)
        G[:, self.U] = accelerations
        if self.d > 2:
            G[:, 1, self.U.start + 2] = 1.0
        return np.asarray(expm(G))

    def start(self, dt: float) -> Array:
        """Return the state at rest, (variants, 4 + 3 d)."""
        q = self.at_rest()
        state = np.zeros((len(self.variants), self.size))
        W = dt * dt * times(np.linalg.inv(q.mass), q.load)
        is_explicit = np.isin(self.of.family, EXPLICIT)
        state[:, self.W] = (is_explicit | (self.of.start == "consistent"))[:, None] * W
        half_step = (self.of.family == "leapfrog")[:, None] / (2 * self.gg_velocity)
        state[:, self.U] = -half_step * W
        state[:, -1] = 1.0
        return state

    def observers(self) -> Array:
        """Return the rows of displacement and pressure in a state, (variants, 2, 4 + 3 d)."""
        rows = np.zeros((len(self.variants), 2, self.size))
        rows[:, 0, 2] = 1.0
        rows[:, 0, 3] = self.of.point * self.rectangle.height * self.high / 2
        rows[:, 1, 0] = -self.springs / self.base_width
        return rows

    # ---- locked contact in equal steps ----

    def powers(self, dt: float, steps: int, parts: int) -> tuple[Array, Array]:
        """Return displacement and pressure of locked contact in equal steps, each (steps, variants)."""
        small = dt / parts
        T, rows = self._locked_step(small)
        earlier_parts = np.linalg.matrix_power(T, parts - 1)
        rows = rows @ earlier_parts  # of the first step, then of more and more of them
        T = T @ earlier_parts
        state = self.start(small)
        power = T
        length = 1
        while length**2 < steps:  # as many steps summed up at once as there are sums
            rows = np.concatenate([rows, rows @ power], axis=1)
            power = power @ power
            length *= 2
        blocks = []
        for _ in range(math.ceil(steps / length)):
            blocks.append(times(rows, state).reshape(len(state), length, 2))
            state = times(power, state)
        observed = np.concatenate(blocks, axis=1)[:, :steps]
        return observed[..., 0].T, observed[..., 1].T

    def _locked_step(self, dt: float) -> tuple[Array, Array]:
        """Return the matrix of a step of locked contact, and the rows of displacement and pressure by its start."""
        observers = self.observers()
        if self.force == "springs":
            T = self.exponential(self.at_rest(), dt) if self.variants[0].exact else self.matrix(self.at_rest(), dt)
            return T, observers @ T
        free, push, contact, gaps = self.forced_step(dt)
        force = closed_force(self.force, contact, Gaps(*(row.T for row in gaps))).T
        T = free + push[:, :, None] * force[:, None, :]
        if self.force == "energy-conserving":
            force = -contact.stiffness[:, None] * T[:, 0]
        pressure = force / self.base_width[:, None]
        return T, np.concatenate([observers[:, :1] @ T, pressure[:, None]], axis=1)

    # ---- contact methods with a force of their own ----

    def forced_step(self, dt: float) -> tuple[Array, Array, Contact, Gaps]:
        """Return the matrix of a step with open contact, what a unit force adds to its end, and what gives the force.

        In an implicit, an energy-conserving and an impact law the contact's force is no part of M A: it enters the
        displacement by 1/2 dt^2 (by theta dt of an impulse), the velocity by dt, and A what the block's strain gives.
        """
        q = self.at_rest(closed=False)
        T = self.matrix(q, dt)
        (c,) = self.stages
        push = np.zeros((len(self.variants), self.size))
        force = times(self.inverse(q, c, dt), dt * dt * q.gap)
        if self.force in ("dashpot", "rigid"):
            push[:, self.W] = force
            push[:, self.x] = c.beta * force
            push[:, self.U] = c.gamma * force
        else:
            inverse_mass = np.linalg.inv(q.mass)
            push[:, self.x] = (c.gamma if self.force == "impact" else 0.5) * force
            push[:, self.W] = -dt * dt * times(inverse_mass @ q.stiffness, push[:, self.x])
            push[:, self.U] = c.gamma * push[:, self.W] + times(inverse_mass, dt * dt * q.gap)
        push[:, 0] = push[:, -2] = np.sum(q.gap * push[:, self.x], axis=-1)
        gap = np.zeros_like(push)
        gap[:, 0] = 1.0
        rate = np.zeros_like(push)
        rate[:, self.U] = q.gap
        mass = self.masses[0] * self.wide * self.high
        dashpot = 2 * self.of.dashpot * np.sqrt(self.springs * mass) / dt
        added_rate = np.sum(rate * push, axis=-1)
        contact = Contact(self.springs, dashpot, self.of.restitution, self.of.clipped, push[:, 0], added_rate)
        return T, push, contact, Gaps(gap, self.gg_velocity * rate, T[:, 0], np.einsum("vi,vij->vj", rate, T))

    # ---- one by one ----

    def loop(self, steps: Array) -> Histories:
        """Return the histories of contact that opens or geometry that moves."""
        first = float(steps[0])
        moving = Moving(self.start(first), np.ones(len(self.variants), dtype=bool), self.wide, self.high)
        displacement_row = self.observers()[:, 0]
        columns = []
        before = 0.0
        for dt in steps.tolist():
            if dt != before:
                matrices = self._matrices(dt) if self.force == "springs" else []
                forced_step = None if self.force == "springs" else self.forced_step(dt)
                ratio = dt / (before or dt)
                moving.state[:, self.U] *= ratio
                moving.state[:, self.W] *= ratio**2
                before = dt
            if forced_step is None:
                pressure, is_open = self._opening(dt, matrices, moving)
            else:
                pressure, is_open = self._forced(*forced_step, moving)
            columns.append((np.sum(displacement_row * moving.state, axis=-1), pressure, is_open))
        return Histories(*map(np.array, zip(*columns, strict=True)))

    def _forced(self, free: Array, push: Array, contact: Contact, gaps: Gaps, moving: Moving) -> tuple[Array, Flags]:
        """Make a step of contact with a force of its own; return pressure and open flags at its end."""
        values = Gaps(*(np.sum(row * moving.state, axis=-1) for row in gaps))
        force, closed = force_of(self.force, contact, values)
        moving.state = times(free, moving.state) + push * force[:, None]
        if self.force == "energy-conserving":
            force = np.maximum(-contact.stiffness * moving.state[:, 0], 0.0)
        return force / self.base_width, ~closed

    def _matrices(self, dt: float) -> list[list[Array]]:
        """Return the matrices of each stage with closed and with open contact; none where the geometry moves."""
        if np.any(self.of.updated):
            return []
        ends = [self.at_rest(closed) for closed in (True, False)]
        return [[self.stage_matrix(q, dt, stage) for q in ends] for stage in range(len(self.stages))]

    def _opening(self, dt: float, matrices: Sequence[Sequence[Array]], moving: Moving) -> tuple[Array, Flags]:
        """Make a step of springs that open and close; return pressure and open flags at its end."""
        of = self.of
        state = moving.state
        closed = moving.closed
        by_mean_gap = (of.contact == "mean gap") & of.opens
        middle: Array | None = None
        for stage, c in enumerate(self.stages):
            start = state if middle is None else np.concatenate([state, middle], axis=-1)
            if np.any(of.lags != ""):
                closed = np.where(of.lags == "", closed, _closed_by_start(of.lags, moving.closed, moving.state[:, 0]))
            for _ in range(OPEN_CLOSE_ITERATIONS):
                if matrices:
                    T = np.where(closed[:, None, None], *matrices[stage])
                    end = times(T, start)
                else:
                    q = self.equations(closed, moving.wide, moving.high)
                    end = self.step(q, c, dt, state, middle)
                limit = np.where(closed, of.band * of.reopening + of.hold, -of.band)
                a_f = c.af[:, 0]
                gap = np.where(by_mean_gap, (1 - a_f) * end[:, 0] + a_f * state[:, 0], end[:, 0])
                now_closed = np.where(of.opens, gap < limit, True)
                now_closed = np.where(of.lags == "opening", closed | now_closed, now_closed)
                now_closed = np.where(of.lags == "switching", closed, now_closed)
                if np.array_equal(now_closed, closed):
                    break
                closed = now_closed
            middle = end
        landing = closed & ~moving.closed & ~of.reset
        if self.d > 2 and np.any(landing):
            T = T if matrices else self.matrix(q, dt)
            end += landing[:, None] * _shear_from_touch(T, state, end)[:, None] * T[:, :, 1]
        if not matrices:
            strain = end[:, self.x] - state[:, self.x]
            moving.high = moving.high * (1 + of.updated * strain[:, 1])
            moving.wide = moving.wide * (1 + of.updated * (strain[:, 2] if self.d > 2 else 0.0))
        end[:, 1] = np.where(closed, end[:, 1], 0.0)
        end[:, -2] = np.where(closed | by_mean_gap, end[:, 0], 0.0)
        moving.state = end
        moving.closed = closed
        pressing = np.where(by_mean_gap, end[:, 0] < 0, closed)
        return np.where(pressing, -self.springs / self.base_width * end[:, 0], 0.0), ~pressing


def _closed_by_start(lags: Array, closed: Flags, gap: Array) -> Flags:
    """Return which contacts that lag are closed in a step, by how the step before ended."""
    closes = (lags == "switching") & (gap < 0)
    return np.asarray((closed & (gap <= 0)) | (~closed & closes))


def _shear_from_touch(T: Array, state: Array, end: Array) -> Array:
    """Return the shear s with which a closing contact starts a step, for it to count from where the gap was crossed.

    By the share g0 / (g0 - g1) of the step, with g the gap, the lateral strain has then grown from e0 to e1, and
    s = -(e1 - e0) g0 / (g0 - g1). Both e1 and g1 are linear in s: e1 = e + e' s and g1 = g + g' s, which leaves
    g' s^2 - b s - c = 0, b = g0 - g + g0 e', c = g0 (e - e0).
    """
    gap_rate = T[:, 0, 1]
    strain_rate = T[:, 4, 1]
    open_gap = np.maximum(state[:, 0], 0.0)  # what starts in the base has crossed already
    b = open_gap * (1 + strain_rate) - end[:, 0]
    c = open_gap * (end[:, 4] - state[:, 4])
    root = -2 * c / (b + np.sqrt(b * b + 4 * gap_rate * c))  # b > 0: the gap has been crossed
    return np.asarray(np.nan_to_num(root))


def times(matrix: NDArray[np.floating[Any]], vector: NDArray[np.floating[Any]]) -> Array:
    """Return the product of matrices (variants, m, n) and vectors (..., variants, n)."""
    return np.asarray((matrix @ vector[..., None])[..., 0])


# ---- what is written ----


def reported(computed: Histories, variants: Sequence[Variant], n: int) -> Histories:
    """Return the n rows that the variants write of what they computed: shifted, late, by a factor."""
    for j, v in enumerate(variants):
        if v.late:
            computed.pressure[:, j] = _late(computed.pressure[:, j], v.late)
        if v.shift:
            for values in (computed.displacement, computed.pressure):
                values[:, j] = _late(values[:, j], v.shift)
            computed.open[:, j] = _shifted(computed.open[:, j], math.floor(v.shift))
    displacement_factors = np.array([v.displacement_factor for v in variants])
    pressure_factors = np.array([v.pressure_factor for v in variants])
    return Histories(
        displacement_factors * computed.displacement[:n], pressure_factors * computed.pressure[:n], computed.open[:n]
    )


def _ramped(values: Array, steps: float) -> Array:
    """Return the response to loads that come on within so many steps, from that to loads that are there at once.

    The load of step n is min(1, n / steps): a sum of loads of 1 / steps each, one more at every step.
    """
    count = min(math.ceil(steps), len(values))  # a fit may try ramps of millions of steps
    shares = np.diff(np.minimum(np.arange(count + 1) / steps, 1.0)) if steps > 1 else np.ones(1)
    return np.asarray(np.convolve(values, shares)[: len(values)])


def _late(values: Array, steps: float) -> Array:
    """Return rows some steps late; half a step late is the mean of two."""
    whole = math.floor(steps)
    part = steps - whole
    late = (1 - part) * _shifted(values, whole)
    return late + part * _shifted(values, whole + 1) if part else late


def _shifted(values: NDArray[Any], late: int) -> NDArray[Any]:
    """Return the rows some steps late (the first rows at rest) or early."""
    shifted = np.roll(values, late)
    shifted[: max(late, 0)] = 0
    return shifted
