"""A kind of scene is one folder: one that is added joins, one that is deleted leaves the rest as it is."""

from __future__ import annotations

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
    tables = {"pendulum": PendulumSection}
    refuses = ("fem",)

    def run(self, table):
        return {"solvers": ["dda"], "columns": ["rotation"]}
''',
}
SCENE = "title = 'A pendulum'\npendulum = { length = 1.0 }\ntime = { step = 0.01, steps = 10 }\n"
ADDED = """
import sys
import validation.models
validation.models.__path__.append("kinds")
from validation.scenes.scene import load_scene, parse_scene
scene = load_scene("swing.toml")
assert scene.kind.name == "pendulum" and scene.pendulum.length == 1.0, scene
assert scene.run.solvers == ("dda",) and scene.run.columns == ("rotation",)
assert load_scene("figures-3-4").kind.name == "block"
for more, field in (({"fem": {}}, "fem"), ({"block": {"side": 1.0, "density": 1.0, "young": 1.0}}, "block")):
    try:
        parse_scene(scene.definition() | more, "swing")
    except ValueError as error:
        assert error.field == field, error.field
    else:
        raise AssertionError(more)
"""


def python(code: str, place: Path) -> None:
    """Run some lines of Python in a folder, before whose path stands the folder itself."""
    command = [sys.executable, "-c", f"import sys; sys.path.insert(0, '.')\n{code}"]
    finished = subprocess.run(command, cwd=place, capture_output=True, text=True, check=False)
    assert finished.returncode == 0, finished.stderr[-3000:]


def test_a_folder_adds_a_kind(tmp_path: Path) -> None:
    folder = tmp_path / "kinds" / "pendulum"
    folder.mkdir(parents=True)
    for name, text in PENDULUM.items():
        (folder / name).write_text(text, encoding="utf-8")
    (tmp_path / "swing.toml").write_text(SCENE, encoding="utf-8")
    python(ADDED, tmp_path)


KEPT = """
from pathlib import Path
import validation
assert Path(validation.__file__).is_relative_to(Path.cwd()), validation.__file__
from validation.scenes.kinds import kinds
from validation.scenes.scene import load_scene, scene_names
assert "{kind}" not in kinds() and len(kinds()) == 3
count = 0
for name in scene_names():
    count += bool(load_scene(name))
assert count > 50
"""


@pytest.mark.parametrize("kind", ["rigid"])
def test_a_deleted_folder_leaves_the_rest(kind: str, tmp_path: Path) -> None:
    for package in ("dda", "fem_reference", "validation"):
        shutil.copytree(ROOT / package, tmp_path / package, ignore=shutil.ignore_patterns("__pycache__"))
    shutil.rmtree(tmp_path / "validation" / "models" / kind)
    for scene in (tmp_path / "validation").rglob("scenes/**/*.toml"):
        if f"[{kind}]" in scene.read_text(encoding="utf-8"):
            scene.unlink()
    python(KEPT.format(kind=kind), tmp_path)
