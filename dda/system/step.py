r"""One step of glued blocks: the stage of `dda.march.step` in arrays, with the glue eliminated by a sparse factor.

Every block stands in its own free modes. The forces mu of the glue, whose gaps are B z, are unknowns of their own, and
are found by their increments: with C the flexibility of the glue, y the way of what is fixed and r the right-hand side,

    s x + b h^2 B' dmu = r,      B x - C dmu = G dy      by      (C + b h^2 B s^-1 B') dmu = B s^-1 r - G dy,

whose matrix is sparse, positive definite and factorised once. The force of glue is never its stiffness times a
difference of displacements. What unit forces of the contacts move, `moved`, is found by as many solves, and from it
their flexibility: one factor serves every contact state.

With viscous damping C = a0 M + a1 K springs and dashpots resist g = z + a1 v. With V = h v, q = h^2 a, c = a0 h,
m = 1 + delta c and beta = alpha + delta a1/h the end of a step obeys

    m q1 + c V* + h^2 (k g1 + B' mu1) = h^2 F,      g1 = g* + beta q1,      z1 = z* + alpha q1,

* what is known before q1: a step of the undamped equations with beta/m for alpha; mu are the forces of springs and
dashpots together.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from dda.contact.rows import FOUND, INSIDE, LOWER, Flexibility, Laws, find, rows_of, unpair, work_for
from dda.march.account import account_with
from dda.march.compiled import called_often
from dda.march.energy import ALGORITHMIC, bulk_loss
from dda.march.step import (
    Body,
    Course,
    March,
    Numbers,
    Part,
    Room,
    StageRoom,
    State,
    end_paths,
    forces_of_ways,
    free_rows,
    prescribe,
    stage_room,
    steps_by,
)
from dda.model.arrays import Array
from dda.scheme.newmark import Scheme, late_momentum
from dda.scheme.stage import Stage, implicit_weight, inertia_force, plain_stage, predictor, velocity_corrector
from dda.system.system import Equations, Factor, factor

if TYPE_CHECKING:
    from scipy.sparse import csr_array

LENGTHS = 16  # step lengths whose factors are kept
_STIFF = (1e4, 1e7)  # stiffness over inertia of a block in s from which each correction is due


class Damping(NamedTuple):
    """Viscous damping, in steps."""

    lag: float  # a1/h
    drag: float  # a0 h
    mass_factor: float  # m
    share: float  # alpha/beta


class Observation(NamedTuple):
    """What is kept of every step, a row each."""

    modes: Array  # (c, n) by the modes
    glue: Array  # (c, gaps) and by the forces of the glue [1/N]
    energies: bool  # whether kinetic and strain energy follow


@dataclass(eq=False)
class Glue:
    """Blocks in their free modes, x = shapes z, and their glue; forces and inertia in units of the step dt."""

    scheme: Scheme
    equations: Equations
    k: Array  # (n,) dt^2 k
    load: Array  # (n,) dt^2 F
    B: csr_array  # (gaps, n)
    Bt: csr_array
    C: csr_array  # C/dt^2
    contact: Array  # (m, n) openings of the contacts
    damping: Damping | None
    by_modes: Array  # (c, n) what is kept, by z
    by_glue: Array  # (c, gaps) and by dt^2 mu
    energies: bool
    find: Callable[..., tuple[int, int]]  # `dda.contact.rows.find`, compiled or not
    hold: Callable[[Any], Any]  # returns records of arrays as `find` takes them
    lengths: dict[tuple[float, float], StageSolver]

    def solver(self, march: March, stage: StageRoom, ratio: float) -> StageSolver:
        """Return what belongs to a stage of a step of some length; that of the whole step is always kept."""
        key = stage.numbers.begin, ratio
        if key not in self.lengths:
            if len(self.lengths) >= LENGTHS * march.scheme.stages:
                for known in [known for known in self.lengths if known[1] != 1]:
                    del self.lengths[known]
            self.lengths[key] = StageSolver(march, stage, ratio)
            march.made[0] += 1
        return self.lengths[key]


class GluedState(State):
    """Where glued blocks are."""

    glue: Array  # (gaps,) dt^2 mu
    felt: Array  # (n,) g; without viscous damping z itself
    held: Array  # (n,) dt^2 (F - k g - B' mu)


def joint_flexibility(weight: float, C: csr_array, B: csr_array, inverse: Array) -> csr_array:
    """Return C + weight B s^-1 B', the matrix of the joint forces' increments."""
    scaled = B.copy()
    scaled.data = B.data * inverse[B.indices]
    return C + weight * (scaled @ B.T)


class StageSolver:
    """The equations of a stage of one length, a share `ratio` of the step."""

    def __init__(self, march: March, stage: StageRoom, ratio: float) -> None:
        """Factorise the matrix of the glue, and find what forces of the contacts move."""
        glue = march.method
        self.glue = glue
        self.numbers = shortened(stage.numbers, march.scheme.gg, ratio)
        self.weight = implicit_weight(self.numbers)
        self.s = 1 + self.weight * glue.k
        self.inverse = 1 / self.s
        self.still = np.zeros(glue.B.shape[0])
        matrix = joint_flexibility(self.weight, glue.C, glue.B, self.inverse)
        self.factor = factor(matrix) if len(self.still) else Factor(np.copy, 0)
        self.corrections = sum(float(np.max(self.s)) > limit for limit in _STIFF)
        if len(glue.contact):
            dt2 = march.scheme.step**2
            responses = [self.increments(self.weight * dt2 * row, self.still) for row in glue.contact]
            self.moved = np.array([x for x, _ in responses]).T
            self.glued = np.array([dmu for _, dmu in responses]).T
            W = glue.contact @ self.moved
            W = (W + W.T) / 2
            flexible = Flexibility(W, W.copy(), np.ones(1))
            if march.laws.paired:
                unpair(flexible.paired, flexible.W)
            self.flexible = glue.hold(flexible)

    def increments(self, r: Array, push: Array) -> tuple[Array, Array]:
        """Return x and dmu of s x + b B' dmu = r, B x - C dmu = G dy.

        Where a block's stiffness outweighs its inertia in s, its rigid motion is a small difference
        of joint forces: each correction takes the digits back that this costs.
        """
        x, dmu = self._solve(r, push)
        for _ in range(self.corrections):
            residual = r - self.s * x - self.weight * (self.glue.Bt @ dmu)
            correction = self._solve(residual, push - self.glue.B @ x + self.glue.C @ dmu)
            x = x + correction[0]
            dmu = dmu + correction[1]
        return x, dmu

    def _solve(self, r: Array, push: Array) -> tuple[Array, Array]:
        dmu = self.factor.solve(self.glue.B @ (self.inverse * r) - push)
        return self.inverse * (r - self.weight * (self.glue.Bt @ dmu)), dmu


def shortened(stage: Stage, gg: float, ratio: float) -> Stage:
    """Return the numbers of a stage of a shorter step, for a state in units of the whole one."""
    by_velocity = {name: ratio * getattr(stage, name) for name in ("d_u", "d_g", "g_0", "g_g", "delta")}
    by_acceleration = {name: ratio * ratio * getattr(stage, name) for name in ("e_0", "e_g", "alpha")}
    return stage._replace(gg=gg**ratio, **by_velocity, **by_acceleration)


def glued_march(
    equations: Equations,
    size: float,
    scheme: Scheme,
    observation: Observation,
    steps: int,
    laws: Laws,
    contact: Array,
) -> March:
    """Return the march of glued blocks, with what belongs to whole steps made.

    Parameters
    ----------
    size
        Of the loads.
    contact : (m, unknowns) array
        Rows of contact, each of one block with all its unknowns.
    """
    rows = contact @ equations.shapes
    n = len(equations.k)
    m = len(rows)
    points = laws.contacts
    if laws.paired:
        rows[2:] = (rows[2] + rows[3]) / 2, rows[3] - rows[2]
    first = [int(np.argmax(row != 0)) // 6 * 6 for row in contact]
    ground = np.zeros((m, 2))
    ground[:points, 1] = 1.0
    ground[points:, 0] = 1.0
    body = Body(
        k=equations.k,
        loads=np.zeros((0, n)),
        stored=np.zeros(0),
        first=first,
        weight=[row[start : start + 6].tolist() for row, start in zip(rows, first, strict=True)],
        ground=ground.tolist(),
        mobility=np.ones(n),
    )
    dt = scheme.step
    damping = None
    numbers = [plain_stage(stage) for stage in scheme.stages]
    if scheme.damped:
        lag = scheme.stiffness_damping / dt
        drag = scheme.mass_damping * dt
        mass_factor = 1 + scheme.delta * drag
        beta = scheme.alpha + scheme.delta * lag
        damping = Damping(lag, drag, mass_factor, scheme.alpha / beta if beta else 1.0)
        numbers = [numbers[0]._replace(alpha=beta / mass_factor)]
    flexible = Flexibility(np.zeros((m, m)), np.zeros((m, m)), np.ones(1))
    closed = rows_of(np.zeros(m), np.zeros(m))
    work = work_for(points, m)
    search, hold = called_often(find, (laws, closed, flexible, closed, work), steps * (points // 2) ** 2)
    glue = Glue(
        scheme=scheme,
        equations=equations,
        k=dt * dt * equations.k,
        load=dt * dt * size * equations.F,
        B=equations.B,
        Bt=equations.B.T.tocsr(),
        C=equations.C / dt**2,
        contact=rows,
        damping=damping,
        by_modes=observation.modes,
        by_glue=observation.glue / dt**2,
        energies=observation.energies,
        find=search,
        hold=hold,
        lengths={},
    )
    stages = [stage_room(stage, 0, 0, False) for stage in numbers]
    made = March(
        body=body,
        laws=hold(laws),
        scheme=Numbers(len(stages), scheme.table is None, True, False, scheme.gg, dt, float(scheme.lag)),
        first=stages[0],
        last=stages[-1],
        between=start_state(glue, np.zeros(m), np.zeros(n), np.zeros(2)),
        room=Room([0.0, 0.0], [0.0, 0.0], p=[], a=[], R=[], x=[0.0] * n, pushed=[], free=[0.0] * m, force=[0.0] * m),
        work=hold(work),
        made=np.zeros(2),
        method=glue,
    )
    for stage in stages:
        glue.solver(made, stage, 1.0)
    return made


def start_state(glue: Glue, opening: Array, velocity: Array, moved: Array) -> GluedState:
    """Return the state at t = 0: unstrained, without contact force.

    Parameters
    ----------
    opening : (m,) array
        Of the rows of contact [m].
    velocity : (n,) array
        Of the modes.
    moved : (2,) array
        Displacement of what is fixed, which stretches the glue [m].
    """
    scheme = glue.scheme
    force = -(scheme.step**2 * (glue.equations.kappa @ (glue.equations.G @ moved)))
    R = glue.load - glue.Bt @ force
    a = R.copy() if scheme.start == "consistent" else 0 * R
    p = late_momentum(scheme, scheme.step * velocity, a)
    rows = glue.hold(rows_of(opening, np.where(opening > 0, LOWER, INSIDE)))
    state = GluedState(0 * R, p, a, R, [0.0] * len(opening), rows)
    state.glue = force
    state.felt = 0 * R if glue.damping else state.z
    state.held = R.copy()
    return state


def make_stage(
    march: March, stage: StageRoom, start: GluedState, before: GluedState, after: GluedState, course: Course, part: Part
) -> tuple[int, int]:
    """Go from the end of the stage before to the end of a stage; return the outcome and the number of solves."""
    glue = march.method
    room = march.room
    solver = glue.solver(march, stage, part.ratio)
    numbers = solver.numbers
    prescribe(march, course, stage, part)
    if glue.damping is not None:
        make_damped_stage(glue, solver, start, after)
        return FOUND, 0
    ahead = predictor(numbers, start.p, start.a, before.p, before.a)
    held = inertia_force(numbers, before.held, start.R, start.a)
    push = solver.still
    if room.start != room.end:
        push = glue.equations.G @ np.subtract(room.end, room.start)
    x, dmu = solver.increments(ahead + numbers.alpha * held, push)
    outcome = FOUND
    solves = 0
    pushed = 0.0
    if len(glue.contact):
        room.x[:] = x.tolist()
        free_rows(march, before)
        outcome, solves = glue.find(march.laws, before.rows, solver.flexible, after.rows, march.work)
        if outcome != FOUND:
            return outcome, solves
        end_paths(march, solver.flexible, before, after)
        forces_of_ways(march, after.rows.force)
        force = np.array(room.force)
        x = x + solver.moved @ force
        dmu = dmu + solver.glued @ force
        pushed = march.scheme.step**2 * (force @ glue.contact)
    np.add(before.z, x, out=after.z)
    np.add(before.glue, dmu, out=after.glue)
    np.subtract(glue.load - glue.k * after.z, glue.Bt @ after.glue, out=after.held)
    np.add(after.held, pushed, out=after.R)
    after.a[:] = inertia_force(numbers, after.R, start.R, start.a)
    after.p[:] = velocity_corrector(numbers, start.p, start.a, before.a, after.a)
    return outcome, solves


def make_damped_stage(glue: Glue, solver: StageSolver, start: GluedState, after: GluedState) -> None:
    """Make a step with viscous damping."""
    numbers = solver.numbers
    lag, drag, mass_factor, share = glue.damping
    ahead = predictor(numbers, start.p, start.a, start.p, start.a)
    coming = velocity_corrector(numbers, start.p, start.a, start.a, 0 * start.a)
    faster = lag * (coming - start.p)
    x, dmu = solver.increments(ahead + faster + numbers.alpha * (start.held - drag * coming), solver.still)
    after.z[:] = start.z + share * x + (1 - share) * ahead - share * faster
    after.felt[:] = start.felt + x
    after.glue[:] = start.glue + dmu
    after.held[:] = glue.load - glue.k * after.felt - glue.Bt @ after.glue
    after.a[:] = (after.held - drag * coming) / mass_factor
    after.p[:] = coming + glue.scheme.delta * after.a


def half_square(x: Array) -> float:
    """Return x' x / 2."""
    return float(x @ x) / 2


