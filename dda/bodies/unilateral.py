r"""Histories of one block on corners that open: pressed, dropped or thrown against its base.

The block is that of `dda.TwoBlockModel`; its two base corners carry pressure only (`dda.contact.unilateral`).
A step whose contacts have no single state is cut, from the state in which it began; the rest of the interval
follows, so that every interval ends at its own time.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from time import perf_counter
from typing import Any, ClassVar, Protocol, TypeVar

import numpy as np

from dda.bodies.opening_block import OpeningBlock, observed, opening_block, start_of
from dda.bodies.turning_body import EXACT, FIRST_ORDER
from dda.contact.rows import Laws, laws_of
from dda.contact.unilateral import Unilateral
from dda.march.energy import CONTACT, DASHPOT, energies_of
from dda.march.energy import IMPACT as IMPACT_LOSS
from dda.march.methods import Method, make_augmented_steps, make_conserving_steps, make_impact_steps, make_steps
from dda.march.run import run
from dda.march.step import History, course_of, march_of
from dda.model.arrays import Array, Columns
from dda.model.checks import check_among, check_count, check_finite, check_positive, check_share
from dda.model.load import LoadedBlock, at_once
from dda.result.contact_result import ContactResult, run_fields
from dda.result.result import check_request
from dda.scheme.newmark import Scheme

NEWMARK = "newmark"
IMPLICIT = "implicit"
CONSERVING = "energy-conserving"
IMPACT = "impact"
AUGMENTED = "augmented"
RULES = (NEWMARK, IMPLICIT, CONSERVING, IMPACT, AUGMENTED)
AnyResult = TypeVar("AnyResult", bound=ContactResult, covariant=True)
LOOPS = {CONSERVING: make_conserving_steps, IMPACT: make_impact_steps, AUGMENTED: make_augmented_steps}


@dataclass(frozen=True, eq=False, init=False)
class UnilateralModel(LoadedBlock):
    """One block over corners that carry no tension, at both ends of its base edge; a base that moves starts at zero."""

    contact: Unilateral
    velocity: float = 0.0  # of the block at t = 0, upwards positive [m/s]
    rules: ClassVar[tuple[str, ...]] = RULES

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

    def history(self, scheme: Scheme, steps: int, columns: Sequence[str], options: UnilateralOptions) -> ContactResult:
        """Make the steps."""
        began = perf_counter()
        model = self
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
        n = len(block.form.unknowns)
        loop = LOOPS.get(options.rule, make_steps)
        ready = perf_counter()
        ran = run(march, start, course, steps, loop, 2 * n + rigid, options.energies, options.cut)
        history = ran.history
        with np.errstate(all="ignore"):
            values = {name: column(model, block, history, name, scheme.step) for name in columns}
        notes = [f"stepped, {ran.how}: contact opens and closes"]
        if n < 6:
            notes.insert(0, f"both corners as one, unknowns {', '.join(block.form.unknowns)}")

        def slide() -> Array:
            ways = block.form.corners[0].T
            return np.array([observed(block, row, history, motion, scheme.step)[1:] for row in ways])

        def velocity() -> Array:
            momentum: Array = block.axes.T @ block.momentum @ history.motion[1:, n : 2 * n].T
            return momentum / (model.block.total_mass * scheme.step)

        return ContactResult(
            **run_fields(history, ran.outcome, scheme, notes, (began, ready)),
            columns=values,
            unknowns=n,
            nonzeros=int(np.count_nonzero(block.form.M)),
            factorisations=ran.lengths,
            contacts=block.contacts,
            multiplicity=block.multiplicity,
            base_contacts=(0, 1),
            make_slide=slide,
            make_velocity=velocity,
            step_passes=history.motion[1:, 2 * n].astype(int) if rigid else None,
            balance=(lambda: energies(model, block, laws, scheme, history, options.rule)) if options.energies else None,
        )


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
    """

    rule: str = NEWMARK  # among RULES
    solve_limit: int = 6  # solves of the open-close iteration before all states are tried
    cut: float = 0.3  # length of a cut step over that of the failed one
    energies: bool = False  # keep what the energies of every step are made of
    full: bool = False  # keep all six unknowns and both corners where the motion of one block is symmetric
    restitution: float | None = None  # e of the rule "impact" [-]
    penetration: float = 1e-9  # to which the passes of the rule "augmented" reduce it [m]
    pass_limit: int = 100_000  # these passes in a step, before the history ends
    rotation: str = EXACT  # or "first-order": the outline of a step moves by x - r y, y + r x, and grows

    def __post_init__(self) -> None:
        check_among(RULES, rule=self.rule)
        check_among((EXACT, FIRST_ORDER), rotation=self.rotation)
        if (self.rule == IMPACT) != (self.restitution is not None):
            raise ValueError(
                f"restitution: goes with rule = {IMPACT!r}, which needs it, "
                f"got {self.restitution!r} with rule = {self.rule!r}"
            )
        if self.restitution is not None:
            check_share(restitution=self.restitution)
        check_positive(penetration=self.penetration)
        check_count(pass_limit=self.pass_limit, solve_limit=self.solve_limit)
        if not 0 < self.cut < 1:
            raise ValueError(f"cut: must be between 0 and 1, got {self.cut!r}")


class OpeningBody(Protocol[AnyResult]):
    """A body on contact that opens: one block, its sub-blocks, or a block that turns."""

    rules: ClassVar[tuple[str, ...]]  # that it takes

    @property
    def contact(self) -> Unilateral:
        """The law of its corners."""

    def history(self, scheme: Scheme, steps: int, columns: Sequence[str], options: UnilateralOptions) -> AnyResult:
        """Make the steps."""


