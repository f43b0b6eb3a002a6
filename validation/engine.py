"""The engine: runs every case of a study once, keeps the histories, compares and judges.

Caching, resuming, parallel running, interruption safety and progress are here and nowhere else.
"""

from __future__ import annotations

import itertools
import signal
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from concurrent.futures import BrokenExecutor, Executor, ProcessPoolExecutor, as_completed
from contextlib import contextmanager
from dataclasses import dataclass, field, replace
from typing import Any

from validation import metrics
from validation.alarms import Alarm, alarms
from validation.budget import budgets
from validation.cases import Case, execute
from validation.gates import Gate, Status, Verdict, judge, rounded
from validation.history import History, Outcome
from validation.provenance import provenance
from validation.results import Results, Row, Value
from validation.studies import Derived, Study

Progress = Callable[[int, int, str], None]
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


@dataclass(frozen=True)
class Finished:
    """The finished cases of a study: rows and histories by (scene, solver), and what is derived from them."""

    rows: dict[tuple[str, str], Row]
    results: Results
    derived: Mapping[tuple[str, str], Derived] = field(default_factory=dict)

    def row(self, scene: str, name: str) -> Row | None:
        """Return the row of a case, or compute the derived row of that name."""
        recipe = self.derived.get((scene, name))
        if recipe is None or (scene, name) in self.rows:
            return self.rows.get((scene, name))
        for need in recipe.needs:
            row = self.rows.get(need)
            if row is None or row.outcome is not Outcome.COMPLETED:
                outcome = Outcome.NOT_RUN if row is None else row.outcome
                return Row("", "", scene, name, outcome, {}, notes=(f"needs {need[1]} on {need[0]}",))
        try:
            return Row("", "", scene, name, Outcome.COMPLETED, recipe.compute(self))
        except (ArithmeticError, LookupError, ValueError) as error:  # numbers that a faulty run leaves without meaning
            return Row("", "", scene, name, Outcome.RAISED, {}, notes=(f"{type(error).__name__}: {error}",))

    def history(self, scene: str, solver: str) -> History | None:
        """Return the history of a case, or None."""
        row = self.rows.get((scene, solver))
        return None if row is None or row.outcome is not Outcome.COMPLETED else self.results.history(row.key)


def run_study(
    study: Study,
    results: Results,
    *,
    full: bool = False,
    ranks: int = 1,
    jobs: int = 1,
    executor: Executor | None = None,
    progress: Progress | None = None,
) -> list[Verdict]:
    """Run what is not finished yet, then compare and judge; everything is kept in the results directory.

    Parameters
    ----------
    study
        The declaration.
    results
        Where finished cases are found and kept.
    full
        Switch the numerical savings of every solver off.
    ranks
        Ranks of the solvers that can be distributed.
    jobs
        Worker processes; ignored where an executor is given.
    executor
        Any executor of the standard library's interface.
    progress
        Called with (done, total, label) after each case.
    """
    cases = study.cases(full, ranks)
    finished = finish(cases, study, results, jobs=jobs, executor=executor, progress=progress)
    comparisons = list(compare(finished, study.pairs))
    verdicts = [evaluate(gate, finished) for gate in study.gates()]
    raised = list(alarms({case.scene.name: case.scene for case in cases}.values(), finished))
    results.write_json(f"studies/{study.name}.json", _manifest(study, cases, finished, comparisons, raised))
    results.write_verdicts(study.name, [_record(verdict, study, raised) for verdict in verdicts])
    return verdicts


def finish(
    cases: Sequence[Case],
    study: Study,
    results: Results,
    *,
    jobs: int = 1,
    executor: Executor | None = None,
    progress: Progress | None = None,
) -> Finished:
    """Take finished cases from the results directory and run the others, each kept as soon as it ends."""
    keyed = [(case, case.key()) for case in cases]
    known = {} if study.timed else {key: row for key, row in results.rows().items() if results.has(row)}
    # What was not installed then may be installed now, and what raised may have wanted memory.
    known = {key: row for key, row in known.items() if row.outcome not in (Outcome.NOT_RUN, Outcome.RAISED)}
    for case, key in keyed:
        if not case.make_solver().cached:
            known.pop(key, None)
    pending = {key: case for case, key in keyed if key not in known}
    done = len(keyed) - len(pending)
    for row, history in _executed(pending, study, jobs, executor):
        results.append(row, history)
        known[row.key] = row
        done += 1
        if progress:
            progress(done, len(keyed), f"{row.scene} {row.solver}")
    rows = {(case.scene.name, case.solver): _named(known[key], case, study) for case, key in keyed}
    return Finished(rows, results, study.recipes())


