"""The chapter of the stiff contact: steps to settle under two schemes, as table and figure."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

import numpy as np

from validation.report.blocks import Block, Column, FigureBlock, Heading, Paragraph, Table
from validation.report.chapters.data import Case, Group, groups
from validation.report.chapters.scene import gate_count
from validation.report.chapters.text import DASH, plain, short
from validation.report.figures import histories as figures
from validation.report.figures import stability as figures_stability
from validation.runs.records import Manifest
from validation.runs.results import Results

SCHEMES = {0.5: "(1/2, 1)", 0.5625: "(9/16, 1)"}
QUANTITIES = ("displacement", "pressure")


def contact_chapter(results: Results, manifest: Manifest, directory: Path) -> list[Block]:
    """Return the chapter: what rings, for how long, and what does not."""
    (group,) = groups(results, manifest)
    table = by_ratio(group)
    file = f"{group.slug}-settling.svg"
    figures.save(figures_stability.settling_figure(lines(table), _longest(group)), directory / file)
    return [
        Heading(manifest.get("title") or manifest["study"]),
        Paragraph(conclusion(table), "lead"),
        Paragraph(manifest.get("purpose") or ""),
        settling_table(table),
        FigureBlock(
            file,
            "Steps until displacement and contact pressure stay within 1e-4 of their static values, dda; a hollow mark "
            "has not settled within the run.",
        ),
        Paragraph(
            "The ring's amplitude falls as 1/p while its decay per step, 8/(ω dt)², falls as well: the longest wait "
            "lies between, and beyond it a ring too small to see never ends. "
            + gate_count(group.verdicts).capitalize()
            + "."
        ),
    ]


Rows = dict[float, dict[float, Case]]  # p/E -> alpha -> case


def by_ratio(group: Group) -> Rows:
    """Return the cases by p/E and alpha."""
    found: Rows = {}
    for case in group.cases:
        ratio = case.scene.contact.stiffness / case.scene.block.young
        found.setdefault(ratio, {})[case.scene.time.alpha] = case
    return dict(sorted(found.items()))


def _longest(group: Group) -> float:
    return float(max(case.scene.time.steps for case in group.cases))


def _steps(case: Case | None, quantity: str) -> float | None:
    return None if case is None else case.number("dda", f"{quantity}.fine_settling_step")


def lines(table: Rows) -> Sequence[figures_stability.Settling]:
    """Return the four curves of the figure."""
    ratios = np.array(list(table))
    return [
        figures_stability.Settling(
            f"{quantity} {SCHEMES[alpha]}",
            ratios,
            np.array([np.nan if (n := _steps(row.get(alpha), quantity)) is None else n for row in table.values()]),
        )
        for alpha in SCHEMES
        for quantity in QUANTITIES
    ]


def conclusion(table: Rows) -> str:
    """Say in one sentence how long the pressure takes under either scheme."""
    parts = []
    for alpha, name in SCHEMES.items():
        found = {ratio: n for ratio, row in table.items() if (n := _steps(row.get(alpha), "pressure")) is not None}
        if found:
            worst = max(found, key=lambda ratio: found[ratio])
            parts.append(f"under {name} up to {found[worst]:.0f} steps (at p = {short(worst)} E)")
    said = " and ".join(parts)
    return f"The contact pressure settles within 1e-4 {said}: constant acceleration rings, (9/16, 1) does not."


def settling_table(table: Rows) -> Table:
    """Return steps to settle and the contact mode's root by p/E."""
    columns = [Column("p / E", "decimal")]
    for name in SCHEMES.values():
        columns += [Column(title, "decimal", f"α, δ = {name}") for title in ("displ.", "press.", "|λ| of the contact")]
    rows = [
        (short(ratio), *(part for alpha in SCHEMES for part in _parts(row.get(alpha)))) for ratio, row in table.items()
    ]
    return Table(tuple(columns), tuple(rows), "Steps to settle within 1e-4 of static, and the contact mode's |λ|, dda.")


def _parts(case: Case | None) -> tuple[str, str, str]:
    steps = [_steps(case, quantity) for quantity in QUANTITIES]
    radius = None if case is None else case.number("dda", "contact.spectral_radius")
    shown = [DASH if n is None else f"{n:.0f}" for n in steps]
    return shown[0], shown[1], DASH if radius is None else plain(radius, 8)
