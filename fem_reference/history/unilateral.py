"""Histories of the block on a base that carries no tension."""

from __future__ import annotations

import time
from dataclasses import dataclass

import numpy as np

from fem_reference.contact import compilation
from fem_reference.contact.columns import ENERGY_COLUMNS, LOSS_COLUMNS, UNILATERAL_COLUMNS, columns_of
from fem_reference.contact.driver import OUTCOMES, Cut, histories
from fem_reference.contact.law import AT_LOWER, INSIDE
from fem_reference.contact.march import ContactState, Record
from fem_reference.contact.points import ContactModel, Friction, build
from fem_reference.contact.stepper import ContactStepper
from fem_reference.problem.checks import require, require_numbers
from fem_reference.problem.digits import coarse
from fem_reference.problem.problem import Array, Problem, Scheme
from fem_reference.problem.result import Result, check_request, just_ended


@dataclass(frozen=True)
class Unilateral:
    """How the block stands on its base, and how its contact is solved."""

    gap: float = 0.0  # g0 under the whole base at t = 0 [m], at least 0
    velocity: float = 0.0  # at t = 0 [m/s], upwards positive
    shear: str = "frictionless"  # or "glued": shear springs of the problem's shear stiffness hold closed points
    limit: int = 6  # most solutions of the open-close iteration before its fallback [-]
    cut: float = 0.3  # factor on a step whose contact has no solution [-], between 0 and 1
    rule: str = "newmark"  # or "implicit": the contact force of the step's end, under average acceleration
    shortest: float = 0.01  # shortest step over the scheme's own [-], above 0 and at most 1
    friction: Friction | None = None  # limit of the forces of glued points; none if absent

    def __post_init__(self) -> None:
        require_numbers(self, unsigned=("gap",))
        glued = self.friction is None or self.shear == "glued"
        require(glued, "friction", "goes with shear = 'glued' only", self.friction)
        shears = "frictionless", "glued"
        require(self.shear in shears, "shear", "must be 'frictionless' or 'glued'", self.shear)
        require(self.rule in ("newmark", "implicit"), "rule", "must be 'newmark' or 'implicit'", self.rule)
        require(self.limit >= 1, "limit", "must be at least 1", self.limit)
        require(0 < self.cut < 1, "cut", "must be between 0 and 1", self.cut)
        require(0 < self.shortest <= 1, "shortest", "must be above 0 and at most 1", self.shortest)


@dataclass(frozen=True, kw_only=True)
class UnilateralResult(Result):
    """A history that may have ended early, after fewer steps than were asked for."""

    points: int  # number of contact points of the base [-]


def solve_unilateral(
    problem: Problem,
    scheme: Scheme,
    steps: int,
    contact: Unilateral | None = None,
    full: bool = False,
    columns: tuple[str, ...] = UNILATERAL_COLUMNS,
) -> UnilateralResult:
    """Integrate the block on a base that carries no tension, unstrained at t = 0 with all loads switched on.

    Parameters
    ----------
    contact
        How the block stands on its base; touching, at rest and without friction if None.
    full
        Solve the whole block where one column of elements would do.
    columns
        Among `fem_reference.UNILATERAL_COLUMNS`.

    Raises
    ------
    ValueError
        If the block cannot be meshed, its base is displaced at t = 0, `steps` is below one or a column is unknown.
    """
    check_request(steps, columns, UNILATERAL_COLUMNS)
    require(not problem.ramp, "ramp", "does not go with contact that opens", problem.ramp)
    contact = contact or Unilateral()
    began = time.perf_counter()
    model = build(problem, full)
    system, compiled, notes = compilation.prepared(model.system(contact.shear, contact.friction), steps, full)
    stepper = ContactStepper(
        system,
        scheme,
        contact.limit,
        rule=contact.rule,
        # the ground's work, which the loads' energy takes off, comes with the losses
        energies=any(name in ENERGY_COLUMNS for name in columns),
        losses=any(name in (*LOSS_COLUMNS, "load_energy") for name in columns),
        compiled=compiled,
    )
    state = block_at_start(stepper, model, contact)
    ready = time.perf_counter()
    cut = None if scheme.staggered else Cut(contact.cut, contact.shortest)

    def kept(record: Record) -> dict[str, Array]:
        of_piece = columns_of(record, model, system.rows)
        return {name: of_piece[name] for name in (*columns, "solves")}

    columns_of_steps, marched = histories(stepper, state, steps, cut, kept)
    rows = len(columns_of_steps["solves"])
    saving = ("one column of elements",) if model.kind == "column" else ()
    return UnilateralResult(
        **just_ended(scheme.step, rows, began, ready),
        columns={name: columns_of_steps[name] for name in columns},
        outcome=OUTCOMES[marched.outcome],
        unknowns=len(model.F),
        points=len(model.share),
        **vars(stepper.work),
        notes=(*saving, *coarse(problem, scheme.step, opens=True), *notes),
    )


def block_at_start(stepper: ContactStepper, model: ContactModel, contact: Unilateral) -> ContactState:
    """The block unstrained with one velocity upwards, all of its points a gap above the base."""
    is_normal = np.arange(len(stepper.system.rows.compliance)) < len(model.share)
    place = np.where(is_normal, contact.gap, 0.0)
    states = np.where(place > 0, AT_LOWER, INSIDE).astype(np.int8)
    return stepper.start(stepper.system.unknowns(contact.velocity * model.upwards), place, states)
