"""A folder of the user's with the name of one of our packages is named, in one sentence, by whatever comes first."""

import os
import subprocess
import sys
import tomllib

import pytest

from validation.entry.siblings import HOME

ENTRY = HOME / "validation/entry"
PYTEST = ["-m", "pytest", "-q", "-p", "no:cacheprovider", "-p", "dda_validation.plugin"]
IN_THE_WAY = "in the way of the package"
# What starts first, its status, and the package that a folder has the name of; each package is tried below as well.
STARTS = {
    "command": (["-m", "dda_validation", "list"], 2, "dda"),
    "plug-in": ([*PYTEST, "--dda-solver", "my:solve"], pytest.ExitCode.USAGE_ERROR, "validation"),
}
SOLVE = ["solve", "figures-3-4", "--set", "time.step=0.002"]
SOLVER = "def solve(scene):\n    return [0.0] * scene.time.steps, [0.0] * scene.time.steps\n"


def test_an_install_holds_every_module_of_the_folder_under_its_second_name():
    setuptools = tomllib.loads((HOME / "pyproject.toml").read_text(encoding="utf-8"))["tool"]["setuptools"]
    names = {path.stem for path in ENTRY.glob("*.py")} - {"__init__"}
    assert HOME / setuptools["package-dir"]["dda_validation"] == ENTRY
    assert set(setuptools["py-modules"]) == {f"dda_validation.{name}" for name in names}


@pytest.fixture
def installed(tmp_path):
    """Return a directory that holds the folder under its second name, as an install does."""
    (tmp_path / "installed").mkdir()
    (tmp_path / "installed/dda_validation").symlink_to(ENTRY, target_is_directory=True)
    return tmp_path / "installed"


@pytest.fixture
def place(tmp_path):
    """Return a directory of the user's."""
    (tmp_path / "place").mkdir()
    return tmp_path / "place"


def add_package(place, name):
    """Add a package to a directory and return its folder."""
    (place / name).mkdir()
    (place / name / "__init__.py").touch()
    return place / name


def start(words, place, *path):
    """Start Python in a directory, where the packages of a path come before ours."""
    places = [*map(str, path), str(HOME), os.environ.get("PYTHONPATH", "")]
    return subprocess.run(
        [sys.executable, *words],
        cwd=place,
        env=os.environ | {"PYTHONPATH": os.pathsep.join(places), "PYTEST_DISABLE_PLUGIN_AUTOLOAD": "1"},
        capture_output=True,
        text=True,
        timeout=120,
    )


@pytest.mark.parametrize("name", ["command", pytest.param("plug-in", marks=pytest.mark.long)])
def test_the_folder_is_named_and_nothing_runs(name, place, installed):
    words, status, package = STARTS[name]
    folder = add_package(place, package)
    done = start(words, place, place, installed)
    output = done.stdout + done.stderr
    assert done.returncode == status, output
    assert f"{folder} is {IN_THE_WAY} {package}" in output
    assert "Traceback" not in output


@pytest.mark.long
def test_the_plug_in_leaves_a_projects_own_package_of_that_name_alone(place, installed):
    add_package(place, "validation").joinpath("theirs.py").write_text("VALUE = 3\n")
    place.joinpath("test_theirs.py").write_text(
        "from validation.theirs import VALUE\n\ndef test_it():\n    assert VALUE == 3\n"
    )
    done = start(PYTEST, place, installed)
    assert done.returncode == 0, done.stdout


@pytest.mark.long
def test_the_process_of_a_users_solver_takes_our_package_and_not_the_folder_beside_it(place):
    add_package(place, "validation")
    place.joinpath("my_flat_solver.py").write_text(SOLVER)
    code = "from validation.__main__ import main\nmain()"  # the command's own script has no directory on the path
    done = start(["-P", "-c", code, *SOLVE, "--solver", "my_flat_solver:solve"], place)
    assert done.returncode == 0, done.stderr
