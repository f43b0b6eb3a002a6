"""The first page: the model, the answer in five sentences, the figure that carries it, one line of verdicts."""

from __future__ import annotations

import cmath
from collections import Counter
from collections.abc import Sequence
from pathlib import Path

import numpy as np

from validation.gates import closed_forms
from validation.report.blocks import Beside, Block, Callout, Heading, Paragraph, Part, Points
from validation.report.chapters.data import Case
from validation.report.chapters.text import percent, plain, short
from validation.report.figures import histories
from validation.report.figures.curves import style_of
from validation.report.figures.front.charts import CHOICES, DASHED, Chart, Stroke, charts_figure
from validation.report.figures.front.model import model_figure
from validation.report.front import closed
from validation.report.front.found import Found, at_ratio, by_step, case_where, milliseconds
from validation.runs.history import Array
from validation.runs.records import VerdictRecord
from validation.scenes.scene import Scene

WANTED = 0.05  # damping ratio that the answer names a time step for
STIFF = 100.0  # p/E of the answer on stiff springs
STIFFNESSES = (1.0, 10.0, 100.0)  # p/E of which the first frequency is told
STEPPED = (2e-3, 5e-3)  # s, steps of which it is told as stepped
DISCOUNT = 0.98
SETTLED = 1e-3  # a pressure at rest within this of the load is the load


def first_page(found: Found, paper: Scene, verdicts: Sequence[VerdictRecord], directory: Path) -> list[Part]:
    """Return the blocks of the first page."""
    words = f"a = {paper.block.side or 0:g} m", f"q = {paper.load.pressure / 1e6:g} MPa"
    drawing = histories.saved(model_figure(*words), directory, "model.svg", "")
    said = [
        point for point in (force(found), steps(found, paper), springs(found), discount(paper), beware(found)) if point
    ]
    return [
        Beside((drawing,), (Heading("What was tested", 3), *tested(paper)), 0.42),
        Heading("The answer in five sentences", 3),
        Points(tuple(said)),
        histories.saved(
            charts_figure(carrying(found, paper), 37.0), directory, "first.svg", carrying_caption(found, paper)
        ),
        verdict_line(verdicts),
    ]


def tested(paper: Scene) -> list[Block]:
    """Return what stands beside the drawing."""
    block = paper.block
    return [
        Paragraph(
            f"An elastic square A ({block.density:g} kg/m³, E = {short(block.young / 1e9)} GPa, μ = {block.poisson:g}) "
            "stands on a fixed block B. Springs lock the corners M and N, p [N/m] each way, and a pressure on "
            "the top is there from t = 0 on. DDA gives the block six unknowns: u, v and r of its centroid and one "
            "strain εx, εy, γxy. Reported are v of the centroid and the contact pressure on the base."
        ),
        Paragraph(
            "It is compared with the same block in finite elements (fem), as a bar that is exact in space and takes "
            "the same time steps (bar), and as one exact in space and time (continuum). DDA differs from the bar by "
            "its model, the bar from the continuum by the time step."
        ),
    ]


# ---- five sentences -----------------------------------------------------------------------------------------------


def _model_form(found: Found) -> list[tuple[Case, float, float]]:
    """Return the cases over one fixed time with the pressure's model form and the displacement's."""
    group, kept = found.get("model-form"), list[tuple[Case, float, float]]()
    if group is None:
        return kept
    for case in by_step(group):
        v, p = (group.number_of_pair(case, "dda", "bar", f"{name}.l2") for name in ("displacement", "pressure"))
        kept += [] if v is None or p is None else [(case, v, p)]
    return kept


