"""Runs beyond one process: one pool over all studies, killed workers, memory, a cluster."""

import json
import multiprocessing
import os
import signal
import sys
from collections import Counter
from concurrent.futures import Executor, Future

import pytest

from validation.engine import cluster, executor
from validation.engine.run import run_cases, study_cases
from validation.engine.study import Study
from validation.errors import InputError
from validation.runs.results import Results
from validation.runs.run import Outcome
from validation.solvers import memory


def sweep(scene, name, count, solvers=("dda",), timed=False):
    """Return a study of so many cases, which differ by their load."""
    pressures = [5e6 + 1e3 * number for number in range(count)]
    swept = scene.model_copy(update={"name": "swept", "sweep": {"load.pressure": pressures}})
    return Study(name, name, "A sweep.", [swept], solvers, timed=timed)


# ---- one pool -------------------------------------------------------------------------------------------------------


class Recorded(Executor):
    """An executor that runs a case when its result is awaited, and notes how many waited then."""

    def __init__(self):
        self.submitted = []

    def submit(self, function, /, *args, **kwargs):
        future = Future()
        self.submitted.append((future, lambda: function(*args, **kwargs)))
        return future


def test_no_worker_waits_between_studies_and_no_case_runs_twice(scene, tmp_path, monkeypatch):
    """Two studies that share cases are on the pool together, that of timings runs alone after them."""
    pool = Recorded()
    waiting = []

    def completed(futures):
        waiting.append(len(futures))
        for future, task in reversed(pool.submitted):  # in another order than they were submitted
            future.set_result(task())
            yield future

    monkeypatch.setattr(executor, "as_completed", completed)
    studies = [sweep(scene, "first", 3), sweep(scene, "timings", 2, timed=True), sweep(scene, "second", 5)]
    groups = [study_cases(study) for study in studies]
    progress = []
    ended = run_cases(
        groups, Results(tmp_path), executor=pool, progress=lambda done, total, _: progress.append((done, total))
    )
    assert [(group.study.name, len(group.rows)) for group in ended] == [("first", 3), ("second", 5), ("timings", 2)]
    assert waiting == [5]
    assert progress == [(number, 10) for number in range(4, 11)]
    rows = (tmp_path / "rows.jsonl").read_text().split("\n\n")
    assert Counter(json.loads(row)["key"] for row in rows).most_common()[0][1] == 1 and len(rows) == 7


@pytest.mark.skipif(multiprocessing.get_start_method() != "fork", reason="workers inherit the patched run by fork")
def test_only_the_cases_of_a_lost_pool_s_workers_run_alone(scene, tmp_path, monkeypatch):
    """The first worker dies on its first case; what no worker had begun goes to another pool."""
    parent = os.getpid()
    alone = []
    run, in_own_process = executor.execute, executor.run_in_own_process

    def deadly(case, key, study):
        if os.getpid() != parent and not (tmp_path / "killed").exists():
            (tmp_path / "killed").touch()
            os.kill(os.getpid(), signal.SIGKILL)
        return run(case, key, study)

    def noted(task):
        alone.append(task.key)
        return in_own_process(task)

    monkeypatch.setattr(executor, "execute", deadly)
    monkeypatch.setattr(executor, "run_in_own_process", noted)
    (ended,) = run_cases([study_cases(sweep(scene, "sweep", 6))], Results(tmp_path / "r"), jobs=2)
    assert {row.outcome for row in ended.rows.values()} == {Outcome.COMPLETED} and len(ended.rows) == 6
    assert 1 <= len(alone) <= 2


def test_a_case_beyond_a_worker_s_share_of_the_memory_runs_after_the_others(scene, tmp_path, monkeypatch):
    monkeypatch.setattr(
        memory, "needed", lambda scene, solver: (7.0 if scene.load.pressure == 5e6 else 5.0, "time.steps")
    )
    monkeypatch.setattr(memory, "available", lambda: 12.0)
    pooled = []
    on_processes = executor.run_on_processes
    monkeypatch.setattr(
        executor, "run_on_processes", lambda tasks, *more: pooled.append(len(tasks)) or on_processes(tasks, *more)
    )
    order = []
    (ended,) = run_cases(
        [study_cases(sweep(scene, "sweep", 4))],
        Results(tmp_path),
        jobs=2,
        progress=lambda done, total, label: order.append(label),
    )
    assert pooled == [3] and "5e+06" in order[-1].replace("5000000", "5e+06") and len(ended.rows) == 4


# ---- a cluster ------------------------------------------------------------------------------------------------------


def test_an_absent_package_is_named(monkeypatch):
    monkeypatch.setitem(sys.modules, "distributed", None)
    with pytest.raises(InputError) as error, cluster.executor("tcp://127.0.0.1:1"):
        pass
    assert error.value.field == "--scheduler"


def test_a_user_s_sources_are_those_that_no_installation_holds(tmp_path, monkeypatch):
    (tmp_path / "mine.py").write_text("A = 1\n")
    (tmp_path / "ours" / "deep").mkdir(parents=True)
    for name in ("ours/__init__.py", "ours/deep/part.py", "ours/notes.txt"):
        (tmp_path / name).write_text("B = 2\n")
    monkeypatch.syspath_prepend(str(tmp_path))
    solvers = ("dda", "mine:solve", "ours.deep.part:solve", "numpy:solve", "json:solve", "nowhere:solve")
    assert set(cluster.user_sources(solvers)) == {"mine.py", "ours/__init__.py", "ours/deep/part.py"}


@pytest.mark.long
@pytest.mark.filterwarnings("ignore")  # another package's own
def test_a_cluster_gives_the_rows_of_one_process_and_a_lost_worker_costs_none(scene, tmp_path):
    distributed = pytest.importorskip("distributed")
    study = sweep(scene, "sweep", 6, ("dda", "bar"))
    (serial,) = run_cases([study_cases(study)], Results(tmp_path / "serial"))
    lost = []
    with distributed.LocalCluster(n_workers=2, threads_per_worker=1, dashboard_address=None) as workers:

        def lose(done, total, label):
            if not lost:
                lost.append(next(iter(workers.workers.values())).pid)
                os.kill(lost[0], signal.SIGKILL)

        with cluster.executor(workers.scheduler_address) as pool:
            (ended,) = run_cases([study_cases(study)], Results(tmp_path / "dask"), executor=pool, progress=lose)
    assert lost and len(ended.rows) == 12
    values = [{key: (row.outcome, row.metrics) for key, row in group.rows.items()} for group in (serial, ended)]
    assert values[0] == values[1]
