"""Shared fixtures: a small scene as text, as a file, and the command line as a process; which tests go together."""

import copy
import gc
import importlib
import importlib.util
import io
import os
import re
import signal
import subprocess
import sys
import tomllib
from collections.abc import Iterable, Iterator, Mapping, Sequence
from contextlib import redirect_stderr, redirect_stdout, suppress
from importlib.machinery import SourceFileLoader
from pathlib import Path
from types import ModuleType
from typing import Any

import pytest

os.environ.setdefault("OMP_NUM_THREADS", "1")  # small matrices: a second thread of BLAS only waits, and counts as work
# Our packages assert nothing: pytest would rewrite them, and plain Python compile them once more.
if rewriting := [finder for finder in sys.meta_path if hasattr(finder, "_must_rewrite")]:
    rewriting[0]._must_rewrite -= {"dda", "fem_reference", "validation"}

from validation.runs.results import Results
from validation.scenes.scene import Scene, load_scene, parse_scene

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
TOGETHER = (  # modules whose tests share what takes long to make
    "test_across",
    "test_calibration",
    "test_changes",
    "test_claims",
    "test_compare",
    "test_compare_words",
    "test_confusion",
    "test_contact_pack",
    "test_hostile_text",
    "test_in_browser",
    "test_invariants",
    "test_judge",
    "test_kept_numbers",
    "test_literature",
    "test_other_versions",
    "test_own_solver",
    "test_pack",
    "test_readable",
    "test_report",
    "test_rotation_orders",
    "test_rotation_solver",
    "test_scheme_verdicts",
    "test_site",
    "test_site_program",
    "test_slipping_pack",
    "test_sweeps",
    "test_submissions",
    "test_user_solvers",
    "test_walls",
    "test_work_precision",
)


GATE = "test_gate["  # with which the names of gates begin

# Of a scene those gates are short whose cases together have every value of each axis and every kind of gate; of these
# scenes, whose axes change together or whose cases take long, the gates of the named cases.
SHORT_CASES = {
    "two-codes-constant": ("block.poisson=0,block.hypothesis=plane stress,time.start=zero",),
    "two-codes-average": ("block.poisson=0.25,block.hypothesis=plane strain,time.start=consistent",),
    "subblocks-axial": ("block.pattern=triangles,block.subdivide=4x4",),
    "subblocks-rocking": ("block.pattern=triangles,block.subdivide=4x4",),
    "stiff-contact": (
        "time.alpha=0.5,contact.stiffness=1e+10",
        "time.alpha=0.5,contact.stiffness=1e+16",
        "time.alpha=0.5625,contact.stiffness=1e+13",
    ),
    "corner-springs": ("fem.elements=4", "fem.elements=32"),
    "rocking-release": ("block.height=4",),
    "rocking-swing": ("block.height=2,block.tilt=22.5",),
    "rocking-pulse": ("block.width=1.1128737204581363", "block.width=0.9945715989724925"),
    "slope-base": ("contact.stiffness=1e+10,contact.shear_stiffness=4e+09",),
    "unlocked": ("contact.stiffness=1e+08", "contact.stiffness=1e+11"),
    "unlocked-ledger": ("contact.stiffness=1e+09", "contact.stiffness=1e+11"),
    "impact": ("contact.stiffness=1e+08", "contact.stiffness=1e+11", "contact.stiffness=1e+21"),
    "bouncing-bar": ("contact.stiffness=450", "contact.stiffness=450000"),
}


# Long are scenes of seconds (an exact motion of a shaken slope, mesh against sub-blocks, the record of work, which has
# tests of its own, columns of many switches), other numbers of a family whose first ones are short (joints, schemes),
# and a second process of the distributed solver.
LONG_GATES = re.compile(
    r"(slope-quake-exact|subblocks-locking|work-precision|unlocked-constant|methods-cost|methods-rigid-impulses-euler"
    r"|columns-(slips|spall|spall-bars|shaken)|columns-joint-0\.(1|5|75|9)"
    r"|methods-\w+-(ch-0|ch-0\.8|bathe-half|bathe-0\.5|implicit-euler|nine-sixteenths))(?=[:\[])"
    r"|.*:fenicsx:2-"
)


def short_gates(names: Sequence[str]) -> set[str]:
    """Return the gates of the short tests among those of these ids: some cases of each scene."""
    names = [name for name in names if not LONG_GATES.match(name)]
    cases: dict[str, dict[str, set[str]]] = {}
    for name in names:
        scene, values, kind = parts_of(name)
        cases.setdefault(scene, {}).setdefault(values, {*values.split(",")}).add(kind)
    short = {scene: {"", *(SHORT_CASES.get(scene) or _covering(marks))} for scene, marks in cases.items()}
    return {name for name in names if parts_of(name)[1] in short[parts_of(name)[0]]}


