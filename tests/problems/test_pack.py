"""The problem pack: complete, and all that a stranger needs to answer a problem with the exact motion."""

import json
import shutil
from pathlib import Path

import pytest
from conftest import typed
from oracles.kept_answers import said
from oracles.stand_ins import assert_kept, summed

from validation.errors import InputError
from validation.problems import pack
from validation.problems.answers import read_sets
from validation.problems.data import PACK, AnswersData, ProblemData
from validation.problems.judge import judge
from validation.problems.problem import names
from validation.runs.defects import DefectsError

KEPT = Path(__file__).with_name("numbers.toml")
QUICK = ("locked", "rocking", "column")
BOXES = ("standing", "pile", "toppling-spin-0.95-of-critical")
FILLED = {"program": "Some code", "version": "1.0", "settings": "exact", "who": "somebody", "scheme": "s",
          "step_s": None, "contact_model": "c", "processor": "p", "licence": "CC0-1.0"}  # fmt: skip


@pytest.fixture(scope="module")
def written(tmp_path_factory):
    """Write the problems whose exact motions take no time."""
    directory = tmp_path_factory.mktemp("pack")
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(pack, "names", lambda: (*QUICK, *BOXES))
        told = []
        assert pack.write_pack(directory, lambda *x: told.append(x)) == 6
        assert told == [(number, 6, name) for number, name in enumerate((*QUICK, *BOXES))]
    return directory


def filled(problems, place, *names):
    """Fill in the folder of a pack, some problems with their own exact motions."""
    shutil.copytree(problems / "answers", place)
    stated = place / "submission.json"
    stated.write_text(json.dumps(json.loads(stated.read_text()) | FILLED))
    for name in names:
        shutil.copy(problems / "exact" / f"{name}.csv", place / f"{name}.csv")
    return place


def test_problems_are_answered_by_the_files_of_the_pack(written, tmp_path):
    ((answers),) = [one.answers for one in read_sets(filled(written, tmp_path / "mine", *QUICK))]
    assert {answer.name: judge(answer.problem, answer.history).verdict for answer in answers} == dict.fromkeys(
        sorted(QUICK, key=names().index), "PASS"
    )


def test_problems_say_what_they_are_judged_by(written):
    stated = {name: json.loads((written / f"{name}.json").read_text()) for name in (*QUICK, *BOXES)}
    assert_kept(KEPT, "pack", {name: summed(said(data, 0.0)) for name, data in stated.items()})


def test_schemas_and_the_page_are_those_of_the_pack(written):
    for schema, data in (("problem", ProblemData), ("answers", AnswersData)):
        assert data.model_json_schema().items() <= json.loads((written / f"{schema}.schema.json").read_text()).items()
    page = (written / "README.md").read_text()
    assert f"version {PACK};" in page and "`rotation_rad`" in page and "| `block.density_kg_per_m3` |" in page
    lines = [line.split("`")[1] for line in page.splitlines() if line.startswith("| `") and line.count("|") == 4]
    assert lines[-len(QUICK) - len(BOXES) :] == [*QUICK, *BOXES]


@pytest.fixture
def short_pack(monkeypatch):
    """Let export-pack write its mark only."""

    def write_mark(place, progress):
        (place / pack.MARK).write_text("{}")
        return 7

    monkeypatch.setattr(pack, "write_pack", write_mark)


@pytest.mark.usefixtures("short_pack")
def test_an_earlier_pack_is_replaced_as_a_whole_and_nothing_else(tmp_path):
    place = tmp_path / "pack"
    assert "7" in typed("export-pack", place).stdout.removeprefix(f"wrote {place}")
    (place / "old.csv").write_text("1")
    assert typed("export-pack", place).returncode == 0
    assert [path.name for path in place.iterdir()] == [pack.MARK]
    assert [path.name for path in tmp_path.iterdir()] == ["pack"]


def test_a_users_directory_is_not_written_to(tmp_path):
    (tmp_path / "README.md").write_text("# Mine\n")
    for place in (tmp_path, tmp_path / "README.md"):
        done = typed("export-pack", place)
        assert done.returncode == 2 and f"error: {place}: must be a" in done.stderr


def test_the_folder_for_all_problems_is_read_when_it_is_filled_in(written, tmp_path):
    place = tmp_path / "mine"
    shutil.copytree(written / "answers", place)
    with pytest.raises(DefectsError) as caught:
        read_sets(place)
    fields = {str(defect.field) for defect in caught.value.defects}
    assert fields == {name for name, blank in pack.ANSWERS_TEMPLATE.items() if blank} - {"settings_name"}
    blank = filled(written, tmp_path / "blank")
    with pytest.raises(InputError, match="table"):
        read_sets(blank)
    shutil.copy(written / "exact/rocking.csv", blank / "rocking.csv")
    ((answer,),) = [one.answers for one in read_sets(blank)]
    assert answer.name == "rocking"
