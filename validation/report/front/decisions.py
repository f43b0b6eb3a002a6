"""Three pages for three decisions of a practitioner: which time step, which springs, which discount."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from pathlib import Path

import numpy as np

from validation.report.blocks import Blocks, Callout, Heading, PageBreak, Paragraph, Table
from validation.report.chapters.data import CaseResults, Groups
from validation.report.chapters.described import Description
from validation.report.figures.charts import DASHED, SETTINGS, ChartLine, ChartPanel
from validation.report.front import closed
from validation.report.front.first import damping_at_steps, peak_excess
from validation.report.front.groups import at_ratio, by_step, case_where
from validation.runs.numbers import DASH, milliseconds, percent, short, signed_percent
from validation.runs.row import Value
from validation.scenes.scene import Scene
from validation.theory import spectra, statics

PAGE = Description(__file__)
RATIOS = (1.0, 10.0, 100.0)  # p/E of the paper
TARGET_DAMPING = (0.01, 0.02, 0.05, 0.1, 0.2)  # damping ratios that a step is named for
DISCOUNTS = (1.0, 0.98, 0.95, 0.9)  # of the paper's Figure 9
STEPS = (1e-2, 2e-3, 1e-3, 1e-4)  # s
STEP = 2e-3  # s, of the page on springs
RATE_STEPS = (1e-3, 2e-3, 1e-2, 2e-2)  # s, at which the damping of a discount that is held as a rate is given
SCHEMES = {"(1/2, 1)": (0.5, 1.0), "(9/16, 1)": (0.5625, 1.0)}
RANGE = (0.01, 20.0)  # ms


def decisions(groups: Groups, paper: Scene, directory: Path) -> Blocks:
    """Return the three pages."""
    blocks: Blocks = []
    for page in (step_page, spring_page, discount_page):
        blocks += [PageBreak(), *page(groups, paper, directory)]
    return blocks


def _rule(text: str, options: str) -> Callout:
    """Return a rule with the command that answers the question for a scene of the reader's own."""
    return Callout(PAGE.text("rule", text=text, command=options), "rule")


def _damping_chart(
    scheme: str,
    scenes: Mapping[str, Scene],
    y_range: tuple[float, float],
    marks: Mapping[str, float],
    levels: Mapping[str, float],
) -> ChartPanel:
    """Return the damping ratio of the first axial mode over the time step, dashed where the discount is a rate."""
    steps = np.geomspace(RANGE[0] / 1e3, RANGE[1] / 1e3, 240)
    lines = []
    for (name, scene), color in zip(scenes.items(), SETTINGS, strict=False):
        dash = () if scene.time.gg_rate is None else DASHED
        lines.append(ChartLine(name, 1e3 * steps, 100 * closed.over_steps(scene, steps), color, dash))
    title = f"Damping ratio of the first axial mode [%], {scheme}"
    return PAGE.panel("damping", lines, title=title, y_range=y_range, marks=marks, levels=levels)


# ---- which time step ----------------------------------------------------------------------------------------------


def step_page(groups: Groups, paper: Scene, directory: Path) -> Blocks:
    """Return the page on the time step."""
    scenes = [closed.stiffer(closed.constant(paper), r) for r in RATIOS]
    turn = closed.most_damped(scenes[0])
    transit = 1e3 * spectra.transit(paper)
    chart = _damping_chart(
        "constant acceleration",
        {f"p = {closed.ratio_of(scene):g}E": scene for scene in scenes},
        (0.05, 60.0),
        {f"a/c = {transit:.3g} ms": transit},
        {f"{100 * xi:g} %": 100 * xi for xi in TARGET_DAMPING},
    )
    greatest = max(float(np.nanmax(line.y)) for line in chart.lines)
    step = closed.step_for(scenes[0], 0.05)
    example = PAGE.text("example", step=step) if step else ""
    command = "advise step my-block.toml --damping 0.05 --solve-for dt"
    return [
        Heading("Decision 1: which time step?", 2),
        _rule(PAGE.text("step-rule", example=example), command),
        PAGE.figure("step", [chart], directory, greatest=greatest, turn=turn),
        step_table(scenes),
        *_as_run(groups),
    ]


