r"""One time step with contact that opens, in the force form.

The contact forces lambda of the end of the step are found before its displacements: with h the step's length,
k0 = h^2 K0, F for h^2 F, mu = h^2 lambda, momentum P = h M V and inertia force f = h^2 M A,

    S0 (D1 - D) = gg P + (1/2 - alpha) f + alpha (F - k0 D) + alpha B' mu,     S0 = M + alpha k0
    f1 = F - k0 D1 + B' mu
    P1 = gg P + (1 - delta) f + delta f1

so that S0 is factorised once for all contact states and the flexibility of the contacts is
C = alpha h^2 B S0^-1 B'. A closed corner's gap is -N/p, set on acceptance: it is no sum of increments.

Every scheme is such a step, or two of them, with other numbers (`dda.scheme.stage`): where it balances the forces
between the ends of a step, those of contact are averaged as the others are, (1 - af) lambda1 + af lambda0. Of a scheme
of two stages each has an open-close iteration of its own, from the end of the one before; gg enters once.

Two other rules, of Newmark's scheme, keep the contact force out of f, the block's own, and put one force of the step
into the displacement, with weight 1/2 for alpha, and into the momentum, with weight 1. With "implicit" it is the force
at the end (Kane, Repetto, Ortiz and Marsden 1999); with "energy-conserving" that of `dda.contact.conserving`, and
average acceleration of the block itself is then the midpoint rule, with F - K D0 for M A0.

Contact methods beside the penalty spring have modules of their own: a clipped dashpot (`dda.contact.dashpot`), passes
of the augmented Lagrangian (`dda.contact.augmented`), impulses with a restitution (`dda.one_block.impact_step`).

On a moving base unknowns count from it: x = D + R y with K0 R = 0, so that its displacement in the step enters as the
momentum M R (y1 - y).
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import replace
from typing import Any, NamedTuple

import numpy as np

from dda.contact.augmented import augmented
from dda.contact.conserving import conserving
from dda.contact.dashpot import damped, set_gaps
from dda.contact.dense import Matrix, Vector, copy, copy_matrix, dot, invert, multiply, quadratic, zeros
from dda.contact.kernel import (
    FOUND,
    TO_OWN,
    Contacts,
    Flexibility,
    Free,
    Law,
    Shear,
    Work,
    at_rest,
    change_slides,
    find_contacts,
    law_of,
    shear_law_of,
    work_for,
)
from dda.contact.unilateral import OPEN, Unilateral
from dda.model.arrays import Array
from dda.model.load import load_share
from dda.one_block.unilateral_form import U_INDEX, UnilateralForm
from dda.scheme.newmark import Scheme, initial_acceleration, late_momentum
from dda.scheme.stage import Stage, implicit_weight, inertia_force, plain_stage, predictor, velocity_corrector
from dda.stepping.driver import BaseRecord, Part, base_displacement, driver, staged
from dda.stepping.energy import ALGORITHMIC, GIVEN, accounted, add_contact_losses, bulk_loss

NEWMARK = "newmark"
IMPLICIT = "implicit"
CONSERVING = "energy-conserving"
IMPACT = "impact"
AUGMENTED = "augmented"
RULES = (NEWMARK, IMPLICIT, CONSERVING, IMPACT, AUGMENTED)


class StepLength(NamedTuple):
    """Everything of a stage that depends on the length of the step alone."""

    numbers: Vector  # (4,) length over the scheme's step, gg for this length, length [s], slope of `set_gaps`
    k: Vector  # (n,) h^2 K0
    F: Vector  # (n,) h^2 F; where the load rises in a ramp, that at the end of the stage which was made last
    inverse: Matrix  # (n, n) of S0
    pushed: Matrix  # (n, q) weight h^2 S0^-1 multiplicity B': displacement of unit forces
    C: Matrix  # flexibility of the contacts in their own slides [m/N]
    C_paired: Matrix  # that in mean and difference of two slides [m/N]
    retarded: Flexibility  # C + tau C' of contacts with a dashpot, tau = c/p [m/N]


class BlockState(NamedTuple):
    """Where the block is, in units of the scheme's own step dt."""

    D: Vector  # (n,) unknowns of the form
    P: Vector  # (n,) dt M V
    f: Vector  # (n,) dt^2 M A
    force: Vector  # (n,) dt^2 (F - K0 D + B' lambda), M A of a scheme that does not average it
    contacts: Contacts


