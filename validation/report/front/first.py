"""The first page: the model, the answer in at most five sentences, the figure that carries it, one line of verdicts."""

from __future__ import annotations

import cmath
from collections import Counter
from collections.abc import Iterable
from pathlib import Path
from typing import Any

import numpy as np

from validation.report.blocks import Beside, Blocks, Callout, Heading, Paragraph, Points
from validation.report.chapters.data import CaseGroup, CaseResults, Groups, Verdicts
from validation.report.chapters.gates import window
from validation.report.figures import histories
from validation.report.figures.charts import DASHED, DOTS, SETTINGS, ChartLine, ChartPanel, chart_figure
from validation.report.figures.curves import style_of
from validation.report.figures.model import model_figure
from validation.report.front import closed
from validation.report.front.groups import PAPER, at_ratio, by_step, case_where
from validation.runs.history import Array
from validation.runs.numbers import milliseconds, percent, plain, short, signed_percent
from validation.scenes.scene import Scene
from validation.theory import spectra

TARGET_DAMPING = 0.05  # damping ratio that the answer names a time step for
STIFF = 100.0  # p/E of the answer on stiff springs
STIFFNESSES = (1.0, 10.0, 100.0)  # p/E for which the first frequency is given
STEPS = (2e-3, 5e-3)  # s, steps for which it is given as stepped
DISCOUNT = 0.98
COUNTS = ("no", "one", "two", "three", "four", "five")
SETTLED = 1e-3  # a pressure at rest within this of the load is the load


def first_page(groups: Groups, paper: Scene, verdicts: Verdicts, directory: Path) -> Blocks:
    """Return the blocks of the first page."""
    model = model_figure(f"a = {paper.block.side or 0:g} m", f"q = {paper.load.pressure / 1e6:g} MPa")
    drawing = histories.saved(model, directory, "model.svg", "")
    answers = [*filter(None, (force(groups), steps(groups, paper), springs(groups), discount(paper), beware(groups)))]
    charts = chart_figure(damping_and_error(groups, paper), 26.0)
    return [
        Beside((drawing,), (Heading("What was tested", 3), *tested(paper)), 0.42),
        Heading(f"The answer in {COUNTS[len(answers)]} sentences", 3),
        Points(tuple(answers)),
        histories.saved(charts, directory, "first.svg", damping_and_error_caption(groups, paper)),
        verdict_line(verdicts),
    ]


def tested(paper: Scene) -> Blocks:
    """Return what stands beside the drawing."""
    block = paper.block
    return [
        Paragraph(
            f"An elastic square A of side a (density {block.density:g} kg/m³, Young's modulus E = "
            f"{short(block.young / 1e9)} GPa, Poisson's ratio μ = {block.poisson:g}) stands on a fixed block B. "
            "Springs of stiffness p [N/m], written as a multiple of E, lock the corners M and N in each direction; "
            "a pressure q on the top is there from t = 0 on. DDA @shi1985, @shi1988 gives the block six unknowns: "
            "displacements u, v and rotation r of its centroid and one strain εx, εy, γxy. Reported are v and the "
            "contact pressure on the base."
        ),
        Paragraph(
            "It is compared with the same block in finite elements (fem), as a bar that is exact in space and takes "
            "the same time steps dt (bar), and as one exact in space and time (continuum). DDA differs from the bar by "
            "its model, the bar from the continuum by the time step."
        ),
    ]


# ---- five sentences -----------------------------------------------------------------------------------------------


def _model_form(groups: Groups) -> list[tuple[CaseResults, float, float]]:
    """Return the cases over one fixed time with the displacement's model form and the pressure's."""
    group = groups.get("model-form")
    if group is None:
        return []
    rows = []
    for case in by_step(group):
        v, p = (group.number_of_pair(case, "dda", "bar", f"{name}.l2") for name in ("displacement", "pressure"))
        if v is not None and p is not None:
            rows.append((case, v, p))
    return rows


