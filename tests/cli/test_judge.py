"""``judge``: a solver, a table or folders of answers become verdicts, pages and badges; defects leave nothing."""

import json
import re
from functools import cache
from html import unescape
from xml.etree import ElementTree

import numpy as np
import pytest
from conftest import refused, typed
from oracles.answers import answered
from oracles.processes import answer_here

from validation.problems import packs
from validation.problems.bands import standard
from validation.problems.cause import Cause
from validation.problems.data import PACK
from validation.problems.pack import table_of
from validation.problems.problem import names, problem
from validation.report.chapters import judged
from validation.report.site.submissions import COLORS
from validation.runs.run import Outcome
from validation.solvers import registry
from validation.suite import judging

FORMAT = "dda-validation verdicts"


@pytest.fixture(scope="module")
def exact():
    return standard(problem("locked")).exact


@pytest.fixture
def undrawn(monkeypatch):
    """Leave out the figures and the search for causes, which take most of the time."""
    monkeypatch.setattr(judged, "figures", lambda *given: ())
    monkeypatch.setattr(judging, "cause", lambda *given: Cause("a <cause> & more", ("factor",)))


def table(place, history):
    """Write the answer to `locked` as a table alone."""
    place.write_text(table_of(problem("locked"), history, [*history.columns]))
    return place


# ---- one answer -----------------------------------------------------------------------------------------------------


def test_a_withheld_column_that_the_problem_asks_for_is_no_full_pass(tmp_path, exact, undrawn):
    place = answered(tmp_path / "mine", 1.0, ("locked",), not_reported={"locked": ["contact_pressure_Pa"]})
    (place / "locked.csv").write_text(table_of(problem("locked"), exact, ["displacement"]))
    done = typed("judge", place, "--out", tmp_path / "site")
    assert done.returncode == 1 and "wrote site/index.html" in done.stdout.replace(f"{tmp_path}/", "")
    badge = ElementTree.parse(tmp_path / "site/badge_bob-s-code-co_1.0_default.svg").getroot()
    assert badge.attrib["aria-label"].endswith("default: 0 of 1 PASS, 1 PARTIAL")
    (found,) = json.loads(typed("judge", place, "--json").stdout)["answers"]
    assert (found["verdict"], found["not_reported"]) == ("PARTIAL", ["contact_pressure_Pa"])


def test_columns_of_other_names_and_signs_are_mapped(tmp_path, exact):
    rows = np.column_stack([exact.time, -1e3 * exact.displacement, exact.columns["contact_pressure"]])
    np.savetxt(tmp_path / "mine.csv", rows, "%.17g", "\t", header="t\tuy\tp", comments="")
    options = ("--columns", "time=t,displacement=uy,contact_pressure=p", "--scale", "displacement=-1e-3")
    assert typed("judge", tmp_path / "mine.csv", "locked", *options).returncode == 0
    assert "--scale" in refused("judge", tmp_path / "mine.csv", "locked", "--scale", "displacement=0")


# ---- solvers --------------------------------------------------------------------------------------------------------


SAME_OR_NOT = """
import numpy as np
from validation import solve as suite

def of_the_suite(scene):
    return suite(scene, "dda").history

EXACT = {}

def exact(scene):
    return EXACT.get(scene.name) or EXACT.setdefault(scene.name, suite(scene, "block-events").history)

def noisy(scene):
    columns = exact(scene).columns
    return {name: x * (1 + 0.02 * np.random.default_rng().standard_normal(x.shape)) for name, x in columns.items()}

def broken(scene):
    raise OSError("DISK")

def away(scene):
    raise NotImplementedError("Away is not installed: apt-get")

def rounded(scene):
    columns = exact(scene).columns
    return {name: x * (1 + 1e-13 * np.random.default_rng().standard_normal(x.shape)) for name, x in columns.items()}
"""


@pytest.fixture
def same_or_not(tmp_path, monkeypatch, undrawn):
    """Write the solvers of a user, which answer in this process."""
    (tmp_path / "same_or_not.py").write_text(SAME_OR_NOT)
    monkeypatch.syspath_prepend(str(tmp_path))
    answer_here(monkeypatch)


