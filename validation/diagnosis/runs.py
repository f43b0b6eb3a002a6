"""The runs of many candidate changes of a block at once, by the stages of `dda` and with its matrices.

An upright rectangle of width a and height h moves by x = (v, ey, ex) and, on a base that yields, by its b; a variant
multiplies the entries of `dda.TwoBlockModel`. Contact presses by rows of its own, the gap v - (h/2) ey - b and, beside
lateral strain, the shear ex; both are summed up by themselves, so that a stiff spring keeps its digits. With U = dt V
and W = dt^2 A a stage (`dda.scheme.stage`) is

    x1 = x + predictor + alpha W1,        U1 = velocity corrector,        R1 = dt^2 (F + B' N - K x1) - dt C U1
    (1 - a_m) M W1 + a_m M W = (1 - a_f) R1 + a_f R

As long as the contact stays, its end is linear in its start: without contact force, and by what unit forces add to it.
Both are had by stepping the unit vectors. With w0 the gap at the start, w_f that at the end without contact force, w_f'
its rate there (times dt) and C, C' what a unit force adds, closed contact presses by

    N = -(delta + kappa C + c C')^-1 [kappa (w_f + b w0) + c w_f']

    springs            kappa = k                  dashpot            c beside k
    mean gap           (1 - a_f) k, b = a_f / (1 - a_f)              rigid: delta = 0, kappa = 1
    implicit           k, as a force of the end alone (Kane et al. 1999)
    energy-conserving  k / 2, b = 1 (Armero and Petocz 1998)

So histories of locked contact in equal steps are sums of powers of one matrix and cost no loop over the steps; contact
that opens, and geometry that moves, are stepped one by one, as `dda.solve_unilateral` does.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, fields, replace
from types import SimpleNamespace
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

import dda
from dda.scheme.stage import Stage, dashpot_matrix, predictor, velocity_corrector
from validation.diagnosis.contact_force import conserving, impact
from validation.diagnosis.schemes import EXPLICIT, discounts, stages
from validation.diagnosis.variant import GRAVITY, Array, Flags, Histories, Rectangle, Variant

OPEN_CLOSE_ITERATIONS = 6  # as in other DDA programs
BLOCK = 32  # steps that are summed up at once
UNEQUAL = 1e-9  # relative difference of two time steps
PLACES = [1, 4, 3]  # of v, ey and ex among the six unknowns of a block
OF_ITS_SIGN = frozenset({"dashpot", "implicit", "energy-conserving", "rigid", "impact"})  # closed where it presses
OF_A_STEP = frozenset({"dashpot", "implicit", "rigid"})  # forces that are reported as they act, not of the spring
OF_NO_ACCELERATION = frozenset({"implicit", "energy-conserving", "impact"})  # forces that enter displacement, velocity


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
    early = [-math.floor(v.shift) - min(0, math.floor(v.late)) for v in variants]
    longer = np.concatenate([steps, np.repeat(steps[-1:], max(0, *early))])  # steps that the last rows report of
    with np.errstate(all="ignore"):
        computed = _at_once(rectangle, variants, longer)
        ramped = [j for j, v in enumerate(variants) if v.ramp]
        if ramped:  # a program may have, or not have, the acceleration of the full load to start from
            from_zero = _at_once(rectangle, [replace(variants[j], start="zero") for j in ramped], longer)
            for i, j in enumerate(ramped):
                ramp = variants[j].ramp / float(longer[0])
                computed.displacement[:, j] += _ramped(from_zero.displacement[:, i], ramp)
                computed.displacement[:, j] -= from_zero.displacement[:, i]
                computed.pressure[:, j] += _ramped(from_zero.pressure[:, i], ramp) - from_zero.pressure[:, i]
        return _reported(computed, variants, len(steps))


def _at_once(rectangle: Rectangle, variants: Sequence[Variant], steps: Array) -> Histories:
    """Return what variants compute under loads that are there at once, those of one kind together."""
    is_equal = len(steps) > 0 and float(np.ptp(steps)) <= UNEQUAL * float(steps[0])
    groups: dict[tuple[Any, ...], list[int]] = {}
    for j, v in enumerate(variants):
        by_powers = is_equal and not (v.opens or v.updated)
        kind = (by_powers, v.updated, _unknowns(rectangle, v), v.parts, v.exact, len(stages(v)), v.contact)
        groups.setdefault(kind, []).append(j)
    shape = len(steps), len(variants)
    histories_of_all = Histories(np.empty(shape), np.empty(shape), np.zeros(shape, dtype=bool))
    for (by_powers, _, unknowns, parts, *_), members in groups.items():
        runs = Runs(rectangle, [variants[j] for j in members], unknowns)
        if by_powers:
            displacement, pressure = runs.powers(float(steps[0]), len(steps), parts)
            is_open = np.zeros(displacement.shape, dtype=bool)
        else:
            rows = [row[parts - 1 :: parts] for row in runs.loop(np.repeat(steps / parts, parts))]
            displacement, pressure, is_open = rows
        histories_of_all.displacement[:, members] = displacement
        histories_of_all.pressure[:, members] = pressure
        histories_of_all.open[:, members] = is_open
    return histories_of_all


def _unknowns(rectangle: Rectangle, v: Variant) -> int:
    """Return how many unknowns a variant moves: with a base, with lateral strain, or without it."""
    if v.base > 0 and v.softness > 0:
        return 4
    return 3 if rectangle.poisson + v.poisson or v.other_plane else 2


class Equations(NamedTuple):
    """What holds apart from the motion, one of each for every variant; d unknowns, r rows of contact."""

    mass: Array  # M, (variants, d)
    stiffness: Array  # K without contact, (variants, d, d)
    carried: Array  # by which x is carried from step to step, (variants, d, d)
    damping: Array  # C, (variants, d, d)
    rows: Array  # B, (variants, r, d)
    load: Array  # F, (variants, d)


class Linear(NamedTuple):
    """A stage whose contact stays, by its start and, of a second one, by the end of the first: m numbers."""

    free: Array  # its end without contact force, (variants, n, m)
    push: Array  # what unit forces of the contact add to it, (variants, n, r)
    force: Array  # of closed contact, (variants, r, m)

    @property
    def closed(self) -> Array:
        """Its end with closed contact, (variants, n, m)."""
        return np.asarray(self.free + self.push @ self.force)


@dataclass(eq=False)
class Moving:
    """Where the variants are at the start of a step: state, closed contacts, and width and height over the scene's."""

    state: Array
    closed: Flags
    wide: Array
    high: Array


