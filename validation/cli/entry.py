"""Entry point of the command line: the commands, and errors as one line with an exit status."""

from __future__ import annotations

import sys
from collections.abc import Callable
from functools import cache

import typer

from validation.cli import compare, contact, damping, gallery, judge, report, run, show, verdicts, waves, work
from validation.cli.app import BAD_INPUT, INTERRUPTED, PASSED, app
from validation.cli.printing.output import prepare, silence
from validation.cli.signals import caught, end
from validation.errors import InputError
from validation.runs.text import printable

COMMANDS = (
    run,
    show,
    report,
    gallery,
    damping,
    contact,
    compare,
    judge,
    verdicts,
    waves,
    work,
)  # importing them declares their commands
FIRST = (
    "list",
    "show",
    "run",
    "solve",
    "report",
    "figures",
    "gallery",
    "compare",
    "judge",
    "damping",
    "advise",
)  # of the help
USAGE_ERROR: type[Exception] = typer.BadParameter.__mro__[1]  # typer exports no name for the base of its usage errors


def _place(name: str | None) -> int:
    return FIRST.index(name) if name in FIRST else len(FIRST)


app.registered_commands.sort(key=lambda command: _place(command.name or getattr(command.callback, "__name__", None)))


@caught()
def main() -> None:
    """Run the command line; bad input is one line and status 2, an interruption 130, or 128 and the signal."""
    prepare()
    status = _guarded(lambda: _commands()(standalone_mode=False))
    if status == INTERRUPTED:  # which typer may have made of the interruption itself
        _guarded(sys.stdout.flush)
        end()
    sys.exit(_guarded(sys.stdout.flush) or status)


@cache
def _commands() -> Callable[..., object]:
    """Return the commands, which typer reads from the signatures of their functions, once in a process."""
    return typer.main.get_command(app)


def _guarded(act: Callable[[], object]) -> int:
    """Return the status of a command, or of an error, which is one line."""
    try:
        status = act()
        return status if isinstance(status, int) else PASSED
    except InputError as error:
        return _said(f"error: {printable(str(error))}")
    except USAGE_ERROR as error:
        return _said(f"error: {printable(error.format_message())} (see dda-validate --help)")  # type: ignore[attr-defined]
    except (KeyboardInterrupt, typer.Abort) as stop:
        if isinstance(stop.__cause__, EOFError):  # typer takes it for the end of an answer; nothing is asked here
            raise stop.__cause__ from None
        return INTERRUPTED
    except BrokenPipeError:  # what decides a status has been said before
        silence()
        return PASSED
    except OSError as error:
        silence()
        return _said(f"error: {error.filename or 'standard output'}: {error.strerror or error}")


def _said(line: str) -> int:
    typer.echo(line, err=True)
    return BAD_INPUT