class BlockStage(NamedTuple):
    """One stage of the scheme."""

    numbers: Stage  # with gg = 1: the momentum that it takes is discounted
    whole: StepLength  # of a whole step
    part: StepLength  # of the last part of a step
    base: Vector  # (2,) displacement of the base in the stage that was made last [m]
    slipped: Vector  # (c,) of the contacts in it [m]


class Room(NamedTuple):
    """Room for the vectors of a step."""

    P: Vector  # (n,) gg P, f and the force at the start of the step, in units of its length
    f: Vector
    force_0: Vector
    balance: Vector  # (n,) and increments without contact forces
    x: Vector
    forces: Vector  # (q,) N, then T in the coordinates of B
    free: Free  # the contacts in a step without their forces
    retarded: Free  # the same of w + tau w' of contacts with a dashpot, in `slide` tau w'; or of preloaded springs
    slide: Vector  # (c,) displacement of the contacts along the base
    A: Matrix  # (n, n)
    scale: Vector
    start: Vector  # (2,) displacement of the base at the start of the stage, along and away from itself [m]
    change: Vector  # (n,)


class BlockEquations(NamedTuple):
    """One block, its law and its scheme, as numbers."""

    law: Law
    stiffness: float  # p [N/m]
    penetration: float  # tolerance of the augmented Lagrangian [m]
    pass_limit: int  # its passes in a step
    restitution: float  # of impacts [-]
    rule: int  # place in RULES; that of Newmark's where the contact force enters as there
    by_balance: bool  # whether the algorithm loses what the others leave: of another scheme than Newmark's
    stages: int  # 1, or 2: `first` and `last`
    lag: float  # by how much of a step P is older than D
    gg: float
    step: float  # [s]
    M: Matrix  # (n, n)
    K: Vector  # (n,)
    load: Vector  # (n,) F
    ramp: float  # time in which it rises [s]
    B: Matrix  # (q, n) gaps, then slides by the unknowns
    multiplicity: float
    translation: Matrix  # (n, 2) R, along and away from the base
    carried: Matrix  # (n, 2) M R
    inverse_mass: Matrix  # (n, n)
    first: BlockStage  # of two
    last: BlockStage
    between: BlockState  # at the end of the first one
    made: Vector  # (1,) matrices made
    passes: Vector  # (1,) of the augmented Lagrangian since a step was kept
    room: Room
    work: Work


def block_equations(
    form: UnilateralForm,
    law: Unilateral,
    scheme: Scheme,
    rule: str,
    limit: int,
    penetration: float = 0.0,
    pass_limit: int = 1,
    restitution: float = 0.0,
) -> tuple[BlockEquations, Shear]:
    """Return the equations as numbers, with the matrices of a whole step, and the law of contacts that can slide."""
    n = len(form.unknowns)
    c = form.contacts
    q = len(form.B)
    vectors: list[Any] = zeros(n, n, n, n, n, q)
    vectors += [Free(*zeros(c, c, c)), Free(*zeros(c, c, c))]
    vectors += zeros(c, (n, n), n, 2, n)
    between: list[Any] = [*zeros(n, n, n, n), at_rest(np.zeros(c))]
    rooms = [stage_room(plain_stage(stage), n, c, q) for stage in scheme.stages]
    block = BlockEquations(
        law=law_of(replace(law, stiffness=math.inf) if rule == AUGMENTED else law, limit),
        stiffness=law.stiffness,
        penetration=penetration,
        pass_limit=pass_limit,
        restitution=restitution,
        rule=0 if rule == AUGMENTED else RULES.index(rule),
        by_balance=scheme.table is not None,
        stages=len(rooms),
        lag=float(scheme.lag),
        gg=scheme.gg,
        step=scheme.step,
        M=form.M,
        K=form.K,
        load=form.F,
        ramp=form.ramp,
        B=form.B,
        multiplicity=form.multiplicity,
        translation=form.translation,
        carried=form.M @ form.translation,
        inverse_mass=np.asarray(np.linalg.inv(form.M), np.float64),
        first=rooms[0],
        last=rooms[-1],
        between=BlockState(*between),
        made=np.zeros(1),
        passes=np.zeros(1),
        room=Room(*vectors),
        work=work_for(c),
    )
    shear_law = shear_law_of(law) if q > c else None
    for stage in rooms:
        set_length(block, shear_law, stage, 1.0, stage.whole)
    return block, shear_law


