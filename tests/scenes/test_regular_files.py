"""What is no regular file is refused at once; what begins with a byte-order mark is read everywhere."""

import os
import re
import signal
from pathlib import Path

import numpy as np
import pytest
from conftest import refused

from validation.diagnosis.reading import read
from validation.errors import InputError
from validation.gates.changes import read_verdicts
from validation.runs.files import read_table, write_atomically
from validation.runs.history import History
from validation.runs.regular import regular
from validation.runs.results import Results
from validation.runs.row import Row
from validation.runs.run import Outcome
from validation.scenes.record import read_record
from validation.scenes.scene import load_scene


@pytest.fixture
def pipe(tmp_path):
    path = tmp_path / "pipe.toml"
    os.mkfifo(path)
    return path


@pytest.fixture
def limited():
    """End what waits for a pipe."""

    def ended(number, frame):
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
        ("advise damping {scene} --set fem.mesh={pipe}", "fem: mesh: "),
        ("solve {scene} --set load.base_motion={pipe}", "load: base_motion: "),
        ("solve {scene} --solver fem --set fem.mesh={pipe}", "fem: mesh: "),
    ],
)
def test_a_pipe_is_refused_and_not_waited_for(command, field, pipe, scene_file, limited):
    words = [word.format(pipe=pipe, scene=scene_file) for word in command.split()]
    assert re.search(rf"{field}{pipe}: .*, got a pipe$", refused(*words, cwd=pipe.parent))


def test_devices_and_directories_are_named(tmp_path):
    for place, kind in ((Path("/dev/zero"), "device"), (tmp_path, "directory")):
        readers = (regular, read_record, read_table, read, load_scene)
        for reader in (*readers, *([read_verdicts] if kind == "device" else [])):
            with pytest.raises(InputError) as error:
                reader(place)
            assert (error.value.source, error.value.value) == (place, f"a {kind}")


def test_a_large_file_is_refused_before_it_is_read(tmp_path):
    path = tmp_path / "large.toml"
    with path.open("wb") as stream:
        stream.truncate(10**9)
    for reader, largest in ((load_scene, 1_000_000), (read, 100_000_000)):
        with pytest.raises(InputError, match=rf"^{path}: .* {largest} .* got 1000000000$"):
            reader(path)


def write(path, content=b"new"):
    write_atomically(path, lambda stream: stream.write(content))


def test_an_output_keeps_the_kind_of_what_stands_there(tmp_path, limited):
    target, link, pipe = tmp_path / "target.csv", tmp_path / "link.csv", tmp_path / "pipe.csv"
    link.symlink_to(target)
    write(link)
    assert link.is_symlink() and target.read_bytes() == b"new"
    os.mkfifo(pipe)
    with pytest.raises(InputError) as error:
        write(pipe)
    assert error.value.source == pipe
    reader = os.open(pipe, os.O_RDONLY | os.O_NONBLOCK)
    write(pipe)
    assert pipe.is_fifo() and os.read(reader, 9) == b"new"
    os.close(reader)
    write(Path("/dev/null"))
    assert Path("/dev/null").is_char_device()
    assert sorted(path.name for path in tmp_path.iterdir()) == ["link.csv", "pipe.csv", "target.csv"]


@pytest.mark.parametrize("option", ["solve --csv", "solve --fields", "run --summary"])
def test_an_output_that_cannot_be_written_is_refused_before_anything_runs(option, tmp_path, scene_file):
    command, name = option.split()
    ending = ".xdmf" if name == "--fields" else ".txt"
    folder, loop, lost = tmp_path / f"folder{ending}", tmp_path / f"loop{ending}", tmp_path / "absent" / f"a{ending}"
    folder.mkdir()
    loop.symlink_to(loop)
    for place in (folder, loop, lost):
        assert str(place) in refused(command, scene_file, name, place, cwd=tmp_path)
    assert sorted(path.name for path in tmp_path.iterdir()) == sorted([folder.name, loop.name, scene_file.name])


def kept_row(directory, **changes):
    """Return results of one row, whose history has two steps of one column."""
    results = Results(directory)
    row = Row("k", "s", "s", "dda", Outcome.COMPLETED, {})
    results.append(row, History(np.array([0.1, 0.2]), {"displacement": np.zeros(2)}))
    case = {"scene": "s", "title": "", "solver": "dda", "key": "k", "definition": {}}
    results.write_json("studies/s.json", {"study": "s", "cases": [case]})
    return results


def test_a_history_that_is_not_as_it_was_kept_is_refused_unread(tmp_path):
    results = kept_row(tmp_path)
    assert results.whole("s", histories=True)["study"] == "s"
    path = tmp_path / "histories" / "k.npz"
    bomb = {"time": np.zeros(10**6), "displacement": np.zeros(10**6)}  # packed to some kilobytes
    for save, columns in (
        (np.savez_compressed, bomb),
        (np.savez, {"time": np.zeros(2)}),
        (np.savez, {"time": np.zeros(900), "displacement": np.zeros(900)}),
    ):
        save(path, **columns)
        with pytest.raises(InputError) as error:
            results.whole("s", histories=True)
        assert error.value.source == path


@pytest.mark.parametrize("name", ["rows.jsonl", "verdicts.json", "studies/s.json", "histories/k.npz", ".lock"])
def test_a_pipe_in_a_results_directory_is_not_waited_for(name, tmp_path, limited):
    results = kept_row(tmp_path)
    (tmp_path / name).unlink(missing_ok=True)
    os.mkfifo(tmp_path / name)
    with pytest.raises(InputError) as error:
        results.check()
        results.whole("s", histories=True)
        results.write_verdicts("s", [])
    assert error.value.value == "a pipe"
