"""The chapter of the study `methods`: its answers and tables rest on the derived rows."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import pytest
from matplotlib.figure import Figure

from validation.report.blocks import Callout, FigureBlock, Heading, Table
from validation.report.chapters.registry import chapter_of
from validation.runs.results import Results
from validation.studies.methods import chapter
from validation.studies.methods.methods import METHODS

RIGID = {"mean": 1.614, "least": 0.341, "most": 2.887, "mean_square": 3.147}


@pytest.fixture
def manifest() -> dict[str, Any]:
    """Return a manifest of a few derived rows and curves of two points."""
    rebounds = {"ch-0.8": 2.887, "hht-0.1": 2.672, "bathe-half": 1.9985, "ch-0": 0.99975}
    rows = [
        {"scene": f"methods-impact-{name}", "name": "rebound on a rigid contact", "metrics": RIGID | {"most": most}}
        for name, most in rebounds.items()
    ]
    ratios = {"average": 0.0902, "bathe-half": 1.818, "tr-bdf2": 1.772, "bathe-0.5": 1.295}
    rows.append({"scene": "methods-cost", "name": "displacement error", "metrics": ratios})
    rows.append(
        {
            "scene": "methods-cost",
            "name": "order",
            "metrics": {"constant over ch-0": 16.0, "constant over conserving": 32.0},
        }
    )
    stop = {"order": 0.04, "order of the peak": -1.23, "finest error": 0.0571, "finest peak": 2.251e9}
    rows.append({"scene": "methods-rigid-displacements", "name": "approach", "metrics": stop})
    for step, error in (("0.001,time.steps=60", 0.083), ("0.0002,time.steps=300", 0.004545)):
        scene = f"methods-column-average[time.step={step}]"
        rows.append({"scene": scene, "name": "column error", "metrics": {"l2": error}})
    sliding = {"scene": "methods-sliding-average[time.step=0.01]", "name": "distance", "metrics": {"error": -0.00608}}
    curve = {"damping": [0.01, 0.3], "mean": [0.9, 1.5], "least": [0.8, 0.5], "most": [1.0, 2.5]}
    data = {
        "omega": {"damping": [0.03, 100.0], "impact": [0.3, 300.0]},
        "methods": dict.fromkeys(chapter.LOOKS, curve),
        "labels": {one.id: one.label for one in METHODS},
    }
    return {
        "study": "methods",
        "title": "Methods",
        "purpose": "",
        "cases": [],
        "derived": [*rows, sliding],
        "data": data,
    }


def test_the_answers_stand_on_what_was_run(manifest: dict[str, Any], tmp_path: Path, drawn: dict[str, Figure]) -> None:
    blocks = chapter.chapter(Results(tmp_path), manifest, tmp_path)  # type: ignore[arg-type]
    locked, opens, never = (block.text for block in blocks if isinstance(block, Callout))
    assert "has 1.29 to 1.82 times the error" in locked
    assert "16 and 32 times fewer solves" in opens
    assert "2.89 (CH 0.8), 2.67 (HHT −0.1), 2.00 (Bathe 1/2)" in never and "at most 1.00 under CH 0" in never
    headings = [block.text for block in blocks if isinstance(block, Heading)]
    assert headings[1:] == ["Locked contact", "Contact that opens", "Rigid stops, columns, sliding"]
    files = [block.file for block in blocks if isinstance(block, FigureBlock)]
    assert files == [*drawn] == ["methods-damping.svg", "methods-restitution.svg"]
    panels = drawn["methods-restitution.svg"].axes
    assert [axes.get_title("left") for axes in panels] == ["(1/2, 1)", "CH 0", "CH 0.8", "HHT −0.1", "Bathe 1/2"]
    *_, stops, others = (block for block in blocks if isinstance(block, Table))
    assert stops.rows == (("rigid stop in displacements, (1/2, 1)", "0.04", "−1.23", "5.71", "2251"),)
    assert others.rows == (("(1/4, 1/2)", "8.30", "0.455", "−0.608"),)


def test_the_study_has_its_chapter() -> None:
    assert chapter_of("methods") is chapter.chapter
