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
from validation.report.chapters.described import Description
from validation.report.chapters.gates import window
from validation.report.figures import histories
from validation.report.figures.charts import DASHED, DOTS, SETTINGS, ChartLine, ChartPanel
from validation.report.figures.curves import style_of
from validation.report.figures.model import model_figure
from validation.report.front import closed
from validation.report.front.groups import PAPER, at_ratio, by_step, case_where
from validation.runs.history import Array
from validation.scenes.scene import Scene
from validation.theory import spectra

PAGE = Description(__file__)
TARGET_DAMPING = 0.05  # damping ratio that the answer names a time step for
STIFF = 100.0  # p/E of the answer on stiff springs
STIFFNESSES = (1.0, 10.0, 100.0)  # p/E for which the first frequency is given
STEPS = (2e-3, 5e-3)  # s, steps for which it is given as stepped
DISCOUNT = 0.98
COUNTS = ("no", "one", "two", "three", "four", "five")
SETTLED = 1e-3  # a pressure at rest within this of the load is the load
Answer = tuple[str, str]  # a question, and what is answered


def first_page(groups: Groups, paper: Scene, verdicts: Verdicts, directory: Path) -> Blocks:
    """Return the blocks of the first page."""
    model = model_figure(f"a = {paper.block.side or 0:g} m", f"q = {paper.load.pressure / 1e6:g} MPa")
    drawing = histories.saved(model, directory, "model.svg", "")
    answers = [*filter(None, (force(groups), steps(groups, paper), springs(groups), discount(paper), beware(groups)))]
    tested = PAGE.text("model", block=paper.block, gigapascals=paper.block.young / 1e9)
    beside = (Heading("What was tested", 3), Paragraph(tested), Paragraph(PAGE.text("compared")))
    panels = damping_and_error(groups, paper)
    return [
        Beside((drawing,), beside, 0.42),
        Heading(f"The answer in {COUNTS[len(answers)]} sentences", 3),
        Points(tuple(answers)),
        PAGE.figure("first", panels, directory, whole_caption=damping_and_error_caption(groups, paper)),
        verdict_line(verdicts),
    ]


def _answer(name: str, **values: Any) -> Answer:
    return PAGE.text(f"{name}-question", **values), PAGE.text(name, **values)


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


def force(groups: Groups) -> Answer | None:
    """Say whether DDA's contact force is right: at rest, and on the way there.

    The first peak leads, which no window changes. A relative L2 difference is mostly one of phase where little is
    damped, and grows with the time over which it is taken.
    """
    rows = _model_form(groups)
    if not rows:
        return None
    scene = rows[0][0].scene
    pressure = scene.load.pressure
    static_pressures = [case.number("dda", "pressure.static") for case, _, _ in rows]
    is_load = all(value is not None and abs(value / pressure - 1) < SETTLED for value in static_pressures)
    peaks = [(peak_excess(case), case.scene.time.step) for case, _, _ in rows]
    peaks = [peak for peak in peaks if peak[0] is not None]
    shortest = rows[-1][0]
    return _answer(
        "force",
        at_rest=PAGE.text("rest-yes" if is_load else "rest-no", pressure=pressure / 1e6),
        peaks=PAGE.text("peaks", peaks=PAGE.listed("peak", peaks)) if peaks else "",
        ratio=closed.ratio_of(scene),
        step=shortest.scene.time.step,
        windows=PAGE.listed("window", sorted(_windows(groups["model-form"], shortest, rows[-1][2]))),
    )


def peak_excess(case: CaseResults) -> float | None:
    """Return by how much DDA's first peak of the contact pressure is above the bar's, under the same steps [1]."""
    dda, bar = (case.number(solver, "pressure.peak") for solver in ("dda", "bar"))
    return None if dda is None or not bar else dda / bar - 1