def step_table(scenes: Sequence[Scene]) -> Table:
    """Return the time step for a damping ratio, a column for each stiffness."""
    rows = []
    for xi in TARGET_DAMPING:
        steps = [closed.step_for(scene, xi) for scene in scenes]
        rows.append((f"{100 * xi:g} %", *(DASH if step is None else f"{1e3 * step:.3g}" for step in steps)))
    frequencies = [spectra.dda_frequency(scene) for scene in scenes]
    rows.append(("ω₁ [rad/s]", *(short(w) for w in frequencies)))
    heads = ("Wanted ξ", ("dt [ms]", *(f"p = {closed.ratio_of(scene):g}E" for scene in scenes)))
    return PAGE.table("steps", rows, heads)


def _as_run(groups: Groups) -> Blocks:
    """Return what the runs over one fixed time had: damping, errors, hidden tension."""
    group = groups.get("model-form")
    if group is None:
        return []
    by_length = replace(group, cases=tuple(by_step(group)))
    table = PAGE.case_table("as-run", by_length, {"peak": _peak, "tension": _tension})
    return [table, Paragraph(PAGE.text("as-run"))] if table.rows else []


def _peak(case: CaseResults) -> str | None:
    """Return how far the first peak of the pressure is off, with its sign."""
    excess = peak_excess(case)
    return None if excess is None else signed_percent(excess)


def _tension(case: CaseResults) -> Value:
    """Return the least pressure where the contact pulls [Pa]."""
    minimum = case.number("dda", "pressure.minimum")
    is_closed = minimum is not None and minimum >= -closed.NOISE * case.scene.load.pressure
    return "none" if is_closed else minimum


# ---- which springs ------------------------------------------------------------------------------------------------


def spring_page(groups: Groups, paper: Scene, directory: Path) -> Blocks:
    """Return the page on the stiffness of the springs."""
    base = closed.constant(paper, step=STEP)
    grid = np.geomspace(0.1, 1e5, 240)
    scenes = [closed.stiffer(base, float(r)) for r in grid]
    share = np.array([100 * closed.penetration(s) / abs(statics.static_displacement(s)) for s in scenes])
    high = np.array([100 * (spectra.dda_frequency(s) / spectra.bar_frequency(s) - 1) for s in scenes])
    marks = {f"{r:g}E": r for r in RATIOS}
    additions = (
        ChartLine("share of v at rest", grid, share, SETTINGS[0]),
        ChartLine("ω₁ above the bar's", grid, high, SETTINGS[3]),
    )
    radii = []
    for (name, (alpha, delta)), color in zip(SCHEMES.items(), SETTINGS[1:], strict=False):
        stepped = [closed.timed(s, alpha=alpha, delta=delta) for s in scenes]
        radii.append(ChartLine(name, grid, np.array([closed.contact_radius(s) for s in stepped]), color))
    title = f"|λ| of the contact at dt = {milliseconds(STEP)}"
    panels = [
        PAGE.panel("deflection", additions, marks=marks),
        PAGE.panel("ringing", radii, title=title, marks=marks),
    ]
    return [
        Heading("Decision 2: which spring stiffness?", 2),
        _rule(spring_rule(groups, base), "advise damping my-block.toml --set contact.stiffness=1e10"),
        PAGE.figure("springs", panels, directory),
        spring_table(groups, base),
        Paragraph(PAGE.text("ringing")),
    ]


def spring_rule(groups: Groups, base: Scene) -> str:
    """Return the rule on springs, with what happens at p = 100E."""
    scenes = [closed.stiffer(base, ratio) for ratio in RATIOS[1:]]
    case = case_where(groups.get("figures-5-6"), at_ratio(100.0))
    displacement, pressure = (column.of_case(case) for column in PAGE.columns("springs")[8:])
    as_run = ""
    if DASH not in (pressure, displacement):
        as_run = PAGE.text("springs-as-run", pressure=pressure, displacement=displacement)
    return PAGE.text(
        "spring-rule",
        deflections=[1e3 * closed.penetration(scene) for scene in scenes],
        share=closed.spring_share(scenes[0]),
        limits=[closed.sign_change_step(scene) for scene in scenes],
        step=STEP,
        radii=[closed.contact_radius(scene) for scene in scenes],
        as_run=as_run,
    )


