"""The chapter of scenes, for `core` and for users' own: a page for each scene."""

from __future__ import annotations

import itertools
from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from validation.report.blocks import Block, Callout, Column, FigureBlock, Heading, PageBreak, Paragraph, Table
from validation.report.chapters.damping import alarm_blocks, budget_blocks
from validation.report.chapters.data import Case, Group, groups, varied_fields
from validation.report.chapters.gates import gate_table
from validation.report.chapters.ledger import METRICS
from validation.report.chapters.text import (
    AS_STATED,
    cell,
    load_size,
    parameters,
    percent,
    plain,
    span,
    word_notes,
)
from validation.report.figures import histories
from validation.report.figures.curves import COLUMNS, Panel
from validation.runs.history import DISPLACEMENT, PRESSURE
from validation.runs.records import Manifest, VerdictRecord
from validation.runs.results import Results
from validation.runs.row import Value
from validation.runs.run import Outcome
from validation.scenes import features
from validation.scenes.scene import Scene
from validation.solvers.contract import Role
from validation.solvers.registry import by_role

MOST_PANELS = 10
NOISE = 1e-9  # of the load; a smaller least pressure is rounding
_PREFIX = {DISPLACEMENT: "displacement", PRESSURE: "pressure"}


def scene_chapter(results: Results, manifest: Manifest, directory: Path) -> list[Block]:
    """Return the chapter of a study: its purpose, then a page for each scene."""
    blocks: list[Block] = [Heading(manifest.get("title") or manifest["study"])]
    if manifest.get("purpose"):
        blocks.append(Paragraph(manifest["purpose"]))
    for i, group in enumerate(groups(results, manifest)):
        blocks += [PageBreak()] * (i > 0) + scene_page(group, directory)
    return blocks


def scene_page(group: Group, directory: Path) -> list[Block]:
    """Return the page of one scene: data, conclusion, figures, damping, gates."""
    blocks: list[Block] = [
        Heading(group.title, 2),
        Paragraph(parameters(group.cases[0].scene, varied_fields(group)), "small"),
        Paragraph(conclusion(group)),
    ]
    blocks += outcomes(group)
    blocks += [_history_block(group, column, directory) for column in _columns(group)]
    if len(drift := drift_values(group)) > 1:
        blocks += _drift_blocks(group, drift, directory)
    first = group.cases[0].scene
    if any(_finished(case) for case in group.cases) and features.linear(first) and first.column is None:
        blocks += [Heading("Damping, settling and peaks", 3), damping_table(group)]
    blocks += [*alarm_blocks(group), *budget_blocks(group, directory)]
    if group.verdicts:
        blocks += [Heading("Gates", 3), gate_table(group.verdicts, {case.name: case.label for case in group.cases})]
    return blocks


# ---- sentences ----------------------------------------------------------------------------------------------------


def conclusion(group: Group) -> str:
    """Return one plain sentence on a scene, computed from its comparisons and verdicts."""
    parts = [_agreement(group), gate_count(group.verdicts)]
    if tension := _tension(group):
        parts.append(tension)
    if trend := _damped_agreement(group):
        parts.append(trend)
    text = "; ".join(part for part in parts if part)
    return text[:1].upper() + text[1:] + "."


def _agreement(group: Group) -> str:
    for reference in (*by_role(Role.REFERENCE), *by_role(Role.LIMIT)):
        said = []
        for metric, name in zip(METRICS, ("displacement", "contact pressure"), strict=True):
            if values := _pair_values(group, "dda", reference, metric):
                said.append(f"{span(values)} in {name}")
        if said:
            return f"against {reference}, dda differs by {' and '.join(said)} (relative L2)"
    return "no pair of solvers was compared"


def _pair_values(group: Group, solver: str, reference: str, metric: str) -> list[float]:
    found = [group.number_of_pair(case, solver, reference, metric) for case in group.cases]
    return [value for value in found if value is not None]


def gate_count(verdicts: Sequence[VerdictRecord]) -> str:
    """Return how many gates pass, fail or did not run, as part of a sentence."""
    count = Counter(v["verdict"] for v in verdicts)
    if not verdicts:
        return "no gate judges this scene"
    if count["PASS"] == len(verdicts):
        return f"all {len(verdicts)} gates pass" if len(verdicts) > 1 else "its one gate passes"
    verb = "fails" if count["FAIL"] == 1 else "fail"
    said = [f"{count['FAIL']} of {len(verdicts)} gates {verb}"] * bool(count["FAIL"])
    return " and ".join(said + [f"{count['NOT RUN']} did not run"] * bool(count["NOT RUN"]))


