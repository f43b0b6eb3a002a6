"""A kind of scene is one folder: one that is added joins, one that is deleted leaves the rest as it is."""

import shutil
import subprocess
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]
PENDULUM = {
    "tables.py": '''
from typing import Annotated

from validation.scenes.keys import Key, Section
from validation.scenes.tables import Positive


class PendulumSection(Section):
    """A mass on a rod."""

    length: Annotated[Positive, Key("m", "of the rod")]
''',
    "kind.py": '''
from validation.models.pendulum.tables import PendulumSection
from validation.scenes.kinds import Kind


class KIND(Kind):
    """A mass on a rod that swings."""

    name = "pendulum"
    words = "a pendulum"
    feature = "pendulum"
    tables = {"pendulum": PendulumSection}
    solvers = {"swing": "validation.models.pendulum.swing:Swing"}
    refuses = ("fem",)

    def run(self, table):
        return {"solvers": ["swing"], "columns": ["rotation"]}
''',
    "swing.py": '''
import numpy as np

from validation.runs.history import History
from validation.runs.run import Outcome, Run
from validation.scenes.scene import Scene
from validation.solvers.contract import Solver


class Swing(Solver):
    """Small swings."""

    name = "swing"
    handles = frozenset({"pendulum"})
    sources = ()

    def solve(self, scene, full=False, fields=None):
        time = scene.time.step * np.arange(1.0, scene.time.steps + 1)
        return Run(Outcome.COMPLETED, History(time, {"rotation": np.cos(np.sqrt(9.81 / scene.pendulum.length) * time)}))
''',
}
SCENE = "title = 'A pendulum'\npendulum = { length = 1.0 }\ntime = { step = 0.01, steps = 10 }\n"
HERE = """
import sys
import validation
from validation.scenes.scene import load_scene, parse_scene, scene_names
from validation.scenes.kinds import kinds
from validation.cli.entry import main


def command(*words):
    sys.argv = ["dda-validate", *map(str, words)]
    try:
        main()
    except SystemExit as ended:
        assert not ended.code, (words, ended.code)

"""
ADDED = (
    """
import validation.models
validation.models.__path__.append("kinds")
"""
    + HERE
    + """
scene = load_scene("swing.toml")
assert scene.kind.name == "pendulum" and scene.pendulum.length == 1.0, scene
assert scene.run.solvers == ("swing",) and scene.run.columns == ("rotation",)
assert load_scene("figures-3-4").kind.name == "block"
for more, field in (({"fem": {}}, "fem"), ({"block": {"side": 1.0, "density": 1.0, "young": 1.0}}, "block")):
    try:
        parse_scene(scene.definition() | more, "swing")
    except ValueError as error:
        assert error.field == field, error.field
    else:
        raise AssertionError(more)
assert validation.solve(scene, "swing").history.columns["rotation"][-1] < 1
try:
    validation.solve(scene, "dda")
except ValueError as error:
    assert "pendulum" in str(error), error
else:
    raise AssertionError("dda takes it")
command("show", "swing.toml")
command("run", "swing.toml", "--results", "results", "--jobs", "1")
"""
)


def python(code, place):
    """Run some lines of Python in a folder, before whose path stands the folder itself."""
    command = [sys.executable, "-c", f"import sys; sys.path.insert(0, '.')\n{code}"]
    finished = subprocess.run(command, cwd=place, capture_output=True, text=True, check=False)
    assert finished.returncode == 0, finished.stderr[-3000:]


@pytest.mark.long
def test_a_folder_adds_a_kind(tmp_path):
    folder = tmp_path / "kinds" / "pendulum"
    folder.mkdir(parents=True)
    for name, text in PENDULUM.items():
        (folder / name).write_text(text, encoding="utf-8")
    (tmp_path / "swing.toml").write_text(SCENE, encoding="utf-8")
    python(ADDED, tmp_path)


KEPT = (
    HERE
    + """
from pathlib import Path

assert Path(validation.__file__).is_relative_to(Path.cwd()), validation.__file__
assert "{kind}" not in kinds() and len(kinds()) == 2
left = [load_scene(name) for name in scene_names()]
assert {{scene.kind.name for scene in left}} == {{*kinds()}}
for name in {scenes}:
    command("show", name)
command("list", "studies")
"""
)


def states(path, kind):
    """Tell whether a scene is of a kind."""
    return f"[{kind}]" in path.read_text(encoding="utf-8")


@pytest.mark.long
def test_a_deleted_folder_leaves_the_rest(tmp_path):
    kind = "plane"
    for package in ("dda", "fem_reference", "validation"):
        shutil.copytree(ROOT / package, tmp_path / package, ignore=shutil.ignore_patterns("__pycache__"))
    shutil.rmtree(tmp_path / "validation" / "models" / kind)
    for study in (tmp_path / "validation" / "studies").iterdir():
        stated = any(states(scene, kind) for scene in study.glob("scenes/*.toml"))
        made = any(f"models.{kind}" in module.read_text() for module in study.glob("*.py"))
        if stated or made:  # a study of the kind goes with it
            shutil.rmtree(study)
    for scene in (tmp_path / "validation" / "scenes" / "library").glob("*.toml"):
        if states(scene, kind):
            scene.unlink()
    python(KEPT.format(kind=kind, scenes=["figures-3-4", "columns-weight"]), tmp_path)
