"""Finished cases compared with each other and judged by gates."""

from __future__ import annotations

import itertools
from collections.abc import Iterable, Iterator, Mapping, Sequence
from typing import Any

from validation.engine.finished import Finished
from validation.gates.gate import Gate, Status, Verdict, judge, rounded
from validation.metrics.pairs import PAIRS, pair
from validation.metrics.values import ratio
from validation.runs.history import History
from validation.runs.results import Row, Value
from validation.runs.run import Outcome

ORDER = (
    "dda",
    "dda-textbook",
    "fem",
    "fem:full",
    "fenicsx",
    "fenicsx:2",
    "bar",
    "continuum",
    "dda-60",
    "fem-60",
    "bar-60",
)  # each is compared with the later
ABSENT = (Outcome.NOT_RUN, Outcome.NOT_APPLICABLE)


def compare(finished: Finished, pairs: Sequence[tuple[str, str]] | None = None) -> Iterator[dict[str, Any]]:
    """Yield the pair metrics of every solver against every later one in the order of references, or of `pairs`."""
    solvers: dict[str, list[str]] = {}
    for scene, solver in finished.rows:
        solvers.setdefault(scene, []).append(solver)
    for scene, names in solvers.items():
        asked = list(itertools.combinations(_ordered(names), 2)) if pairs is None else pairs
        needed = dict.fromkeys(solver for pair in asked for solver in pair)
        histories = {s: history for s in needed if (history := finished.history(scene, s)) is not None}
        for solver, reference in asked:
            if solver in histories and reference in histories:
                yield _comparison(finished, scene, solver, reference, histories)


def _ordered(solvers: Iterable[str]) -> list[str]:
    """Solvers in the order of references; others, which users bring, first."""
    return sorted(solvers, key=lambda s: ORDER.index(s) if s in ORDER else -1)


def _comparison(
    finished: Finished, scene: str, solver: str, reference: str, histories: Mapping[str, History]
) -> dict[str, Any]:
    history, against, static = histories[solver], histories[reference], finished.rows[scene, solver].metrics
    values = {m: _plain(pair(m, history, against, static)) for m in PAIRS}
    return {
        "scene": scene,
        "solver": solver,
        "reference": reference,
        "window": float(history.time[-1]),
        "metrics": values,
    }


def _plain(value: Value) -> Value:
    return rounded(value, 6) if isinstance(value, float) else value


def evaluate(gate: Gate, finished: Finished) -> Verdict:
    """Measure what a gate asks for and judge it."""
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
    return judge(gate, _value(gate, names, finished))


def _judged_anyway(gate: Gate, row: Row) -> bool:
    """Whether the gate asks how a run left its bounds, which a run that did can answer."""
    return gate.metric.startswith("stability.") and row.outcome in (Outcome.UNSTABLE, Outcome.OVERFLOW)


def _value(gate: Gate, names: list[tuple[str, str]], finished: Finished) -> Value:
    if gate.metric in PAIRS:
        histories = [finished.history(*name) for name in names]
        if len(histories) < 2 or histories[0] is None or histories[1] is None:
            return None
        first, second = (h if gate.until is None else h.until(gate.until) for h in histories if h is not None)
        return pair(gate.metric, first, second, finished.rows[names[0]].metrics)
    rows = [finished.row(*name) for name in names]
    values = [None if row is None else row.metrics.get(gate.metric) for row in rows]
    return values[0] if len(values) == 1 else ratio(values[0], values[1])
