"""Runs beyond one process: one pool over all studies, killed workers, memory, shards and their merge."""

from __future__ import annotations

import itertools
import json
import multiprocessing
import os
import signal
from collections import Counter
from collections.abc import Callable
from concurrent.futures import Executor, Future
from pathlib import Path
from typing import Any

import pytest
from conftest import SCENE, typed

from validation.engine import cluster, executor, shards
from validation.engine.case import Case
from validation.engine.run import run_cases, study_cases
from validation.engine.shards import Shard
from validation.engine.study import Study
from validation.errors import InputError
from validation.runs.results import Results
from validation.runs.run import Outcome
from validation.scenes.scene import Scene
from validation.solvers import memory

GATE = '[[gate]]\npair = ["dda", "bar"]\nmetric = "displacement.l2"\nband = [{}, 0.5]\nreason = "model form"\n'
SWEEP = '[run]\nsolvers = ["dda", "bar"]\n[sweep]\n"time.gg" = [1.0, 0.99, 0.98, 0.97]\n'


def sweep(scene: Scene, name: str, count: int, solvers: tuple[str, ...] = ("dda",), timed: bool = False) -> Study:
    """Return a study of so many cases, which differ by their load."""
    pressures = [5e6 + 1e3 * number for number in range(count)]
    swept = scene.model_copy(update={"name": "swept", "sweep": {"load.pressure": pressures}})
    return Study(name, name, "A sweep.", [swept], solvers, timed=timed)


# ---- one pool -------------------------------------------------------------------------------------------------------


class Recorded(Executor):
    """An executor that runs a case when its result is awaited, and notes how many waited then."""

    def __init__(self) -> None:
        self.submitted: list[tuple[Future[Any], Callable[[], Any]]] = []

    def submit(self, function: Callable[..., Any], /, *args: Any, **kwargs: Any) -> Future[Any]:
        future: Future[Any] = Future()
        self.submitted.append((future, lambda: function(*args, **kwargs)))
        return future


