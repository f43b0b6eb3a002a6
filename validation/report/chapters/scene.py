"""The chapter of scenes, for `core` and for users' own: a page for each scene."""

from __future__ import annotations

import itertools
import math
from collections import Counter
from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path

import numpy as np

from validation.advice.hooks import AdviceHooks
from validation.metrics.pairs import relative_l2
from validation.metrics.values import or_nan
from validation.report.blocks import Blocks, Callout, FigureBlock, Heading, Paragraph
from validation.report.chapters.budget import budget_blocks
from validation.report.chapters.damping import damping_table
from validation.report.chapters.data import CaseGroup, CaseResults, Verdicts, case_groups
from validation.report.chapters.ledger import METRICS, ledger_blocks, parts_of
from validation.report.chapters.summary import scene_summary
from validation.report.chapters.text import AS_STATED, capital, load_size, span
from validation.report.figures import histories, motion
from validation.report.figures.charts import Figure
from validation.report.figures.curves import HistoryPanel, HistoryPanels, differences, evenly
from validation.runs.columns import rank
from validation.runs.history import DISPLACEMENT, PRESSURE
from validation.runs.numbers import bounded, percent, plain, power, short
from validation.runs.records import Manifest
from validation.runs.results import Results
from validation.runs.run import Outcome
from validation.scenes import features
from validation.scenes.keys import is_fulfilled
from validation.solvers.contract import Role
from validation.solvers.registry import by_role, role
from validation.suite.folders import sources_of

MOST_PANELS = 10
FEW = 4  # scenes of a study; of more of them a figure holds the first column alone
CALM = 1.5  # times the time in which the slowest line settles
PERIODS = 5  # of the first mode, over which the figure that opens a page shows a free vibration
VISIBLE = 0.1  # relative difference that is seen on a page, while the motions are still seen to be the same one
FEWEST = 3  # steps that make a line
LEAD_COLUMNS = 2  # that this figure holds
LEAD_ROW = 30.0  # mm, height of a column in it
_PREFIX = {DISPLACEMENT: "displacement", PRESSURE: "pressure"}


def scene_chapter(results: Results, manifest: Manifest, directory: Path) -> Blocks:
    """Return the chapter of a study: its question, then a section for each scene; of one scene its page."""
    groups = case_groups(results, manifest)
    if len(groups) == 1:
        return scene_page(groups[0], directory)
    columns = [_columns(group)[:1] if len(groups) > FEW else None for group in groups]
    blocks = opening(manifest)
    for group, drawn in zip(groups, columns, strict=True):
        blocks += scene_section(group, directory, drawn)
    return [*blocks, *ledger_blocks(groups, manifest["study"], directory)]


def scene_page(group: CaseGroup, directory: Path) -> Blocks:
    """Return the page of a scene: finding, summary, the case that shows it best, all cases."""
    _, finding, *section = scene_section(group, directory, () if _is_shown_whole(group) else None)
    summary = scene_summary(group, directory)
    lead = lead_figure(group, directory)
    return [Heading(group.title), finding, *summary, *lead, *section, *budget_blocks(group, directory)]


def opening(manifest: Manifest, verdicts: Verdicts = (), lead: str = "", remark: str = "") -> Blocks:
    """Return title, `lead`, and a paragraph of purpose, `remark` and what the gates say."""
    gates = f"{gate_count(verdicts).capitalize()}." if verdicts else ""
    text = " ".join(filter(None, (manifest.get("purpose"), remark, gates)))
    sources = sources_of(manifest.get("study", ""))
    rests_on = f"Sources: {sources}" if sources else ""
    paragraphs = (Paragraph(lead, "lead"), Paragraph(text), Paragraph(rests_on, "small"))
    title = manifest.get("title") or manifest["study"]
    return [Heading(title), *(paragraph for paragraph in paragraphs if paragraph.text)]


def scene_section(
    group: CaseGroup,
    directory: Path,
    columns: Sequence[str] | None = None,
    without: Sequence[str] = (),
) -> Blocks:
    """Return the section of one scene: its finding in words, the figure that shows it, the numbers that matter.

    The figure holds `columns` of histories, by default all, `without` some solvers.
    """
    blocks = [Heading(group.title, 2), Paragraph(conclusion(group)), *outcomes(group)]
    drawn_columns = [name for name in _columns(group) if columns is None or name in columns]
    if drawn_columns:
        blocks.append(history_block(group, drawn_columns, directory, without))
    scene = group.cases[0].scene
    if features.linear(scene) and AdviceHooks.of(scene).has_budget:
        table = damping_table(group)
        blocks += [table] if table.rows else []
    return blocks


# ---- sentences ----


