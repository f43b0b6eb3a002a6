r"""A block cut into sub-blocks over a base that carries no tension.

The sub-blocks and their glue are those of `dda.system.subdivision`; in place of the locked springs every base edge of
a sub-block has a contact point at each end, with its share p l / a of the corner springs. One step is that of
`dda.system.solution` without supports, and then the forces of the points,

    r = gg P + (1/2 - alpha) f + alpha (F - k D - B' mu)     ->  dD, dmu of the free system
    (w, s) = (w_f, s_f) + C lambda,    C = alpha dt^2 Bc S^-1 Bc'  with S^-1 the same solve,
    f1 = F - k D1 - B' mu1 + dt^2 Bc' lambda,

so that one factorisation, and as many solves with it as there are forces, serve every contact state. Other schemes
take one stage or two of this form (`dda.scheme.stage`), each with its own contacts.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from time import perf_counter

import numpy as np

from dda.contact.kernel import (
    FOUND,
    TO_PAIR,
    Contacts,
    Flexibility,
    Free,
    Shear,
    at_rest,
    change_slides,
    find_contacts,
    law_of,
    shear_law_of,
    work_for,
)
from dda.contact.springs import Contact, base_directions
from dda.contact.unilateral import CONSISTENT, LAGGED, Unilateral
from dda.model.arrays import Array
from dda.model.load import BaseMotion
from dda.one_block.contact_result import ContactResult, run_fields
from dda.one_block.solution import check_request, step_times
from dda.one_block.two_block import TwoBlockModel
from dda.one_block.unilateral import NEWMARK, UnilateralModel, UnilateralOptions, check_scheme
from dda.scheme.newmark import Scheme, late_momentum
from dda.scheme.stage import Stage, inertia_force, predictor, velocity_corrector
from dda.stepping.compiled import Compilable
from dda.stepping.driver import (
    BaseRecord,
    Part,
    base_displacement,
    base_record,
    driver,
    history_of,
    reached_history,
    staged,
)
from dda.stepping.energy import ALGORITHMIC, accounted, add_contact_losses, bulk_loss, energies_of, spring_energies
from dda.system.joints import FIXED
from dda.system.solution import StageSolver
from dda.system.subdivision import Pattern, subdivided
from dda.system.system import BlockSystem, Equations, inverses

LENGTHS = 16  # step lengths whose factors are kept
COMPILE_TIME = 2.0  # of the search for contacts, over that of the smallest loop
PLAIN_POINT = 3e-6  # seconds of a solve in plain Python for each pair of points


@dataclass(frozen=True, eq=False)
class OpeningSystem:
    """Sub-blocks, glue and the points of the base, in their order from M to N."""

    system: BlockSystem  # without supports
    law: Unilateral  # of each point
    normals: Array  # (points, unknowns) gap by D
    tangents: Array  # (points, unknowns) displacement along the base by D
    velocity: float  # at t = 0, upwards positive [m/s]
    axes: Array  # (2, 2) unit tangent of the base from M to N, and its normal into the blocks
    motion: BaseMotion | None  # of the base

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
    load = replace(model.load, motion=None)
    locked = TwoBlockModel(model.block, Contact(1.0), load, model.base, model.top)
    cut = subdivided(locked, columns, rows, glue, pattern)
    tangent, normal, _ = base_directions(model.block, model.base)
    supports = [joint for joint in cut.joints if joint.second == FIXED]
    supports.sort(key=lambda joint: float(tangent @ np.array(joint.start)))
    ends = [(joint.first, np.array(place)) for joint in supports for place in (joint.start, joint.end)]
    normals, tangents = np.zeros((2, len(ends), len(cut.blocks), 6))
    for i, (number, (x, y)) in enumerate(ends):
        T = cut.blocks[number].T(float(x), float(y))
        normals[i, number] = normal @ T
        tangents[i, number] = tangent @ T
    share = supports[0].normal  # a side that is cut evenly has edges of one length
    contact = model.contact
    law = replace(
        contact, stiffness=contact.stiffness * share, shear=contact.shear * share, cohesion=contact.cohesion * share
    )
    return OpeningSystem(
        system=replace(cut, joints=[joint for joint in cut.joints if joint.second != FIXED]),
        law=law,
        normals=normals.reshape(len(ends), -1),
        tangents=tangents.reshape(len(ends), -1),
        velocity=model.velocity,
        axes=np.array([tangent, normal]),
        motion=model.load.motion,
    )


@dataclass(eq=False)
class SystemState:
    """Where the sub-blocks are, in units of the scheme's own step dt."""

    D: Array  # unknowns
    P: Array  # dt M V
    f: Array  # dt^2 M A
    mu: Array  # dt^2 times the forces of the glue
    force: Array  # dt^2 times all forces, f of schemes that do not average them
    contacts: Contacts  # of the points


