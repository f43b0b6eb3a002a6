"""Eccentric, sideways and volume loads and a moving base: DDA, finite elements and closed forms."""

from pathlib import Path

import pytest
from conftest import SCENE

from validation import load_scene, solve
from validation.errors import InputError

COLUMNS = ("displacement", "contact_pressure", "horizontal_displacement", "rotation")


def scene_with(tmp_path: Path, load: str, record: str | None = None) -> Path:
    text = SCENE.replace("pressure = 5.0e6", load) + '[run]\nsolvers = ["dda", "fem"]\n'
    text += f"columns = {list(COLUMNS)!r}\n"
    path = tmp_path / "loads.toml"
    path.write_text(text)
    if record is not None:
        (tmp_path / "quake.csv").write_text(record)
    return path


@pytest.mark.parametrize(
    ("record", "words"),
    [
        (None, "cannot be read"),
        ("time,z\n0,0\n", "header must be time,x or time,y or time,x,y"),
        ("time,x\n0,0\n0,1\n", "time must increase from row to row, got 0 after 0"),
        ("time,x\n0,nan\n", "must hold finite numbers"),
        ("time,x\n0,a\n", ":2:3: must be a number, got 'a'"),
        ("time,x\n", "must hold rows of numbers under the header"),
    ],
)
def test_records_are_checked(tmp_path, record, words):
    scene = load_scene(scene_with(tmp_path, 'base_motion = "quake.csv"', record))
    with pytest.raises(InputError, match=words):
        solve(scene, "dda")
