"""Files: written whole or not at all, histories as CSV tables."""

from __future__ import annotations

import contextlib
import csv
import errno
import io
import os
import re
import shutil
import stat
import tempfile
from collections.abc import Callable, Iterable, Iterator
from pathlib import Path
from typing import IO

import numpy as np

from validation.errors import InputError
from validation.runs import extras
from validation.runs.defects import Place
from validation.runs.history import Array, History
from validation.runs.regular import kind_of
from validation.runs.tables import meant, number, read_text, rows_of

FIGURE_ENDINGS = (".svg", ".pdf", ".png")
# What numpy reads as it is read below.
_PLAIN = re.compile(r"time(?:,\w+)+(?:\n[-+.eE\d]+(?:,[-+.eE\d]+)*)+\n?", re.ASCII)


@contextlib.contextmanager
def atomic_path(path: Path) -> Iterator[Path]:
    """Yield a temporary path of the same ending; what stands there when the block ends well becomes the file.

    A regular file appears under its name at once, a link keeps its target and its target is written, a pipe or a
    character device is written to.

    Raises
    ------
    InputError
        The directory or the file cannot be written, or what stands there is a directory, a socket or a disk.
    """
    temporary = ""
    try:
        is_stream = _is_stream(path)
        target = check_output(path)
        directory = None if is_stream else target.parent
        handle, temporary = tempfile.mkstemp(dir=directory, prefix=f".{target.stem}.", suffix=path.suffix)
        os.close(handle)
        yield Path(temporary)
        if is_stream:
            _copy_into(target, Path(temporary))
            Path(temporary).unlink()
        else:
            mask = os.umask(0)
            os.umask(mask)
            os.chmod(temporary, 0o666 & ~mask)
            os.replace(temporary, target)
    except BaseException as error:
        if temporary:
            Path(temporary).unlink(missing_ok=True)
        if isinstance(error, OSError):
            raise InputError(
                f"cannot be written: {error.strerror}", source=path, advice="choose another place"
            ) from None
        raise


@contextlib.contextmanager
def atomic_directory(out: Path) -> Iterator[Path]:
    """Yield a temporary directory beside `out`, which takes its name and its place when the block ends well.

    Raises
    ------
    InputError
        The directory cannot be made or replaced.
    """
    target = Path(os.path.realpath(out))  # of a link the directory that it names is replaced, and the link stays
    temporary = None
    if target.exists() and not target.is_dir():
        raise InputError("must be a directory", source=out, value=kind_of(target.stat().st_mode))
    try:
        target.parent.mkdir(parents=True, exist_ok=True)
        temporary = Path(tempfile.mkdtemp(dir=target.parent, prefix=f".{target.name}."))
        new = temporary / "new"
        old = temporary / "old"
        new.mkdir()
        yield new
        if target.exists():
            os.replace(target, old)
        try:
            os.replace(new, target)
        except OSError:
            if old.exists():
                os.replace(old, target)
            raise
    except OSError as error:
        raise InputError(f"cannot be written: {error.strerror}", source=out, advice="choose another place") from None
    finally:
        if temporary is not None:
            shutil.rmtree(temporary, ignore_errors=True)


def check_place(out: Path, mark: str, what: str) -> None:
    """Refuse a place that will be replaced as a whole and is neither empty nor an earlier `what`.

    That has a file of the name `mark`.
    """
    is_empty = out.is_dir() and not any(out.iterdir())
    if out.exists() and not is_empty and not (out / mark).is_file():
        raise InputError(f"must be a new or empty directory or an earlier {what}", source=out)


def check_output(path: Path) -> Path:
    """Return what a path that will be written leads to; refuse one that cannot be.

    Raises
    ------
    InputError
        A directory, a socket or a disk stands there, a link leads to itself, or the directory does not exist.
    """
    if "\0" in str(path):
        raise InputError("must not hold a NUL", field="path", value=repr(str(path)))
    target = path if _is_stream(path) else Path(os.path.realpath(path))
    if target.is_symlink() and not target.exists():
        raise InputError("cannot be written: a link that leads to itself", source=path, advice="choose another place")
    if not target.parent.is_dir():
        raise InputError(
            f"cannot be written: {target.parent} is not a directory", source=path, advice="choose another place"
        )
    if target.exists():
        mode = target.stat().st_mode
        if not (stat.S_ISREG(mode) or stat.S_ISFIFO(mode) or stat.S_ISCHR(mode)):
            raise InputError("must be a file, a pipe or a character device", source=path, value=kind_of(mode))
    return target


