"""Users' solvers that do whatever a program can do wrong: named outcomes, in time, and nothing left of them."""

from __future__ import annotations

import os
import subprocess
import sys
import time
from collections.abc import Iterator
from pathlib import Path

import pytest
from conftest import SCENE, thinned
from oracles.processes import MARK, left, new_mark

from validation.engine.case import Case
from validation.engine.measure import execute
from validation.runs.results import Results
from validation.runs.row import Row
from validation.runs.run import Outcome
from validation.scenes.scene import Scene, load_scene
from validation.solvers.processes import worker
from validation.solvers.user import VARIABLE, words

HERE = Path(__file__).parent / "user_solvers"
MANY = (
    "forks leaves_a_thread leaves_an_exit_hook leaves_a_daemon prints ignores_signals kills_its_guard kills_its_group "
    "closes_everything interrupts raises_half_a_character odd_names SubnormalStatic sound"
)
HUNG = "no history within 1.75 s, the time limit for 50 steps"
needs_linux = pytest.mark.skipif(not Path("/proc/self/fd").exists(), reason="the solver finds its pipes in /proc")


@pytest.fixture
def mark(monkeypatch: pytest.MonkeyPatch) -> Iterator[str]:
    with new_mark() as name:
        monkeypatch.setenv(MARK, name)
        yield name


@pytest.fixture
def scene(scene_file: Path, monkeypatch: pytest.MonkeyPatch) -> Scene:
    monkeypatch.syspath_prepend(str(HERE))
    return load_scene(scene_file)


def row_of(scene: Scene, attribute: str) -> Row:
    """Return the row of a case, and see that it can be written and read again."""
    row, _ = execute(Case(scene, f"hostile:{attribute}"), "key", "study")
    again = Row.parse(row.line())
    assert again is not None and again.outcome is row.outcome
    "; ".join(row.notes).encode("utf-8")
    return row


CASES = [
    ("forks", Outcome.COMPLETED, ""),
    ("forks_and_stays", Outcome.COMPLETED, ""),
    ("leaves_a_thread", Outcome.COMPLETED, ""),
    ("leaves_an_exit_hook", Outcome.COMPLETED, ""),
    ("leaves_a_daemon", Outcome.COMPLETED, ""),
    ("exits_in_a_thread", Outcome.COMPLETED, ""),
    ("prints", Outcome.COMPLETED, ""),
    ("prints_without_end", Outcome.COMPLETED, ""),
    ("changes_directory", Outcome.COMPLETED, ""),
    ("collects_itself", Outcome.COMPLETED, ""),
    pytest.param("writes_half_a_line", Outcome.TIMEOUT, HUNG, marks=needs_linux),
    pytest.param("drips", Outcome.TIMEOUT, HUNG, marks=needs_linux),
    pytest.param("writes_garbage", Outcome.RAISED, "crashed: no answer but", marks=needs_linux),
    pytest.param("writes_a_list", Outcome.RAISED, "crashed: no answer but '[1, 2]'", marks=needs_linux),
    pytest.param("answers_another_request", Outcome.COMPLETED, "", marks=needs_linux),
    ("closes_everything", Outcome.RAISED, "crashed: the process ended with status"),
    ("closes_and_sleeps", Outcome.RAISED, "crashed: the process ended with status 137"),
    ("sleeps", Outcome.TIMEOUT, HUNG),
    ("spins", Outcome.TIMEOUT, HUNG),
    ("ignores_signals", Outcome.TIMEOUT, HUNG),
    ("stops_itself", Outcome.TIMEOUT, HUNG),
    ("stops_its_guard", Outcome.TIMEOUT, HUNG),
    ("kills_its_guard", Outcome.RAISED, "crashed: the process ended with status -9"),
    ("terminates_its_guard", Outcome.RAISED, "crashed: the process ended with status 137"),
    ("kills_its_group", Outcome.RAISED, "crashed: the process ended with status 137"),
    ("kills_itself", Outcome.RAISED, "crashed: the process ended with status 137"),
    ("interrupts", Outcome.RAISED, "KeyboardInterrupt"),
    ("ends_a_generator", Outcome.RAISED, "GeneratorExit: no more"),
    ("raises_what_has_no_text", Outcome.RAISED, "Nameless, whose text raises RuntimeError"),
    ("raises_half_a_character", Outcome.RAISED, r"half \udc80 of \ud800 a character, \x1b[31mred"),
    ("raises_a_book", Outcome.RAISED, "ValueError: xxx"),
    ("recurses", Outcome.RAISED, "RecursionError: "),
    ("wants_memory", Outcome.RAISED, "Unable to allocate"),
    ("not_a_number", Outcome.NOT_A_NUMBER, "displacement at step 1"),
    ("infinite", Outcome.OVERFLOW, "displacement at step 1"),
    ("texts", Outcome.RAISED, "TypeError: displacement must hold real numbers, got an array of <U5"),
    ("complex_numbers", Outcome.RAISED, "TypeError: displacement must hold real numbers, got an array of complex128"),
    ("dates", Outcome.RAISED, "TypeError: displacement must hold real numbers, got an array of datetime64"),
    ("nothing_in_it", Outcome.NOT_A_NUMBER, "displacement at step 1"),
    ("scalar", Outcome.WRONG_SHAPE, "displacement has shape (), not (50,)"),
    ("square", Outcome.WRONG_SHAPE, "displacement has shape (50, 50), not (50,)"),
    ("ragged", Outcome.RAISED, "ValueError: setting an array element with a sequence"),
    ("odd_names", Outcome.COMPLETED, ""),
    ("names_of_half_characters", Outcome.WRONG_SHAPE, r"no column displacement, got \udc80"),
    ("Static", Outcome.COMPLETED, ""),
    ("SubnormalStatic", Outcome.COMPLETED, "static: must be zero or a normal number, got -1e-320 for displacement"),
    ("LeastStatic", Outcome.COMPLETED, ""),
    ("UndefinedStatic", Outcome.COMPLETED, "static: must be zero or a normal number, got nan for displacement"),
    ("TextStatic", Outcome.RAISED, "could not convert string to float"),
    ("OddModes", Outcome.COMPLETED, ""),
]


