"""The command line as a user types it: exit status, one line for bad input, nothing half-written."""

import subprocess
import sys

import pytest
from conftest import refused, typed


def test_verdicts_that_are_no_text_are_told_as_such(tmp_path):
    (tmp_path / "verdicts.json").write_bytes(b"\xff\xfe")
    assert refused("diff", tmp_path, tmp_path).startswith(f"error: {tmp_path / 'verdicts.json'}: ")


def test_springs_that_no_mode_can_have_are_named_by_an_alarm_not_by_a_warning(scene_file, tmp_path):
    done = typed(
        "run",
        scene_file,
        "--set",
        "contact.stiffness=1e308",
        "--set",
        "time.steps=5",
        "--set",
        'run.solvers=["dda","bar"]',
        "--results",
        tmp_path / "results",
    )
    assert "small" in done.stdout and "FloatingPointError" in done.stdout
    assert "RuntimeWarning" not in done.stderr


INTERRUPTED = (130, "", "interrupted\n")


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


def test_an_end_of_a_file_is_no_interruption(monkeypatch):
    def torn(*arguments):
        raise EOFError("marshal data too short")

    monkeypatch.setattr("validation.suite.folders.get_study", torn)
    with pytest.raises(EOFError):
        typed("list", "studies")
