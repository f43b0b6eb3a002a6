"""Real processes: killed in the middle, writing where nothing can be written, two at once in one directory."""

import json
import os
import resource
import signal
import subprocess
import sys
import time
from multiprocessing import Barrier, Process

import numpy as np
import pytest
from conftest import SCENE, refused, typed
from faults import seams

from validation.errors import InputError
from validation.runs.history import History
from validation.runs.results import Results
from validation.runs.row import Row
from validation.runs.run import Outcome

# A solver that has not answered before it may.
WAITING = """
import pathlib, time
def solve(scene):
    while not pathlib.Path(__file__).with_name("go").exists():
        time.sleep(0.02)
    return {"displacement": [-1e-3] * scene.time.steps}
"""


def start(scene, results, jobs=2):
    command = [sys.executable, "-m", "validation", "run", str(scene), "--results", str(results), "--jobs", str(jobs)]
    return subprocess.Popen(
        command, stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, text=True, start_new_session=True
    )


def rows_of(results):
    return Results(results).rows()


@pytest.mark.long
@pytest.mark.usefixtures("interruptible")
@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGKILL])
def test_a_run_that_is_killed_goes_on_where_it_stopped(number, scene_file, tmp_path, monkeypatch):
    (tmp_path / "waiting_solver.py").write_text(WAITING)
    monkeypatch.setenv("PYTHONPATH", str(tmp_path), prepend=os.pathsep)
    monkeypatch.syspath_prepend(tmp_path)  # for the second run, which is this process's
    scene_file.write_text(SCENE + '[run]\nsolvers = ["dda", "waiting_solver:solve", "bar"]\n')
    results = tmp_path / "r"
    with start(scene_file, results) as process:
        deadline = time.monotonic() + 60
        while process.poll() is None and time.monotonic() < deadline and len(rows_of(results)) < 2:
            time.sleep(0.02)
        os.killpg(process.pid, number)
        _, said = process.communicate(timeout=60)
    kept = rows_of(results)
    assert "Traceback" not in said
    assert {row.solver for row in kept.values()} == {"dda", "bar"}
    assert all(Results(results).history(row.key) is not None for row in kept.values())
    assert not list(results.glob("histories/.*")) or number == signal.SIGKILL
    before = (results / "rows.jsonl").read_bytes()
    (tmp_path / "go").touch()
    done = typed("run", scene_file, "--results", results)
    assert done.returncode == 0, done.stderr
    after = (results / "rows.jsonl").read_bytes()
    assert after.startswith(before), "finished rows are kept as they were"
    assert len(rows_of(results)) == 3
    fresh = [line for line in after[len(before) :].splitlines() if line.strip()]
    assert len(fresh) == 1, "only what was missing runs"


def write_again_and_again(directory, study, start):
    """Write verdicts, of which those before must still be there."""
    start.wait(60)
    for i in range(40):
        kept = Results(directory).read_json("verdicts.json", [], list[dict[str, str]])
        assert [verdict["id"] for verdict in kept if verdict["study"] == study] == [str(i - 1)] * (i > 0)
        Results(directory).write_verdicts(study, [{"study": study, "id": str(i)}])


def test_verdicts_of_two_studies_written_at_once_are_both_kept(tmp_path):
    start = Barrier(2)
    many = [Process(target=write_again_and_again, args=(tmp_path, name, start)) for name in ("a", "b")]
    for process in many:
        process.start()
    for process in many:
        process.join(60)
    assert [process.exitcode for process in many] == [0, 0]
    assert {verdict["study"] for verdict in json.loads((tmp_path / "verdicts.json").read_text())} == {"a", "b"}


def finished(name):
    return Row(name, "s", "x", "dda", Outcome.COMPLETED, {}), History(np.ones(3), {"displacement": np.ones(3)})


def test_a_write_that_fails_is_reported_and_costs_no_finished_row(tmp_path, monkeypatch):
    results = Results(tmp_path)
    results.append(*finished("first"))
    monkeypatch.setattr(os, "write", lambda handle, data: 5)  # a disk that is full takes the beginning
    with pytest.raises(InputError, match=r"rows.jsonl: cannot be written: .* finished rows are kept"):
        results.append(*finished("second"))
    monkeypatch.undo()
    results.append(*finished("third"))
    assert set(results.rows()) == {"first", "third"}


def test_a_directory_that_cannot_be_written_is_one_line(scene_file, tmp_path):
    (tmp_path / "file").write_text("not a directory")
    refused("run", scene_file, "--results", tmp_path / "file" / "r")
    (tmp_path / "r" / "rows.jsonl").mkdir(parents=True)
    assert "must be a regular file" in refused("run", scene_file, "--results", tmp_path / "r")


def test_a_write_that_fails_in_the_middle_of_a_study_is_one_line(scene_file, tmp_path, monkeypatch):
    """A limit on the size of files stands for a full disk: the second history does not fit."""
    scene_file.write_text(SCENE + '[run]\nsolvers = ["dda"]\n[sweep]\n"time.steps" = [10, 4000]\n')
    monkeypatch.setattr(sys, "dont_write_bytecode", True)  # a compiled file would be cut off, and kept
    made = {"python": "3", "commit": "here", "packages": {}}
    seams.ORIGIN.put(monkeypatch, lambda: made)  # git would be ended in the middle of its index, and leave its lock
    before = resource.getrlimit(resource.RLIMIT_FSIZE)
    resource.setrlimit(resource.RLIMIT_FSIZE, (16_384, before[1]))
    try:
        said = refused("run", scene_file, "--results", tmp_path / "r")
    finally:
        resource.setrlimit(resource.RLIMIT_FSIZE, before)
    assert "cannot be written: File too large" in said
    assert len(rows_of(tmp_path / "r")) == 1
    assert len(list((tmp_path / "r" / "histories").iterdir())) == 1
    assert typed("run", scene_file, "--results", tmp_path / "r").returncode == 0
    assert len(rows_of(tmp_path / "r")) == 2
