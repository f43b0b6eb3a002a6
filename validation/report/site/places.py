"""Where a site is written: a new or empty directory, or an earlier site, which is replaced."""

from __future__ import annotations

from pathlib import Path

from validation.errors import InputError


def check_place(out: Path, mark: str, what: str) -> None:
    """Refuse a place that cannot be written, or whose files are not those of such a site.

    The file `mark` marks an earlier site, which is called `what`.
    """
    if out.exists() and not out.is_dir():
        raise InputError("must be a directory", field="--out", value=f"the file {out}")
    if out.is_dir() and any(out.iterdir()) and not (out / mark).is_file():
        message = f"must be a new or empty directory or an earlier {what}"
        raise InputError(message, field="--out", value=f"{out} with other files")


def write(path: Path, text: str) -> None:
    """Write a file with the same line ends everywhere."""
    path.write_bytes(text.encode())