def force(groups: Groups) -> tuple[str, str] | None:
    """Say whether DDA's contact force is right: at rest, and on the way there.

    The first peak leads, which no window changes. A relative L2 difference is mostly one of phase where little is
    damped, and grows with the time over which it is taken.
    """
    rows = _model_form(groups)
    if not rows:
        return None
    scene = rows[0][0].scene
    static_pressures = [case.number("dda", "pressure.static") for case, _, _ in rows]
    at_rest = "At rest no: not every run tends to the load"
    if all(value is not None and abs(value / scene.load.pressure - 1) < SETTLED for value in static_pressures):
        at_rest = f"At rest yes: every run tends to {scene.load.pressure / 1e6:g} MPa"
    peaks = []
    for case, _, _ in rows:
        excess = peak_excess(case)
        if excess is not None:
            peaks.append(f"{signed_percent(excess)} at {milliseconds(case.scene.time.step)}")
    moving = "during the motion no"
    if peaks:
        moving += f": against the bar under the same steps its first peak is off by {', '.join(peaks)}"
    return (
        "Is DDA's force right?",
        f"{at_rest}; {moving} "
        f"(p = {closed.ratio_of(scene):g}E): one strain in place of a wave, which the damping of a long step hides."
        f"{_windows(groups, rows[-1])}",
    )


def peak_excess(case: CaseResults) -> float | None:
    """Return by how much DDA's first peak of the contact pressure is above the bar's, under the same steps [1]."""
    dda, bar = (case.number(solver, "pressure.peak") for solver in ("dda", "bar"))
    return None if dda is None or not bar else dda / bar - 1


def _windows(groups: Groups, shortest: tuple[CaseResults, float, float]) -> str:
    """Say how a relative L2 difference of the pressure grows with its window, at the shortest step."""
    case, _, pressure_error = shortest
    errors: list[tuple[float, float]] = []  # window [s] and relative L2
    for verdict in groups["model-form"].verdicts:
        subject = (verdict["scene"], tuple(verdict["pair"]), verdict["metric"])
        value = verdict["value"]
        if subject == (case.name, ("dda", "bar"), "pressure.l2") and isinstance(value, int | float):
            until = window(verdict)
            errors.append((float(until.removesuffix("s")) if until else case.scene.time.duration, float(value)))
    if len(errors) < 2:
        errors = [(case.scene.time.duration, pressure_error)]
    texts = [f"{percent(value)} over {short(time)} s" for time, value in sorted(errors)]
    return (
        f" A relative L2 difference is mostly phase and grows with its window: at "
        f"{milliseconds(case.scene.time.step)} {', '.join(texts)}."
    )


def steps(groups: Groups, paper: Scene) -> tuple[str, str]:
    """Say that the time step is the damping, and which one gives 5 %."""
    measured = []
    for case in by_step(groups.get(PAPER)):
        if (xi := case.number("dda", "mode1.damping")) is not None:
            measured.append(f"{percent(xi)} at {milliseconds(case.scene.time.step)}")
    step = closed.step_for(paper, TARGET_DAMPING)
    advice = "see decision 1"
    if step:
        advice = f"for {100 * TARGET_DAMPING:g}\u00a0% take dt = {milliseconds(step)} (decision 1)"
    return (
        "Which time step?",
        f"The step is the damping: constant acceleration, in DDA's usage Newmark's @newmark1959 weights (α, δ) = (1/2, "
        f"1) (texts on finite elements mean (1/4, 1/2)), damps the first mode by {', '.join(measured)} of "
        f"critical at p = {closed.ratio_of(paper):g}E; {advice}.",
    )


