"""What page 1 says of a scene: drawing, choices, error and cost of each solver, what damping removed, what to doubt.

Every number is of the rows, or of the closed form of the scheme at a frequency of the rows. What a scene has not, such
as springs or a mode, is left out.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import replace
from pathlib import Path

from validation.advice.coarse import removal_of
from validation.report.blocks import Beside, Blocks, Heading, Paragraph, Points, Table
from validation.report.chapters.alarms import alarm_lines
from validation.report.chapters.data import CaseGroup, CaseResults, Groups, varied_fields
from validation.report.chapters.described import Description
from validation.report.chapters.text import AS_STATED, parameters, range_of, span
from validation.report.figures import histories
from validation.report.figures.curves import evenly
from validation.report.figures.drawing import scene_figure
from validation.report.scene.hooks import SCHEMES, ShowingHooks
from validation.runs.numbers import DASH, bounded, percent, plain, short
from validation.runs.row import Row, Value
from validation.runs.run import Outcome
from validation.scenes import features
from validation.scenes.scene import Scene
from validation.solvers.contract import Role
from validation.solvers.registry import by_role, role
from validation.theory import spectra
from validation.theory.stepping import Stepping

PAGE = Description(__file__)
DRAWING_SHARE = 0.36  # of the width
MOST_CASES = 6  # of a sweep on page 1
NONE = 1e-10  # of a damping ratio, or of an amplitude: what rounding leaves of none
LEVELS = (0.1, 0.01, 0.001)  # errors of the displacement that a fastest run is named for
ERRORS = ("displacement.l2", "pressure.l2", "horizontal.l2")
COSTS = (*ERRORS, "unknowns", "solves", "steps", "setup", "stepping")
MESHES = ("fem", "fenicsx")
Lines = Iterable[tuple[CaseResults, Mapping[str, Value]]]  # of a table: the case, and what is computed from it


def scene_summary(group: CaseGroup, directory: Path) -> Blocks:
    """Return the summary of a scene; its drawing is written to a directory."""
    drawing = histories.saved(scene_figure(group.cases[0].scene), directory, f"{group.slug}-drawing.svg", "")
    alarms: Blocks = [*alarm_lines({group.name: group})]
    data = Paragraph(parameters(group.cases[0].scene, varied_fields(group)), "small")
    return [
        Beside((drawing,), (Points(tuple(choices(group))), data), DRAWING_SHARE),
        *error_blocks(group),
        *damping_blocks(group),
        *([Heading("What not to trust", 3), *alarms] if alarms else []),
    ]


def overview(groups: Groups) -> Table:
    """Return a line for each scene: how far DDA is off, how its first mode is damped, what a run costs."""
    lines = []
    for group in groups.values():
        own: dict[str, Value] = {"title": group.title, "cases": float(len(group.cases))}
        errors = [errors_of(group, case, "dda", reference_of(group, case)) for case in group.cases]
        for metric in ERRORS:
            values = [found[metric] for found in errors if metric in found]
            own[metric] = span(values) if values else None
        damping = group.numbers("dda", "mode1.damping")
        own["damping"] = span(damping) if damping else None
        own["seconds"] = max((seconds_of(case.rows["dda"]) for case in group.cases if "dda" in case.rows), default=None)
        own["alarms"] = ", ".join(dict.fromkeys(alarm["kind"] for alarm in group.alarms)) or "none"
        lines.append((group.cases[0], own))
    return _table("overview", lines)


def _table(name: str, lines: Lines, **values: str) -> Table:
    """Return a table without columns that say nothing; a case is named in its first line."""
    described = PAGE.columns(name)
    rows = []
    previous = ""
    for case, own in lines:
        label = "" if case.label in (AS_STATED, previous) else case.label
        rows.append([column.of_case(case, {"case": label, **own}) for column in described])
        previous = case.label
    kept = [place for place, cells in enumerate(zip(*rows, strict=True)) if not set(cells) <= {DASH, "", "0"}]
    return PAGE.table(name, [[row[i] for i in kept] for row in rows], [described[i].head for i in kept], **values)


# ---- choices ----


def choices(group: CaseGroup) -> Iterator[tuple[str, str]]:
    """Yield time step, springs and discount, and what they do."""
    scenes = [case.scene for case in group.cases]
    hooks = ShowingHooks.of(scenes[0])
    yield "Time step.", _step(group, scenes)
    if springs := hooks.springs(scenes, group.numbers):
        yield "Springs.", springs
    yield "Discount.", _discount(scenes)


def _step(group: CaseGroup, scenes: Sequence[Scene]) -> str:
    steps = [scene.time.step for scene in scenes]
    step = f"{range_of(steps)}\u00a0s" if max(steps) >= 1 else f"{range_of(1e3 * step for step in steps)}\u00a0ms"
    parts = [f"dt = {step}, {', '.join(dict.fromkeys(map(_scheme, scenes)))}"]
    frequencies = [_frequency_of(case) for case in group.cases]
    turns = [w * scene.time.step for w, scene in zip(frequencies, scenes, strict=True) if w is not None]
    if turns:
        parts.append(f"a period of the first mode takes {range_of(2 * math.pi / turn for turn in turns)} steps")
    block = scenes[0].stated_block
    if block is not None and block.rectangle is not None:
        crossings = [spectra.transit(scene) / scene.time.step for scene in scenes]
        parts.append(f"a wave crosses the block in {range_of(crossings)}")
    return f"{'; '.join(parts)}."


def _scheme(scene: Scene) -> str:
    t = scene.time
    return SCHEMES.get((t.alpha, t.delta), "Newmark") if t.scheme == "newmark" else Stepping.of(scene).name


def _discount(scenes: Sequence[Scene]) -> str:
    if scenes[0].time.gg_rate is not None:
        return f"Held as a rate of {range_of(scene.time.gg_rate or 0.0 for scene in scenes)} 1/s, whatever the step."
    discounts = [scene.time.discount for scene in scenes]
    if min(discounts) == 1:
        return "gg = 1: none."
    rates = [-math.log(scene.time.discount) / scene.time.step for scene in scenes if scene.time.discount > 0]
    at_steps = f", at these steps a rate of {range_of(rates)} 1/s" if rates else ""
    return f"gg = {range_of(discounts)} per step{at_steps}."


# ---- error and cost ----


def reference_of(group: CaseGroup, case: CaseResults) -> str | None:
    """Return the best reference that a case was compared with: exact in time as well, else in space."""
    for wanted in (Role.TRUTH, Role.REFERENCE, Role.LIMIT):
        for name in by_role(wanted):
            if name in case.rows and any(errors_of(group, case, solver, name) for solver in case.rows):
                return name
    return None


def errors_of(group: CaseGroup, case: CaseResults, solver: str, reference: str | None) -> dict[str, float]:
    """Return the relative L2 differences of a solver from a reference."""
    values = {} if reference is None else group.compared(case, solver, reference)
    return {metric: float(values[metric]) for metric in ERRORS if isinstance(values.get(metric), int | float)}


def seconds_of(row: Row) -> float:
    """Return the run time of a row with its set-up [s]."""
    return sum(row.seconds.values())


def error_blocks(group: CaseGroup) -> Blocks:
    """Return error and cost of each solver in each case, the reference, and the fastest run to an error."""
    chosen = [group.cases[i] for i in evenly(len(group.cases), MOST_CASES)]
    lines = []
    for case in chosen:
        reference = reference_of(group, case)
        for solver, row in case.rows.items():
            if row.outcome is Outcome.COMPLETED and row.seconds:
                name = f"{solver} (reference)" if solver == reference else solver
                errors = errors_of(group, case, solver, reference)
                lines.append((case, {**dict.fromkeys(COSTS), "solver": name, **errors, **row.work, **row.seconds}))
    if not lines:
        return []
    note = reference_note(group, chosen[-1])
    if len(chosen) < len(group.cases):
        note += f" {len(chosen)} of {len(group.cases)} cases."
    return [Heading("Error and cost", 3), _table("costs", lines, note=note), *_frequency(group), *fastest(group)]


def reference_note(group: CaseGroup, case: CaseResults) -> str:
    """Say how far the reference can be trusted."""
    reference = reference_of(group, case)
    if reference is None:
        return "No reference applies here, or none was run."
    if role(reference) is Role.TRUTH:
        estimate = case.rows[reference].estimate
        within = f" within {bounded(estimate, percent(estimate))}" if estimate else ""
        return f"The reference, {reference}, is exact in space and time{within}."
    if role(reference) is Role.LIMIT:
        return f"The reference, {reference}, is exact in time, with the strains that DDA has."
    same = "takes the same steps, so that their error is not in the table"
    if reference not in MESHES:
        more = " (continuum in run.solvers tells it)" if features.linear(case.scene) else ""
        return f"The reference, {reference}, is exact in space and {same}{more}."
    mesh = ""
    block = case.scene.stated_block
    if block is not None and block.rectangle is not None:
        shift = spectra.mesh_frequency_error(case.scene)
        mesh = f", as a bar its mesh is off by {bounded(shift, percent(shift))} in the first frequency,"
    return f"The reference, {reference}, is the finest mesh that was run{mesh} and {same}."


def _frequency(group: CaseGroup) -> Blocks:
    """Say how far one strain puts the first natural frequency off."""
    case = group.cases[-1]
    own = case.number("dda", "mode1.frequency")
    for reference in ("bar", *MESHES):
        exact = case.number(reference, "mode1.frequency")
        if own is not None and exact:
            shift = own / exact - 1
            off = f"{percent(abs(shift))} {'above' if shift > 0 else 'below'}"
            return [Paragraph(PAGE.text("frequency", own=short(own), off=off, reference=reference))]
    return []


def fastest(group: CaseGroup) -> Blocks:
    """Return the fastest run within each error of the displacement; nothing of a single case."""
    runs = []  # seconds, error, words
    for case in group.cases:
        reference = reference_of(group, case)
        for solver, row in case.rows.items():
            error = errors_of(group, case, solver, reference).get(ERRORS[0])
            if error is not None:
                runs.append((seconds_of(row), error, f"{solver} at {case.label}"))
    if len(group.cases) < 2 or not runs:
        return []
    parts = []
    for level in LEVELS:
        within = [run for run in runs if run[1] <= level]
        if within:
            seconds, _, words = min(within)
            parts.append(f"{percent(level)}: {words}, {plain(1e3 * seconds, 2)}\u00a0ms")
    name = "fastest" if parts else "none-within"
    return [Paragraph(PAGE.text(name, runs="; ".join(parts), level=percent(LEVELS[0])))]


# ---- damping ----


def _frequency_of(case: CaseResults) -> float | None:
    """Return the first natural frequency of DDA's model [rad/s]."""
    return ShowingHooks.of(case.scene).first_frequency(case.scene, case.number("dda", "mode1.frequency"))


