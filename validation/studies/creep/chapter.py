"""The chapter of the study `creep`: a stable block over time and over the step, by rule and scheme."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from validation.report.blocks import Blocks, FigureBlock, Paragraph, Table
from validation.report.chapters.data import CaseResults, Groups, cases_of, groups_by_name, verdicts_of
from validation.report.chapters.described import Description
from validation.report.chapters.scene import opening
from validation.report.chapters.text import cell
from validation.report.figures.charts import DOTS, ChartLine
from validation.runs.records import Manifest
from validation.runs.results import Results
from validation.studies.creep import formulas as study
from validation.theory import friction

CONSTANT = "constant acceleration"
AVERAGE = "average acceleration"
ORANGE = "#d55e00"
AMBER = "#e69f00"
BLUE = "#0072b2"
GREEN = "#009e73"
BLACK = "black"
PAGE = Description(__file__)


def chapter(results: Results, manifest: Manifest, directory: Path) -> Blocks:
    """Return the chapter: the figure and the table by steps."""
    groups = groups_by_name(results, manifest)
    blocks = [*opening(manifest, verdicts_of(groups.values())), Paragraph(PAGE.text("explanation"))]
    if groups.get(study.STEPS):
        blocks += [over_time_and_step(groups, directory), by_step(groups)]
    blocks += by_stiffness(groups)
    return blocks


def over_time_and_step(groups: Groups, directory: Path) -> FigureBlock:
    """Return the figure of slides over time and of slip over the step."""
    exact = [case for case in cases_of(groups, study.EXACT) if case.scene.contact.friction == 30]
    lines = [trace("exact", case, "block-events", BLACK) for case in exact]
    steps = cases_of(groups, study.STEPS)
    for words, step, color in (("1 ms", 1e-3, ORANGE), ("0.2 ms", 2e-4, AMBER)):
        lines += [trace(f"(1/2, 1), {words}", c, "dda", color) for c in steps if of(c, CONSTANT) and at(c, step)]
    lines += [trace("(1/4, 1/2), 0.2 ms", c, "dda", BLUE) for c in steps if of(c, AVERAGE) and at(c, 2e-4)]
    kinds = ((CONSTANT, "(1/2, 1), consistent", ORANGE), (AVERAGE, "(1/4, 1/2), consistent", BLUE))
    slips = [over_step(words, [c for c in steps if of(c, kind)], color) for kind, words, color in kinds]
    slips.append(over_step("lagged, dead bands", lagged(groups), GREEN))
    program_steps, program_slips = np.array(sorted(study.PROGRAM.items())).T
    program = ChartLine(
        "an established program", 1e3 * program_steps, 1e3 * program_slips, BLACK, width=0, dots=DOTS, hollow=True
    )
    slips.append(program)
    slips += [across(case) for case in exact[:1]]
    lines = [line for line in lines if len(line.x)]
    slips = [line for line in slips if len(line.x)]
    panels = (PAGE.panel("slide", lines), PAGE.panel("slip", slips))
    return PAGE.figure("creep", panels, directory)


def of(case: CaseResults, kind: str) -> bool:
    """Whether a case is of a scheme from the usual start, without a discount."""
    t = case.scene.time
    if t.discount < 1 or (kind == AVERAGE) != (t.delta == 0.5):
        return False
    return t.start == ("consistent" if kind == AVERAGE else "zero")


def at(case: CaseResults, step: float) -> bool:
    """Whether a case is of a time step."""
    return abs(case.scene.time.step / step - 1) < 1e-9


def lagged(groups: Groups) -> list[CaseResults]:
    """Return the cases of lagged friction on the scene's own springs."""
    return [case for case in cases_of(groups, study.LAGGED) if case.scene.contact.stiffness == case.scene.block.young]


def trace(words: str, case: CaseResults, solver: str, color: str) -> ChartLine:
    """Return the slide of a case over time."""
    history = case.histories.get(solver)
    if history is None:
        return ChartLine(words, np.zeros(0), np.zeros(0), color)
    return ChartLine(words, history.time, 1e3 * study.slid(history.columns), color)


def slip(case: CaseResults) -> float | None:
    """Return the slip of the corners in a second, of a block that slides far that of the centroid [m]."""
    if case.scene.contact.rules == "lagged":
        return case.number("dda", "horizontal.final")
    history = case.histories.get("dda")
    return None if history is None else float(study.slid(history.columns)[-1])


def over_step(words: str, runs: list[CaseResults], color: str) -> ChartLine:
    """Return the slip of some cases over their steps."""
    points = sorted((case.scene.time.step, value) for case in runs if (value := slip(case)))
    steps, slips = 1e3 * np.array(points).reshape(-1, 2).T
    return ChartLine(words, steps, slips, color)


def across(case: CaseResults) -> ChartLine:
    """Return the exact block's slip in a second, at any step."""
    history = case.histories.get("block-events")
    if history is None:
        return ChartLine("exact", np.zeros(0), np.zeros(0), BLACK)
    speed = float(study.slid(history.columns)[-1] / history.time[-1])
    return ChartLine("exact", np.array([0.2, 10.0]), np.full(2, 1e3 * speed), BLACK, dash=(2.0, 2.0))


def by_step(groups: Groups) -> Table:
    """Return the slip in a second by step and rule."""
    steps = cases_of(groups, study.STEPS)
    rows = []
    for step, program_slip in study.PROGRAM.items():
        slips = [next((slip(c) for c in steps if of(c, kind) and at(c, step)), None) for kind in (CONSTANT, AVERAGE)]
        slips.append(next((slip(c) for c in lagged(groups) if at(c, step)), None))
        rows.append(tuple(cell(value, 1e3, 3) for value in (step, *slips, program_slip)))
    return PAGE.table("steps", rows, scale=1e3 * friction.creep_scale(steps[0].scene))


def by_stiffness(groups: Groups) -> Blocks:
    """Return the table of the creep on springs of any stiffness, where a run has it."""
    damped = cases_of(groups, study.DAMPED)
    rows = []
    for case in sorted(cases_of(groups, study.STIFFNESS), key=lambda one: one.scene.contact.stiffness):
        p = case.scene.contact.stiffness
        stopping = [one for one in damped if one.scene.contact.stiffness == p]
        own = {
            "ratio": p / case.scene.block.young,
            "scale": friction.creep_scale(case.scene),
            "exact": speed(case, "block-events"),
            "dda": speed(case, "dda"),
            "by step": next((slip(one) for one in stopping if one.scene.time.discount == 1), None),
            "by discount": next((slip(one) for one in stopping if one.scene.time.discount < 1), None),
        }
        rows.append(PAGE.cells("stiffness", case, own))
    return [PAGE.table("stiffness", rows)] if rows else []


def speed(case: CaseResults, solver: str) -> float | None:
    """Return the mean speed of the corners over a run [m/s]."""
    history = case.histories.get(solver)
    return None if history is None else float(study.slid(history.columns)[-1] / history.time[-1])