def spring_table(groups: Groups, base: Scene) -> Table:
    """Return what a stiffness makes of the answer: closed forms, and steps to settle as run."""
    rows = []
    for ratio in RATIOS:
        scene = closed.stiffer(base, ratio)
        case, fine = (case_where(groups.get(name), at_ratio(ratio, 0.5)) for name in ("figures-5-6", "stiff-contact"))
        numbers: dict[str, Value] = {
            "ratio": ratio,
            "at rest": statics.static_displacement(scene),
            "springs": f"{1e3 * closed.penetration(scene):.3g}",
            "damping": closed.first_damping(scene),
            "contact": closed.contact_radius(scene),
            "limit": f"{1e3 * closed.sign_change_step(scene):.3g}",
        }
        columns = PAGE.columns("springs")
        row = [column.text(numbers[column.of]) for column in columns[:6]]
        row += [column.of_case(case) for column in columns[6:8]]
        rows.append([*row, *(column.of_case(fine or case) for column in columns[8:])])
    return PAGE.table("springs", rows, step=milliseconds(STEP))


# ---- which discount -----------------------------------------------------------------------------------------------


def discount_page(groups: Groups, paper: Scene, directory: Path) -> Blocks:
    """Return the page on the discount."""
    base = closed.average(paper)
    rate = closed.rate_for(base, 0.05)
    at_rate = closed.timed(base, gg_rate=rate, gg=1.0)
    scenes = {f"gg = {gg:g}": closed.timed(base, gg=gg) for gg in DISCOUNTS[1:]}
    turns = ", ".join(short(spectra.dda_frequency(at_rate) * step, 2) for step in RATE_STEPS)
    chart = _damping_chart(
        "average acceleration",
        scenes | {f"gg = exp(−{rate:.3g} dt)": at_rate},
        (0.1, 1000.0),
        {"2 ms": 2.0, "1 ms": 1.0, "0.1 ms": 0.1},
        {"critical": 100.0},
    )
    per_step = closed.timed(base, gg=0.98)
    overdamped_below = closed.overdamped_below(per_step)
    creep = PAGE.text("creep", step=overdamped_below) if overdamped_below else ""
    ratios = damping_at_steps(per_step, (2e-3, 1e-3, 1e-4))
    return [
        Heading("Decision 3: which discount?", 2),
        _rule(
            PAGE.text("discount-rule", rate=rate, ratios=ratios, creep=creep),
            "advise step my-block.toml --damping 0.05 --solve-for gg",
        ),
        PAGE.figure("discount", [chart], directory, ratios=damping_at_steps(at_rate, RATE_STEPS), turns=turns),
        discount_table(base),
        Paragraph(PAGE.text("discount")),
        *_measured(groups),
    ]


def discount_table(base: Scene) -> Table:
    """Return the damping of each discount at each step, where it overdamps, and the rate it amounts to."""
    rows = []
    for gg in DISCOUNTS:
        scene = closed.timed(base, gg=gg)
        ratios = [closed.first_damping(closed.timed(scene, step=step)) for step in STEPS[1:]]
        damping_cells = [percent(xi) if xi > 1e-12 else "0\u00a0%" for xi in ratios]
        overdamped_below = closed.overdamped_below(scene)
        step = DASH if overdamped_below is None else f"{1e3 * overdamped_below:.3g}"
        rate = -np.log(gg) / 1e-3 + 0.0  # without a negative zero
        rows.append((f"{gg:.2f}", *damping_cells, step, f"{rate:.3g}"))
    by_step_heads = ("ξ₁, average acceleration", *(f"dt = {milliseconds(step)}" for step in STEPS[1:]))
    return PAGE.table("discounts", rows, ("gg", by_step_heads, "overdamped below dt [ms]", "c at dt = 1 ms [1/s]"))


def _measured(groups: Groups) -> Blocks:
    """Return how the runs of Figure 9 were damped, as measured on their histories."""
    group = groups.get("figure-9")
    if group is None:
        return []
    ratios = []
    for case in group.cases:
        xi = case.number("dda", "mode1.measured_damping")
        if xi is not None:
            ratios.append((percent(xi) if xi > 1e-9 else "0 %", case.scene.time.discount))
    if not ratios:
        return []
    step = group.cases[0].scene.time.step
    return [Paragraph(PAGE.text("measured", step=step, ratios=PAGE.listed("measured-ratio", ratios)))]
