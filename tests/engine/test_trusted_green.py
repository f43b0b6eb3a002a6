"""What is kept is served only where it is whole and its own; what was not measured is no green."""

import itertools
import json
import shutil
import tomllib
import zipfile
from dataclasses import replace

import numpy as np
import pytest
from conftest import SCENE, refused, thinned
from faults import seams
from oracles.made_cases import study

from validation.engine import measure, origin
from validation.engine.case import Case
from validation.engine.run import finish, run_study
from validation.engine.study import Study
from validation.errors import InputError
from validation.runs.history import History
from validation.runs.results import Results
from validation.runs.row import Row
from validation.runs.run import Outcome
from validation.scenes.scene import load_scene, parse_scene


def ran(scene, results):
    """Return the solvers that a run has run, not taken from the directory."""
    seen = []
    run_study(study(scene), results, progress=lambda done, total, label: seen.append(label.split()[1]))
    return seen


# ---- kept rows ------------------------------------------------------------------------------------------------------


def test_the_manifest_says_which_versions_made_the_rows(scene, tmp_path, monkeypatch):
    results = Results(tmp_path)
    then = {"python": "3.11", "commit": "then", "packages": {"numpy": "2.0.0"}}
    seams.ORIGIN.put(monkeypatch, lambda: then)
    monkeypatch.setattr(origin, "library_versions", dict)
    finish([Case(scene, "dda")], study(scene), results)
    seams.ORIGIN.put(monkeypatch, lambda: then | {"commit": "now", "packages": {"numpy": "2.1.0"}})
    assert ran(scene, results) == ["bar"]
    found = results.manifest("test")["provenance"]
    assert found["commit"] == "then (1 row); now (1 row)"
    assert found["packages"] == {"numpy": "2.0.0 (1 row); 2.1.0 (1 row)"}
    assert found["python"] == "3.11"


def shorter(history):
    return History(history.time[:-1], {name: values[:-1] for name, values in history.columns.items()})


def without_pressure(history):
    return History(history.time, {"displacement": history.displacement})


def infinite(history):
    return History(history.time, {**history.columns, "displacement": np.full(len(history.time), np.inf)})


@pytest.fixture(scope="module")
def rows_kept(tmp_path_factory):
    """Return a directory with the rows of a study."""
    directory = tmp_path_factory.mktemp("kept")
    run_study(study(parse_scene(tomllib.loads(SCENE), "small")), Results(directory))
    return directory


HISTORIES = [shorter, without_pressure, infinite, lambda history: None]  # the last one takes the file away
LINES = [
    lambda line: line.replace('"displacement.static": -0.01', '"displacement.static": -0.012'),
    lambda line: line.replace('"outcome": "completed"', '"outcome": "unstable as predicted"'),
    lambda line: json.dumps({k: v for k, v in json.loads(line).items() if k != "digest"}),
    lambda line: replace(Row.parse(line), provenance={}).line(),
    lambda line: "[" * 100_000,
    lambda line: line[:-40],  # as a kill leaves it
]


@pytest.mark.parametrize(
    ("of_history", "change"), [*((True, one) for one in HISTORIES), *((False, one) for one in LINES)]
)
def test_what_is_not_as_it_was_written_is_run_again_and_nothing_else(of_history, change, scene, tmp_path, rows_kept):
    shutil.copytree(rows_kept, tmp_path, dirs_exist_ok=True)
    results = Results(tmp_path)
    (row,) = (row for row in results.rows().values() if row.solver == "dda")
    history = results.history(row.key)
    if of_history:
        (tmp_path / "histories" / f"{row.key}.npz").unlink()
        results.append(row, change(history))
    else:
        path = tmp_path / "rows.jsonl"
        lines = [line for line in path.read_text().splitlines() if line]
        path.write_text("\n".join(change(line) if '"dda"' in line else line for line in lines))
    assert ran(scene, results) == ["dda"]
    assert ran(scene, results) == []