def _named(row: Row, case: Case, study: Study) -> Row:
    """Give a row that another scene or study has brought the names of this one."""
    return replace(row, scene=case.scene.name, study=study.name)


def _executed(
    pending: dict[str, Case], study: Study, jobs: int, executor: Executor | None
) -> Iterator[tuple[Row, History | None]]:
    """Run the pending cases, in this process where one worker or one case is all there is."""
    if study.timed or (executor is None and min(jobs, len(pending)) <= 1):
        for key, case in pending.items():
            yield execute(case, key, study.name)
        return
    lost = []
    with _pool(executor, min(jobs, len(pending))) as pool:
        futures = {pool.submit(execute, case, key, study.name): key for key, case in pending.items()}
        for future in as_completed(futures):
            if isinstance(future.exception(), BrokenExecutor):
                lost.append(futures[future])
            else:
                yield future.result()
    for key in lost:
        yield _alone(pending[key], key, study)


def _alone(case: Case, key: str, study: Study) -> tuple[Row, History | None]:
    """Run a case in a process of its own: one that kills its worker, for want of memory, is a row like any other."""
    with _pool(None, 1) as pool:
        try:
            return pool.submit(execute, case, key, study.name).result()
        except BrokenExecutor:
            note = "the process died, for want of memory or by a signal"
            return Row(key, study.name, case.scene.name, case.solver, Outcome.RAISED, {}, notes=(note,)), None


@contextmanager
def _pool(executor: Executor | None, jobs: int) -> Iterator[Executor]:
    """Yield the given executor, or one of processes that goes down at once on an interruption."""
    if executor is not None:
        yield executor
        return
    pool, wait = ProcessPoolExecutor(jobs, initializer=_ignore_interrupt), True
    try:
        yield pool
    except KeyboardInterrupt:
        # A worker that ends while it hands over a result leaves the pool's thread waiting for the rest of it.
        wait = False
        for process in (pool._processes or {}).values():
            process.terminate()
        raise
    finally:
        pool.shutdown(wait=wait, cancel_futures=True)


def _ignore_interrupt() -> None:
    """Leave Ctrl-C to the parent, which ends the workers."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)


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
    values = {m: _plain(metrics.pair(m, history, against, static)) for m in metrics.PAIRS}
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
    if gate.metric in metrics.PAIRS:
        histories = [finished.history(*name) for name in names]
        if len(histories) < 2 or histories[0] is None or histories[1] is None:
            return None
        first, second = (h if gate.until is None else h.until(gate.until) for h in histories if h is not None)
        return metrics.pair(gate.metric, first, second, finished.rows[names[0]].metrics)
    rows = [finished.row(*name) for name in names]
    values = [None if row is None else row.metrics.get(gate.metric) for row in rows]
    return values[0] if len(values) == 1 else metrics.ratio(values[0], values[1])


def _record(verdict: Verdict, study: Study, raised: Sequence[Alarm]) -> dict[str, Any]:
    """Return a verdict as plain data, with the kinds of alarm on its case."""
    kinds = {
        alarm.kind for alarm in raised if alarm.scene in (verdict.gate.scene, verdict.gate.scene.partition("[")[0])
    }
    return verdict.record(study.name) | {"alarms": sorted(kinds)}


def _derived_record(finished: Finished, scene: str, name: str) -> dict[str, Any]:
    row = finished.row(scene, name)
    metrics = {} if row is None else {key: _plain(value) for key, value in row.metrics.items()}
    return {"scene": scene, "name": name, "metrics": metrics}


def _manifest(
    study: Study,
    cases: Sequence[Case],
    finished: Finished,
    comparisons: list[dict[str, Any]],
    raised: Sequence[Alarm],
) -> dict[str, Any]:
    listed = [
        {
            "scene": case.scene.name,
            "title": case.scene.title,
            "solver": case.solver,
            "key": finished.rows[case.scene.name, case.solver].key,
            "definition": case.scene.definition(),
        }
        for case in cases
    ]
    return {
        "study": study.name,
        "title": study.title,
        "purpose": study.purpose,
        "cases": listed,
        "comparisons": comparisons,
        "derived": [_derived_record(finished, *name) for name in finished.derived],
        "data": dict(study.data()),
        "budgets": list(budgets(case.scene for case in cases if case.solver == "dda")),
        "alarms": [alarm.record() for alarm in raised],
        "provenance": provenance(),
    }
