"""Entry point of the command line: the commands, and errors as one line with an exit status."""

from __future__ import annotations

import os
import sys

import typer

from validation.cli import compare, damping, report, run, verdicts, work
from validation.cli.app import BAD_INPUT, INTERRUPTED, PASSED, app
from validation.cli.signals import caught, interruption
from validation.errors import InputError

COMMANDS = (run, report, damping, compare, verdicts, work)  # importing them declares their commands
USAGE_ERROR: type[Exception] = typer.BadParameter.__mro__[1]  # typer exports no name for the base of its usage errors


@caught()
def main() -> None:
    """Run the command line; bad input is one line and status 2, an interruption 130, or 128 and the signal."""
    try:
        status = app(standalone_mode=False)
    except InputError as error:
        _stop(f"error: {error}", BAD_INPUT)
    except USAGE_ERROR as error:
        text = " ".join(error.format_message().split())  # type: ignore[attr-defined]
        _stop(f"error: {text} (see dda-validate --help)", BAD_INPUT)
    except (KeyboardInterrupt, typer.Abort):
        status = INTERRUPTED
    except BrokenPipeError:
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
        status = PASSED
    if status == INTERRUPTED:  # which typer may have made of the interruption itself
        typer.echo("interrupted: finished rows are kept; run the same command again to continue", err=True)
        sys.stdout.flush()
        os._exit(interruption())  # not through the pool's own exit, which may wait for a worker that is gone
    sys.exit(status or PASSED)


def _stop(line: str, status: int) -> None:
    typer.echo(line, err=True)
    sys.exit(status)
