"""The chapter of the study `slopes`: the way of a sliding block beside its closed form, and what a discount leaves."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from pathlib import Path

import numpy as np

from validation.gates import friction
from validation.report.blocks import Block, FigureBlock, Heading, Paragraph, Table, columns
from validation.report.chapters.data import Case, Group, groups, verdicts_of
from validation.report.chapters.scene import opening
from validation.report.chapters.text import DASH, plain
from validation.report.figures.friction import Panel, Trace, panels_figure
from validation.report.figures.histories import saved
from validation.runs.records import Manifest, VerdictRecord
from validation.runs.results import Results
from validation.studies.slopes import sliding as study

OURS, ALONG = "dda", "horizontal_displacement"
ORANGE, BLUE, GREY = "#d55e00", "#0072b2", "#666666"
RATES = np.geomspace(0.1, 100.0, 61)  # 1/s
CAPTION = (
    "DDA follows the closed form down the incline, and a discount brakes it as a drag. "
    "Left: distance that the block slides, dda (lines) and the closed form (dashed), without a discount and with "
    "gg = 0.98 and 0.99 per step. Right: share of the distance without drag that a body covers in a second, over the "
    "rate of the drag: continuous drag (line) and runs (circles)."
)
SAID = (
    "While every corner slips one way or is open, the centroid's uₜ + uₙ tan φ moves freely under "
    "g (sin β − tan φ cos β) − c a / m, whatever springs, step and scheme, through bounces too. The springs put the "
    "block ahead by tan φ times its settlement, at any step: this is what papers call the penalty error of sliding. "
    "A discount is a drag of −ln(gg)/dt per second, in sliding and in flight alike: gg without dt means nothing."
)


def chapter(results: Results, manifest: Manifest, directory: Path) -> list[Block]:
    """Return the chapter: figure, run-outs, thresholds."""
    found = {group.name: group for group in groups(results, manifest)}
    slides = [
        case for name in (study.SLIDING, study.AVERAGE, study.DRAG) if name in found for case in found[name].cases
    ]
    starts = [case for name in (study.THRESHOLD, study.MANUAL) if name in found for case in found[name].cases]
    blocks = [*opening(manifest, verdicts_of(found.values())), Paragraph(SAID)]
    if found.get(study.SLIDING) and found.get(study.DRAG):
        blocks.append(trajectories(found[study.SLIDING], found[study.DRAG], directory))
    blocks += [Heading("Run-out", 2), run_outs(slides)] if slides else []
    shaken = [case for name in (study.SHAKEN, study.QUAKE) if name in found for case in judged(found[name])]
    return [*blocks, *(thresholds(starts) if starts else []), *(shaking(shaken) if shaken else [])]


def trajectories(free: Group, braked: Group, directory: Path) -> FigureBlock:
    """Return the figure of ways over time, and of what a drag leaves."""
    traces = []
    for case, color in zip((*free.cases[-1:], *braked.cases), (ORANGE, BLUE, "#009e73", "#cc79a7", GREY), strict=False):
        if (history := case.histories.get(OURS)) is None:
            continue
        gg = case.scene.time.discount
        words = f"gg = {gg:g}, dt = {1e3 * case.scene.time.step:g} ms"
        way, _ = friction.free_motion(case.scene, friction.sliding_acceleration(case.scene))
        traces.append(Trace(words, history.time, history.columns[ALONG], color))
        traces.append(Trace("_", history.time, way, "black", dash=(2.0, 2.0)))
    curve = Trace("drag c", RATES, np.array([kept(rate) for rate in RATES]), GREY)
    dots = [dot for case in braked.cases if (dot := share(case)) is not None]
    points = Trace("dda", np.array([x for x, _ in dots]), np.array([y for _, y in dots]), ORANGE, dotted=True)
    panels = (
        Panel("Way down the incline", "t [s]", "way [m]", tuple(traces), legend="upper left"),
        Panel("What a drag leaves after 1 s", "c [1/s]", "share of the way", (curve, points), True, "lower left"),
    )
    return saved(panels_figure(panels), directory, "slopes-ways.svg", CAPTION)


def kept(rate: float, time: float = 1.0) -> float:
    """Return the share of its way under a drag, 2 (c t - 1 + exp(-c t)) / (c t)^2 [-]."""
    x = rate * time
    return 2 * (x + float(np.expm1(-x))) / x**2


def share(case: Case) -> tuple[float, float] | None:
    """Return the drag's rate and the share of the way that a run went."""
    way = case.number(OURS, "horizontal.final")
    whole = friction.run_out(case.scene, case.scene.time.duration)
    return None if way is None else (friction.drag_rate(case.scene), way / whole)


