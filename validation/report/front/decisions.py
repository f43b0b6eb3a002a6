"""Three pages for three decisions of a practitioner: which time step, which springs, which discount."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np

from validation.report.blocks import Blocks, Callout, Heading, Paragraph, Table, table
from validation.report.chapters.data import Groups
from validation.report.chapters.described import Description
from validation.report.chapters.text import DASH, cell, percent, short
from validation.report.figures import histories
from validation.report.figures.charts import DASHED, SETTINGS, ChartLine, ChartPanel, chart_figure
from validation.report.front import closed
from validation.report.front.first import damping_at_steps, peak_excess, signed_percent
from validation.report.front.groups import at_ratio, by_step, case_where, milliseconds
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
        blocks += page(groups, paper, directory)
    return blocks


def _rule(text: str, options: str) -> Callout:
    """Return a rule with the command that answers the question for a scene of the reader's own."""
    return Callout(f"Rule. {text} For your own block: dda-validate {options}", "rule")


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
    return ChartPanel(title, "time step dt [ms]", "", lines, RANGE, y_range, (True, True), marks, levels)


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
    caption = (
        f"Damping @doolin2004, @lin2015 grows with the step, ξ ≈ ω₁ dt / 4, to at most {greatest:.3g} % "
        f"at ω₁ dt = {turn:.3g}, and falls beyond; where a line ends, at ω₁ dt = 4, the mode flips "
        "sign each step instead of oscillating. Dashed vertical: the time a wave takes from top to base; a longer "
        "step cannot resolve it."
    )
    step = closed.step_for(scenes[0], 0.05)
    example = f": for 5\u00a0% at p = 1E, dt = {1e3 * step:.3g}\u00a0ms" if step else ""
    return [
        Heading("Decision 1: which time step?", 2),
        _rule(
            f"Choose the damping ratio ξ of the first axial mode, then dt ≈ 4 ξ / ω₁, ω₁ its circular "
            f"frequency (up to ξ = 10\u00a0% within 3\u00a0%){example}. "
            "Small damping and the wave both need a short step, and no step repairs the model: what is left "
            "when the damping is gone is one strain in place of a wave.",
            "advise my-block.toml --damping 0.05 --solve-for dt",
        ),
        histories.saved(chart_figure([chart], 37.0), directory, "decision-step.svg", caption),
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
    return table(
        ("Wanted ξ", ("dt [ms]", *(f"p = {closed.ratio_of(s):g}E" for s in scenes))),
        rows,
        "Which dt for which damping ratio: constant acceleration (1/2, 1), gg = 1.",
    )


def _as_run(groups: Groups) -> Blocks:
    """Return what the runs over one fixed time had: damping, errors, hidden tension."""
    group = groups.get("model-form")
    if group is None:
        return []
    rows = []
    for case in by_step(group):
        errors = []
        for pair in (("dda", "bar"), ("bar", "continuum")):
            errors += [group.number_of_pair(case, *pair, f"{name}.l2") for name in ("displacement", "pressure")]
        minimum = case.number("dda", "pressure.minimum")
        tension = cell(minimum, 1e-6, 3)
        if minimum is not None and minimum >= -closed.NOISE * case.scene.load.pressure:
            tension = "none"
        excess = peak_excess(case)
        peak = DASH if excess is None else signed_percent(excess)
        shares = (case.number("dda", "mode1.damping"), *errors)
        damping, *error_cells = [DASH if value is None else percent(value) for value in shares]
        rows.append((f"{1e3 * case.scene.time.step:g}", damping, peak, *error_cells, tension))
    if not rows:
        return []
    return [
        table(
            (
                "dt [ms]",
                "ξ₁",
                ("DDA − bar: model", "first peak", "displ.", "pressure"),
                ("bar − continuum: time", "displ.", "pressure"),
                "Pull of the contact [MPa]",
            ),
            rows,
            "What each step cost at p = 1E, as run: first peak of the pressure, and relative L2 over 0.2 s.",
        ),
        Paragraph(
            "Read both halves together: the left falls as the step grows because both motions are damped out, and only "
            "the right shows what the step has cost. No window changes the peak; a relative L2 difference of motions "
            "that are little damped is mostly one of phase and grows with the time over which it is taken."
        ),
    ]


# ---- which springs ------------------------------------------------------------------------------------------------


def spring_page(groups: Groups, paper: Scene, directory: Path) -> Blocks:
    """Return the page on the stiffness of the springs."""
    base = closed.constant(paper, step=STEP)
    grid = np.geomspace(0.1, 1e5, 240)
    scenes = [closed.stiffer(base, float(r)) for r in grid]
    share = np.array([100 * closed.penetration(s) / abs(statics.static_displacement(s)) for s in scenes])
    high = np.array([100 * (spectra.dda_frequency(s) / spectra.bar_frequency(s) - 1) for s in scenes])
    marks = {f"{r:g}E": r for r in RATIOS}
    axes: dict[str, Any] = {"x_range": (0.1, 1e5), "logarithmic": (True, False), "marks": marks}
    additions = (
        ChartLine("share of v at rest", grid, share, SETTINGS[0]),
        ChartLine("ω₁ above the bar's", grid, high, SETTINGS[3]),
    )
    deflection = ChartPanel("What the springs add [%]", "p / E", "", additions, y_range=(0.0, 100.0), **axes)
    radii = []
    for (name, (alpha, delta)), color in zip(SCHEMES.items(), SETTINGS[1:], strict=False):
        stepped = [closed.timed(s, alpha=alpha, delta=delta) for s in scenes]
        radii.append(ChartLine(name, grid, np.array([closed.contact_radius(s) for s in stepped]), color))
    title = f"|λ| of the contact at dt = {milliseconds(STEP)}"
    ringing = ChartPanel(title, "p / E", "", radii, y_range=(0.0, 1.05), **axes)
    caption = (
        "Left: the springs' share of v at rest over p/E; the stiffer they are, the more the first natural "
        "frequency exceeds the bar's. Right: |λ|, the share of its amplitude that the contact keeps per step; at 1 the "
        "ringing is undamped. Of the two drawn (9/16, 1) avoids it, as does any δ > 1/2 with α = (1/2 + δ)²/4, "
        "whose roots tend to (δ − 3/2)/(δ + 1/2)."
    )
    return [
        Heading("Decision 2: which spring stiffness?", 2),
        _rule(spring_rule(groups, base), "damping my-block.toml --set contact.stiffness=1e10"),
        histories.saved(chart_figure([deflection, ringing], 34.0), directory, "decision-springs.svg", caption),
        spring_table(groups, base),
        Paragraph(
            "The ringing is almost invisible in the displacement and fully present in the contact force: forces that "
            "are read, or that open the contact, show the scheme and not the block."
        ),
    ]


def spring_rule(groups: Groups, base: Scene) -> str:
    """Return the rule on springs, with what happens at p = 100E."""
    usual, stiff = (closed.stiffer(base, ratio) for ratio in RATIOS[1:])
    case = case_where(groups.get("figures-5-6"), at_ratio(100.0))
    displacement, pressure = (column.of_case(case) for column in PAGE.columns("springs")[8:])
    as_run = ""
    if DASH not in (pressure, displacement):
        as_run = (
            f" (as run: {pressure} steps until the pressure is within 0.01\u00a0%, {displacement} for the displacement)"
        )
    return (
        f"For a locked square block take p = 10E: the springs then deflect by {1e3 * closed.penetration(usual):.3g}"
        f"\u00a0mm at rest, {percent(closed.spring_share(usual))} of what the block shortens by; for another shape it "
        f"is (w/h) E/p. At p = 100E they deflect by {1e3 * closed.penetration(stiff):.3g}\u00a0mm. Beyond dt = 4/ω of "
        f"the contact, {milliseconds(closed.sign_change_step(usual))} at 10E and "
        f"{milliseconds(closed.sign_change_step(stiff))} at 100E, the contact force flips sign each step: at "
        f"dt = {milliseconds(STEP)} it keeps {percent(closed.contact_radius(usual))} of its amplitude at 10E and "
        f"{percent(closed.contact_radius(stiff))} at 100E{as_run}. "
        "If stiff springs are a must, take a step below 4/ω, or δ > 1/2 with α = (1/2 + δ)²/4, as (9/16, 1). Where the "
        "contact opens, the peak force of a landing in DDA grows as √p: this is no rule there."
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
            "limit": f"{1e3 * 4 / spectra.contact_frequency(scene):.3g}",
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
    caption = (
        "The shorter the step, the more a discount per step damps, without bound; held as a rate (dashed), it damps "
        f"the block alike while ω₁ dt is small: asked for 5 %, it is {damping_at_steps(at_rate, RATE_STEPS)} "
        f"(ω₁ dt = {turns})."
    )
    per_step = closed.timed(base, gg=0.98)
    overdamped_below = closed.overdamped_below(per_step)
    creep = ""
    if overdamped_below:
        creep = f", and below dt = {1e3 * overdamped_below:.3g}\u00a0ms the block creeps instead of oscillating"
    return [
        Heading("Decision 3: which discount?", 2),
        _rule(
            f"Leave gg at 1, or hold it as a rate: gg = exp(−c dt) with c = 2 ω₁ ξ, for 5\u00a0% c = {rate:.3g} 1/s, "
            "at steps with ω₁ dt below 1. "
            f"gg = 0.98 per step is {damping_at_steps(per_step, (2e-3, 1e-3, 1e-4))} of critical{creep}; a refined "
            "step never converges.",
            "advise my-block.toml --damping 0.05 --solve-for gg",
        ),
        histories.saved(chart_figure([chart], 34.0), directory, "decision-discount.svg", caption),
        discount_table(base),
        Paragraph(
            "The discount does not damp a stiff contact: with average acceleration its roots tend to −1 and −gg. It "
            "acts on the velocity at the start of a step, so that the first step from rest does not feel it; with "
            "constant acceleration it comes on top of what the step damps."
        ),
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
    return table(
        (
            "gg",
            ("ξ₁, average acceleration", *(f"dt = {milliseconds(step)}" for step in STEPS[1:])),
            "overdamped below dt [ms]",
            "c at dt = 1 ms [1/s]",
        ),
        rows,
        "What a discount per step damps at p = 1E, in closed form.",
    )


def _measured(groups: Groups) -> Blocks:
    """Return how the runs of Figure 9 were damped, as measured on their histories."""
    group = groups.get("figure-9")
    if group is None:
        return []
    parts = []
    for case in group.cases:
        xi = case.number("dda", "mode1.measured_damping")
        if xi is not None:
            ratio = percent(xi) if xi > 1e-9 else "0 %"
            parts.append(f"{ratio} for gg = {case.scene.time.discount:g}")
    if not parts:
        return []
    step = milliseconds(group.cases[0].scene.time.step)
    return [Paragraph(f"Measured on the histories of the paper's Figure 9, at dt = {step}: {', '.join(parts)}.")]
