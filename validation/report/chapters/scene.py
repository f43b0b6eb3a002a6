"""The chapter of scenes, for `core` and for users' own: a page for each scene."""

from __future__ import annotations

import itertools
import math
from collections import Counter
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np

from validation.report.blocks import Block, Callout, FigureBlock, Heading, Paragraph
from validation.report.chapters.damping import budget_blocks, damping_table
from validation.report.chapters.data import Case, Group, groups
from validation.report.chapters.ledger import METRICS, ledger_blocks, parts_of
from validation.report.chapters.text import (
    AS_STATED,
    bounded,
    load_size,
    percent,
    plain,
    power,
    short,
    span,
)
from validation.report.figures import histories, motion
from validation.report.figures.curves import COLUMNS, Panel, differences
from validation.runs.history import DISPLACEMENT, PRESSURE, History
from validation.runs.records import Manifest, VerdictRecord
from validation.runs.results import Results
from validation.runs.run import Outcome
from validation.scenes import features
from validation.solvers.contract import Role
from validation.solvers.registry import by_role

MOST_PANELS = 10
FEW = 4  # scenes of a study; of more of them a figure holds the first column alone
CALM = 1.5  # times the time in which the slowest line settles
_PREFIX = {DISPLACEMENT: "displacement", PRESSURE: "pressure"}


def scene_chapter(results: Results, manifest: Manifest, directory: Path) -> list[Block]:
    """Return the chapter of a study: its question, then a section for each scene."""
    found = groups(results, manifest)
    blocks = opening(manifest)
    for group in found:
        shown = _columns(group)[:1] if len(found) > FEW else None
        blocks += scene_section(group, directory, shown, apart=len(found) == 1)
    blocks += ledger_blocks(found, manifest["study"], directory) if len(found) > 1 else []
    return [*blocks, *budget_blocks(found[0], directory)] if len(found) == 1 else blocks


def opening(manifest: Manifest, verdicts: Sequence[VerdictRecord] = (), lead: str = "", said: str = "") -> list[Block]:
    """Return what a chapter begins with: title, `lead`, and a paragraph of purpose, `said` and what the gates say."""
    counted = f"{gate_count(verdicts).capitalize()}." if verdicts else ""
    text = " ".join(filter(None, (manifest.get("purpose"), said, counted)))
    paragraphs = (Paragraph(lead, "lead"), Paragraph(text))
    return [Heading(manifest.get("title") or manifest["study"]), *(each for each in paragraphs if each.text)]


def scene_section(
    group: Group,
    directory: Path,
    shown: Sequence[str] | None = None,
    apart: bool = False,
    without: Sequence[str] = (),
) -> list[Block]:
    """Return the section of one scene: what was found, the figure that shows it, the numbers that matter.

    The figure holds the columns that are `shown`, all where none are named, of the solvers but those it is `without`,
    and where asked for how far they are apart.
    """
    blocks: list[Block] = [Heading(group.title, 2), Paragraph(conclusion(group)), *outcomes(group)]
    if columns := [name for name in _columns(group) if shown is None or name in shown]:
        blocks.append(history_block(group, columns, directory, apart, without))
    if len(drift := drift_values(group)) > 1:
        blocks += _drift_blocks(group, drift, directory)
    first = group.cases[0].scene
    if features.linear(first) and first.column is None and (table := damping_table(group)).rows:
        blocks.append(table)
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
    pairs = [("dda", reference) for reference in (*by_role(Role.REFERENCE), *by_role(Role.LIMIT))]
    others = [(pair["solver"], pair["reference"]) for pair in group.comparisons]  # of users' own solvers
    for solver, reference in dict.fromkeys((*pairs, *parts_of(group.cases[0]).values(), *others)):
        said = []
        for metric, name in zip(METRICS, ("displacement", "contact pressure"), strict=True):
            if values := _pair_values(group, solver, reference, metric):
                said.append(f"{span(values)} in {name}")
        if said:
            over = _windows(group, solver, reference)
            return f"against {reference}, {solver} differs by {' and '.join(said)} (relative L2{over})"
    return "no pair of solvers was compared"


def _windows(group: Group, solver: str, reference: str) -> str:
    """Return over which time a pair was compared, of which a relative L2 difference of undamped motions depends."""
    own = [pair for pair in group.comparisons if {pair["solver"], pair["reference"]} == {solver, reference}]
    longest = [max(float(pair.get("window") or 0.0) for pair in own if pair["scene"] == c.name) for c in group.cases
               if any(pair["scene"] == c.name for pair in own)]  # fmt: skip
    if not longest or min(longest) <= 0:
        return ""
    low, high = min(longest), max(longest)
    return f" over {short(low)}\u00a0s" if high <= low * 1.001 else f", {short(low)} to {short(high)}\u00a0s"


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
    if len(verdicts) == 1:
        return "its one gate " + ("fails" if count["FAIL"] else "did not run")
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
    trend = f"the difference falls as the damping grows, from {least} to {most}"
    return f"{trend}: both are damped, which is no sign of accuracy"


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