def solve_unilateral(
    model: OpeningBody[AnyResult],
    scheme: Scheme,
    steps: int,
    columns: Sequence[str] = ("displacement", "contact_pressure"),
    options: UnilateralOptions | None = None,
) -> AnyResult:
    """Step blocks on contact that opens, from rest or from their starting velocity.

    Displacements and rotation count from t = 0; strains of a block that turns are those along axes that turn with it. A
    numerical failure is an outcome: the history then ends with the last step that was reached.

    Parameters
    ----------
    model, scheme
        What moves, a `UnilateralModel`, an `OpeningSystem` or a `RollingModel`, and how it is stepped. The start
        "consistent" means M A0 = F, since no contact presses at t = 0.
    columns : sequence of str
        Any of `dda.COLUMNS`.

    Raises
    ------
    ValueError
        If the number of steps is not positive, a column is unknown, or rule, scheme and contact exclude each other.
    """
    check_request(steps, columns)
    options = options or UnilateralOptions()
    for field, holds, rule, value in requirements(model, scheme, options):
        if not holds:
            raise ValueError(f"{field}: {rule}, got {value}")
    return model.history(scheme, steps, columns, options)


def column(model: UnilateralModel, block: OpeningBlock, history: History, name: str, step: float) -> Array:
    """Return a column of every step."""
    if name == "contact_pressure":
        return np.asarray(history.force[1:, : block.contacts] @ np.ones(block.contacts) / model.base_length + 0.0)
    (row,), (by_base,) = block.form.rows([name])
    motion = model.load.motion
    moved: Array = observed(block, row, history, motion, step)[1:] - row @ block.start + 0.0
    if motion is not None and by_base.any():
        moved += motion.at(step * np.arange(1.0, len(moved) + 1)) @ by_base
    return moved


def energies(
    model: UnilateralModel,
    block: OpeningBlock,
    laws: Laws,
    scheme: Scheme,
    history: History,
    rule: str,
) -> Columns:
    """Return the energies [J] from t = 0 on, the losses summed.

    They are those of `dda.march.energy`, with "dashpot" or "impact" where contact has one. Energy-conserving contact
    does the work U0 - U1 itself and loses nothing.
    """
    n = len(block.form.unknowns)
    z = history.motion[:, :n]
    v = history.motion[:, n : 2 * n] / scheme.step
    load = block.start @ block.form.F - observed(block, block.form.F, history, model.load.motion, scheme.step)
    if model.load.motion is not None:
        moved = model.load.motion.at(scheme.step * np.arange(len(z)))
        load -= moved @ (block.axes.T @ block.translation.T @ block.form.F)
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
        energies[DASHPOT] = history.sums[:, CONTACT]
    if rule == IMPACT:
        energies[IMPACT_LOSS] = history.sums[:, CONTACT]
    return energies


def requirements(model: Any, scheme: Scheme, options: UnilateralOptions) -> Iterator[tuple[str, bool, str, object]]:
    """Yield what body, scheme, law and rule need of each other: field, whether it holds, the rule, what there is."""
    law = model.contact
    rule = options.rule
    weights = scheme.alpha, scheme.delta
    sprung = not math.isinf(law.stiffness)
    needs = f"{rule} contact needs"
    yield "rule", rule in model.rules, f"must be among {', '.join(model.rules)} for such a body", repr(rule)
    if rule not in (NEWMARK, AUGMENTED):
        yield "rule", scheme.table is None, f"{rule} contact goes with scheme newmark only", repr(scheme.name)
    if law.damping:
        yield "damping", rule == NEWMARK, f"a dashpot goes with rule = {NEWMARK!r} only", f"rule = {rule!r}"
    if frictionless(law, options):
        field = "damping" if law.damping else "rule"
        slides = len(model.reduced.B) > model.reduced.contacts
        yield field, not slides, "it needs shear = 0 where the base can slide", f"{law.shear:g}"
    if rule in (IMPLICIT, CONSERVING):
        yield "rule", weights == (0.25, 0.5), f"{needs} average acceleration, alpha = 1/4, delta = 1/2", weights
    if rule in (CONSERVING, AUGMENTED):
        yield "rule", sprung, f"{needs} a finite stiffness", f"{law.stiffness:g}"
    if rule in LOOPS:
        yield "rule", not any(law.band), f"{needs} no band", law.band
    if rule == AUGMENTED:
        yield "rule", scheme.alpha > 0, f"{needs} an implicit scheme", f"alpha = {scheme.alpha:g}"
    if rule == CONSERVING:
        at_once(model.load, f"{CONSERVING} contact")
    if rule in (CONSERVING, IMPACT):
        yield "rule", model.load.motion is None, f"{needs} a base at rest", "one that moves"
    if rule == IMPACT:
        theta = (scheme.delta + 0.5) / 2
        fits = 0 < theta <= 1 and math.isclose(scheme.alpha, theta * theta, rel_tol=1e-9)
        yield "rule", fits, f"{needs} alpha = theta^2, delta = 2 theta - 1/2, e.g. 1/4 and 1/2, or 9/16 and 1", weights
        yield "rule", not sprung, f"{needs} a rigid stop, stiffness = inf", f"{law.stiffness:g}"
        yield "rule", law.friction is None, f"{needs} no friction", law.friction
    damping = scheme.mass_damping, scheme.stiffness_damping
    yield "mass_damping, stiffness_damping", not scheme.damped, "must be 0 where contact opens", damping
    explicit = scheme.alpha == 0
    yield "stiffness", sprung or not explicit, "must be finite in an explicit scheme (alpha = 0)", law.stiffness


def frictionless(law: Unilateral, options: UnilateralOptions) -> bool:
    """Tell whether contact has no forces along the base, whatever its law has."""
    return bool(law.damping) or options.rule in LOOPS
