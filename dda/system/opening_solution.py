"""Histories of sub-blocks over a base that carries no tension."""

from __future__ import annotations

import math
from collections.abc import Sequence
from time import perf_counter

import numpy as np
from numpy.typing import NDArray

from dda.contact.unilateral import CONSISTENT, LAGGED
from dda.one_block.contact_result import ContactResult, contact_parts, run_fields
from dda.one_block.solution import check_request, step_times
from dda.one_block.unilateral import UnilateralOptions, check_scheme
from dda.one_block.unilateral_step import NEWMARK
from dda.scheme.newmark import Scheme
from dda.stepping.driver import base_record, history_of, reached_history
from dda.stepping.energy import ENERGIES, GIVEN, spring_energies
from dda.system.opening import OpeningBody, OpeningSystem, make_steps

Array = NDArray[np.float64]


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
    law = opening.law
    if law.rules == LAGGED:
        raise ValueError(f"rules: sub-blocks take {CONSISTENT} friction alone, got {LAGGED!r}")
    check_scheme(law, scheme)
    began = perf_counter()
    body = OpeningBody(opening, scheme, options.solve_limit, columns, steps, options.energies)
    nonzeros = body.length(1.0).stepper.factor.nonzeros
    requested, points = len(columns), body.points
    history = history_of(steps, requested + 2 + points + 3 * options.energies, points, options.energies)
    base = base_record(opening.motion and opening.motion.along(opening.axes))
    ready = perf_counter()
    with np.errstate(all="ignore"):
        reached, ended = make_steps(body, body.start_state(), body.start_state(), base, history, steps, options.cut)
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
        kinetic, strain, load = motion[:, requested + 2 + points :].T
        springs = spring_energies(law, history.normal[1:], history.shear[1:])
        stored = (kinetic, strain, springs, load - history.sums[1:, GIVEN])
        return dict(zip(ENERGIES, (*stored, *history.sums[1:, :4].T), strict=True))

    softness = 1 / law.shear if law.shear else 0.0
    own_parts = {"slide": slide, "horizontal_velocity": lambda: velocity[0], "velocity": lambda: velocity[1]}
    return ContactResult(
        **run_fields(history, ended, scheme, [f"stepped, {body.find.how}: contact opens and closes"], (began, ready)),
        columns=dict(zip(columns, motion[:, :requested].T + 0.0, strict=True)),
        unknowns=len(opening.equations.F),
        nonzeros=nonzeros,
        factorisations=body.made,
        base_contacts=(0, -1),
        parts=contact_parts(history, softness, **own_parts),
        balance=balance if options.energies else None,
    )
