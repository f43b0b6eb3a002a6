"""What `run cost --scene` prints: the cheapest ways for a user's block."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from validation.report.blocks import Blocks, Paragraph, TableColumn, table
from validation.runs.numbers import DASH, short
from validation.runs.records import Manifest
from validation.studies.cost.measures import ANY, ELEMENTS, OWN, REFERENCE

WHO = {ANY: "any", OWN: "dda", ELEMENTS: "fem"}
COLUMNS = ("", "error", "by", "the cheapest way")
NUMBERS = ("dt [ms]", "run [ms]", "set-up [ms]", "work")


def answer(manifest: Manifest) -> Blocks:
    """Return the cheapest ways to each accuracy, and what the errors are measured in."""
    rows = []
    measured = ""
    for derived in manifest["derived"]:
        metrics: Mapping[str, Any] = derived["metrics"]
        if derived["name"] == REFERENCE and metrics:
            measured = (
                f"Relative L2 error over {1e3 * metrics['window']:.3g} ms, of means of means over "
                f"{1e3 * metrics['mean']:.3g} ms, against: {metrics['label']}{_uncertainty(metrics)}. Work, in lines "
                "of Python, ranks; ms are the least of some repeats, by the processor."
            )
        if "who" in metrics:
            numbers = []
            for name, factor in (("step", 1e3), ("seconds", 1e3), ("setup", 1e3), ("work", 1.0)):
                numbers.append(short(factor * metrics[name], 3) if name in metrics else DASH)
            rows.append([metrics["quantity"], metrics["accuracy"], WHO[metrics["who"]], metrics["way"], *numbers])
    return [table([*COLUMNS, *(TableColumn(title, "decimal") for title in NUMBERS)], rows), Paragraph(measured)]


def _uncertainty(metrics: Mapping[str, Any]) -> str:
    """Say how far a reference that is not exact may be off."""
    values = []
    for key, value in metrics.items():
        if key.startswith("uncertainty."):
            values.append(f"{100 * value:.2g} % in {key.removeprefix('uncertainty.')}")
    return f", uncertain by {' and '.join(values)}" if values else ""
