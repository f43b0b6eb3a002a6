"""The engine: runs every case of a study once, keeps the histories, compares and judges."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from concurrent.futures import Executor
from dataclasses import replace

from validation.engine.case import Case
from validation.engine.executor import executed
from validation.engine.finished import Finished
from validation.engine.judge import compare, evaluate, existing, plain
from validation.engine.study import Study
from validation.gates.gate import Verdict
from validation.runs.case_name import scene_of
from validation.runs.provenance import provenance
from validation.runs.records import (
    AlarmRecord,
    Annotations,
    CaseRecord,
    ComparisonRecord,
    DerivedRecord,
    Manifest,
    VerdictRecord,
)
from validation.runs.results import Results
from validation.runs.row import Row
from validation.runs.run import Outcome
from validation.solvers import memory

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
    scenes = list({case.scene.name: case.scene for case in cases}.values())
    said = study.annotate(scenes, finished)
    manifest = _manifest(study, cases, finished, list(compare(finished, study.pairs)), said)
    verdicts = [evaluate(gate, finished) for gate in existing(study.gates(), scenes, finished)]
    results.write_json(f"studies/{study.name}.json", manifest)
    results.write_verdicts(study.name, [_record(verdict, study, said["alarms"]) for verdict in verdicts])
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
    # What was not installed then may be installed now, and what raised or was refused may have wanted memory.
    known = {key: row for key, row in known.items() if row.outcome not in (Outcome.NOT_RUN, Outcome.RAISED)}
    known = {key: row for key, row in known.items() if not memory.refused(row.notes)}
    for case, key in keyed:
        if not case.make_solver().cached:
            known.pop(key, None)
    pending = {key: case for case, key in keyed if key not in known}
    done = len(keyed) - len(pending)
    for row, history in executed(pending, study, jobs, executor):
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


def _record(verdict: Verdict, study: Study, alarms: Sequence[AlarmRecord]) -> VerdictRecord:
    """Return a verdict as plain data, with the kinds of alarm on its case or on its whole scene."""
    case = verdict.gate.scene
    kinds = {alarm["kind"] for alarm in alarms if alarm["scene"] in (case, scene_of(case))}
    record = verdict.record(study.name)
    record["alarms"] = sorted(kinds)
    return record


def _derived_record(finished: Finished, scene: str, name: str) -> DerivedRecord:
    row = finished.row(scene, name)
    metrics = {} if row is None else {key: plain(value) for key, value in row.metrics.items()}
    return {"scene": scene, "name": name, "metrics": metrics}


def _case_record(case: Case, finished: Finished) -> CaseRecord:
    return {
        "scene": case.scene.name,
        "title": case.scene.title,
        "solver": case.solver,
        "key": finished.rows[case.scene.name, case.solver].key,
        "definition": case.scene.definition(),
    }


def _manifest(
    study: Study,
    cases: Sequence[Case],
    finished: Finished,
    comparisons: list[ComparisonRecord],
    said: Annotations,
) -> Manifest:
    return {
        "study": study.name,
        "title": study.title,
        "purpose": study.purpose,
        "cases": [_case_record(case, finished) for case in cases],
        "comparisons": comparisons,
        "derived": [_derived_record(finished, *name) for name in finished.derived],
        "data": dict(study.data()),
        "budgets": said["budgets"],
        "alarms": said["alarms"],
        "provenance": provenance(),
    }
