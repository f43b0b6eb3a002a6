"""What is kept and told of runs: results directories, contacts, columns, names, texts, files and what is absent."""

import fcntl
import itertools
import os
import platform
import stat
import tempfile
from dataclasses import replace
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest
from oracles.made_cases import made_history, made_row
from oracles.stand_ins import numbers_in, summed

from validation.errors import InputError
from validation.runs import columns, extras, files, provenance, strict, tables, text, units
from validation.runs.case_name import CaseName, scene_of
from validation.runs.defects import Defects, DefectsError, Place
from validation.runs.modes import Mode
from validation.runs.regular import kind_of, regular
from validation.runs.results import Results
from validation.runs.run import Outcome, Run

ROOT = Path(__file__).parents[2]
needs_proc = pytest.mark.skipif(not Path("/proc/cpuinfo").exists(), reason="looks at /proc")


def refusal(ask, *given):
    with pytest.raises(InputError) as error:
        ask(*given)
    return error.value.rule


def verdict(study, name):
    words = dict.fromkeys(("scene", "metric", "reason", "why", "reference_kind"), "w")
    numbers = {"value": 1.5, "band": [1.0, 2.0], "reference_uncertainty": 0.0}
    return words | numbers | {"study": study, "id": name, "verdict": "PASS", "pair": [], "alarms": []}


def test_rows_and_histories_are_kept_whole_and_what_is_lost_is_named(tmp_path):
    results = Results(tmp_path)
    row = made_row("dda")
    finer = made_history(0.05, [0.5, 1.0, 2.5, 3.0])
    results.append(row, replace(made_history(0.1, [1.0, 3.0], [7.0, 9.0]), between=finer))
    (kept,) = results.rows().values()
    assert (kept.steps, kept.columns) == (2, ("displacement", "contact_pressure"))
    history = results.history(row.key)
    assert history.between.time.tolist() == finer.time.tolist() and history.displacement.tolist() == [1.0, 3.0]
    assert history.between.displacement.tolist() == [0.5, 1.0, 2.5, 3.0]
    asked = (2, ["contact_pressure"]), (3, []), (2, ["rotation"])
    assert [results.sound(kept, *one) for one in asked] == [True, False, False]
    assert results.history("none") is None and results.sound(replace(kept, outcome=Outcome.RAISED), 9, ["x"])
    cases = [{"scene": "s", "solver": "dda", "key": row.key, "title": "", "definition": {}}]
    results.write_json("studies/made.json", {"study": "made", "cases": cases})
    assert results.studies() == ["made"] and results.manifest("other") == {"study": "other"}
    assert results.whole("made", histories=True)["cases"] == cases
    results.append(replace(row, steps=3), None)
    assert results.whole("made") and "columns" in refusal(results.whole, "made", True)
    results.append(replace(kept, steps=300), None)
    assert "steps" in refusal(results.whole, "made", True)
    results.append(kept, None)
    (tmp_path / "histories" / f"{row.key}.npz").unlink()
    assert results.whole("made") and refusal(results.whole, "made", True).startswith("the history of s dda")
    assert not results.sound(kept, 2, [])
    (tmp_path / "rows.jsonl").write_text("")
    assert refusal(results.whole, "made").startswith("the row of s dda")
    results.append(row, made_history(0.1, np.ones(400)))  # whose size is far from that of so few steps
    assert results.whole("made", histories=True)
    (tmp_path / "file").touch()
    assert refusal(Results(tmp_path / "file").check) == "must be a directory"


def test_verdicts_of_a_study_take_the_place_of_its_own(tmp_path):
    results = Results(tmp_path)
    for study, names in (("b", "yx"), ("a", "z"), ("c", "u"), ("b", "w")):
        results.write_verdicts(study, [verdict(study, name) for name in names])
    assert [(one["study"], one["id"]) for one in results.verdicts()] == [("a", "z"), ("b", "w"), ("c", "u")]
    assert [one["id"] for one in results.verdicts("b")] == ["w"] and results.unread_verdicts() == {}
    results.write_verdicts("a", [verdict("a", "z") | {"band": [2.0, 1.0]}])
    assert [*results.unread_verdicts()] == ["a"] and len(results.readable_verdicts()) == 2
    assert "low <= high" in refusal(results.verdicts)
    results.write_verdicts("a", [verdict("a", "z")])
    assert len(results.verdicts()) == 3
    with results._locked(), open(tmp_path / ".lock") as other, pytest.raises(BlockingIOError):
        fcntl.flock(other, fcntl.LOCK_EX | fcntl.LOCK_NB)


