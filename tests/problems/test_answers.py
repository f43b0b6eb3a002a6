"""Folders of answers: read as a whole, every defect of all files listed at once, kept in their layout or refused."""

from __future__ import annotations

import json
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from oracles.answers import QUICK, STATED, answered
from oracles.submissions import submitted

from validation.cli.judging import judged_sets
from validation.errors import InputError
from validation.problems import packs
from validation.problems.answers import AnswerSet, folder_name, keep, read_sets
from validation.problems.data import PACK
from validation.problems.defects import DefectsError
from validation.problems.pack import blank_table, table_of
from validation.problems.problem import problem
from validation.problems.questions import question
from validation.problems.submission import FILE, read_submission
from validation.runs.history import History
from validation.scenes.rigid import POSE


def defects_of(root: Path, **options: Any) -> list[str]:
    """Return the defects of a directory, by the path below it."""
    with pytest.raises(InputError) as caught:
        read_sets(root, **options)
    return [str(one).replace(f"{root}/", "") for one in DefectsError.of(caught.value).defects]


def names_of(sets: list[AnswerSet]) -> list[tuple[str, tuple[str, ...]]]:
    return [(one.settings_name, tuple(answer.name for answer in one.answers)) for one in sets]


# ---- what is read ---------------------------------------------------------------------------------------------------


def test_settings_of_a_program_are_read_with_their_problems_in_the_order_of_the_pack(tmp_path: Path) -> None:
    answered(tmp_path / "coarse", settings_name="coarse", names=("column", "locked"))
    fine = answered(tmp_path / "fine", settings_name="fine", step_s={"rocking": 1e-3}, names=("rocking",))
    (fine / "locked.csv").write_text(blank_table(problem("locked")))  # as the pack has it: not answered
    (fine / "notes.txt").write_text("anything")
    sets = read_sets(tmp_path)
    assert names_of(sets) == [("coarse", ("locked", "column")), ("fine", ("rocking",))]
    assert [one.data.step_of("rocking") for one in sets] == [0.002, 1e-3]
    assert sets[1].data.step_of("locked") is None