def conclusion(group: CaseGroup) -> str:
    """Return a sentence on a scene, from its comparisons and verdicts."""
    parts = (_agreement(group), gate_count(group.verdicts), _tension(group), _damped_agreement(group))
    text = "; ".join(part for part in parts if part)
    return f"{capital(text)}."


def _agreement(group: CaseGroup) -> str:
    pairs = [("dda", reference) for reference in (*by_role(Role.REFERENCE), *by_role(Role.LIMIT))]
    others = [(pair["solver"], pair["reference"]) for pair in group.comparisons]  # of users' own solvers
    for solver, reference in dict.fromkeys((*pairs, *parts_of(group.cases[0]).values(), *others)):
        differences_in_words = []
        for metric, name in zip(METRICS, ("displacement", "contact pressure"), strict=True):
            numbers = group.numbers_of_pair(solver, reference, metric)
            if numbers:
                differences_in_words.append(f"{span(numbers)} in {name}")
        if differences_in_words:
            text = " and ".join(differences_in_words)
            window = _windows(group, solver, reference)
            return f"against {reference}, {solver} differs by {text} (relative L2{window})"
    return "no pair of solvers was compared"


def _windows(group: CaseGroup, solver: str, reference: str) -> str:
    """Return over which time a pair was compared; a relative L2 difference of undamped motions depends on it."""
    compared = filter(None, (group.comparison(case, solver, reference) for case in group.cases))
    windows = [float(pair.get("window") or 0.0) for pair in compared]
    if not windows or min(windows) <= 0:
        return ""
    low = min(windows)
    high = max(windows)
    return f" over {short(low)}\u00a0s" if high <= low * 1.001 else f", {short(low)} to {short(high)}\u00a0s"


def gate_count(verdicts: Verdicts) -> str:
    """Return how many gates pass, fail or did not run."""
    count = Counter(v["verdict"] for v in verdicts)
    if not verdicts:
        return "no gate judges this scene"
    if count["PASS"] == len(verdicts):
        return f"all {len(verdicts)} gates pass" if len(verdicts) > 1 else "its one gate passes"
    if len(verdicts) == 1:
        return "its one gate fails" if count["FAIL"] else "its one gate did not run"
    parts = []
    if count["FAIL"]:
        verb = "fails" if count["FAIL"] == 1 else "fail"
        parts.append(f"{count['FAIL']} of {len(verdicts)} gates {verb}")
    if count["NOT RUN"]:
        parts.append(f"{count['NOT RUN']} did not run")
    return " and ".join(parts)


def _tension(group: CaseGroup) -> str:
    """Say where a locked contact hides tension."""
    tensions: dict[str, float] = {}
    for solver in group.solvers:
        minimum = min(group.numbers(solver, "pressure.minimum"), default=0.0)
        if minimum < -1e-6 * load_size(group.cases[0].scene):
            tensions[solver] = minimum
    if not tensions:
        return ""
    preferred: list[str] = [solver for solver in ("dda", "bar", "fem") if solver in tensions]
    solvers = preferred or list(tensions)
    deepest = " and ".join(f"{plain(tensions[solver] / 1e6, 3)} MPa in {solver}" for solver in solvers[:2])
    return f"the locked contact hides tension, down to {deepest}"


def _damped_agreement(group: CaseGroup) -> str:
    """Warn where the agreement grows with the damping: alone it then rewards the worse run."""
    pairs = []
    for case in group.cases:
        xi = case.number("dda", "mode1.damping")
        error = group.number_of_pair(case, "dda", "bar", METRICS[0])
        if xi is not None and error is not None:
            pairs.append((xi, error))
    pairs.sort()
    falls = all(a[0] < b[0] and a[1] > b[1] for a, b in itertools.pairwise(pairs))
    if len(pairs) < 3 or not falls:
        return ""
    least, most = (f"{percent(error)} at ξ₁ = {100 * xi:.2f}\u00a0%" for xi, error in (pairs[0], pairs[-1]))
    trend = f"the difference falls as the damping grows, from {least} to {most}"
    return f"{trend}: both are damped, which is no sign of accuracy"


def outcomes(group: CaseGroup) -> Blocks:
    """Name every outcome but completed, with its sentence and the cases that share it."""
    labels_by_outcome: dict[tuple[str, Outcome, tuple[str, ...]], list[str]] = {}
    for case in group.cases:
        for solver, row in case.rows.items():
            if row.outcome is not Outcome.COMPLETED:
                labels_by_outcome.setdefault((solver, row.outcome, row.notes), []).append(case.label)
    blocks: Blocks = []
    for (solver, outcome, notes), labels in labels_by_outcome.items():
        where = "" if labels == [AS_STATED] else f" at {'; '.join(labels)}"
        blocks.append(Callout(f"{solver}{where}: {outcome}. {outcome.sentence} {'; '.join(notes)}".strip(), "warn"))
    return blocks