def _tension(group: Group) -> str:
    """Say where a locked contact hides tension."""
    pulled: dict[str, float] = {}
    for solver in group.solvers:
        values = [case.number(solver, "pressure.minimum") for case in group.cases]
        least = min((value for value in values if value is not None), default=0.0)
        if least < -1e-6 * load_size(group.cases[0].scene):
            pulled[solver] = least
    if not pulled:
        return ""
    named = [s for s in ("dda", "bar", "fem") if s in pulled][:2] or list(pulled)[:2]
    deepest = " and ".join(f"{plain(pulled[solver] / 1e6, 3)} MPa in {solver}" for solver in named)
    return f"the locked contact hides tension, down to {deepest}"


def _damped_agreement(group: Group) -> str:
    """Warn where the agreement grows with the damping, since agreement alone then rewards the worse run."""
    pairs = []
    for case in group.cases:
        xi, error = case.number("dda", "mode1.damping"), group.number_of_pair(case, "dda", "bar", METRICS[0])
        if xi is not None and error is not None:
            pairs.append((xi, error))
    pairs.sort()
    falls = all(a[0] < b[0] and a[1] > b[1] for a, b in itertools.pairwise(pairs))
    if len(pairs) < 3 or not falls:
        return ""
    least, most = (f"{percent(error)} at ξ₁ = {100 * xi:.2f}\u00a0%" for xi, error in (pairs[0], pairs[-1]))
    return f"the difference falls as the damping grows, from {least} to {most}: both are damped, which is no merit"


def outcomes(group: Group) -> list[Block]:
    """Name every outcome other than completed, with its sentence; cases that share it share a line."""
    said: dict[tuple[str, Outcome, tuple[str, ...]], list[str]] = {}
    for case in group.cases:
        for solver, row in case.rows.items():
            if row.outcome is not Outcome.COMPLETED:
                said.setdefault((solver, row.outcome, row.notes), []).append(case.label)
    return [
        Callout(f"{solver}{_where(labels)}: {outcome}. {outcome.sentence} {'; '.join(notes)}".strip(), "warn")
        for (solver, outcome, notes), labels in said.items()
    ]


def _where(labels: Sequence[str]) -> str:
    return "" if list(labels) == [AS_STATED] else f" at {'; '.join(labels)}"


# ---- figures ------------------------------------------------------------------------------------------------------


def _columns(group: Group) -> list[str]:
    """Return the columns that some solver reports, displacement and contact pressure first."""
    kept: set[str] = set()
    for case in group.cases:
        kept.update(*(history.columns for history in case.histories.values()))
    return sorted(kept, key=lambda name: (name not in COLUMNS, [*COLUMNS, name].index(name), name))


def _history_block(group: Group, column: str, directory: Path) -> FigureBlock:
    shown = [group.cases[i] for i in np.unique(np.linspace(0, len(group.cases) - 1, MOST_PANELS).round().astype(int))]
    window = min(_ends(shown), default=0.0)  # cases of one figure are compared over the same time
    panels = [_panel(case, column, window) for case in shown]
    name = COLUMNS.get(column, (column,))[0]
    less = "" if len(shown) == len(group.cases) else f" ({len(shown)} of {len(group.cases)} cases)"
    cut = max(_ends(shown), default=0.0) > window * 1.001
    span = f"The first {plain(window, 3)} s, the time that all cases run." if cut else ""
    caption = _history_caption(panels) if column == DISPLACEMENT else ""
    file = f"{group.slug}-{column.replace('_', '-')}.svg"
    said = " ".join(f"{name}{less}. {span} {caption}".split())
    return histories.saved(histories.history_figure(panels, column), directory, file, said)


def _ends(cases: Sequence[Case]) -> list[float]:
    """Return the last instant of every history [s]."""
    ends = []
    for case in cases:
        ends += [float(history.time[-1]) for history in case.histories.values() if len(history.time)]
    return ends


def _history_caption(panels: Sequence[Panel]) -> str:
    said = ["The hairline is the static value."] if any(p.static is not None for p in panels) else []
    references = list(dict.fromkeys(p.reference for p in panels if p.reference and len(p.histories) > 1))
    if references:
        said.append(f"Below: difference Δ from {' or '.join(references)}, the largest in each fortieth of the time.")
    return " ".join(said)


def _panel(case: Case, column: str, window: float) -> Panel:
    shown = {s: h.until(window) for s, h in case.histories.items() if column in h.columns}
    reference = case.reference if case.reference in shown else None
    metric = f"{_PREFIX.get(column, column)}.static"
    known = [case.number(solver, metric) for solver in (reference or "", "dda", *shown)]
    title = "" if case.label == AS_STATED else case.label
    return Panel(title, shown, next((v for v in known if v is not None), None), reference)


