"""The entry point: no traceback and no warning for numbers out of range, the version, and a command that is none."""

import importlib.metadata
import io
import signal
import sys

import numpy as np
import pytest
from conftest import refused, typed

from validation.cli import entry
from validation.cli.printing import output
from validation.entry import command, siblings

OUT_OF_RANGE = """
advise response figures-3-4 --set time.step=0.002 --points 100000000000000
advise response figures-3-4 --set time.step=0.002 --to 1e300
advise response figures-3-4 --set time.step=1e-320
advise wave figures-3-4 --set time.step=0.002 --fmax 1e200
advise wave figures-3-4 --set time.step=0.002 --fmax 1e-200
advise damping figures-3-4 --set time.step=1e-300
advise damping figures-3-4 --set time.step=0.002 --set contact.stiffness=1e300
advise contact unlocked-constant --set block.velocity=1e200 --set time.step=0.002 --set time.steps=2
"""


@pytest.mark.parametrize("line", OUT_OF_RANGE.strip().splitlines())
def test_numbers_out_of_range_are_one_line(line):
    done = typed(*line.split())
    lines = [line for line in done.stderr.splitlines() if not line.startswith("warning: ")]
    assert done.returncode == 2 and len(lines) == 1 and lines[0].startswith("error: "), done.stderr


@pytest.mark.parametrize(
    "error",
    [
        MemoryError(),
        OverflowError(34, "Numerical result out of range"),
        ZeroDivisionError("division by zero"),
        FloatingPointError("overflow"),
        np.linalg.LinAlgError("Eigenvalues did not converge"),
        RuntimeError("Factor is exactly singular"),
        ValueError("array must not contain infs or NaNs"),
        ModuleNotFoundError("No module named 'meshio.vtu'", name="meshio.vtu"),
        OSError(28, "No space left on device", "history.csv"),
    ],
    ids=lambda error: type(error).__name__,
)
def test_errors_of_numbers_are_bad_input(error, monkeypatch):
    def fail(**options):
        raise error

    monkeypatch.setattr(entry, "command_line", lambda: fail)
    said = refused("list")
    assert said.startswith("error: ") and "None" not in said


@pytest.mark.parametrize("error", [ValueError("fault"), ModuleNotFoundError("fault", name="os.fault")])
def test_an_error_of_the_program_stays_one(error, monkeypatch):
    def fail(**options):
        raise error

    monkeypatch.setattr(entry, "command_line", lambda: fail)
    with pytest.raises(type(error), match="fault"):
        typed("list")


def test_a_reader_that_has_gone_is_no_failure(monkeypatch):
    def fail(**options):
        raise BrokenPipeError

    monkeypatch.setattr(entry, "command_line", lambda: fail)
    closed = []
    monkeypatch.setattr(entry, "silence", lambda: closed.append(True))
    done = typed("list")
    assert (done.returncode, done.stderr, closed) == (0, "", [True])


def test_a_full_output_is_one_line(monkeypatch):
    class Full(io.StringIO):
        def flush(self):
            raise OSError(28, "No space left on device")

    closed = []
    monkeypatch.setattr(entry, "silence", lambda: closed.append(True))
    monkeypatch.setattr(entry, "command_line", lambda: lambda **options: setattr(sys, "stdout", Full()))
    assert (refused("list"), closed) == ("error: standard output: No space left on device\n", [True])


def test_a_module_that_is_nowhere_is_refused_before_anything_runs():
    for words in (("solve", "field-locked", "--solver"), ("judge", "--study", "core")):
        line = refused(*words, "nowhere:solve")
        assert line.startswith("error: solver: ") and "nowhere:solve" in line


def test_the_version_is_that_of_the_distribution():
    done = typed("--version")
    assert (done.returncode, done.stdout) == (0, f"dda-validate {importlib.metadata.version('dda-validation')}\n")


def test_no_command_shows_the_commands_once():
    done = typed()
    assert done.returncode == 2 and not done.stderr.strip()
    assert done.stdout.count("export-pack") == 1


def test_streams_are_there_and_take_every_character(monkeypatch):
    errors = io.TextIOWrapper(io.BytesIO(), "ascii")
    monkeypatch.setattr(sys, "stdout", None)
    monkeypatch.setattr(sys, "stderr", errors)
    output.prepare()
    with sys.stdout as stream:
        print("x", file=stream)
    print("é", file=sys.stderr, flush=True)
    assert errors.buffer.getvalue() == b"\\xe9\n"


# ---- what starts first ----------------------------------------------------------------------------------------------


@pytest.mark.usefixtures("interruptible")
def test_a_command_starts_on_one_thread_unless_a_folder_is_in_its_way(monkeypatch, capsys):
    calls = []
    monkeypatch.setattr("validation.runs.threads.limit_process", lambda: calls.append("limited"))
    monkeypatch.setattr("validation.cli.main", lambda: calls.append("run"))
    monkeypatch.setattr(command, "shadowed", lambda: None)
    for handler, left in ((signal.default_int_handler, signal.SIG_DFL), (signal.SIG_IGN, signal.SIG_IGN)):
        signal.signal(signal.SIGINT, handler)
        command.main()
        assert signal.getsignal(signal.SIGINT) is left
    assert calls == ["limited", "run"] * 2
    monkeypatch.setattr(command, "shadowed", lambda: "x is in the way")
    with pytest.raises(SystemExit) as stopped:
        command.main()
    assert (stopped.value.code, capsys.readouterr().err, len(calls)) == (2, "error: x is in the way\n", 4)


def test_what_has_the_name_of_a_package_of_ours_is_named_and_what_is_nowhere_is_not(monkeypatch, tmp_path):
    siblings.check()
    monkeypatch.setattr(siblings, "PACKAGES", ("no_such_package", "heapq"))  # one of a single file
    assert siblings.shadowed().startswith(f"{importlib.import_module('heapq').__file__} is in the way of ")
    monkeypatch.setattr(siblings, "PACKAGES", ("dda",))
    monkeypatch.setattr(siblings, "HOME", tmp_path)
    with pytest.raises(ImportError, match=rf"dda is in the way of the package dda .* in {tmp_path};"):
        siblings.check()
