"""The results directory: rows, histories, study manifests and verdicts.

``rows.jsonl`` is append-only, one finished case a line; ``histories/<key>.npz`` holds the kept columns;
``studies/<name>.json`` says which cases a study consists of and how they compare; ``verdicts.json`` holds the
gates' verdicts without seconds. Everything that a report needs is here: it cannot call a solver.
"""

from __future__ import annotations

import errno
import functools
import json
import os
import zipfile
from collections.abc import Iterable, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import IO, Any

import numpy as np

from validation.errors import InputError
from validation.runs.files import write_atomically
from validation.runs.history import History
from validation.runs.records import Manifest, VerdictRecord
from validation.runs.row import Row
from validation.runs.run import Outcome

_parsed = functools.lru_cache(maxsize=4096)(Row.parse)  # of a growing file only the new lines


class Results:
    """A results directory; it is made when the first thing is written."""

    def __init__(self, directory: Path | str) -> None:
        self.directory = Path(directory)

    def _make(self, *parts: str) -> Path:
        path = self.directory.joinpath(*parts)
        try:
            path.parent.mkdir(parents=True, exist_ok=True)
        except OSError as error:
            raise InputError(
                f"{path.parent}: cannot be made: {error.strerror}; choose another place with --results"
            ) from None
        return path

    def rows(self) -> dict[str, Row]:
        """Return the finished rows by key, the latest of each."""
        path = self.directory / "rows.jsonl"
        if not path.exists():
            return {}
        if not path.is_file():
            raise InputError(f"{path}: cannot be read: it is no file; choose another place with --results")
        try:
            parsed = map(_parsed, path.read_text(encoding="utf-8", errors="replace").splitlines())
        except OSError as error:
            raise InputError(f"{path}: cannot be read: {error.strerror}; choose another place with --results") from None
        return {row.key: row for row in parsed if row is not None}

    def append(self, row: Row, history: History | None) -> None:
        """Keep a finished case: its history first, then its line in one write.

        The line begins with a line break, so that a line that a killed run left unfinished cannot swallow it.
        """
        if history is not None:
            self._save_history(row.key, history)
        path = self._make("rows.jsonl")
        try:
            handle = os.open(path, os.O_WRONLY | os.O_APPEND | os.O_CREAT, 0o666)
            try:
                line = f"\n{row.line()}\n".encode()
                if os.write(handle, line) < len(line):  # the beginning is not read as a row
                    raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))
            finally:
                os.close(handle)
        except OSError as error:
            raise InputError(
                f"{path}: cannot be written: {error.strerror}; finished rows are kept, "
                "choose another place with --results"
            ) from None

    def _save_history(self, key: str, history: History) -> None:
        columns = {"time": history.time, **history.columns}

        def write(stream: IO[bytes]) -> None:  # np.savez means other things by its options from version to version
            with zipfile.ZipFile(stream, "w") as kept:
                for name, values in columns.items():
                    with kept.open(f"{name}.npy", "w", force_zip64=True) as part:
                        np.lib.format.write_array(part, values, allow_pickle=False)

        write_atomically(self._make("histories", f"{key}.npz"), write)

    def history(self, key: str) -> History | None:
        """Return the kept history of a case, or None where the case has none."""
        path = self.directory / "histories" / f"{key}.npz"
        if not path.exists():
            return None
        try:
            with np.load(path) as data:
                columns = {name: data[name] for name in data.files}
        except (OSError, ValueError, EOFError, zipfile.BadZipFile):
            raise InputError(f"{path}: cannot be read as a history; delete it and run again") from None
        return History(columns.pop("time"), columns)

    def has(self, row: Row) -> bool:
        """Whether the row's history is there as well (a completed case always keeps one)."""
        return row.outcome is not Outcome.COMPLETED or (self.directory / "histories" / f"{row.key}.npz").exists()

    def write_json(self, name: str, data: object) -> None:
        """Write a JSON file of the directory atomically."""
        text = json.dumps(data, indent=1, allow_nan=False) + "\n"
        write_atomically(self._make(*name.split("/")), lambda stream: stream.write(text.encode()))

    def read_json(self, name: str, default: Any = None) -> Any:
        """Return a JSON file of the directory, or the default where it is absent."""
        path = self.directory / name
        try:
            return json.loads(path.read_text(encoding="utf-8"))
        except FileNotFoundError:
            return default
        except (OSError, ValueError) as error:
            raise InputError(f"{path}: cannot be read as JSON: {error}; delete it and run again") from None

    def studies(self) -> list[str]:
        """Return the names of the studies whose results are here."""
        return sorted(path.stem for path in self.directory.glob("studies/*.json"))

    def manifest(self, study: str) -> Manifest:
        """Return a study's manifest: title, cases (scene, solver, key, definition) and comparisons."""
        found: Manifest = self.read_json(f"studies/{study}.json", {})
        return found

    def verdicts(self, study: str | None = None) -> list[VerdictRecord]:
        """Return the verdicts, of one study or of all."""
        kept: Iterable[VerdictRecord] = self.read_json("verdicts.json", [])
        return [v for v in kept if study is None or v["study"] == study]

    def write_verdicts(self, study: str, verdicts: list[VerdictRecord]) -> None:
        """Replace the verdicts of one study; of two runs at once the one waits for the other."""
        with self._alone():
            others = [v for v in self.verdicts() if v["study"] != study]
            self.write_json("verdicts.json", sorted(others + verdicts, key=lambda v: (v["study"], v["id"])))

    @contextmanager
    def _alone(self) -> Iterator[None]:
        """Hold the directory's lock, where the system has locks; it falls with the process that holds it."""
        try:
            import fcntl
        except ImportError:
            yield
            return
        path = self._make(".lock")
        try:
            handle = os.open(path, os.O_WRONLY | os.O_CREAT, 0o666)
        except OSError as error:
            raise InputError(f"{path}: cannot be written: {error.strerror}; choose another place") from None
        try:
            fcntl.flock(handle, fcntl.LOCK_EX)
            yield
        finally:
            os.close(handle)
