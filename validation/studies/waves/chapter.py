"""The chapter of waves: what of a wave arrives, what joints and bases do to it, and a site under a record."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np

from validation.report.blocks import Blocks, Heading, Paragraph, Table
from validation.report.chapters.data import (
    CaseGroups,
    CaseResults,
    DerivedRows,
    Groups,
    cases_of,
    derived_rows,
    groups_by_name,
    verdicts_of,
)
from validation.report.chapters.described import Description
from validation.report.chapters.scene import opening
from validation.report.chapters.text import DASH, capital, percent
from validation.report.figures.charts import ChartLine, ChartPanel
from validation.report.figures.curves import engineering
from validation.runs.history import DISPLACEMENT, PRESSURE, Array
from validation.runs.records import Manifest
from validation.runs.results import Results
from validation.scenes.scene import Scene
from validation.studies.waves.rows import COUNTS, row_name

PAGE = Description(__file__)
SCHEMES = {1.0: "(1/2, 1)", 0.5: "(1/4, 1/2)"}  # by delta
COLORS = {"(1/2, 1)": "#d55e00", "(1/4, 1/2)": "#0072b2"}
DASHES = {0.1: (1.0, 1.2), 0.25: (2.5, 1.2), 0.5: (5.0, 1.5)}  # by c dt/h


@dataclass(frozen=True)
class TravelledWaves:
    """Waves of one scheme and one c dt/h: closed form, or what was measured."""

    scheme: str  # "(1/2, 1)" or "(1/4, 1/2)"
    courant: float  # c dt/h [-]
    blocks: Array  # a wavelength [-]
    speed: Array  # error of the phase speed [-]
    amplitude: Array  # after ten wavelengths, over that at the start [-]


def chapter(results: Results, manifest: Manifest, directory: Path) -> Blocks:
    """Return the chapter: waves in blocks, joints and base, the site."""
    groups = groups_by_name(results, manifest)
    rows = derived_rows(manifest)
    measured = travels(groups, rows)
    blocks = opening(manifest, verdicts_of(groups.values()), lead(measured))
    if measured:
        curves = [_curve(data) for data in manifest.get("data", {}).get("curves", [])]
        blocks.append(PAGE.figure("travel", travel_panels(curves, measured), directory))
    tables = (_others(groups, rows), _joints(groups, rows), _base(groups, rows))
    blocks += [table for table in tables if table.rows]
    return [*blocks, *_site(groups, directory)]


def _curve(data: Mapping[str, Any]) -> TravelledWaves:
    parts = (np.array(data[part]) for part in ("blocks", "speed", "left"))
    return TravelledWaves(data["scheme"], data["courant"], *parts)


# ---- waves in blocks ------------------------------------------------------------------------------------------------


def _courant(scene: Scene) -> float:
    """Return c dt/h of the lowest layer's continuum."""
    if scene.column is None:
        return 0.0
    layer = scene.column.layer[0]
    speed = math.sqrt(scene.column.modulus(layer) / layer.density)
    return round(speed * scene.time.step * layer.blocks / layer.thickness, 6)


def _scheme(case: CaseResults) -> str:
    return SCHEMES.get(case.scene.time.delta, DASH)


def _waves(case: CaseResults, rows: DerivedRows, metric: str) -> list[tuple[int, Mapping[str, Any]]]:
    """Return blocks a wavelength and metrics of the waves of a case that DDA carried."""
    waves = []
    for blocks in COUNTS:
        metrics = rows.get((case.name, row_name("dda", blocks)), {})
        if isinstance(metrics.get(metric), float):
            waves.append((blocks, metrics))
    return waves


def travels(groups: Groups, rows: DerivedRows) -> list[TravelledWaves]:
    """Return the waves measured in welded blocks, by case."""
    measured = []
    for case in cases_of(groups, "waves-blocks"):
        waves = _waves(case, rows, "wave.left")
        if waves and case.scene.time.delta in SCHEMES:
            parts = (np.array([wave[f"wave.{part}"] for _, wave in waves]) for part in ("speed_error", "left"))
            blocks = np.array([float(count) for count, _ in waves])
            measured.append(TravelledWaves(SCHEMES[case.scene.time.delta], _courant(case.scene), blocks, *parts))
    return measured


def lead(measured: Sequence[TravelledWaves]) -> str:
    """Say what ten blocks a wavelength give, in one sentence."""
    for travel in measured:
        at = np.flatnonzero(travel.blocks == 10)
        if travel.scheme == "(1/2, 1)" and travel.courant == 0.5 and at.size:
            speed_error = percent(travel.speed[at[0]])
            amplitude = percent(travel.amplitude[at[0]])
            return PAGE.text("lead", speed_error=speed_error, amplitude=amplitude)
    return ""


def travel_panels(curves: Sequence[TravelledWaves], measured: Sequence[TravelledWaves]) -> list[ChartPanel]:
    """Return the error of the speed and what is left, closed forms as lines and measured waves as dots."""
    speeds = []
    amplitudes = []
    for waves in curves:
        look = (COLORS[waves.scheme], DASHES.get(waves.courant, ()), 0.9)
        name = f"{waves.scheme}, c dt/h = {waves.courant:g}"
        if waves.scheme == "(1/4, 1/2)":  # which loses nothing, whatever the step
            name = "(1/4, 1/2), every dt"
        speeds.append(ChartLine("", waves.blocks, 100 * waves.speed, *look))
        amplitudes.append(ChartLine(name, waves.blocks, waves.amplitude, *look))
    for waves in measured:
        dots: dict[str, Any] = {"color": COLORS[waves.scheme], "width": 0, "dots": 2.6}
        speeds.append(ChartLine("", waves.blocks, 100 * waves.speed, **dots))
        amplitudes.append(ChartLine("", waves.blocks, waves.amplitude, **dots))
    return [PAGE.panel("speed", speeds), PAGE.panel("amplitude", amplitudes)]