def test_a_history_without_time_is_one_line(tmp_path):
    results, path = Results(tmp_path), tmp_path / "histories/k.npz"
    path.parent.mkdir()
    with path.open("wb") as stream:
        np.save(stream, np.zeros(3))
    with pytest.raises(InputError, match="read"):
        results.history("k")
    np.savez(path, displacement=np.zeros(50))
    with pytest.raises(InputError, match="another"):
        results.history("k")
    with zipfile.ZipFile(path, "a") as kept:
        kept.comment = b"k"
    with pytest.raises(InputError, match="time"):
        results.history("k")


# ---- records --------------------------------------------------------------------------------------------------------

COMMANDS = ["run", "report", "diff", "baseline"]
MALFORMED = ["[", "[" * 100_000, "{}", "null", '[{"study": "s"}]', '[{"id": 1, "study": "s"}]', '["a"]', "[1e999]"]


@pytest.mark.parametrize(
    ("command", "text"), thinned(itertools.product(COMMANDS, MALFORMED), 23), ids=itertools.count()
)
def test_malformed_verdicts_are_one_line_before_anything_runs(command, text, scene_file, tmp_path):
    results = tmp_path / "r"
    run_study(study(load_scene(scene_file)), Results(results))
    (results / "verdicts.json").write_text(text)
    before = (results / "rows.jsonl").read_bytes()
    words = {
        "run": ["run", scene_file, "--results", results],
        "report": ["report", "--results", results, "--out", tmp_path / "r.pdf"],
        "diff": ["diff", results, results],
        "baseline": ["run", scene_file, "--results", tmp_path / "new", "--baseline", results / "verdicts.json"],
    }
    assert "verdicts.json: " in refused(*words[command])
    assert (results / "rows.jsonl").read_bytes() == before and not (tmp_path / "new").exists()


def test_manifests_that_swap_places_or_lose_a_row_are_one_line(scene_file, tmp_path):
    results = Results(tmp_path / "r")
    run_study(study(load_scene(scene_file)), results)
    shutil.copy(tmp_path / "r/studies/test.json", tmp_path / "r/studies/other.json")
    for words in (["rows", "other"], ["report", "other", "--figures", "f"]):
        assert "'test'" in refused(*words, "--results", tmp_path / "r", cwd=tmp_path)
    (tmp_path / "r/studies/other.json").unlink()
    (tmp_path / "r/rows.jsonl").write_text("\n")
    for words in (["rows", "test"], ["report", "test", "--figures", "f"]):
        assert {"small", "dda"} <= {*refused(*words, "--results", tmp_path / "r", cwd=tmp_path).split()}


# ---- cases that end badly -------------------------------------------------------------------------------------------


def test_a_part_that_cannot_be_measured_is_noted_and_the_others_are_kept(scene, monkeypatch):
    sound = measure.solo

    def fails_in_modes(seen, parts, only):
        if "modes" in parts:
            raise np.linalg.LinAlgError("never")
        return sound(seen, parts, only)

    monkeypatch.setattr(measure, "solo", fails_in_modes)
    row, history = measure.execute(Case(scene, "dda"), "k", "test")
    assert row.outcome is Outcome.COMPLETED and history is not None
    assert row.notes[-1].startswith("modes ") and row.notes[-1].endswith(": LinAlgError: never")
    assert isinstance(row.metrics["displacement.final"], float) and "mode1.damping" not in row.metrics


def test_alarms_that_fail_on_one_scene_are_said_of_it_alone(scene, tmp_path):
    other = scene.model_copy(update={"name": "other"})

    def annotate(scenes, finished):
        names = [s.name for s in scenes]
        if "other" in names:
            raise OverflowError("large")
        told = [{"kind": "k", "scene": name, "sentence": "s", "values": {}} for name in names]
        return {"alarms": told, "budgets": []}

    made = Study("test", "t", "p", [scene, other], ("dda",), annotate=annotate)
    run_study(made, Results(tmp_path))
    told = {alarm["scene"]: alarm["sentence"] for alarm in Results(tmp_path).manifest("test")["alarms"]}
    assert told.pop("other").endswith(": OverflowError: large") and told == {"small": "s"}
