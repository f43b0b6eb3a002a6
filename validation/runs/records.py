"""Records between engine and report: what stands in the manifest of a study and in ``verdicts.json``."""

from __future__ import annotations

from typing import Any

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
    values: dict[str, float]


BudgetRecord = TypedDict(
    "BudgetRecord",
    {
        "scene": str,  # name of the first case
        "steps": list[float],  # dt of the cases [s]
        "gg": float,
        "gg_rate": float | None,  # 1/s
        "dt": list[float | None],  # s
        "modes": dict[str, dict[str, list[float | None]]],  # name to total, algorithmic and kinetic xi, |lambda|
        "limits": dict[str, float],  # s
        "real roots at": float,  # w dt of the first axial mode
        "floor": float | None,  # first frequency of DDA over that of the bar
    },
)


class Annotations(TypedDict):
    """What a study says of its cases beside verdicts."""

    alarms: list[AlarmRecord]
    budgets: list[BudgetRecord]


class Manifest(TypedDict):
    """A study as it was run."""

    study: str
    title: str
    purpose: str
    cases: list[CaseRecord]
    comparisons: list[ComparisonRecord]
    derived: list[DerivedRecord]
    data: dict[str, Any]  # what the study's own chapter draws
    alarms: list[AlarmRecord]
    budgets: list[BudgetRecord]
    provenance: dict[str, Any]


class VerdictRecord(TypedDict):
    """One gate's verdict; values are rounded well above the last bits, and no seconds stand in it."""

    id: str
    study: str
    scene: str
    pair: list[str]
    metric: str
    value: Value
    band: list[float]
    verdict: str
    reason: str
    why: str
    reference_kind: str
    reference_uncertainty: float
    alarms: list[str]