def parts_of(name: str) -> tuple[str, str, str]:
    """Return the scene of a gate's id, the values of its case, and what it asks for of which solvers."""
    scene, values, kind = re.fullmatch(r"([^\[:]+)(?:\[([^\]]*)\])?:(.+)", name).groups(default="")
    return scene, values, re.sub(r"\(.*?\)", "", kind)  # a case that it is held against is named in brackets


def _covering(marks: Mapping[str, set[str]]) -> list[str]:
    """Return few cases that have all marks of any, the one with the most new ones first."""
    left, found = set().union(*marks.values()), []
    while left:
        found.append(max(marks, key=lambda case: len(marks[case] & left)))
        left -= marks[found[-1]]
    return found


def group_of(nodeid: str) -> str:
    """Name the group of a test: its module where tests share, the scene of a gate, otherwise the test itself.

    Tests that run FEniCSx are one group, since each worker of the tests would start a process of it.
    """
    path, _, name = nodeid.partition("::")
    if "fenicsx" in nodeid:
        return "fenicsx"
    if name.startswith(GATE):
        return re.split(r"[\[:]", name.removeprefix(GATE))[0]
    return path if Path(path).stem in TOGETHER else nodeid


@pytest.hookimpl(optionalhook=True)
def pytest_xdist_make_scheduler(config: pytest.Config, log: object) -> object:
    """Keep groups on one worker, the largest first; marks do not reach pytest-xdist from pytest 9.2 on.

    Single tests come last, in the order of collection, so that no worker waits for the other's last group.
    """
    if config.getvalue("dist") != "loadgroup":
        return None
    from xdist.scheduler import LoadScopeScheduling

    class Groups(LoadScopeScheduling):
        def _split_scope(self, nodeid: str) -> str:
            return group_of(nodeid)

        def _assign_work_unit(self, node: object) -> None:
            """Forget finished groups: after each test pytest-xdist counts what is pending in all of them."""
            assigned = self.assigned_work[node]
            self.assigned_work[node] = {name: tests for name, tests in assigned.items() if not all(tests.values())}
            super()._assign_work_unit(node)

    return Groups(config, log)


def pytest_collection(session: pytest.Session) -> None:
    """Import the test modules from the last one on in every second worker, where all tests are collected.

    In a fresh clone the assertions of all test modules are rewritten, which takes longer than to collect them. Workers
    that begin at both ends of the list do half of it each and read the rest from the files that the other has written.
    """
    config = session.config
    worker = getattr(config, "workerinput", {}).get("workerid", "gw0")
    if int(worker.removeprefix("gw")) % 2 and [Path(path).name for path in config.args] == config.getini("testpaths"):
        for path in sorted((config.rootpath / "tests").rglob("test_*.py"), reverse=True):
            if (path.parent / "conftest.py").exists():
                continue  # which says from where its modules import, and is read where they are collected
            with suppress(Exception, pytest.skip.Exception):  # told where the module is collected
                importlib.import_module(".".join(path.relative_to(config.rootpath).with_suffix("").parts))


@pytest.hookimpl(wrapper=True, specname="pytest_collection")
def pytest_rest_while_collecting() -> Iterator[None]:
    """Let the garbage collector rest until all is collected, and leave that alone later.

    What is imported and collected stays to the end; to look through it takes as long as to collect it.
    """
    gc.disable()
    try:
        return (yield)
    finally:
        gc.freeze()
        gc.enable()


@pytest.hookimpl(tryfirst=True)
def pytest_collection_modifyitems(items: list[pytest.Item]) -> None:
    """Mark the gates of all but a few cases as long, and let Hypothesis draw without the constants of our sources."""
    gates = {item.name.removeprefix(GATE).removesuffix("]"): item for item in items if item.name.startswith(GATE)}
    for name in gates.keys() - short_gates([*gates]):
        gates[name].add_marker(pytest.mark.long)
    _draw_without_constants()


def _draw_without_constants() -> None:
    """Let Hypothesis draw without the constants of our sources.

    They would make the examples depend on which modules a process has imported, and on any edit, for the time of
    parsing every source.
    """
    providers: Any = sys.modules.get("hypothesis.internal.conjecture.providers")
    if hasattr(providers, "is_local_module_file"):  # not in its older versions, which draw no such constants
        providers.is_local_module_file = lambda path: False


