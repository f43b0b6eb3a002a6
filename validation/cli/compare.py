"""The command ``compare``: a history of another program, judged."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from validation.cli.app import ColumnsOption, JsonOption, ScaleOption, SetOption, _progress, app, one_case, writable_pdf
from validation.cli.printing.output import echo_answer

if TYPE_CHECKING:
    from validation.diagnosis.answer import Answer


@app.command()
def compare(
    scene: Annotated[str, typer.Argument(help="Built-in scene or scene file: what the program was asked to compute.")],
    history: Annotated[
        Path, typer.Argument(help="The history: a table under a header, or a measured-point file of ntdda (.m).")
    ],
    columns: ColumnsOption = None,
    scale: ScaleOption = None,
    tolerance: Annotated[
        float, typer.Option(help="Relative difference (L2) up to which a column counts as the same.", min=0.0, max=1.0)
    ] = 0.0,
    report: Annotated[
        Path | None,
        typer.Option("--out", help="Write a one-page report.", metavar="FILE.pdf", callback=writable_pdf),
    ] = None,
    figure: Annotated[
        Path | None,
        typer.Option(
            help="Draw both histories and their difference, as wide as a slide.", metavar="FILE.svg|.pdf|.png"
        ),
    ] = None,
    assignments: SetOption = None,
    as_json: JsonOption = False,
) -> None:
    """Judge another program's history: same model and scheme, or where and how it departs, and why.

    The scene states what the program was asked to compute: a block, or a column whose contacts open or slip. The
    history's own time step is used. Exit status: 0 the scene's own history, 1 another one, 2 bad input.

    Example: [bold]dda-validate compare figures-3-4 theirs.csv --set time.step=0.002 --columns time=t,displacement=uy
    --scale displacement=-1e-3[/bold]
    """
    from validation.diagnosis.hooks import DiagnosisHooks
    from validation.diagnosis.judgement import compare as judge
    from validation.diagnosis.reading import OURS, read
    from validation.runs.files import check_ending
    from validation.solvers.history_table import HeaderNames

    check_ending(figure, "--figure")
    case = one_case(scene, assignments)
    DiagnosisHooks.of(case).check(case)  # before its file is taken for a wrong one
    foreign = read(history, HeaderNames.typed(columns, scale, OURS))
    with _progress("compare"):
        answer = judge(case, foreign, tolerance)
    if report is not None:
        from validation.report.chapters.compare import write_page

        write_page(case, history.name, answer, report)
    if figure is not None:
        from validation.report.chapters.compare import answer_figure
        from validation.report.figures.response import save_as

        save_as(answer_figure(case, answer, slide=True), figure)
    echo_answer(answer.as_dict(), _lines(answer), as_json)
    if answer.departs:
        raise typer.Exit(1)


def _lines(answer: Answer) -> Iterator[str]:
    """Yield the sentence first, then what it rests on."""
    from validation.diagnosis.causes import CAUSES
    from validation.diagnosis.sentences import family, told_lines

    yield answer.sentence
    if answer.remedy:
        what = "run the scene" if answer.remedy.startswith("--set") else "read the history"
        yield f"to {what} so, add {answer.remedy}"
    if answer.causes:
        yield "\ncauses"
        for name in answer.causes:
            number = f"{answer.values[name]:.5g}" if name in answer.values else ""
            yield f"  {name:<18} {number:>10}  {CAUSES[name].words}"
    for alternative in answer.alike:
        further = alternative["further_scene"]
        yield f"\n{family(alternative)} would give the same history here; to tell them apart, try {further}"
    if answer.evidence:
        yield "\nevidence"
        for stage in answer.evidence:
            mark = {True: "right", False: "wrong", None: "-"}[stage.agrees]
            yield f"  {stage.name:<18} {mark:<6} {stage.words}"
    if answer.opened:
        yield f"\nthe contact opened: first step {answer.opened[0]}, last {answer.opened[1]}"
    rest = [*told_lines(answer.told, answer.untold), *(f"note: {note}" for note in answer.notes)]
    yield from ["", *rest] if rest else []
