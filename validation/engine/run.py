"""The engine: runs every case of a study once, keeps the histories, compares and judges."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from concurrent.futures import Executor
from dataclasses import replace

import numpy as np

from validation.engine.case import Case
from validation.engine.executor import executed
from validation.engine.finished import Finished
from validation.engine.judge import compare, evaluate, existing, plain
from validation.engine.measure import columns_of
from validation.engine.origin import of_rows
from validation.engine.study import Study
from validation.gates.gate import Verdict
from validation.runs.case_name import scene_of
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
from validation.runs.text import error_text
from validation.scenes.scene import Scene

Progress = Callable[[int, int, str], None]
# What was not installed then may be installed now; memory, time and files that were wanting may be there.
RUN_AGAIN = (Outcome.NOT_RUN, Outcome.RAISED, Outcome.REFUSED, Outcome.TIMEOUT)


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
    annotations = _annotated(study, scenes, finished)
    manifest = _manifest(study, cases, finished, list(compare(finished, study.pairs)), annotations)
    verdicts = [evaluate(gate, finished) for gate in existing(study.gates(), scenes, finished)]
    results.write_json(f"studies/{study.name}.json", manifest)
    results.write_verdicts(study.name, [_record(verdict, study, annotations["alarms"]) for verdict in verdicts])
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
    """Take finished cases from the results directory and run the others, each kept as soon as it ends.

    Parameters
    ----------
    cases, study
        The cases, and the study whose names their rows get.
    results, jobs, executor, progress
        As in `run_study`.
    """
    keyed = [(case, case.key()) for case in cases]
    rows_by_key = {} if study.timed else _valid_rows(keyed, results)
    pending = {key: case for case, key in keyed if key not in rows_by_key}
    restored = len(keyed) - len(pending)
    for number, (row, history) in enumerate(executed(pending, study, jobs, executor), start=restored + 1):
        results.append(row, history)
        rows_by_key[row.key] = row
        if progress:
            progress(number, len(keyed), f"{row.scene} {row.solver}")
    rows = {(case.scene.name, case.solver): _relabelled(rows_by_key[key], case, study) for case, key in keyed}
    return Finished(rows, results, study.recipes())


def _valid_rows(keyed: Sequence[tuple[Case, str]], results: Results) -> dict[str, Row]:
    """Return the rows of the results directory that need not be made again."""
    rows = results.rows()
    return {key: rows[key] for case, key in keyed if key in rows and _is_valid(rows[key], case, results)}


def _is_valid(row: Row, case: Case, results: Results) -> bool:
    """Whether a kept row stands for its case: it says what made it, and its history is whole."""
    if row.outcome in RUN_AGAIN or not row.provenance or not case.make_solver().cached:
        return False
    return results.sound(row, case.scene.time.steps, columns_of(case))


def _relabelled(row: Row, case: Case, study: Study) -> Row:
    """Give a row that another scene or study has brought the names of this one."""
    return replace(row, scene=case.scene.name, study=study.name, solver=case.solver)


@np.errstate(divide="raise", invalid="raise")
def _annotated(study: Study, scenes: Sequence[Scene], finished: Finished) -> Annotations:
    """Return alarms and budgets; a scene whose numbers they cannot take is named by an alarm of its own."""
    failed: dict[str, str] = {}
    try:
        return study.annotate(scenes, finished)
    except Exception:  # which scene it was is found one by one
        for scene in scenes:
            try:
                study.annotate([scene], finished)
            except Exception as error:
                failed[scene.name] = error_text(error)
    annotations = study.annotate([scene for scene in scenes if scene.name not in failed], finished)
    unexamined: list[AlarmRecord] = [
        {"kind": "not examined", "scene": name, "sentence": f"alarms and damping budget: {why}", "values": {}}
        for name, why in failed.items()
    ]
    return {"alarms": [*annotations["alarms"], *unexamined], "budgets": annotations["budgets"]}


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
    annotations: Annotations,
) -> Manifest:
    return {
        "study": study.name,
        "title": study.title,
        "purpose": study.purpose,
        "cases": [_case_record(case, finished) for case in cases],
        "comparisons": comparisons,
        "derived": [_derived_record(finished, *name) for name in finished.derived],
        "data": dict(study.data()),
        "budgets": annotations["budgets"],
        "alarms": annotations["alarms"],
        "provenance": of_rows(finished.rows.values()),
    }