def force(found: Found) -> tuple[str, str] | None:
    """Say whether DDA's contact force is right: at rest, and on the way there.

    The first peak leads, which no window changes. A relative L2 difference is mostly one of phase where little is
    damped, and grows with the time over which it is taken.
    """
    rows = _model_form(found)
    if not rows:
        return None
    scene = rows[0][0].scene
    rests = [case.number("dda", "pressure.static") for case, _, _ in rows]
    right = all(value is not None and abs(value / scene.load.pressure - 1) < SETTLED for value in rests)
    at_rest = f"every run tends to {scene.load.pressure / 1e6:g} MPa" if right else "not every run tends to the load"
    peaks = []
    for case, _, _ in rows:
        if (excess := peak_excess(case)) is not None:
            sign = "+" if excess >= 0 else "−"
            peaks.append(f"{sign}{percent(abs(excess))} at {milliseconds(case.scene.time.step)}")
    during = f"during the motion no: against the bar under the same steps its first peak is off by {', '.join(peaks)}"
    return (
        "Is DDA's force right?",
        f"At rest {'yes' if right else 'no'}: {at_rest}; {during if peaks else 'during the motion no'} "
        f"(p = {closed.ratio_of(scene):g}E): one strain in place of a wave, which the damping of a long step hides."
        f"{_windows(found, rows[-1])}",
    )


def peak_excess(case: Case) -> float | None:
    """Return by how much DDA's first peak of the contact pressure is above the bar's, under the same steps [1]."""
    own, bar = (case.number(solver, "pressure.peak") for solver in ("dda", "bar"))
    return None if own is None or not bar else own / bar - 1


def _windows(found: Found, shortest: tuple[Case, float, float]) -> str:
    """Say how a relative L2 difference of the pressure grows with its window, at the shortest step."""
    case, _, whole = shortest
    over: list[tuple[float, float]] = []
    for verdict in found["model-form"].verdicts:
        gated = (verdict["scene"], tuple(verdict["pair"]), verdict["metric"])
        value = verdict["value"]
        if gated == (case.name, ("dda", "bar"), "pressure.l2") and isinstance(value, int | float):
            over.append((_window_of(verdict["id"]) or _length(case.scene), float(value)))
    spoken = [f"{percent(value)} over {short(seconds)} s" for seconds, value in sorted(over)]
    if len(spoken) < 2:
        spoken = [f"{percent(whole)} over {short(_length(case.scene))} s"]
    return (
        f" A relative L2 difference is mostly phase and grows with its window: at "
        f"{milliseconds(case.scene.time.step)} {', '.join(spoken)}."
    )


def _window_of(gate: str) -> float | None:
    """Return the time up to which a gate compares [s], which its id ends with; None where it takes the whole run."""
    seconds = gate.rpartition("@")[2]
    return float(seconds.removesuffix("s")) if "@" in gate else None


def _length(scene: Scene) -> float:
    return scene.time.step * scene.time.steps


def steps(found: Found, paper: Scene) -> tuple[str, str]:
    """Say that the time step is the damping, and which one gives 5 %."""
    measured = []
    for case in by_step(found.get(paper.name.partition("[")[0])):
        if (xi := case.number("dda", "mode1.damping")) is not None:
            measured.append(f"{percent(xi)} at {milliseconds(case.scene.time.step)}")
    wanted = closed.step_for(paper, WANTED)
    take = (
        f"for {100 * WANTED:g}\u00a0% take dt = {1e3 * wanted:.3g}\u00a0ms (decision 1)" if wanted else "see decision 1"
    )
    return (
        "Which time step?",
        f"The step is the damping: constant acceleration, in DDA's usage (1/2, 1) (texts on finite elements mean "
        f"(1/4, 1/2)), damps the first mode by {', '.join(measured)} of "
        f"critical at p = {closed.ratio_of(paper):g}E; {take}.",
    )