def springs(groups: Groups) -> tuple[str, str] | None:
    """Say what happens at p = 100E."""
    usual, stiff = (case_where(groups.get("figures-5-6"), at_ratio(ratio)) for ratio in (STIFF / 10, STIFF))
    if usual is None or stiff is None:
        return None
    settling_steps = (
        usual.number("dda", "displacement.settling_step"),
        stiff.number("dda", "displacement.settling_step"),
        stiff.number("dda", "displacement.fine_settling_step"),
        stiff.number("dda", "pressure.fine_settling_step"),
    )
    texts = [f"{step:.0f}" for step in settling_steps if step is not None]
    if len(texts) < len(settling_steps):
        return None
    usual_steps, stiff_steps, fine_displacement, fine_pressure = texts
    radius = closed.contact_radius(stiff.scene)
    constant = closed.constant(usual.scene)
    share = percent(closed.spring_share(constant))
    return (
        "Which springs?",
        f"About p = {STIFF / 10:g}E for a locked square block: the springs then add {share} "
        "to what it shortens by itself; their force flips sign each step only beyond "
        f"dt = {milliseconds(closed.sign_change_step(constant))}. At p = {STIFF:g}E the displacement hardly changes "
        f"(settled within 1\u00a0% after {stiff_steps} steps instead of {usual_steps}), but the contact rings: it "
        f"flips sign each step and keeps {percent(radius)} of its swing, so that the pressure needs {fine_pressure} "
        f"steps to come within 0.01\u00a0% of rest and the displacement {fine_displacement}, at "
        f"dt = {milliseconds(stiff.scene.time.step)} (decision 2).",
    )


def discount(paper: Scene) -> tuple[str, str]:
    """Say what gg = 0.98 does."""
    kinetic = closed.average(paper, DISCOUNT)
    ratios = damping_at_steps(kinetic, (2e-3, 1e-3, 1e-4))
    return (
        f"What does gg = {DISCOUNT:g} do?",
        f"The kinetic damping gg @hatzor2004 removes {100 * (1 - DISCOUNT):.0f}\u00a0% of the velocity in each step, "
        f"not in each second: alone, under average acceleration, it damps the first mode by {ratios} of critical; hold "
        "the rate instead, gg = exp(−c dt) (decision 3).",
    )


def damping_at_steps(scene: Scene, steps: Iterable[float]) -> str:
    """Return the damping ratio of the first axial mode at some steps [s], ``1.2 % at 2 ms, 2.5 % at 1 ms``."""
    ratios = {step: closed.first_damping(closed.timed(scene, step=step)) for step in steps}
    return ", ".join(f"{percent(xi)} at {milliseconds(step)}" for step, xi in ratios.items())


def beware(groups: Groups) -> tuple[str, str] | None:
    """Say what must not be believed: agreement at a long step, a contact that is always closed, the frequency."""
    rows = _model_form(groups)
    if not rows:
        return None
    longest, agreement, _ = rows[0]
    time_error = groups["model-form"].number_of_pair(longest, "bar", "continuum", "displacement.l2")
    both_off = "" if time_error is None else f", while both are {percent(time_error)} off the continuum"
    minima = [value for case, _, _ in rows if (value := case.number("dda", "pressure.minimum")) is not None]
    stiffer = [closed.stiffer(longest.scene, ratio) for ratio in STIFFNESSES]
    excesses = [spectra.dda_frequency(s) / spectra.bar_frequency(s) - 1 for s in stiffer]
    return (
        "What should I not trust?",
        f"The agreement at a long step: {percent(agreement)} at {milliseconds(longest.scene.time.step)}, because both "
        f"are damped out{both_off}; a locked contact that looks closed (it pulls with {plain(-min(minima) / 1e6, 3)} "
        f"MPa in DDA); and the first frequency: one strain makes the natural one {percent(min(excesses))} to "
        f"{percent(max(excesses))} too high from p = {STIFFNESSES[0]:g}E to {STIFFNESSES[-1]:g}E (softer springs "
        f"less), and the step lowers it: {_stepped_frequencies(longest.scene)} against the exact one at "
        f"p = {closed.ratio_of(longest.scene):g}E.",
    )


def _stepped_frequencies(scene: Scene) -> str:
    """Say what the step makes of DDA's first frequency against the exact bar's, at a short and at a longer step."""
    parts = []
    for step in STEPS:
        excess = stepped_frequency(closed.timed(scene, step=step)) / spectra.bar_frequency(scene) - 1
        parts.append(f"{percent(abs(excess))} {'above' if excess > 0 else 'below'} at {milliseconds(step)}")
    return ", ".join(parts)


def stepped_frequency(scene: Scene) -> float:
    """Return the undamped frequency of DDA's first axial mode as stepped [rad/s]: |ln lambda| / dt."""
    root = spectra.roots(scene, spectra.dda_frequency(scene))[0]
    return abs(cmath.log(root)) / scene.time.step


