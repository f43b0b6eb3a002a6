"""The chapter of stiff and extreme data: maps of correct digits, outcomes by name."""

from __future__ import annotations

import itertools
import math
from collections import Counter
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from validation.metrics.growth import Stability
from validation.report.blocks import Blocks, Table, TableColumn, table
from validation.report.chapters.scene import opening
from validation.report.chapters.text import DASH
from validation.report.figures import histories
from validation.report.figures.maps import MapScale, NumberMap, map_figure
from validation.runs.history import Array
from validation.runs.records import Manifest
from validation.runs.results import Results
from validation.runs.row import Row, Value
from validation.runs.run import Outcome

QUANTITIES = {"displacement": "Displacement", "pressure": "Contact pressure"}
SOLVERS = ("dda", "dda-textbook")
MATRIX = "extremes-"  # prefix of the scenes of the maps
SHADES = MapScale("cividis", 16.0, cell=4.6)


@dataclass(frozen=True)
class ExtremeRun:
    """One run of the study beside its sixty-digit reference."""

    scene: str
    solver: str
    ratio: float  # p/E
    step: float  # s
    row: Row
    errors: Mapping[str, Value]


def extreme_runs(results: Results, manifest: Manifest) -> list[ExtremeRun]:
    """Return the runs of the solvers that are judged, with their errors where there are any."""
    rows = results.rows()
    compared = {(c["scene"], c["solver"]): c["metrics"] for c in manifest.get("comparisons", [])}
    runs = []
    for entry in manifest.get("cases", []):
        solver = entry["solver"]
        if solver not in SOLVERS or entry["key"] not in rows:
            continue
        name = entry["scene"]
        definition = entry["definition"]
        metrics = compared.get((name, solver), {})
        errors = {q: metrics.get(f"{q}.max") for q in QUANTITIES}
        ratio = definition["contact"]["stiffness"] / definition["block"]["young"]
        runs.append(ExtremeRun(name, solver, ratio, definition["time"]["step"], rows[entry["key"]], errors))
    return runs


def chapter(results: Results, manifest: Manifest, directory: Path) -> Blocks:
    """Return the chapter of a study of extremes."""
    runs = extreme_runs(results, manifest)
    blocks = [*opening(manifest, lead=conclusion(runs)), outcome_table(runs)]
    matrix = [run for run in runs if run.scene.startswith(MATRIX)]
    for solver in SOLVERS:
        blocks += _maps(manifest["study"], [run for run in matrix if run.solver == solver], directory)
    return blocks


def _errors(runs: Iterable[ExtremeRun]) -> list[float]:
    """Return the errors of runs in both quantities, as far as they are numbers."""
    values = itertools.chain.from_iterable(run.errors.values() for run in runs)
    return [float(value) for value in values if isinstance(value, int | float)]


def digits_of(error: Array) -> Array:
    """Return -log10 of the error, cut to 0 .. 16; NaN stays NaN."""
    with np.errstate(divide="ignore", invalid="ignore"):
        digits: Array = np.clip(-np.log10(np.maximum(error, 1e-16)), 0.0, 16.0) + 0.0
    return digits


def digit_map(title: str, error: Array) -> NumberMap:
    """Return a map of whole correct digits; a cell without a run is empty."""
    values = digits_of(error)
    texts = [[f"{np.floor(value):.0f}" if np.isfinite(value) else "" for value in row] for row in values]
    return NumberMap(title, values, texts)


def digits(error: float) -> int:
    """Return the whole number of correct digits."""
    return int(digits_of(np.array(error)))


def conclusion(runs: Sequence[ExtremeRun]) -> str:
    """Say in one sentence how many digits each solver keeps at least, and how runs beyond their limit end."""
    parts = []
    for solver in SOLVERS:
        errors = _errors(run for run in runs if run.solver == solver)
        if errors:
            parts.append(f"{solver} {digits(max(errors))}")
    text = f"Fewest correct digits, in both quantities: {', '.join(parts)}"
    ends = Counter(run.row.outcome for run in runs if run.solver == "dda")
    grown = ends[Outcome.UNSTABLE] + ends[Outcome.OVERFLOW]
    if grown:
        mispredicted = ends[Outcome.MISPREDICTED]
        share = f"all but {mispredicted} more" if mispredicted else "all"
        text += f"; {grown} runs of dda left their bounds, {share} as predicted"
    return f"{text}."


def outcome_table(runs: Sequence[ExtremeRun]) -> Table:
    """Return how often each outcome was met, by solver."""
    kinds = [str(kind) for kind in Stability]
    rows = []
    for solver in SOLVERS:
        count: Counter[str] = Counter()
        for run in runs:
            if run.solver != solver:
                continue
            kind = run.row.metrics.get("stability.kind")
            has_kind = run.row.outcome in (Outcome.COMPLETED, Outcome.UNSTABLE, Outcome.OVERFLOW) and kind in kinds
            count[str(kind) if has_kind else str(run.row.outcome)] += 1
        others = ", ".join(f"{name} {n}" for name, n in count.items() if name not in kinds)
        rows.append((solver, *(str(count.get(kind, 0)) for kind in kinds), others or DASH))
    notes = tuple(f"{kind}: {kind.sentence}" for kind in Stability)
    return table(("Solver", *kinds, TableColumn("otherwise", "fill")), rows, "Outcomes by name.", notes)


def _maps(study: str, runs: Sequence[ExtremeRun], directory: Path) -> Blocks:
    """Return the two maps of one solver, worst over schemes, starts and discounts."""
    if not _errors(runs):
        return []
    ratios = sorted({run.ratio for run in runs})
    steps = sorted({run.step for run in runs})
    maps = [digit_map(title, _worst(runs, q, ratios, steps)) for q, title in QUANTITIES.items()]
    labels = ("Time step dt [s]", "p / E")
    figure = map_figure([maps], [*map(_decade, ratios)], [*map(_decade, steps)], labels, SHADES)
    solver = runs[0].solver
    caption = f"{solver}: correct digits, the worst of all bounded schemes; blank: no bounded run."
    return [histories.saved(figure, directory, f"{study}-digits-{solver}.svg", caption)]


def _worst(runs: Sequence[ExtremeRun], quantity: str, ratios: Sequence[float], steps: Sequence[float]) -> Array:
    errors = np.full((len(ratios), len(steps)), np.nan)
    for run in runs:
        value = run.errors.get(quantity)
        if isinstance(value, int | float):
            place = ratios.index(run.ratio), steps.index(run.step)
            errors[place] = np.fmax(errors[place], float(value))
    return errors


def _decade(value: float) -> str:
    return f"$10^{{{round(math.log10(value))}}}$"
