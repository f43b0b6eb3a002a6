"""Users' solvers that do whatever a program can do wrong: named outcomes, in time, and nothing left of them."""

import os
import sys
import tomllib
from pathlib import Path

import pytest
from conftest import thinned
from oracles.processes import MARK, left, new_mark

from validation.engine.case import Case
from validation.engine.measure import execute
from validation.runs.row import Row
from validation.runs.run import Outcome
from validation.scenes.scene import load_scene
from validation.solvers.processes import worker
from validation.solvers.user import VARIABLE, UserSolver

HERE = Path(__file__).parent / "user_solvers"
needs_linux = pytest.mark.skipif(not Path("/proc/self/fd").exists(), reason="the solver finds its pipes in /proc")


@pytest.fixture
def mark(monkeypatch):
    monkeypatch.setattr(worker, "workers", {})  # what other tests have started has no mark
    with new_mark() as name:
        monkeypatch.setenv(MARK, name)
        yield name


@pytest.fixture
def scene(scene_file, monkeypatch):
    monkeypatch.syspath_prepend(str(HERE))
    return load_scene(scene_file)


def row_of(scene, solver):
    """Return the row of a case, and see that it can be written and read again."""
    row, _ = execute(Case(scene, solver), "key", "study")
    again = Row.parse(row.line())
    assert again is not None and again.outcome is row.outcome
    "; ".join(row.notes).encode("utf-8")
    return row


def told(row, outcome, said):
    """Whether a row has an outcome and says why, in no more than a few lines."""
    return row.outcome is outcome and said in "; ".join(row.notes) and sum(map(len, row.notes)) < 1000


TABLES = tomllib.loads(Path(__file__).with_name("hostile_solvers.toml").read_text())
FATAL = [pytest.param(*case, marks=[needs_linux] * linux) for *case, linux in TABLES["fatal"]]


@needs_linux
def test_one_process_outlives_all_that_solvers_do_in_it(scene, mark):
    """Each is a row with a name, and what it has left disturbs neither the next scene nor the end."""
    used = set()
    for target, outcome, said in TABLES["survived"]:
        row = row_of(scene.with_values({"title": target}), "named:Named")
        assert told(row, Outcome(outcome), said), (target, row.outcome, row.notes)
        used.update(worker.workers.values())
    assert len(used) == 1, "the processes that have answered"
    worker.close_all()
    assert left(mark) == []


@pytest.fixture
def at_once(scene, monkeypatch):
    """Start workers that know no scenes, and wait shortly for those that have closed their output."""
    monkeypatch.setattr(UserSolver, "command", lambda self: [sys.executable, str(HERE / "bare.py"), self.target])
    monkeypatch.setenv("PYTHONPATH", os.pathsep.join([str(HERE), *sys.path]))
    monkeypatch.setattr(worker, "EXIT_TIMEOUT", 0.1)


@pytest.mark.usefixtures("at_once")
@pytest.mark.parametrize(("target", "outcome", "said"), thinned(FATAL, 4))
def test_what_a_process_does_not_outlive_is_a_row_with_a_name(scene, mark, target, outcome, said, monkeypatch):
    assert UserSolver(target, target).about() == {}, "the process has started"
    monkeypatch.setenv(VARIABLE, "0.05" if outcome == "timeout" else "60")
    row = row_of(scene, target)
    assert told(row, Outcome(outcome), said), (row.outcome, row.notes)
    worker.close_all()
    assert left(mark) == []


def test_a_scene_that_nobody_reads_defeats_no_time_limit(scene):
    """More than a pipe holds: the solver's process has stopped, and nobody takes the request."""
    blind = [sys.executable, "-c", "import time; time.sleep(60)"]
    with pytest.raises(worker.WorkerHangs, match=r"0\.2 s"):
        worker.ask(blind, os.environ, {"much": "x" * 1_000_000}, 0.2)


def test_a_command_that_is_not_there_is_named():
    with pytest.raises(worker.WorkerDied, match="/no/such"):
        worker.ask(["/no/such"], os.environ, {}, 10.0)
