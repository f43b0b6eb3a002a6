"""Error against cost as data of a page: the runs of the study `work-precision`."""

from __future__ import annotations

import math
from collections.abc import Sequence

from validation.gallery.cases import PlainData
from validation.report.chapters.work import refinement
from validation.report.figures.curves import style_of
from validation.runs.records import Manifest
from validation.runs.results import Results
from validation.studies.work.points import COSTS, QUANTITIES, Point, points
from validation.studies.work.study import SCHEMES

REFERENCES = ("continuum", "bar")


def work_plots(results: Results, manifest: Manifest) -> list[PlainData]:
    """Return a plot for each scheme that was refined: the runs of each method, with costs and errors of each run."""
    plots = []
    for scheme in SCHEMES:
        prefix = f"work-{scheme}"
        if {"cases", "comparisons"} <= manifest.keys() and (runs := points(results, manifest, prefix)):
            plots.append({"name": prefix, "title": f"{scheme.capitalize()} acceleration"} | _plot(runs))
    return plots


def _plot(runs: Sequence[Point]) -> PlainData:
    """Return what is varied and the runs; an error that is zero or absent has no place on a logarithmic axis."""
    methods = list(dict.fromkeys(run.method for run in runs))
    return {
        "costs": list(COSTS),
        "quantities": list(QUANTITIES),
        "references": list(REFERENCES),
        "methods": [{"name": name, "color": style_of(name).color} for name in methods],
        "runs": [
            {
                "method": methods.index(run.method),
                "label": refinement(run),
                "costs": [_number(cost(run)) for cost in COSTS.values()],
                "errors": [[_number(run.errors.get((q, r))) for r in REFERENCES] for q in QUANTITIES],
            }
            for run in runs
        ],
    }


def _number(value: float | None) -> float | None:
    """Return a positive number to four digits, else None."""
    return float(f"{value:.4g}") if value is not None and math.isfinite(value) and value > 0 else None