def _others(groups: Groups, rows: DerivedRows) -> Table:
    """Return the waves in glued blocks, under kinetic damping, and in shear."""
    lines = []
    for case in cases_of(groups, "waves-glue", "waves-discount", "waves-shear"):
        column = case.scene.column
        if column is None:
            continue
        layer = column.layer[0]
        time = case.scene.time
        own: dict[str, Any] = {
            "glue": column.glue and column.glue * layer.thickness / layer.blocks / column.modulus(layer),
            "scheme": f"{time.alpha:g}, {time.delta:g}, {time.discount:g}",
            "courant": f"{_courant(case.scene):.3g}",
        }
        for count, wave in _waves(case, rows, "wave.left"):
            lines.append(PAGE.cells("others", case, {**own, "blocks": count, **wave}))
    return PAGE.table("others", lines)


# ---- joints and base ------------------------------------------------------------------------------------------------


def _joints(groups: Groups, rows: DerivedRows) -> Table:
    """Return what a joint of kj = rho c w lets through."""
    lines = []
    for case in cases_of(groups, *(name for name in groups if name.startswith("waves-joint"))):
        own: dict[str, Any] = {"scheme": _scheme, "courant": f"{_courant(case.scene):g}"}
        for count, wave in _waves(case, rows, "joint.transmitted"):
            lines.append(PAGE.cells("joints", case, {**own, "blocks": count, **wave}))
    return PAGE.table("joints", lines)


def _base(groups: Groups, rows: DerivedRows) -> Table:
    """Return what a transmitting base of the column's own impedance sends back."""
    lines = []
    counts: list[int] = []
    for case in cases_of(groups, "waves-base"):
        waves = _waves(case, rows, "base.reflected")
        counts = [count for count, _ in waves]
        reflected = (f"{100 * wave['base.reflected']:.3f}" for _, wave in waves)
        lines.append((_scheme(case), f"{_courant(case.scene):g}", *reflected))
    heads = ("α, δ", "c dt/h", ("|R| [%] by blocks a wavelength", *map(str, counts)))
    return PAGE.table("base", lines, heads)


# ---- the site -------------------------------------------------------------------------------------------------------


def _site(groups: Groups, directory: Path) -> Blocks:
    """Return the page of the layered site: surface and base under two schemes and exactly."""
    groups_of_site = [groups[name] for name in ("waves-site", "waves-site-usual") if name in groups]
    traces: dict[str, list[ChartLine]] = {DISPLACEMENT: [], PRESSURE: []}
    for group in groups_of_site:
        case = group.cases[0]
        name = f"dda, dt = {case.scene.time.step:g} s,\n{SCHEMES.get(case.scene.time.delta, '')}"
        lines = [("dda", name, COLORS[SCHEMES[case.scene.time.delta]], 0.6)]
        if not traces[DISPLACEMENT]:  # once, below the others
            lines.insert(0, ("layers", "exact layers", "#999999", 1.6))
        for solver, label, color, width in lines:
            history = case.histories.get(solver)
            for column, traces_of_column in traces.items():
                if history is not None and column in history.columns:
                    values = history.columns[column]
                    traces_of_column.append(ChartLine(label, history.time, values, color, width=width))
    if not all(traces.values()):
        return []
    panels = [
        site_panel("Surface displacement", "m", traces[DISPLACEMENT], ""),
        site_panel("Shear stress on the base", "Pa", traces[PRESSURE], "Time [s]"),
    ]
    return [
        Heading("A site under a record", 2),
        Paragraph(_site_sentence(groups_of_site)),
        PAGE.figure("site", panels, directory),
    ]


def site_panel(title: str, unit: str, traces: Sequence[ChartLine], x_label: str) -> ChartPanel:
    """Return traces [m or Pa] as a panel in a unit that suits them, each with its largest value."""
    largest = [float(np.abs(trace.y).max()) for trace in traces]
    factor, unit = engineering(max(largest), unit)
    lines = []
    for trace, value in zip(traces, largest, strict=True):
        lines.append(replace(trace, y=factor * trace.y, note=f"{factor * value:.3g} {unit} at most"))
    return ChartPanel(f"{title} [{unit}]", x_label, "", lines, (0.0, float(traces[0].x[-1])), names="beside")


def _site_sentence(site: CaseGroups) -> str:
    """Say how far DDA is from the exact layers, case by case."""
    parts = []
    for group in site:
        case = group.cases[0]
        surface = group.number_of_pair(case, "dda", "layers", "displacement.l2")
        base = group.number_of_pair(case, "dda", "layers", "pressure.l2")
        if surface is not None and base is not None:
            scheme = f"dt = {case.scene.time.step:g} s and {SCHEMES.get(case.scene.time.delta, '')}"
            parts.append(
                f"with {scheme} DDA is {percent(surface)} off at the surface and {percent(base)} off on the base"
            )
    text = f"{'; '.join(parts)} (relative L2 against the exact layers)."
    return capital(text) if parts else ""
