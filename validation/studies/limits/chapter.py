"""The chapter of the study `limits`: locking of nearly incompressible elements, and the energy of a million steps."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path

from validation.report.blocks import Blocks, Heading, Paragraph, Table, table
from validation.report.chapters.data import CaseGroup, CaseResults, groups_by_name
from validation.report.chapters.scene import history_block, opening
from validation.report.chapters.text import DASH, bounded, percent, power
from validation.runs.history import DISPLACEMENT
from validation.runs.records import Manifest
from validation.runs.results import Results

LOCKING = "locking"
LONG = "long-run"


def chapter(results: Results, manifest: Manifest, directory: Path) -> Blocks:
    """Return the chapter: the table of locking, the long run with its energy."""
    groups = groups_by_name(results, manifest)
    blocks = opening(manifest)
    if LOCKING in groups:
        blocks += [
            Heading(groups[LOCKING].title, 2),
            Paragraph(locked_sentence(groups[LOCKING])),
            locking_table(groups[LOCKING]),
        ]
    if LONG in groups:
        long = groups[LONG]
        blocks += [
            Heading(long.title, 2),
            Paragraph(drift_sentence(long)),
            history_block(long, (DISPLACEMENT,), directory),
        ]
    return blocks


def by_poisson(group: CaseGroup) -> Mapping[float, dict[int, CaseResults]]:
    """Return the cases of the coarsest mesh by Poisson ratio and degree."""
    cases: dict[float, dict[int, CaseResults]] = {}
    for case in group.cases:
        if case.scene.fem.per_side == _coarsest(group):
            cases.setdefault(case.scene.block.poisson, {})[case.scene.fem.degree] = case
    return cases


def _coarsest(group: CaseGroup) -> int:
    return min(case.scene.fem.per_side for case in group.cases)


def coarse_error(group: CaseGroup) -> tuple[float, int, float] | None:
    """Return the largest Poisson ratio that ran on a finer mesh, its elements a side, and how stiff the coarse one is.

    The last is the share by which quadratic elements of the coarsest mesh displace less than those of the finer one.
    """
    finer = [case for case in group.cases if case.scene.fem.per_side > _coarsest(group)]
    case = max(finer, key=lambda case: (case.scene.block.poisson, case.scene.fem.per_side), default=None)
    if case is None:
        return None
    poisson = case.scene.block.poisson
    fine = case.number("fem", "displacement.static")
    _, coarse = _static_displacements(by_poisson(group)[poisson])
    return (poisson, case.scene.fem.per_side, 1 - coarse / fine) if fine and coarse else None


def _static_displacements(cases: Mapping[int, CaseResults]) -> list[float | None]:
    """Return the displacement at rest of linear and of quadratic elements [m]."""
    return [cases[degree].number("fem", "displacement.static") if degree in cases else None for degree in (1, 2)]


def locking_table(group: CaseGroup) -> Table:
    """Return the displacement at rest of linear and quadratic elements by Poisson ratio."""
    rows = []
    for poisson, cases in by_poisson(group).items():
        linear, quadratic = _static_displacements(cases)
        cells = [DASH if v is None else f"{1e3 * v:.4f}".replace("-", "−") for v in (linear, quadratic)]
        share = DASH if not linear or not quadratic else percent(linear / quadratic)
        rows.append((f"{poisson:g}", *cells, share))
    return table(
        ("μ", "linear", "quadratic", "linear over quadratic"),
        rows,
        f"v at rest [mm], plane strain, {_coarsest(group)} elements a side.",
    )


def locked_sentence(group: CaseGroup) -> str:
    """Say how much of the motion linear elements keep where the material hardly changes its volume."""
    poisson, cases = max(by_poisson(group).items())
    linear, quadratic = _static_displacements(cases)
    if not linear or not quadratic:
        return "Both degrees are needed to see locking."
    error = coarse_error(group)
    reservation = ""
    if error is not None:
        largest_poisson, elements, stiffening = error
        reservation = (
            f", but at μ = {largest_poisson:g} {_coarsest(group)} of them a side are still {percent(stiffening)} "
            f"stiffer than {elements} a side"
        )
    return (
        f"Linear elements lock: at μ = {poisson:g} they keep {percent(linear / quadratic)} of the displacement. "
        f"Quadratic ones do not lock{reservation}."
    )


def drift_sentence(group: CaseGroup) -> str:
    """Say how far the energy drifts over the long run."""
    drifts = group.numbers("dda", "energy.drift")
    steps = max(case.scene.time.steps for case in group.cases)
    if not drifts:
        return f"{steps} steps; the energy was not measured."
    largest = max(drifts)
    spaced_steps = f"{steps:,}".replace(",", "\u00a0")
    return f"The energy drifts by {bounded(largest, power(largest))} at most over {spaced_steps} steps."
