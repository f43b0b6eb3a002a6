"""Where a history leaves what the scene expects, and in what manner."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Literal

import numpy as np

from validation.diagnosis.causes import all_benign
from validation.diagnosis.fits.fit import Fit
from validation.diagnosis.fits.target import Target
from validation.diagnosis.stepping import histories
from validation.diagnosis.variant import Variant
from validation.runs.history import Array

Kind = Literal["phase", "amplitude", "damping", "offset"]
SEEN = 1e-3  # of the largest displacement: a smaller difference is no departure
NOISE = 4.0  # standard deviations


@dataclass(frozen=True)
class Departure:
    """The first step at which a history leaves the expected one, and how it does."""

    step: int  # counted from 1
    kind: Kind


def expected(target: Target, explanation: Fit, scene: Variant, causes: Sequence[str]) -> tuple[Array, Array]:
    """Return displacement [m] and pressure [Pa] of the scene's own scheme with what a program may add without fault.

    Weight, moving geometry and a slightly compliant base are taken over from the fit.
    """
    v = explanation.variant
    yields = "base-compliance" in causes
    softness, base = (v.softness, v.base) if yields else (0.0, 0.0)
    plain = replace(scene, softness=softness, base=base, weight=v.weight, updated=v.updated)
    run = histories(target.column, [plain], target.steps)
    return run.displacement[:, 0], run.pressure[:, 0]


def departure(
    target: Target, expected_columns: tuple[Array, Array], causes: Sequence[str], open_steps: Sequence[int]
) -> Departure | None:
    """Return where the history departs; None if there is no cause but benign ones.

    The column that leaves first dates it; one that never leaves by more than digits and noise dates nothing. A contact
    that opens is a departure from its first open step on, even before the displacement shows it.
    """
    if all_benign(causes):
        return None
    if {"sign", "unit"} & set(causes):
        return Departure(int(target.rows[0]) + 1, "amplitude")
    recorded = [target.displacement] if target.pressure is None else [target.displacement, target.pressure]
    columns = list(zip(recorded, expected_columns, target.bars, strict=False))
    departing = [c for c in columns if not c[2].holds(c[0] - c[1][target.rows])]
    dated = [
        measured(expected_values[target.rows], values, target.rows, bar.spread)
        for values, expected_values, bar in departing or columns[:1]
    ]
    first = replace(dated[0], step=min(one.step for one in dated))
    if open_steps and set(causes) & {"contact-opened"} and first.step > open_steps[0]:
        return Departure(open_steps[0], first.kind)
    return first


def unbounded(expected_values: Array, recorded: Array, rows: np.ndarray) -> Departure:
    """Return the first step at which a history without bounds has left the expected one."""
    away = np.abs(recorded - expected_values) > SEEN * float(np.max(np.abs(expected_values)))
    return Departure(int(rows[int(np.argmax(away))]) + 1, "amplitude")


def measured(expected_values: Array, recorded: Array, rows: np.ndarray, noise: float) -> Departure:
    """Return the first step beyond tolerance and the manner that explains most of the difference.

    The manners are the derivatives of the expected history r about its last value s: a factor on s (offset), a
    factor on r - s (amplitude), a stretch of time (phase), a further decay (damping).
    """
    with np.errstate(all="ignore"):
        expected_values = np.nan_to_num(expected_values, posinf=1e300, neginf=-1e300)
        size = float(np.max(np.abs(recorded))) or 1.0
        r = np.clip(expected_values, -1e3 * size, 1e3 * size)
    d = recorded - r
    tolerance = max(SEEN * size, NOISE * noise)
    beyond = np.flatnonzero(np.abs(d) > tolerance)
    first = int(beyond[0]) if beyond.size else int(np.argmax(np.abs(d)))
    t = (rows + 1) / (rows[-1] + 1)
    static = float(np.mean(r[-max(2, len(r) // 10) :]))
    swing = r - static
    rate = np.gradient(r, t)
    manners: list[tuple[Kind, Array]] = [
        ("offset", np.full_like(r, static)),
        ("amplitude", swing),
        ("damping", t * swing),
        ("phase", t * rate),
        ("phase", rate),
    ]
    shares = [(float(d @ basis) ** 2 / (float(basis @ basis) or 1.0), kind) for kind, basis in manners]
    return Departure(int(rows[first]) + 1, max(shares)[1])