# ---- figures ----


def _columns(group: CaseGroup) -> list[str]:
    """Return the columns that solvers report: those of a kind in the scene's order, displacement first."""
    names: set[str] = set()
    for case in group.cases:
        names.update(*(history.columns for history in case.histories.values()))
    scene = group.cases[0].scene
    own = [name for name in scene.run.columns if scene.kind.has_column(scene, name) and name in names]
    return own or sorted(names, key=lambda name: (rank(name), name))


def lead_figure(group: CaseGroup, directory: Path) -> Blocks:
    """Draw the case and the window that show what the solvers differ by; nothing where no history was kept."""
    columns = _columns(group)[:LEAD_COLUMNS]
    panel, sentences = lead_panel(group, columns)
    if panel is None:
        return []
    sentences += [*_on_one([panel], columns), *_reading([panel], columns, apart=True)]
    figure = motion.history_figure([replace(panel, title="")], *columns, apart=True, height=LEAD_ROW)
    return [histories.saved(figure, directory, f"{group.slug}-lead.svg", " ".join(sentences), group.name)]


def slide_figure(group: CaseGroup) -> Figure | None:
    """Return the figure that opens the page of a scene, under its title, for a slide."""
    columns = _columns(group)[:LEAD_COLUMNS]
    panel, _ = lead_panel(group, columns)
    if panel is None:
        return None
    title = ": ".join(filter(None, (group.title, panel.title)))
    return motion.history_figure([replace(panel, title=title)], *columns, apart=True, slide=True)


def lead_panel(group: CaseGroup, columns: Sequence[str]) -> tuple[HistoryPanel | None, list[str]]:
    """Return the case and the window that show what the solvers differ by, and what they show in words.

    The window is that of `free_window`; the case is that in which, over it, the judged solver and its reference differ
    by a share nearest to `VISIBLE`: further apart their lines have no more to do with one another, closer they are one.
    """
    panels = {}
    for case in group.cases if columns else ():
        window = min(free_window(case, columns[0]), _settling_time([case], columns, ()))
        panel = _panel(case, columns, window, ())
        if any(history.time.size >= FEWEST for history in panel.histories.values()):
            panels[case.name] = panel
    if not panels:
        return None, []
    shares = {name: lead_difference(panel, columns[0]) for name, panel in panels.items()}
    distances = {name: abs(math.log(share / VISIBLE)) for name, share in shares.items() if share}
    telling = min(distances, key=distances.__getitem__, default=next(iter(panels)))
    panel = panels[telling]
    sentences = []
    if len(group.cases) > 1:
        which = "the one that shows most" if distances else "the first"
        sentences.append(f"{panel.title}, of {len(group.cases)} cases {which}.")
    share = shares[telling]
    if share:
        window = max(float(history.time[-1]) for history in panel.histories.values())
        name = columns[0].replace("_", " ")
        sentences.append(
            f"Over these {short(window, 3)} s {_judged(panel)} is {percent(share)} off {panel.reference} in {name} "
            "(relative L2)."
        )
    return panel, sentences


def _is_shown_whole(group: CaseGroup) -> bool:
    """Whether the opening figure of a page shows all: one case, its columns and steps."""
    columns = _columns(group)
    case, *others = group.cases
    if others or not 0 < len(columns) <= LEAD_COLUMNS:
        return False
    return free_window(case, columns[0]) >= min(_ends([case]), default=0.0)


def _judged(panel: HistoryPanel) -> str | None:
    """Return the judged solver of a panel: DDA, or the first beside the reference."""
    solvers = [name for name in panel.histories if name != panel.reference]
    return min(solvers, key=lambda name: role(name) is not Role.JUDGED, default=None)


def lead_difference(panel: HistoryPanel, column: str) -> float | None:
    """Return the relative L2 difference between the judged solver of a panel and its reference.

    None where they cannot be compared, one of them blew up, or all that they differ by is rounding.
    """
    judged = panel.histories.get(_judged(panel) or "")
    base = panel.histories.get(panel.reference or "")
    if judged is None or base is None or judged.time.size != base.time.size:
        return None
    if column not in judged.columns or column not in base.columns:
        return None
    values = base.columns[column]
    with np.errstate(all="ignore"):
        share = or_nan(relative_l2(judged.columns[column], values))
    return share if share > motion.FLOOR else None


