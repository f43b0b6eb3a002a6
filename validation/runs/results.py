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
from dataclasses import replace
from pathlib import Path
from typing import IO, Any

import numpy as np

from validation.errors import InputError
from validation.runs import strict
from validation.runs.files import write_atomically
from validation.runs.history import Array, History
from validation.runs.records import Manifest, Named, VerdictRecord, Verdicts
from validation.runs.regular import regular, regular_or_absent
from validation.runs.row import Row
from validation.runs.run import Outcome

ADVICE = "delete it and run again"
BETWEEN = "between/"  # before the names of columns at more instants than the steps
LARGEST_HEADER = 4096  # bytes before a column's numbers; numpy writes 128
WITH_HISTORY = (Outcome.COMPLETED, Outcome.UNSTABLE)  # outcomes whose history is kept
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
                f"cannot be made: {error.strerror}", source=path.parent, advice="choose another place with --results"
            ) from None
        return path

    def rows(self) -> dict[str, Row]:
        """Return the finished rows by key, the latest of each."""
        path = self.directory / "rows.jsonl"
        try:
            if not regular_or_absent(path):
                return {}
            parsed = map(_parsed, path.read_text(encoding="utf-8", errors="replace").splitlines())
        except OSError as error:
            raise InputError(
                f"cannot be read: {error.strerror}", source=path, advice="choose another place with --results"
            ) from None
        return {row.key: row for row in parsed if row is not None}

    def append(self, row: Row, history: History | None) -> None:
        """Keep a finished case: its history first, then its line in one write.

        The line begins with a line break, so that a line that a killed run left unfinished cannot swallow it.
        """
        if history is not None:
            self._save_history(row.key, history)
            row = replace(row, steps=len(history.time), columns=tuple(history.columns))
        path = self._make("rows.jsonl")
        try:
            regular_or_absent(path)
            handle = os.open(path, os.O_WRONLY | os.O_APPEND | os.O_CREAT, 0o666)
            try:
                line = f"\n{row.line()}\n".encode()
                if os.write(handle, line) < len(line):  # the beginning is not read as a row
                    raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))
            finally:
                os.close(handle)
        except OSError as error:
            raise InputError(
                f"cannot be written: {error.strerror}",
                source=path,
                advice="finished rows are kept, choose another place with --results",
            ) from None

    def _save_history(self, key: str, history: History) -> None:
        columns = {"time": history.time, **history.columns}
        if history.between is not None:
            columns[f"{BETWEEN}time"] = history.between.time
            columns |= {f"{BETWEEN}{name}": values for name, values in history.between.columns.items()}

        def write(stream: IO[bytes]) -> None:  # np.savez means other things by its options from version to version
            with zipfile.ZipFile(stream, "w") as archive:
                archive.comment = key.encode()  # a file that stands in another's place is seen
                for name, values in columns.items():
                    with archive.open(f"{name}.npy", "w", force_zip64=True) as file:
                        np.lib.format.write_array(file, np.asarray(values, np.float64), allow_pickle=False)

        write_atomically(self._make("histories", f"{key}.npz"), write)

    def history(self, key: str) -> History | None:
        """Return the kept history of a case, or None where the case has none.

        Raises
        ------
        InputError
            The file is damaged, belongs to another case, or holds no history.
        """
        path = self._history_file(key)
        if not path.exists():
            return None
        owner, columns, between = _read_columns(path)
        defect = "belongs to another case" if owner != key else _defect(columns, between)
        if defect:
            raise InputError(defect, source=path, advice=ADVICE)
        finer = History(between.pop("time"), between) if between else None
        return History(columns.pop("time"), columns, finer)

    def sound(self, row: Row, steps: int, columns: Iterable[str]) -> bool:
        """Whether a row's kept history is there, its own, finite, of so many steps and with all these columns.

        Raises InputError where the file is damaged.
        """
        path = self._history_file(row.key)
        if row.outcome not in WITH_HISTORY:
            return True
        if not path.exists():
            return False
        owner, columns_of_file, between = _read_columns(path)
        return (
            owner == row.key
            and _defect(columns_of_file, between) is None
            and len(columns_of_file["time"]) == steps
            and {*columns} <= {*columns_of_file}
        )

    def _history_file(self, key: str) -> Path:
        return self.directory / "histories" / f"{key}.npz"

    def write_json(self, name: str, data: object) -> None:
        """Write a JSON file of the directory atomically."""
        text = json.dumps(data, indent=1, allow_nan=False) + "\n"
        write_atomically(self._make(*name.split("/")), lambda stream: stream.write(text.encode()))

    def read_json(self, name: str, default: Any = None, kind: Any = Any) -> Any:
        """Return a JSON file of the directory, whose content is of a type, or the default where it is absent."""
        try:
            return strict.read(self.directory / name, kind, ADVICE)
        except FileNotFoundError:
            return default

    def studies(self) -> list[str]:
        """Return the names of the studies whose results are here."""
        return sorted(path.stem for path in self.directory.glob("studies/*.json"))

    def manifest(self, study: str) -> Manifest:
        """Return a study's manifest, or raise InputError for a damaged file or that of another study."""
        name = f"studies/{study}.json"
        manifest: Manifest | None = self.read_json(name, None, Manifest)
        if manifest is None:
            return {"study": study}
        if manifest["study"] != study:
            raise InputError(f"holds the study {manifest['study']!r}", source=self.directory / name, advice=ADVICE)
        return manifest

    def whole(self, study: str, histories: bool = False) -> Manifest:
        """Return a study's manifest, or raise InputError where a row that it lists or, if asked, a history is lost."""
        manifest = self.manifest(study)
        rows = self.rows()
        for case in manifest.get("cases", []):
            row = rows.get(case["key"])
            if row is None:
                part = "row"
            elif histories and row.outcome in WITH_HISTORY and not self._history_file(row.key).exists():
                part = "history"
            else:
                if histories and row.outcome in WITH_HISTORY:
                    _check_shape(self._history_file(row.key), row)
                continue
            raise InputError(
                f"the {part} of {case['scene']} {case['solver']} is missing",
                source=self.directory,
                advice=f"run {study} again",
            )
        return manifest

    def check(self) -> None:
        """Raise InputError where rows or verdicts, which a run will add to, cannot be read, before anything runs."""
        if self.directory.is_file():  # what is in it is not said to be damaged, nor to be deleted
            raise InputError("must be a directory", field="--results", value=f"the file {str(self.directory)!r}")
        self.rows()
        self.verdicts()

    def verdicts(self, study: str | None = None) -> list[VerdictRecord]:
        """Return the verdicts, of one study or of all."""
        records = self.read_json("verdicts.json", [], Verdicts)
        return [v for v in records if study is None or v["study"] == study]

    def unread_verdicts(self) -> dict[str, str]:
        """Return the studies with verdicts that are not as this version writes them, and what is wrong with the first.

        Raises
        ------
        InputError
            The file holds no list of records that name their study.
        """
        records = self.read_json("verdicts.json", [], list[Named])
        defects = {v["study"]: strict.defect_of(v, VerdictRecord) for v in reversed([*records])}
        return {study: defect for study, defect in defects.items() if defect}

    def readable_verdicts(self) -> list[VerdictRecord]:
        """Return the verdicts of the studies that `unread_verdicts` does not name."""
        unread = self.unread_verdicts()
        records = self.read_json("verdicts.json", [], list[Named])
        return [v for v in records if v["study"] not in unread]

    def write_verdicts(self, study: str, verdicts: list[VerdictRecord]) -> None:
        """Replace the verdicts of one study; of two runs at once the one waits for the other."""
        with self._locked():
            records = self.read_json("verdicts.json", [], list[Named])
            others = [v for v in records if v["study"] != study]
            self.write_json("verdicts.json", sorted(others + verdicts, key=lambda v: (v["study"], v["id"])))

    @contextmanager
    def _locked(self) -> Iterator[None]:
        """Hold the directory's lock, where the system has locks; it falls with the process that holds it."""
        try:
            import fcntl
        except ImportError:
            yield
            return
        path = self._make(".lock")
        try:
            regular_or_absent(path)
            handle = os.open(path, os.O_WRONLY | os.O_CREAT, 0o666)
        except OSError as error:
            raise InputError(
                f"cannot be written: {error.strerror}", source=path, advice="choose another place"
            ) from None
        try:
            fcntl.flock(handle, fcntl.LOCK_EX)
            yield
        finally:
            os.close(handle)


