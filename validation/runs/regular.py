"""Files that can be read as a whole, apart from pipes, which wait for a writer, and devices, which may never end."""

from __future__ import annotations

import math
import stat
from pathlib import Path

from validation.errors import InputError

KINDS = (
    (stat.S_ISREG, "file"),
    (stat.S_ISDIR, "directory"),
    (stat.S_ISFIFO, "pipe"),
    (stat.S_ISSOCK, "socket"),
    (stat.S_ISCHR, "device"),
    (stat.S_ISBLK, "disk"),
)


def kind_of(mode: int) -> str:
    """Return what stands at a path with this mode, as "a pipe"."""
    return f"a {next((name for is_kind, name in KINDS if is_kind(mode)), 'special file')}"


def regular(path: Path, largest: float = math.inf) -> None:
    """Refuse what is there but no file of at most `largest` bytes: a pipe waits and a device ends for nobody.

    Raises
    ------
    InputError
        It is a directory, a pipe, a socket or a device, or it is larger.
    OSError
        It is not there, or is out of reach.
    """
    if "\0" in str(path):
        raise InputError("must not hold a NUL", field="path", value=repr(str(path)))
    status = path.stat()
    if not stat.S_ISREG(status.st_mode):
        raise InputError("must be a regular file", source=path, value=kind_of(status.st_mode))
    if status.st_size > largest:
        raise InputError(f"must be at most {largest:.0f} bytes", source=path, value=status.st_size)


def regular_or_absent(path: Path) -> bool:
    """Whether a file is there, where nothing but a regular file may be.

    Raises
    ------
    InputError
        Something else is there.
    OSError
        It is out of reach.
    """
    try:
        regular(path)
    except FileNotFoundError:
        return False
    return True