def free_window(case: CaseResults, column: str) -> float:
    """Return the time [s] that is shown of a case: the first periods of a vibration, or all of a driven motion.

    Where no solver knows the first frequency, a period is what a history swings in.
    """
    end = min(_ends([case]), default=0.0)
    tables = case.scene.tables()
    if "input" in tables or is_fulfilled("load.base_motion", "", tables):
        return end
    frequencies = [case.number(solver, "mode1.frequency") for solver in case.rows]
    known = [frequency for frequency in frequencies if frequency]
    if known:
        return min(end, PERIODS * 2 * math.pi / min(known))
    for history in case.histories.values():
        crossings = motion.swings(history, column) if column in history.columns else 0
        if crossings > 2 * PERIODS:
            return end * 2 * PERIODS / crossings
    return end


def history_block(
    group: CaseGroup, columns: Sequence[str], directory: Path, without: Sequence[str] = ()
) -> FigureBlock:
    """Draw columns of a scene's cases over the time that all of them run; return the figure's block."""
    cases = [group.cases[i] for i in evenly(len(group.cases), MOST_PANELS)]
    ends = _ends(cases)
    window = min(ends, default=0.0)  # cases of one figure are compared over the same time
    settled = _settling_time(cases, columns, without)
    panels = [_panel(case, columns, min(window, settled), without) for case in cases]
    panels = [panel for panel in panels if panel.histories]  # the steps of the others are longer than that time
    sentences = []
    if len(panels) < len(group.cases):
        sentences.append(f"{len(panels)} of {len(group.cases)} cases.")
    if settled < window:
        window = settled
        sentences.append(f"The first {plain(window, 2)} s; all have settled to 1\u00a0% by then.")
    elif max(ends, default=0.0) > window * 1.001:
        sentences.append(f"The first {plain(window, 3)} s, the time that all cases run.")
    sentences += [*_on_one(panels, columns), *_reading(panels, columns)]
    figure = motion.history_figure(panels, *columns)
    return histories.saved(figure, directory, f"{group.slug}-history.svg", " ".join(sentences), group.name)


def _ends(cases: Sequence[CaseResults]) -> list[float]:
    """Return the last instant [s] of each case that has one, of its longest run."""
    ends = []
    for case in cases:
        last = [float(history.time[-1]) for history in case.histories.values() if len(history.time)]
        ends += [max(last)] if last else []
    return ends


def _settling_time(cases: Sequence[CaseResults], columns: Sequence[str], without: Sequence[str]) -> float:
    """Return a time [s] to end at, by which every drawn line has long settled; else infinity."""
    latest = 0.0
    for case in cases:
        for solver in set(case.histories) - set(without):
            for column in columns:
                step = case.number(solver, f"{_PREFIX.get(column, column)}.settling_step")
                if step is None:
                    return math.inf
                latest = max(latest, max(step, FEWEST) * case.scene.time.step)
    return CALM * latest


def _on_one(panels: HistoryPanels, columns: Sequence[str]) -> list[str]:
    """Name the lines that lie on one another, and how far off they are at most."""
    parts = []
    for name, others in motion.twins(panels, columns).items():
        parts += [f"{other} lies on {name} (within {bounded(off, power(off))})" for other, off in others.items()]
    return [f"{', '.join(parts)}."] if parts else []


def _reading(panels: HistoryPanels, columns: Sequence[str], apart: bool = False) -> list[str]:
    """Say how the figure is read, as far as it is not written on it."""
    sentences = []
    if start := motion.start_of(panels, columns[0]):
        sentences.append(
            f"Oscillations too dense to draw are the band that they fill; below, the first {plain(start, 2)} s."
        )
    if any(panel.static for panel in panels):
        sentences.append("Hairline: static value.")
    references = dict.fromkeys(p.reference for p in panels if p.reference and differences(p, columns[0]))
    if references and apart:
        sentences.append(f"|Δ|: from {' or '.join(map(str, references))}, the largest in each fortieth of the time.")
    return sentences


def _panel(case: CaseResults, columns: Sequence[str], window: float, without: Sequence[str]) -> HistoryPanel:
    """Return the histories of a case up to a time [s]; an exact motion is drawn at the instants between the steps."""
    drawn = {}
    for solver, history in case.histories.items():
        shown = history.until(window)
        if solver not in without and set(columns) & set(history.columns) and len(shown.time):
            drawn[solver] = shown
    reference = case.reference if case.reference in drawn else None
    static = {}
    for column in columns:
        metric = f"{_PREFIX.get(column, column)}.static"
        values = [case.number(solver, metric) for solver in (reference or "", "dda", *drawn)]
        numbers = [value for value in values if value is not None]
        if numbers:
            static[column] = numbers[0]
    finer = {solver: history.between for solver, history in drawn.items() if history.between is not None}
    title = "" if case.label == AS_STATED else case.label
    return HistoryPanel(title, drawn, static, reference, finer=finer, own=case.scene.kind.columns)
