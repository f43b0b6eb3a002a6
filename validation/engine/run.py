"""The engine: runs every case of a study once, keeps the histories, compares and judges."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from concurrent.futures import Executor
from dataclasses import replace
from typing import Any

from validation.advice.alarms import Alarm, alarms
from validation.advice.budget import budgets
from validation.engine.case import Case
from validation.engine.executor import _executed
from validation.engine.finished import Finished
from validation.engine.judge import _plain, compare, evaluate
from validation.engine.study import Study
from validation.gates.gate import Verdict
from validation.runs.provenance import provenance
from validation.runs.results import Results, Row
from validation.runs.run import Outcome

Progress = Callable[[int, int, str], None]


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
