"""The engine: runs every case of some studies once on one pool, keeps the histories, compares and judges."""

from __future__ import annotations

import itertools
from collections.abc import Generator, Sequence
from concurrent.futures import Executor
from contextlib import closing
from dataclasses import dataclass, field, replace

import numpy as np

from validation.engine.case import Case
from validation.engine.executor import Pending, executed
from validation.engine.finished import Finished
from validation.engine.judge import compare, evaluate, existing, plain
from validation.engine.measure import columns_of
from validation.engine.measured import JudgedStudy
from validation.engine.origin import of_rows
from validation.engine.study import Study
from validation.gates.gate import Verdict
from validation.runs.case_name import scene_of
from validation.runs.history import History
from validation.runs.progress import Progress
from validation.runs.records import (
    AlarmRecord,
    Annotations,
    CaseRecord,
    DerivedRecord,
    VerdictRecord,
)
from validation.runs.results import Results
from validation.runs.row import Row
from validation.runs.run import Outcome
from validation.runs.text import error_text
from validation.scenes.scene import Scene

# What was not installed then may be installed now; memory, time and files that were wanting may be there.
RUN_AGAIN = (Outcome.NOT_RUN, Outcome.RAISED, Outcome.REFUSED, Outcome.TIMEOUT)


@dataclass
class StudyCases:
    """The cases of a study with their keys, and the rows by key of those that have ended."""

    study: Study  # whose names the rows get
    keyed: Sequence[tuple[Case, str]]
    rows: dict[str, Row] = field(default_factory=dict)

    @property
    def cases(self) -> list[Case]:
        """The cases."""
        return [case for case, _ in self.keyed]

    def pending(self) -> list[Pending]:
        """Return the cases that have no row."""
        pending = {key: Pending(case, key, self.study.name) for case, key in self.keyed if key not in self.rows}
        return list(pending.values())

    def finished(self, results: Results) -> Finished:
        """Return the finished cases; a row that another scene or study has brought gets the names of this one."""
        rows = {}
        for case, key in self.keyed:
            row = replace(self.rows[key], scene=case.scene.name, study=self.study.name, solver=case.solver)
            rows[case.scene.name, case.solver] = row
        return Finished(rows, results, self.study.recipes)


def study_cases(study: Study, full: bool = False, ranks: int = 1) -> StudyCases:
    """Return the cases of a study with their keys; the parameters are those of `Study.cases`."""
    return StudyCases(study, [(case, case.key()) for case in study.cases(full, ranks)])


def run_study(
    study: Study,
    results: Results,
    *,
    full: bool = False,
    ranks: int = 1,
    jobs: int = 1,
    executor: Executor | None = None,
    progress: Progress | None = None,
) -> Sequence[Verdict]:
    """Run what is not finished yet, then compare and judge; everything is kept in the results directory.

    Parameters
    ----------
    full
        Switch the numerical savings of every solver off.
    ranks
        Ranks of the solvers that can be distributed.
    jobs
        Worker processes; ignored where an executor is given.
    """
    group = study_cases(study, full, ranks)
    (ended,) = run_cases([group], results, jobs=jobs, executor=executor, progress=progress)
    return judge_study(ended, results).verdicts


def finish(
    cases: Sequence[Case],
    study: Study,
    results: Results,
    *,
    jobs: int = 1,
    executor: Executor | None = None,
    progress: Progress | None = None,
) -> Finished:
    """Take finished cases from the results directory and run the others; the parameters are those of `run_study`."""
    group = StudyCases(study, [(case, case.key()) for case in cases])
    (ended,) = run_cases([group], results, jobs=jobs, executor=executor, progress=progress)
    return ended.finished(results)


def run_cases(
    groups: Sequence[StudyCases],
    results: Results,
    *,
    jobs: int = 1,
    executor: Executor | None = None,
    progress: Progress | None = None,
) -> Generator[StudyCases, None, None]:
    """Run the cases of all studies on one pool, each case once and its row kept as soon as it ends.

    The rows of `groups` are filled in, and a group is yielded as soon as its last case has ended, for which no worker
    waits. Studies of timings follow the others, in this process, one case after the other. The other parameters are
    those of `run_study`.
    """
    finished_rows = results.rows()
    untimed = [group for group in groups if not group.study.timed]
    timed = [group for group in groups if group.study.timed]
    pooled: dict[str, Pending] = {}
    missing: dict[str, list[StudyCases]] = {}  # by key, the studies that wait for its row
    for group in groups:
        for case, key in group.keyed:
            if key in finished_rows and _is_valid(finished_rows[key], case, results):
                group.rows[key] = finished_rows[key]
    for group in untimed:
        for task in group.pending():
            pooled.setdefault(task.key, task)
            missing.setdefault(task.key, []).append(group)
    total = sum(len(group.keyed) for group in groups)
    numbers = itertools.count(total - len(pooled) - sum(len(group.pending()) for group in timed) + 1)

    def keep(row: Row, history: History | None) -> None:
        results.append(row, history)
        if progress:
            progress(next(numbers), total, f"{row.scene} {row.solver}")

    waiting = {group.study.name: len(group.pending()) for group in untimed}
    yield from (group for group in untimed if not waiting[group.study.name])
    with closing(executed(list(pooled.values()), jobs, executor)) as endings:
        for row, history in endings:
            keep(row, history)
            for group in missing[row.key]:
                group.rows[row.key] = row
                waiting[group.study.name] -= 1
                if not waiting[group.study.name]:
                    yield group
    for group in timed:
        for row, history in executed(group.pending()):
            keep(row, history)
            group.rows[row.key] = row
        yield group


def judge_study(group: StudyCases, results: Results) -> JudgedStudy:
    """Compare and judge the finished cases of a study; manifest and verdicts are kept in the results directory."""
    study = group.study
    finished = group.finished(results)
    scenes = list({case.scene.name: case.scene for case in group.cases}.values())
    annotations = _annotated(study, scenes, finished)
    manifest = {
        "study": study.name,
        "title": study.title,
        "purpose": study.purpose,
        "cases": [_case_record(case, finished) for case in group.cases],
        "comparisons": list(compare(finished, study.pairs)),
        "derived": [_derived_record(finished, *name) for name in finished.derived],
        "data": dict(study.data()),
        "budgets": annotations["budgets"],
        "alarms": annotations["alarms"],
        "provenance": of_rows(finished.rows.values()),
    }
    verdicts = [evaluate(gate, finished) for gate in existing(study.gates(), scenes, finished)]
    results.write_json(f"studies/{study.name}.json", manifest)
    results.write_verdicts(study.name, [_record(verdict, study, annotations["alarms"]) for verdict in verdicts])
    return JudgedStudy(study, verdicts, {case: row.outcome for case, row in finished.rows.items()})


def _is_valid(row: Row, case: Case, results: Results) -> bool:
    """Whether a kept row stands for its case: it says what made it, and its history is whole."""
    if row.outcome in RUN_AGAIN or not row.provenance or not case.make_solver().cached:
        return False
    return results.sound(row, case.scene.time.steps, columns_of(case))


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
