"""What a chapter is built from: the scenes of a study with their cases, rows, histories and verdicts."""

from __future__ import annotations

import itertools
import re
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any

from validation.report.chapters.text import case_labels
from validation.runs.case_name import CaseName, scene_of
from validation.runs.history import History
from validation.runs.records import AlarmRecord, BudgetRecord, CaseRecord, ComparisonRecord, Manifest, VerdictRecord
from validation.runs.results import Results
from validation.runs.row import RowsBySolver
from validation.scenes.scene import Scene, parse_scene
from validation.solvers.contract import Role
from validation.solvers.registry import FULL, by_role

Verdicts = Sequence[VerdictRecord]


@dataclass(frozen=True)
class CaseResults:
    """One case of a scene: rows and histories by solver."""

    name: str
    label: str
    scene: Scene
    rows: RowsBySolver
    histories: Mapping[str, History] = field(default_factory=dict)

    def number(self, solver: str, metric: str) -> float | None:
        """Return a metric of a solver where it is a number."""
        row = self.rows.get(solver)
        value = None if row is None else row.metrics.get(metric)
        return float(value) if isinstance(value, int | float) else None

    @property
    def reference(self) -> str | None:
        """The solver that pictures take differences from."""
        # The same Newmark scheme first: pictures show model and code.
        candidates = [*by_role(Role.REFERENCE), *by_role(Role.TRUTH), *by_role(Role.LIMIT)]
        return next((name for name in candidates if name in self.histories), None)


@dataclass(frozen=True)
class CaseGroup:
    """A scene of a study: the cases of one sweep, their comparisons and verdicts."""

    name: str
    title: str
    cases: tuple[CaseResults, ...]
    comparisons: tuple[ComparisonRecord, ...]
    verdicts: tuple[VerdictRecord, ...]
    alarms: tuple[AlarmRecord, ...] = ()
    budgets: tuple[BudgetRecord, ...] = ()

    @property
    def solvers(self) -> list[str]:
        """All solvers of the cases, in the order of the study."""
        return list(dict.fromkeys(itertools.chain(*(case.rows for case in self.cases))))

    @property
    def slug(self) -> str:
        """The name as part of a file name."""
        return re.sub(r"[^\w.-]+", "-", self.name).strip("-.") or "scene"

    def numbers(self, solver: str, metric: str) -> list[float]:
        """Return a metric of a solver for the cases where it is a number."""
        values = [case.number(solver, metric) for case in self.cases]
        return [value for value in values if value is not None]

    def comparison(self, case: CaseResults, solver: str, reference: str) -> ComparisonRecord | None:
        """Return the comparison of a pair over the longest window, in either order, None where there is none."""
        pair = {solver, reference}
        of_pair = [c for c in self.comparisons if c["scene"] == case.name and {c["solver"], c["reference"]} == pair]
        return max(of_pair, key=lambda c: float(c.get("window") or 0.0), default=None)

    def compared(self, case: CaseResults, solver: str, reference: str) -> Mapping[str, Any]:
        """Return the metrics of this comparison."""
        comparison = self.comparison(case, solver, reference)
        return {} if comparison is None else comparison["metrics"]

    def numbers_of_pair(self, solver: str, reference: str, metric: str) -> list[float]:
        """Return a metric of a pair for the cases where it is a number."""
        values = [self.number_of_pair(case, solver, reference, metric) for case in self.cases]
        return [value for value in values if value is not None]

    def number_of_pair(self, case: CaseResults, solver: str, reference: str, metric: str) -> float | None:
        """Return a metric of a pair where it is a number."""
        value = self.compared(case, solver, reference).get(metric)
        return float(value) if isinstance(value, int | float) else None


Groups = Mapping[str, CaseGroup]  # scenes by their names
CaseGroups = Sequence[CaseGroup]


def case_groups(results: Results, manifest: Manifest, drawn: bool = True) -> list[CaseGroup]:
    """Return the scenes of a study in the order of its manifest, with histories only if those are drawn."""
    rows = results.rows()
    scenes: dict[str, dict[str, list[CaseRecord]]] = {}
    for entry in manifest.get("cases", []):
        scenes.setdefault(scene_of(entry["scene"]), {}).setdefault(entry["scene"], []).append(entry)
    verdicts = results.verdicts(manifest.get("study"))
    groups = []
    for base, records in scenes.items():
        groups.append(
            CaseGroup(
                base,
                next(iter(records.values()))[0].get("title") or base,
                cases_with(records, rows, results.history) if drawn else cases_with(records, rows),
                tuple(c for c in manifest.get("comparisons", []) if scene_of(c["scene"]) == base),
                tuple(v for v in verdicts if scene_of(v["scene"]) == base),
                tuple(a for a in manifest.get("alarms", []) if scene_of(a["scene"]) == base),
                tuple(b for b in manifest.get("budgets", []) if scene_of(b["scene"]) == base),
            )
        )
    return groups


def groups_of_studies(results: Results, manifests: Iterable[Manifest], drawn: bool = True) -> dict[str, CaseGroup]:
    """Return the scenes of studies by name, each as the first study has it."""
    groups: dict[str, CaseGroup] = {}
    for manifest in manifests:
        for group in case_groups(results, manifest, drawn):
            groups.setdefault(group.name, group)
    return groups


def labels_of(groups: Iterable[CaseGroup]) -> dict[str, str]:
    """Return the labels of cases by name."""
    return {case.name: case.label for group in groups for case in group.cases}


def cases_with(
    records_by_case: Mapping[str, Sequence[CaseRecord]],
    rows: RowsBySolver,
    history_of: Callable[[str], History | None] = lambda key: None,
) -> tuple[CaseResults, ...]:
    """Return the cases of one scene with labels, the rows of their records, and histories by key."""
    scenes = [parse_scene(records[0]["definition"], name) for name, records in records_by_case.items()]
    labels = case_labels(list(records_by_case), scenes)
    cases = []
    for (name, records), label, scene in zip(records_by_case.items(), labels, scenes, strict=True):
        rows_by_solver = {record["solver"]: rows[record["key"]] for record in records if record["key"] in rows}
        histories = {}
        for solver, row in rows_by_solver.items():
            history = history_of(row.key)
            if history is not None and not solver.endswith(FULL):  # whose history is that of the model without it
                histories[solver] = history
        cases.append(CaseResults(name, label, scene, rows_by_solver, histories))
    return tuple(cases)


def varied_fields(group: CaseGroup) -> set[str]:
    """Return the fields that vary between cases."""
    return set().union(*(CaseName.parse(case.name).values for case in group.cases))
