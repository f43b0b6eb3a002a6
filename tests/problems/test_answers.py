"""Folders of answers: read as a whole, every defect of all files listed at once, kept in their layout or refused."""

import csv
import json

import numpy as np
import pytest
from oracles.answers import QUICK, STATED, answered, stated

from validation.errors import InputError
from validation.models.plane.boxes import boxes_of
from validation.problems import packs
from validation.problems.answers import FILE, keep, read_sets, read_tables
from validation.problems.bands import standard
from validation.problems.data import PACK, folder_name
from validation.problems.pack import ANSWERS_TEMPLATE, blank_table, table_of
from validation.problems.problem import problem, problem_of
from validation.runs.defects import DefectsError
from validation.runs.history import History
from validation.scenes.scene import load_scene
from validation.suite.judging import judged_sets


def defects_of(root, **options):
    """Return the defects of a directory: the place, by the path below it, the field and the value."""
    with pytest.raises(InputError) as caught:
        read_sets(root, **options)
    defects = DefectsError.of(caught.value).defects
    assert not any("\n" in str(one) for one in defects)
    return [(str(one.source).removeprefix(f"{root}/"), one.field, one.value) for one in defects]


def names_of(sets):
    return [(one.data.settings_name, tuple(answer.name for answer in one.answers)) for one in sets]


def test_settings_of_a_program_are_read_with_their_problems_in_the_order_of_the_pack(tmp_path):
    answered(tmp_path / "coarse", settings_name="coarse", names=("column", "locked"))
    fine = answered(tmp_path / "fine", settings_name="fine", step_s={"rocking": 1e-3}, names=("rocking",))
    (fine / "locked.csv").write_text(blank_table(problem("locked")))  # as the pack has it: not answered
    (fine / "notes.txt").write_text("anything")
    told = []
    sets = read_sets(tmp_path, progress=lambda *done: told.append(done[:2]))
    assert told == [(0, 2), (1, 2)]
    assert names_of(sets) == [("coarse", ("locked", "column")), ("fine", ("rocking",))]
    assert [one.data.step_of("rocking") for one in sets] == [0.002, 1e-3]
    assert sets[1].data.step_of("locked") is None
    answered(tmp_path / "same", settings_name="fine", names=("locked",))
    assert [place for place, *_ in defects_of(tmp_path)] == [f"same/{FILE}"]


def test_a_column_that_is_not_reported_is_named_by_problem(tmp_path):
    answered(tmp_path, names=("locked",))
    rows = [line.rsplit(",", 1)[0] for line in (tmp_path / "locked.csv").read_text().splitlines()]
    (tmp_path / "locked.csv").write_text("\n".join(rows))
    ((place, field, _),) = defects_of(tmp_path)
    assert (place, field) == ("locked.csv:1:22", "header")
    (tmp_path / FILE).write_text(json.dumps(STATED | {"not_reported": {"locked": ["contact_pressure_Pa"]}}))
    ((answer,),) = [one.answers for one in read_sets(tmp_path)]
    assert list(answer.history.columns) == ["displacement"]


def test_an_answer_to_a_problem_that_changed_is_stale_and_the_others_stand(tmp_path, monkeypatch):
    now = packs.packs()[PACK]
    without = {name: digest for name, digest in now.items() if name != "column"}
    monkeypatch.setattr(packs, "packs", lambda: {"1.8": without, "1.9": now | {"locked": "0" * 16}, PACK: now})
    monkeypatch.setattr("validation.problems.answers.packs", packs.packs)
    answered(tmp_path, pack="1.9")
    (tmp_path / "locked.csv").write_text("what it asked then is not known")
    ((stale, *others),) = [one.answers for one in read_sets(tmp_path)]
    assert stale.name == "locked" and stale.history is None and "1.9" in stale.reason
    assert [answer.status for answer in others] == [None, None]
    ((asked,),) = [one.answers for one in read_sets(tmp_path, own={"locked": problem("locked")})]
    assert asked.reason == stale.reason
    early = answered(tmp_path / "early", pack="1.8")
    assert [(field, value) for _, field, value in defects_of(early)] == [("pack", "'1.8'")]  # without a column yet
    (early / "column.csv").write_text(blank_table(problem("column")))
    assert names_of(read_sets(early)) == [("default", ("locked", "rocking"))]


def spoilt(place, name, change):
    path = place / name
    path.write_text(change(path.read_text()))