@pytest.mark.parametrize(
    ("solver", "said"),
    [
        ("of_the_suite", "It is bit for bit the history of dda"),
        ("exact", "It is bit for bit the exact motion that it is judged by"),
        ("noisy", "Not repeatable: a second run differs by "),
        ("rounded", ""),
    ],
)
@pytest.mark.usefixtures("same_or_not")
def test_an_answer_of_the_suite_and_one_that_does_not_repeat_are_told_on_the_page(solver, said, tmp_path):
    done = typed("judge", f"same_or_not:{solver}", "locked", "--out", tmp_path / "site", "--json")
    (*warnings,) = json.loads(done.stdout)["answers"][0]["warnings"]
    assert [sentence[: len(said)] for sentence in warnings] == ([said] if said else [])
    (page,) = (tmp_path / "site").glob("answers_*.html")
    assert all(sentence in unescape(page.read_text(encoding="utf-8")) for sentence in warnings)


@pytest.mark.usefixtures("same_or_not")
def test_programs_stand_beside_each_other(tmp_path, monkeypatch):
    """What is not applicable, what raises and what is not there are no failures of the others, nor hidden by them."""
    brought = {"mine": "same_or_not:rounded", "broken": "same_or_not:broken", "away": "same_or_not:away"}
    monkeypatch.setattr(registry, "entry_points", lambda: brought)
    asked = ("installed", "locked", "rocking", "--beside", "dda", "--require", "mine")
    done = typed("judge", *asked, "--out", tmp_path / "site")
    assert done.returncode == 1 and (tmp_path / "site/index.html").exists(), done.stderr
    header, locked, rocking, times = done.stdout.splitlines()[1:5]
    assert header.split() == ["Problem", "mine", "dda"] and times.startswith("time [s]")
    assert "PASS" in locked and "FAIL" in locked and str(Outcome.NOT_APPLICABLE) in rocking
    assert "DISK" in done.stdout and "apt-get" in done.stdout
    required = typed("judge", "installed", "locked", "--beside", "dda", "--require", "away", "--json")
    assert required.returncode == 3
    found = json.loads(required.stdout)["answers"]
    assert {row["program"]: row["verdict"] for row in found} == {
        "mine": "PASS", "broken": "NOT RUN", "away": "NOT RUN", "dda": "FAIL",
    }  # fmt: skip


def test_what_a_program_is_not_asked_or_refuses_is_told_once(tmp_path, monkeypatch):
    """A program is named without its folder; tables that are not asked are left alone."""
    monkeypatch.chdir(tmp_path)
    (tmp_path / "mine").write_text("#!/bin/sh\necho a wall >&2\nexit 77\n")
    (tmp_path / "mine").chmod(0o755)
    done = typed("judge", "mine", "locked", "standing", "impact")
    assert done.returncode == 1 and done.stdout.count("a wall") == 1
    answered(tmp_path / "answers", 1.001)
    (answer,) = json.loads(typed("judge", "answers", "locked", "--json").stdout)["answers"]
    assert (answer["problem"], answer["verdict"]) == ("locked", "PASS")


def test_boxes_are_judged_by_numbers(undrawn):
    done = typed("judge", "dda", "impact")
    assert done.returncode == 1, done.stderr
    for number in ("rebound", "sinking"):
        assert re.search(rf"{number} +FAIL", done.stdout)
    assert "cause" not in done.stdout
    done = typed("judge", "rigid-exact", "standing", "--set", "plane.contact.friction=19")
    assert done.returncode == 0 and re.search(r"slid +PASS", done.stdout), done.stderr
    assert "plane.gravity" in refused("judge", "dda", "impact", "--set", "plane.gravity=[0.0, -3.0]")


# ---- folders --------------------------------------------------------------------------------------------------------


