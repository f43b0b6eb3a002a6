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

from dataclasses import dataclass
from functools import cached_property, lru_cache, partial
from typing import TYPE_CHECKING, Any

import numpy as np

from dda.bodies.block_system import Equations, factor
from dda.contact.rows import FOUND, INSIDE, LOWER, Flexibility, Laws, Rows, Solved, find, rows_of, unpair
from dda.march.account import account_with
from dda.march.compiled import as_lists, as_record, code_for
from dda.march.energy import ALGORITHMIC, bulk_loss
from dda.march.step import (
    Body,
    Course,
    History,
    March,
    Part,
    StageRoom,
    end_paths,
    forces_of_ways,
    free_rows,
    history_of,
    kept_discount,
    march_of,
    prescribe,
    reached_history,
    steps_by,
)
from dda.model.arrays import Array, ArrayPair
from dda.scheme.newmark import Scheme, late_momentum
from dda.scheme.stage import Stage, implicit_weight, inertia_force, predictor, velocity_corrector

if TYPE_CHECKING:
    from scipy.sparse import csr_array

LENGTHS = 32  # stages whose factors are kept
POINTS = 32  # squares of so many points take as long in plain Python as a step of one block does
_STIFF = (1e4, 1e7)  # stiffness over inertia of a block in s from which each correction is due


@dataclass(eq=False)
class Glue:
    """Blocks in their free modes, and their glue; forces and inertia in units of the step dt."""

    scheme: Scheme
    equations: Equations
    k: Array  # (n,) dt^2 k
    load: Array  # (n,) dt^2 F
    Bt: csr_array  # (n, gaps)
    C: csr_array  # C/dt^2
    contact: Array  # (m, n) openings of the contacts, by the modes
    paired: bool  # whether two of them are the mean and the difference of two ways
    observed: ArrayPair  # (c, n) and (c, gaps) rows of what is kept of every step, by z and by dt^2 mu
    energies: bool  # whether kinetic and strain energy are kept too
    compiled: Any  # `dda.contact.rows.find` compiled, and records of all that it takes, or None
    lag: float  # a1/dt
    drag: float  # a0 dt
    mass_factor: float  # m
    share: float  # alpha/beta

    @cached_property
    def solver(self) -> Any:
        """Function of the numbers of a stage and of a length that returns its equations; the latest ones are kept."""
        return lru_cache(LENGTHS)(partial(StageSolver, self))


@dataclass(eq=False)
class GluedState:
    """Where glued blocks are: what `dda.march.step.State` has, and the glue."""

    z: Array
    p: Array
    a: Array
    R: Array
    path: list[float]
    rows: Rows
    glue: Array  # (gaps,) dt^2 mu
    felt: Array  # (n,) g; z without viscous damping
    held: Array  # (n,) dt^2 (F - k g - B' mu)


def joint_flexibility(weight: float, C: csr_array, B: csr_array, inverse: Array) -> csr_array:
    """Return C + weight B s^-1 B', the matrix of the joint forces' increments."""
    return C + weight * (B.multiply(inverse).tocsr() @ B.T)


class StageSolver:
    """The equations of a stage of one length, a share `ratio` of the step."""

    def __init__(self, glue: Glue, stage: Stage, ratio: float) -> None:
        """Factorise the matrix of the glue, and find what forces of the contacts move."""
        self.glue = glue
        alpha = (stage.alpha + stage.delta * glue.lag) / glue.mass_factor
        self.numbers = shortened(stage, alpha, glue.scheme.gg, ratio)
        self.weight = implicit_weight(self.numbers)
        self.s = 1 + self.weight * glue.k
        self.inverse = 1 / self.s
        self.B = glue.equations.B
        self.still = np.zeros(self.B.shape[0])
        matrix = joint_flexibility(self.weight, glue.C, self.B, self.inverse)
        self.nonzeros = int(matrix.nnz)
        self.solve = factor(matrix) if len(self.still) else np.copy
        self.corrections = sum(np.max(self.s) > limit for limit in _STIFF)
        if len(glue.contact):
            push = self.weight * glue.scheme.step**2 * glue.contact
            responses = [self.increments(row, self.still) for row in push]
            self.moved, self.glued = (np.array(part).T for part in zip(*responses, strict=True))
            W = glue.contact @ self.moved
            W = (W + W.T) / 2
            flexible = Flexibility(W, W.copy(), np.ones(1))
            if glue.paired:
                unpair(flexible.paired, flexible.W)
            self.flexible = as_lists(flexible)
            self.record = as_record(flexible) if glue.compiled else None

    def increments(self, r: Array, push: Array) -> ArrayPair:
        """Return x and dmu of s x + b B' dmu = r, B x - C dmu = G dy.

        Where a block's stiffness outweighs its inertia in s, its rigid motion is a small difference
        of joint forces: each correction takes the digits back that this costs.
        """
        x: Any = 0.0
        dmu: Any = 0.0
        residual = r
        apart = push
        for correction in range(1 + self.corrections):
            if correction:
                residual = r - self.s * x - self.weight * (self.glue.Bt @ dmu)
                apart = push - self.B @ x + self.glue.C @ dmu
            more = self.solve(self.B @ (self.inverse * residual) - apart)
            dmu = dmu + more
            x = x + self.inverse * (residual - self.weight * (self.glue.Bt @ more))
        return x, dmu