def drift_values(group: Group) -> list[tuple[int, float]]:
    """Return elements a side and static displacement [m] of fem on corner point springs, where meshes vary."""
    cases = [case for case in group.cases if case.scene.fem.foundation == "corner" and case.scene.fem.mesh is None]
    found = {case.scene.fem.per_side: case.number("fem", "displacement.static") for case in cases}
    return sorted((n, v) for n, v in found.items() if v is not None)


def _drift_blocks(group: Group, drift: Sequence[tuple[int, float]], directory: Path) -> list[Block]:
    n, v = np.array([float(n) for n, _ in drift]), np.array([v for _, v in drift])
    slope = float(np.polyfit(np.log2(n), v, 1)[0])
    dda = group.cases[0].number("dda", "displacement.static")
    note = f": {plain(1e3 * slope, 3)} mm per doubling of n"
    figure = histories.line_figure(
        [histories.Line("fem", n, 1e3 * v, note)],
        "Elements a side n",
        "Static displacement [mm]",
        {} if dda is None else {"dda": 1e3 * dda},
        log2_x=True,
    )
    caption = "Static displacement on corner point springs over the mesh, with the fitted slope."
    return [
        histories.saved(figure, directory, f"{group.slug}-drift.svg", caption),
        Callout(
            f"On corner point springs the static displacement changes by {plain(1e3 * slope, 3)} mm with every "
            "halving of the mesh and has no limit: a point force moves its own point of an elastic body "
            'infinitely. The cure is foundation = "distributed" or "patch".',
            "warn",
        ),
    ]


# ---- tables -------------------------------------------------------------------------------------------------------


@dataclass(frozen=True)
class Measure:
    """A column of the damping table: titles, metric, factor and decimals (four digits where None)."""

    title: str
    over: str
    metric: str
    factor: float = 1.0
    decimals: int | None = None


_MEASURES = (
    Measure("model", "ω₁ [rad/s]", "mode1.frequency"),
    Measure("operator", "ω₁ [rad/s]", "mode1.numerical_frequency"),
    Measure("history", "ω₁ [rad/s]", "mode1.measured_frequency"),
    Measure("operator", "ξ₁ [%]", "mode1.damping", 100.0, 3),
    Measure("history", "ξ₁ [%]", "mode1.measured_damping", 100.0, 3),
    Measure("", "|λ₁|", "mode1.spectral_radius", 1.0, 4),
    Measure("displ.", "Settling step", "displacement.settling_step", 1.0, 0),
    Measure("press.", "Settling step", "pressure.settling_step", 1.0, 0),
    Measure("mm", "First peak", "displacement.peak", 1e3),
    Measure("MPa", "First peak", "pressure.peak", 1e-6),
    Measure("MPa", "Least press.", "pressure.minimum", 1e-6),
)


LONG_LABEL = 18  # letters; a longer label takes a line of its own above its solvers


def damping_table(group: Group) -> Table:
    """Return frequency and damping of the first axial mode, settling steps and peaks per case and solver."""
    long = any(len(case.label) > LONG_LABEL for case in group.cases)
    rows: list[tuple[str, ...]] = []
    for case in group.cases:
        rows += [(case.label,)] if long else []
        for i, solver in enumerate(_finished(case)):
            values = (_measured(m, case.rows[solver].metrics.get(m.metric), case.scene) for m in _MEASURES)
            rows.append((*(() if long else (case.label if i == 0 else "",)), solver, *values))
    titles = (Column("Solver"), *(Column(m.title, "decimal", m.over) for m in _MEASURES))
    measured: list[Value] = []
    for case in group.cases:
        for row in case.rows.values():
            measured += [row.metrics.get(m.metric) for m in _MEASURES]
    shown = titles if long else (Column("Case"), *titles)
    return Table(shown, tuple(rows), notes=word_notes(measured), ruled=not long)


def _finished(case: Case) -> list[str]:
    return [solver for solver, row in case.rows.items() if row.metrics]


def _measured(measure: Measure, value: Value, scene: Scene) -> str:
    if not isinstance(value, int | float):
        return cell(value)
    if measure.decimals is None:
        noise = NOISE * load_size(scene) if measure.metric == "pressure.minimum" else 0.0
        return cell(value if abs(value) > noise else 0.0, measure.factor)
    return f"{round(value * measure.factor, measure.decimals) + 0.0:.{measure.decimals}f}".replace("-", "−")
