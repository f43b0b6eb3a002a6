"""Standard output that nobody reads, that is closed or full, or that cannot write a character."""

from __future__ import annotations

import io
import json
import os
import sys
from collections.abc import Iterable, Iterator, Sequence
from contextlib import contextmanager, suppress
from textwrap import wrap
from typing import TYPE_CHECKING, Any

import typer

from validation.advice.plain import Line, PlainAnswer, in_columns, plain
from validation.runs.text import visible

if TYPE_CHECKING:
    from rich.console import Console

    from validation.report.blocks import Block
    from validation.report.render.terminal import StyledLine

PAGE = 150  # characters of a line where the output is no terminal


def prepare() -> None:
    """Let the streams write every character, as an escape where need be, and be there."""
    for name in ("stdout", "stderr"):
        stream = getattr(sys, name)
        if stream is None:  # closed by who started this process
            setattr(sys, name, open(os.devnull, "w"))  # noqa: SIM115 - as long as the process
        elif isinstance(stream, io.TextIOWrapper):
            stream.reconfigure(errors="backslashreplace")


def echo(text: str = "", err: bool = False) -> None:
    """Print lines of text; characters that would act on a terminal are written as escapes."""
    typer.echo(visible(text), err=err)


def echo_json(data: Any) -> None:
    """Print plain data as JSON."""
    echo(json.dumps(data, indent=1, allow_nan=False))


def echo_answer(answer: PlainAnswer | dict[str, Any], lines: Iterable[str], as_json: bool) -> None:
    """Print an answer as plain data, or its lines."""
    if as_json:
        echo_json(plain(answer.as_dict() if isinstance(answer, PlainAnswer) else answer))
        return
    for line in lines:
        echo(broken(line))


def columns(lines: Sequence[Line]) -> str:
    """Return lines with their columns aligned, the last one wrapped to a terminal."""
    return in_columns(lines, terminal_width())


def print_blocks(blocks: Iterable[Block]) -> None:
    """Print blocks, their lines broken at the width of a terminal."""
    from validation.report.render.terminal import lines

    print_lines(lines(blocks, terminal_width()))


def print_lines(lines: Iterable[StyledLine]) -> None:
    """Print lines, with the style of its verdict on the first word or, in a line of counts, on all of it."""
    from rich.text import Text

    from validation.report.render.terminal import STYLES

    printer = console()
    if printer.color_system is None:  # which no style would be seen in
        for text, _ in lines:
            echo(text)
        return
    for text, word in lines:
        styled_text = Text(text)
        if word:
            end = len(word) if text.startswith(word) else len(text)
            styled_text.stylize(STYLES[word], 0, end)
        printer.print(styled_text, soft_wrap=True)


@contextmanager
def tolerate_closed_pipe() -> Iterator[None]:
    """Go on where the reader of the output has gone: what is left to say decides nothing."""
    try:
        yield
        sys.stdout.flush()
    except BrokenPipeError:
        silence()


def silence() -> None:
    """Send the rest of the output nowhere."""
    with suppress(OSError, ValueError):
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())


def console() -> Console:
    """Return a console of the library rich that leaves a reader who has gone to `tolerate_closed_pipe`."""
    from rich.console import Console
    from rich.text import Text

    class Plain(Console):
        def print(self, *objects: Any, **options: Any) -> None:  # as `echo`; the cells of tables are printable
            super().print(*map(self._visible, objects), **options)

        @staticmethod
        def _visible(printed: Any) -> Any:
            if isinstance(printed, Text) and visible(printed.plain) != printed.plain:
                return Text(visible(printed.plain), style=printed.style)
            return visible(printed) if isinstance(printed, str) else printed

        def on_broken_pipe(self) -> None:  # rich would end the process
            raise

    width = None if sys.stdout.isatty() else PAGE
    return Plain(width=width)


def width() -> int:
    """Return the characters of a line: those of the terminal, or `PAGE` where the output is none."""
    return console().width


def broken(text: str) -> str:
    """Return text with its long lines broken at the width of the terminal; as it is where the output is none."""
    columns = terminal_width()
    if columns is None:
        return text
    lines = []
    for line in text.split("\n"):
        is_long = len(line) > columns
        lines += wrap(line, columns, break_long_words=False, break_on_hyphens=False) if is_long else [line]
    return "\n".join(lines)


def terminal_width() -> int | None:
    """Return the characters of a line of the terminal; None where the output is none, and lines are not broken."""
    return console().width if sys.stdout.isatty() else None