class Runs:
    """The runs of variants with equally many unknowns.

    A state holds the rows of contact, x, U, W, R, the force of contact that is reported and a one.
    """

    def __init__(self, rectangle: Rectangle, variants: Sequence[Variant], unknowns: int) -> None:
        self.rectangle = rectangle
        self.d = d = unknowns
        self.r = r = 2 if d > 2 else 1
        self.q = slice(0, r)
        self.x, self.U, self.W, self.R = (slice(r + i * d, r + (i + 1) * d) for i in range(4))
        self.size = r + 4 * d + 2
        # every number of the variants by its name, one array each
        numbers = {field.name: np.array([getattr(v, field.name) for v in variants]) for field in fields(Variant)}
        self.of = of = SimpleNamespace(**numbers)
        numbers_of_stages = np.array([stages(v) for v in variants], dtype=float)  # (variants, stages, numbers)
        self.stages: list[Any] = [Stage._make(one.T[..., None]) for one in np.moveaxis(numbers_of_stages, 1, 0)]
        self.law = variants[0].contact
        self.is_exact = variants[0].exact
        self.is_updated = variants[0].updated
        self.gg_displacement, self.gg_velocity = np.array([discounts(v) for v in variants]).T[:, :, None]
        soft = of.softness * (d < 4)  # else it is the base that yields
        self.springs = rectangle.normal * np.exp(-soft)
        self.base_width = rectangle.width * of.side
        # what the scene's own matrices hold of every variant's
        model = rectangle.model
        normal, shear = dda.spring_vectors(model.block, 0)
        self.masses = model.mass[PLACES, PLACES][:, None] * of.density
        self.masses[1:] *= of.inertia
        self.moduli = model.block.section.area * rectangle.elasticity(variants)
        self.lever = normal[0, 4]
        self.top = model.block.corners[2, 1] / 2
        self.shear_springs = rectangle.shear * np.exp(-soft * of.tied) * shear[0, 3] ** 2

    # ---- matrices ---------------------------------------------------------------------------------------------------

    def equations(self, wide: Array, high: Array, closed: bool = True) -> Equations:
        """Return the equations of blocks whose width and height are so many times the scene's, (variants,)."""
        of = self.of
        d = self.d
        area = wide * high
        M = np.ones((len(wide), d))
        M[:, 0] = self.masses[0] * area
        M[:, 1] = self.masses[1] * area * high**2
        K = np.zeros((len(wide), d, d))
        strains = min(d, 3)
        K[:, 1:strains, 1:strains] = area[:, None, None] * self.moduli[:, : strains - 1, : strains - 1]
        B = np.zeros((len(wide), self.r, d))
        B[:, 0, 0] = 1.0
        B[:, 0, 1] = self.lever * high
        gravity = of.gravity * self.rectangle.gravity + of.weight * GRAVITY
        load = of.load * self.rectangle.pressure * self.base_width
        F = np.zeros((len(wide), d))
        F[:, 0] = -load - M[:, 0] * gravity
        F[:, 1] = -load * of.strain_load * self.top * high
        if d > 2:
            M[:, 2] = self.masses[2] * area * wide**2
            B[:, 1, 2] = 1.0
        if d > 3:
            B[:, 0, 3] = -1.0
            M[:, 3] = of.base * self.masses[0] * of.side**2 * of.tall
            K[:, 3, 3] = self.rectangle.normal / np.expm1(of.softness)
            F[:, 3] = -M[:, 3] * gravity
        carried = K * (of.kept != "springs")[:, None, None]
        if closed:
            lost = self.springs * (1 - of.coupling) * B[:, 0, 1]  # of the springs' entry between v and ey
            for i, j in ((0, 1), (1, 0)):
                K[:, i, j] -= lost
                carried[:, i, j] -= lost * (of.kept != "stress")
        k = self.row_springs(wide)
        whole = K + np.einsum("vr,vri,vrj->vij", k, B, B)
        C = of.viscous[:, None, None] * M[:, :, None] * np.eye(d) + of.structural[:, None, None] * whole
        return Equations(M, K, carried, C, B, F)

    def row_springs(self, wide: Array) -> Array:
        """Return the stiffness of each row of contact, (variants, r)."""
        return np.column_stack([self.springs, self.shear_springs * wide**2])[:, : self.r]

    # ---- a stage that is linear -------------------------------------------------------------------------------------

    def step(self, q: Equations, c: Any, dt: float, start: Array, force: Array) -> Array:
        """Return the end of a stage under given contact forces, (..., variants, n).

        Parameters
        ----------
        c
            The stage, whose numbers are arrays of those of every variant, (variants, 1).
        start
            Where the step starts and, of a second stage, where the first one ends, (..., variants, n or 2 n).
        force
            Of each row of contact, (..., variants, r).
        """
        state = start[..., : self.size]
        before = start[..., -self.size :]
        U = state[..., self.U]
        W = state[..., self.W]
        increment = predictor(c, self.gg_displacement * U, W, before[..., self.U], before[..., self.W])
        rate = velocity_corrector(c, self.gg_velocity * U, W, before[..., self.W], 0.0 * W)
        moved = before[..., self.x] + increment - state[..., self.x]
        internal = times(q.carried, state[..., self.x]) + times(q.stiffness, moved)
        R = dt * dt * (state[..., -1:] * q.load - internal) - dt * times(q.damping, rate)
        push = dt * dt * times(np.swapaxes(q.rows, -1, -2), force)
        inverse = np.asarray(np.linalg.inv(self.matrix(q, c, dt)), dtype=np.float64)
        kick = np.zeros_like(push)
        if self.law in OF_NO_ACCELERATION:
            kick = (c.delta if self.law == "impact" else 0.5) * times(inverse, push)
            rate = rate + push / q.mass
            push = 0.0 * push
        whole = 0.0 * push
        if self.law == "mean gap":  # whose force is that of the whole step
            whole, push = push, whole
        R = R + push
        balance = (1 - c.af) * R + c.af * state[..., self.R] - c.am * q.mass * W + whole
        end_W = times(inverse, balance / (1 - c.am))
        change = c.alpha * end_W + kick
        end_W = end_W - dt * dt * times(q.stiffness, kick) / q.mass
        increment = increment + change
        end = np.zeros((*end_W.shape[:-1], self.size))
        end[..., self.q] = before[..., self.q] + times(q.rows, increment)
        end[..., self.x] = before[..., self.x] + increment
        end[..., self.U] = np.where(self.of.secant[:, None], increment, rate + c.delta * end_W)
        end[..., self.W] = end_W
        end[..., self.R] = R - times(dt * dt * q.stiffness, change) - times(dt * q.damping, c.delta * end_W)
        end[..., -1] = state[..., -1]
        return end

    def matrix(self, q: Equations, c: Any, dt: float) -> Array:
        """Return the matrix of W1 in a stage, (variants, d, d)."""
        numbers = {name: getattr(c, name)[..., None] for name in ("alpha", "delta", "am", "af")}
        mass = q.mass[:, :, None] * np.eye(self.d)
        return dashpot_matrix(c._replace(**numbers), mass, dt * q.damping, dt * dt * q.stiffness)

    def linear(self, q: Equations, c: Any, dt: float, wide: Array, stage: int) -> Linear:
        """Return a stage by its unit vectors."""
        m = (1 + stage) * self.size
        units = np.eye(m + self.r)[:, None, :]
        whole = np.moveaxis(self.step(q, c, dt, units[..., :m], units[..., m:]), 0, -1)
        free = whole[..., :m]
        push = whole[..., m:]
        k = self.row_springs(wide)
        stiffness = k
        before = -1.0 * (self.of.kept == "stress")[:, None] * np.ones_like(k)
        own = np.eye(self.r)
        if self.law == "mean gap":
            stiffness = (1 - c.af) * k
            before = before + c.af / (1 - c.af)
        elif self.law == "energy-conserving":
            stiffness = k / 2
            before = np.ones_like(k)
        elif self.law == "rigid":
            stiffness = np.ones_like(k)
            own = 0.0 * own
        mass = self.masses[0] * self.of.side**2 * self.of.tall
        dashpot = (2 * self.of.dashpot * np.sqrt(self.springs * mass) / dt)[:, None, None]
        rows = free[:, self.q].copy()
        rows[:, :, self.q] += before[:, :, None] * np.eye(self.r)
        pressed = stiffness[:, :, None] * rows + dashpot * (q.rows @ free[:, self.U])
        flexible = own + stiffness[:, :, None] * push[:, self.q] + dashpot * (q.rows @ push[:, self.U])
        return Linear(free, push, -np.linalg.solve(flexible, pressed))

    def locked(self, q: Equations, dt: float) -> Array:
        """Return the matrix of a step with closed contact, with the force that is reported, (variants, n, n)."""
        whole = self.linear(q, self.stages[0], dt, self.of.side, 0)
        T = whole.closed
        if len(self.stages) == 2:
            second = self.linear(q, self.stages[1], dt, self.of.side, 1).closed
            T = second[..., : self.size] + second[..., self.size :] @ T
        T[:, -2] = whole.force[:, 0] if self.law in OF_A_STEP else -self.springs[:, None] * T[:, 0]
        return T

    def exponential(self, q: Equations, dt: float) -> Array:
        """Return the matrix of a step that is exact in time: of x' = U, U' = W by the forces at hand, t over dt."""
        from scipy.linalg import expm

        nothing: Any = Stage._make(np.zeros((len(Stage._fields), len(self.springs), 1)))._replace(gg=1.0)
        whole = self.linear(q, nothing, dt, self.of.side, 0)  # its W1 is the acceleration at the start
        G = np.zeros((len(self.springs), self.size, self.size))
        G[:, self.q, self.U] = q.rows
        G[:, self.x, self.U] = np.eye(self.d)
        G[:, self.U] = whole.closed[:, self.W]
        T = np.asarray(expm(G))
        T[:, -2] = -self.springs[:, None] * T[:, 0]
        return T

    def start(self, dt: float) -> Array:
        """Return the state at rest, (variants, n)."""
        q = self.equations(self.of.side, self.of.side * self.of.tall)
        state = np.zeros((len(self.springs), self.size))
        force = dt * dt * q.load
        is_explicit = np.isin(self.of.family, EXPLICIT)
        state[:, self.W] = (is_explicit | (self.of.start == "consistent"))[:, None] * force / q.mass
        half_step = (self.of.family == "leapfrog")[:, None] / (2 * self.gg_velocity)
        state[:, self.U] = -half_step * state[:, self.W]
        state[:, self.R] = force
        state[:, -1] = 1.0
        return state

    def observed(self, states: Array) -> Array:
        """Return displacement and pressure of states, or of what states are made of, (..., variants, n)."""
        height = self.of.point * self.rectangle.height * self.of.side * self.of.tall / 2
        displacement = states[..., self.r] + height * states[..., self.r + 1]
        return np.stack([displacement, states[..., -2] / self.base_width], axis=-1)

    # ---- locked contact in equal steps ------------------------------------------------------------------------------

    def powers(self, dt: float, steps: int, parts: int) -> tuple[Array, Array]:
        """Return displacement and pressure of locked contact in equal steps, each (steps, variants)."""
        small = dt / parts
        q = self.equations(self.of.side, self.of.side * self.of.tall)
        power = self.exponential(q, dt) if self.is_exact else np.linalg.matrix_power(self.locked(q, small), parts)
        rows = np.moveaxis(
            self.observed(np.moveaxis(power, -1, 0)), 0, -1
        )  # of the first step, then of more and more of them
        state = self.start(small)
        length = 1
        while length < min(BLOCK, steps):
            rows = np.concatenate([rows, rows @ power], axis=1)
            power = power @ power
            length *= 2
        blocks = []
        for _ in range(math.ceil(steps / length)):
            blocks.append(times(rows, state).reshape(len(state), length, 2))
            state = times(power, state)
        observed = np.concatenate(blocks, axis=1)[:, :steps]
        return observed[..., 0].T, observed[..., 1].T

    # ---- one by one -------------------------------------------------------------------------------------------------

    def loop(self, steps: Array) -> tuple[Array, ...]:
        """Return displacement, pressure and open flags of contact that opens or geometry that moves."""
        moving = Moving(
            self.start(float(steps[0])),
            np.ones(len(self.springs), dtype=bool),
            self.of.side,
            self.of.side * self.of.tall,
        )
        kept = []
        before = 0.0
        for dt in steps.tolist():
            if dt != before or self.is_updated:
                sets = [list(self._linear_stages(moving, dt, closed)) for closed in self._couplings()]
                ratio = dt / (before or dt)
                moving.state[:, self.U] *= ratio
                moving.state[:, self.W] *= ratio**2
                moving.state[:, self.R] *= ratio**2
                before = dt
            is_open = self._pressed(sets[-1][0], moving) if self.law in OF_ITS_SIGN else self._opened(sets, moving)
            kept.append((self.observed(moving.state), is_open))
        observed, flags = map(np.array, zip(*kept, strict=True))
        return observed[..., 0], observed[..., 1], flags

    def _couplings(self) -> tuple[bool, ...]:
        """Return for which states of the contact the equations are made: its coupling may be another one."""
        return (False, True) if np.any(self.of.coupling != 1) else (True,)

    def _linear_stages(self, moving: Moving, dt: float, closed: bool) -> Iterator[Linear]:
        q = self.equations(moving.wide, moving.high, closed)
        for stage, c in enumerate(self.stages):
            yield self.linear(q, c, dt, moving.wide, stage)

    def _pressed(self, whole: Linear, moving: Moving) -> Flags:
        """Make a step of contact that is closed where it presses; return where it is open at the end."""
        state = moving.state
        end = times(whole.free, state)
        free = end[:, 0]
        flexible = whole.push[:, 0, 0]
        force = times(whole.force, state)[:, 0]
        if self.law == "impact":
            rows = self.equations(moving.wide, moving.high).rows[:, 0]
            rates = [np.sum(rows * U, axis=-1) for U in (state[:, self.U], end[:, self.U], whole.push[:, self.U, 0])]
            rates[0] = self.gg_velocity[:, 0] * rates[0]
            force = impact(self.of.restitution, state[:, 0], rates)
            closed = force > 0
        elif self.law == "energy-conserving":
            force = conserving(self.springs, flexible, state[:, 0], free, force)
            closed = free + flexible * force < 0
        else:
            closed = (free < 0) & ((force > 0) | ~self.of.clipped)
            force = np.where(closed, force, 0.0)
        moving.state = end + whole.push[:, :, 0] * force[:, None]
        is_of_end = self.law == "energy-conserving"
        moving.state[:, -2] = np.maximum(-self.springs * moving.state[:, 0], 0.0) if is_of_end else force
        return np.asarray(~closed)

    def _opened(self, sets: Sequence[Sequence[Linear]], moving: Moving) -> Flags:
        """Make a step of springs that open and close; return where they are open at the end."""
        of = self.of
        state = moving.state
        closed = moving.closed
        start = state
        for stage, c in enumerate(self.stages):
            if np.any(of.lags != ""):
                closed = np.where(of.lags == "", closed, _closed_by_start(of.lags, moving.closed, state[:, 0]))
            for _ in range(OPEN_CLOSE_ITERATIONS):
                whole = sets[-1][stage]
                if len(sets) == 2:
                    pair = zip(whole, sets[0][stage], strict=True)
                    whole = Linear(*(np.where(closed[:, None, None], *both) for both in pair))
                force = np.where(closed[:, None], times(whole.force, start), 0.0)
                end = times(whole.free, start) + times(whole.push, force)
                limit = np.where(closed, of.band * of.reopening + of.hold, -of.band)
                gap = end[:, 0]
                if self.law == "mean gap":
                    gap = (1 - c.af[:, 0]) * gap + c.af[:, 0] * state[:, 0]
                now_closed = np.where(of.opens, gap < limit, True)
                now_closed = np.where(of.lags == "opening", closed | now_closed, now_closed)
                now_closed = np.where(of.lags == "switching", closed, now_closed)
                if np.array_equal(now_closed, closed):
                    break
                closed = now_closed
            start = np.concatenate([state, end], axis=-1)
        landing = closed & ~moving.closed & ~of.reset
        if self.d > 2 and np.any(landing):
            T = whole.closed
            ex = self.x.start + 2
            end += landing[:, None] * _shear_from_touch(T, state, end, ex)[:, None] * T[:, :, 1]
        if self.is_updated:
            strain = end[:, self.x] - state[:, self.x]
            moving.high = moving.high * (1 + of.updated * strain[:, 1])
            moving.wide = moving.wide * (1 + of.updated * (strain[:, 2] if self.d > 2 else 0.0))
        if self.d > 2:
            end[:, 1] = np.where(closed, end[:, 1], 0.0)
        pressing = end[:, 0] < 0 if self.law == "mean gap" else closed
        end[:, -2] = np.where(pressing, -self.springs * end[:, 0], 0.0)
        moving.state = end
        moving.closed = closed
        return np.asarray(~pressing)


