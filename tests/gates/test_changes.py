"""What other people's CI uses: summaries, baselines, differences."""

import json

import pytest
from conftest import SCENE, typed

from validation.errors import InputError
from validation.gates.changes import against, changes, markdown, read_verdicts, same_band

GATE = '[run]\nsolvers = ["dda", "bar"]\n[[gate]]\npair = ["dda", "bar"]\nmetric = "displacement.l2"\n'


def verdict(id, word, value=1.0, study="s"):
    return {"study": study, "id": id, "verdict": word, "value": value, "band": [0.0, 1.0], "reason": "a | b", "why": ""}


def write(path, *verdicts):
    path.write_text(json.dumps(verdicts))
    return path


@pytest.mark.parametrize(
    ("before", "after", "kind"),
    [
        ("PASS", "FAIL", "worse"),
        ("PASS", "NOT RUN", "worse"),
        ("NOT RUN", "FAIL", "worse"),
        ("PASS", None, "worse"),
        (None, "FAIL", "worse"),
        (None, "PASS", "new"),
        (None, "NOT RUN", "new"),
        ("FAIL", "PASS", "better"),
        ("FAIL", "NOT RUN", "better"),
        ("NOT RUN", "PASS", "better"),
        ("FAIL", None, "gone"),
    ],
)
def test_what_became_of_a_gate(before, after, kind):
    old, new = ([] if word is None else [verdict("a", word)] for word in (before, after))
    assert [change.kind for change in changes(old, new)] == [kind]


@pytest.mark.parametrize(
    ("band", "kind"),
    [
        ([-1e-3, 1.0], "worse"),  # lets pass what failed before, at either edge
        ([0.0, 1.001], "worse"),
        ([0.1, 0.9], "band"),
        ([0.0, 1 + 1e-9], None),  # the last digits are the processor's
    ],
)
def test_a_wider_band_is_worse_at_either_edge(band, kind):
    found = changes([verdict("a", "PASS")], [verdict("a", "PASS") | {"band": band}])
    assert [change.kind for change in found] == ([] if kind is None else [kind])
    assert same_band((0.0, 1e9), (0.0, 1e9 + 9)) and not same_band((0.0, 1e9), (0.0, 1e9 + 11))
    assert same_band(None, None) and not same_band(None, tuple(band)) and not same_band(tuple(band), None)


def test_a_summary_counts_and_tells_what_failed_and_what_changed():
    old = [verdict("a", "PASS"), verdict("c`", "PASS", "undefined"), verdict("g", "FAIL", study="t")]
    new = [
        verdict("a", "FAIL", 2.0),
        verdict("b", "NOT RUN", None, "t") | {"why": "missing"},
        verdict("c`", "PASS", "undefined") | {"band": [0.0, 0.5]},
    ]
    assert markdown(new, changes(old, new)).splitlines() == [
        "## dda-validation: 1 PASS, 1 FAIL, 1 NOT RUN", "",
        "| study | PASS | FAIL | NOT RUN |", "|---|---|---|---|", "| s | 1 | 1 | 0 |", "| t | 0 | 0 | 1 |", "",
        "### FAIL", "",
        "| gate | value | band | why |", "|---|---|---|---|", r"| `a` | 2 | 0 .. 1 | a \| b |", "",
        "### NOT RUN", "",
        "| gate | value | band | why |", "|---|---|---|---|", "| `b` | - | 0 .. 1 | missing |", "",
        "### Since the baseline", "",
        "| change | gate | verdict | value |", "|---|---|---|---|",
        "| worse | `a` | PASS → FAIL | 1 → 2 |",
        "| new | `b` | absent → NOT RUN | - |",
        "| gone | `g` | FAIL → absent | 1 → - |",
        "| band | `c'` | PASS | undefined; band 0 .. 1 → 0 .. 0.5 |",
    ]  # fmt: skip
    assert markdown(new[2:], []).splitlines()[-3:] == ["### Since the baseline", "", "Nothing changed."]
    assert "baseline" not in markdown(new)


def test_a_baseline_is_one_of_the_studies_that_were_run(tmp_path):
    old = [verdict("a", "PASS"), verdict("b", "PASS", study="t"), verdict("c", "FAIL", 3.0, "u")]
    assert against(old, [verdict("a", "PASS")]) == []
    assert [(c.kind, c.id) for c in against(old, [verdict("a", "PASS")], ("s", "t"))] == [("worse", "b")]
    path = write(tmp_path / "verdicts.json", old[0])
    assert read_verdicts(path) == read_verdicts(tmp_path)
    with pytest.raises(InputError) as error:
        read_verdicts(tmp_path / "no.json")
    assert error.value.source == tmp_path / "no.json"


def test_a_run_fails_only_on_what_got_worse_and_leaves_a_summary(scene_file, tmp_path):
    summary, base = tmp_path / "summary.md", tmp_path / "base.json"
    scene_file.write_text(SCENE + GATE + 'band = [0.0, 1e-3]\nreason = "too | tight"\n')
    options = ("--results", tmp_path / "r", "--summary", summary)
    assert typed("run", scene_file, *options).returncode == 1
    text = summary.read_text()
    assert text.startswith("## dda-validation: 0 PASS, 1 FAIL, 0 NOT RUN\n")
    assert "| `small:dda-bar:displacement.l2` |" in text and r"too \| tight" in text and "baseline" not in text
    base.write_bytes((tmp_path / "r/verdicts.json").read_bytes())
    done = typed("run", scene_file, *options, "--baseline", base)
    assert done.returncode == 0 and "PASS →" not in summary.read_text()
    write(base, json.loads(base.read_text())[0] | {"verdict": "PASS", "value": 0.0})
    done = typed("run", scene_file, *options, "--baseline", base)
    assert done.returncode == 1 and "1 worse" in done.stdout
    assert "| worse | `small:dda-bar:displacement.l2` | PASS → FAIL |" in summary.read_text()


def test_unreadable_verdicts_are_named(tmp_path):
    path = tmp_path / "verdicts.json"
    for text, rule in (("[", "JSON"), ('{"a": 1}', "list")):
        path.write_text(text)
        with pytest.raises(InputError, match=rule) as error:
            read_verdicts(tmp_path)
        assert error.value.source == path
