"""Files that can be read as a whole, apart from pipes, which wait for a writer, and devices, which may never end."""

from __future__ import annotations

import math
import stat
from pathlib import Path

from validation.errors import InputError

KINDS = (
    (stat.S_ISDIR, "directory"),
    (stat.S_ISFIFO, "pipe"),
    (stat.S_ISSOCK, "socket"),
    (stat.S_ISCHR, "device"),
    (stat.S_ISBLK, "device"),
)


def regular(path: Path, largest: float = math.inf) -> None:
    """Refuse what is there but no file of at most `largest` bytes: a pipe waits and a device ends for nobody.

    Raises
    ------
    InputError
        It is a directory, a pipe, a socket or a device, or it is larger.
    OSError
        It is not there, or is out of reach.
    """
    status = path.stat()
    if not stat.S_ISREG(status.st_mode):
        kind = next((name for is_kind, name in KINDS if is_kind(status.st_mode)), "something else")
        raise InputError("must be a regular file", source=path, value=f"a {kind}")
    if status.st_size > largest:
        raise InputError(f"must be at most {largest:.0f} bytes", source=path, value=status.st_size)
