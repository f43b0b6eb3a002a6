"""The chapter of the study `response`: amplitude over frequency, and the table of the paper's block."""

from __future__ import annotations

import itertools
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np

from validation.report.blocks import Blocks, Paragraph, Table, table
from validation.report.chapters.data import DerivedRows, derived_rows
from validation.report.chapters.scene import opening
from validation.report.chapters.text import DASH, percent, plain
from validation.report.figures.histories import saved
from validation.report.figures.response import ResponseCurve, response_figure
from validation.runs.records import Manifest
from validation.runs.results import Results
from validation.studies.response.formulas import FREQUENCIES, LOW, row_name

ANSWERS = {  # scene -> title
    "response-exact": "exact in time",
    "response-constant": "dt = 2 ms, (1/2, 1)",
    "response-average": "dt = 2 ms, (1/4, 1/2), gg = 0.98",
}
SOLVERS = ("dda", "fem", "bar")
PARTS = {"displacement": 1e3, "pressure": 1e-6}  # mm, MPa
DIGITS = 6  # that rows are stored with: to round once more would be to round twice
HIDDEN = "response-damping"


def chapter(results: Results, manifest: Manifest, directory: Path) -> Blocks:
    """Return the chapter: what the step takes, the figure, the table."""
    rows = derived_rows(manifest)
    blocks = opening(manifest, results.verdicts(manifest["study"]), lead(rows))
    data = manifest.get("data", {})
    curves = [_response_curve(data["frequency"], curve) for curve in data.get("curves", [])]
    if curves:
        caption = (
            "The paper's block under a pressure of 5 MPa that vibrates: DDA at dt = 2 ms under (1/2, 1), the same "
            "model exact in time, and the continuum. The phase is the lead over the load."
        )
        blocks.append(saved(response_figure(curves, logarithmic=False), directory, "response.svg", caption))
    table = amplitudes(rows)
    if table.rows:
        blocks.append(table)
    sentence = hidden(rows)
    return [*blocks, Paragraph(sentence)] if sentence else blocks


def _response_curve(frequency: Sequence[float], curve: Mapping[str, Any]) -> ResponseCurve:
    columns = {column: (np.array(size), np.array(phase)) for column, (size, phase) in curve["columns"].items()}
    dashed = curve["exact"] and curve["solver"] == "dda"
    return ResponseCurve(curve["name"], curve["solver"], dashed, np.array(frequency), columns)


def lead(rows: DerivedRows) -> str:
    """Say what the step takes next to the first frequency."""
    scenes = ("response-exact", "response-constant")
    exact, stepped = (rows.get((scene, row_name("dda", 52.0)), {}).get("displacement") for scene in scenes)
    if not (isinstance(exact, float) and isinstance(stepped, float)):
        return ""
    return (
        f"Near its first frequency, at 52 Hz, the block responds with {1e3 * stepped:.1f} mm instead of "
        f"{1e3 * exact:.1f} mm: at dt = 2 ms the step has removed {percent(1 - stepped / exact)} of the resonance."
    )


def amplitudes(rows: DerivedRows) -> Table:
    """Return the amplitudes of each answer, frequency and solver."""
    lines = []
    for scene, frequency in itertools.product(ANSWERS, FREQUENCIES):
        cells = []
        for part, factor in PARTS.items():
            values = [rows.get((scene, row_name(solver, frequency)), {}).get(part) for solver in SOLVERS]
            cells += [plain(factor * value, DIGITS) if isinstance(value, float) else DASH for value in values]
        if set(cells) != {DASH}:
            lines.append((ANSWERS[scene], f"{frequency:g}", *cells))
    caption = "Amplitudes under the pressure; fem: eight linear elements, whose error against the bar is known"
    return table(
        ("Answer", "f [Hz]", ("Displacement [mm]", *SOLVERS), ("Contact pressure [MPa]", *SOLVERS)), lines, caption
    )


def hidden(rows: DerivedRows) -> str:
    """Say the damping that the step hides, as measured on the steps."""
    parts = []
    for frequency in LOW:
        ratio = rows.get((HIDDEN, row_name("dda", frequency)), {}).get("damping.steps")
        if isinstance(ratio, float):
            parts.append(f"{percent(ratio)} at {frequency:g} Hz")
    if not parts:
        return ""
    return (
        f"At dt = 0.01 s the usual scheme has the steady ratios |Im W|/|W| = sin(ω dt/4) of {', '.join(parts)}, "
        "measured on stepped histories of a base that vibrates. The damping ratio of a free vibration is within 1.4 % "
        "of it while ω dt is below 0.3, and smaller above: 25.5 % at 20 Hz."
    )
