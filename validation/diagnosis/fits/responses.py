"""Histories of variants: the suite's own solver where a contact opens, one pass for all the others."""

from __future__ import annotations

from collections.abc import Sequence
from functools import lru_cache
from typing import Literal

import numpy as np

import dda
from validation.diagnosis import stepping
from validation.diagnosis.stepping import UNEQUAL
from validation.diagnosis.variant import GRAVITY, POISSON, Array, Flags, Histories, Rectangle, Variant

KEPT = 128  # histories of opening contact: a fit asks for the same one many times
# what the suite's solver of opening contact does not have: these stand as they are by default
WITHOUT_SOLVER = (
    *("updated", "viscous", "structural", "reset", "discounted", "secant", "strain_load", "coupling", "kept"),
    *("family", "exact", "one_spring", "inertia", "ramp"),
)


def computed(column: Rectangle, variants: Sequence[Variant], steps: Array) -> Histories:
    """Return the histories of all variants from rest, as `validation.diagnosis.stepping.histories` does."""
    equal = len(steps) > 0 and float(np.ptp(steps)) <= UNEQUAL * float(steps[0])
    alone = [j for j, v in enumerate(variants) if equal and _solver_has(v)]
    if not alone:
        return stepping.histories(column, variants, steps)
    parts = {j: _unilateral(column, variants[j], float(steps[0]), len(steps)) for j in alone}
    others = [j for j in range(len(variants)) if j not in parts]
    if others:
        batch = stepping.histories(column, [variants[j] for j in others], steps)
        parts |= {j: _column_of(batch, i) for i, j in enumerate(others)}
    ordered = [parts[j] for j in range(len(variants))]
    displacement, pressure, opened = (np.column_stack(columns) for columns in zip(*ordered, strict=True))
    return Histories(displacement, pressure, opened > 0)


Columns = tuple[Array, Array, Flags]  # displacement, pressure and open flags of one variant


def _column_of(batch: Histories, i: int) -> Columns:
    return batch.displacement[:, i], batch.pressure[:, i], batch.open[:, i]


def _solver_has(v: Variant) -> bool:
    """Whether the suite's solver of opening contact has everything of a variant."""
    plain = Variant(v.alpha, v.delta, v.gg)
    return v.opens and v.gg <= 1 and not v.base and all(getattr(v, n) == getattr(plain, n) for n in WITHOUT_SOLVER)


@lru_cache(maxsize=KEPT)
def _unilateral(column: Rectangle, v: Variant, dt: float, n: int) -> Columns:
    """Return displacement, pressure and open flags of a contact that opens."""
    longer = n + stepping.further_steps([v])
    strain = column.plane_strain != v.other_plane
    hypothesis: Literal["plane strain", "plane stress"] = "plane strain" if strain else "plane stress"
    mu = min(max(column.poisson + v.poisson, -POISSON), POISSON)
    material = dda.Material(column.density * v.density, column.young * v.young, mu, hypothesis)
    softer = float(np.exp(-v.softness))
    contact = dda.Unilateral(
        column.normal / 2 * softer,
        column.shear / 2 * (softer if v.tied else 1.0),
        band=(v.band, v.band * v.reopening),
    )
    model = dda.UnilateralModel(
        dda.Block.rectangle(column.width * v.side, column.height * v.side * v.tall, material),
        contact,
        pressure=column.pressure * v.load,
        gravity=column.gravity * v.gravity + v.weight * GRAVITY,
    )
    scheme = dda.Scheme(v.alpha, v.delta, v.gg, dt / v.parts, v.start)
    run = dda.solve_unilateral(model, scheme, longer * v.parts)
    centroid = run.columns["displacement"]
    point = centroid + v.point * (centroid - run.gap_m)  # h/2 ey is what the base lags behind
    columns = point, run.columns["contact_pressure"], (~run.closed_m).astype(float)
    last = slice(v.parts - 1, None, v.parts)
    displacement, pressure, opened = (_filled(values, longer * v.parts)[last, None] for values in columns)
    return _column_of(stepping.reported(Histories(displacement, pressure, opened > 0), [v], n), 0)


def _filled(values: Array, n: int) -> Array:
    """Return a history that ended early, the rows after its end beyond any bound."""
    return np.concatenate([values, np.full(n - len(values), np.inf)]) if len(values) < n else values.copy()
