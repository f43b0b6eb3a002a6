"""The page of `judge`: the verdict on an answer, the curves, what the answer says of itself."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

from validation.problems.bands import Standard
from validation.problems.data import united
from validation.problems.judge import Column, Judgement, Word
from validation.problems.problem import Problem
from validation.problems.told import COUNTED, Told
from validation.report.blocks import Block, Callout, FigureBlock, Paragraph, Table, columns
from validation.report.blocks import Column as TableColumn
from validation.report.chapters.text import DASH, bounded, plain, short
from validation.report.figures.curves import EXACT, Panel
from validation.runs.history import History

if TYPE_CHECKING:
    from validation.problems.cause import Cause

ANSWER = "answer"
ALLOWED = (
    "Allowed is what one per cent of the datum that is named changes in the exact motion: data of a block are not "
    "known to better than one per cent, and an error below that changes nothing for its user."
)


@dataclass(frozen=True, eq=False)
class Judged:
    """An answer with all that is said of it."""

    problem: Problem
    history: History
    held: Standard
    judgement: Judgement
    cause: Cause | None  # of a failure
    about: tuple[tuple[str, str], ...]  # what the answer says of itself: field and text
    warnings: tuple[str, ...] = ()  # what makes the verdict worth less, in sentences


def headline(judged: Judged) -> str:
    """Return the verdict and what it rests on, in a sentence."""
    found = judged.judgement
    decides = found.deciding
    if decides is None or decides.band is None:
        return f"{found.verdict}: no column of it is judged."
    off = f"{per_cent(decides.error)} off in {united(decides.name)}, where {per_cent(decides.band)} is allowed"
    within = found.word in (Word.PASS, Word.PARTIAL)
    return f"{found.verdict}: it is at most {off}." if within else f"{found.verdict}: it is {off}."


def reached(judged: Judged) -> str:
    """Return how far an answer that fails is right, in a sentence."""
    within, until = judged.judgement.within, max(column.until for column in judged.judgement.columns)
    if not within:
        return "Its error is more than what is allowed from the first step on."
    return f"Its error is within what is allowed up to {short(within)} s of {short(until)} s."


def per_cent(share: float | None) -> str:
    """Return an error in per cent."""
    if share is None:
        return DASH
    return "below 1e-9 %" if share < 1e-11 else f"{short(100 * share, 2)} %"


def page(judged: Judged, directory: Path) -> list[Block]:
    """Return the blocks of the page; its figures are written to a directory."""
    found = judged.judgement
    tone = {Word.PASS: "pass", Word.FAIL: "fail"}.get(found.word, "warn")
    blocks: list[Block] = [Callout(headline(judged), tone)]  # type: ignore[arg-type]
    blocks += [Callout(sentence, "warn") for sentence in judged.warnings]
    if judged.cause is not None:
        blocks.append(Paragraph(f"Cause: {judged.cause.sentence}. {reached(judged)}"))
        if judged.cause.would_tell:
            blocks.append(Paragraph(f"What would tell: {judged.cause.would_tell}."))
    return [
        *blocks,
        Paragraph(f"The question: {judged.problem.asks} {judged.problem.title}."),
        _columns(found.columns, judged.held),
        *figures(judged, directory),
        *([_told(found.told)] if found.told else []),
        _about(judged.about),
    ]


def figures(judged: Judged, directory: Path) -> Sequence[FigureBlock]:
    """Draw every column that is judged, with the exact one."""
    from validation.report.figures import histories, motion  # which load matplotlib; a verdict alone needs none

    drawn = []
    for name in judged.history.columns:
        rows = len(judged.held.exact.time)
        lines = {
            EXACT: History(judged.held.exact.time, {name: judged.held.exact.columns[name]}),
            ANSWER: History(judged.history.time[:rows], {name: judged.history.columns[name][:rows]}),
        }
        panel = Panel(f"{united(name).rpartition('_')[0].replace('_', ' ')}", lines, {}, EXACT)
        if ANSWER in motion.twins([panel], [name]).get(EXACT, {}):
            caption = f"The answer lies on the exact motion: {united(name)}."
        else:
            caption = (
                f"The answer beside the exact motion, and their difference over its largest value: {united(name)}."
            )
        figure = motion.history_figure([panel], name, apart=True)
        drawn.append(histories.saved(figure, directory, f"judged-{name}.svg", caption))
    return drawn


def _columns(found: Sequence[Column], held: Standard) -> Table:
    titles = (
        TableColumn("Column"),
        TableColumn("Verdict", "outcome"),
        *columns("decimal", "Error [%]", "Allowed [%]"),
        TableColumn("Set by"),
        TableColumn("Until [s]", "decimal"),
    )
    rows = []
    for one in found:
        error, band = (DASH if share is None else short(100 * share, 2) for share in (one.error, one.band))
        rows.append((united(one.name), str(one.word), error, band, datum(one, held) or DASH, plain(one.until)))
    unjudged = [f"{united(one.name)}: {one.reason}." for one in found if one.band is None]
    return Table(titles, tuple(rows), "Relative L2 error of each column.", (ALLOWED, *unjudged))


def datum(column: Column, held: Standard) -> str:
    """Return the datum of which one per cent sets a column's band, nothing where it has none."""
    band = held.bands.get(column.name)
    return band.datum if band else ""


def _told(found: Sequence[Told]) -> Table:
    titles = (TableColumn("Number", "fill"), *columns("decimal", "Answer", "Exact"), TableColumn("Unit"))
    rows = [(one.name, _value(one, one.value), _value(one, one.exact), one.unit) for one in found]
    return Table(titles, tuple(rows), "Further numbers, which are not judged.")


def _value(told: Told, value: float | None) -> str:
    if value is None:
        return DASH
    return f"{value:.0f}" if told.name in COUNTED else bounded(value, plain(value))


def _about(said: Sequence[tuple[str, str]]) -> Table:
    return Table((TableColumn("Of the answer"), TableColumn("", "fill")), tuple(said))