class StageLength:
    """What forces of the points change in a stage of a step of one length."""

    def __init__(self, opening: OpeningSystem, stage: Stage, rows: Array) -> None:
        self.solver = StageSolver(opening.equations, stage)
        self.still = np.zeros(len(opening.equations.pressure))
        push = stage.step**2 * rows
        responses = [self.solver.increments(self.solver.weight * row, self.still) for row in push]
        self.moved, self.glued = (np.array([pair[i] for pair in responses]).T for i in (0, 1))
        C = rows @ self.moved
        C = (C + C.T) / 2
        self.flexible = Flexibility(C, C.copy())
        if len(C) == 4 and len(opening.normals) == 2:
            change_slides(C, TO_PAIR, self.flexible.C_paired)


class Length:
    """Everything of a step that depends on its length alone, factorised once."""

    def __init__(self, opening: OpeningSystem, scheme: Scheme, ratio: float) -> None:
        self.scheme = scheme if ratio == 1 else replace(scheme, gg=scheme.gg**ratio, step=scheme.step * ratio)
        h2 = self.scheme.step**2
        self.F = h2 * opening.equations.F * opening.system.load_size
        self.rows = np.concatenate([opening.normals, opening.tangents]) if opening.law.shear else opening.normals
        self.push = h2 * self.rows.T
        self.stages = [StageLength(opening, stage, self.rows) for stage in self.scheme.stages]


class OpeningBody:
    """The sub-blocks as the loop over steps takes them: `advance`, `account` and `keep` are for `driver`."""

    def __init__(
        self, opening: OpeningSystem, scheme: Scheme, limit: int, columns: Sequence[str], steps: int, energies: bool
    ) -> None:
        self.opening = opening
        self.scheme = scheme
        points = len(opening.normals)
        self.points = points
        self.made = 0
        self.lengths: dict[float, Length] = {}
        self.observers = opening.equations.rows(columns)[0]
        pressure = np.array([name == "contact_pressure" for name in columns], dtype=float)
        self.pressure = pressure / opening.system.base_length
        self.find = Compilable(find_contacts, steps * PLAIN_POINT * points**2, COMPILE_TIME)
        self.law = self.find.room(law_of(opening.law, limit))
        self.shear_law = self.find.room(shear_law_of(opening.law))
        self.work = self.find.room(work_for(points))
        e = opening.equations
        self.inverse_mass = e.blockwise(inverses(e.mass))
        self.elastic = e.blockwise(e.elastic)
        self.F = e.F * opening.system.load_size
        self.energies = energies
        self.by_balance = scheme.table is not None
        self.gg = scheme.gg
        self.lag = scheme.lag
        self.stages = len(scheme.stages)
        self.first = 0  # number of the first stage of two
        self.last = self.stages - 1
        self.between = self.start_state()  # room for the end of the first stage
        # of each stage in the part of a step that was made last: displacement of the base and slips of the points [m]
        self.carried = np.zeros((self.stages, 2))
        self.slipped = np.zeros((self.stages, points))

    def length(self, ratio: float) -> Length:
        """Return what belongs to a length, over the scheme's step; that of the whole step is always kept."""
        if ratio not in self.lengths:
            if len(self.lengths) >= LENGTHS:
                self.lengths = {1.0: self.lengths[1.0]}
            length = self.lengths[ratio] = Length(self.opening, self.scheme, ratio)
            for stage in length.stages:
                stage.flexible = self.find.room(stage.flexible)
                self.made += 1
        return self.lengths[ratio]

    def start_state(self) -> SystemState:
        """Return the state at t = 0: unstrained, without contact force, the points at the starting gap."""
        e = self.opening.equations
        dt = self.scheme.step
        upwards = np.zeros((len(e.mass), 6))
        upwards[:, 1] = dt * self.opening.velocity
        P = np.einsum("nij,nj->ni", e.mass, upwards).ravel()
        F = dt * dt * e.F * self.opening.system.load_size
        f = F if self.scheme.start == "consistent" else np.zeros_like(F)
        contacts = at_rest(np.full(self.points, self.opening.law.gap))
        P = late_momentum(self.scheme, P, f)
        return SystemState(np.zeros_like(F), P, f, np.zeros(len(e.pressure)), F, self.find.room(contacts))

    def stored(self, state: SystemState, discount: float) -> tuple[float, ...]:
        """Return kinetic and strain energy, and that of the load without what the base gave [J]."""
        dt = self.scheme.step
        strain = self.stiff(state.D, state.mu / dt**2) / 2
        return self.kinetic(self.momentum(state, discount) / dt), strain, -float(self.F @ state.D)

    def momentum(self, state: SystemState, discount: float) -> Array:
        """Return dt M V at the time of the displacements; `discount` is that of P."""
        return discount * state.P + self.scheme.lag * state.f if self.scheme.lag else state.P

    def start_discount(self, first: bool) -> float:
        """Return the discount of P at the start of a step: gg in what `late_momentum` made of the one at t = 0."""
        return self.scheme.gg if first and self.scheme.lag else 1.0

    def kinetic(self, momentum: Array) -> float:
        """Return momentum' M^-1 momentum / 2."""
        return float(momentum @ (self.inverse_mass @ momentum)) / 2

    def stiff(self, D: Array, force: Array) -> float:
        """Return D' Ke D + lambda' kappa^-1 lambda, twice the strain energy of the sub-blocks and their glue."""
        return float(D @ (self.elastic @ D) + force @ (self.opening.equations.C @ force))


