"""Histories of sub-blocks over a base that carries no tension."""

from __future__ import annotations

import math
from collections.abc import Sequence
from functools import partial
from time import perf_counter

import numpy as np
from numpy.typing import NDArray

from dda.contact.unilateral import CONSISTENT, LAGGED
from dda.one_block.contact_result import ContactResult, early_end
from dda.one_block.solution import check_request, step_times
from dda.one_block.unilateral import UnilateralOptions, check_scheme
from dda.one_block.unilateral_energy import ENERGIES
from dda.one_block.unilateral_step import NEWMARK
from dda.scheme.newmark import Scheme
from dda.stepping.driver import OUTCOMES, counts_of, reached_rows
from dda.system.opening import OpeningBody, OpeningSystem, SystemHistory, make_steps

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
    history, counts = body.history(steps), counts_of(steps, options.energies)
    ready = perf_counter()
    with np.errstate(all="ignore"):
        reached, outcome = make_steps(
            body, body.start_state(), body.start_state(), None, history, counts, steps, options.cut
        )
    history = SystemHistory(*reached_rows(history, reached))
    mass = math.fsum(block.material.density * block.section.area for block in opening.system.blocks)
    velocity = history.momentum.T / (mass * scheme.step)
    losses = counts.losses[:reached]

    def balance() -> dict[str, Array]:
        stored = history.stored.copy()
        stored[:, 3] -= losses[:, 4]
        return dict(zip(ENERGIES, (*stored.T, *losses[:, :4].T), strict=True))

    parts = {name: np.transpose(getattr(history, name)) for name in ("normal", "shear", "gap", "slide", "slipped")}
    parts["stretch"] = 0.0 - parts["shear"] / law.shear if law.shear else np.zeros_like(parts["shear"])
    parts |= {"states": history.state.T.astype(int), "horizontal_velocity": velocity[0], "velocity": velocity[1]}
    return ContactResult(
        time=step_times(scheme, reached),
        columns=dict(zip(columns, history.columns.T + 0.0, strict=True)),
        unknowns=len(opening.equations.F),
        nonzeros=nonzeros,
        factorisations=body.made,
        solves=int(counts.solves[:reached].sum()),
        notes=(f"stepped, {body.find.how}: contact opens and closes", *early_end(outcome, reached)),
        setup_seconds=ready - began,
        stepping_seconds=perf_counter() - ready,
        outcome=OUTCOMES[outcome],
        step_solves=counts.solves[:reached],
        step_cuts=counts.cuts[:reached],
        base_contacts=(0, -1),
        parts={name: partial(np.asarray, values) for name, values in parts.items()},
        balance=balance if options.energies else None,
    )