def test_columns_have_units_words_and_an_order():
    own = {"x": columns.ColumnKind("mm", "m", "Place of box {n}"), "force": columns.ColumnKind("N", "m")}
    names = ["slip_2", "other", "rotation", "displacement_11", "displacement", "force_3", "displacement_2"]
    assert sorted(names, key=columns.rank) == [names[k] for k in (4, 2, 6, 3, 5, 0, 1)]
    units = [
        columns.unit_of(name, own) for name in ("force_1", "x", "x_1", "velocity_3", "rotation", "rotation_1", "y")
    ]
    assert units == ["N", "mm", "mm", "m/s", "rad", "", ""] and columns.unit_of("force_1") == "Pa"
    assert columns.axis_of("x_7", own) == ("Place of box 7", "mm") and columns.axis_of("contact_pressure")[1] == "Pa"
    assert columns.axis_of("gap_2") == ("Gap 2", "m") and columns.split("a_b") == ("a_b", "")


def test_headers_are_recognised_with_their_units():
    known = {"displacement": "m", "time": "s"}
    headers = ("displacement", "Displacement_mm", "displacement [cm]", "displacement_MM", "time_ms", "time_mm", "place")
    found = [units.recognised(header, known) for header in headers]
    assert [one and one[0] for one in found] == [*3 * ["displacement"], None, "time", None, None]
    assert [one[1] for one in found if one] == pytest.approx([1.0, 1e-3, 1e-2, 1e-3])
    assert summed(numbers_in(units.OTHERS)) == pytest.approx(653.37079974, abs=1e-6)


def test_samples_of_a_damped_motion_show_its_alias():
    for xi, is_beyond in ((0.4, True), (0.75, False)):
        decay, turn = 10 * xi, 10 * np.sqrt(1 - xi**2)
        root = np.exp(0.4 * complex(-decay, turn))
        mode = Mode(10.0, 1.0, (root, root.conjugate()), sampled=True)
        folded = pytest.approx(np.hypot(decay, 5 * np.pi - turn))
        assert mode.alias(0.4) == (folded if is_beyond else None)
    assert replace(mode, eigenvalues=(0.0, 0.5)).alias(0.4) is None


def test_names_of_cases_are_taken_apart_as_they_are_put_together():
    for name in ("scene", "odd[name]", "a[time.step=0.1,load.pressure=5,000]", "b[x=1]"):
        assert str(CaseName.parse(name)) == name
    assert CaseName.parse("a[time.step=0.1,load.p=5,000]").values == {"time.step": "0.1", "load.p": "5,000"}
    assert scene_of("b[x=1]") == "b"


def test_json_is_strict(tmp_path):
    limit = 2**63
    assert strict.loads(f"[{limit}, -1.5e3]") == [limit, -1500.0]
    for refused in ("NaN", "1e999", str(limit + 1), "9" * 21, "[" * 100_000):
        with pytest.raises(ValueError, match=r"number|nested"):
            strict.loads(refused)
    assert strict.defect_of({"a": 1}, dict[str, str]).startswith("a: inp") and strict.defect_of([1], list[int]) is None
    (tmp_path / "bytes").write_bytes(b"\xff")
    assert refusal(strict.read, tmp_path / "bytes", list, "") == "must be UTF-8 text"
    assert refusal(regular, tmp_path / "bytes", 0.5) == "must be at most 0 bytes"
    assert regular(tmp_path / "bytes", 1) is None


def test_defects_that_repeat_are_one_with_the_number_of_places():
    defects, path = Defects(), Path("a.csv")
    for line in (1, 2, 3):
        defects.add(Place(path, line), "must be so", field="x", value=line)
    defects.add(Place(path, 4), "must be so", field="y", advice="do it")
    defects.take(InputError("must", source=Place(Path("b.csv")), field="z"))
    assert len(defects) == 3 and defects.has(path, "y") and not defects.has(path, "z")
    with pytest.raises(DefectsError) as error:
        defects.check()
    first, second, _ = error.value.defects
    assert (first.value, first.advice, second.advice) == (1, "and in 2 more places", "do it")
    assert (error.value.field, error.value.advice) == ("x", "and in 2 more places (and 2 more)")
    assert str(Place(path).at(3, 7)) == "a.csv:3:7" and len(DefectsError.of(error.value).defects) == 3
    Defects().check()


