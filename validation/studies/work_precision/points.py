"""What the results of the study `work-precision` say of error and cost: points, fronts, the cheapest answer."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass, field

from validation.runs.case_name import scene_of
from validation.runs.records import CaseRecord, Manifest
from validation.runs.results import Results
from validation.runs.row import Row, Value
from validation.runs.run import Outcome
from validation.scenes.scene import Scene, parse_scene

QUANTITIES = {
    "displacement": "displacement.l2",
    "contact pressure": "pressure.l2",
    "first frequency": "mode1.numerical_frequency",
    "damping ratio": "mode1.damping",
}
METHODS = {("dda", 1): "dda", ("fem", 1): "fem, linear", ("fem", 2): "fem, quadratic", ("bar", 1): "bar"}
ROUNDING = 1e-9  # uncertainty of the exact references: histories of a sum of modes


@dataclass(frozen=True)
class Point:
    """One run: its method, its cost, its errors by (quantity, reference)."""

    method: str
    scene: Scene
    row: Row
    errors: Mapping[tuple[str, str], float] = field(default_factory=dict)

    @property
    def seconds(self) -> float:
        """Set-up and stepping [s]."""
        return sum(self.row.seconds.values())

    @property
    def work(self) -> float:
        """Unknowns times steps."""
        return float(self.row.work.get("unknowns", 0) * self.row.work.get("steps", 0))

    def reaches(self, error: float, reference: str) -> bool:
        """Whether displacement and contact pressure are both within an error of a reference."""
        return all(self.errors.get((q, reference), math.inf) <= error for q in ("displacement", "contact pressure"))


def points(results: Results, manifest: Manifest, prefix: str) -> list[Point]:
    """Return the completed runs of the scenes whose name begins so, in the order of the study."""
    rows = results.rows()
    compared = {(c["scene"], c["solver"], c["reference"]): c["metrics"] for c in manifest["comparisons"]}
    by_case = {(case["scene"], case["solver"]): rows[case["key"]] for case in manifest["cases"] if case["key"] in rows}
    runs = []
    for case in manifest["cases"]:
        row = by_case.get((case["scene"], case["solver"]))
        scene = parse_scene(case["definition"], case["scene"])
        method = METHODS.get((case["solver"], scene.fem.degree if case["solver"] == "fem" else 1))
        quadratic_copy = case["solver"] != "fem" and "quadratic" in case["scene"]
        is_drawn = scene_of(case["scene"]).startswith(prefix) and method is not None and not quadratic_copy
        if is_drawn and row is not None and row.outcome is Outcome.COMPLETED:
            runs.append(Point(str(method), scene, row, _errors(case, row, by_case, compared)))
    return runs


def _errors(
    case: CaseRecord,
    row: Row,
    rows: Mapping[tuple[str, str], Row],
    compared: Mapping[tuple[str, str, str], Mapping[str, Value]],
) -> dict[tuple[str, str], float]:
    """Return the errors of a run against the bar (model form and mesh) and the continuum (everything)."""
    errors = {}
    for reference in ("bar", "continuum"):
        other = rows.get((case["scene"], reference))
        metrics = compared.get((case["scene"], case["solver"], reference))
        for name, metric in QUANTITIES.items():
            value: Value = None
            if metrics is not None and metric in metrics:
                value = metrics[metric]
            elif metrics is not None and other is not None:
                value = _difference(row.metrics.get(metric), other.metrics.get(metric), relative="frequency" in name)
            if isinstance(value, int | float) and math.isfinite(value):
                errors[name, reference] = abs(float(value))
    return errors


def _difference(value: Value, reference: Value, relative: bool) -> Value:
    if not isinstance(value, int | float) or not isinstance(reference, int | float):
        return None
    return (value - reference) / reference if relative and reference else value - reference


def front(candidates: Sequence[tuple[float, float]]) -> list[tuple[float, float]]:
    """Return the (cost, error) pairs that no other beats in both, cheapest first."""
    best = math.inf
    pareto_front = []
    for cost, error in sorted(candidates):
        if error < best:
            best = error
            pareto_front.append((cost, error))
    return pareto_front


def floor(runs: Iterable[Point], quantity: str, reference: str) -> float | None:
    """Return the error of DDA at the finest step: its model form."""
    dda_runs = [run for run in runs if run.method == "dda" and (quantity, reference) in run.errors]
    return min(dda_runs, key=lambda run: run.scene.time.step).errors[quantity, reference] if dda_runs else None


def cheapest(runs: Sequence[Point], error: float, reference: str = "continuum") -> Point | None:
    """Return the run of least seconds whose displacement and contact pressure are both within an error."""
    within_error = [point for point in runs if point.reaches(error, reference)]
    return min(within_error, key=lambda run: run.seconds, default=None)


Cost = Callable[[Point], float]
COSTS: dict[str, Cost] = {"seconds": lambda p: p.seconds, "unknowns × steps": lambda p: p.work}
