"""After any end of the parent nothing of it runs two seconds later: no worker, no user's solver, nothing it started."""

import os
import signal
import subprocess
import sys
import time
from pathlib import Path

import pytest
from conftest import SCENE
from oracles.processes import MARK, left, marked, new_mark

from validation.runs.results import Results

SOLVERS = """
import atexit, os, signal, subprocess, sys, threading, time

def endless(scene):
    while True:
        time.sleep(0.01)

def with_a_child(scene):
    subprocess.run([sys.executable, "-c", "import time; time.sleep(600)"])

def deaf(scene):
    for number in (signal.SIGTERM, signal.SIGHUP, signal.SIGINT):
        signal.signal(number, signal.SIG_IGN)
    endless(scene)

def sound(scene):
    return {"displacement": [-1e-3] * scene.time.steps}

def with_a_thread(scene):
    threading.Thread(target=endless, args=(scene,)).start()
    return sound(scene)

def with_an_exit_hook(scene):
    atexit.register(endless, scene)
    return sound(scene)

def with_a_child_left(scene):
    subprocess.Popen([sys.executable, "-c", "import time; time.sleep(600)"])
    return sound(scene)
"""
needs_proc = pytest.mark.skipif(not Path("/proc/self/environ").exists(), reason="finds processes in /proc")
pytestmark = [needs_proc, pytest.mark.usefixtures("interruptible")]


@pytest.fixture
def mark():
    with new_mark() as name:
        yield name


def begin(directory, mark, solvers, *options, sweep="[1.0]"):
    """Start a run of a scene, with these discounts, by the named solvers of the module above."""
    (directory / "bad_solvers.py").write_text(SOLVERS)
    scene = directory / "long.toml"
    scene.write_text(SCENE + f'[run]\nsolvers = [{solvers}]\n[sweep]\n"time.gg" = {sweep}\n')
    command = [sys.executable, "-m", "validation", "run", str(scene), "--results", str(directory / "r"), *options]
    places = [str(directory), *filter(None, [os.environ.get("PYTHONPATH")])]
    return subprocess.Popen(
        command,
        cwd=directory,
        env=os.environ | {MARK: mark, "OMP_NUM_THREADS": "1", "PYTHONPATH": os.pathsep.join(places)},
        stdout=subprocess.DEVNULL,
        stderr=subprocess.PIPE,
        text=True,
        start_new_session=True,
    )


def wait_for(mark, words, process):
    """Wait until a process with these words in its command line has been there for a moment."""
    deadline = time.monotonic() + 60
    while process.poll() is None and time.monotonic() < deadline:
        if any(words in line for line in marked(mark).values()):
            time.sleep(0.3)
            return
        time.sleep(0.05)
    raise AssertionError(f"no process with {words!r}: {marked(mark)}")


SIGNALS = [signal.SIGTERM, signal.SIGINT, signal.SIGHUP, signal.SIGKILL]


LEAVERS = [("with_a_child", "sleep(600)"), ("deaf", "user_worker")]  # and what shows that one has begun


@pytest.mark.long
@pytest.mark.parametrize(("number", "leaver"), list(zip(SIGNALS, 2 * LEAVERS, strict=True)))
def test_nothing_outlives_the_parent(number, leaver, tmp_path, mark):
    """The signal goes to the parent alone, as from a scheduler or an out-of-memory killer."""
    solver, words = leaver
    with begin(tmp_path, mark, f'"dda", "bad_solvers:{solver}"', "--jobs", "2") as process:
        wait_for(mark, words, process)
        process.send_signal(number)
        _, said = process.communicate(timeout=30)
    assert left(mark) == []
    assert "Traceback" not in said
    assert process.returncode == (-9 if number == signal.SIGKILL else 128 + number)
    if number != signal.SIGKILL:
        assert said.startswith("interrupted: ") and said.count("\n") == 1


@pytest.mark.long
@pytest.mark.parametrize("solver", ["with_an_exit_hook", "with_a_thread", "with_a_child_left"])
def test_what_a_solver_leaves_behind_ends_with_the_run(solver, tmp_path, mark):
    with begin(tmp_path, mark, f'"bad_solvers:{solver}"', "--jobs", "2", sweep="[1.0, 0.99]") as process:
        process.communicate(timeout=60)
    assert left(mark) == []
    assert {str(row.outcome) for row in Results(tmp_path / "r").rows().values()} == {"completed"}
