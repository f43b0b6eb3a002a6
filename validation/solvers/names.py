"""The names in a scene that belong to other rooms: solvers, their columns, metrics and pairs of gates."""

from __future__ import annotations

from validation.errors import InputError
from validation.metrics.catalogue import CATALOGUE, PAIRS
from validation.scenes import features
from validation.scenes.scene import Scene
from validation.solvers.registry import FULL, get_solver, is_solver, solver_names


def check_names(scene: Scene, source: str) -> None:
    """Check what a scene names, before anything runs.

    Raises
    ------
    InputError
        A solver or a metric is unknown, a column is one that none of the solvers has, or a gate's pair does not fit.
    """
    solver_columns: dict[str, None] = {}
    for name in scene.run.solvers:
        solver = name.removesuffix(FULL)
        if not is_solver(solver):
            rule = f"must be among {', '.join(solver_names())}"
            raise InputError(rule, source=source, field="run.solvers", value=repr(name))
        adapter = get_solver(solver)
        adapter.check_module()
        solver_columns |= dict.fromkeys(adapter.columns() or scene.run.columns)
    for column in scene.run.columns:
        if column not in solver_columns and not scene.kind.has_column(scene, column):
            raise InputError(
                f"must be among {', '.join(solver_columns)}", source=source, field="run.columns", value=repr(column)
            )
    pairs_and_metrics = set()
    for number, gate in enumerate(scene.gate):
        if (gate.pair, gate.metric) in pairs_and_metrics:
            raise InputError(
                "must not repeat pair and metric of another gate",
                source=source,
                field=f"gate.{number}",
                value=f"{', '.join(gate.pair)} and {gate.metric}",
            )
        pairs_and_metrics.add((gate.pair, gate.metric))
        solvers = scene.run.solvers
        field = f"gate.{number}"
        if gate.metric not in CATALOGUE:
            raise InputError(
                f"must be among {', '.join(CATALOGUE)}", source=source, field=f"{field}.metric", value=repr(gate.metric)
            )
        missing = [name for name in gate.pair if name not in solvers]
        if missing:
            raise InputError(
                "must be solvers that run.solvers lists", source=source, field=f"{field}.pair", value=repr(missing[0])
            )
        if gate.metric in PAIRS and len(gate.pair) < 2:
            raise InputError(
                f"must name a solver and a reference for {gate.metric}",
                source=source,
                field=f"{field}.pair",
                value=list(gate.pair),
            )
    _check_linear(scene, source)


def _check_linear(scene: Scene, source: str) -> None:
    """Refuse a gate on a metric of linear scenes where no case is linear: it would be dropped without a word."""
    linear_metrics = {n: gate.metric for n, gate in enumerate(scene.gate) if CATALOGUE[gate.metric].linear}
    if not linear_metrics:
        return
    cases = scene.expand()
    if any(map(features.linear, cases)):
        return
    number, metric = next(iter(linear_metrics.items()))
    raise InputError(
        f"{metric} exists for linear scenes only",
        source=source,
        field=f"gate.{number}.metric",
        value=f"one with {', '.join(features.of(cases[0]))}",
    )
