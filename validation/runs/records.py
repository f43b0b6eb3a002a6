"""Records between engine and report: what stands in the manifest of a study and in ``verdicts.json``."""

from __future__ import annotations

from typing import Annotated, Any, NotRequired

from pydantic import AfterValidator, Field
from typing_extensions import TypedDict

from validation.runs.row import Value


class CaseRecord(TypedDict):
    """One case of a study: where its row is found, and the scene that was run."""

    scene: str
    title: str
    solver: str
    key: str
    definition: dict[str, Any]  # the scene as a file would state it


class ComparisonRecord(TypedDict):
    """The pair metrics of a solver and a reference over a window."""

    scene: str
    solver: str
    reference: str
    window: float  # s
    metrics: dict[str, Value]


class DerivedRecord(TypedDict):
    """A row that was computed from finished cases."""

    scene: str
    name: str
    metrics: dict[str, Value]


class AlarmRecord(TypedDict):
    """A result that looks better than it is."""

    kind: str
    scene: str
    sentence: str
    values: NotRequired[dict[str, float]]


class BudgetRecord(TypedDict):
    """The damping of a scene's modes over dt."""

    scene: str  # name of the first case
    steps: list[float]  # dt of the cases [s]
    gg: float
    gg_rate: float | None  # 1/s
    dt: list[float]  # s
    modes: dict[str, dict[str, list[float | None]]]  # name to total xi and its parts
    transit: float  # of a wave from top to base [s]
    floor: float | None  # first frequency of DDA over that of the bar


class Annotations(TypedDict):
    """What a study says of its cases beside verdicts."""

    alarms: list[AlarmRecord]
    budgets: list[BudgetRecord]


class _Study(TypedDict):
    study: str


class Manifest(_Study, total=False):
    """A study as it was run; one that another version has written may lack parts."""

    title: str
    purpose: str
    cases: list[CaseRecord]
    comparisons: list[ComparisonRecord]
    derived: list[DerivedRecord]
    data: dict[str, Any]  # what the study's own chapter draws
    alarms: list[AlarmRecord]
    budgets: list[BudgetRecord]
    provenance: dict[str, Any]


class Named(TypedDict):
    """A verdict of which no more is asked than whose it is."""

    study: str
    id: str


def _ordered(band: list[float]) -> list[float]:
    if not band[0] <= band[1]:
        raise ValueError(f"must be [low, high] with low <= high, got {band}")
    return band


Word = Annotated[str, Field(pattern="^(PASS|FAIL|NOT RUN)$")]
Band = Annotated[list[float], Field(min_length=2, max_length=2), AfterValidator(_ordered)]


class BaselineVerdict(TypedDict):
    """What two runs are compared by, gate by gate."""

    id: str
    study: str
    value: Value
    band: Band
    verdict: Word


class VerdictRecord(BaselineVerdict):
    """One gate's verdict; values are rounded well above the last bits, and no seconds stand in it."""

    scene: str
    pair: list[str]
    metric: str
    reason: str
    why: str
    margin: NotRequired[float | None]  # share of the way from the target to the edge; see `Gate.margin`
    reference_kind: str
    reference_uncertainty: float
    alarms: list[str]


def sound(record: BaselineVerdict) -> BaselineVerdict:
    """Return a verdict that its own value, of four digits or of two where it is small, and its band bear out.

    Raises
    ------
    ValueError
        It passes without a number, or its word is not that of its value.
    """
    value = record["value"]
    low, high = record["band"]
    word = record["verdict"]
    inside = outside = True
    if isinstance(value, int | float):
        rounding = 6e-4 if abs(value) >= 1e-9 else 6e-2
        slack = rounding * min(abs(value), 1e300) + 1e-12
        inside = low - slack <= value <= high + slack
        outside = not low + slack < value < high - slack
    elif word == "PASS":
        inside = False
    if (word == "PASS" and not inside) or (word == "FAIL" and not outside):
        raise ValueError(f"{record['id'][:200]} says {word}, got {value!r} in [{low:g}, {high:g}]")
    return record


def unique(records: list[BaselineVerdict]) -> list[BaselineVerdict]:
    """Return verdicts, or raise ValueError where two of a study have one id."""
    gates = set()
    for record in records:
        name = (record["study"], record["id"])
        if name in gates:
            raise ValueError(f"{record['id'][:200]} appears twice in the study {record['study'][:200]}")
        gates.add(name)
    return records


Verdicts = Annotated[list[Annotated[VerdictRecord, AfterValidator(sound)]], AfterValidator(unique)]
Baseline = Annotated[list[Annotated[BaselineVerdict, AfterValidator(sound)]], AfterValidator(unique)]
