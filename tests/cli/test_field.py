"""``judge`` of folders and of submissions: verdicts, their site, and defects that leave nothing behind."""

from __future__ import annotations

import json
import re
from pathlib import Path

import pytest
from conftest import typed
from oracles.answers import answered

from validation.problems import bands, cause, packs
from validation.problems.data import PACK
from validation.problems.questions import names
from validation.report.chapters import judged


@pytest.fixture
def undrawn(monkeypatch: pytest.MonkeyPatch) -> None:
    """Leave out the figures and the search for causes, which take most of the time."""
    monkeypatch.setattr(judged, "figures", lambda *given: ())
    monkeypatch.setattr(cause, "cause", lambda *given: cause.Cause("a <cause> & more", ("factor",)))


@pytest.fixture
def layout(tmp_path: Path) -> Path:
    """Return a layout of two programs, one at two steps."""
    place = tmp_path / "submissions"
    for name, factor, step in (("default", 1.04, 2e-3), ("fine-step", 1.01, 1e-3)):
        folder = place / "bob-s-code-co/1.0" / name
        answered(folder, factor, settings_name=name, step_s=step)
    answered(place / "other/2.0/default", 1.001, ("locked",), program="Other", version="2.0", step_s=None)
    return place


def test_a_folder_is_judged_and_each_problem_told(tmp_path: Path, undrawn: None) -> None:
    answered(tmp_path / "mine", 1.01)
    done = typed("judge", tmp_path / "mine")
    assert done.returncode == 1, done.stderr
    assert "Bob's <code> & co 1.0 default: 2 of 3 PASS, 1 FAIL\n" in done.stdout
    assert re.search(r"locked +PASS +1 % +5.7 %  displacement_m\n", done.stdout)
    assert re.search(r"column +FAIL +1 % +0.82 %  displacement_2_m; cause: a <cause> & more\n", done.stdout)
    assert f"{len(names()) - 3} problems of the pack are not answered" in done.stdout
    assert sorted(path.suffix for path in (tmp_path / "mine").iterdir()) == [".csv", ".csv", ".csv", ".json"]
    answered(tmp_path / "right", 1.001, ("locked", "rocking"))
    assert typed("judge", tmp_path / "right").returncode == 0


def test_verdicts_as_plain_data_are_those_of_the_commands(layout: Path, tmp_path: Path, undrawn: None) -> None:
    typed("judge", layout, "--site", tmp_path / "site")
    verdicts = json.loads((tmp_path / "site/verdicts.json").read_text(encoding="utf-8"))
    assert (verdicts["format"], verdicts["pack"]) == ("dda-validation verdicts", PACK)
    rows = {(row["program"], row["settings_name"], row["problem"]): row for row in verdicts["answers"]}
    assert len(rows) == 7
    row = rows["Bob's <code> & co", "default", "rocking"]
    assert (row["verdict"], row["step_s"], row["cause"]["ids"]) == ("FAIL", 0.002, ["factor"])
    assert (row["columns"][0]["error"], row["columns"][0]["allowed"]) == (0.04, pytest.approx(0.015, abs=6e-4))
    assert json.loads(typed("judge", layout, "--json").stdout) == verdicts
    rounding = answered(tmp_path / "rounding", 1 + 1e-13, ("locked",))
    (row,) = json.loads(typed("judge", rounding, "--json").stdout)["answers"]
    assert [column["error"] for column in row["columns"]] == [1e-11, 1e-11]


def test_an_answer_to_an_earlier_pack_is_stale_in_table_page_and_data(
    tmp_path: Path, undrawn: None, monkeypatch: pytest.MonkeyPatch
) -> None:
    now = packs.packs()[PACK]
    earlier = {"1.9": now | {"locked": "0" * 16}, PACK: now}
    for module in ("packs", "answers", "submission"):
        monkeypatch.setattr(f"validation.problems.{module}.packs", lambda: earlier)
    answered(tmp_path / "mine", 1.001, ("locked", "rocking"), pack="1.9")
    done = typed("judge", tmp_path / "mine", "--out", tmp_path / "site")
    assert done.returncode == 1 and re.search(r"locked +stale .*it answers pack 1.9", done.stdout)
    assert re.search(r"rocking +PASS", done.stdout)
    for file in ("index.html", "answers_bob-s-code-co_1.0_default.html", "verdicts.json"):
        assert "it answers pack 1.9" in (tmp_path / "site" / file).read_text(encoding="utf-8"), file


def test_each_exact_motion_is_computed_once(layout: Path, undrawn: None, tmp_path: Path) -> None:
    bands._standard.cache_clear()
    typed("judge", layout, "--site", tmp_path / "site")
    assert bands._standard.cache_info().misses == 3


def test_all_defects_are_printed_and_nothing_is_written(layout: Path, tmp_path: Path, undrawn: None) -> None:
    folder = layout / "other/2.0/default"
    (folder / "locked.csv").write_text("time_s;displacement_m\n")
    (folder / "rokcing.csv").write_text("")
    site = tmp_path / "site"
    for arguments in (("--site", site), ("--keep", tmp_path / "kept", "--out", site)):
        done = typed("judge", layout, *arguments)
        assert done.returncode == 2 and done.stdout == ""
        *lines, last = done.stderr.splitlines()
        assert [line.partition(f"{folder}/")[2].split(" ")[0] for line in lines] == ["locked.csv:1:7:", "rokcing.csv:"]
        assert last == "2 defects in 2 files; nothing is judged"
        assert not (tmp_path / "site").exists() and not (tmp_path / "kept").exists()


def test_answers_are_kept_and_then_make_the_site(tmp_path: Path, undrawn: None) -> None:
    answered(tmp_path / "mine", 1.001, ("locked",))
    done = typed("judge", tmp_path / "mine", "--keep", tmp_path / "submissions")
    assert done.returncode == 0 and "kept in " in done.stdout
    assert typed("judge", tmp_path / "submissions", "--site", tmp_path / "site").returncode == 0
    answered(tmp_path / "mine", 1.002, ("locked",))
    done = typed("judge", tmp_path / "mine", "--keep", tmp_path / "submissions")
    assert done.returncode == 2 and "holds another answer, which is not overwritten" in done.stderr


@pytest.mark.parametrize(
    ("arguments", "said"),
    [
        (("judge", "locked", "--solver", "dda", "--keep", "kept"), "--keep: goes with a folder of answers"),
        (("judge", "none", "--site", "s"), "must be a directory with submission.json"),
        (("judge", "mine", "--set", "time.step=1"), "--set: goes with --scene or --solver"),
        (("judge", "mine", "--out", "mine"), "must be a new or empty directory or an earlier site"),
    ],
)
def test_bad_input_is_one_line(
    arguments: tuple[str, ...], said: str, tmp_path: Path, undrawn: None, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    answered(tmp_path / "mine", 1.001, ("locked",))
    done = typed(*arguments)
    assert done.returncode == 2 and said in done.stderr and done.stderr.count("\n") == 1, done.stderr