def test_absent_libraries_are_named_with_their_extras():
    assert extras.is_installed("numpy") and not extras.is_installed("no_such_library") and not extras.is_installed("..")
    assert extras.missing("numpy") is None and extras.missing("json") is None
    assert extras.sentence("flint").startswith("needs python-flint, not installed: ") and "[exact]" in extras.sentence(
        "flint"
    )
    three = extras.sentence("typst", "flint", "jinja2")
    assert "typst, python-flint and jinja2" in three and "[report,exact]" in three


def written(path):
    with files.atomic_path(path) as temporary:
        temporary.write_text("x")


@needs_proc
def test_files_appear_whole_or_not_at_all(tmp_path, monkeypatch):
    path = tmp_path / "a.txt"
    path.write_text("old")
    with pytest.raises(ZeroDivisionError), files.atomic_path(path) as temporary:
        temporary.write_text("new")
        raise ZeroDivisionError
    assert path.read_text() == "old" and os.listdir(tmp_path) == ["a.txt"]
    (tmp_path / "link").symlink_to("a.txt")
    os.mkfifo(tmp_path / "pipe")
    with files.atomic_path(tmp_path / "link") as temporary:
        temporary.write_text("new")
    assert path.read_text() == "new" and (tmp_path / "link").is_symlink()
    assert stat.S_IMODE(path.stat().st_mode) == 0o666 & ~os.umask(os.umask(0o22))
    assert files.check_output(tmp_path / "link") == path and files.check_output(tmp_path / "pipe").is_fifo()
    (tmp_path / "self").symlink_to("self")
    for wrong in (tmp_path, tmp_path / "none/b", tmp_path / "self", Path("a\0")):
        assert refusal(files.check_output, wrong)
    monkeypatch.setattr(tempfile, "tempdir", str(tmp_path / "temporary"))
    Path(tempfile.tempdir).mkdir()
    with path.open("w") as stream, files.atomic_path(Path(f"/proc/self/fd/{stream.fileno()}")) as temporary:
        temporary.write_text("streamed")
    assert path.read_text() == "streamed" and os.listdir(tempfile.tempdir) == []
    with path.open() as stream:
        assert files._is_stream(Path(f"/proc/self/fd/{stream.fileno()}")) and not files._is_stream(path)
    assert "reads" in refusal(written, tmp_path / "pipe")
    kinds = [kind_of(one.stat().st_mode) for one in (path, tmp_path, tmp_path / "pipe", Path("/dev/null"))]
    assert kinds == ["a file", "a directory", "a pipe", "a device"]


def test_directories_take_their_place_whole(tmp_path):
    place = tmp_path / "deep" / "out"
    for name in ("first", "second"):
        with files.atomic_directory(place) as new:
            (new / name).touch()
        assert os.listdir(place) == [name] and os.listdir(place.parent) == ["out"]
    with pytest.raises(InputError), files.atomic_directory(place) as new:
        (new / "third").touch()
        new.rename(tmp_path / "away")  # so that it cannot take its place
    assert os.listdir(place) == ["second"] and os.listdir(place.parent) == ["out"]
    with pytest.raises(InputError) as error, files.atomic_directory(place / "second"):
        pass
    assert (error.value.rule, error.value.value) == ("must be a directory", "a file")


UNREADABLE = [  # bytes of a table, and where and what the first one is that is no text
    (b"time,x\n0,1\n0,\xe9\n", "3:3", "0xe9", None),
    (b"\xff\xfet\0i\0m\0e\0", "1:1", "0xff", "it is UTF-16; save it as UTF-8"),
]


def test_cells_are_found_with_their_places():
    rows = tables.rows_of('time , "x ""2"" "," , 3"\n\n1;"2";;\n  4   5\n" 6 ",""\n7 "\n8', 5)
    assert [[cell.text for cell in row] for row in rows] == [
        ["time", 'x "2"', ", 3"],
        ["1", "2"],
        ["4", "5"],
        ["6"],
        ["7", '"'],
    ]
    assert [(cell.line, cell.column) for row in rows for cell in row] == [
        *((1, 1), (1, 8), (1, 19)),
        *((3, 1), (3, 3)),
        *((4, 3), (4, 7)),
        *((5, 1), (6, 1), (6, 3)),
    ]


