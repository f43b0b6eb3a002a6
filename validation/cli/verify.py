"""The command ``verify``: what is verified, and one phenomenon run and judged."""

from __future__ import annotations

import tempfile
from contextlib import nullcontext
from pathlib import Path
from typing import Annotated

import typer

from validation.cli.app import GATE_FAILED, PASSED, RESULTS, JsonOption, ResultsOption, _progress, app
from validation.cli.printing.output import echo, echo_json, print_blocks
from validation.cli.run import default_jobs


def known_phenomena(incomplete: str) -> list[str]:
    """Return the phenomena that a shell may complete a word to."""
    from validation.suite.matrix import phenomena

    return [one.name for one in phenomena() if one.name.startswith(incomplete)]


@app.command()
def verify(
    name: Annotated[
        str | None,
        typer.Argument(
            help="A phenomenon, a part of its name, or its study; without one all are listed.",
            metavar="[PHENOMENON]",
            autocompletion=known_phenomena,
        ),
    ] = None,
    solver: Annotated[
        str,
        typer.Option(
            help="Who answers in the place of dda: module:attribute, ./program or a name of `list solvers`.",
            metavar="NAME",
        ),
    ] = "dda",
    results: ResultsOption = RESULTS,
    jobs: Annotated[int | None, typer.Option(help="Worker processes; default: the machine's cores.", min=1)] = None,
    verbose: Annotated[
        bool, typer.Option("--verbose", "-v", help="Print every gate, not the tightest of each reason.")
    ] = False,
    as_json: JsonOption = False,
) -> None:
    """List what is verified, or run what verifies one phenomenon and print truth, band, value and margin of its gates.

    Of the gates with one reason the tightest is printed, and every one that fails. A margin is how much of the way from
    the truth to the edge of the band the value leaves. What is verified, by which sources, and what is missing is the
    page verification of the documentation. Exit status: 0 all passes, 1 something fails or nothing was judged, 2 bad
    input. `--solver my_solver:solve` judges a program of yours.

    Example: [bold]dda-validate verify ledge[/bold]
    """
    from validation.gates.gate import Status
    from validation.report.blocks import table
    from validation.report.verification import truth_counts, verdict_blocks
    from validation.runs.results import Results
    from validation.solvers.registry import get_solver
    from validation.suite.matrix import JUDGED, phenomena, phenomenon
    from validation.suite.matrix import verify as judged

    if name is None:
        rows = [(shown.name, shown.study, truth_counts(shown)) for shown in phenomena()]
        print_blocks([table(("phenomenon", "study", "gates by truth"), rows)])
        return
    shown = phenomenon(name)
    get_solver(solver).check_loads()
    # What another answers is kept nowhere: its rows have the name of `dda`.
    place = nullcontext(results) if solver == JUDGED else tempfile.TemporaryDirectory()
    with place as directory, _progress("verify") as progress:
        verdicts, remarks = judged(shown, Results(Path(directory)), solver, jobs or default_jobs(), progress)
    if as_json:
        echo_json([verdict.record(shown.study) for verdict in verdicts])
    else:
        print_blocks(verdict_blocks(shown, verdicts, verbose))
        for remark in remarks:
            echo(remark)
    judged_ones = [verdict.status for verdict in verdicts if verdict.status is not Status.NOT_RUN]
    raise typer.Exit(GATE_FAILED if not judged_ones or Status.FAIL in judged_ones else PASSED)
