"""The chapter of the study `slopes`: displacement of a sliding block beside its closed form, and under a discount."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from pathlib import Path

import numpy as np

from validation.report.blocks import Block, Blocks, FigureBlock, Heading, Paragraph, Table, table
from validation.report.chapters.data import CaseGroup, CaseResults, cases_of, groups_by_name, verdicts_of
from validation.report.chapters.scene import opening
from validation.report.chapters.text import DASH, cell, plain
from validation.report.figures.charts import BESIDE, DOTS, ChartLine, ChartPanel, chart_figure
from validation.report.figures.histories import saved
from validation.runs.records import Manifest, VerdictRecord
from validation.runs.results import Results
from validation.studies.slopes import sliding as study
from validation.theory import friction

DDA = "dda"
ALONG = "horizontal_displacement"
ORANGE = "#d55e00"
GREY = "#666666"
BRAKED_COLORS = ("#0072b2", "#009e73", "#cc79a7", GREY)
RATES = np.geomspace(0.1, 100.0, 61)  # 1/s
CAPTION = (
    "DDA follows the closed form down the incline, and a discount brakes it as a drag. "
    "Left: distance that the block slides, dda (lines) and the closed form (dashed), without a discount and with "
    "gg = 0.98 and 0.99 per step. Right: share of the distance without drag that a body covers in a second, over the "
    "rate of the drag: continuous drag (line) and runs (circles)."
)
EXPLANATION = (
    "While every corner slips in one direction or is open, the centroid's uₜ + uₙ tan φ moves freely under "
    "g (sin β − tan φ cos β) − c a / m, whatever springs, step and scheme, through bounces too. The springs put the "
    "block ahead by tan φ times its settlement, at any step: this is what papers call the penalty error of sliding. "
    "A discount is a drag of −ln(gg)/dt per second, in sliding and in flight alike: gg without dt means nothing."
)


def chapter(results: Results, manifest: Manifest, directory: Path) -> Blocks:
    """Return the chapter: figure, run-outs, thresholds."""
    groups = groups_by_name(results, manifest)
    blocks = [*opening(manifest, verdicts_of(groups.values())), Paragraph(EXPLANATION)]
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
    panels = (
        ChartPanel("Distance down the incline", "t [s]", "distance [m]", traces, names="upper left"),
        ChartPanel(
            "What a drag leaves after 1 s",
            "c [1/s]",
            "share of the distance",
            (curve, points),
            logarithmic=(True, True),
            names="lower left",
        ),
    )
    return saved(chart_figure(panels, margins=BESIDE), directory, "slopes-ways.svg", CAPTION)


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
    caption = (
        "Distance after a second at 28.9 degrees under 15 degrees of friction. Ahead: the run beyond the closed form; "
        "18.64 µm is tan φ times the settlement; under average acceleration the block is still in the air."
    )
    return table(
        (
            "dt [ms]",
            "α",
            "δ",
            "gg",
            "c [1/s]",
            "cohesion [Pa]",
            "closed form [m]",
            "dda [m]",
            "ahead [µm]",
            "fem [m]",
        ),
        tuple(_run_out(case) for case in cases),
        caption,
    )


def _run_out(case: CaseResults) -> tuple[str, ...]:
    scene = case.scene
    time = scene.time
    data = (1e3 * time.step, time.alpha, time.delta, time.discount, friction.drag_rate(scene), scene.contact.cohesion)
    displacements, _ = friction.free_motion(scene, friction.sliding_acceleration(scene))
    free = float(displacements[-1])
    dda, fem = (case.number(solver, "horizontal.final") for solver in (DDA, "fem"))
    ahead = None if dda is None else dda - free
    return (
        *(plain(value + 0.0) for value in data),  # without a negative zero
        plain(free, 6),
        cell(dda, digits=6),
        cell(ahead, 1e6),
        cell(fem, digits=6),
    )


def thresholds(cases: Sequence[CaseResults]) -> Iterator[Block]:
    """Yield the accelerations about the angle of friction."""
    rows = []
    for case in cases:
        history = case.histories.get(DDA)
        slip_rate = case.number(DDA, "contact.slip_rate")
        expected = friction.sliding_acceleration(case.scene)
        measured = DASH
        if expected < 0 and slip_rate is not None and slip_rate < 1e-9:
            measured = "stands"
            slip_rate = 0.0
        elif history is not None:
            measured = cell(study.acceleration(case.scene, history), digits=5)
        rows.append(
            (
                plain(case.scene.load.slope),
                plain(case.scene.contact.friction or 0.0),
                plain(expected, 5),
                measured,
                cell(slip_rate, 1e3),
            )
        )
    yield Heading("Where sliding begins", 2)
    yield Paragraph(
        "Gravity is switched on, so that a block begins to slide on every slope and loses or gains speed by "
        "g (sin β − tan φ cos β): the slope at which that passes through zero is the angle of friction."
    )
    yield table(
        ("slope [°]", "friction [°]", "a, closed form [m/s²]", "a, dda [m/s²]", "slip a second [mm/s]"),
        rows,
        "Acceleration over the second half of each run.",
    )


ShakenCase = tuple[CaseResults, dict[str, VerdictRecord]]


def judged(group: CaseGroup) -> list[ShakenCase]:
    """Return the cases of a group that have gates against a rigid mass, and these by their metrics."""
    cases = []
    for case in group.cases:
        verdicts = {v["metric"]: v for v in group.verdicts if v["scene"] == case.name and v["pair"] == [study.RIGID]}
        if {"slide", "largest difference"} <= set(verdicts):
            cases.append((case, verdicts))
    return cases


def shaking(cases: Sequence[ShakenCase]) -> Iterator[Block]:
    """Yield the slides over a base that shakes, beside those of a rigid mass."""
    rows = []
    for case, verdicts in cases:
        low, high = verdicts["slide"]["band"]
        values = (verdicts["slide"]["value"], verdicts["largest difference"]["value"])
        measured = (plain(1e3 * value, 4) if isinstance(value, float) else DASH for value in values)
        base = "record" if case.name.startswith(study.QUAKE) else "2 Hz"
        scene = (plain(case.scene.load.slope, 2), plain(case.scene.contact.stiffness / 1e9, 3))
        # Half of a band in mm: its middle is the rigid mass's slide, its half width what is allowed.
        rows.append((base, *scene, plain(500 * (low + high), 5), *measured, plain(500 * (high - low), 3)))
    if rows:
        yield Heading("A base that shakes", 2)
        yield table(
            (
                "base",
                "slope [deg]",
                "p [GN/m]",
                "slide, rigid [mm]",
                "slide, dda [mm]",
                "largest difference [mm]",
                "allowed [mm]",
            ),
            rows,
            "Slide over a base that shakes, at 2 Hz or by a record of three frequencies: Newmark's sliding block.",
        )