def run_outs(cases: Sequence[Case]) -> Table:
    """Return the ways of all runs beside the closed form."""
    titles = (
        *columns("decimal", "dt [ms]", "α", "δ", "gg", "c [1/s]", "cohesion [Pa]"),
        *columns("decimal", "closed form [m]", "dda [m]", "ahead [µm]", "fem [m]"),
    )
    caption = (
        "Distance after a second at 28.9 degrees under 15 degrees of friction. Ahead: the run beyond the closed form; "
        "18.64 µm is tan φ times the settlement; under average acceleration the block is still in the air."
    )
    return Table(titles, tuple(_run_out(case) for case in cases), caption)


def _run_out(case: Case) -> tuple[str, ...]:
    t, scene = case.scene.time, case.scene
    free = float(friction.free_motion(scene, friction.sliding_acceleration(scene))[0][-1])
    ours, elements = (case.number(name, "horizontal.final") for name in (OURS, "fem"))
    numbers = (
        (1e3 * t.step, t.alpha, t.delta, t.discount),
        (friction.drag_rate(scene) + 0.0, scene.contact.cohesion, free),
    )
    said = [plain(value, 4 if i < 6 else 6) for i, value in enumerate((*numbers[0], *numbers[1]))]
    ahead = None if ours is None else 1e6 * (ours - free)
    return (*said, *(DASH if v is None else plain(v, d) for v, d in ((ours, 6), (ahead, 4), (elements, 6))))


def thresholds(cases: Sequence[Case]) -> Iterator[Block]:
    """Yield the accelerations about the angle of friction."""
    titles = columns(
        "decimal", "slope [°]", "friction [°]", "a, closed form [m/s²]", "a, dda [m/s²]", "slip a second [mm/s]"
    )
    rows = []
    for case in cases:
        history, rate = case.histories.get(OURS), case.number(OURS, "contact.slip_rate")
        expected = friction.sliding_acceleration(case.scene)
        stands = expected < 0 and rate is not None and rate < 1e-9
        measured = None if history is None or stands else study.acceleration(case.scene, history)
        numbers = (case.scene.load.slope, case.scene.contact.friction or 0.0)
        rows.append(
            (
                *(plain(value, 4) for value in numbers),
                plain(expected, 5),
                "stands" if stands else DASH if measured is None else plain(measured, 5),
                DASH if rate is None else plain(0.0 if stands else 1e3 * rate, 4),
            )
        )
    yield Heading("Where sliding begins", 2)
    yield Paragraph(
        "Gravity is switched on, so that a block begins to slide on every slope and loses or gains speed by "
        "g (sin β − tan φ cos β): the slope at which that passes through zero is the angle of friction."
    )
    yield Table(titles, tuple(rows), "Acceleration over the second half of each run.")


Judged = tuple[Case, dict[str, VerdictRecord]]


def judged(group: Group) -> list[Judged]:
    """Return the cases of a group that have gates against a rigid mass, and these by their metrics."""
    found = []
    for case in group.cases:
        own = {v["metric"]: v for v in group.verdicts if v["scene"] == case.name and v["pair"] == [study.RIGID]}
        if {"slide", "largest difference"} <= set(own):
            found.append((case, own))
    return found


def shaking(cases: Sequence[Judged]) -> Iterator[Block]:
    """Yield the slides over a base that shakes, beside those of a rigid mass."""
    titles = columns(
        "decimal",
        "base",
        "slope [deg]",
        "p [GN/m]",
        "slide, rigid [mm]",
        "slide, dda [mm]",
        "largest difference [mm]",
        "allowed [mm]",
    )
    rows = []
    for case, own in cases:
        low, high = own["slide"]["band"]
        found = (own["slide"]["value"], own["largest difference"]["value"])
        said = (DASH if not isinstance(value, float) else plain(1e3 * value, 4) for value in found)
        base = "record" if case.name.startswith(study.QUAKE) else "2 Hz"
        scene = (plain(case.scene.load.slope, 2), plain(case.scene.contact.stiffness / 1e9, 3))
        rows.append((base, *scene, plain(500 * (low + high), 5), *said, plain(500 * (high - low), 3)))
    if rows:
        yield Heading("A base that shakes", 2)
        yield Table(
            titles,
            tuple(rows),
            "Slide over a base that shakes, at 2 Hz or by a record of three frequencies: Newmark's sliding block.",
        )
