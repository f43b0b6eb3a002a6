"""The command line as a user types it: exit status, one line for bad input, nothing half-written."""

import os
import signal
import subprocess
import sys
import time

import pytest
from conftest import SCENE, refused, typed


def test_fields_are_written_for_paraview(scene_file, tmp_path):
    done = typed("solve", scene_file, "--solver", "fem", "--fields", tmp_path / "f.vtu")
    assert done.returncode == 0, done.stderr
    assert (tmp_path / "f.vtu").stat().st_size > 1000


LISTS = {  # refused in more words than a page can hold, or by a path of this machine
    'solve corner-springs --set run.columns=["heat"]': "corner-springs: run.columns: must be among ",
    "run column.toml": "column.toml: run.columns: must be among ",
    "run metric.toml": "metric.toml: gate.0.metric: must be among ",
    "solve corner-springs --set fem.elements=4 --csv no/where.csv": "no/where.csv: cannot be written",
}


@pytest.mark.parametrize("line", LISTS)
def test_what_is_not_among_many_is_refused_by_file_and_field(line, tmp_path):
    gate = '[[gate]]\npair = ["dda"]\nmetric = "heat"\nband = [0, 1]\nreason = "r"'
    (tmp_path / "column.toml").write_text(f'{SCENE}[run]\ncolumns = ["displacement", "heat"]')
    (tmp_path / "metric.toml").write_text(f"{SCENE}{gate}")
    assert refused(*line.split(), cwd=tmp_path).startswith(f"error: {LISTS[line]}")
    assert {path.name for path in tmp_path.iterdir()} == {"column.toml", "metric.toml"}


def test_verdicts_that_are_no_text_are_told_as_such(tmp_path):
    (tmp_path / "verdicts.json").write_bytes(b"\xff\xfe")
    assert "verdicts.json: must be UTF-8 text" in refused("diff", tmp_path, tmp_path)


def test_springs_that_no_mode_can_have_are_named_by_an_alarm_not_by_a_warning(scene_file, tmp_path):
    done = typed("run", scene_file, "--set", "contact.stiffness=1e308", "--results", tmp_path / "results")
    assert "not examined: small: alarms and damping budget: FloatingPointError: divide by zero" in done.stdout
    assert "RuntimeWarning" not in done.stderr


@pytest.mark.long
@pytest.mark.usefixtures("interruptible")
def test_an_interruption_says_that_finished_rows_are_kept(scene_file, tmp_path):
    long = SCENE.replace("steps = 50", "steps = 40000") + '[run]\nsolvers = ["dda-textbook"]\n'
    scene_file.write_text(long + '[sweep]\n"time.gg" = [1.0, 0.9]\n"time.steps" = [10, 1000000]\n')
    command = [sys.executable, "-m", "validation", "run", str(scene_file), "--results", str(tmp_path / "r")]
    with subprocess.Popen(command, stderr=subprocess.PIPE, text=True, start_new_session=True) as process:
        rows = tmp_path / "r" / "rows.jsonl"
        while not rows.exists() and process.poll() is None:
            time.sleep(0.02)
        os.killpg(process.pid, signal.SIGINT)
        _, said = process.communicate(timeout=60)
    assert process.returncode == 130
    assert said.strip() == "interrupted: finished rows are kept; run the same command again to continue"


INTERRUPTED = (130, "", "interrupted\n")
KEPT = (130, "", "interrupted: finished rows are kept; run the same command again to continue\n")


def interrupted(code):
    """Return status and words of a command line that hears Ctrl-C in the middle of what the code makes of it."""
    raised = (
        "import signal, threading, time\nfrom validation.cli import entry, signals\n"
        + code
        + ("\nthreading.Timer(0.2, signal.raise_signal, [signal.SIGINT]).start()\nentry.main()")
    )
    done = subprocess.run([sys.executable, "-c", raised], capture_output=True, text=True, timeout=60)
    return done.returncode, done.stdout, done.stderr


@pytest.mark.usefixtures("interruptible")
def test_an_interruption_is_one_line():
    assert interrupted("entry.command_line = lambda: lambda **options: time.sleep(50)") == INTERRUPTED


@pytest.mark.long
@pytest.mark.usefixtures("interruptible")
def test_an_interruption_promises_rows_where_the_command_keeps_them():
    code = "def slow(**options):\n    signals.promise_rows()\n    time.sleep(50)\nentry.command_line = lambda: slow"
    assert interrupted(code) == KEPT


@pytest.mark.usefixtures("interruptible")
def test_an_interruption_in_a_long_call_is_told_as_well():
    """The main thread is where it hears of no signal: what it would say is said for it, once."""
    deaf = (
        "signals.GRACE_PERIOD = 0.1\ndef deaf(act):\n    while True:\n        try:\n"
        "            threading.Event().wait(1)\n        except KeyboardInterrupt:\n            pass\n"
        "entry._exit_status = deaf"
    )
    assert interrupted(deaf) == INTERRUPTED


def test_an_end_of_a_file_is_no_interruption(monkeypatch):
    def torn(*arguments):
        raise EOFError("marshal data too short")

    monkeypatch.setattr("validation.suite.folders.get_study", torn)
    with pytest.raises(EOFError, match="too short"):
        typed("list")