def stage_room(stage: Stage, n: int, c: int, q: int) -> BlockStage:
    """Return a stage, with room for what belongs to it."""
    return BlockStage(
        numbers=stage,
        whole=length_room(n, q),
        part=length_room(n, q),
        base=np.zeros(2),
        slipped=np.zeros(c),
    )


def length_room(n: int, q: int) -> StepLength:
    """Return room for what belongs to the length of a step."""
    rows: list[Any] = zeros(4, n, n, (n, n), (n, q), (q, q), (q, q))
    rows.append(Flexibility(*zeros((q, q), (q, q))))
    return StepLength(*rows)


def start_state(form: UnilateralForm, law: Unilateral, scheme: Scheme, velocity: float, rule: str) -> BlockState:
    """Return the state at t = 0: unstrained, without contact force, the corners at the starting gap."""
    dt = scheme.step
    P = (dt * velocity) * (form.M @ (form.translation @ form.axes[:, 1]))
    F = load_share(form.ramp, 0.0) * (dt * dt * form.F)
    f = F if rule == CONSERVING else initial_acceleration(scheme, F)
    return BlockState(form.start, late_momentum(scheme, P, f), f, F, at_rest(np.full(form.contacts, law.gap)))


# ---- the step --------------------------------------------------------------------------------------------------------


def set_length(block: BlockEquations, shear_law: Shear, stage: BlockStage, ratio: float, length: StepLength) -> None:
    """Write everything of a stage that depends on the length of the step: S0^-1, and the flexibility of the contacts.

    A shorter step keeps the share gg^ratio of the velocity, so that the parts of a step together keep gg.
    """
    n = len(block.K)
    q = len(block.B)
    room = block.room
    implicit = implicit_weight(stage.numbers)
    step = block.step * ratio
    h2 = step * step
    length.numbers[0] = ratio
    length.numbers[1] = block.gg**ratio
    length.numbers[2] = step
    copy_matrix(block.M, room.A)
    for i in range(n):
        length.k[i] = h2 * block.K[i]
        length.F[i] = h2 * block.load[i]
        room.A[i][i] += implicit * length.k[i]
    invert(room.A, n, room.scale, length.inverse)
    weight = (implicit if block.rule == 0 else 0.5) * h2 * block.multiplicity
    if block.rule == 3:  # impulses change the velocity
        weight = block.multiplicity
    for i in range(n):
        for j in range(q):
            length.pushed[i][j] = weight * dot(length.inverse[i], block.B[j], n)
    for i in range(q):
        for j in range(q):
            total = 0.0
            for k in range(n):
                total += block.B[i][k] * length.pushed[k][j]
            length.C_paired[i][j] = total
    if shear_law is not None and q == 4:
        change_slides(length.C_paired, TO_OWN, length.C)
    else:
        copy_matrix(length.C_paired, length.C)
    if block.law.damping > 0:
        set_retarded(block, stage, length)
    block.made[0] += 1


