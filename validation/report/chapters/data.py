"""What a chapter is built from: the scenes of a study with their cases, rows, histories and verdicts."""

from __future__ import annotations

import itertools
import re
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass
from functools import partial
from typing import Any

from validation.report.chapters.text import case_labels
from validation.runs.case_name import CaseName, scene_of
from validation.runs.history import History
from validation.runs.records import AlarmRecord, BudgetRecord, CaseRecord, ComparisonRecord, Manifest, VerdictRecord
from validation.runs.results import Results
from validation.runs.row import Row
from validation.scenes.scene import Scene, parse_scene
from validation.solvers.contract import Role
from validation.solvers.registry import by_role


@dataclass(frozen=True)
class Case:
    """One case of a scene: rows and histories by solver."""

    name: str
    label: str
    scene: Scene
    rows: Mapping[str, Row]
    histories: Mapping[str, History]

    def number(self, solver: str, metric: str) -> float | None:
        """Return a metric of a solver where it is a number."""
        row = self.rows.get(solver)
        value = None if row is None else row.metrics.get(metric)
        return float(value) if isinstance(value, int | float) else None

    @property
    def reference(self) -> str | None:
        """The solver that pictures take differences from."""
        # The same Newmark scheme first: pictures show model and code.
        known = [*by_role(Role.REFERENCE), *by_role(Role.TRUTH), *by_role(Role.LIMIT)]
        return next((name for name in known if name in self.histories), None)


@dataclass(frozen=True)
class Group:
    """A scene of a study: the cases of one sweep, their comparisons and verdicts."""

    name: str
    title: str
    cases: tuple[Case, ...]
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

    def compared(self, case: Case, solver: str, reference: str) -> Mapping[str, Any] | None:
        """Return the metrics of a pair over the longest window, in either order, or None."""
        pair = {solver, reference}
        own = [c for c in self.comparisons if c["scene"] == case.name and {c["solver"], c["reference"]} == pair]
        longest = max(own, key=lambda c: float(c.get("window") or 0.0), default=None)
        return None if longest is None else dict(longest["metrics"])

    def number_of_pair(self, case: Case, solver: str, reference: str, metric: str) -> float | None:
        """Return a metric of a pair where it is a number."""
        value = (self.compared(case, solver, reference) or {}).get(metric)
        return float(value) if isinstance(value, int | float) else None


def groups(results: Results, manifest: Manifest, drawn: bool = True) -> list[Group]:
    """Return the scenes of a study in the order of its manifest; with their histories only if those are drawn."""
    rows = results.rows()
    scenes: dict[str, dict[str, list[CaseRecord]]] = {}
    for entry in spoken_of(manifest):
        scenes.setdefault(scene_of(entry["scene"]), {}).setdefault(entry["scene"], []).append(entry)
    verdicts = results.verdicts(manifest.get("study"))
    history_of = results.history if drawn else lambda _: None
    return [_group(history_of, rows, manifest, base, cases, verdicts) for base, cases in scenes.items()]


def spoken_of(manifest: Manifest) -> list[CaseRecord]:
    """Return the cases of a study that a page speaks of: all, or where its data name its cells' `runs`, those scenes.

    The other scenes of such a study are what its bands and checks are computed from, and show nothing by themselves.
    """
    cases = manifest.get("cases", [])
    try:
        scenes = {case[0] for case, _ in manifest.get("data", {})["runs"].values()}
    except (AttributeError, LookupError, TypeError, ValueError):  # no field, or one of another version
        return cases
    return [entry for entry in cases if entry["scene"] in scenes]


def verdicts_of(found: Iterable[Group]) -> list[VerdictRecord]:
    """Return the verdicts of scenes."""
    return [verdict for group in found for verdict in group.verdicts]


def _group(
    history_of: Callable[[str], History | None],
    rows: Mapping[str, Row],
    manifest: Manifest,
    base: str,
    entries: Mapping[str, Sequence[CaseRecord]],
    verdicts: Sequence[VerdictRecord],
) -> Group:
    scenes = [parse_scene(own[0]["definition"], name) for name, own in entries.items()]
    labels = case_labels(list(entries), scenes)
    cases = map(partial(_case, history_of, rows), entries.values(), labels, scenes)
    return Group(
        base,
        next(iter(entries.values()))[0].get("title") or base,
        tuple(cases),
        tuple(c for c in manifest.get("comparisons", []) if scene_of(c["scene"]) == base),
        tuple(v for v in verdicts if scene_of(v["scene"]) == base),
        tuple(a for a in manifest.get("alarms", []) if scene_of(a["scene"]) == base),
        tuple(b for b in manifest.get("budgets", []) if scene_of(b["scene"]) == base),
    )


def _case(
    history_of: Callable[[str], History | None],
    rows: Mapping[str, Row],
    entries: Sequence[CaseRecord],
    label: str,
    scene: Scene,
) -> Case:
    own = {e["solver"]: rows[e["key"]] for e in entries if e["key"] in rows}
    drawn = {solver: row for solver, row in own.items() if not solver.endswith(":full")}  # equal to what they repeat
    histories = {s: history for s, row in drawn.items() if (history := history_of(row.key)) is not None}
    return Case(entries[0]["scene"], label, scene, own, histories)


def varied_fields(group: Group) -> set[str]:
    """Return the fields that vary between the cases of a scene."""
    return set().union(*(CaseName.parse(case.name).values for case in group.cases))
