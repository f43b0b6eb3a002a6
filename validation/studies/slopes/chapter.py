"""The chapter of the study `slopes`: displacement of a sliding block beside its closed form, and under a discount."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

import numpy as np

from validation.report.blocks import Blocks, FigureBlock, Heading, Paragraph, Table
from validation.report.chapters.data import CaseGroup, CaseResults, cases_of, groups_by_name, verdicts_of
from validation.report.chapters.described import Description
from validation.report.chapters.scene import opening
from validation.report.figures.charts import DOTS, ChartLine
from validation.runs.records import Manifest, VerdictRecord
from validation.runs.results import Results
from validation.runs.row import Value
from validation.studies.slopes import formulas as study
from validation.theory import friction

DDA = "dda"
ALONG = "horizontal_displacement"
ORANGE = "#d55e00"
GREY = "#666666"
BRAKED_COLORS = ("#0072b2", "#009e73", "#cc79a7", GREY)
RATES = np.geomspace(0.1, 100.0, 61)  # 1/s
PAGE = Description(__file__)


def chapter(results: Results, manifest: Manifest, directory: Path) -> Blocks:
    """Return the chapter: figure, run-outs, thresholds."""
    groups = groups_by_name(results, manifest)
    blocks = [*opening(manifest, verdicts_of(groups.values())), Paragraph(PAGE.text("explanation"))]
    if groups.get(study.SLIDING) and groups.get(study.DRAG):
        blocks.append(trajectories(groups[study.SLIDING], groups[study.DRAG], directory))
    slides = cases_of(groups, study.SLIDING, study.AVERAGE, study.DRAG)
    if slides:
        blocks += [Heading("Run-out", 2), run_outs(slides)]
    starts = cases_of(groups, study.THRESHOLD, study.MANUAL)
    if starts:
        blocks += thresholds(starts)
    shaken: list[ShakenCase] = []
    for name in (study.SHAKEN, study.QUAKE):
        shaken += judged(groups[name]) if name in groups else []
    return [*blocks, *shaking(shaken)]


def trajectories(free: CaseGroup, braked: CaseGroup, directory: Path) -> FigureBlock:
    """Return the figure of displacements over time, and of the share that is left under a drag."""
    traces = []
    for case, color in zip((*free.cases[-1:], *braked.cases), (ORANGE, *BRAKED_COLORS), strict=False):
        history = case.histories.get(DDA)
        if history is None:
            continue
        gg = case.scene.time.discount
        words = f"gg = {gg:g}, dt = {1e3 * case.scene.time.step:g} ms"
        displacement, _ = friction.free_motion(case.scene, friction.sliding_acceleration(case.scene))
        traces.append(ChartLine(words, history.time, history.columns[ALONG], color))
        traces.append(ChartLine("", history.time, displacement, "black", dash=(2.0, 2.0)))
    curve = ChartLine("drag c", RATES, np.array([drag_share(rate) for rate in RATES]), GREY)
    measured = [point for case in braked.cases if (point := share(case)) is not None]
    rates, shares = np.array(measured).reshape(-1, 2).T
    points = ChartLine("dda", rates, shares, ORANGE, width=0, dots=DOTS, hollow=True)
    panels = (PAGE.panel("distance", traces), PAGE.panel("share", (curve, points)))
    return PAGE.figure("trajectories", panels, directory)


def drag_share(rate: float, time: float = 1.0) -> float:
    """Return the displacement under a drag over that without, 2 (c t - 1 + exp(-c t)) / (c t)^2 [-]."""
    x = rate * time
    return 2 * (x + float(np.expm1(-x))) / x**2


def share(case: CaseResults) -> tuple[float, float] | None:
    """Return the drag's rate, and the displacement of a run over that without drag."""
    displacement = case.number(DDA, "horizontal.final")
    undamped = friction.run_out(case.scene, case.scene.time.duration)
    return None if displacement is None else (friction.drag_rate(case.scene), displacement / undamped)


def run_outs(cases: Sequence[CaseResults]) -> Table:
    """Return the displacements of all runs beside the closed form."""
    own = {"drag": lambda case: friction.drag_rate(case.scene) + 0.0, "free": free_slide, "ahead": ahead}
    return PAGE.table("run-outs", [PAGE.cells("run-outs", case, own) for case in cases])


def free_slide(case: CaseResults) -> float:
    """Return the displacement at the end in closed form [m]."""
    displacements, _ = friction.free_motion(case.scene, friction.sliding_acceleration(case.scene))
    return float(displacements[-1])


def ahead(case: CaseResults) -> float | None:
    """Return how far a run is beyond the closed form [m]."""
    final = case.number(DDA, "horizontal.final")
    return None if final is None else final - free_slide(case)


def thresholds(cases: Sequence[CaseResults]) -> Blocks:
    """Return the accelerations about the angle of friction."""
    rows = []
    for case in cases:
        history = case.histories.get(DDA)
        slip_rate = case.number(DDA, "contact.slip_rate")
        expected = friction.sliding_acceleration(case.scene)
        measured: Value = None
        if expected < 0 and slip_rate is not None and slip_rate < 1e-9:
            measured = "stands"
            slip_rate = 0.0
        elif history is not None:
            measured = study.acceleration(case.scene, history)
        own = {"expected": expected, "measured": measured, "slip": slip_rate}
        rows.append(PAGE.cells("thresholds", case, own | {"friction": case.scene.contact.friction or 0.0}))
    return [
        Heading("Where sliding begins", 2),
        Paragraph(PAGE.text("thresholds")),
        PAGE.table("thresholds", rows),
    ]


ShakenCase = tuple[CaseResults, dict[str, VerdictRecord]]


def judged(group: CaseGroup) -> list[ShakenCase]:
    """Return the cases of a group that have gates against a rigid mass, and these by their metrics."""
    cases = []
    for case in group.cases:
        verdicts = {v["metric"]: v for v in group.verdicts if v["scene"] == case.name and v["pair"] == [study.RIGID]}
        if {"slide", "largest difference"} <= set(verdicts):
            cases.append((case, verdicts))
    return cases


def shaking(cases: Sequence[ShakenCase]) -> Blocks:
    """Return the slides over a base that shakes, beside those of a rigid mass."""
    rows = []
    for case, verdicts in cases:
        low, high = verdicts["slide"]["band"]
        own = {
            "base": "record" if case.name.startswith(study.QUAKE) else "2 Hz",
            "rigid": (low + high) / 2,  # the middle of the band is the rigid mass's slide
            "slide": verdicts["slide"]["value"],
            "difference": verdicts["largest difference"]["value"],
            "allowed": (high - low) / 2,
        }
        rows.append(PAGE.cells("shaking", case, own))
    return [Heading("A base that shakes", 2), PAGE.table("shaking", rows)] if rows else []