def make_stage(
    body: OpeningBody,
    shear_law: Shear,
    number: int,
    state: SystemState,
    before: SystemState,
    after: SystemState,
    base: BaseRecord | None,
    part: Part,
) -> tuple[int, int]:
    """Go from the end of the stage before to the end of a stage; return the outcome and the number of solves."""
    length = body.length(part.ratio)
    made = length.stages[number]
    solver = made.solver
    stage = solver.stage
    ratio = part.ratio
    carried = body.carried[number]
    if base is not None:
        interval = Part(part.begun + ratio * stage.begin, ratio * (stage.end - stage.begin))
        base_displacement(base, body.scheme.step, interval, np.zeros(2), carried)
    P = ratio * state.P
    f = ratio * ratio * state.f
    force_0 = ratio * ratio * state.force
    mu = ratio * ratio * before.mu
    f_g = ratio * ratio * before.f
    balance = predictor(stage, P, f, ratio * before.P, f_g)
    # contact forces at the start of the stage are no part of what is known of its end
    internal = solver.k @ before.D + solver.Bt @ mu
    balance = balance + stage.alpha * inertia_force(stage, length.F - internal, force_0, f)
    dD, dmu = solver.increments(balance, made.still)
    moved = length.rows @ dD
    n = body.points
    free = Free(np.array(before.contacts.gap) + moved[:n] - carried[1], np.zeros(n), np.zeros(n))
    if len(moved) > n:
        free.slide[:] = moved[n:] - carried[0]
        free.paired[:2] = (free.slide[0] + free.slide[-1]) / 2, free.slide[-1] - free.slide[0]
    outcome, solves = body.find(body.law, shear_law, before.contacts, free, made.flexible, after.contacts, body.work)
    if outcome != FOUND:
        return outcome, solves
    forces = np.array([*after.contacts.normal, *after.contacts.shear])[: len(moved)]
    D = before.D + dD
    mu = mu + dmu
    pressed = np.zeros_like(dD)
    if np.any(forces):
        D = D + made.moved @ forces
        mu = mu + made.glued @ forces
        pressed = length.push @ forces
    force = length.F - (solver.k @ D + solver.Bt @ mu) + pressed
    f1 = inertia_force(stage, force, force_0, f)
    P1 = velocity_corrector(stage, P, f, f_g, f1)
    after.D = D
    after.P = P1 / ratio
    after.f = f1 / (ratio * ratio)
    after.mu = mu / (ratio * ratio)
    after.force = force / (ratio * ratio)
    body.slipped[number] = after.contacts.slipped
    return FOUND, solves


advance = staged(make_stage)


def account_stage(
    body: OpeningBody,
    shear_law: Shear,
    number: int,
    before: SystemState,
    after: SystemState,
    part: Part,
    sums: Array,
) -> None:
    """Add what the points lose in a stage, and what the base gives [J]."""
    stage = body.scheme.stages[number]
    add_contact_losses(
        body.law,
        shear_law,
        before.contacts,
        after.contacts,
        body.slipped[number],
        body.opening.tangents @ (after.D - before.D) - body.carried[number, 0],
        body.carried[number],
        0.5 if body.by_balance else stage.delta,
        stage.step * part.ratio * (stage.end - stage.begin),
        1.0,
        sums,
    )


def kinetic_energy(body: OpeningBody, state: SystemState) -> float:
    """Return the kinetic energy of the momentum that is carried [J]."""
    return body.kinetic(state.P / body.scheme.step)