# ---- the figure ---------------------------------------------------------------------------------------------------


def damping_and_error(groups: Groups, paper: Scene) -> list[ChartPanel]:
    """Return damping and error over the time step, the paper's steps marked."""
    orange = style_of("dda").color
    black = style_of("bar").color
    grid = np.geomspace(5e-5, 2e-2, 200)
    cases = by_step(groups.get(PAPER))
    marks = {f"{1e3 * case.scene.time.step:g}": 1e3 * case.scene.time.step for case in cases}
    measured = [(1e3 * case.scene.time.step, case.number("dda", "mode1.damping")) for case in cases]
    dots = np.array([(x, 100 * y) for x, y in measured if y is not None]).reshape(-1, 2).T
    axes: dict[str, Any] = {"x_range": (0.05, 20.0), "logarithmic": (True, True), "marks": marks}
    damping = ChartPanel(
        "Damping ratio of the first mode [%]",
        "time step dt [ms]",
        "",
        (
            ChartLine("DDA", 1e3 * grid, 100 * closed.over_steps(paper, grid), orange),
            ChartLine("", dots[0], dots[1], orange, width=0, dots=DOTS),
        ),
        y_range=(0.2, 100.0),
        levels={"5 %": 100 * TARGET_DAMPING},
        **axes,
    )
    errors = []
    for name, pair, color, dash in (
        ("DDA − bar", ("dda", "bar"), orange, ()),
        ("bar − continuum", ("bar", "continuum"), black, ()),
        ("DDA − continuum", ("dda", "continuum"), SETTINGS[0], DASHED),
    ):
        x, y = _errors(groups.get("model-form"), pair)
        if x.size:
            errors.append(ChartLine(name, x, 100 * y, color, dash, dots=DOTS))
    if not errors:
        return [damping]
    title = "Error of the displacement over 0.2 s [%]"
    return [damping, ChartPanel(title, "time step dt [ms]", "", errors, y_range=(0.2, 200.0), **axes)]


def _errors(group: CaseGroup | None, pair: tuple[str, str]) -> tuple[Array, Array]:
    """Return the steps [ms] of a group's cases, in rising order, and the relative L2 errors of a pair."""
    points = []
    for case in reversed(by_step(group)):
        value = group.number_of_pair(case, *pair, "displacement.l2") if group else None
        points += [] if value is None else [(1e3 * case.scene.time.step, value)]
    x, y = np.array(points).reshape(-1, 2).T
    return x, y


def damping_and_error_caption(groups: Groups, paper: Scene) -> str:
    """Return the figure's caption, which says what it shows."""
    rows = _model_form(groups)
    turn = closed.most_damped(closed.constant(paper))
    claim = (
        f"The longer the step (to ω₁ dt = {turn:.3g}, ω₁ the first circular frequency), the more it damps, and the "
        "better DDA seems to fit the bar"
    )
    if len(rows) > 1:
        claim += f": {percent(rows[-1][1])} at {milliseconds(rows[-1][0].scene.time.step)}, "
        claim += f"{percent(rows[0][1])} at {milliseconds(rows[0][0].scene.time.step)}"
    return (
        f"{claim}. What the step itself spoils grows instead. p = {closed.ratio_of(paper):g}E, constant acceleration. "
        "Line: closed form; dots: as run, right in relative L2; dashed: the paper's steps."
    )


def verdict_line(verdicts: Verdicts) -> Callout:
    """Return the one line of verdicts."""
    if not verdicts:
        return Callout("No gate was judged.", "warn")
    count = Counter(v["verdict"] for v in verdicts)
    gates = "gate" if len(verdicts) == 1 else "gates"
    outcomes = f"{count['PASS']} passed, {count['FAIL']} failed, {count['NOT RUN']} not run."
    text = f"{len(verdicts)} {gates}: {outcomes}"
    if count["FAIL"]:
        return Callout(text, "fail")
    if count["NOT RUN"]:
        return Callout(text, "warn")
    return Callout(text, "pass")
