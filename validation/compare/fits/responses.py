"""Histories of variants: the suite's own solver where a contact opens, one pass for all the others."""

from __future__ import annotations

from collections.abc import Sequence
from functools import lru_cache
from typing import Literal

import numpy as np

import dda
from dda.one_block import variants as batch
from dda.one_block.variants import GRAVITY, Column, Flags, Histories, Variant
from validation.runs.history import Array

KEPT = 128  # histories of opening contact: a fit asks for the same one many times
UNEQUAL = 1e-9  # relative difference of two time steps
POISSON = 0.499  # a fit may try more


def computed(column: Column, variants: Sequence[Variant], steps: Array) -> Histories:
    """Return the histories of all variants from rest, as `dda.one_block.variants.histories` does."""
    equal = len(steps) > 0 and float(np.ptp(steps)) <= UNEQUAL * float(steps[0])
    alone = [j for j, v in enumerate(variants) if equal and _solver_has(v)]
    if not alone:
        return batch.histories(column, variants, steps)
    parts = {j: _unilateral(column, variants[j], float(steps[0]), len(steps)) for j in alone}
    others = [j for j in range(len(variants)) if j not in parts]
    if others:
        found = batch.histories(column, [variants[j] for j in others], steps)
        parts |= {j: _column_of(found, i) for i, j in enumerate(others)}
    ordered = [parts[j] for j in range(len(variants))]
    return Histories(
        np.column_stack([part[0] for part in ordered]),
        np.column_stack([part[1] for part in ordered]),
        np.column_stack([part[2] for part in ordered]),
        np.column_stack([part[3] for part in ordered]),
    )


Columns = tuple[Array, Array, Flags, Array]  # displacement, pressure, open flags and area of one variant


def _column_of(found: Histories, i: int) -> Columns:
    return found.displacement[:, i], found.pressure[:, i], found.open[:, i], found.area[:, i]


def _solver_has(v: Variant) -> bool:
    """Whether the suite's solver of opening contact has everything of a variant."""
    as_it_is = Variant(v.alpha, v.delta, v.gg)
    own = ("updated", "viscous", "reset", "discounted", "strain_load", "coupling", "kept")
    return v.opens and v.gg <= 1 and not v.base and all(getattr(v, n) == getattr(as_it_is, n) for n in own)


@lru_cache(maxsize=KEPT)
def _unilateral(column: Column, v: Variant, dt: float, n: int) -> Columns:
    """Return displacement, pressure, open flags and area of a contact that opens."""
    longer = n + batch.further_steps([v])
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
        gravity=column.gravity + v.weight * GRAVITY,
    )
    found = dda.solve_unilateral(model, dda.Scheme(v.alpha, v.delta, v.gg, dt, v.start), longer)
    centroid = found.columns["displacement"]
    shown = centroid + v.point * (centroid - found.gap_m)  # h/2 ey is what the base lags behind
    pressure, opened = found.columns["contact_pressure"], (~found.closed_m).astype(float)
    rows = [_filled(values, longer)[:, None] for values in (shown, pressure, opened, np.ones_like(shown))]
    return _column_of(batch.reported(Histories(rows[0], rows[1], rows[2] > 0, rows[3]), [v], n), 0)


def _filled(values: Array, n: int) -> Array:
    """Return a history that ended early, the rows after its end beyond any bound."""
    return np.concatenate([values, np.full(n - len(values), np.inf)]) if len(values) < n else values.copy()