@pytest.fixture
def layout(tmp_path):
    """Return a layout of two programs, one at two steps."""
    place = tmp_path / "submissions"
    for name, factor, step in (("default", 1.04, 2e-3), ("fine-step", 1.01, 1e-3)):
        folder = place / "bob-s-code-co/1.0" / name
        answered(folder, factor, settings_name=name, step_s=step)
    answered(place / "other/2.0/default", 1.001, ("locked",), program="Other", version="2.0", step_s=None)
    return place


def test_the_site_holds_every_answer_and_the_data_of_the_commands_and_needs_nothing_else(layout, tmp_path, undrawn):
    done = typed("judge", layout, "--layout", "--out", tmp_path / "site")
    assert done.returncode == 1, done.stderr
    files = {path.name: path.read_text(encoding="utf-8") for path in (tmp_path / "site").iterdir()}
    stems = ("bob-s-code-co_1.0_default", "bob-s-code-co_1.0_fine-step", "other_2.0_default")
    pages = {"index.html", "program_bob-s-code-co.html", "program_other.html", *(f"answers_{s}.html" for s in stems)}
    assert set(files) == pages | {f"badge_{stem}.svg" for stem in stems} | {"verdicts.json", "page.css", "filter.js"}
    for name, text in files.items():
        assert str(tmp_path) not in text
        if name.endswith(".html"):
            addresses = re.findall(r'(?:href|src)="([^"#]+)(?:#[^"]*)?"', text)
            assert set(addresses) <= {*files, "data:,"}, name
            assert "<code>" not in text and "<cause>" not in text
        if name.endswith(".svg"):
            ElementTree.fromstring(text)
    verdicts = json.loads(files["verdicts.json"])
    assert (verdicts["format"], verdicts["pack"]) == (FORMAT, PACK)
    rows = {(row["program"], row["settings_name"], row["problem"]): row for row in verdicts["answers"]}
    assert len(rows) == 7
    row = rows["Bob's <code> & co", "default", "rocking"]
    assert (row["verdict"], row["step_s"], row["cause"]["ids"]) == ("FAIL", 0.002, ["factor"])
    assert (row["criteria"][0]["error"], row["criteria"][0]["allowed"]) == (0.04, pytest.approx(0.015, abs=6e-4))
    colors = [[color in files[f"badge_{stem}.svg"] for color in COLORS.values()] for stem in stems]
    assert colors == [[False, False, True], [False, False, True], [True, False, False]]
    left = [name for name in names() if name not in {row["problem"] for row in verdicts["answers"]}]
    assert f" {', '.join(left)}." in files["index.html"] and files["index.html"].count("<h2") == 3
    assert json.loads(typed("judge", layout, "--json").stdout) == verdicts
    rounding = answered(tmp_path / "rounding", 1 + 1e-13, ("locked",))
    (row,) = json.loads(typed("judge", rounding, "--json").stdout)["answers"]
    assert [column["error"] for column in row["criteria"]] == [1e-11, 1e-11]


def test_an_answer_to_an_earlier_pack_is_stale_in_table_page_and_data(tmp_path, undrawn, monkeypatch):
    now = packs.packs()[PACK]
    earlier = {"1.9": now | {"locked": "0" * 16}, PACK: now}
    for module in ("packs", "answers"):
        monkeypatch.setattr(f"validation.problems.{module}.packs", lambda: earlier)
    answered(tmp_path / "mine", 1.001, ("locked", "rocking"), pack="1.9")
    done = typed("judge", tmp_path / "mine", "--out", tmp_path / "site")
    assert done.returncode == 1 and re.search(r"locked +stale .* 1\.9", done.stdout)
    assert re.search(r"rocking +PASS", done.stdout)
    assert re.search(rf"^{len(names()) - 2} problems", done.stdout, re.M)
    assert done.stdout.startswith("Bob's <code> & co 1.0 default: 1 of 2 PASS, 1 stale")
    for file in ("index.html", "answers_bob-s-code-co_1.0_default.html", "verdicts.json"):
        assert "pack 1.9" in (tmp_path / "site" / file).read_text(encoding="utf-8"), file