def by_lines(change):
    return lambda text: "\n".join(change(text.splitlines()))


MISTAKES = {
    "not a number": (
        "locked.csv",
        by_lines(lambda lines: [*lines[:3], "0.006,nan,0", *lines[4:]]),
        ("locked.csv:4:7", "displacement_m", "nan"),
    ),
    "two words of one entry": (  # a comma after the last one is told at another place from Python 3.13 on
        FILE,
        lambda text: text.replace('"CC0-1.0"', '"CC0" "1.0"'),
        (f"{FILE}:13:19", None, None),
    ),
    "a table that is missing": (
        FILE,
        lambda text: text.replace("0.002", '{"spall": 0.002}'),
        (FILE, "step_s", "no such file"),
    ),
    "a problem that nobody asks": (
        FILE,
        lambda text: text.replace("0.002", '{"spal": 0.002}'),
        (FILE, "step_s", None),
    ),
}


@pytest.mark.parametrize("mistake", MISTAKES)
def test_a_mistake_is_named_with_its_place(mistake, tmp_path):
    file, change, defect = MISTAKES[mistake]
    answered(tmp_path, names=("locked",))
    spoilt(tmp_path, file, change)
    assert defect in defects_of(tmp_path)


def test_all_defects_of_all_files_are_listed_at_once(tmp_path):
    place = answered(tmp_path / "coarse", settings_name="coarse")
    other = answered(tmp_path / "fine", settings_name="fine", who=...)
    answered(tmp_path / "again", settings_name="coarse", names=("locked",))
    spoilt(place, "locked.csv", MISTAKES["not a number"][1])
    spoilt(place, "rocking.csv", lambda text: text.replace("rotation_rad", "rotation_turns"))
    (other / "Locked.csv").write_text("")
    (tmp_path / "forgotten").mkdir()
    (tmp_path / "forgotten" / "locked.csv").write_text("")
    expected = {"coarse/locked.csv:4:7", "coarse/rocking.csv:1:8", f"fine/{FILE}", "fine/Locked.csv"}
    found = [place for place, *_ in defects_of(tmp_path)]
    assert set(found) == expected | {f"forgotten/{FILE}"}
    assert len(found) == len(expected) + 1  # `again` is the same as `coarse` only where that can be read


def test_a_layout_is_where_its_metadata_say(tmp_path):
    answered(tmp_path / "bob-s-code-co/1.0/default", names=("locked",))
    assert len(read_sets(tmp_path, in_layout=True)) == 1
    answered(tmp_path / "bob-s-code-co/1.1/default", names=("locked",), version="1.2")
    ((place, *_),) = defects_of(tmp_path, in_layout=True)
    assert place == "bob-s-code-co/1.1/default"


@pytest.mark.parametrize(
    ("text", "name"), [("My Code 2", "my-code-2"), ("../x", "x"), ("C++", "c++"), ("\u7a0b\u5e8f", ""), ("..", "")]
)
def test_names_of_folders_lead_nowhere_else(text, name):
    assert folder_name(text) == name


def test_an_answer_is_kept_once_and_not_overwritten(tmp_path):
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
    with pytest.raises(InputError, match="another"):
        keep([*read_sets(tmp_path / "another"), *read_sets(mine)], layout)
    assert (place / "locked.csv").read_bytes() == kept
    assert [path.name for path in place.parent.iterdir()] == ["default"]  # neither is half of them written


Rows = list[list[str]]


def rows_of(name="locked"):
    return list(csv.reader(table_of(problem(name), standard(problem(name)).exact).splitlines()))


def text_of(rows, separator=","):
    return "\n".join(separator.join(row) for row in rows)


def scaled(column, factor):
    """Return a change that multiplies a column by a factor."""

    def change(rows):
        numbers = [[repr(float(x) * factor) if i == column else x for i, x in enumerate(row)] for row in rows[1:]]
        return [rows[0], *numbers]

    return change


