"""The command line as a user types it: exit status, one line for bad input, nothing half-written."""

import pytest
from conftest import refused, typed

from validation.cli import run


def test_verdicts_that_are_no_text_are_told_as_such(tmp_path):
    (tmp_path / "verdicts.json").write_bytes(b"\xff\xfe")
    assert refused("diff", tmp_path, tmp_path).startswith(f"error: {tmp_path / 'verdicts.json'}: ")


def test_springs_that_no_mode_can_have_are_named_by_an_alarm_not_by_a_warning(scene_file, tmp_path):
    words = ["--set", "contact.stiffness=1e308", "--set", "time.steps=5", "--results"]
    done = typed("run", scene_file, "--set", 'run.solvers=["dda","bar"]', *words, tmp_path / "results")
    assert "small" in done.stdout and "FloatingPointError" in done.stdout
    assert "RuntimeWarning" not in done.stderr


def test_an_end_of_a_file_is_no_interruption(monkeypatch):
    def torn(*arguments):
        raise EOFError("marshal data too short")

    monkeypatch.setattr("validation.suite.folders.get_study", torn)
    with pytest.raises(EOFError):
        typed("list", "studies")


def test_a_quiet_run_shows_no_bar(scene_file, tmp_path, monkeypatch):
    shown = []
    bar = run._progress

    def recorded(title, visible):
        shown.append((title, visible))
        return bar(title, visible)

    monkeypatch.setattr(run, bar.__name__, recorded)
    for words in ([], ["--quiet"]):
        typed("run", scene_file, "--set", 'run.solvers=["dda"]', "--results", tmp_path / "r", *words)
    assert shown == [("small", True), ("small", False)]
