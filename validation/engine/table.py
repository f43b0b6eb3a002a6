"""The rows of a study as one tidy table: a number a line, with what it is of."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import asdict, dataclass, field

from validation.metrics.catalogue import CATALOGUE
from validation.runs.case_name import CaseName, scene_of
from validation.runs.records import Manifest
from validation.runs.results import Results
from validation.runs.row import Metrics, Value


@dataclass(frozen=True)
class TidyRow:
    """A number of a study."""

    study: str
    scene: str
    case: str  # empty where a derived row belongs to a scene, or to none
    solver: str  # or the name of a derived row
    metric: str
    value: Value  # the number, or the word in its place
    unit: str = ""  # that of the catalogue of metrics
    reference: str = ""  # of a comparison
    window: float | None = None  # the time that it covers [s]
    swept: Mapping[str, str] = field(default_factory=dict)  # the swept values of the case, by their keys


def tidy(results: Results, manifest: Manifest) -> Iterator[TidyRow]:
    """Yield the numbers of a study: those of its cases, of comparisons, and of derived rows."""
    study = manifest["study"]
    rows = results.rows()
    cases = {case["scene"] for case in manifest["cases"]}

    def of(
        name: str, solver: str, metrics: Metrics, reference: str = "", window: float | None = None
    ) -> Iterator[TidyRow]:
        swept = CaseName.parse(name).values
        case = name if name in cases else ""
        for metric, value in metrics.items():
            yield TidyRow(study, scene_of(name), case, solver, metric, value, _unit(metric), reference, window, swept)

    for record in manifest["cases"]:
        row = rows[record["key"]]
        cost: dict[str, Value] = {f"work.{name}": value for name, value in row.work.items()}
        cost |= {f"seconds.{name}": value for name, value in row.seconds.items()}
        numbers: dict[str, Value] = {"outcome": str(row.outcome), **row.metrics, **cost}
        if row.estimate is not None:
            numbers["estimate"] = row.estimate
        yield from of(record["scene"], record["solver"], numbers)
    for pair in manifest.get("comparisons", []):
        yield from of(pair["scene"], pair["solver"], pair["metrics"], pair["reference"], pair["window"])
    for derived in manifest.get("derived", []):
        yield from of(derived["scene"], derived["name"], derived["metrics"])


def _unit(metric: str) -> str:
    if metric in CATALOGUE:
        return CATALOGUE[metric].unit
    return "s" if metric.startswith("seconds.") else ""


def lines(rows: Sequence[TidyRow]) -> list[dict[str, object]]:
    """Return the rows as lines of a table, with a column for each key that is swept."""
    keys = dict.fromkeys(key for row in rows for key in row.swept)
    table = []
    for row in rows:
        line = {name: "" if value is None else value for name, value in asdict(row).items() if name != "swept"}
        table.append(line | {key: row.swept.get(key, "") for key in keys})
    return table
