"""Memory: limits of control groups count, and a refusal for want of it is not kept."""

import math
import os
from dataclasses import replace
from pathlib import Path

import pytest
from conftest import SCENE

from validation.engine.run import run_study
from validation.errors import InputError
from validation.runs.results import Results
from validation.runs.run import Outcome
from validation.scenes.scene import load_scene
from validation.solvers import memory
from validation.solvers.hooks import SolvingHooks
from validation.solvers.registry import get_solver, solve
from validation.suite.folders import scene_study

MB = 2**20


def machine(root, groups, files):
    """Make the files of a machine's control groups."""
    for name, text in {"proc/self/cgroup": groups, **{f"sys/fs/cgroup/{n}": t for n, t in files.items()}}.items():
        path = root / name
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(text)
    return root


def left(root):
    return min(memory.of_groups(root), default=math.inf)


V2 = "0::/user.slice/job.scope\n"
JOB, USER = "user.slice/job.scope", "user.slice"


@pytest.mark.parametrize(
    ("groups", "files", "expected"),
    [
        (V2, {}, math.inf),
        (V2, {f"{JOB}/memory.max": "max\n", f"{JOB}/memory.high": "max\n", f"{JOB}/memory.current": "5\n"}, math.inf),
        (V2, {f"{JOB}/memory.max": f"{100 * MB}\n", f"{JOB}/memory.current": f"{30 * MB}\n"}, 70 * MB),
        (V2, {f"{JOB}/memory.max": "max", f"{JOB}/memory.high": f"{60 * MB}", f"{JOB}/memory.current": "0"}, 60 * MB),
        (V2, {f"{JOB}/memory.max": f"{90 * MB}", f"{JOB}/memory.high": f"{60 * MB}"}, 60 * MB),
        (V2, {f"{USER}/memory.max": f"{50 * MB}", f"{USER}/memory.current": f"{MB}"}, 49 * MB),
        (V2, {"memory.max": f"{40 * MB}", "memory.current": "0"}, 40 * MB),  # a container that sees its own root
        (
            V2,
            {
                f"{JOB}/memory.max": f"{100 * MB}",
                f"{JOB}/memory.current": f"{90 * MB}",
                f"{JOB}/memory.stat": f"anon {10 * MB}\nfile {80 * MB}\ninactive_file {60 * MB}\n",
            },
            70 * MB,
        ),
        ("rubbish\n", {"memory.max": "1"}, math.inf),
    ],
)
def test_what_control_groups_leave(groups, files, expected, tmp_path):
    assert left(machine(tmp_path, groups, files)) == expected


def test_a_machine_that_does_not_say_what_is_available_says_what_it_has(monkeypatch):
    monkeypatch.setattr(Path, "read_text", lambda path, **options: "")
    assert memory._of_machine() == os.sysconf("SC_PAGE_SIZE") * os.sysconf("SC_PHYS_PAGES")
    monkeypatch.setattr(Path, "read_text", lambda path, **options: "MemAvailable: 7 kB")
    assert memory._of_machine() == 7 * 1024.0
    assert SolvingHooks().memory(None, None) == (0.0, "time.steps") and SolvingHooks().reach(None) == math.inf


def test_a_worker_that_may_have_less_than_goes_unnoticed_is_asked_all_the_same(tmp_path):
    path = tmp_path / "own.toml"
    path.write_text(SCENE)
    scene, solver = load_scene(path), get_solver("dda")
    memory.check(scene, solver)
    with pytest.raises(InputError, match=memory.REFUSED):
        memory.check(scene, solver, limit=1.0)


def test_a_refusal_for_want_of_memory_is_not_kept(tmp_path, monkeypatch):
    path, results = tmp_path / "own.toml", Results(tmp_path / "r")
    path.write_text(SCENE + '[run]\nsolvers = ["dda"]\n')
    study = replace(scene_study(str(path)), annotate=lambda *given: {"alarms": [], "budgets": []})
    monkeypatch.setattr(memory, "UNNOTICED", 0.0)
    monkeypatch.setattr(memory, "available", lambda: 1.0)
    with pytest.raises(InputError, match=memory.REFUSED):
        solve(load_scene(path), "dda")
    run_study(study, results)
    (row,) = results.rows().values()
    assert row.outcome is Outcome.REFUSED and any(memory.REFUSED in note for note in row.notes)
    monkeypatch.undo()
    run_study(study, results)
    (row,) = results.rows().values()
    assert row.outcome is Outcome.COMPLETED and not any(memory.REFUSED in note for note in row.notes)