def add_bulk_loss(march: March, state: GluedState, after: GluedState, part: Part, sums: Array) -> None:
    """Add what Newmark's step loses beside the contacts [J], with A0 that may be any."""
    glue = march.method
    delta = glue.scheme.delta
    dt2 = glue.scheme.step**2
    moved = after.z - state.z
    stiff = strain_energy(glue, moved, after.glue - state.glue)
    kinetic = (half_square(after.a) - half_square(state.a)) / dt2 / dt2
    change = half_square(after.a - state.a) / dt2 / dt2
    sums[ALGORITHMIC] += (1 - delta) * float(moved @ (state.R - state.a)) / dt2
    sums[ALGORITHMIC] += bulk_loss(glue.scheme.alpha, delta, dt2 * part.ratio**2, 2 * stiff, kinetic, change)


def strain_energy(glue: Glue, z: Array, force: Array) -> float:
    """Return that of blocks and glue, z' k z / 2 + mu' C mu / 2 [J]."""
    return float(z @ (glue.k * z) + force @ (glue.C @ force)) / 2 / glue.scheme.step**2


def keep(march: March, state: GluedState, rows: Array, number: int) -> bool:
    """Write what is observed at the end of a step; tell whether it is finite, or without contacts, which never stop."""
    glue = march.method
    observed = glue.by_modes @ state.z + glue.by_glue @ state.glue
    if not len(glue.contact):
        rows[number] = observed
        return True
    lag = march.scheme.lag
    discount = march.scheme.gg if number == 0 and lag != 0 else 1.0  # of what `late_momentum` made of p at t = 0
    p = discount * state.p + lag * state.a
    stored = []
    if glue.energies:
        stored = [half_square(p) / march.scheme.step**2, strain_energy(glue, state.z, state.glue)]
    rows[number] = np.concatenate([observed, p @ glue.equations.rigid[:, :2], stored])
    return bool(np.isfinite(state.z).all())


make_steps = steps_by(make_stage, account_with(half_square, add_bulk_loss), keep)
