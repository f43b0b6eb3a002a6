"""Shards of a run: the cases of some studies in n parts for as many jobs, and the parts put together again.

Case number k of all cases, each counted once, belongs to shard ``k mod n``: neighbours in a study cost alike, and so
do the shards. What a gate compares a case with may be in another shard; gates are judged when all rows are together.
"""

from __future__ import annotations

import hashlib
import json
import re
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from importlib.metadata import version
from pathlib import Path

from typing_extensions import TypedDict

from validation.engine.case import SOURCES, library_versions, source_digest
from validation.engine.measure import columns_of
from validation.engine.run import StudyCases
from validation.errors import InputError
from validation.runs import strict
from validation.runs.results import Results

DIRECTORY = "shards"  # of a results directory, one file a shard
ADVICE = "run this shard again"
DISTRIBUTION = "dda-validation"


@dataclass(frozen=True)
class Shard:
    """Part `number` of `count`, counted from 1."""

    number: int
    count: int

    @classmethod
    def parse(cls, text: str) -> Shard:
        """Return the shard that a text such as ``3/8`` names.

        Raises
        ------
        InputError
            It is no such text.
        """
        match = re.fullmatch(r"([1-9]\d{0,5})/([1-9]\d{0,5})", text)
        if match is None or int(match[1]) > int(match[2]):
            raise InputError("must be i/n with 1 <= i <= n, as in 3/8", field="--shard", value=repr(text))
        return cls(int(match[1]), int(match[2]))

    def __str__(self) -> str:
        return f"{self.number}/{self.count}"

    def part(self, groups: Sequence[StudyCases]) -> list[StudyCases]:
        """Return the cases of this shard, study by study; a case that two studies share is in one shard."""
        keys = set(all_keys(groups)[self.number - 1 :: self.count])
        return [replace(group, keyed=[item for item in group.keyed if item[1] in keys], rows={}) for group in groups]


def all_keys(groups: Iterable[StudyCases]) -> list[str]:
    """Return the key of every case of some studies once, in their order."""
    return list(dict.fromkeys(key for group in groups for _, key in group.keyed))


class RunOptions(TypedDict):
    """What a run was called with as far as it decides its cases."""

    targets: list[str]
    assignments: list[str]
    full: bool
    ranks: int


class ShardRecord(TypedDict):
    """What a shard writes when its last case has ended."""

    number: int
    count: int
    options: RunOptions
    versions: dict[str, str]
    studies: dict[str, str]  # study to the fingerprint of all its cases, in whatever shard


def fingerprint(group: StudyCases) -> str:
    """Return the hash of a study's cases: scenes, solvers, and by their keys all that decides their rows."""
    cases = [(case.scene.name, case.solver, key) for case, key in group.keyed]
    return hashlib.sha256(json.dumps(cases).encode()).hexdigest()[:24]


def record_of(shard: Shard, options: RunOptions, groups: Sequence[StudyCases]) -> ShardRecord:
    """Return the record of a shard of the whole studies' cases, as it is made here."""
    sources = hashlib.sha256("".join(map(source_digest, SOURCES)).encode()).hexdigest()[:12]
    return {
        "number": shard.number,
        "count": shard.count,
        "options": options,
        "versions": {DISTRIBUTION: version(DISTRIBUTION), "its sources": sources, **library_versions()},
        "studies": {group.study.name: fingerprint(group) for group in groups},
    }


def begin(shard: Shard, results: Results) -> None:
    """Withdraw the record of an earlier run of a shard: without one the shard is unfinished."""
    (results.directory / _file(shard)).unlink(missing_ok=True)


def write(record: ShardRecord, results: Results) -> None:
    """Keep the record of a shard whose cases have ended."""
    results.write_json(_file(Shard(record["number"], record["count"])), record)


def _file(shard: Shard) -> str:
    return f"{DIRECTORY}/{shard.number}-of-{shard.count}.json"