def test_all_defects_are_printed_and_nothing_is_written(layout, tmp_path, undrawn):
    folder = layout / "other/2.0/default"
    (folder / "locked.csv").write_text("time_s;displacement_m\n")
    (folder / "rokcing.csv").write_text("")
    site = tmp_path / "site"
    for arguments in (("--layout", "--out", site), ("--keep", tmp_path / "kept", "--out", site)):
        done = typed("judge", layout, *arguments)
        assert done.returncode == 2 and done.stdout == ""
        *lines, last = done.stderr.splitlines()
        assert [line.partition(f"{folder}/")[2].split(" ")[0] for line in lines] == ["locked.csv:1:22:", "rokcing.csv:"]
        assert last.startswith("2 defects in 2 files; ")
        assert not (tmp_path / "site").exists() and not (tmp_path / "kept").exists()


def test_answers_are_kept_and_then_make_the_site(tmp_path, undrawn):
    answered(tmp_path / "mine", 1.001, ("locked",))
    done = typed("judge", tmp_path / "mine", "--keep", tmp_path / "submissions")
    assert done.returncode == 0
    assert typed("judge", tmp_path / "submissions", "--layout", "--out", tmp_path / "site").returncode == 0
    answered(tmp_path / "mine", 1.002, ("locked",))
    done = typed("judge", tmp_path / "mine", "--keep", tmp_path / "submissions")
    assert done.returncode == 2


@pytest.mark.parametrize(
    ("arguments", "said"),
    [
        (("dda", "stoping"), "did you mean stopping?"),
        (("dda", "figures-3-5"), "did you mean figures-3-4?"),
        (("mine", "--out", "mine"), "error: mine: "),
        (("nowhere:solve", "locked"), "error: solver: "),
        (("installed",), "error: "),
    ],
)  # fmt: skip
def test_bad_input_is_one_line_and_writes_nothing(arguments, said, tmp_path, undrawn, monkeypatch):
    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr(registry, "entry_points", dict)
    answered(tmp_path / "mine", 1.001, ("locked",))
    done = typed("judge", *arguments)
    assert done.returncode == 2 and said in done.stderr and done.stderr.count("\n") == 1, done.stderr
    assert sorted(path.name for path in tmp_path.iterdir()) == ["mine"]


# ---- gates ----------------------------------------------------------------------------------------------------------


def test_a_file_of_a_history_is_put_to_the_gates_of_its_scene(tmp_path, monkeypatch):
    """Of a folder of histories the scenes that it holds are judged, the others are not run."""
    from validation.suite.own_solver import gates

    monkeypatch.setattr(gates, "judged_studies", tuple)  # those of all studies take seconds to read
    for name in ("applying", "asked"):
        monkeypatch.setattr(gates, name, cache(getattr(gates, name).__wrapped__))
    monkeypatch.chdir(tmp_path)
    scene = gates.START.scenes[0]
    history = registry.get_solver("dda").solve(scene).history
    columns = ["displacement", "contact_pressure"]
    rows = np.column_stack([history.time, *(history.columns[name] for name in columns)])
    (tmp_path / "mine").mkdir()
    header = ";".join(["time", *columns])
    np.savetxt(f"mine/{scene.name}.csv", rows, "%.17g", ";", header=header, comments="")
    done = typed("judge", "mine/", "--study", "own-solver", "--json")
    assert (done.returncode, done.stderr) == (0, "")
    reports = json.loads(done.stdout)
    assert {report["status"] for report in reports if report["scene"] == scene.name} <= {"PASS", "NOT RUN"}
    assert {report["status"] for report in reports if report["scene"] != scene.name} == {"NOT RUN"}
    np.savetxt(
        f"mine/{scene.name}.csv", rows * [1, 1.01, 1.01], "%r", ";", header=f"time;{';'.join(columns)}", comments=""
    )
    done = typed("judge", "mine/", "--study", "own-solver")
    assert done.returncode == 1 and "FAIL" in done.stdout