def test_no_worker_waits_between_studies_and_no_case_runs_twice(
    scene: Scene, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Two studies that share cases are on the pool together, that of timings runs alone after them."""
    pool = Recorded()
    waiting: list[int] = []

    def completed(futures: dict[Future[Any], Any]) -> Any:
        waiting.append(len(futures))
        for future, task in reversed(pool.submitted):  # in another order than they were submitted
            future.set_result(task())
            yield future

    monkeypatch.setattr(executor, "as_completed", completed)
    studies = [sweep(scene, "first", 3), sweep(scene, "timings", 2, timed=True), sweep(scene, "second", 5)]
    groups = [study_cases(study) for study in studies]
    progress: list[tuple[int, int]] = []
    ended = run_cases(
        groups, Results(tmp_path), executor=pool, progress=lambda done, total, _: progress.append((done, total))
    )
    assert [(group.study.name, len(group.rows)) for group in ended] == [("first", 3), ("second", 5), ("timings", 2)]
    assert waiting == [5]
    assert progress == [(number, 10) for number in range(4, 11)]
    rows = (tmp_path / "rows.jsonl").read_text().split("\n\n")
    assert Counter(json.loads(row)["key"] for row in rows).most_common()[0][1] == 2 and len(rows) == 7


@pytest.mark.long
@pytest.mark.parametrize("count", [300])
def test_a_killed_worker_costs_nothing_and_every_case_is_there_once(count: int, scene: Scene, tmp_path: Path) -> None:
    def kill(done: int, total: int, label: str) -> None:
        if done == total // 2:
            os.kill(multiprocessing.active_children()[0].pid or 0, signal.SIGKILL)

    group = study_cases(sweep(scene, "sweep", count))
    (ended,) = run_cases([group], Results(tmp_path), jobs=2, progress=kill)
    assert Counter(row.outcome for row in ended.rows.values()) == {Outcome.COMPLETED: count}
    lines = [line for line in (tmp_path / "rows.jsonl").read_text().splitlines() if line]
    assert len(lines) == len(Results(tmp_path).rows()) == len(list((tmp_path / "histories").iterdir())) == count


@pytest.mark.skipif(multiprocessing.get_start_method() != "fork", reason="workers inherit the patched run by fork")
def test_only_the_cases_of_a_lost_pool_s_workers_run_alone(
    scene: Scene, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """The first worker dies on its first case; what no worker had begun goes to another pool."""
    parent = os.getpid()
    alone: list[str] = []
    run, in_own_process = executor.execute, executor.run_in_own_process

    def deadly(case: Case, key: str, study: str) -> executor.Ending:
        if os.getpid() != parent and not (tmp_path / "killed").exists():
            (tmp_path / "killed").touch()
            os.kill(os.getpid(), signal.SIGKILL)
        return run(case, key, study)

    def noted(task: executor.Pending) -> executor.Ending:
        alone.append(task.key)
        return in_own_process(task)

    monkeypatch.setattr(executor, "execute", deadly)
    monkeypatch.setattr(executor, "run_in_own_process", noted)
    (ended,) = run_cases([study_cases(sweep(scene, "sweep", 12))], Results(tmp_path / "r"), jobs=2)
    assert {row.outcome for row in ended.rows.values()} == {Outcome.COMPLETED} and len(ended.rows) == 12
    assert 1 <= len(alone) <= 2


def test_a_case_beyond_a_worker_s_share_of_the_memory_runs_after_the_others(
    scene: Scene, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(
        memory, "needed", lambda scene, solver: (7.0 if scene.load.pressure == 5e6 else 5.0, "time.steps")
    )
    monkeypatch.setattr(memory, "available", lambda: 12.0)
    pooled: list[int] = []
    on_processes = executor.run_on_processes
    monkeypatch.setattr(
        executor, "run_on_processes", lambda tasks, *more: pooled.append(len(tasks)) or on_processes(tasks, *more)
    )
    order: list[str] = []
    (ended,) = run_cases(
        [study_cases(sweep(scene, "sweep", 4))],
        Results(tmp_path),
        jobs=2,
        progress=lambda done, total, label: order.append(label),
    )
    assert pooled == [3] and "5e+06" in order[-1].replace("5000000", "5e+06") and len(ended.rows) == 4


# ---- a cluster ------------------------------------------------------------------------------------------------------


def test_a_user_s_sources_are_those_that_no_installation_holds(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    (tmp_path / "mine.py").write_text("A = 1\n")
    (tmp_path / "ours" / "deep").mkdir(parents=True)
    for name in ("ours/__init__.py", "ours/deep/part.py", "ours/notes.txt"):
        (tmp_path / name).write_text("B = 2\n")
    monkeypatch.syspath_prepend(str(tmp_path))
    solvers = ("dda", "mine:solve", "ours.deep.part:solve", "numpy:solve", "json:solve", "nowhere:solve")
    assert set(cluster.user_sources(solvers)) == {"mine.py", "ours/__init__.py", "ours/deep/part.py"}


@pytest.mark.long
@pytest.mark.filterwarnings("ignore")  # another package's own
def test_a_user_s_solver_runs_on_workers_that_stand_elsewhere(
    scene: Scene, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """A worker's limit of memory holds for its cases."""
    distributed = pytest.importorskip("distributed")
    study = sweep(scene, "sweep", 2, ("only_here:solve", "dda"))
    large = study_cases(sweep(scene.with_values({"time.steps": 4_000_000}), "large", 1))
    options = {"n_workers": 1, "threads_per_worker": 1, "dashboard_address": None, "memory_limit": "300MB"}
    with distributed.LocalCluster(**options) as workers:
        (tmp_path / "only_here.py").write_text(
            "def solve(scene):\n    return {'displacement': [-1e-3] * scene.time.steps}\n"
        )
        monkeypatch.syspath_prepend(str(tmp_path))
        with cluster.executor(workers.scheduler_address, ["only_here:solve"]) as pool:
            ended = list(run_cases([study_cases(study), large], Results(tmp_path / "r"), executor=pool))
    rows = {group.study.name: list(group.rows.values()) for group in ended}
    assert {row.outcome for row in rows["sweep"]} == {Outcome.COMPLETED}, [row.notes for row in rows["sweep"]]
    assert rows["large"][0].outcome is Outcome.REFUSED and "0.3 GB are available" in rows["large"][0].notes[-1]


# ---- shards ---------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("count", [1, 2, 3, 7, 20])
def test_every_case_is_in_one_shard_and_shards_are_alike(count: int, scene: Scene) -> None:
    groups = [study_cases(sweep(scene, name, size, ("dda", "bar"))) for name, size in (("a", 3), ("b", 5))]
    parts = [Shard(number, count).part(groups) for number in range(1, count + 1)]
    keys = [list(shards.all_keys(part)) for part in parts]
    assert sorted(itertools.chain.from_iterable(keys)) == sorted(set(shards.all_keys(groups)))
    assert max(map(len, keys)) - min(map(len, keys)) <= 1
    shared = {key for _, key in groups[0].keyed}
    assert all(shared.isdisjoint(part[1].rows) and len(part) == 2 for part in parts)


@pytest.fixture(scope="module")
def sharded(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Return a folder with a scene file, its whole run and its run in three parts; some gates fail."""
    place = tmp_path_factory.mktemp("sharded")
    (place / "scene.toml").write_text(SCENE + SWEEP + GATE.format(0.05))
    runs = [("whole", []), *((f"part-{n}", ["--shard", f"{n}/3"]) for n in (1, 2, 3))]
    for name, options in runs:
        done = typed("run", place / "scene.toml", "--results", place / name, "--jobs", "1", *options)
        assert done.returncode == (1 if name == "whole" else 0), done.stderr
        assert name == "whole" or not (place / name / "verdicts.json").exists()
    return place


def test_merged_shards_are_the_whole_run(sharded: Path, tmp_path: Path) -> None:
    parts = [sharded / f"part-{n}" for n in (3, 1, 2)]
    done = typed("merge", *parts, "--out", tmp_path / "all", "--json")
    assert done.returncode == 1 and json.loads(done.stdout)["status"] == 1
    whole, merged = Results(sharded / "whole"), Results(tmp_path / "all")
    assert (merged.directory / "verdicts.json").read_bytes() == (whole.directory / "verdicts.json").read_bytes()
    manifest = merged.whole("scene", histories=True)
    assert {key: manifest[key] for key in ("cases", "comparisons", "alarms")} == {
        key: whole.manifest("scene")[key] for key in ("cases", "comparisons", "alarms")
    }
    assert set(merged.rows()) == set(whole.rows())
    passing = typed("merge", *parts, "--out", tmp_path / "again", "--baseline", sharded / "whole", "--quiet")
    assert (passing.returncode, passing.stdout) == (0, "")


def changed(sharded: Path, place: Path, **values: object) -> Path:
    """Copy the record of the third part, which says something else."""
    record = json.loads((sharded / "part-3" / "shards" / "3-of-3.json").read_text())
    Results(place).write_json("shards/3-of-3.json", record | values)
    return place


def test_parts_that_are_not_those_of_one_run_are_refused_by_name(sharded: Path, tmp_path: Path) -> None:
    one, two, three = (sharded / f"part-{number}" for number in (1, 2, 3))
    record = shards.read_shards([one, two, three])[0].record
    numpy = record["versions"] | {"numpy": "0.1"}
    cases: list[tuple[list[Path], str]] = [
        ([one], "not found: 2/3, 3/3"),
        ([one, two, three, two], "shard 2/3: is there twice"),
        ([one, sharded / "whole"], "whole: holds no finished shard"),
        ([one, two, changed(sharded, tmp_path / "a", versions=numpy)], "version of numpy"),
        ([one, two, changed(sharded, tmp_path / "b", studies={"scene": "0"})], "cases of scene"),
        ([one, two, changed(sharded, tmp_path / "c", options=record["options"] | {"full": True})], "full"),
        ([one, two, changed(sharded, tmp_path / "d", count=4)], "count: must be of as many parts"),
        ([one, two, changed(sharded, tmp_path / "e", number="x")], "must be what a run writes: number"),
        ([one, two, changed(sharded, tmp_path / "f")], "the row of scene[time.gg=0.99] dda is missing"),
    ]
    for directories, words in cases:
        done = typed("merge", *directories, "--out", tmp_path / "out")
        assert done.returncode == 2 and words in done.stderr and len(done.stderr.splitlines()) == 1, done.stderr
        assert not (tmp_path / "out").exists()
    done = typed("merge", one, two, three, "--out", one)
    assert done.returncode == 2 and "--out: must be a new or empty directory" in done.stderr


def test_another_version_of_the_suite_does_not_merge(
    sharded: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(shards, "version", lambda name: "0.0")
    done = typed("merge", *(sharded / f"part-{n}" for n in (1, 2, 3)), "--out", tmp_path / "out")
    assert done.returncode == 2 and "this installation: version of dda-validation: must be" in done.stderr


@pytest.mark.parametrize("text", ["0/3", "4/3", "1", "a/b", "1/0", "-1/2", "1/2/3", "01/2"])
def test_what_is_no_part_is_refused(text: str) -> None:
    with pytest.raises(InputError, match=r"^--shard: must be i/n") as error:
        Shard.parse(text)
    assert error.value.value == repr(text)


def test_a_part_without_cases_is_none_and_options_of_judging_are_those_of_merge(tmp_path: Path) -> None:
    (tmp_path / "scene.toml").write_text(SCENE.replace("steps = 50", "steps = 10") + '[run]\nsolvers = ["dda"]\n')
    statuses = []
    for part in ("1/2", "2/2"):
        done = typed("run", tmp_path / "scene.toml", "--shard", part, "--results", tmp_path / "r", "--json")
        statuses.append((done.returncode, json.loads(done.stdout)["cases"]))
    assert statuses == [(0, 1), (0, 0)]
    done = typed("merge", tmp_path / "r", "--out", tmp_path / "all", "--quiet")
    assert done.returncode == 0 and len(Results(tmp_path / "all").rows()) == 1
    done = typed("run", tmp_path / "scene.toml", "--shard", "1/2", "--require", "dda")
    assert done.returncode == 2 and "--shard: goes without --require" in done.stderr


@pytest.mark.parametrize(("solver", "memory_left", "status"), [("nowhere:solve", 1e12, 1), ("dda", 0.0, 2)])
def test_a_shard_ends_as_its_cases_do(
    solver: str, memory_left: float, status: int, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    (tmp_path / "scene.toml").write_text(SCENE + f'[run]\nsolvers = ["{solver}"]\n')
    monkeypatch.setattr(memory, "available", lambda: memory_left)
    done = typed("run", tmp_path / "scene.toml", "--shard", "1/1", "--results", tmp_path / "r")
    assert done.returncode == status
    merged = typed("merge", tmp_path / "r", "--out", tmp_path / "all")
    assert merged.returncode == status, merged.stderr
