"""The commit that results are kept with is that of the suite's own sources, or none."""

from __future__ import annotations

import os
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

import validation

HERE = Path(validation.__file__).parents[1]
ASK = "from validation.runs import provenance; print(provenance._commit(), provenance.__file__)"
PROJECT = '[project]\nname = "{}"\n'
pytestmark = pytest.mark.skipif(shutil.which("git") is None, reason="needs git")


def git(directory: Path, *words: str) -> str:
    names = {f"GIT_{who}_{what}": "x" for who in ("AUTHOR", "COMMITTER") for what in ("NAME", "EMAIL")}
    return subprocess.run(
        ["git", *words], cwd=directory, env=os.environ | names, check=True, capture_output=True, text=True
    ).stdout.strip()


def sources(place: Path) -> Path:
    """Copy the parts of the package that say where results come from."""
    (place / "validation" / "runs").mkdir(parents=True)
    for name in ("__init__.py", "errors.py", "runs/__init__.py", "runs/provenance.py"):
        shutil.copy(HERE / "validation" / name, place / "validation" / name)
    return place


def project(place: Path, name: str) -> str:
    """Make a git project with one commit and return that."""
    place.mkdir(parents=True, exist_ok=True)
    (place / "pyproject.toml").write_text(PROJECT.format(name))
    git(place, "init", "-q")
    git(place, "add", "-A")
    git(place, "commit", "-qm", "first")
    return git(place, "describe", "--always", "--abbrev=12")


def said(place: Path, **environment: str) -> str:
    done = subprocess.run(
        [sys.executable, "-c", ASK],
        env=os.environ | {"PYTHONPATH": str(place)} | environment,
        cwd=place,
        check=True,
        capture_output=True,
        text=True,
    )
    commit, _, file = done.stdout.strip().rpartition(" ")
    assert Path(file).is_relative_to(place)
    return commit


def test_an_own_checkout_tells_its_commit(tmp_path: Path) -> None:
    commit = project(sources(tmp_path / "suite"), "dda-validation")
    assert said(tmp_path / "suite") == commit
    with (tmp_path / "suite" / "pyproject.toml").open("a") as stream:
        stream.write("# changed\n")
    assert said(tmp_path / "suite") == f"{commit}+"


@pytest.mark.parametrize("name", ["another-project", "dda-validation"])
def test_a_package_inside_another_project_has_no_commit(name: str, tmp_path: Path) -> None:
    """As an environment in a project's directory has it, even in a checkout of this very project."""
    inside = sources(tmp_path / "other" / ".venv" / "site-packages")
    project(tmp_path / "other", name)
    assert said(inside) == "unknown (not a git checkout)"


def test_another_project_at_the_same_level_is_not_taken(tmp_path: Path) -> None:
    project(sources(tmp_path / "other"), "another-project")
    assert said(tmp_path / "other") == "unknown (not a git checkout)"


def test_what_git_s_own_variables_name_is_not_taken(tmp_path: Path) -> None:
    """A hook of another repository that runs the suite sets them."""
    project(tmp_path / "hooked", "hooked")
    inside = sources(tmp_path / "suite")
    assert said(inside, GIT_DIR=str(tmp_path / "hooked" / ".git")) == "unknown (not a git checkout)"
    commit = project(inside, "dda-validation")
    assert said(inside, GIT_DIR=str(tmp_path / "hooked" / ".git")) == commit


def test_a_checkout_without_a_commit(tmp_path: Path) -> None:
    inside = sources(tmp_path / "suite")
    (inside / "pyproject.toml").write_text(PROJECT.format("dda-validation"))
    git(inside, "init", "-q")
    assert said(inside) == "unknown (no commit yet)"
