"""The answer of `compare` in words."""

from __future__ import annotations

import itertools
from collections.abc import Mapping, Sequence
from typing import Any

from validation.diagnosis.fits.fit import Interval, named
from validation.diagnosis.schemes import EXPLICIT, FAMILIES, split_of
from validation.diagnosis.variant import Variant
from validation.runs.numbers import ROUNDING

EXACT = "exact in time"


def scheme_words(alpha: float, delta: float, gg: float) -> str:
    """Return a scheme by name and numbers."""
    numbers = f"alpha = {alpha:.4g}, delta = {delta:.4g}, gg = {gg:.5g}"
    name = named(alpha, delta)
    return f"{name} ({numbers})" if name else f"an unnamed scheme ({numbers})"


def scheme_of(v: Variant) -> str:
    """Return the scheme of a variant by name and numbers."""
    if v.exact:
        return EXACT
    if v.family == "newmark":
        return scheme_words(v.alpha, v.delta, v.gg)
    if v.contact == "impact":
        return f"Moreau and Jean's scheme (theta = {v.spectral:.4g}, gg = {v.gg:.5g})"
    name = FAMILIES[v.family]
    if v.family in EXPLICIT:
        return f"{name} (gg = {v.gg:.5g})"
    numbers = {"hht": f"alpha_f = {v.spectral:.4g}", "theta": f"theta = {v.spectral:.4g}"}
    number = numbers.get(v.family, f"rho_inf = {v.spectral:.4g}")
    if v.family == "composite":
        return f"{name} (split {split_of(v):.4g}, {number}, gg = {v.gg:.5g})"
    return f"{name} ({number}, gg = {v.gg:.5g}, initial acceleration {v.start})"


def span(steps: Sequence[int]) -> str:
    """Return steps as runs, ``1-5, 84-100``."""
    numbered = itertools.groupby(enumerate(steps), lambda one: one[1] - one[0])
    runs = [[step for _, step in run] for _, run in numbered]
    return ", ".join(f"{run[0]}-{run[-1]}" if len(run) > 1 else str(run[0]) for run in runs)


def told_lines(determined: Mapping[str, Interval], untold: Sequence[Mapping[str, float]]) -> list[str]:
    """Return the fitted numbers with their intervals, and the directions that the history does not determine."""
    lines = [f"fitted {name} = {_fitted(interval)} (95 %)" for name, interval in determined.items()]
    return lines + [
        "not determined by the data: " + ", ".join(f"{part:+.2f} {name}" for name, part in direction.items())
        for direction in untold
    ]


def _fitted(interval: Interval) -> str:
    value = interval.value if abs(interval.value) > ROUNDING else 0.0
    width = f"+- {interval.half_width:.2g}" if interval.half_width > ROUNDING else f"+- less than {ROUNDING:g}"
    return f"{value:.7g} {width}"


def listed(parts: Sequence[str]) -> str:
    """Return parts as a list, ``a, b and c``."""
    return " and ".join([", ".join(parts[:-1]), parts[-1]] if len(parts) > 1 else parts)


def family(one: Mapping[str, Any]) -> str:
    """Return causes with their numbers, ``density-factor 0.5 and gg 0.98``."""
    return listed([name + (f" {one['values'][name]:.5g}" if name in one["values"] else "") for name in one["causes"]])
