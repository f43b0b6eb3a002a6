"""The commit that results are kept with is that of the suite's own sources, or none."""

import importlib.util
import os
import shutil
import subprocess
from pathlib import Path

import pytest

import validation

HERE = Path(validation.__file__).parents[1]
PROJECT = '[project]\nname = "{}"\n'
pytestmark = pytest.mark.skipif(shutil.which("git") is None, reason="needs git")


def git(directory, *words):
    names = {f"GIT_{who}_{what}": "x" for who in ("AUTHOR", "COMMITTER") for what in ("NAME", "EMAIL")}
    return subprocess.run(
        ["git", *words], cwd=directory, env=os.environ | names, check=True, capture_output=True, text=True
    ).stdout.strip()


def sources(place):
    """Copy the module that says where results come from."""
    (place / "validation" / "runs").mkdir(parents=True)
    shutil.copy(HERE / "validation/runs/provenance.py", place / "validation/runs/provenance.py")
    return place


def project(place, name):
    """Make a git project with one commit and return that."""
    place.mkdir(parents=True, exist_ok=True)
    (place / "pyproject.toml").write_text(PROJECT.format(name))
    git(place, "init", "-q")
    git(place, "add", "-A")
    git(place, "commit", "-qm", "first")
    return git(place, "describe", "--always", "--abbrev=12")


def said(place):
    """Return what the module that stands at a place says."""
    spec = importlib.util.spec_from_file_location("provenance_elsewhere", place / "validation/runs/provenance.py")
    assert spec is not None and spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return str(module._commit())


def test_an_own_checkout_tells_its_commit(tmp_path):
    commit = project(sources(tmp_path / "suite"), "dda-validation")
    assert said(tmp_path / "suite") == commit
    with (tmp_path / "suite" / "pyproject.toml").open("a") as stream:
        stream.write("# changed\n")
    assert said(tmp_path / "suite") == f"{commit}+"


INSIDE = ".venv/site-packages"  # as an environment in a project's directory has it


@pytest.mark.parametrize(
    ("place", "name"), [(INSIDE, "other-project"), (INSIDE, "dda-validation"), ("", "other-project"), ("", "a-project")]
)
def test_another_project_or_another_checkout_of_this_one_has_no_commit(place, name, tmp_path):
    inside = sources(tmp_path / "other" / place)
    project(tmp_path / "other", name)
    assert said(inside).startswith("unknown (")
