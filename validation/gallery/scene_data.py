"""The data of a scene's page: histories, outcomes and numbers of its cases."""

from __future__ import annotations

import itertools
import math
from collections.abc import Sequence

import numpy as np

from validation.gallery.cases import GalleryScene, PlainData, readable
from validation.gallery.histories import lines_of
from validation.metrics.catalogue import CATALOGUE, is_count
from validation.report.chapters.data import CaseResults
from validation.report.chapters.text import bounded, cell
from validation.report.figures.curves import COLUMNS, axis_of, is_sparse, style_of
from validation.runs.history import History
from validation.runs.results import WITH_HISTORY, Results
from validation.runs.row import Value
from validation.runs.run import Outcome

MOST_LINES = 3000  # curves of a whole gallery
FEWEST = 4  # cases of a scene that are drawn, however many lines there are
METRICS = (
    "displacement.static",
    "displacement.peak",
    "displacement.settling_step",
    "pressure.peak",
    "pressure.minimum",
    "pressure.settling_step",
    "mode1.frequency",
    "mode1.damping",
    "mode1.measured_damping",
    "mode1.spectral_radius",
    "switches.count",
    "switches.first_opening",
    "contact.gap",
    "contact.penetration",
    "contact.peak_force",
    "contact.restitution",
    "energy.rise",
)


def lines(case: CaseResults) -> int:
    """Return how many curves a case may have, as its rows tell without its histories."""
    return sum(row.outcome in WITH_HISTORY for row in case.rows.values()) * len(case.scene.run.columns)


def drawn(scene: GalleryScene, most: int) -> list[CaseResults]:
    """Return the cases whose curves are drawn: all, or evenly chosen ones, the first and the last among them.

    `most` is the number of curves of a scene; at least `FEWEST` cases are drawn all the same.
    """
    with_lines = [case for case in scene.cases if lines(case)]
    return [with_lines[i] for i in _chosen([lines(case) for case in with_lines], most)]


def _chosen(counts: Sequence[int], most: int) -> list[int]:
    """Return which of the cases are drawn, by the number of curves of each."""
    count = max(FEWEST, most // max(counts, default=1))
    if len(counts) <= count:
        return [*range(len(counts))]
    places: list[int] = np.unique(np.linspace(0, len(counts) - 1, count).round().astype(int)).tolist()
    return places


def most_lines(scenes: Sequence[GalleryScene]) -> int:
    """Return how many curves each scene may have, so that there are `MOST_LINES` in all."""
    counts = []
    for scene in scenes:
        counts.append([count for case in scene.cases if (count := lines(case))])
    most = max(map(sum, counts), default=1)
    while most > 1 and sum(sum(each[i] for i in _chosen(each, most)) for each in counts) > MOST_LINES:
        most = int(0.95 * most)
    return most


def all_lines(scenes: Sequence[GalleryScene], most: int) -> int:
    """Return the number of curves of all scenes with at most so many of each."""
    return sum(sum(map(lines, drawn(scene, most))) for scene in scenes)


def data(results: Results, scene: GalleryScene, most: int, samples: int) -> PlainData:
    """Return the histories, outcomes and numbers of a scene's page, as plain data."""
    drawn_cases = drawn(scene, most)
    cases = [_case(results, case, samples) for case in drawn_cases]
    names = list(dict.fromkeys(itertools.chain.from_iterable(case["columns"] for case in cases)))
    rigid = scene.cases[0].scene.rigid
    ordered = sorted(names, key=[*(COLUMNS if rigid is None else rigid.columns), *names].index)
    solvers = dict.fromkeys(itertools.chain.from_iterable(case.rows for case in scene.cases))
    metrics = _metrics(drawn_cases)
    return {
        "columns": {name: list(axis_of(name, rigid is not None)) for name in ordered},
        "solvers": {readable(name): _style(name) for name in solvers},
        "cases": cases,
        "metrics": [[name, CATALOGUE[name].unit, CATALOGUE[name].says] for name in metrics],
        "numbers": [_numbers(case, metrics) for case in drawn_cases],
    }


def _case(results: Results, case: CaseResults, samples: int) -> PlainData:
    """Return label, curves and what went otherwise than hoped for."""
    histories: dict[str, History] = {}
    messages = []
    for solver, row in case.rows.items():
        history = results.history(row.key)
        if history is not None and len(history.time):
            histories[readable(solver)] = history
        if row.outcome is not Outcome.COMPLETED:
            notes = readable("; ".join(row.notes))
            messages.append(f"{readable(solver)}: {row.outcome}. {row.outcome.sentence} {notes}".strip())
    static = next(iter(case.rows.values())).metrics.get("displacement.static") if case.rows else None
    limit = 6 * abs(static) if isinstance(static, float) and math.isfinite(static) and static else None
    dots: dict[str, list[str]] = {}
    for name, history in histories.items():
        for column, values in history.columns.items():
            if is_sparse(name, history.time, values):
                dots.setdefault(column, []).append(name)
    page_data = {"label": readable(case.label), "limit": limit, "told": messages, "dots": dots}
    return page_data | lines_of(histories, samples)


def _style(name: str) -> PlainData:
    style = style_of(name)
    return {"color": style.color, "dash": [round(2 * length, 1) for length in style.dash], "width": style.width}


def _metrics(cases: Sequence[CaseResults]) -> list[str]:
    """Return the metrics of which some row has a number."""
    measured: set[str] = set()
    for case in cases:
        for row in case.rows.values():
            measured.update(name for name in METRICS if isinstance(row.metrics.get(name), int | float))
    return [name for name in METRICS if name in measured and name in CATALOGUE]


def _numbers(case: CaseResults, metrics: Sequence[str]) -> list[list[str]]:
    """Return solver, values of the metrics and steps of each row."""
    return [
        [readable(solver), *(_text(name, row.metrics.get(name)) for name in metrics), str(row.work.get("steps", "–"))]
        for solver, row in case.rows.items()
    ]


def _text(metric: str, value: Value) -> str:
    """Return a value as a page writes it: counts whole, a ratio at the level of rounding as a bound."""
    if is_count(metric) and isinstance(value, float) and value.is_integer():
        return str(int(value))
    text = cell(value)
    return bounded(value, text) if isinstance(value, float) and value and CATALOGUE[metric].unit == "1" else text