def _closed_by_start(lags: Array, closed: Flags, gap: Array) -> Flags:
    """Return which contacts that lag are closed in a step, by how the step before ended."""
    closes = (lags == "switching") & (gap < 0)
    return np.asarray((closed & (gap <= 0)) | (~closed & closes))


def _shear_from_touch(T: Array, state: Array, end: Array, ex: int) -> Array:
    """Return the shear s with which a closing contact starts a step, for it to count from where the gap was crossed.

    By the share g0 / (g0 - g1) of the step, with g the gap, the lateral strain has then grown from e0 to e1, and
    s = -(e1 - e0) g0 / (g0 - g1). Both e1 and g1 are linear in s: e1 = e + e' s and g1 = g + g' s, which leaves
    g' s^2 - b s - c = 0, b = g0 - g + g0 e', c = g0 (e - e0).
    """
    gap_rate = T[:, 0, 1]
    open_gap = np.maximum(state[:, 0], 0.0)  # what starts in the base has crossed already
    b = open_gap * (1 + T[:, ex, 1]) - end[:, 0]
    c = open_gap * (end[:, ex] - state[:, ex])
    root = -2 * c / (b + np.sqrt(b * b + 4 * gap_rate * c))  # b > 0: the gap has been crossed
    return np.asarray(np.nan_to_num(root))