def test_problems_that_the_stated_pack_did_not_have_are_one_defect(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    now = packs.packs()[PACK]
    earlier = {name: digest for name, digest in now.items() if name not in ("column", "rocking")}
    monkeypatch.setattr(packs, "packs", lambda: {"1.9": earlier, PACK: now})
    for module in ("answers", "submission"):
        monkeypatch.setattr(f"validation.problems.{module}.packs", packs.packs)
    answered(tmp_path, pack="1.9", names=("locked", "column", "rocking"))
    (tmp_path / "creep.csv").write_text(blank_table(problem("creep")))
    (line,) = defects_of(tmp_path)
    assert f"{FILE}:3:10: pack: must be {PACK}, from which on the pack holds column.csv and 1 more" in line


def test_a_column_that_is_not_reported_is_named_by_problem(tmp_path: Path) -> None:
    answered(tmp_path, names=("locked",))
    rows = [line.rsplit(",", 1)[0] for line in (tmp_path / "locked.csv").read_text().splitlines()]
    (tmp_path / "locked.csv").write_text("\n".join(rows))
    (line,) = defects_of(tmp_path)
    assert line.startswith("locked.csv:1:22: header: contact_pressure_Pa is required")
    (tmp_path / FILE).write_text(json.dumps(STATED | {"not_reported": {"locked": ["contact_pressure_Pa"]}}))
    ((answer,),) = [one.answers for one in read_sets(tmp_path)]
    assert answer.withheld == ("contact_pressure_Pa",) and list(answer.history.columns) == ["displacement"]


def test_an_answer_to_a_problem_that_changed_is_stale_and_the_others_stand(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    now = packs.packs()[PACK]
    monkeypatch.setattr(packs, "packs", lambda: {"1.9": now | {"locked": "0" * 16}, PACK: now})
    monkeypatch.setattr("validation.problems.answers.packs", packs.packs)
    monkeypatch.setattr("validation.problems.submission.packs", packs.packs)
    answered(tmp_path, pack="1.9")
    (tmp_path / "locked.csv").write_text("what it asked then is not known")
    ((stale, *others),) = [one.answers for one in read_sets(tmp_path)]
    assert stale.name == "locked" and stale.history is None and "it answers pack 1.9" in str(stale.stale)
    assert [answer.stale for answer in others] == [None, None]


# ---- what is refused ------------------------------------------------------------------------------------------------


def spoilt(place: Path, name: str, change: Callable[[str], str]) -> None:
    path = place / name
    path.write_text(change(path.read_text()))


def by_lines(change: Callable[[list[str]], list[str]]) -> Callable[[str], str]:
    return lambda text: "\n".join(change(text.splitlines()))


MISTAKES: dict[str, tuple[str, Callable[[str], str], str]] = {
    "decimal commas": (
        "locked.csv",
        by_lines(lambda lines: [lines[0], *(line.replace(".", ",") for line in lines[1:])]),
        "must have 3 cells, got 6; a decimal comma?; and in 49 more places",
    ),
    "not a number": (
        "locked.csv",
        by_lines(lambda lines: [*lines[:3], "0.006,nan,0", *lines[4:]]),
        "locked.csv:4:7: displacement_m: must be a finite number, got nan",
    ),
    "a number as text": (
        FILE,
        lambda text: text.replace("0.002", '"0.002"'),
        f"{FILE}:9:12: step_s: must be a positive number [s], an object of such numbers by problem, or null",
    ),
    "a comma after the last entry": (
        FILE,
        lambda text: text.replace('"CC0-1.0"', '"CC0-1.0",'),
        f"{FILE}:14:1: must be JSON: ",
    ),
    "an unknown problem": (
        FILE,
        lambda text: text.replace('"CC0-1.0"', '"CC0-1.0",\n "not_reported": {"lokced": []}'),
        f"{FILE}:14:19: not_reported: lokced: must be among ",
    ),
    "a table that is missing": (
        FILE,
        lambda text: text.replace("0.002", '{"spall": 0.002}'),
        f"{FILE}:9:13: step_s: spall: must have a table spall.csv, got no such file",
    ),
}


@pytest.mark.parametrize("mistake", MISTAKES)
def test_a_mistake_is_named_with_line_and_character(mistake: str, tmp_path: Path) -> None:
    file, change, said = MISTAKES[mistake]
    answered(tmp_path, names=("locked",))
    read_sets(tmp_path)
    spoilt(tmp_path, file, change)
    lines = defects_of(tmp_path)
    assert any(said in line for line in lines), lines
    assert all("\n" not in line for line in lines)


@pytest.mark.parametrize(("field", "value"), [("pack", 3.0), ("step_s", []), ("link", 7), ("program", "")])
def test_a_field_with_one_mistake_has_one_line(field: str, value: object, tmp_path: Path) -> None:
    (line,) = defects_of(answered(tmp_path, names=("locked",), **{field: value}))
    assert f": {field}: must " in line


def test_all_defects_of_all_files_are_listed_at_once(tmp_path: Path) -> None:
    place = answered(tmp_path / "coarse", settings_name="coarse")
    other = answered(tmp_path / "fine", settings_name="fine", who=...)
    answered(tmp_path / "again", settings_name="coarse", names=("locked",))
    spoilt(place, "locked.csv", MISTAKES["not a number"][1])
    spoilt(place, "rocking.csv", lambda text: text.replace("rotation_rad", "rotation_deg"))
    (other / "Locked.csv").write_text("")
    (tmp_path / "forgotten").mkdir()
    (tmp_path / "forgotten" / "locked.csv").write_text("")
    lines = defects_of(tmp_path)
    starts = ("coarse/locked.csv:4:7", "coarse/rocking.csv:1:8", f"fine/{FILE}:1:1: who", "fine/Locked.csv: ")
    for start in (*starts, f"forgotten/{FILE}: is required"):
        assert sum(line.startswith(start) for line in lines) == 1, (start, lines)
    assert len(lines) == len(starts) + 1  # `again` is the same as `coarse` only where that can be read
    for path in (place, other, tmp_path / "forgotten"):
        for file in path.iterdir():
            file.unlink()
        path.rmdir()
    answered(tmp_path / "coarse", settings_name="coarse", names=("locked",))
    (line,) = defects_of(tmp_path)
    assert line.startswith(f"coarse/{FILE}: must have another settings_name")


@pytest.mark.parametrize("written", ["\ufeff{}", "\r\n", ",,\n", '"'])
def test_what_spreadsheets_write_is_read(written: str, tmp_path: Path) -> None:
    answered(tmp_path, names=("locked",))
    text = (tmp_path / "locked.csv").read_text()
    if written == "\ufeff{}":
        text = written.format(text)
    elif written == '"':
        text = "\n".join(",".join(f'"{cell}"' for cell in line.split(",")) for line in text.splitlines())
    else:
        text = text.replace("\n", written)
    (tmp_path / "locked.csv").write_text(text, encoding="utf-8", newline="")
    assert names_of(read_sets(tmp_path)) == [("default", ("locked",))]


def test_a_layout_is_where_its_metadata_say(tmp_path: Path) -> None:
    answered(tmp_path / "bob-s-code-co/1.0/default", names=("locked",))
    assert len(read_sets(tmp_path, in_layout=True)) == 1
    answered(tmp_path / "bob-s-code-co/1.1/default", names=("locked",), version="1.2")
    (line,) = defects_of(tmp_path, in_layout=True)
    assert line.startswith("bob-s-code-co/1.1/default: must lie in bob-s-code-co/1.2/default")


@pytest.mark.parametrize(
    ("text", "name"), [("My Code 2", "my-code-2"), ("../x", "x"), ("C++", "c++"), ("\u7a0b\u5e8f", ""), ("..", "")]
)
def test_names_of_folders_lead_nowhere_else(text: str, name: str) -> None:
    assert folder_name(text) == name


# ---- what is kept ---------------------------------------------------------------------------------------------------


def test_an_answer_is_kept_once_and_not_overwritten(tmp_path: Path) -> None:
    layout = tmp_path / "submissions"
    mine = answered(tmp_path / "mine", names=QUICK[:1])
    (mine / "judged.html").write_text("a page")
    (place,) = keep(read_sets(mine), layout)
    assert place == layout / "bob-s-code-co/1.0/default"
    assert sorted(path.name for path in place.iterdir()) == ["locked.csv", FILE]
    assert keep(read_sets(mine), layout) == [place]  # the same once more
    kept = (place / "locked.csv").read_bytes()
    answered(tmp_path / "another", settings_name="another", names=QUICK[:1])
    answered(mine, factor=1.02, names=QUICK[:1])
    with pytest.raises(InputError, match="holds another answer, which is not overwritten"):
        keep([*read_sets(tmp_path / "another"), *read_sets(mine)], layout)
    assert (place / "locked.csv").read_bytes() == kept
    assert [path.name for path in place.parent.iterdir()] == ["default"]  # neither is half of them written


# ---- rigid boxes ----------------------------------------------------------------------------------------------------


def boxes_answered(place: Path, name: str, **changed: float) -> None:
    """Answer a problem of rigid boxes with boxes that stay where they are, columns times factors."""
    asked = question(name)
    starts = asked.scene.rigid.starts
    poses = {f"{part}_{n}": x for n, start in enumerate(starts, start=1) for part, x in zip(POSE, start, strict=True)}
    columns = {c: np.full(len(asked.instants), changed.get(c, 1.0) * poses[c]) for c in asked.columns}
    (place / f"{name}.csv").write_text(table_of(History(asked.instants, columns), asked.columns))


def test_positions_of_boxes_are_measured(tmp_path: Path) -> None:
    place = answered(tmp_path, names=())
    for name in ("standing", "standing-friction-19-deg", "pile"):
        boxes_answered(place, name)
    (judged,) = judged_sets(read_sets(place), lambda *given: None)
    words = {name: str(one.word) for name, one in judged.judged.items()}
    assert words == {"standing": "PASS", "standing-friction-19-deg": "FAIL", "pile": "PASS"}
    # Forces are not asked: what is measured on them alone is not among the numbers.
    assert [number.quantity.name for number in judged.judged["pile"].numbers] == [
        "drift of the top",
        "sinking of the top",
    ]
    assert judged.judged["standing-friction-19-deg"].deciding.quantity.name == "distance slid"


def test_heights_in_millimetres_are_named(tmp_path: Path) -> None:
    boxes_answered(answered(tmp_path, names=()), "pile", y_3=1e3)
    (line,) = defects_of(tmp_path)
    assert "pile.csv:1:" in line and "y_3_m: wrong units: it begins with 1000 times what is expected in SI, mm?" in line


def test_boxes_are_no_submission_of_one_problem(tmp_path: Path) -> None:
    (line,) = [str(one) for one in DefectsError.of(_refused(submitted(tmp_path, "", problem="standing"))).defects]
    assert "problem: is answered in a folder of answers" in line


def _refused(place: Path) -> InputError:
    with pytest.raises(InputError) as caught:
        read_submission(place)
    return caught.value
