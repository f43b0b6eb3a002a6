"""Results that another version wrote cost their own chapter, not the report and not the gallery."""

import hashlib
import json

import pytest
from oracles.made_cases import kept_study
from oracles.made_results import made_rows

from validation.gates.gate import Gate, judge
from validation.report.book import ordered_studies, unread_studies
from validation.results import Results
from validation.scenes.scene import load_scene


def redefine(manifest):
    for case in manifest["cases"]:
        case["definition"]["future"] = {"key": 1}


UNREADABLE = {
    "manifest": ("studies/theirs.json", lambda manifest: manifest.update(cases=3)),
    "definition": ("studies/theirs.json", redefine),
    "outcome": ("rows.jsonl", lambda row: row.update(outcome="of the future")),
    "row": ("rows.jsonl", lambda row: row.pop("metrics")),
    "verdict": ("verdicts.json", lambda verdict: verdict.update(verdict="MAYBE")),
    "band": ("verdicts.json", lambda verdict: verdict.pop("band")),
    "history": ("histories/theirs dda.npz", None),
}


def rewrite(path, change):
    """Change the records of one study in a file of results."""
    text = path.read_text()
    lines = filter(None, text.splitlines()) if path.suffix == ".jsonl" else [text]
    written = [json.loads(line) for line in lines]
    for record in written[0] if isinstance(written[0], list) else written:
        if "theirs" in (record["study"], record.get("scene", "").partition("[")[0]):
            change(record)
        if record.pop("digest", None):
            record["digest"] = hashlib.sha256(json.dumps(record, sort_keys=True).encode()).hexdigest()[:16]
    path.write_text("\n".join(map(json.dumps, written)) + "\n")


@pytest.mark.parametrize("name", UNREADABLE)
def test_a_study_of_another_version_is_named(name, tmp_path):
    kept = Results(tmp_path)
    for study in ("mine", "theirs"):
        scene = load_scene("field-locked").model_copy(update={"name": study})
        kept_study(kept, made_rows(scene)[:1], study=study)
        gate = Gate(study, ("dda",), "displacement.static", -1.0, 0.0, "a test")
        kept.write_verdicts(study, [judge(gate, -0.01).record(study)])
    assert list(unread_studies(kept, ordered_studies(kept))) == []
    file, change = UNREADABLE[name]
    (tmp_path / file).unlink() if change is None else rewrite(tmp_path / file, change)
    again = Results(tmp_path)
    assert list(unread_studies(again, ordered_studies(again))) == ["theirs"]
