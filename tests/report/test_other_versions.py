"""Results that another version wrote cost their own chapter, not the report and not the gallery."""

import hashlib
import json
import shutil

import pytest
from conftest import SCENE, typed

from validation.report.book import ordered_studies, unread_studies
from validation.results import Results

GATE = """
[run]
solvers = ["dda", "bar"]
[[gate]]
pair = ["dda", "bar"]
metric = "displacement.l2"
band = [0.0, 1.0]
reason = "a test"
"""


@pytest.fixture(scope="module")
def two(tmp_path_factory):
    """Return the results of two scenes."""
    place = tmp_path_factory.mktemp("two")
    for name, step in (("mine", "time.step=0.002"), ("theirs", "time.step=0.001")):
        (place / f"{name}.toml").write_text(SCENE + GATE)
        done = typed("run", f"{name}.toml", "--set", step, "--results", "r", cwd=place)
        assert done.returncode == 0, done.stderr
    return place / "r"


def change_manifest(results, change):
    path = results / "studies" / "theirs.json"
    manifest = json.loads(path.read_text())
    change(manifest)
    path.write_text(json.dumps(manifest))


def change_rows(results, change):
    path = results / "rows.jsonl"
    rows = [json.loads(line) for line in path.read_text().splitlines() if line]
    for row in rows:
        row.pop("digest")
        if row["study"] == "theirs":
            change(row)
        row["digest"] = hashlib.sha256(json.dumps(row, sort_keys=True).encode()).hexdigest()[:16]
    path.write_text("\n".join(map(json.dumps, rows)) + "\n")


def change_verdicts(results, change):
    path = results / "verdicts.json"
    verdicts = json.loads(path.read_text())
    for verdict in verdicts:
        if verdict["study"] == "theirs":
            change(verdict)
    path.write_text(json.dumps(verdicts))


def redefine(manifest):
    for case in manifest["cases"]:
        case["definition"]["future"] = {"key": 1}


UNREADABLE = {
    "manifest": (change_manifest, lambda manifest: manifest.update(cases=3)),
    "definition": (change_manifest, redefine),
    "outcome": (change_rows, lambda row: row.update(outcome="of the future")),
    "row": (change_rows, lambda row: row.pop("metrics")),
    "verdict": (change_verdicts, lambda verdict: verdict.update(verdict="MAYBE")),
    "band": (change_verdicts, lambda verdict: verdict.pop("band")),
}


def changed(name, two, tmp_path):
    """Return a copy of the results in which one study is of another version."""
    shutil.copytree(two, tmp_path / "r")
    edit, change = UNREADABLE[name]
    edit(tmp_path / "r", change)
    return Results(tmp_path / "r")


@pytest.mark.parametrize("name", UNREADABLE)
def test_a_study_of_another_version_is_named(name, two, tmp_path):
    kept = changed(name, two, tmp_path)
    assert list(unread_studies(kept, ordered_studies(kept))) == ["theirs"]