def shortened(stage: Stage, alpha: float, gg: float, ratio: float) -> Stage:
    """Return the numbers of a stage of a shorter step with another alpha, for a state in units of the whole one."""
    numbers = {name: getattr(stage, name) for name in Stage._fields} | {"alpha": alpha, "gg": gg**ratio}
    for name in ("d_u", "d_g", "g_0", "g_g", "delta"):
        numbers[name] *= ratio
    for name in ("e_0", "e_g", "alpha"):
        numbers[name] *= ratio * ratio
    return Stage(**numbers)


def glued_march(
    equations: Equations,
    size: float,
    scheme: Scheme,
    laws: Laws,
    contact: Array,
    observed: ArrayPair,
    energies: bool,
    steps: int,
) -> March:
    """Return the march of so many steps of glued blocks under loads of a size, with energies kept too if asked for.

    Parameters
    ----------
    contact : (m, unknowns) array
        Rows of contact, each of one block with all its unknowns.
    observed : (c, n) and (c, gaps) arrays
        What is kept of every step, by the modes and by the forces of the glue.
    """
    rows = contact @ equations.shapes
    m = len(rows)
    if laws.paired:
        rows[2:] = (rows[2] + rows[3]) / 2, rows[3] - rows[2]
    first = np.array([int(np.argmax(row != 0)) // 6 * 6 for row in contact], dtype=int)
    across = np.arange(m) < laws.contacts
    body = Body(
        k=equations.k,
        loads=np.zeros((0, len(equations.k))),
        stored=np.zeros(0),
        first=first,
        weight=np.array([row[start : start + 6] for row, start in zip(rows, first, strict=True)]),
        ground=np.column_stack([~across, across]).astype(float),
        mobility=np.ones(len(equations.k)),
    )
    march = march_of(body, laws, scheme, np.zeros(m))
    closed = march.between.rows
    records = laws, closed, march.last.whole.flexible, closed, march.work
    dt = scheme.step
    lag = scheme.stiffness_damping / dt
    drag = scheme.mass_damping * dt
    beta = scheme.alpha + scheme.delta * lag
    glue = Glue(
        scheme=scheme,
        equations=equations,
        k=dt * dt * equations.k,
        load=dt * dt * size * equations.F,
        Bt=equations.B.T.tocsr(),
        C=equations.C / dt**2,
        contact=rows,
        paired=laws.paired,
        observed=(observed[0], observed[1] / dt**2),
        energies=energies,
        compiled=code_for(find, records, steps * laws.contacts**2 // POINTS),
        lag=lag,
        drag=drag,
        mass_factor=1 + scheme.delta * drag,
        share=scheme.alpha / beta if beta else 1.0,
    )
    between = start_state(glue, np.zeros(m), 0 * equations.k, np.zeros(2))
    lists: March = as_lists(march._replace(between=between, method=glue))
    return lists


def start_state(glue: Glue, opening: Array, velocity: Array, moved: Array) -> GluedState:
    """Return the state at t = 0: unstrained, without contact force.

    `opening` is that of the rows [m], (m,), `velocity` that of the modes, (n,). What is fixed has `moved` by (x, y),
    which stretches the glue [m].
    """
    scheme = glue.scheme
    force = -(scheme.step**2 * (glue.equations.kappa @ (glue.equations.G @ moved)))
    R = glue.load - glue.Bt @ force
    a = R if scheme.start == "consistent" else 0 * R
    p = late_momentum(scheme, scheme.step * velocity, a)
    rows = as_lists(rows_of(opening, np.where(opening > 0, LOWER, INSIDE)))
    return GluedState(0 * R, p, a, R, [0.0] * len(opening), rows, force, 0 * R, R)


def run_glued(
    march: March, course: Course, steps: int, opening: Array, velocity: Array, moved: Array, cut: float = 0.3
) -> tuple[History, int]:
    """Make the steps from the state of `start_state` on; return them, and how they ended."""
    glue = march.method
    start, after = (start_state(glue, opening, velocity, moved) for _ in range(2))
    m = len(opening)
    kept = len(glue.observed[0])
    if m:
        kept += 2 + 2 * glue.energies
    history = history_of(steps, kept, march.laws.contacts, m, glue.energies)
    with np.errstate(all="ignore"):
        reached, outcome = make_steps(march, start, after, course, history, steps, cut)
    return reached_history(history, reached), outcome


def make_stage(
    march: March, stage: StageRoom, start: GluedState, before: GluedState, after: GluedState, course: Course, part: Part
) -> Solved:
    """Go from the end of the stage before to the end of a stage; return the outcome and the number of solves."""
    glue = march.method
    room = march.room
    solver = glue.solver(stage.numbers, part.ratio)
    numbers = solver.numbers
    damped = glue.scheme.damped
    prescribe(march, course, stage, part)
    ahead = predictor(numbers, start.p, start.a, before.p, before.a)
    balance = ahead
    drag = 0.0
    if damped:
        coming = velocity_corrector(numbers, start.p, start.a, before.a, 0 * start.a)
        faster = glue.lag * (coming - start.p)
        balance = ahead + faster
        drag = glue.drag * coming
    balance = balance + numbers.alpha * inertia_force(numbers, before.held - drag, start.R, start.a)
    push = solver.still
    if room.start != room.end:
        push = glue.equations.G @ np.subtract(room.end, room.start)
    x, dmu = solver.increments(balance, push)
    outcome = FOUND
    solves = 0
    pushed = 0.0
    if len(glue.contact):
        room.x[:] = x.tolist()
        free_rows(march, before)
        outcome, solves = find_rows(march, solver, before.rows, after.rows)
        if outcome != FOUND:
            return outcome, solves
        end_paths(march, solver.flexible, before, after)
        forces_of_ways(march, after.rows.force)
        force = np.array(room.force)
        x = x + solver.moved @ force
        dmu = dmu + solver.glued @ force
        pushed = march.scheme.step**2 * (force @ glue.contact)
    after.felt = before.felt + x
    after.glue = before.glue + dmu
    after.held = glue.load - glue.k * after.felt - glue.Bt @ after.glue
    after.R = after.held + (pushed - drag)
    after.a = inertia_force(numbers, after.R, start.R, start.a)
    after.z = after.felt
    if damped:
        after.a = after.a / glue.mass_factor
        after.z = before.z + glue.share * x + (1 - glue.share) * ahead - glue.share * faster
    after.p = velocity_corrector(numbers, start.p, start.a, before.a, after.a)
    return outcome, solves


def find_rows(march: March, solver: StageSolver, before: Rows, after: Rows) -> Solved:
    """Find the contacts of a stage, by compiled code where it is at hand; lists are faster for all else."""
    if march.method.compiled is None:
        return find(march.laws, before, solver.flexible, after, march.work)
    machine_code, (laws, earlier, _, later, work) = march.method.compiled
    for name in Rows._fields:
        getattr(earlier, name)[:] = getattr(before, name)
    work.q[:] = march.work.q
    work.pair[:] = march.work.pair
    outcome, solves = machine_code(laws, earlier, solver.record, later, work)
    for name in Rows._fields:
        getattr(after, name)[:] = getattr(later, name).tolist()
    return outcome, solves


def half_square(x: Array) -> float:
    """Return x' x / 2."""
    return float(x @ x) / 2


def add_bulk_loss(march: March, state: GluedState, after: GluedState, part: Part, sums: Array) -> None:
    """Add what Newmark's step loses beside the contacts [J], with A0 that may be any."""
    glue = march.method
    delta = glue.scheme.delta
    dt2 = glue.scheme.step**2
    moved = after.z - state.z
    stiff = 2 * strain_energy(glue, moved, after.glue - state.glue)
    kinetic = (half_square(after.a) - half_square(state.a)) / dt2**2
    change = half_square(after.a - state.a) / dt2**2
    sums[ALGORITHMIC] += (1 - delta) * float(moved @ (state.R - state.a)) / dt2
    sums[ALGORITHMIC] += bulk_loss(glue.scheme.alpha, delta, dt2 * part.ratio**2, stiff, kinetic, change)


def strain_energy(glue: Glue, z: Array, force: Array) -> float:
    """Return that of blocks and glue, z' k z / 2 + mu' C mu / 2 [J]."""
    return float(z @ (glue.k * z) + force @ (glue.C @ force)) / 2 / glue.scheme.step**2


def keep(march: March, state: GluedState, rows: Array, number: int) -> bool:
    """Write what is observed at the end of a step; tell whether it is finite, or without contacts, which never stop."""
    glue = march.method
    kept = [glue.observed[0] @ state.z + glue.observed[1] @ state.glue]
    if len(glue.contact):
        discount = kept_discount(march.scheme, number)
        p = discount * state.p + march.scheme.lag * state.a
        kept.append(p @ glue.equations.rigid[:, :2])
        if glue.energies:
            kept.append([half_square(p) / march.scheme.step**2, strain_energy(glue, state.z, state.glue)])
    rows[number] = np.concatenate(kept)
    return not len(glue.contact) or bool(np.isfinite(state.z).all())


account = account_with(half_square, add_bulk_loss)
make_steps = steps_by(make_stage, account, keep)
