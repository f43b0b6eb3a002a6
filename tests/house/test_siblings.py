"""A folder of the user's with the name of one of our packages is named, in one sentence, by whatever comes first."""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path

import pytest

from validation.siblings import HOME, shadowed

STARTS = {
    "command": ["-m", "validation", "list"],
    "solve": ["-m", "validation", "solve", "figures-3-4"],
    "plug-in": ["-m", "pytest", "-q", "-p", "no:cacheprovider", "-p", "validation.plugin", "--dda-solver", "my:solve"],
}


def test_our_own_packages_are_not_in_the_way() -> None:
    assert shadowed() is None


def start(words: list[str], place: Path) -> subprocess.CompletedProcess[str]:
    """Start Python where the packages of a place come first, and ours come next."""
    path = os.pathsep.join([str(place), str(HOME), os.environ.get("PYTHONPATH", "")])
    return subprocess.run(
        [sys.executable, *words],
        cwd=place,
        env=os.environ | {"PYTHONPATH": path, "PYTEST_DISABLE_PLUGIN_AUTOLOAD": "1"},
        capture_output=True,
        text=True,
        timeout=120,
    )


@pytest.fixture(params=["dda", "fem_reference"])
def place(request: pytest.FixtureRequest, tmp_path: Path) -> Path:
    """Return a directory with a package of that name."""
    (tmp_path / request.param).mkdir()
    (tmp_path / request.param / "__init__.py").touch()
    return tmp_path


@pytest.mark.parametrize("name", STARTS)
def test_the_folder_is_named_and_nothing_runs(name: str, place: Path) -> None:
    done = start(STARTS[name], place)
    said = done.stdout + done.stderr
    assert done.returncode == 2, said
    assert f"{next(place.iterdir())} is in the way of the package " in said
    assert "Traceback" not in said


def test_the_first_name_from_python_finds_out(place: Path) -> None:
    done = start(["-c", "import validation\nfrom validation import solve"], place)
    assert done.stderr.splitlines()[-1].startswith(f"ImportError: {next(place.iterdir())} is in the way of")


def test_a_folder_without_code_is_in_nobodys_way(tmp_path: Path) -> None:
    (tmp_path / "dda").mkdir()
    assert start(["-m", "validation", "list", "studies"], tmp_path).returncode == 0
