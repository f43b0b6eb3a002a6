"""One BLAS thread in every process of ours and in every calculation, and nobody's settings touched beside."""

import logging
import os
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
import scipy.linalg  # noqa: F401 - so that both libraries are loaded
from threadpoolctl import threadpool_info, threadpool_limits

from validation.engine.case import Case
from validation.engine.measure import execute
from validation.runs.history import History
from validation.runs.run import Outcome, Run
from validation.runs.threads import ONE_THREAD, VARIABLES, limit_process
from validation.scenes.scene import load_scene
from validation.solvers.contract import Solver
from validation.solvers.logs import errors_only, solver_logs
from validation.solvers.registry import solve

MANY = 3  # threads of this process, whatever the machine has


def threads():
    """Return the numbers of threads of the BLAS libraries of this process that are numpy's and scipy's."""
    return {info["num_threads"] for info in threadpool_info() if info["user_api"] == "blas" and is_ours(info)}


def is_ours(info):
    """Whether a library came with numpy or scipy, or from the system: programs under test bring others of their own."""
    folder = Path(info["filepath"]).parent.name
    return not folder.endswith(".libs") or folder in ("numpy.libs", "scipy.libs")


@pytest.fixture
def many_threads(monkeypatch):
    """Let this process be one in which nobody has decided, with some threads."""
    for name in VARIABLES:
        monkeypatch.delenv(name, raising=False)
    with threadpool_limits(MANY, user_api="blas"):
        yield
    assert not set(VARIABLES) & set(os.environ)


class Looking(Solver):
    """A solver that notes how many threads it sees."""

    name = "looking"
    sources = ("validation.runs",)

    def __init__(self):
        self.seen = []

    def solve(self, scene, full=False, fields=None):
        self.seen.append(threads())
        time = scene.time.step * np.arange(1.0, scene.time.steps + 1)
        return Run(Outcome.COMPLETED, History(time, dict.fromkeys(scene.run.columns, 0 * time)))


def block():
    """Return a scene of one block."""
    return load_scene("figures-3-4").expand()[0].with_values({"time.steps": 5})


def test_solve_from_python_takes_one_thread_and_leaves_the_others_as_they_were(many_threads):
    looking = Looking()
    assert solve(block(), looking).outcome is Outcome.COMPLETED
    assert looking.seen == [{1}]
    assert threads() == {MANY}


def test_a_case_of_a_study_takes_one_thread_wherever_it_runs(many_threads, monkeypatch):
    """A gate of the pytest plug-in and a case on a Dask worker are executed so."""
    looking = Looking()
    monkeypatch.setattr(Case, "make_solver", lambda case: looking)
    execute(Case(block(), "looking", ("history",)), "key", "study")
    assert looking.seen == [{1}]
    assert threads() == {MANY}


def test_a_process_of_ours_is_limited_for_good_unless_the_user_decides(many_threads, monkeypatch):
    monkeypatch.setenv("MKL_NUM_THREADS", "2")
    limit_process()
    assert threads() == {MANY} and "OMP_NUM_THREADS" not in os.environ
    monkeypatch.delenv("MKL_NUM_THREADS")
    with monkeypatch.context() as patch:
        for name in ONE_THREAD:
            patch.setenv(name, "")
        limit_process()
        assert threads() == {1} and {os.environ[name] for name in ONE_THREAD} == {"1"}


def test_errors_alone_are_logged_for_the_time_that_is_asked_for():
    before = log_levels()
    with pytest.raises(KeyboardInterrupt), errors_only():
        assert log_levels() == [logging.ERROR] * 2
        raise KeyboardInterrupt
    assert log_levels() == before != [logging.ERROR] * 2


def log_levels():
    """Return from which level on a worker shows what our solvers log."""
    return [log.level for log in solver_logs()]


def run_python(code, **environment):
    """Run code in a process in which nobody has decided."""
    kept = {name: value for name, value in os.environ.items() if name not in VARIABLES}
    done = subprocess.run(
        [sys.executable, "-c", code], capture_output=True, text=True, env=kept | environment, timeout=120
    )
    assert done.returncode == 0, done.stderr
    return done.stdout.splitlines()[-1]


TYPED = """
import os, sys
sys.argv = ["dda-validate", "list", "studies"]
from validation.__main__ import main
try:
    main()
except SystemExit:
    pass
import numpy, scipy.linalg
from threadpoolctl import threadpool_info
print({info["num_threads"] for info in threadpool_info()}, os.environ.get("OMP_NUM_THREADS"))
"""


@pytest.mark.long
def test_a_command_has_one_thread_as_typed():
    assert run_python(TYPED) == "{1} 1"


@pytest.mark.long
def test_a_command_has_as_many_as_the_user_says():
    assert run_python(TYPED, OMP_NUM_THREADS="2") == "{2} 2"


@pytest.mark.long
def test_the_package_dda_touches_nothing():
    code = "import os; before = dict(os.environ); import dda, validation; print(dict(os.environ) == before)"
    assert run_python(code) == "True"