def _windows(group: CaseGroup, case: CaseResults, pressure_error: float) -> list[tuple[float, float]]:
    """Return the windows [s] that the pressure of a case is judged over, or its duration, with the relative L2."""
    errors: list[tuple[float, float]] = []
    duration = case.scene.time.duration
    for verdict in group.verdicts:
        subject = (verdict["scene"], tuple(verdict["pair"]), verdict["metric"])
        value = verdict["value"]
        if subject == (case.name, ("dda", "bar"), "pressure.l2") and isinstance(value, int | float):
            until = window(verdict)
            errors.append((float(until.removesuffix("s")) if until else duration, float(value)))
    return errors if len(errors) > 1 else [(duration, pressure_error)]


def steps(groups: Groups, paper: Scene) -> Answer:
    """Say that the time step is the damping, and which one gives 5 %."""
    measured = [(case.number("dda", "mode1.damping"), case.scene.time.step) for case in by_step(groups.get(PAPER))]
    step = closed.step_for(paper, TARGET_DAMPING)
    return _answer(
        "steps",
        measured=PAGE.listed("ratio-at-step", (one for one in measured if one[0] is not None)),
        ratio=closed.ratio_of(paper),
        advice=PAGE.text("step-for", percent=100 * TARGET_DAMPING, step=step) if step else "see decision 1",
    )


def springs(groups: Groups) -> Answer | None:
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
    if None in settling_steps:
        return None
    constant = closed.constant(usual.scene)
    return _answer(
        "springs",
        usual=STIFF / 10,
        stiff=STIFF,
        share=closed.spring_share(constant),
        limit=closed.sign_change_step(constant),
        steps=settling_steps,
        radius=closed.contact_radius(stiff.scene),
        step=stiff.scene.time.step,
    )


def discount(paper: Scene) -> Answer:
    """Say what gg = 0.98 does."""
    ratios = damping_at_steps(closed.average(paper, DISCOUNT), (2e-3, 1e-3, 1e-4))
    return _answer("discount", gg=DISCOUNT, removed=100 * (1 - DISCOUNT), ratios=ratios)


def damping_at_steps(scene: Scene, steps: Iterable[float]) -> str:
    """Return the damping ratio of the first axial mode at some steps [s], ``1.2 % at 2 ms, 2.5 % at 1 ms``."""
    return PAGE.listed("ratio-at-step", ((closed.first_damping(closed.timed(scene, step=dt)), dt) for dt in steps))


def beware(groups: Groups) -> Answer | None:
    """Say what must not be believed: agreement at a long step, a contact that is always closed, the frequency."""
    rows = _model_form(groups)
    if not rows:
        return None
    longest, agreement, _ = rows[0]
    scene = longest.scene
    time_error = groups["model-form"].number_of_pair(longest, "bar", "continuum", "displacement.l2")
    minima = [value for case, _, _ in rows if (value := case.number("dda", "pressure.minimum")) is not None]
    stiffer = [closed.stiffer(scene, ratio) for ratio in STIFFNESSES]
    excesses = [spectra.dda_frequency(s) / spectra.bar_frequency(s) - 1 for s in stiffer]
    stepped = []
    for step in STEPS:
        excess = stepped_frequency(closed.timed(scene, step=step)) / spectra.bar_frequency(scene) - 1
        stepped.append((abs(excess), "above" if excess > 0 else "below", step))
    return _answer(
        "beware",
        agreement=agreement,
        step=scene.time.step,
        both_off="" if time_error is None else PAGE.text("both-off", error=time_error),
        pull=-min(minima) / 1e6,
        least=min(excesses),
        most=max(excesses),
        softest=STIFFNESSES[0],
        stiffest=STIFFNESSES[-1],
        stepped=PAGE.listed("stepped", stepped),
        ratio=closed.ratio_of(scene),
    )


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
    damping = (
        ChartLine("DDA", 1e3 * grid, 100 * closed.over_steps(paper, grid), orange),
        ChartLine("", dots[0], dots[1], orange, width=0, dots=DOTS),
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
    lines_by_panel = {"damping": damping, "error": errors}
    return [PAGE.panel(name, lines, marks=marks) for name, lines in lines_by_panel.items() if lines]


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
    fits = PAGE.text("fits", short=rows[-1], long=rows[0]) if len(rows) > 1 else ""
    turn = closed.most_damped(closed.constant(paper))
    return PAGE.text("caption", turn=turn, fits=fits, ratio=closed.ratio_of(paper))


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
