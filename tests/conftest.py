"""Shared fixtures: a small scene as text and as a file, the command line as a process; gates are long."""

import copy
import gc
import importlib.util
import io
import os
import signal
import subprocess
import sys
import tomllib
from collections import Counter
from contextlib import redirect_stderr, redirect_stdout
from importlib.machinery import SourceFileLoader
from pathlib import Path

import pytest

os.environ.setdefault("OMP_NUM_THREADS", "1")  # small matrices: a second thread of BLAS only waits, and counts as work

from validation.runs.results import Results
from validation.scenes.scene import load_scene, parse_scene

SCENE = """\
title = "A small scene"

[block]
side = 2.0
density = 2700.0
young = 1.0e9

[contact]
stiffness = 1.0e9

[load]
pressure = 5.0e6

[time]
step = 0.002
steps = 50

[fem]
elements = 4
"""


OVERFLOW = [  # options with which the small scene leaves the range of doubles
    word
    for value in ("time.alpha=0", "time.delta=0.5", "time.step=0.1", "time.steps=2000", "time.allow_unstable=true")
    for word in ("--set", value)
]


@pytest.hookimpl(wrapper=True, specname="pytest_collection")
def pytest_rest_while_collecting():
    """Let the garbage collector rest until all is collected, and leave that alone later.

    What is imported and collected stays to the end; to look through it takes as long as to collect it.
    """
    gc.disable()
    try:
        return (yield)
    finally:
        gc.freeze()
        gc.enable()


# Two workers that begin with these files end together. The gates leave their runs to kill matrices and reports.
LONGEST = ("test_gates", "test_docs", "test_cause", "test_kills", "test_readable", "test_fenicsx", "test_slopes")


def pytest_configure(config):
    """Let pytest-xdist hand files out as they are sorted below, not by the number of their tests."""
    config.option.loadscopereorder = False


@pytest.hookimpl(tryfirst=True)
def pytest_collection_modifyitems(items):
    """Mark all accuracy gates as long, for `studies/test_gates_in_short.py` judges those of first cases; sort files."""
    for item in items:
        if item.get_closest_marker("validation"):
            item.add_marker(pytest.mark.long)
    tests = Counter(item.path for item in items)
    order = {path: ((*LONGEST, path.stem).index(path.stem), -tests[path]) for path in tests}
    items.sort(key=lambda item: order[item.path])


def pytest_collection_finish():
    """Let Hypothesis draw without the constants of our sources, for which it has no setting.

    They would make the examples depend on which modules a process has imported, and on any edit, for the time of
    parsing every source.
    """
    providers = sys.modules.get("hypothesis.internal.conjecture.providers")
    if hasattr(providers, "is_local_module_file"):  # not in its older versions, which draw no such constants
        providers.is_local_module_file = lambda path: False


def pytest_runtest_setup(item):
    """Skip what needs FEniCSx by name where there is none, which is asked when the first such test is reached."""
    if item.get_closest_marker("fenicsx"):
        from validation.solvers.fenicsx import INSTALL_HINT, interpreter

        if interpreter() is None:
            pytest.skip(f"fenicsx is NOT RUN: {INSTALL_HINT}")


@pytest.fixture(autouse=True)
def plain_python(request, monkeypatch):
    """Keep short tests from compiling, which takes longer than all of them; plain functions give the same numbers."""
    if not request.node.get_closest_marker("long"):
        monkeypatch.setattr("dda.march.compiled.SHORT", sys.maxsize)


def thinned(cases, every):
    """Mark all but every n-th case as long.

    Of a product of axes all values stay in the short tests if there are that many cases and n is prime to the
    lengths of the axes.
    """
    listed = list(cases)
    cases = [case if isinstance(case, type(pytest.param())) else pytest.param(*_parts(case)) for case in listed]
    long = [[] if i % every == 0 else [pytest.mark.long] for i in range(len(listed))]
    return [pytest.param(*case.values, marks=[*case.marks, *more]) for case, more in zip(cases, long, strict=True)]


def _parts(case):
    return case if isinstance(case, tuple) else (case,)


def beside(finished_cases, directory):
    """Return a results directory of its own studies and verdicts, whose finished cases are those of all tests."""
    (finished_cases / "histories").mkdir(parents=True, exist_ok=True)
    (finished_cases / "rows.jsonl").touch()
    directory.mkdir(exist_ok=True)
    for name in ("histories", "rows.jsonl"):
        if not (directory / name).is_symlink():
            (directory / name).symlink_to(finished_cases / name)
    return Results(directory)


@pytest.fixture
def interruptible():
    """Let signals reach the processes that a test starts.

    They inherit that a job in the background ignores SIGINT, and SIGHUP under nohup.
    """
    interrupt = signal.signal(signal.SIGINT, signal.default_int_handler)
    hangup = signal.signal(signal.SIGHUP, signal.SIG_DFL)
    yield
    signal.signal(signal.SIGINT, interrupt)
    signal.signal(signal.SIGHUP, hangup)


@pytest.fixture
def scene_file(tmp_path):
    path = tmp_path / "small.toml"
    path.write_text(SCENE)
    return path


@pytest.fixture
def scene(scene_file):
    return load_scene(scene_file)


def scene_of(**changes):
    """Return the small scene with other values, each named by its section, two underscores and its key."""
    data = copy.deepcopy(tomllib.loads(SCENE))
    for name, value in changes.items():
        section, _, key = name.partition("__")
        data.setdefault(section, {})[key] = value
    return parse_scene(data, "x.toml")


def script(name, monkeypatch):
    """Load a script of `.ci`, whose name has no suffix, as a module."""
    monkeypatch.setattr(sys, "dont_write_bytecode", True)
    path = Path(__file__).parents[1] / ".ci" / name
    spec = importlib.util.spec_from_loader(name, SourceFileLoader(name, str(path)))
    assert spec is not None and spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    monkeypatch.setitem(sys.modules, name, module)  # its dataclasses look themselves up there
    spec.loader.exec_module(module)
    return module


def cli(*arguments, cwd=None):
    """Run the command line as a user does."""
    return subprocess.run(
        [sys.executable, "-m", "validation", *map(str, arguments)],
        capture_output=True,
        text=True,
        timeout=120,
        cwd=cwd,
        env=os.environ | {"OMP_NUM_THREADS": "1", "COLUMNS": "160"},
    )


def typed(*arguments, cwd=None):
    """Run the command line in this process, where not the process is the point: no start-up, no workers unasked."""
    from validation.cli import main, run

    said, complained, words = io.StringIO(), io.StringIO(), [str(argument) for argument in arguments]
    with pytest.MonkeyPatch.context() as patch, redirect_stdout(said), redirect_stderr(complained):
        patch.setattr(sys, "argv", ["dda-validate", *words])
        patch.setattr(run, "default_jobs", lambda: 1)
        patch.setattr("validation.advice.budget.POINTS", 5)  # of a curve that no command prints
        patch.setenv("COLUMNS", "160")
        patch.chdir(cwd or Path.cwd())
        with pytest.raises(SystemExit) as stopped:
            main()
    status = stopped.value.code
    assert isinstance(status, int)
    return subprocess.CompletedProcess(words, status, said.getvalue(), complained.getvalue())


def refused(*arguments, cwd=None):
    """Type what is refused as bad input, by one line and status 2, and return that line."""
    done = typed(*arguments, cwd=cwd)
    assert done.returncode == 2 and len(done.stderr.strip().splitlines()) == 1, done.stderr
    return done.stderr
