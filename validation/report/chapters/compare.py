"""The page of `compare --out`: the answer, the curves and the evidence."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

from validation.diagnosis.answer import Answer
from validation.diagnosis.causes import CAUSES
from validation.diagnosis.sentences import family, told_lines
from validation.report.blocks import Block, Blocks, Callout, Heading, Paragraph, TableColumn, table
from validation.report.chapters.text import parameters
from validation.report.figures import histories, motion
from validation.report.figures.charts import Figure
from validation.report.figures.curves import HistoryPanel
from validation.report.render.pdf import write_document
from validation.runs.history import DISPLACEMENT, PRESSURE
from validation.runs.numbers import DASH, short
from validation.scenes.scene import Scene

FIGURE = "compare.svg"


def write_page(scene: Scene, source: str, answer: Answer, out: Path) -> Path:
    """Write the answer as one PDF page and return its path.

    Raises
    ------
    InputError
        The file cannot be written.
    """
    return write_document(out, lambda directory: page(scene, source, answer, directory))


def answer_figure(scene: Scene, answer: Answer, slide: bool = False) -> Figure:
    """Draw the file, DDA and the best explanation; below, what these leave of the file's displacement."""
    of_file = next(iter(answer.curves))
    drawn = [name for name in (DISPLACEMENT, PRESSURE) if name in answer.curves[of_file].columns]
    title = f"displacement of the {scene.kind.point}" + (", contact pressure" if PRESSURE in drawn else "")
    panel = HistoryPanel(title, answer.curves, {}, of_file)
    return motion.history_figure([panel], *drawn, apart=True, slide=slide)


def page(scene: Scene, source: str, answer: Answer, directory: Path) -> Sequence[Block]:
    """Return the blocks of the page; its figure is written to a directory."""
    caption = (
        "The file, DDA on the scene allowing for what is no error, and the best explanation; below, what they leave of "
        "the file's displacement."
    )
    rest = [*told_lines(answer.told, answer.untold), *answer.notes]
    return [
        Heading(f"{source} beside {scene.name}"),
        Callout(answer.sentence, "warn") if answer.departure else Paragraph(answer.sentence, "lead"),
        Paragraph(parameters(scene, set()), "small"),
        histories.saved(answer_figure(scene, answer), directory, FIGURE, caption),
        *_facts(answer),
        *_evidence(answer),
        *(Paragraph(line, "small") for line in rest),
    ]


def _facts(answer: Answer) -> Blocks:
    rows = [(name, CAUSES[name].words + _number(answer, name)) for name in answer.causes]
    if answer.nearest:
        rows.append(("nearest", f"{family(answer.nearest)}: {short(100 * answer.unexplained, 2)} % left"))
    rows += [("same rows", f"{family(one)}; told apart by {one['further_scene']}") for one in answer.alike]
    if answer.departure:
        rows.append(("departure", f"step {answer.departure.step}, mainly in {answer.departure.kind}"))
    if answer.opened:
        rows.append(("contact open", f"first step {answer.opened[0]}, last {answer.opened[1]}"))
    return [table((TableColumn("Found", "code"), TableColumn("In words", "fill")), rows)] if rows else []


def _number(answer: Answer, name: str) -> str:
    return f": {short(answer.values[name], 5)}" if name in answer.values else ""


def _evidence(answer: Answer) -> Blocks:
    """Return what was measured before any cause was named."""
    marks = {True: "right", False: "wrong", None: DASH}
    rows = tuple((stage.name.replace("_", " "), marks[stage.agrees], stage.words) for stage in answer.evidence)
    titles = (TableColumn("Evidence", "code"), TableColumn("", "code"), TableColumn("In words", "fill"))
    return [table(titles, rows)] if rows else []