@dataclass(frozen=True)
class FinishedShard:
    """A shard that was run, and where its rows are."""

    record: ShardRecord
    directory: Path

    @property
    def shard(self) -> Shard:
        """Which part it is."""
        return Shard(self.record["number"], self.record["count"])

    def __str__(self) -> str:
        return f"shard {self.shard} in {self.directory}"


def read_shards(directories: Sequence[Path]) -> list[FinishedShard]:
    """Return the shards of some results directories, all parts of one run, in their order.

    Raises
    ------
    InputError
        A directory holds no finished shard, two are of different runs or the same part, or a part is missing.
    """
    shards = [shard for directory in directories for shard in _read(directory)]
    first = shards[0]
    for shard in shards[1:]:
        check_same(first.record, shard.record, str(first), str(shard))
    by_number: dict[int, FinishedShard] = {}
    for shard in shards:
        twin = by_number.setdefault(shard.shard.number, shard)
        if twin is not shard:
            raise InputError(
                f"is there twice: in {twin.directory} and in {shard.directory}", source=f"shard {shard.shard}"
            )
    missing = [n for n in range(1, first.shard.count + 1) if n not in by_number]
    if missing:
        names = ", ".join(str(Shard(number, first.shard.count)) for number in missing)
        raise InputError(
            f"not found: {names}",
            field="shards",
            advice="run these parts, or name the directories that hold them",
        )
    return [by_number[number] for number in sorted(by_number)]


def _read(directory: Path) -> Iterator[FinishedShard]:
    paths = sorted(directory.glob(f"{DIRECTORY}/*.json"))
    if not paths:
        raise InputError(
            "holds no finished shard", source=directory, advice="run --shard i/n with --results here, to its end"
        )
    for path in paths:
        yield FinishedShard(strict.read(path, ShardRecord, ADVICE), directory)


def check_same(expected: ShardRecord, found: ShardRecord, expected_name: str, found_name: str) -> None:
    """Refuse to put two parts together that are not of one run.

    Parameters
    ----------
    expected, found
        The records; their numbers are not compared.
    expected_name, found_name
        What the message calls them.

    Raises
    ------
    InputError
        With the first thing that differs.
    """
    if expected["count"] != found["count"]:
        raise InputError(
            f"must be of as many parts as {expected_name}", source=found_name, field="count", value=found["count"]
        )
    for part, name in (("versions", "version of "), ("options", ""), ("studies", "cases of ")):
        expected_values: Mapping[str, object] = expected[part]  # type: ignore[literal-required]
        found_values: Mapping[str, object] = found[part]  # type: ignore[literal-required]
        for key in dict.fromkeys((*expected_values, *found_values)):
            if expected_values.get(key) != found_values.get(key):
                raise InputError(
                    f"must be that of {expected_name}, {expected_values.get(key)}",
                    source=found_name,
                    field=f"{name}{key}",
                    value=found_values.get(key),
                    advice="run all parts with one version of everything on the same scenes",
                )


def collect(shards: Sequence[FinishedShard], groups: Sequence[StudyCases], results: Results) -> None:
    """Copy the rows and histories of all shards into a results directory, and give the rows to the studies' cases.

    Raises
    ------
    InputError
        A row or a history of a shard is not there.
    """
    rows_of_directory = {shard.directory: Results(shard.directory).rows() for shard in shards}
    for shard in shards:
        source = Results(shard.directory)
        rows = rows_of_directory[shard.directory]
        copied: set[str] = set()
        for group, part in zip(groups, shard.shard.part(groups), strict=True):
            for case, key in part.keyed:
                row = rows.get(key)
                if row is None or not source.sound(row, case.scene.time.steps, columns_of(case)):
                    lost = "row" if row is None else "history"
                    raise InputError(
                        f"the {lost} of {case.scene.name} {case.solver} is missing", source=shard, advice=ADVICE
                    )
                group.rows[key] = row
                if key not in copied:
                    copied.add(key)
                    results.append(row, source.history(key))