@pytest.mark.parametrize(("attribute", "outcome", "said"), thinned(CASES, 3))
def test_a_hostile_solver_is_a_row_with_a_name(
    scene: Scene, mark: str, attribute: str, outcome: Outcome, said: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv(VARIABLE, "1.5" if outcome is Outcome.TIMEOUT else "60")
    row = row_of(scene, attribute)
    assert row.outcome is outcome, row.notes
    assert said in "; ".join(row.notes)
    assert sum(map(len, row.notes)) < 1000
    if outcome is Outcome.COMPLETED:
        assert row_of(scene, attribute).outcome is outcome, "what it has left does not disturb the next scene"
    worker.close_all()
    assert left(mark) == []


@pytest.mark.parametrize("attribute", thinned(["forks_and_stays", "forks"], 2))
def test_a_fork_of_a_solver_answers_no_later_scene(scene: Scene, attribute: str) -> None:
    for _ in range(4):
        assert row_of(scene, attribute).metrics["displacement.final"] == -1e-3
        time.sleep(0.2)


def test_a_scene_that_nobody_reads_defeats_no_time_limit(scene: Scene) -> None:
    """More than a pipe holds: the solver's process has stopped, and nobody takes the request."""
    blind = [sys.executable, "-c", "import time; time.sleep(60)"]
    with pytest.raises(worker.WorkerHangs, match="no answer within 1 s"):
        worker.ask(blind, os.environ, {"much": "x" * 10_000_000}, 1.0)


def test_an_answer_without_end_is_ended(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(worker, "LONGEST", 100_000)
    endless = [sys.executable, "-c", "import sys\nwhile True: sys.stdout.write('x' * 1000)"]
    with pytest.raises(worker.WorkerDied, match="its answer is longer than 100000 bytes"):
        worker.ask(endless, os.environ, {}, 30.0)


def test_a_command_that_is_not_there_is_named() -> None:
    with pytest.raises(worker.WorkerDied, match=r"status 127: /no/such: No such file or directory"):
        worker.ask(["/no/such"], os.environ, {}, 10.0)


def test_what_a_solver_says_fits_a_line() -> None:
    assert words("a\n b\tc") == "a b c"
    assert words("x" * 500) == "x" * 400 + " ..."
    assert words("\udc80\x00\x1b") == r"\udc80\x00\x1b"
    assert words("Spannung in N/mm², σ") == "Spannung in N/mm², σ"


@pytest.mark.long
def test_a_study_of_hostile_solvers_ends_with_every_row(mark: str, tmp_path: Path) -> None:
    """Through the command line, on two workers: every case a row, no traceback."""
    names = MANY.split()
    path = tmp_path / "all.toml"
    solvers = ", ".join(f'"hostile:{name}"' for name in names)
    path.write_text(SCENE + f"[run]\nsolvers = [{solvers}]\n")
    done = subprocess.run(
        [sys.executable, "-m", "validation", "run", str(path), "--results", str(tmp_path / "r"), "--jobs", "2"],
        capture_output=True,
        timeout=280,
        cwd=HERE,
        env=os.environ | {VARIABLE: "3", "PYTHONPATH": os.pathsep.join([str(HERE), *sys.path])},
    )
    assert b"Traceback" not in done.stderr + done.stdout, done.stderr.decode(errors="replace")
    rows = Results(tmp_path / "r").rows().values()
    assert sorted(row.solver for row in rows) == sorted(f"hostile:{name}" for name in names)
    assert left(mark) == []
