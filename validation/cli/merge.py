"""The command ``merge``: shards of a run put together and judged as one run."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from validation.cli.app import BaselineOption, JsonOption, SummaryOption, app
from validation.cli.run import Judging, QuietOption, RequireOption, VerboseOption, answer_and_exit
from validation.cli.signals import promise_rows


@app.command()
def merge(
    directories: Annotated[
        list[Path], typer.Argument(help="Results directories of `dda-validate run --shard`.", metavar="DIR...")
    ],
    out: Annotated[Path, typer.Option("--out", help="Results directory to make.", metavar="DIR")],
    require: RequireOption = None,
    summary: SummaryOption = None,
    baseline: BaselineOption = None,
    verbose: VerboseOption = False,
    as_json: JsonOption = False,
    quiet: QuietOption = False,
) -> None:
    """Put the shards of a run together, judge the whole, and answer as an unsharded run does.

    No case is run. The studies and scene files are those that the shards were called with, found from here.

    Example: [bold]dda-validate merge part-1 part-2 part-3 --out merged[/bold]
    """
    import time

    from validation.engine import shards
    from validation.engine.run import judge_study, study_cases
    from validation.errors import InputError
    from validation.runs.files import atomic_directory
    from validation.runs.results import Results
    from validation.scenes.scene import parse_assignment
    from validation.suite.folders import resolve

    judging = Judging(require or [], summary, baseline, verbose, as_json, quiet)
    before = judging.check()
    if out.exists() and (not out.is_dir() or any(out.iterdir())):
        raise InputError("must be a new or empty directory", field="--out", value=repr(str(out)))
    finished_shards = shards.read_shards(directories)
    options = finished_shards[0].record["options"]
    promise_rows()
    studies = resolve(options["targets"], dict(map(parse_assignment, options["assignments"])))
    groups = [study_cases(study, options["full"], options["ranks"]) for study in studies]
    here = shards.record_of(finished_shards[0].shard, options, groups)
    shards.check_same(finished_shards[0].record, here, str(finished_shards[0]), "this installation")
    runs = []
    seconds = []
    with atomic_directory(out) as temporary:
        results = Results(temporary)
        shards.collect(finished_shards, groups, results)
        for group in groups:
            start = time.monotonic()
            runs.append(judge_study(group, results))
            seconds.append(time.monotonic() - start)
    answer_and_exit(runs, seconds, Results(out), judging, before)