def set_retarded(block: BlockEquations, stage: BlockStage, length: StepLength) -> None:
    """Write C + tau C' of contacts with a dashpot, where forces change their rates by C' = delta' h B S0^-1 B'."""
    n = len(block.K)
    retardation = block.law.damping * block.law.compliance
    implicit = implicit_weight(stage.numbers)
    h = length.numbers[2]
    late = stage.numbers.delta * (1 - stage.numbers.af) / (1 - stage.numbers.am)
    length.numbers[3] = retardation * late / (implicit * h) if implicit > 0 else 0.0
    weight = (implicit * h * h + retardation * late * h) * block.multiplicity
    for i in range(len(block.B)):
        for j in range(len(block.B)):
            total = 0.0
            for k in range(n):
                total += block.B[i][k] * dot(length.inverse[k], block.B[j], n)
            length.retarded.C[i][j] = weight * total


def length_of(block: BlockEquations, shear_law: Shear, stage: BlockStage, ratio: float) -> StepLength:
    """Return what belongs to a length, over the scheme's step."""
    if ratio == 1.0:
        return stage.whole
    if stage.part.numbers[0] != ratio:
        set_length(block, shear_law, stage, ratio, stage.part)
    return stage.part


def solve_at_end(
    block: BlockEquations, shear_law: Shear, before: Contacts, length: StepLength, after: Contacts
) -> tuple[int, int]:
    """Find the contacts whose law holds at the end of the step."""
    return find_contacts(block.law, shear_law, before, block.room.free, length, after, block.work)


def solve_conserving(
    block: BlockEquations, shear_law: Shear, before: Contacts, length: StepLength, after: Contacts
) -> tuple[int, int]:
    """Find the contacts whose forces do the work of their springs, without shear."""
    return conserving(block.stiffness, before, block.room.free, length, after, block.work)


def solve_damped(
    block: BlockEquations, shear_law: Shear, before: Contacts, length: StepLength, after: Contacts
) -> tuple[int, int]:
    """Find the contacts with a dashpot beside their springs, without shear."""
    room = block.room
    outcome, solves = damped(block.law, before, room.free, room.retarded, length, length.retarded, after, block.work)
    set_gaps(length.numbers[3], room.free, room.retarded, length, after)
    return outcome, solves


def solve_augmented(
    block: BlockEquations, shear_law: Shear, before: Contacts, length: StepLength, after: Contacts
) -> tuple[int, int]:
    """Find the contacts on a rigid stop by passes over springs, without shear."""
    room = block.room
    springs = Law(1 / block.stiffness, 0.0, 0.0, block.law.limit, 0.0)
    outcome, solves, passes = augmented(
        springs,
        block.penetration,
        block.pass_limit,
        before,
        room.free,
        room.retarded,
        length,
        after,
        block.work,
    )
    block.passes[0] += passes
    return outcome, solves


def stage_with(solve: Callable[..., tuple[int, int]]) -> Callable[..., tuple[int, int]]:
    """Return what makes a stage whose contacts are found by `solve`, one of the functions above."""

    def make_stage(
        block: BlockEquations,
        shear_law: Shear,
        stage: BlockStage,
        state: BlockState,
        before: BlockState,
        after: BlockState,
        base: BaseRecord | None,
        part: Part,
    ) -> tuple[int, int]:
        """Go from the end of the stage before to the end of a stage; return the outcome and the number of solves."""
        length = length_of(block, shear_law, stage, part.ratio)
        begin_step(block, state, length)
        free_stage(block, shear_law, stage, length, before, base, part)
        outcome, solves = solve(block, shear_law, before.contacts, length, after.contacts)
        if outcome == FOUND:
            accept(block, shear_law, stage, length, before, after)
            if shear_law is not None:
                refer(block, before.contacts, after)
                copy(after.contacts.slipped, stage.slipped)
        return outcome, solves

    return make_stage