def springs(found: Found) -> tuple[str, str] | None:
    """Say what happens at p = 100E."""
    usual, stiff = (case_where(found.get("figures-5-6"), at_ratio(ratio)) for ratio in (STIFF / 10, STIFF))
    if usual is None or stiff is None:
        return None
    fine = [stiff.number("dda", f"{name}.fine_settling_step") for name in ("displacement", "pressure")]
    settled = [case.number("dda", "displacement.settling_step") for case in (usual, stiff)]
    if None in (*fine, *settled):
        return None
    numbers = [float(value or 0) for value in (*settled, *fine)]
    radius = closed.contact_radius(stiff.scene)
    soft = closed.timed(usual.scene, alpha=0.5, delta=1.0, gg=1.0)
    return (
        "Which springs?",
        f"About p = {STIFF / 10:g}E for a locked square block: the springs then add {percent(closed.given_way(soft))} "
        "to what it shortens by itself; their force flips sign each step only beyond "
        f"dt = {milliseconds(closed.flips_beyond(soft))}. At p = {STIFF:g}E the displacement hardly changes (settled "
        f"within 1\u00a0% after {numbers[1]:.0f} steps instead of {numbers[0]:.0f}), but the contact rings: it flips "
        f"sign each step and keeps {percent(radius)} of its swing, so that the pressure needs {numbers[3]:.0f} steps "
        f"to come within 0.01\u00a0% of rest and the displacement {numbers[2]:.0f}, at "
        f"dt = {milliseconds(stiff.scene.time.step)} (decision 2).",
    )


def discount(paper: Scene) -> tuple[str, str]:
    """Say what gg = 0.98 does."""
    kinetic = closed.timed(paper, alpha=0.25, delta=0.5, gg=DISCOUNT)
    spoken = []
    for step in (2e-3, 1e-3, 1e-4):
        xi = closed.first_damping(closed.timed(kinetic, step=step))
        spoken.append(f"{percent(xi)} at {milliseconds(step)}")
    return (
        f"What does gg = {DISCOUNT:g} do?",
        f"It removes {100 * (1 - DISCOUNT):.0f}\u00a0% of the velocity in each step, not in each second: alone, under "
        f"average acceleration, it damps the first mode by {', '.join(spoken)} of critical; hold "
        "the rate instead, gg = exp(−c dt) (decision 3).",
    )


def beware(found: Found) -> tuple[str, str] | None:
    """Say what must not be believed: agreement at a long step, a contact that is always closed, the frequency."""
    rows = _model_form(found)
    if not rows:
        return None
    (longest, agreed, _), group = rows[0], found["model-form"]
    time = group.number_of_pair(longest, "bar", "continuum", "displacement.l2")
    pulls = [value for case, _, _ in rows if (value := case.number("dda", "pressure.minimum")) is not None]
    high = [closed_forms.dda_frequency(s) / closed_forms.bar_frequency(s) - 1 for s in _stiffnesses(longest.scene)]
    late = "" if time is None else f", while both are {percent(time)} off the continuum"
    return (
        "What should I not trust?",
        f"The agreement at a long step: {percent(agreed)} at {milliseconds(longest.scene.time.step)}, because both are "
        f"damped out{late}; a locked contact that looks closed (it pulls with {plain(-min(pulls) / 1e6, 3)} MPa in "
        f"DDA); and the first frequency: one strain makes the natural one {percent(min(high))} to "
        f"{percent(max(high))} too high from p = {STIFFNESSES[0]:g}E to {STIFFNESSES[-1]:g}E (softer springs less), "
        f"and the step lowers it: {_stepped(longest.scene)} against the exact one at "
        f"p = {closed.ratio_of(longest.scene):g}E.",
    )


def _stepped(scene: Scene) -> str:
    """Say what the step makes of DDA's first frequency against the exact bar's, at a short and at a longer step."""
    spoken = []
    for step in STEPPED:
        excess = stepped_frequency(closed.timed(scene, step=step)) / closed_forms.bar_frequency(scene) - 1
        spoken.append(f"{percent(abs(excess))} {'above' if excess > 0 else 'below'} at {milliseconds(step)}")
    return ", ".join(spoken)


def stepped_frequency(scene: Scene) -> float:
    """Return the undamped frequency of DDA's first axial mode as stepped [rad/s]: |ln lambda| / dt."""
    root = closed_forms.roots(scene, closed_forms.dda_frequency(scene))[0]
    return abs(cmath.log(root)) / scene.time.step


