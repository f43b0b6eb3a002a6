"""Real processes: killed in the middle, writing where nothing can be written, two at once in one directory."""

import errno
import os
import resource
import sys

import numpy as np
import pytest
from conftest import SCENE, refused, typed
from faults import seams

from validation.errors import InputError
from validation.runs.history import History
from validation.runs.results import Results
from validation.runs.row import Row
from validation.runs.run import Outcome

# A solver that has not answered before it may.


def rows_of(results):
    return Results(results).rows()


def finished(name):
    return Row(name, "s", "x", "dda", Outcome.COMPLETED, {}), History(np.ones(3), {"displacement": np.ones(3)})


def test_a_write_that_fails_is_reported_and_costs_no_finished_row(tmp_path, monkeypatch):
    results = Results(tmp_path)
    results.append(*finished("first"))
    monkeypatch.setattr(os, "write", lambda handle, data: 5)  # a disk that is full takes the beginning
    with pytest.raises(InputError, match=r"rows\.jsonl: "):
        results.append(*finished("second"))
    monkeypatch.undo()
    results.append(*finished("third"))
    assert set(results.rows()) == {"first", "third"}


def test_a_directory_that_cannot_be_written_is_one_line(scene_file, tmp_path):
    (tmp_path / "file").write_text("not a directory")
    refused("run", scene_file, "--results", tmp_path / "file" / "r")
    (tmp_path / "r" / "rows.jsonl").mkdir(parents=True)
    assert "regular" in refused("run", scene_file, "--results", tmp_path / "r")


def test_a_write_that_fails_in_the_middle_of_a_study_is_one_line(scene_file, tmp_path, monkeypatch):
    """A limit on the size of files stands for a full disk: the second history does not fit."""
    scene_file.write_text(SCENE + '[run]\nsolvers = ["dda"]\n[sweep]\n"time.steps" = [10, 4000]\n')
    monkeypatch.setattr(sys, "dont_write_bytecode", True)  # a compiled file would be cut off, and kept
    made = {"python": "3", "commit": "here", "packages": {}}
    seams.ORIGIN.put(monkeypatch, lambda: made)  # git would be ended in the middle of its index, and leave its lock
    before = resource.getrlimit(resource.RLIMIT_FSIZE)
    resource.setrlimit(resource.RLIMIT_FSIZE, (16_384, before[1]))
    try:
        said = refused("run", scene_file, "--results", tmp_path / "r")
    finally:
        resource.setrlimit(resource.RLIMIT_FSIZE, before)
    assert os.strerror(errno.EFBIG) in said
    assert len(rows_of(tmp_path / "r")) == 1
    assert len(list((tmp_path / "r" / "histories").iterdir())) == 1
    assert typed("run", scene_file, "--results", tmp_path / "r").returncode == 0
    assert len(rows_of(tmp_path / "r")) == 2
