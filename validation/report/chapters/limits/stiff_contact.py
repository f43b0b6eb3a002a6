"""The chapter of the stiff contact: steps to settle under two schemes, as table and figure."""

from __future__ import annotations

import itertools
from collections.abc import Sequence
from pathlib import Path

import numpy as np

from validation.report.blocks import Block, Paragraph, Table, columns
from validation.report.chapters.data import Case, Group, groups
from validation.report.chapters.scene import gate_count, opening
from validation.report.chapters.text import DASH, plain, short
from validation.report.figures import histories
from validation.report.figures.stability import Settling, settling_figure
from validation.runs.records import Manifest
from validation.runs.results import Results

SCHEMES = {0.5: "(1/2, 1)", 0.5625: "(9/16, 1)"}
QUANTITIES = ("displacement", "pressure")


def contact_chapter(results: Results, manifest: Manifest, directory: Path) -> list[Block]:
    """Return the chapter: what rings, for how long, and what does not."""
    (group,) = groups(results, manifest)
    table = by_ratio(group)
    longest = float(max(case.scene.time.steps for case in group.cases))
    caption = (
        "Steps until displacement and contact pressure stay within 10⁻⁴ of their static values, dda; a hollow mark has "
        "not settled within the run."
    )
    ring = (
        "The amplitude of the ringing falls as 1/p, and so does its decay per step, 8/(ω dt)²: it takes longest to "
        "settle in between, and beyond, a ringing too small to see never ends."
    )
    return [
        *opening(manifest, lead=conclusion(table)),
        settling_table(table),
        histories.saved(settling_figure(lines(table), longest), directory, f"{group.slug}-settling.svg", caption),
        Paragraph(f"{ring} {gate_count(group.verdicts).capitalize()}."),
    ]


Rows = dict[float, dict[float, Case]]  # p/E -> alpha -> case


def by_ratio(group: Group) -> Rows:
    """Return the cases by p/E and alpha."""
    found: Rows = {}
    for case in group.cases:
        ratio = case.scene.contact.stiffness / case.scene.block.young
        found.setdefault(ratio, {})[case.scene.time.alpha] = case
    return dict(sorted(found.items()))


def _steps(case: Case | None, quantity: str) -> float | None:
    return None if case is None else case.number("dda", f"{quantity}.fine_settling_step")


def lines(table: Rows) -> Sequence[Settling]:
    """Return the four curves of the figure."""
    ratios, found = np.array(list(table)), []
    for alpha, name in SCHEMES.items():
        for quantity in QUANTITIES:
            steps = [_steps(row.get(alpha), quantity) for row in table.values()]
            found.append(Settling(f"{quantity} {name}", ratios, np.array(steps, dtype=float)))
    return found


def conclusion(table: Rows) -> str:
    """Say in one sentence how long the pressure takes under either scheme."""
    parts = []
    for alpha, name in SCHEMES.items():
        found: list[tuple[float, float]] = []
        for ratio, row in table.items():
            steps = _steps(row.get(alpha), "pressure")
            found += [] if steps is None else [(steps, -ratio)]
        if found:
            steps, ratio = max(found)  # of equal waits that of the softest contact
            parts.append(f"under {name} up to {steps:.0f} steps (at p = {short(-ratio)}E)")
    said = " and ".join(parts)
    return f"To settle within 10⁻⁴ the contact pressure takes {said}: constant acceleration rings, (9/16, 1) does not."


def settling_table(table: Rows) -> Table:
    """Return steps to settle and the contact mode's root by p/E."""
    titles = columns("decimal", "p / E")
    for name in SCHEMES.values():
        titles += columns("decimal", "displ.", "press.", "|λ| of the contact", group=f"α, δ = {name}")
    rows = []
    for ratio, row in table.items():
        rows.append((short(ratio), *itertools.chain(*(_parts(row.get(alpha)) for alpha in SCHEMES))))
    return Table(titles, tuple(rows), "Steps to settle within 10⁻⁴ of static, and the contact mode's |λ|, dda.")


def _parts(case: Case | None) -> tuple[str, str, str]:
    steps = [_steps(case, quantity) for quantity in QUANTITIES]
    radius = None if case is None else case.number("dda", "contact.spectral_radius")
    shown = [DASH if n is None else f"{n:.0f}" for n in steps]
    return shown[0], shown[1], DASH if radius is None else plain(radius, 8)
