r"""Histories of one block on corners that open: pressed, dropped or thrown against its base.

The block is that of `dda.TwoBlockModel`; its two base corners carry pressure only (`dda.contact.unilateral`).
A step whose contacts have no single state is cut, from the state in which it began; the rest of the interval
follows, so that every interval ends at its own time.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from time import perf_counter

import numpy as np

from dda.bodies.opening_block import OpeningBlock, observed, opening_block, start_of, unknowns_of
from dda.bodies.two_block import carried
from dda.contact.rows import Laws, laws_of
from dda.contact.unilateral import Unilateral
from dda.march.energy import CONTACT, DASHPOT, energies_of
from dda.march.energy import IMPACT as IMPACT_LOSS
from dda.march.methods import Method, make_augmented_steps, make_conserving_steps, make_impact_steps, make_steps
from dda.march.run import run
from dda.march.step import History, course_of, march_of
from dda.model.arrays import Array
from dda.model.checks import check_count, check_finite, check_positive
from dda.model.load import LoadedBlock, at_once
from dda.result.contact_result import ContactResult, run_fields
from dda.result.result import check_request, step_times
from dda.scheme.newmark import Scheme

NEWMARK = "newmark"
IMPLICIT = "implicit"
CONSERVING = "energy-conserving"
IMPACT = "impact"
AUGMENTED = "augmented"
RULES = (NEWMARK, IMPLICIT, CONSERVING, IMPACT, AUGMENTED)
LOOPS = {CONSERVING: make_conserving_steps, IMPACT: make_impact_steps, AUGMENTED: make_augmented_steps}


@dataclass(frozen=True, eq=False, init=False)
class UnilateralModel(LoadedBlock):
    """One block over corners that carry no tension, at both ends of its base edge; a base that moves starts at zero."""

    contact: Unilateral
    velocity: float = 0.0  # of the block at t = 0, upwards positive [m/s]

    def check(self) -> None:
        """Check the numbers and the edges."""
        super().check()
        check_finite(velocity=self.velocity)
        motion = self.load.motion
        if motion is not None and np.any(start := motion.at([0.0])[0]):
            raise ValueError(f"motion: must be zero at t = 0 where contact opens, got {tuple(start.tolist())}")

    @cached_property
    def reduced(self) -> OpeningBlock:
        """The block in the unknowns that move."""
        return opening_block(self, self.velocity)


@dataclass(frozen=True)
class UnilateralOptions:
    """How the contacts are found and what is kept.

    The rules, beside "newmark" with a penalty spring, a dashpot beside it, or a rigid stop:

    - "implicit": the contact force of the end alone (Kane and others 1999), the block by average acceleration;
    - "energy-conserving": the force that does the work of its spring (Armero and Petocz 1998), the block likewise;
    - "impact": impulses with a coefficient of restitution on a rigid stop (Moreau and Jean), by the theta method, which
      is Newmark's (theta^2, 2 theta - 1/2). e is exact at every step; what a landing leaves of penetration, up to V dt,
      stays;
    - "augmented": passes of an augmented Lagrangian (Uzawa) over springs of the given stiffness until no contact is
      pressed deeper than `penetration`. They lead to the rigid stop, whose rebound is arbitrary at every step.

    Raises
    ------
    ValueError
        If a value is out of its range.
    """

    rule: str = NEWMARK  # among RULES
    solve_limit: int = 6  # solves of the open-close iteration before all states are tried
    cut: float = 0.3  # length of a cut step over that of the failed one
    energies: bool = False  # keep what the energies of every step are made of
    full: bool = False  # keep all six unknowns and both corners where the motion is symmetric
    restitution: float | None = None  # e of the rule "impact" [-]
    penetration: float = 1e-9  # to which the passes of the rule "augmented" reduce it [m]
    pass_limit: int = 100_000  # these passes in a step, before the history ends

    def __post_init__(self) -> None:
        """Check the ranges."""
        if self.rule not in RULES:
            raise ValueError(f"rule: must be among {', '.join(RULES)}, got {self.rule!r}")
        if (self.rule == IMPACT) != (self.restitution is not None):
            raise ValueError(
                f"restitution: goes with rule = {IMPACT!r}, which needs it, "
                f"got {self.restitution!r} with rule = {self.rule!r}"
            )
        if self.restitution is not None and not 0 <= self.restitution <= 1:
            raise ValueError(f"restitution: must be from 0 to 1, got {self.restitution!r}")
        check_positive(penetration=self.penetration)
        check_count(pass_limit=self.pass_limit)
        check_iteration(self.solve_limit, self.cut)


def check_iteration(solve_limit: int, cut: float) -> None:
    """Raise ValueError where the numbers of the open-close iteration are out of range."""
    check_count(solve_limit=solve_limit)
    if not 0 < cut < 1:
        raise ValueError(f"cut: must be between 0 and 1, got {cut!r}")


def solve_unilateral(
    model: UnilateralModel,
    scheme: Scheme,
    steps: int,
    columns: Sequence[str] = ("displacement", "contact_pressure"),
    options: UnilateralOptions | None = None,
) -> ContactResult:
    """Step a block on corners that open, from rest or from its starting velocity.

    Displacements count from t = 0. A numerical failure is an outcome, not an exception: the history then
    ends with the last step that was reached.

    Parameters
    ----------
    model, scheme
        What moves and how it is stepped. The start "consistent" means M A0 = F, since no contact presses at t = 0.
    steps : int
        Number of steps.
    columns : sequence of str
        Any of `dda.COLUMNS`.
    options
        How the contacts are found; the defaults if absent.

    Raises
    ------
    ValueError
        If the number of steps is not positive, a column is unknown, or rule, scheme and contact exclude each other.
    """
    check_request(steps, columns)
    options = options or UnilateralOptions()
    check_combination(model, scheme, options)
    began = perf_counter()
    law = model.contact
    if frictionless(law, options):  # no corner slides, even if `full` keeps the unknowns that could
        law = replace(law, shear=0.0)
        model = replace(model, contact=law)
    block = opening_block(model, model.velocity, full=True) if options.full else model.reduced
    shape = block.contacts, len(block.B), options.solve_limit, block.multiplicity
    springs = laws_of(law, *shape)
    rigid = options.rule == AUGMENTED  # the limit of its passes
    laws = laws_of(replace(law, stiffness=math.inf), *shape) if rigid else springs
    with np.errstate(all="ignore"):  # overflow is an outcome
        start = start_of(block, scheme, law.gap, model.velocity, at_once=options.rule == CONSERVING)
    march = march_of(
        block.body,
        laws,
        scheme,
        start.rows.opening,
        Method(springs, options.penetration, options.pass_limit, options.restitution or 0.0),
        averages=options.rule in (NEWMARK, AUGMENTED),
        impulses=options.rule == IMPACT,
    )
    motion = model.load.motion
    course = course_of(motion and motion.along(block.axes), block.ramp)
    n = len(block.unknowns)
    loop = LOOPS.get(options.rule, make_steps)
    ready = perf_counter()
    ran = run(march, start, course, steps, loop, 2 * n + rigid, options.energies, options.cut)
    history = ran.history
    reached = len(history.solves) - 1
    with np.errstate(all="ignore"):
        values = {name: column(model, block, history, name, scheme.step) for name in columns}
    for name, moved in carried(motion, step_times(scheme, reached)).items():
        if name in values:
            values[name] = values[name] + moved
    impulses = None
    if options.rule == IMPACT:
        impulses = np.broadcast_to(scheme.step * history.force[1:].T / block.multiplicity, (2, reached))
    notes = [f"stepped, {ran.how}: contact opens and closes"]
    if n < 6:
        notes.insert(0, f"both corners as one, unknowns {', '.join(block.unknowns)}")

    def velocity() -> Array:
        momentum: Array = block.axes.T @ block.momentum @ history.motion[1:, n : 2 * n].T
        return momentum / (model.block.total_mass * scheme.step)

    return ContactResult(
        **run_fields(history, ran.outcome, scheme, notes, (began, ready)),
        columns=values,
        unknowns=n,
        nonzeros=int(np.count_nonzero(block.M)),
        factorisations=ran.lengths,
        contacts=block.contacts,
        multiplicity=block.multiplicity,
        base_contacts=(0, 1),
        make_slide=lambda: block.slide @ unknowns_of(block, history, motion, scheme.step)[:, 1:],
        make_velocity=velocity,
        impulses=impulses,
        step_passes=history.motion[1:, 2 * n].astype(int) if rigid else None,
        balance=(lambda: energies(model, block, laws, scheme, history, options.rule)) if options.energies else None,
    )


def column(model: UnilateralModel, block: OpeningBlock, history: History, name: str, step: float) -> Array:
    """Return a column of every step."""
    if name == "contact_pressure":
        return np.asarray(history.force[1:, : block.contacts].sum(axis=1) / model.base_length + 0.0)
    row = block.observers[name]
    return observed(block, row, history, model.load.motion, step)[1:] - row @ block.start + 0.0


def energies(
    model: UnilateralModel,
    block: OpeningBlock,
    laws: Laws,
    scheme: Scheme,
    history: History,
    rule: str,
) -> dict[str, Array]:
    """Return the energies [J] after every step, the losses summed from t = 0 on.

    They are those of `dda.march.energy`, with "dashpot" or "impact" where contact has one. Energy-conserving contact
    does the work U0 - U1 itself and loses nothing.
    """
    n = len(block.unknowns)
    z = history.motion[:, :n]
    v = history.motion[:, n : 2 * n] / scheme.step
    load = block.start @ block.F - observed(block, block.F, history, model.load.motion, scheme.step)
    if model.load.motion is not None:
        moved = model.load.motion.at(scheme.step * np.arange(float(len(z))))
        load -= moved @ (block.axes.T @ block.translation.T @ block.F)
    springs = history.force
    if model.contact.damping:
        springs = np.maximum(-history.opening, 0.0) / laws.compliance
    stored = (
        np.sum(v * v, axis=1) / 2,
        (z * z) @ block.body.k / 2,
        (springs * springs) @ laws.compliance / 2,
        load,
    )
    energies = energies_of(stored, history.sums, scheme.table is not None)
    if model.contact.damping:
        energies[DASHPOT] = history.sums[1:, CONTACT]
    if rule == IMPACT:
        energies[IMPACT_LOSS] = history.sums[1:, CONTACT]
    return energies


def check_combination(model: UnilateralModel, scheme: Scheme, options: UnilateralOptions) -> None:
    """Raise ValueError where rule, scheme and contact exclude each other."""
    law = model.contact
    if options.rule not in (NEWMARK, AUGMENTED) and scheme.table is not None:
        raise ValueError(f"rule: {options.rule} contact goes with scheme newmark only, got {scheme.name!r}")
    if law.damping and options.rule != NEWMARK:
        raise ValueError(
            f"damping: a dashpot goes with rule = {NEWMARK!r} only, got {law.damping:g} with rule = {options.rule!r}"
        )
    if frictionless(law, options) and len(model.reduced.B) > model.reduced.contacts:
        subject = "damping: a dashpot" if law.damping else f"rule: {options.rule} contact"
        raise ValueError(f"{subject} needs shear = 0 where the base can slide, got {law.shear:g}")
    if options.rule == IMPACT:
        check_impact(model, scheme)
    if options.rule == AUGMENTED and (math.isinf(law.stiffness) or any(law.band) or scheme.alpha == 0):
        raise ValueError(
            f"rule: {AUGMENTED} contact needs a finite stiffness (that of its passes), no band and an implicit scheme, "
            f"got stiffness = {law.stiffness:g}, band = {law.band} and alpha = {scheme.alpha:g}"
        )
    if options.rule in (IMPLICIT, CONSERVING) and (scheme.alpha, scheme.delta) != (0.25, 0.5):
        weights = (scheme.alpha, scheme.delta)
        raise ValueError(
            f"rule: {options.rule} contact needs average acceleration, alpha = 1/4, delta = 1/2, got {weights}"
        )
    if options.rule == CONSERVING:
        if math.isinf(law.stiffness) or any(law.band):
            raise ValueError(
                f"rule: {CONSERVING} contact needs a finite stiffness and no band, "
                f"got stiffness = {law.stiffness:g} and band = {law.band}"
            )
        at_once(model.load, f"{CONSERVING} contact")
        if model.load.motion is not None:
            raise ValueError(f"rule: {CONSERVING} contact needs a base at rest, got one that moves")
    check_scheme(law, scheme)


def frictionless(law: Unilateral, options: UnilateralOptions) -> bool:
    """Tell whether contact has no forces along the base, whatever its law has."""
    return bool(law.damping) or options.rule in LOOPS


def check_impact(model: UnilateralModel, scheme: Scheme) -> None:
    """Raise ValueError where impulses do not go with the scheme or the contact."""
    law = model.contact
    theta = (scheme.delta + 0.5) / 2
    if not (0 < theta <= 1 and math.isclose(scheme.alpha, theta * theta, rel_tol=1e-9)):
        raise ValueError(
            f"rule: {IMPACT} contact needs alpha = theta^2, delta = 2 theta - 1/2, e.g. 1/4 and 1/2, or 9/16 and 1, "
            f"got {(scheme.alpha, scheme.delta)}"
        )
    if not math.isinf(law.stiffness):
        raise ValueError(f"rule: {IMPACT} contact needs a rigid stop, stiffness = inf, got {law.stiffness:g}")
    if law.friction is not None or any(law.band):
        raise ValueError(
            f"rule: {IMPACT} contact needs no friction and no band, got friction = {law.friction} and band = {law.band}"
        )
    if model.load.motion is not None:
        raise ValueError(f"rule: {IMPACT} contact needs a base at rest, got one that moves")


def check_scheme(law: Unilateral, scheme: Scheme) -> None:
    """Raise ValueError where an explicit scheme meets a rigid stop, or viscous damping a contact."""
    if scheme.damped:
        damping = (scheme.mass_damping, scheme.stiffness_damping)
        raise ValueError(f"mass_damping, stiffness_damping: must be 0 where contact opens, got {damping}")
    if math.isinf(law.stiffness) and scheme.alpha == 0:
        raise ValueError(f"stiffness: must be finite in an explicit scheme (alpha = 0), got {law.stiffness}")
