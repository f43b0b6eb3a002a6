"""The chapter of stiff and extreme data: maps of correct digits, outcomes by name, the one-factor extremes."""

from __future__ import annotations

import math
from collections import Counter
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from validation.metrics.growth import Stability
from validation.report.blocks import Block, Column, Heading, Table, columns
from validation.report.chapters.scene import opening
from validation.report.chapters.text import DASH, short
from validation.report.figures import histories
from validation.report.figures.stability import DigitMap, digit_maps, digits_of
from validation.runs.history import Array
from validation.runs.records import Manifest
from validation.runs.results import Results
from validation.runs.row import Row, Value
from validation.runs.run import Outcome

QUANTITIES = {"displacement": "Displacement", "pressure": "Contact pressure"}
MEASURE = {"bar": "scaled"}  # the bar's wave may not have arrived; all others over their own maximum
SOLVERS = ("dda", "dda-textbook", "fem", "bar")
MATRIX, FACTOR = "extremes-", "extreme-"
MOST_ROWS = 16  # of the one-factor extremes


@dataclass(frozen=True)
class Cell:
    """One run of the study beside its sixty-digit reference."""

    scene: str
    solver: str
    ratio: float  # p/E
    step: float  # s
    row: Row
    errors: Mapping[str, Value]


def cells(results: Results, manifest: Manifest) -> list[Cell]:
    """Return the runs of the solvers that are judged, with their errors where there are any."""
    rows = results.rows()
    compared = {(c["scene"], c["solver"]): c["metrics"] for c in manifest.get("comparisons", [])}
    found = []
    for entry in manifest.get("cases", []):
        solver, name, data = entry["solver"], entry["scene"], entry["definition"]
        if solver not in SOLVERS or entry["key"] not in rows:
            continue
        metrics = compared.get((name, solver), {})
        errors = {q: metrics.get(f"{q}.{MEASURE.get(solver, 'max')}") for q in QUANTITIES}
        ratio = data["contact"]["stiffness"] / data["block"]["young"]
        found.append(Cell(name, solver, ratio, data["time"]["step"], rows[entry["key"]], errors))
    return found


def stability_chapter(results: Results, manifest: Manifest, directory: Path) -> list[Block]:
    """Return the chapter of a study of extremes."""
    found = cells(results, manifest)
    blocks = [*opening(manifest, lead=conclusion(found)), outcome_table(found)]
    matrix = [cell for cell in found if cell.scene.startswith(MATRIX)]
    for solver in SOLVERS:
        blocks += _maps(manifest["study"], [cell for cell in matrix if cell.solver == solver], directory)
    return [*blocks, *factor_tables([c for c in found if c.scene.startswith(FACTOR)])]


def _numbers(found: Iterable[Cell], quantity: str) -> list[float]:
    values = [cell.errors.get(quantity) for cell in found]
    return [float(v) for v in values if isinstance(v, int | float)]


def digits(error: float) -> int:
    """Return the whole number of correct digits."""
    return int(digits_of(np.array(error)))


def conclusion(found: Sequence[Cell]) -> str:
    """Say in one sentence how many digits each solver keeps at least, and how runs beyond their limit end."""
    said = []
    for solver in SOLVERS:
        own = [c for c in found if c.solver == solver and (solver != "fem" or 1e-3 <= c.ratio <= 1e12)]
        worst = [*_numbers(own, "displacement"), *_numbers(own, "pressure")]
        if worst:
            where = " for p/E from 10⁻³ to 10¹²" if solver == "fem" else ""
            said.append(f"{solver} {digits(max(worst))}{where}")
    ends = Counter(cell.row.outcome for cell in found if cell.solver == "dda")
    grown, odd = ends[Outcome.UNSTABLE] + ends[Outcome.OVERFLOW], ends[Outcome.MISPREDICTED]
    tail = f"; {grown} runs of dda left their bounds, {f'all but {odd} more' if odd else 'all'} as predicted"
    return f"Fewest correct digits, in both quantities: {', '.join(said)}{tail if grown else ''}."