@pytest.mark.parametrize(
    ("change", "place", "field", "value"),
    [
        (lambda r: [[*r[0][:2], "speed"], *r[1:]], ":1:28", "header", "time_s, displacement_m, speed"),
        (lambda r: [[*row, row[1]] for row in r], ":1:43", "header", None),
        (lambda r: r[1:], ":1:1", "header", "numbers"),
        (lambda r: [r[0], *([repr(float(row[0]) + 1e-3), *row[1:]] for row in r[1:])], ":2:1", "time", "0.003"),
        (lambda r: [r[0], ["0.002", "", "0"], *r[2:]], ":2:7", "displacement_m", "nothing"),
        (lambda r: [r[0], ["0.002", "1_0", "0"], *r[2:]], ":2:7", "displacement_m", "'1_0'"),
        (lambda r: [r[0], ["0.002", "1e400", "0"], *r[2:]], ":2:7", "displacement_m", "1e400"),
        (lambda r: [*r, *r[1:]], ":52:1", "time", "52 or more"),
        (lambda r: [r[0], *r[:0:-1]], ":2:1", "time", "0.1"),
        (lambda r: r[:-1], ":50:1", "time", "49"),
        (lambda r: [*r[:3], r[3][:2], *r[4:]], ":4:28", None, 2),
        (lambda r: [], "", None, "an empty file"),
        (scaled(1, 1e3), ":1:8", "displacement_m", None),
        (scaled(2, 1e-6), ":1:23", "contact_pressure_Pa", None),
        (scaled(2, 2.0), ":1:23", "contact_pressure_Pa", None),  # a force
        (scaled(1, -1.0), ":1:8", "displacement_m", None),
    ],
)
def test_a_wrong_table_is_named(change, place, field, value, tmp_path):
    (stated(tmp_path) / "locked.csv").write_text(text_of(change(rows_of())))
    assert defects_of(tmp_path)[0] == (f"locked.csv{place}", field, value)


def in_other_units(rows):
    """Return the table in milliseconds, millimetres and kilopascals, with an index and a column of another program."""
    factors = (1e3, 1e3, 1e-3)
    header = ["", "Time [ms]", "displacement_mm", "contact_pressure (kPa)", "energy"]
    body = [[str(i), *(repr(factors[j] * float(row[j])) for j in range(3)), "0"] for i, row in enumerate(rows[1:])]
    return text_of([header, *body])


def of_a_spreadsheet(rows):
    """Return a table as spreadsheets write it: a mark in front, CR LF, empty cells and rows at the ends."""
    return "\ufeff" + "\r\n".join(",".join([*row, "", ""]) for row in [*rows, ["", "", ""]])


def with_decimal_commas(rows):
    return text_of([rows[0], *([cell.replace(".", ",") for cell in row] for row in rows[1:])], ";")


def of_fortran(row):
    return [f"{float(cell):.17E}".replace("E", "D") for cell in row]


WRITTEN = {
    "of a spreadsheet": of_a_spreadsheet,
    "decimal commas": with_decimal_commas,
    "tabs": lambda rows: text_of(rows, "\t"),
    "blanks": lambda rows: text_of(rows, "  "),
    "quotes": lambda rows: text_of([[f'"{cell}"' for cell in row] for row in rows]),
    "comments": lambda rows: "# of my code\n" + text_of(rows) + "  % the end",
    "exponents of Fortran": lambda rows: text_of([rows[0], *map(of_fortran, rows[1:])]),
    "other names": lambda rows: text_of([["TIME", "Displacement", "contact_pressure"], *rows[1:]]),
    "other order": lambda rows: text_of([[row[2], row[0], row[1]] for row in rows]),
    "the state at t = 0": lambda rows: text_of([rows[0], ["0", "0", "0"], *rows[1:]]),
    "single precision": lambda rows: text_of([rows[0], *([repr(float(np.float32(r[0]))), *r[1:]] for r in rows[1:])]),
    "other units": in_other_units,
}  # fmt: skip


@pytest.mark.parametrize("written", WRITTEN)
def test_what_other_programs_write_is_read(written, tmp_path):
    exact = standard(problem("locked")).exact
    (stated(tmp_path) / "locked.csv").write_text(WRITTEN[written](rows_of()), encoding="utf-8", newline="")
    (tmp_path / "._locked.csv").write_bytes(b"\0")  # which a system lays beside a file
    ((answer,),) = [one.answers for one in read_sets(tmp_path)]
    np.testing.assert_array_equal(answer.history.time, exact.time)
    for name, values in exact.columns.items():
        np.testing.assert_allclose(answer.history.columns[name], values, rtol=1e-14)