def _is_stream(path: Path) -> bool:
    """Whether bytes go into what is there: a pipe, a device, or an open descriptor such as /dev/stdout."""
    if not path.exists():
        return False
    if not path.is_file():
        return not path.is_dir()
    link = path
    while link.is_symlink():
        if link.parent.resolve().parts[1:2] == ("proc",):
            return True
        link = link.parent / os.readlink(link)
    return False


def _copy_into(target: Path, content: Path) -> None:
    """Write a file's bytes into a pipe or a device, which keeps its kind; a pipe that nobody reads is refused."""
    try:
        handle = os.open(target, os.O_WRONLY | os.O_APPEND | os.O_NONBLOCK)  # without waiting for a reader
    except OSError as error:
        if error.errno == errno.ENXIO:
            raise InputError(
                "is a pipe that no program reads", source=target, advice="start the reader first"
            ) from None
        raise
    os.set_blocking(handle, True)
    with os.fdopen(handle, "wb") as stream, content.open("rb") as source:
        shutil.copyfileobj(source, stream)


def write_new(path: Path, text: str) -> None:
    """Write a text into a directory that nobody has yet, with the same line ends everywhere."""
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_bytes(text.encode())


def write_atomically(path: Path, write: Callable[[IO[bytes]], object]) -> None:
    """Write a file by `atomic_path`, so that no half-written file is ever seen."""
    with atomic_path(path) as temporary, temporary.open("wb") as stream:
        write(stream)


def write_text(path: Path, text: str) -> None:
    """Write a text as `write_atomically` does, in UTF-8."""
    write_atomically(path, lambda stream: stream.write(text.encode()))


def csv_text(rows: Iterable[Iterable[object]]) -> str:
    """Return rows as CSV."""
    text = io.StringIO(newline="")
    csv.writer(text, lineterminator="\n").writerows(rows)
    return text.getvalue()


def check_ending(path: Path | None, field: str) -> None:
    """Raise InputError for a figure's file that ends in none of `FIGURE_ENDINGS`, or where figures cannot be drawn."""
    if path is None:
        return
    if path.suffix.lower() not in FIGURE_ENDINGS:
        raise InputError(f"must end in {', '.join(FIGURE_ENDINGS)}", field=field, value=repr(path.name))
    extras.require(field, *extras.FIGURES)


def write_csv(history: History, path: Path) -> None:
    """Write a history as CSV with full double precision, header ``time,displacement,...``."""
    table = np.column_stack([history.time, *history.columns.values()])
    write_text(path, csv_text([["time", *history.columns], *table.tolist()]))


def read_table(path: Path) -> tuple[list[str], Array]:
    """Read a table of numbers under a header that begins with time: names and values, a row a time.

    Raises
    ------
    InputError
        The file cannot be read or is not such a table.
    """
    try:
        text = read_text(path)
    except OSError as error:
        raise InputError(f"cannot be read: {error.strerror}", source=path) from None
    if _PLAIN.fullmatch(text):
        names = text.partition("\n")[0].split(",")
        with contextlib.suppress(ValueError):  # what is wrong is found below, with its place
            table = np.loadtxt(io.StringIO(text), delimiter=",", skiprows=1, ndmin=2)
            if table.shape[1] == len(names):
                return names, table
    header, *rows = rows_of(text) or [[]]
    names = [cell.text for cell in header]
    if not names or names[0] != "time" or not all(names):
        raise InputError("header must begin with time and name every column", source=path, value=repr(",".join(names)))
    if not rows:
        raise InputError("must hold rows of numbers under the header", source=path, value="none")
    table = np.empty((len(rows), len(names)))
    for i, row in enumerate(rows):
        if len(row) != len(names):
            place = Place(path, row[0].line)
            raise InputError(f"must have {len(names)} numbers under the header", source=place, value=len(row))
        for j, cell in enumerate(row):
            value = number(cell.text)
            if value is None:
                place = Place(path, cell.line, cell.column)
                raise InputError("must be a number", source=place, value=repr(cell.text), advice=meant(cell.text))
            table[i, j] = value
    return names, table