def history_block(
    group: Group, columns: Sequence[str], directory: Path, apart: bool = False, without: Sequence[str] = ()
) -> FigureBlock:
    """Draw columns of a scene's cases over the time that all of them run, and return the figure with its caption."""
    shown = [group.cases[i] for i in np.unique(np.linspace(0, len(group.cases) - 1, MOST_PANELS).round().astype(int))]
    window = min(_ends(shown), default=0.0)  # cases of one figure are compared over the same time
    calm = _calm(shown, columns, without)
    said = []
    if len(shown) < len(group.cases):
        said.append(f"{len(shown)} of {len(group.cases)} cases.")
    if calm < window:
        window = calm
        said.append(f"The first {plain(window, 2)} s; all have settled to 1\u00a0% by then.")
    elif max(_ends(shown), default=0.0) > window * 1.001:
        said.append(f"The first {plain(window, 3)} s, the time that all cases run.")
    panels = [_panel(case, columns, window, without, _finer(case, group.cases)) for case in shown]
    said += [sentence for sentence in (_on_one(panels, columns), *_reading(panels, columns, apart)) if sentence]
    file = f"{group.slug}-history.svg"
    return histories.saved(motion.history_figure(panels, *columns, apart=apart), directory, file, " ".join(said))


def _ends(cases: Sequence[Case]) -> list[float]:
    """Return the last instant of every history [s]."""
    ends = []
    for case in cases:
        ends += [float(history.time[-1]) for history in case.histories.values() if len(history.time)]
    return ends


def _calm(cases: Sequence[Case], columns: Sequence[str], without: Sequence[str]) -> float:
    """Return a time [s] by which every drawn line has long settled, and which is worth to end at; else infinity."""
    latest = 0.0
    for case in cases:
        for solver in set(case.histories) - set(without):
            for column in columns:
                step = case.number(solver, f"{_PREFIX.get(column, column)}.settling_step")
                latest = max(latest, math.inf if step is None else step * case.scene.time.step)
    return CALM * latest


def _on_one(panels: Sequence[Panel], columns: Sequence[str]) -> str:
    """Name the lines that lie on one another, and how far off they are at most."""
    said = []
    for name, others in motion.twins(panels, columns).items():
        said += [f"{other} lies on {name} (within {bounded(off, power(off))})" for other, off in others.items()]
    return f"{', '.join(said)}." if said else ""


def _reading(panels: Sequence[Panel], columns: Sequence[str], apart: bool) -> list[str]:
    """Say how the figure is read, as far as it is not written on it."""
    said = []
    if span := motion.start_of(panels, columns[0]):
        said.append(f"Oscillations too dense to draw are the band that they fill; below, the first {plain(span, 2)} s.")
    if any(panel.static for panel in panels):
        said.append("Hairline: static value.")
    sparse = {name for panel in panels for name in panel.sparse(columns)}
    if sparse:
        said.append(f"Dots: {' and '.join(sorted(sparse))} at the steps, too few to be joined.")
    references = dict.fromkeys(p.reference for p in panels if p.reference and differences(p, columns[0]))
    if references and apart:
        said.append(f"|Δ|: from {' or '.join(map(str, references))}, the largest in each fortieth of the time.")
    return said


def _finer(case: Case, cases: Sequence[Case]) -> dict[str, History]:
    """Return the exact solutions of a case at the most instants that a case of the same motion has.

    They do not depend on the step: cases that differ in it alone have one exact motion, which few instants show as a
    zigzag.
    """
    finer: dict[str, History] = {}
    for solver in (*by_role(Role.TRUTH), *by_role(Role.LIMIT)):
        own = case.histories.get(solver)
        same = [other for other in cases if solver in other.histories and _motion_of(other) == _motion_of(case)]
        finest = min(same, key=lambda other: other.scene.time.step, default=case)
        if own is not None and finest.scene.time.step < case.scene.time.step:
            finer[solver] = finest.histories[solver]
    return finer


def _motion_of(case: Case) -> dict[str, Any]:
    """Return the definition of a case without its steps."""
    definition = {name: table for name, table in case.scene.definition().items() if name not in ("name", "title")}
    time = {key: value for key, value in definition["time"].items() if key not in ("step", "steps")}
    return definition | {"time": time}


def _panel(
    case: Case, columns: Sequence[str], window: float, without: Sequence[str], finer: Mapping[str, History]
) -> Panel:
    some = {s: h for s, h in case.histories.items() if s not in without and set(columns) & set(h.columns)}
    shown = {s: h.until(window) for s, h in some.items()}
    reference = case.reference if case.reference in shown else None
    static = {}
    for column in columns:
        metric = f"{_PREFIX.get(column, column)}.static"
        known = [case.number(solver, metric) for solver in (reference or "", "dda", *shown)]
        if (value := next((v for v in known if v is not None), None)) is not None:
            static[column] = value
    more = {solver: history.until(window) for solver, history in finer.items() if solver in shown}
    return Panel("" if case.label == AS_STATED else case.label, shown, static, reference, finer=more)


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