def add_algorithmic_loss(body: OpeningBody, state: SystemState, after: SystemState, part: Part, sums: Array) -> None:
    """Add what Newmark's step loses beside the points [J], with A0 that may be any."""
    scheme = body.scheme
    dt2 = scheme.step**2
    moved = after.D - state.D
    R0 = state.f / dt2
    R1 = after.f / dt2
    sums[ALGORITHMIC] += (1 - scheme.delta) * float(moved @ (state.force / dt2 - R0))
    stiff = body.stiff(moved, (after.mu - state.mu) / dt2)
    kinetic = body.kinetic(R1) - body.kinetic(R0)
    change = body.kinetic(R1 - R0)
    sums[ALGORITHMIC] += bulk_loss(scheme.alpha, scheme.delta, dt2 * part.ratio**2, stiff, kinetic, change)


def keep(body: OpeningBody, state: SystemState, rows: Array, number: int) -> bool:
    """Write columns, momentum and energy at the end of a step; tell whether it is finite."""
    columns = body.observers @ state.D + body.pressure * np.sum(state.contacts.normal)
    discount = body.start_discount(number == 0)
    momentum = body.momentum(state, discount).reshape(-1, 6)[:, :2].sum(axis=0)
    stored = body.stored(state, discount) if body.energies else ()
    rows[number] = np.concatenate([columns, momentum, body.opening.tangents @ state.D, stored])
    return bool(np.isfinite(state.D).all())


account = accounted(kinetic_energy, account_stage, add_algorithmic_loss)
make_steps = driver(advance, account, keep)


def solve_opening_system(
    opening: OpeningSystem,
    scheme: Scheme,
    steps: int,
    columns: Sequence[str] = ("displacement", "contact_pressure"),
    options: UnilateralOptions | None = None,
) -> ContactResult:
    """Step sub-blocks on points that open, from rest or from their starting velocity.

    Parameters and outcomes are those of `dda.solve_unilateral`; the rule is "newmark", and all unknowns are kept.

    Raises
    ------
    ValueError
        If the number of steps is not positive, a column is unknown, or rule, scheme and contact exclude each other.
    """
    import scipy.sparse.linalg  # noqa: F401  (before the clock starts)

    check_request(steps, columns)
    options = options or UnilateralOptions()
    if options.rule != NEWMARK:
        raise ValueError(f"rule: sub-blocks take {NEWMARK} alone, got {options.rule!r}")
    if opening.law.damping:
        raise ValueError(f"damping: sub-blocks take springs without dashpots alone, got {opening.law.damping:g}")
    law = opening.law
    if law.rules == LAGGED:
        raise ValueError(f"rules: sub-blocks take {CONSISTENT} friction alone, got {LAGGED!r}")
    check_scheme(law, scheme)
    began = perf_counter()
    body = OpeningBody(opening, scheme, options.solve_limit, columns, steps, options.energies)
    nonzeros = body.length(1.0).stages[-1].solver.factor.nonzeros
    requested = len(columns)
    points = body.points
    history = history_of(steps, requested + 2 + points + 3 * options.energies, points, options.energies)
    base = base_record(opening.motion and opening.motion.along(opening.axes))
    ready = perf_counter()
    with np.errstate(all="ignore"):
        reached, ended = make_steps(
            body, body.shear_law, body.start_state(), body.start_state(), base, history, steps, options.cut
        )
    history = reached_history(history, reached)
    motion = history.motion[1:]
    mass = math.fsum(block.total_mass for block in opening.system.blocks)
    velocity = motion[:, requested : requested + 2].T / (mass * scheme.step)

    def slide() -> Array:
        moved: Array = motion[:, requested + 2 : requested + 2 + points].T
        if opening.motion is not None:
            moved = moved - opening.motion.at(step_times(scheme, reached)) @ opening.axes[0]
        return moved

    def balance() -> dict[str, Array]:
        kinetic, strain, load = history.motion[:, requested + 2 + points :].T
        springs = spring_energies(law, history.normal, history.shear)
        return energies_of((kinetic, strain, springs, load), history.sums, scheme.table is not None)

    return ContactResult(
        **run_fields(history, ended, scheme, [f"stepped, {body.find.how}: contact opens and closes"], (began, ready)),
        columns=dict(zip(columns, motion[:, :requested].T + 0.0, strict=True)),
        unknowns=len(opening.equations.F),
        nonzeros=nonzeros,
        factorisations=body.made,
        base_contacts=(0, -1),
        softness=law.softness,
        parts={"slide": slide, "horizontal_velocity": lambda: velocity[0], "velocity": lambda: velocity[1]},
        balance=balance if options.energies else None,
    )