@pytest.mark.parametrize(
    ("fields", "field", "value"),
    [
        ({"pack": "99.0"}, "pack", "'99.0'"),
        ({"pack": ...}, "pack", "nothing"),
        ({"settings": ANSWERS_TEMPLATE["settings"]}, "settings", ANSWERS_TEMPLATE["settings"]),
        ({"wo": "x"}, "wo", "'x'"),
        ({"program": " "}, "program", "' '"),
        ({"program": "\u7a0b"}, "program", "'\u7a0b'"),
        ({"who": 2001 * "x"}, "who", 2001 * "x"),
        ({"settings_name": 61 * "x"}, "settings_name", 61 * "x"),
        ({"step_s": "0.002"}, "step_s", "'0.002'"),
        ({"not_reported": {"locked": ["pressure"]}}, "not_reported.locked", "'pressure'"),
        ({"not_reported": {"locked": "pressure"}}, "not_reported.locked", "'pressure'"),
        (
            {"not_reported": {"locked": ["displacement_m", "contact_pressure_Pa"]}},
            "not_reported.locked",
            "all of displacement_m, contact_pressure_Pa",
        ),
    ],
)
def test_a_wrong_field_is_named(fields, field, value, tmp_path):
    ((place, found, shown),) = defects_of(answered(tmp_path, names=("locked",), **fields))
    assert (place, found) == (FILE, field)
    assert shown.strip("'")[:50] == value.strip("'")[:50]


@pytest.mark.parametrize(
    ("content", "defect"),
    [
        ("[1]", (FILE, None, "list")),
        ("{", (f"{FILE}:1:2", None, None)),
        (json.dumps(STATED).replace('{"format"', '{"pack": "1.0", "format"'), (FILE, "pack", None)),
    ],
)
def test_files_that_are_no_such_files(content, defect, tmp_path):
    (answered(tmp_path, names=("locked",)) / FILE).write_text(content)
    assert defect in defects_of(tmp_path)


def test_tables_alone_answer_problems_and_scenes_of_ones_own(tmp_path):
    scene = load_scene("field-locked").with_values({"contact.stiffness": 2e9}).model_copy(update={"name": "mine"})
    own = problem_of(scene)
    (tmp_path / "mine.csv").write_text(table_of(own, standard(own).exact))
    (tmp_path / "locked.csv").write_text(text_of(rows_of()))
    answers = read_tables(tmp_path, [problem("locked"), problem("opening"), own]).answers
    assert [answer.name for answer in answers] == ["locked", "mine"]
    (tmp_path / "opening.csv").write_text("")
    with pytest.raises(DefectsError):
        read_tables(tmp_path, [problem("locked"), problem("opening")])
    (tmp_path / "opening.csv").unlink()
    assert read_tables(tmp_path / "mine.csv", [own]).answers[0].problem is own
    stated(tmp_path)
    ((answer, _),) = [one.answers for one in read_sets(tmp_path, own={"locked": problem("locked"), "mine": own})]
    assert answer.problem is problem("locked")
    with pytest.raises(InputError) as caught:
        read_tables(tmp_path / "mine.csv", [own, problem("locked")])
    assert caught.value.field == "asked"


POSE = ("x", "y", "angle")


def boxes_answered(place, name, unit=1.0):
    """Answer a problem of boxes with boxes that stay where they are."""
    asked = problem(name)
    poses = {f"{box.name}.{part}": getattr(box, part) for box in boxes_of(asked.scene).boxes for part in POSE}
    columns = {c: np.full(len(asked.instants), unit * poses[c]) for c in asked.columns}
    (place / f"{name}.csv").write_text(table_of(asked, History(asked.instants, columns)))


def test_positions_of_boxes_are_measured(tmp_path):
    place = answered(tmp_path, names=())
    for name in ("standing", "standing-friction-19-deg", "pile"):
        boxes_answered(place, name)
    told = []
    (judged,) = judged_sets(read_sets(place), lambda *given: told.append(given[:2]))
    assert told == [(0, 3), (1, 3), (2, 3)]
    judged = {one.name: one for one in judged.answers}
    words = {name: str(one.judgement.status) for name, one in judged.items()}
    assert words == {"standing": "PASS", "standing-friction-19-deg": "FAIL", "pile": "PASS"}
    # Forces are not asked: what is measured on them alone is not among the numbers.
    assert len(judged["pile"].judgement.criteria) == 2
    assert "slid" in judged["standing-friction-19-deg"].judgement.deciding.name
    boxes_answered(place, "standing", 1e3)
    assert [field for _, field, _ in defects_of(place)] == ["box.y_m"]