def begin_step(block: BlockEquations, state: BlockState, length: StepLength) -> None:
    """Write what all stages take from the start of a step, in units of its length; its velocity is discounted here."""
    room = block.room
    P = room.P
    f = room.f
    ratio = length.numbers[0]
    gg = length.numbers[1]
    for i in range(len(P)):
        P[i] = gg * (ratio * state.P[i])
        f[i] = ratio * ratio * state.f[i]
        room.force_0[i] = ratio * ratio * state.force[i]


def free_stage(
    block: BlockEquations,
    shear_law: Shear,
    stage: BlockStage,
    length: StepLength,
    before: BlockState,
    base: BaseRecord | None,
    part: Part,
) -> None:
    """Write the increments of a stage without contact forces, and what it does to the contacts."""
    room = block.room
    numbers = stage.numbers
    n = len(block.K)
    c = len(block.room.slide)
    ratio = part.ratio
    if block.ramp > 0:
        share = load_share(block.ramp, (part.begun + ratio * numbers.end) * block.step)
        for i in range(n):
            length.F[i] = share * length.numbers[2] * length.numbers[2] * block.load[i]
    P = room.P
    f = room.f
    for i in range(n):
        force = inertia_force(numbers, length.F[i] - length.k[i] * before.D[i], room.force_0[i], f[i])
        balance = predictor(numbers, P[i], f[i], ratio * before.P[i], ratio * ratio * before.f[i])
        room.balance[i] = balance + numbers.alpha * force
    if base is not None:
        interval = Part(part.begun + ratio * numbers.begin, ratio * (numbers.end - numbers.begin))
        base_displacement(base, block.step, interval, room.start, stage.base)
        for i in range(n):
            room.balance[i] -= dot(block.carried[i], stage.base, 2)
    multiply(length.inverse, room.balance, n, n, room.x)
    for i in range(c):  # the gaps are the last unknowns
        room.free.gap[i] = before.D[n - c + i] + room.x[n - c + i]
    if block.law.damping > 0:
        retard(block, stage, length, before, base is not None)
    if shear_law is not None:
        slides_by(block, room.x, room.free.slide)


def retard(block: BlockEquations, stage: BlockStage, length: StepLength, before: BlockState, base_moves: bool) -> None:
    """Write w + tau w' at the end of a stage without contact forces, with w' from the base, which moves evenly."""
    room = block.room
    n = len(block.K)
    c = len(room.slide)
    h = length.numbers[2]
    retardation = block.law.damping * block.law.compliance
    for i in range(n):
        _, _, room.change[i] = motion_at_end(block, stage, length, before, before.D[i] + room.x[i], 0.0, i)
    for i in range(c):
        rate = dot(block.inverse_mass[n - c + i], room.change, n) / h
        if base_moves:
            rate -= stage.base[1] / (h * (stage.numbers.end - stage.numbers.begin))
        room.retarded.slide[i] = retardation * rate
        room.retarded.gap[i] = room.free.gap[i] + room.retarded.slide[i]


def motion_at_end(
    block: BlockEquations,
    stage: BlockStage,
    length: StepLength,
    before: BlockState,
    D: float,
    pressed: float,
    i: int,
) -> tuple[float, float, float]:
    """Return force, h^2 M A and h M V of an unknown at the end of a stage, in units of the step's length.

    Parameters
    ----------
    D, pressed
        The unknown there [m], and h^2 B' lambda.
    """
    room = block.room
    numbers = stage.numbers
    ratio = length.numbers[0]
    force = length.F[i] - length.k[i] * D + pressed
    f1 = inertia_force(numbers, force, room.force_0[i], room.f[i])
    P1 = velocity_corrector(numbers, room.P[i], room.f[i], ratio * ratio * before.f[i], f1)
    return force, f1, P1


def slides_by(block: BlockEquations, x: Vector, slide: Vector) -> None:
    """Write how far the contacts slide by x; room.free.paired is left with the coordinates of B."""
    c = len(block.room.slide)
    paired = block.room.free.paired
    for i in range(c):
        paired[i] = dot(block.B[c + i], x, len(block.K))
    slide[0] = paired[0]
    if c == 2:
        slide[0] = paired[0] - paired[1] / 2
        slide[1] = paired[0] + paired[1] / 2


