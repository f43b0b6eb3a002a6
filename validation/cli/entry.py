"""Entry point of the command line: the commands, and errors as one line with an exit status."""

from __future__ import annotations

import inspect
import sys
import warnings
from collections.abc import Callable
from functools import cache
from pathlib import Path

import typer

from validation.cli import (
    advise,
    claims,
    compare,
    contact,
    judge,
    new,
    report,
    run,
    show,
    verdicts,
    verify,
    waves,
    work,
)
from validation.cli.app import BAD_INPUT, INTERRUPTED, PASSED, app, parts
from validation.cli.printing.output import echo, prepare, silence
from validation.cli.signals import end, interruptible
from validation.errors import InputError
from validation.runs import extras
from validation.runs.text import printable

COMMANDS = (
    run,
    new,
    show,
    report,
    claims,
    advise,
    contact,
    compare,
    judge,
    verdicts,
    verify,
    waves,
    work,
)  # importing them declares their commands
GROUPS = {  # of the help, each with its commands in their order, and their pages of the documentation
    "Scenes and runs": dict.fromkeys(("new", "list", "show", "run", "solve"), "tutorial.md"),
    "Results": {
        **dict.fromkeys(("report", "rows"), "gallery.md"),
        "claims": "claims.md",
        "verify": "verification.md",
        "diff": "ci.md",
    },
    "Your own code or program": {"judge": "judge.md", "compare": "judge.md", "export-pack": "judge.md"},
    "Time step, springs and damping": {"advise": "choose.md"},
}
PAGES = {name: page for pages in GROUPS.values() for name, page in pages.items()}
ORDER = list(PAGES)
OUT_OF_RANGE = (
    "the numbers leave the range of double precision; a value of the scene or an option is far too large or too small"
)
USAGE_ERROR: type[Exception] = typer.BadParameter.__mro__[1]  # typer exports no name for the base of its usage errors


def page_of(name: str) -> Path:
    """Return the page of a command: of the checkout, or where the wheel has put it below its environment."""
    page = PAGES[name]
    packages = Path(__file__).resolve().parents[2]
    installed = [folder / "share/doc/dda-validation" for folder in packages.parents]
    folders = (packages / "docs", packages / "share/doc/dda-validation", *installed)
    return next((folder for folder in folders if (folder / page).is_file()), folders[0]) / page


for command in (*app.registered_commands, *parts.registered_commands):
    command.name = command.name or str(getattr(command.callback, "__name__", ""))
    panels = [group for group, names in GROUPS.items() if command.name in names]
    command.rich_help_panel = panels[0] if panels else None  # the parts of a command stand in one
    # typer keeps the line breaks of a docstring, which are not those of a terminal
    paragraphs = (inspect.getdoc(command.callback) or "").split("\n\n")
    command.help = "\n\n".join(" ".join(paragraph.split()) for paragraph in paragraphs)
    command.epilog = f"Page: {page_of(command.name if panels and command.name else 'advise')}"
app.registered_commands.sort(key=lambda command: ORDER.index(command.name or ""))
(group,) = app.registered_groups
group.epilog = f"Page: {page_of('advise')}"
group.rich_help_panel = next(name for name, names in GROUPS.items() if group.name in names)


@interruptible()
def main() -> None:
    """Run the command line; bad input is one line and status 2, an interruption 130, or 128 and the signal."""
    prepare()
    with warnings.catch_warnings():
        # Where numbers leave the range a library's warning is no text for a terminal, and our own ends the command.
        warnings.filterwarnings("ignore", category=RuntimeWarning)
        warnings.filterwarnings("error", category=RuntimeWarning, module=r"(dda|fem_reference|validation)(\.|$)")
        status = _exit_status(lambda: command_line()(standalone_mode=False))
    if status == INTERRUPTED:  # which typer may have made of the interruption itself
        _exit_status(sys.stdout.flush)
        end()
    sys.exit(_exit_status(sys.stdout.flush) or status)  # noqa: TID251 - it is the end of the process


@cache
def command_line() -> Callable[..., object]:
    """Return the commands, which typer reads from the signatures of their functions, once in a process."""
    return typer.main.get_command(app)


def _exit_status(command: Callable[[], object]) -> int:
    """Return the status of a command, or of an error, which is one line."""
    try:
        status = command()
        return status if isinstance(status, int) else PASSED
    except InputError as error:
        return _print_error(f"error: {printable(str(error))}")
    except USAGE_ERROR as error:
        message = error.format_message()  # type: ignore[attr-defined]
        if not message:  # no command: typer has printed its help
            return BAD_INPUT
        return _print_error(f"error: {printable(message)} (see dda-validate --help)")
    except (KeyboardInterrupt, typer.Abort) as stop:
        if isinstance(stop.__cause__, EOFError):  # typer takes it for the end of an answer; nothing is asked here
            raise stop.__cause__ from None
        return INTERRUPTED
    except MemoryError:
        return _print_error(
            "error: there is not enough memory; take fewer steps, points, elements or worker processes (--jobs)"
        )
    except (ArithmeticError, RuntimeWarning) as error:
        return _print_error(f"error: {OUT_OF_RANGE} ({_last_argument(error)})")
    except (RuntimeError, ValueError) as error:
        if not _is_numerical(error):
            raise
        return _print_error(f"error: {OUT_OF_RANGE} ({_last_argument(error)})")
    except ModuleNotFoundError as error:
        if (error.name or "").partition(".")[0] not in extras.EXTRA_OF:
            raise
        return _print_error(f"error: {extras.sentence((error.name or '').partition('.')[0])}")
    except BrokenPipeError:  # what decides a status has been said before
        silence()
        return PASSED
    except OSError as error:
        silence()
        return _print_error(f"error: {error.filename or 'standard output'}: {error.strerror or error}")


def _is_numerical(error: Exception) -> bool:
    """Whether a library's linear algebra has met infinities, or a matrix that rounding has made singular."""
    return type(error).__name__ in ("LinAlgError", "ArpackError", "ArpackNoConvergence") or any(
        words in str(error) for words in ("exactly singular", "must not contain infs or NaNs")
    )


def _last_argument(error: BaseException) -> str:
    """Return what an error says in the end: errors of the system come with their number."""
    last = error.args[-1] if error.args else type(error).__name__
    return printable(str(last))


def _print_error(line: str) -> int:
    echo(line, err=True)
    return BAD_INPUT