def damping_blocks(group: CaseGroup) -> Blocks:
    """Return what damping removed: of the first mode where there is one, else of the energy of a contact that opens."""
    modes = []
    for case in group.cases[:MOST_CASES]:
        frequency = _frequency_of(case)
        if frequency is not None:
            modes.append((case, mode_damping(case, frequency)))
    if modes and not any(abs(part or 0.0) > NONE for _, parts in modes for part in parts.values()):
        return [Heading("What damping removed", 3), Paragraph(PAGE.text("undamped"))]
    if modes:
        return [Heading("What damping removed", 3), _table("damping", modes)]
    opened = [case for case in group.cases[:MOST_CASES] if case.number("dda", "energy.given") is not None]
    if not opened:
        return []
    return [Heading("What damping removed", 3), _table("energy", ((case, {}) for case in opened))]


def mode_damping(case: CaseResults, frequency: float) -> dict[str, float | None]:
    """Return the damping ratio of a mode in all, by scheme, discount and tables, and what is gone in a period [1]."""
    stepping = Stepping.of(case.scene)
    turn = frequency * case.scene.time.step
    by_scheme = replace(stepping, gg=1.0, rate=None).damping_ratio(turn)
    numerical = stepping.damping_ratio(turn)
    total: float | None = numerical
    if case.scene.damping.present:
        total = case.number("dda", "mode1.damping")
    by_tables = None if total is None or not case.scene.damping.present else total - numerical
    removal = removal_of(case.scene, frequency)
    parts = {"total": total, "scheme": by_scheme, "discount": numerical - by_scheme, "tables": by_tables}
    parts |= {"gone": removal.by_scheme, "meant": removal.by_damping}
    return {name: part if part is not None and math.isfinite(part) else None for name, part in parts.items()}
