"""Finished cases compared with each other and judged by gates."""

from __future__ import annotations

import itertools
import math
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import replace

from validation.engine.finished import Derived, Finished
from validation.gates.gate import Gate, Status, Verdict, judge, rounded
from validation.metrics.catalogue import CATALOGUE, PAIRS, pair
from validation.metrics.values import UNDEFINED, finite, ratio
from validation.runs.history import History
from validation.runs.records import ComparisonRecord
from validation.runs.row import Metrics, Row, Value
from validation.runs.run import Outcome
from validation.scenes import features
from validation.scenes.scene import Scene
from validation.solvers.registry import rank

HORIZON = "horizon.time"  # up to which histories are compared
ABSENT = (Outcome.NOT_RUN, Outcome.NOT_APPLICABLE)


def compare(finished: Finished, pairs: Sequence[tuple[str, str]] | None = None) -> Iterator[ComparisonRecord]:
    """Yield the pair metrics of the solvers of each scene, of `pairs` of solver and reference.

    None stands for every solver against every later one in the order of references.
    """
    solvers: dict[str, list[str]] = {}
    for scene, solver in finished.rows:
        solvers.setdefault(scene, []).append(solver)
    for scene, names in solvers.items():
        solver_pairs = list(itertools.combinations(_ordered(names), 2)) if pairs is None else pairs
        needed = dict.fromkeys(itertools.chain.from_iterable(solver_pairs))
        histories = {s: history for s in needed if (history := finished.history(scene, s)) is not None}
        for solver, reference in solver_pairs:
            if solver in histories and reference in histories:
                yield _comparison(finished, scene, solver, reference, histories)


def _ordered(solvers: Iterable[str]) -> list[str]:
    """Solvers in the order of references; those that users bring come first."""
    return sorted(solvers, key=rank)


def _comparison(
    finished: Finished, scene: str, solver: str, reference: str, histories: Mapping[str, History]
) -> ComparisonRecord:
    history = histories[solver]
    metrics = finished.rows[scene, solver].metrics
    values = {metric: plain(_paired(metric, history, histories[reference], metrics)) for metric in PAIRS}
    return {
        "scene": scene,
        "solver": solver,
        "reference": reference,
        "window": float(history.time[-1]),
        "metrics": values,
    }


def _paired(metric: str, history: History, reference: History, static: Metrics) -> Value:
    """Return a metric of a pair; undefined where the numbers leave its arithmetic."""
    try:
        return pair(metric, history, reference, static)
    except (ArithmeticError, ValueError):  # LinAlgError is one
        return UNDEFINED


def plain(value: Value) -> Value:
    """Return a value as it is kept: six digits, well above the last bits; no number beyond the range of numbers."""
    value = finite(value)
    return rounded(value, 6) if isinstance(value, float) else value


def existing(gates: Iterable[Gate], scenes: Iterable[Scene], finished: Finished) -> list[Gate]:
    """Return the gates that have a meaning: those on modes, spectra and statics exist for linear scenes only."""
    nonlinear = {scene.name for scene in scenes if not features.linear(scene)}
    return [
        gate for gate in gates if not (nonlinear & {name for name, _ in gate.cases} and _linear_only(gate, finished))
    ]


def _linear_only(gate: Gate, finished: Finished) -> bool:
    derived = [finished.derived[name].linear for name in gate.cases if name in finished.derived]
    return any(derived) or (gate.metric in CATALOGUE and CATALOGUE[gate.metric].linear)


def reads(gate: Gate, derived: Mapping[tuple[str, str], Derived]) -> Iterator[tuple[tuple[str, str], str]]:
    """Yield what `evaluate` reads of rows: a case and solver with a metric, those behind derived rows included."""
    for name in gate.cases:
        recipe = derived.get(name)
        if recipe is not None:
            yield from itertools.product(recipe.needs, recipe.reads)
        else:
            yield name, HORIZON if gate.metric in PAIRS else gate.metric
    quantity, _, kind = gate.metric.partition(".")
    if gate.metric in PAIRS and kind == "scaled":
        yield gate.cases[0], f"{quantity}.static"


def evaluate(gate: Gate, finished: Finished) -> Verdict:
    """Measure what a gate asks for and judge it.

    It is NOT RUN where a case is absent, FAIL where one did not complete, else what value and band say.
    """
    names = gate.cases
    for name in names:
        row = finished.row(*name)
        if row is None or row.outcome in ABSENT:
            why = f"{name[1]} was not run" if row is None else f"{name[1]}: {'; '.join(row.notes)}"
            return Verdict(gate, None, Status.NOT_RUN, why)
        if row.outcome is not Outcome.COMPLETED and not _judged_anyway(gate, row):
            return Verdict(gate, None, Status.FAIL, f"{name[1]}: {row.outcome.sentence} {'; '.join(row.notes)}")
    if names[0] == names[-1] and len(names) == 2:
        return Verdict(gate, None, Status.FAIL, "a run was compared with itself")
    verdict = judge(gate, _value(gate, names, finished))
    return replace(verdict, why="; ".join(filter(None, (verdict.why, _shortened(gate, names, finished)))))


def _judged_anyway(gate: Gate, row: Row) -> bool:
    """Whether the gate asks how a run left its bounds, which a run that did can answer."""
    return gate.metric.startswith("stability.") and row.outcome in (Outcome.UNSTABLE, Outcome.OVERFLOW)


def compared_until(gate: Gate, names: list[tuple[str, str]], finished: Finished) -> float | None:
    """Return the time up to which two histories are compared [s]: the gate's, or the horizon of either if earlier."""
    horizons = [row.metrics.get(HORIZON) for row in map(finished.rows.get, names) if row is not None]
    limits = [gate.until, *(value for value in horizons if isinstance(value, float))]
    return min((limit for limit in limits if limit is not None), default=None)


def _shortened(gate: Gate, names: list[tuple[str, str]], finished: Finished) -> str:
    """Say up to when two histories were compared, where that is less than the gate asks for."""
    until = compared_until(gate, names, finished) if gate.metric in PAIRS else None
    if until is None:
        return ""
    ends = [float(h.time[-1]) for h in itertools.starmap(finished.history, names) if h is not None and len(h.time)]
    if until >= min([*ends, gate.until or math.inf]) * (1 - 1e-9):
        return ""
    return f"compared up to {until:.4g} s, where the switches of the contact have amplified rounding to 1e-6"


def _value(gate: Gate, names: list[tuple[str, str]], finished: Finished) -> Value:
    if gate.metric in PAIRS:
        histories = list(itertools.starmap(finished.history, names))
        if len(histories) < 2 or histories[0] is None or histories[1] is None:
            return None
        until = compared_until(gate, names, finished)
        first, second = (h if until is None else h.until(until) for h in histories if h is not None)
        return _paired(gate.metric, first, second, finished.rows[names[0]].metrics)
    rows = list(itertools.starmap(finished.row, names))
    values = [None if row is None else row.metrics.get(gate.metric) for row in rows]
    return values[0] if len(values) == 1 else ratio(values[0], values[1])