@contextmanager
def _archive(path: Path) -> Iterator[zipfile.ZipFile]:
    """Open a kept history, whose members are stored as they are: packed ones may be of any size."""
    try:
        regular(path)
        with zipfile.ZipFile(path) as archive:
            if any(member.compress_type != zipfile.ZIP_STORED for member in archive.infolist()):
                raise ValueError
            yield archive
    except InputError:
        raise
    except Exception:  # what a damaged file may raise is no closed list
        raise InputError("cannot be read as a history", source=path, advice=ADVICE) from None


def _read_columns(path: Path) -> tuple[str, dict[str, Array], dict[str, Array]]:
    """Return the key that a history was kept under, its columns, and those at more instants."""
    with _archive(path) as archive:
        columns: dict[str, Array] = {}
        between: dict[str, Array] = {}
        for member in archive.namelist():
            name = member.removesuffix(".npy")
            place = between if name.startswith(BETWEEN) else columns
            with archive.open(member) as file:
                place[name.removeprefix(BETWEEN)] = np.lib.format.read_array(file, allow_pickle=False)
        return archive.comment.decode(errors="replace"), columns, between


def _defect(columns: dict[str, Array], between: dict[str, Array]) -> str | None:
    """Say what a history lacks, at its steps or between them: times, or one finite number a time in every column."""
    if "time" not in columns:
        return "holds no column time"
    if between and (defect := _defect(between, {})):
        return f"between the steps: {defect}"
    for name, values in columns.items():
        if values.dtype != np.float64 or values.shape != (len(columns["time"]),) or not np.isfinite(values).all():
            return f"{name} must hold one finite number a step"
    return None


def _check_shape(path: Path, row: Row) -> None:
    """Refuse a kept history that has not the columns and steps of its row, from the archive's directory alone."""
    with _archive(path) as archive:
        members = [member for member in archive.infolist() if not member.filename.startswith(BETWEEN)]
    sizes = {member.filename.removesuffix(".npy"): member.file_size for member in members}
    content = 8 * row.steps  # bytes of a column of doubles
    if {*sizes} != {"time", *row.columns}:
        raise InputError("has not the columns of its row", source=path, advice=ADVICE)
    if any(not content <= size <= content + LARGEST_HEADER for size in sizes.values()):
        raise InputError("has not the steps of its row", source=path, advice=ADVICE)