def _stiffnesses(scene: Scene) -> list[Scene]:
    return [closed.stiffer(scene, ratio) for ratio in STIFFNESSES]


# ---- the figure ---------------------------------------------------------------------------------------------------


def carrying(found: Found, paper: Scene) -> list[Chart]:
    """Return damping and error over the time step, the paper's steps marked."""
    orange, black = style_of("dda").color, style_of("bar").color
    grid = np.geomspace(5e-5, 2e-2, 200)
    own = by_step(found.get(paper.name.partition("[")[0]))
    marks = {f"{1e3 * case.scene.time.step:g}": 1e3 * case.scene.time.step for case in own}
    measured = [(1e3 * case.scene.time.step, case.number("dda", "mode1.damping")) for case in own]
    dots = np.array([(x, 100 * y) for x, y in measured if y is not None]).reshape(-1, 2).T
    axis, limits = "time step dt [ms]", (0.05, 20.0)
    damping = Chart(
        "Damping ratio of the first mode [%]",
        (axis, ""),
        (
            Stroke("DDA", 1e3 * grid, 100 * closed.over_steps(paper, grid), orange),
            Stroke("as run", dots[0], dots[1], orange, dots=True, line=False, named=False),
        ),
        limits,
        (0.2, 100.0),
        marks,
        {"5 %": 100 * WANTED},
    )
    errors = []
    group = found.get("model-form")
    for name, pair, color, dash in (
        ("DDA − bar", ("dda", "bar"), orange, ()),
        ("bar − continuum", ("bar", "continuum"), black, ()),
        ("DDA − continuum", ("dda", "continuum"), CHOICES[0], DASHED),
    ):
        x, y = _errors(found, pair)
        if group is not None and x.size:
            errors.append(Stroke(name, x, 100 * y, color, dash, dots=True))
    if not errors:
        return [damping]
    error = Chart("Error of the displacement over 0.2 s [%]", (axis, ""), errors, limits, (0.2, 200.0), marks)
    return [damping, error]


def _errors(found: Found, pair: tuple[str, str]) -> tuple[Array, Array]:
    group, points = found.get("model-form"), []
    for case in reversed(by_step(group)):
        value = group.number_of_pair(case, *pair, "displacement.l2") if group else None
        points += [] if value is None else [(1e3 * case.scene.time.step, value)]
    x, y = np.array(points).reshape(-1, 2).T
    return x, y


def carrying_caption(found: Found, paper: Scene) -> str:
    """Return the figure's caption, which says what it shows."""
    rows = _model_form(found)
    turn = closed.most_damped(closed.timed(paper, alpha=0.5, delta=1.0, gg=1.0))
    said = f"The longer the step (to ω₁ dt = {turn:.3g}), the more it damps, and the better DDA seems to fit the bar"
    if len(rows) > 1:
        said += f": {percent(rows[-1][1])} at {milliseconds(rows[-1][0].scene.time.step)}, "
        said += f"{percent(rows[0][1])} at {milliseconds(rows[0][0].scene.time.step)}"
    return (
        f"{said}. What the step itself spoils grows instead. p = {closed.ratio_of(paper):g}E, constant acceleration. "
        "Line: closed form; dots: as run, right in relative L2; dashed: the paper's steps."
    )


def verdict_line(verdicts: Sequence[VerdictRecord]) -> Callout:
    """Return the one line of verdicts."""
    count = Counter(v["verdict"] for v in verdicts)
    gates = "gate" if len(verdicts) == 1 else "gates"
    told = f"{count['PASS']} passed, {count['FAIL']} failed, {count['NOT RUN']} not run."
    words = f"{len(verdicts)} {gates}: {told}"
    if not verdicts:
        return Callout("No gate was judged.", "warn")
    return Callout(words, "fail" if count["FAIL"] else "warn" if count["NOT RUN"] else "pass")
