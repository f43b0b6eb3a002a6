"""What the chapter of the study `response` draws by itself: amplitude and phase over frequency."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np

from validation.report.blocks import Blocks
from validation.report.chapters.described import Description
from validation.report.chapters.queries import StudyTable
from validation.report.figures.histories import saved
from validation.report.figures.response import ResponseCurve, response_figure

PAGE = Description(__file__)


def curves(table: StudyTable, directory: Path) -> Blocks:
    """Return the figure of the responses that the study keeps."""
    drawn = [_response_curve(table.data["frequency"], curve) for curve in table.data.get("curves", [])]
    if not drawn:
        return []
    return [saved(response_figure(drawn, logarithmic=False), directory, "response.svg", PAGE.text("responses"))]


def _response_curve(frequency: Sequence[float], curve: Mapping[str, Any]) -> ResponseCurve:
    columns = {column: (np.array(size), np.array(phase)) for column, (size, phase) in curve["columns"].items()}
    dashed = curve["exact"] and curve["solver"] == "dda"
    return ResponseCurve(curve["name"], curve["solver"], dashed, np.array(frequency), columns)