def accept(
    block: BlockEquations,
    shear_law: Shear,
    stage: BlockStage,
    length: StepLength,
    before: BlockState,
    after: BlockState,
) -> None:
    """Write (D, P, f) at the end of the stage under the contact forces."""
    room = block.room
    n = len(block.K)
    c = len(block.room.slide)
    normal = block.work.mean if block.rule == 2 else after.contacts.normal
    contact_forces(block, shear_law, normal, after.contacts.shear)
    ratio = length.numbers[0]
    h2 = length.numbers[2] * length.numbers[2]
    for i in range(n):
        after.D[i] = before.D[i] + room.x[i] + dot(length.pushed[i], room.forces, len(block.B))
    for i in range(c):
        after.D[n - c + i] = after.contacts.gap[i]
    for i in range(n):
        pressed = 0.0
        for j in range(len(block.B)):
            pressed += block.B[j][i] * room.forces[j]
        pressed = h2 * (block.multiplicity * pressed)
        own = pressed if block.rule == 0 else 0.0  # what of it enters f
        force, f1, P1 = motion_at_end(block, stage, length, before, after.D[i], own, i)
        if block.rule != 0:
            P1 += pressed
        after.force[i] = force / (ratio * ratio)
        after.P[i] = P1 / ratio
        after.f[i] = f1 / (ratio * ratio)


def contact_forces(block: BlockEquations, shear_law: Shear, normal: Vector, shear: Vector) -> None:
    """Write the forces in the coordinates of B: N, then T, or H = T_M + T_N and G = (T_N - T_M)/2."""
    room = block.room
    c = len(block.room.slide)
    for i in range(c):
        room.forces[i] = normal[i]
    if shear_law is None:
        return
    room.forces[c] = shear[0]
    if c == 2:
        room.forces[2] = shear[0] + shear[1]
        room.forces[3] = (shear[1] - shear[0]) / 2


def refer(block: BlockEquations, before: Contacts, after: BlockState) -> None:
    """Write the references; where a corner stays closed and does not slip, U in D is set from its own.

    The sum of increments that U was may hold the rounding of a much larger motion without forces.
    """
    room = block.room
    c = len(block.room.slide)
    contacts = after.contacts
    slides_by(block, after.D, room.slide)
    staying = 0
    apart = 0.0
    for i in range(c):
        if stays(before, contacts, i):
            staying += 1
            apart += before.reference[i] + contacts.stretch[i] - room.slide[i]
    if c == 2 and staying > 0:
        after.D[U_INDEX] += apart / staying
        for i in range(c):
            room.slide[i] += apart / staying
    for i in range(c):
        if stays(before, contacts, i):
            contacts.reference[i] = before.reference[i]
        else:
            contacts.reference[i] = room.slide[i] - contacts.stretch[i]


def stays(before: Contacts, after: Contacts, i: int) -> bool:
    """Tell whether a contact is closed before and after the step and does not slip in it."""
    return bool(before.state[i] != OPEN and after.state[i] != OPEN and after.slipped[i] == 0)


# ---- what is kept ----------------------------------------------------------------------------------------------------


def kinetic_energy(block: BlockEquations, state: BlockState) -> float:
    """Return the kinetic energy of the momentum that is carried [J]."""
    return quadratic(block.inverse_mass, state.P, len(block.K)) / 2 / (block.step * block.step)