def times(matrix: Array, vector: Array) -> Array:
    """Return the product of matrices (variants, m, n) and vectors (..., variants, n)."""
    return np.asarray((matrix @ vector[..., None])[..., 0])


# ---- what is written ------------------------------------------------------------------------------------------------


def _reported(computed: Histories, variants: Sequence[Variant], n: int) -> Histories:
    """Return the n rows that the variants write of what they computed: shifted, late, by a factor."""
    for j, v in enumerate(variants):
        computed.pressure[:, j] = _late(computed.pressure[:, j], v.late)
        for values in (computed.displacement, computed.pressure):
            values[:, j] = _late(values[:, j], v.shift)
        computed.open[:, j] = _shifted(computed.open[:, j], math.floor(v.shift))
    factors = np.array([(v.displacement_factor, v.pressure_factor) for v in variants]).T
    return Histories(factors[0] * computed.displacement[:n], factors[1] * computed.pressure[:n], computed.open[:n])


def _ramped(values: Array, steps: float) -> Array:
    """Return the response to loads that come on within so many steps, of the response to loads that are there at once.

    The load of step n is min(1, n / steps): a sum of loads that each come on at once, a share of 1 / steps every step.
    """
    rising = min(math.ceil(steps), len(values))
    shares = np.diff(np.minimum(np.arange(rising + 1) / steps, 1.0)) if steps > 1 else np.ones(1)
    return np.asarray(np.convolve(values, shares)[: len(values)])


def _late(values: Array, steps: float) -> Array:
    """Return rows some steps late; half a step late is the mean of two."""
    if not steps:
        return values
    whole = math.floor(steps)
    part = steps - whole
    late = (1 - part) * _shifted(values, whole)
    return late + part * _shifted(values, whole + 1) if part else late


def _shifted(values: NDArray[Any], late: int) -> NDArray[Any]:
    """Return the rows some steps late (the first rows at rest) or early."""
    if not late:
        return values
    shifted = np.roll(values, late)
    shifted[: max(late, 0)] = 0
    return shifted
