"""What is no regular file is refused at once; what begins with a byte-order mark is read everywhere."""

from __future__ import annotations

import os
import signal
from collections.abc import Iterator
from pathlib import Path

import numpy as np
import pytest
from conftest import SCENE, refused

from validation.diagnosis.reading import read
from validation.errors import InputError
from validation.runs.files import read_csv, read_table
from validation.runs.regular import regular
from validation.scenes.record import read_record
from validation.scenes.scene import load_scene

MARK = b"\xef\xbb\xbf"
TABLE = b"time,x\n0,0\n1,0.5\n2,1\n"


@pytest.fixture
def pipe(tmp_path: Path) -> Path:
    path = tmp_path / "pipe.toml"
    os.mkfifo(path)
    return path


@pytest.fixture
def limited() -> Iterator[None]:
    """End what waits for a pipe."""

    def ended(number: int, frame: object) -> None:
        raise TimeoutError("waited for a pipe")

    before = signal.signal(signal.SIGALRM, ended)
    signal.alarm(20)
    yield
    signal.alarm(0)
    signal.signal(signal.SIGALRM, before)


@pytest.mark.parametrize(
    ("command", "field"),
    [
        ("solve {pipe}", ""),
        ("run {scene} --set fem.mesh={pipe}", "fem: mesh: "),
        ("compare {scene} {pipe}", ""),
        ("damping {scene} --set fem.mesh={pipe}", "fem: mesh: "),
        ("solve {scene} --set load.base_motion={pipe}", "load: base_motion: "),
        ("solve {scene} --solver fem --set fem.mesh={pipe}", "fem: mesh: "),
    ],
)
def test_a_pipe_is_refused_and_not_waited_for(
    command: str, field: str, pipe: Path, scene_file: Path, limited: None
) -> None:
    words = [word.format(pipe=pipe, scene=scene_file) for word in command.split()]
    assert f"{field}{pipe}: must be a regular file, got a pipe" in refused(*words, cwd=pipe.parent)


def test_devices_and_directories_are_named(tmp_path: Path) -> None:
    for place, kind in ((Path("/dev/zero"), "device"), (tmp_path, "directory")):
        with pytest.raises(InputError, match=f"must be a regular file, got a {kind}"):
            regular(place)
        for reader in (read_record, read_csv, read, load_scene):
            with pytest.raises(InputError, match=f"must be a regular file, got a {kind}"):
                reader(place)


def test_a_scene_in_a_sweep_is_looked_at_as_well(pipe: Path, tmp_path: Path) -> None:
    path = tmp_path / "swept.toml"
    path.write_text(SCENE + f'[sweep]\n"load.base_motion" = ["{pipe.name}"]\n')
    with pytest.raises(InputError, match=r"base_motion: .*must be a regular file, got a pipe"):
        load_scene(path).expand()


def test_a_file_that_is_not_there_is_told_where_it_is_read(tmp_path: Path) -> None:
    path = tmp_path / "scene.toml"
    path.write_text(SCENE + '\n[run]\nsolvers = ["dda"]\n')
    scene = load_scene(path).with_values({"load.base_motion": str(tmp_path / "absent.csv")})
    with pytest.raises(InputError, match="cannot be read: No such file"):
        read_record(Path(str(scene.load.base_motion)))


def test_a_byte_order_mark_is_no_part_of_a_table(tmp_path: Path) -> None:
    path = tmp_path / "record.csv"
    path.write_bytes(MARK + TABLE)
    assert np.array_equal(read_record(path).x, [0, 0.5, 1])
    assert read_table(path)[0] == ["time", "x"]
    assert list(read_csv(path).columns) == ["x"]
    path.write_bytes(MARK + b"time,displacement\n1,1\n2,2\n3,3\n4,4\n")
    assert np.array_equal(read(path).displacement, [1, 2, 3, 4])
    scene = tmp_path / "marked.toml"
    scene.write_bytes(MARK + SCENE.encode())
    assert load_scene(scene).name == "marked"


def test_a_large_file_is_refused_before_it_is_read(tmp_path: Path) -> None:
    path = tmp_path / "large.toml"
    with path.open("wb") as stream:
        stream.truncate(10**9)
    for reader, largest in ((load_scene, 1_000_000), (read, 100_000_000)):
        with pytest.raises(InputError, match=rf"^{path}: must be at most {largest} bytes, got 1000000000"):
            reader(path)
