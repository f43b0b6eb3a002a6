"""The ranking of an answer: every named scheme and every other solver, by what it leaves."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import Any

from validation.diagnosis.causes import compliance
from validation.diagnosis.fits.fit import NAMED, fit, named
from validation.diagnosis.fits.target import Target
from validation.diagnosis.other_solvers import Rival
from validation.diagnosis.variant import Variant


def ranking(
    model: str, target: Target, best_variant: Variant, free: Sequence[str], others: Sequence[Rival]
) -> list[dict[str, Any]]:
    """Return every named scheme with what was found besides, and the other solvers, by misfit."""
    pairs = dict.fromkeys([(best_variant.alpha, best_variant.delta), *NAMED.values()])
    free = tuple(dict.fromkeys(("softness", *(name for name in free if name not in ("alpha", "delta", "gg", "base")))))
    quick = target.quick()
    fits = fit(quick, [(replace(best_variant, alpha=a, delta=d), free) for a, d in pairs])
    best = fit(target, [(best_variant, ())])[0].misfit
    rows = [
        row_of(
            model,
            f.variant.alpha,
            f.variant.delta,
            best_variant.gg,
            min(f.misfit, best) if i == 0 else f.misfit,
            compliance(target, f.variant),
        )
        for i, f in enumerate(fits)
    ]
    rows += [
        row_of(
            r.model, r.alpha, r.delta, r.gg, r.misfit, compliance(target, replace(best_variant, softness=r.softness))
        )
        for r in others
    ]
    return sorted(rows, key=lambda row: row["misfit"])


def row_of(
    model: str, alpha: float | None, delta: float | None, gg: float | None, misfit: float, soft: float | None
) -> dict[str, Any]:
    """Return a line of the ranking; a scheme that grows has no finite misfit worth a number."""
    name = None if alpha is None or delta is None else named(alpha, delta)
    return {
        "model": model,
        "name": name,
        "alpha": alpha,
        "delta": delta,
        "gg": gg,
        "misfit": float(f"{min(misfit, 1e6):.6g}"),
        "compliance": None if soft is None else float(f"{soft:.4g}"),
    }