def outcome_table(found: Sequence[Cell]) -> Table:
    """Return how often each outcome was met, by solver."""
    kinds = [str(kind) for kind in Stability]
    rows = []
    for solver in SOLVERS:
        count: Counter[str] = Counter()
        for cell in (c for c in found if c.solver == solver):
            kind = cell.row.metrics.get("stability.kind")
            named = cell.row.outcome in (Outcome.COMPLETED, Outcome.UNSTABLE, Outcome.OVERFLOW) and kind in kinds
            count[str(kind) if named else str(cell.row.outcome)] += 1
        others = ", ".join(f"{name} {n}" for name, n in count.items() if name not in kinds)
        rows.append((solver, *(str(count.get(kind, 0)) for kind in kinds), others or DASH))
    titles = (Column("Solver"), *columns("decimal", *kinds), Column("otherwise", "fill"))
    notes = tuple(f"{kind}: {kind.sentence}" for kind in Stability)
    caption = "Outcomes by name; the bar has no matrix and completes or does not apply."
    return Table(titles, tuple(rows), caption, notes)


def _maps(study: str, own: Sequence[Cell], directory: Path) -> list[Block]:
    """Return the two maps of one solver, worst over schemes, starts and discounts."""
    if not any(_numbers(own, quantity) for quantity in QUANTITIES):
        return []
    ratios, steps = sorted({c.ratio for c in own}), sorted({c.step for c in own})
    maps = [DigitMap(title, _worst(own, q, ratios, steps)) for q, title in QUANTITIES.items()]
    drawn = digit_maps(maps, [*map(_decade, ratios)], [*map(_decade, steps)], "Time step dt [s]", "p / E")
    solver = own[0].solver
    over = "over the static value where nothing has arrived, " if solver == "bar" else ""
    caption = f"{solver}: correct digits, {over}the worst of all bounded schemes; blank: no bounded run."
    return [histories.saved(drawn, directory, f"{study}-digits-{solver}.svg", caption)]


def _worst(own: Sequence[Cell], quantity: str, ratios: Sequence[float], steps: Sequence[float]) -> Array:
    error = np.full((len(ratios), len(steps)), np.nan)
    for cell in own:
        value = cell.errors.get(quantity)
        if isinstance(value, int | float):
            i, j = ratios.index(cell.ratio), steps.index(cell.step)
            error[i, j] = np.fmax(error[i, j], float(value))
    return error


def _decade(value: float) -> str:
    return f"$10^{{{round(math.log10(value))}}}$"


def factor_tables(found: Sequence[Cell]) -> list[Block]:
    """Return one table of the one-factor extremes: radius, condition, residual and digits."""
    by_key = {(c.scene, c.solver): c for c in found}
    scenes = dict.fromkeys(c.scene for c in found)
    rows = [_factor_row(scene, by_key) for scene in scenes]
    if not rows:
        return []
    if len(rows) > MOST_ROWS:
        fewest = sorted(rows, key=lambda row: _fewest(by_key.get((row[0], "dda"))))[:MOST_ROWS]
        rows = [row for row in rows if row in fewest]
    titles = (
        Column("Scene", "id"),
        *columns("decimal", "|λ|", "condition", "residual", group="dda"),
        *columns("decimal", "dda", "dda-textbook", "fem", group="Digits of displacement / pressure"),
    )
    left = len(rows) < len(scenes)
    caption = f"The {len(rows)} of {len(scenes)} runs in which dda keeps the fewest digits." if left else ""
    return [Heading("One datum at its extremes", 3), Table(titles, tuple(rows), caption, ruled=False)]


def _factor_row(scene: str, found: Mapping[tuple[str, str], Cell]) -> tuple[str, ...]:
    own = found.get((scene, "dda"))
    metrics = own.row.metrics if own else {}
    shown = [_shown(metrics.get(f"stability.{name}")) for name in ("radius", "condition", "residual")]
    return (scene, *shown, *(_both(found.get((scene, solver))) for solver in ("dda", "dda-textbook", "fem")))


def _fewest(cell: Cell | None) -> float:
    """Return the fewest digits that a run keeps in either quantity; without end where it has no errors."""
    values = [] if cell is None else [*_numbers([cell], "displacement"), *_numbers([cell], "pressure")]
    return digits(max(values)) if values else math.inf


def _shown(value: Value) -> str:
    return (short(value, 3) if abs(value) > 1e-300 else "0") if isinstance(value, float) else DASH


def _both(cell: Cell | None) -> str:
    """Return the digits of both quantities, or the outcome where there are none."""
    if cell is None:
        return DASH
    values = [cell.errors.get(quantity) for quantity in QUANTITIES]
    if not all(isinstance(v, int | float) for v in values):
        return DASH if cell.row.outcome is Outcome.COMPLETED else str(cell.row.outcome)
    return " / ".join(str(digits(float(v))) for v in values if isinstance(v, int | float))