def test_bytes_that_are_no_text_have_a_place(tmp_path):
    assert text.shown("\x1bé\u00a0") == "\\x1bé\u00a0"
    path = tmp_path / "t.csv"
    for content, place, value, advice in UNREADABLE:
        path.write_bytes(content)
        with pytest.raises(InputError) as error:
            tables.read_text(path)
        assert str(error.value.source) == f"{path}:{place}"
        assert (error.value.advice, value in str(error.value.value)) == (advice, True)
    path.write_text("place,x\n0,1\n")
    assert "begin with time" in refusal(files.read_table, path)
    assert refusal(files.read_table, tmp_path / "none") == "cannot be read: No such file or directory"
    (tmp_path / ".lock").mkdir()
    assert refusal(Results(tmp_path).write_verdicts, "a", [])
    assert refusal(Results(path / "below").write_json, "a.json", {}).startswith("cannot be made: ")


@needs_proc
def test_where_results_come_from(monkeypatch):
    lines = Path("/proc/cpuinfo").read_text().splitlines()
    named = [line.partition(":")[2].strip() for line in lines if line.startswith("model name")]
    assert provenance._processor() == [*named, platform.machine()][0]

    with monkeypatch.context() as patch:
        for top, described, commit in (
            (ROOT, "abc+", "abc+"),
            (ROOT, None, "unknown (no commit yet)"),
            (ROOT / "validation", "abc", "unknown (not a git checkout)"),
        ):
            told = {"rev-parse": str(top), "describe": described or ""}
            said = {word: SimpleNamespace(stdout=text) for word, text in told.items()}
            patch.setattr(provenance.subprocess, "run", lambda words, said=said, **given: said[words[1]])
            assert provenance._commit() == commit

    def absent(*given, **more):
        raise OSError

    monkeypatch.setattr(Path, "read_text", absent)
    monkeypatch.setattr(platform, "processor", lambda: "a processor")
    assert provenance._processor() == "a processor"
    assert provenance._version("no-such-package") == "not installed"
    sound = SimpleNamespace(stdout=" said\n")
    environments = []
    monkeypatch.setenv("GIT_DIR", "elsewhere")
    monkeypatch.setattr(provenance.subprocess, "run", lambda *given, env, **more: environments.append(env) or sound)
    assert provenance._git("status") == "said" and "PATH" in environments[0] and "GIT_DIR" not in environments[0]
    monkeypatch.setattr(provenance.subprocess, "run", absent)
    assert provenance._git("status") is None and provenance._commit() == "unknown (not a git checkout)"
    assert not provenance._is_source_root(Path("nowhere"))


def test_a_run_without_a_history_has_no_columns():
    history = made_history(0.1, [1.0, 3.0], [7.0, 9.0])
    run = Run(Outcome.COMPLETED, history)
    assert [values.tolist() for values in (run.displacement, run.contact_pressure)] == [[1.0, 3.0], [7.0, 9.0]]
    assert run.time is history.time and Outcome("overflow").sentence
    for part, outcome in itertools.product(("time", "displacement"), (Outcome.RAISED, Outcome.TIMEOUT)):
        with pytest.raises(ValueError, match="because"):
            getattr(Run(outcome, notes=("because",)), part)


def test_a_table_is_read_whatever_ends_it(tmp_path):
    """Plain numbers are read at once; what is none is found with its place, also after digits without end."""
    path = tmp_path / "table.csv"
    path.write_text("time,displacement\n0.5,1e-3\n1.0,-2.5E+2\n")
    names, values = files.read_table(path)
    assert names == ["time", "displacement"] and values.tolist() == [[0.5, 1e-3], [1.0, -250.0]]
    for wrong in ("1" * 60 + "x", "--1", "1,2,3"):
        path.write_text(f"time,displacement\n0.5,1.0\n1.0,{wrong}\n")
        with pytest.raises(InputError) as caught:
            files.read_table(path)
        assert "table.csv:3" in str(caught.value)