def account_stage(
    block: BlockEquations,
    shear_law: Shear,
    stage: BlockStage,
    before: BlockState,
    after: BlockState,
    part: Part,
    sums: Vector,
) -> None:
    """Add what the contacts lose in a stage, and what base and a load that rises give.

    Forces of contact and loads that rise act with the weights 1 - delta and delta at the two ends of Newmark's step,
    with one half at those of another scheme's stage.
    """
    room = block.room
    numbers = stage.numbers
    late = 0.5 if block.by_balance else numbers.delta
    for i in range(len(block.K)):
        room.change[i] = after.D[i] - before.D[i]
    if block.rule != 2:
        if shear_law is not None:
            slides_by(block, room.change, room.slide)
        add_contact_losses(
            block.law,
            shear_law,
            before.contacts,
            after.contacts,
            stage.slipped,
            room.slide,
            stage.base,
            late if block.rule == 0 else 1.0,
            block.step * part.ratio * (numbers.end - numbers.begin),
            block.multiplicity,
            sums,
        )
    if block.ramp > 0:  # what a load that rises does beside the work of the whole one
        share = mean_share(block, numbers, part, late)
        for i in range(len(block.K)):
            moved = room.change[i] + dot(block.translation[i], stage.base, 2)
            sums[GIVEN] += (share - 1) * block.load[i] * moved


def mean_share(block: BlockEquations, numbers: Stage, part: Part, late: float) -> float:
    """Return the share of a load that rises which acts over a stage, `late` of it as at its end."""
    begin = load_share(block.ramp, (part.begun + part.ratio * numbers.begin) * block.step)
    end = load_share(block.ramp, (part.begun + part.ratio * numbers.end) * block.step)
    return (1 - late) * begin + late * end


def add_algorithmic_loss(block: BlockEquations, state: BlockState, after: BlockState, part: Part, sums: Vector) -> None:
    """Add what Newmark's step loses [J] beside the contacts."""
    room = block.room
    alpha = block.last.numbers.alpha
    delta = block.last.numbers.delta
    n = len(block.K)
    h = block.step * part.ratio
    dt2 = block.step * block.step
    stiff = 0.0
    for i in range(n):
        room.change[i] = after.D[i] - state.D[i]
        stiff += room.change[i] * room.change[i] * block.K[i]
    if part.begun == 0:  # A0 may be any; later M A = F - K D + B' lambda
        for i in range(n):
            moved = room.change[i] + dot(block.translation[i], block.last.base, 2)
            sums[ALGORITHMIC] += (1 - delta) * moved * (state.force[i] - state.f[i]) / dt2
    kinetic = 0.0
    kinetic_of_change = 0.0
    if alpha != delta / 2:
        for i in range(n):
            room.change[i] = (after.f[i] - state.f[i]) / dt2
        stored = quadratic(block.inverse_mass, after.f, n) - quadratic(block.inverse_mass, state.f, n)
        kinetic = stored / 2 / dt2 / dt2
        kinetic_of_change = quadratic(block.inverse_mass, room.change, n) / 2
    sums[ALGORITHMIC] += bulk_loss(alpha, delta, h * h, stiff, kinetic, kinetic_of_change)


def keep(block: BlockEquations, state: BlockState, rows: Array, number: int) -> bool:
    """Write D and the momentum at its time, at the end of a step; tell whether it is finite."""
    n = len(block.K)
    total = 0.0
    for i in range(n):
        rows[number, i] = state.D[i]
        rows[number, n + i] = state.P[i]
        if block.lag != 0:
            discount = block.gg if number == 0 else 1.0  # of what `late_momentum` made of the velocity at t = 0
            rows[number, n + i] = discount * state.P[i] + block.lag * state.f[i]
        total += state.D[i]
    if rows.shape[1] > 2 * n:
        rows[number, 2 * n] = block.passes[0]
        block.passes[0] = 0.0
    return math.isfinite(total)


advance = staged(stage_with(solve_at_end))
account = accounted(kinetic_energy, account_stage, add_algorithmic_loss)
make_steps = driver(advance, account, keep)
make_conserving_steps = driver(staged(stage_with(solve_conserving)), account, keep)
make_damped_steps = driver(staged(stage_with(solve_damped)), account, keep)
make_augmented_steps = driver(staged(stage_with(solve_augmented)), account, keep)
