"""Options that commands share."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

RanksOption = Annotated[
    int, typer.Option("--ranks", help="MPI ranks of the solvers that can be distributed (fenicsx).", min=1, metavar="N")
]
SummaryOption = Annotated[
    Path | None,
    typer.Option("--summary", help="Write the verdicts as Markdown, for the summary page of a CI job.", metavar="FILE"),
]
BaselineOption = Annotated[
    Path | None,
    typer.Option(
        "--baseline",
        help="Verdicts of an earlier run (verdicts.json or a results directory): fail only on what got worse.",
        metavar="FILE",
    ),
]