def pytest_runtest_setup(item: pytest.Item) -> None:
    """Skip what needs FEniCSx by name where there is none, which is asked when the first such test is reached."""
    if item.get_closest_marker("fenicsx"):
        from validation.solvers.fenicsx import INSTALL_HINT, interpreter

        if interpreter() is None:
            pytest.skip(f"fenicsx is NOT RUN: {INSTALL_HINT}")


def thinned(cases: Iterable[object], every: int) -> list[object]:
    """Mark all but every n-th case as long.

    Of a product of axes all values stay in the short tests if there are that many cases and n is prime to the
    lengths of the axes.
    """
    listed = list(cases)
    cases = [case if isinstance(case, type(pytest.param())) else pytest.param(*_parts(case)) for case in listed]
    long = [[] if i % every == 0 else [pytest.mark.long] for i in range(len(listed))]
    return [pytest.param(*case.values, marks=[*case.marks, *more]) for case, more in zip(cases, long, strict=True)]


def _parts(case: object) -> tuple[object, ...]:
    return case if isinstance(case, tuple) else (case,)


def beside(finished_cases: Path, directory: Path) -> Results:
    """Return a results directory of its own studies and verdicts, whose finished cases are those of all tests."""
    (finished_cases / "histories").mkdir(parents=True, exist_ok=True)
    (finished_cases / "rows.jsonl").touch()
    directory.mkdir(exist_ok=True)
    for name in ("histories", "rows.jsonl"):
        if not (directory / name).is_symlink():
            (directory / name).symlink_to(finished_cases / name)
    return Results(directory)


@pytest.fixture
def interruptible() -> Iterator[None]:
    """Let signals reach the processes that a test starts.

    They inherit that a job in the background ignores SIGINT, and SIGHUP under nohup.
    """
    interrupt = signal.signal(signal.SIGINT, signal.default_int_handler)
    hangup = signal.signal(signal.SIGHUP, signal.SIG_DFL)
    yield
    signal.signal(signal.SIGINT, interrupt)
    signal.signal(signal.SIGHUP, hangup)


@pytest.fixture
def scene_file(tmp_path: Path) -> Path:
    path = tmp_path / "small.toml"
    path.write_text(SCENE)
    return path


@pytest.fixture
def scene(scene_file: Path) -> Scene:
    return load_scene(scene_file)


def scene_of(**changes: object) -> Scene:
    """Return the small scene with other values, each named by its section, two underscores and its key."""
    data = copy.deepcopy(tomllib.loads(SCENE))
    for name, value in changes.items():
        section, _, key = name.partition("__")
        data.setdefault(section, {})[key] = value
    return parse_scene(data, "x.toml")


def script(name: str, monkeypatch: pytest.MonkeyPatch) -> ModuleType:
    """Load a script of `.ci`, whose name has no suffix, as a module."""
    monkeypatch.setattr(sys, "dont_write_bytecode", True)
    path = Path(__file__).parents[1] / ".ci" / name
    spec = importlib.util.spec_from_loader(name, SourceFileLoader(name, str(path)))
    assert spec is not None and spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    monkeypatch.setitem(sys.modules, name, module)  # its dataclasses look themselves up there
    spec.loader.exec_module(module)
    return module


def cli(*arguments: object, cwd: Path | None = None) -> subprocess.CompletedProcess[str]:
    """Run the command line as a user does."""
    return subprocess.run(
        [sys.executable, "-m", "validation", *map(str, arguments)],
        capture_output=True,
        text=True,
        timeout=120,
        cwd=cwd,
        env=os.environ | {"OMP_NUM_THREADS": "1", "COLUMNS": "160"},
    )


def typed(*arguments: object, cwd: Path | None = None) -> subprocess.CompletedProcess[str]:
    """Run the command line in this process, where not the process is the point: no start-up, no workers unasked."""
    from validation.cli import main, run

    said, complained, words = io.StringIO(), io.StringIO(), [str(argument) for argument in arguments]
    with pytest.MonkeyPatch.context() as patch, redirect_stdout(said), redirect_stderr(complained):
        patch.setattr(sys, "argv", ["dda-validate", *words])
        patch.setattr(run, "default_jobs", lambda: 1)
        patch.setenv("COLUMNS", "160")
        patch.chdir(cwd or Path.cwd())
        with pytest.raises(SystemExit) as stopped:
            main()
    status = stopped.value.code
    assert isinstance(status, int)
    return subprocess.CompletedProcess(words, status, said.getvalue(), complained.getvalue())


def refused(*arguments: object, cwd: Path | None = None) -> str:
    """Type what is refused as bad input, by one line and status 2, and return that line."""
    done = typed(*arguments, cwd=cwd)
    assert done.returncode == 2 and len(done.stderr.strip().splitlines()) == 1, done.stderr
    return done.stderr
