"""Chapters are queries of the table of a study: what is looked up, put into sentences, tables and charts, by name."""

import fnmatch
import re
import tomllib
from dataclasses import replace
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest
from matplotlib.figure import Figure
from oracles.made_cases import between, kept_study, made_history, made_row

from validation.engine.run import run_study
from validation.report.blocks import FigureBlock, Heading, Paragraph
from validation.report.chapters.described import Description
from validation.report.chapters.queries import StudyTable
from validation.report.chapters.registry import chapter_of
from validation.report.chapters.written import WrittenChapter
from validation.report.figures.drawing import FigureHooks
from validation.results import Results
from validation.runs.case_name import scene_of
from validation.scenes.scene import load_scene
from validation.studies.waves.rows import curves
from validation.suite.folders import get_study, study_folders

DERIVED = [
    {"scene": "figures-3-4[time.step=0.01]", "name": "closed", "metrics": {"ratio": 0.5, "word": "stands"}},
    {"scene": "figures-3-4", "name": "order", "metrics": {"power": -2.0}},
    {"scene": "owner-a", "name": "dda at 10 blocks", "metrics": {"piece 1": 3.0, "piece 2": 4.0, "other": 9.0}},
    {"scene": "owner-b", "name": "dda at 20 blocks", "metrics": {"piece 1": 5.0}},
]
FOLDERS = {name: folder for name, folder in study_folders().items() if (folder.path / "chapter.toml").exists()}


@pytest.fixture
def table(tmp_path):
    """The table of a study of two cases by two solvers."""
    results = Results(tmp_path / "results")
    cases = []
    for number, case in enumerate(load_scene("figures-3-4").expand()[:2], start=1):
        for solver in ("dda", "fem"):
            metrics = {"displacement.static": -0.01 * number, "pressure.settling_step": "undefined"}
            history = made_history(case.time.step, [0.0, -1.0, -2.0], [0.0, 10.0, 20.0])
            row = made_row(solver, metrics, case.name, work={"unknowns": 6}, seconds={"set-up": 1.0, "stepping": 2.0})
            cases.append((case, row, history))
    names = [case.name for case, *_ in cases]
    data = {"curves": [{"kind": "a", "x": [1.0, 2.0], "y": [3.0, None]}, {"kind": "b", "x": [0.0], "y": [1.0]}]}
    data["remarks"] = ["mind"]
    pairs = [between(names[0], "dda", "fem", displacement_l2=0.25)]
    kept_study(results, cases, pairs, derived=DERIVED, data=data)
    return StudyTable(results, results.manifest("made"))


TABLE = tomllib.loads(Path(__file__).with_name("queries.toml").read_text(encoding="utf-8"))


def test_a_query_looks_up_what_it_names_and_a_column_picks_one_of_some_lines(table):
    for row in TABLE["query"]:
        lines = table.lines(row.get("query", {"where": {"time.step": 0.01}}))
        assert [told(table.value(line, row["of"])) for line in lines] == row["values"], row
    for row in TABLE["column"]:
        assert told(table.picked(table.lines({}), row["column"])) == row["value"], row


def told(value):
    """Return a value as the table states it, which has no word of its own for nothing."""
    return "none" if value is None else value


MAPS = """
[maps.steps]
file = "{study}.svg"
caption = "Maps."
of = ["figures-*"]
rows = { of = "contact.stiffness", form = "decade", label = "p" }
columns = { of = "time.step", factor = 1e3, form = "g", descending = true, label = "step [ms]" }
scale = ["Greys", 1.0, 5.0]
missing = "none"
[[maps.steps.maps]]
title = "v"
of = "dda displacement.static"
decimals = 2
shade = { from = 0.0, to = -0.04 }
[[maps.steps.maps]]
title = "r"
of = "closed: ratio"
digits = 1
shade = { from = 0.25, to = 4.0, logarithmic = true }
[[maps.steps.maps]]
title = "s"
of = "closed: ratio"
form = "digits"
shade = { from = 2.0, to = 8.0, logarithmic = true, either_side = true }
[maps.nothing]
file = "nothing.svg"
caption = ""
of = ["figures-*"]
rows = { of = "contact.stiffness" }
columns = { of = "time.step" }
scale = ["Greys", 1.0, 5.0]
maps = [{ title = "v", of = "closed: absent", shade = { from = 0.0, to = 1.0 } }]
"""

PAGE = """
parts = [
    { opening = "" },
    { text = "said" },
    { text = "missing" },
    { text = "replaced", tone = "fail" },
    { heading = "Shown", figure = "chart", table = "cases", after = "said" },
    { heading = "Never", table = "nothing" },
    { text = "said", when = ["nowhere"] },
    { table = "measured" },
    { heading = "Never", table = "measured", where = { "time.step" = 0.002 } },
    { text = "judged" },
    { section = "figures-3-4", columns = [], without = "truth" },
    { maps = "steps" },
    { maps = "nothing" },
    { picture = "scenes" },
    { picture = "nothing" },
    { frames = "turns" },
    { frames = "nothing" },
    { heading_of = "figures-3-4", text = "said", level = 3 },
    { heading_of = "nowhere", text = "said" },
    { each = "scene", text = "said" },
    { outcomes = 1 },
    { call = "own" },
    { heading = "Its course", history = "figures-3-4", columns = ["displacement"] },
    { points = ["said", "missing"], heading = "In {count}" },
]
[frames.turns]
scene = "figures-3-4*"
solver = "dda"
times = [0.0029, 0.0051]
height = 30.0
file = "turns.svg"
caption = "As it turns."
[frames.nothing]
scene = "figures-3-4*"
solver = "bar"
[picture.scenes]
file = "scenes.svg"
caption = "As drawn."
height = 31.0
scenes = { "figures-3-4*" = "First", "nowhere" = "Never", "*0.002]" = "Second" }
[picture.nothing]
scenes = { "nowhere" = "Never" }
[text]
judged = "{gates}"
said = "At {coarse} ms: {cases}."
said-question = "When?"
missing-question = "Why?"
missing = "There is {absent}."
replaced = "There is {absent}."
replaced-without = "There is none."
[number.coarse]
value = "time.step"
pick = "most"
factor = 1e3
form = "g"
[number.fine]
value = "time.step"
pick = "least"
[number.absent]
value = "closed: absent"
[list.cases]
text = "{step} s gives {static}"
join = " and "
[list.cases.numbers]
step = { value = "time.step", form = "g" }
static = { value = "dda displacement.static", decimals = 2 }
[table.cases]
caption = "To {coarse} ms."
by = "solver"
first = [["", "", "exact", "", "{coarse}"]]
columns = [
    { title = "Case", of = "scene", without = "figures-", once = true },
    { title = "dt", of = "time.step", form = "g", without = "s" },
    { title = "Solver", of = "solver", words = { fem = "elements" } },
    { title = "", of = "time.step", form = "g", pattern = "{}, {}", also = [{ of = "* work.unknowns", digits = 1 }] },
    { title = "v", of = "* displacement.static", decimals = 2, where = { "time.step" = 0.01 } },
]
[table.measured]
measured = true
notes_of = "remarks"
columns = [{ title = "dt", of = "time.step", form = "g" }, { title = "r", of = "closed: ratio", digits = 2 }]
[table.nothing]
of = "nowhere"
columns = [{ title = "v", of = "dda displacement.static" }]
[figure.chart]
file = "chart.svg"
caption = "Drawn at {coarse} ms."
panels = ["a", "b"]
[panel.a]
logarithmic = [false, false]
lines = [
    { x = "time.step", y = "dda displacement.static", y_factor = 100.0, sort = "time.step", name = "v" },
    { x = "time.step", y = "closed: ratio", absent = 7.0, name = "all" },
    { x = "time.step", y = "closed: ratio", absent = 7.0, only_absent = true, name = "absent" },
    { x_ends = [0.0, 1.0], y = "closed: ratio", name = "level" },
]
[panel.b]
marks = { here = "fine", "{coarse} ms" = "coarse", there = "absent" }
x_ticks = [[1.0, "one"]]
[[panel.b.lines]]
where = { "time.step" = 0.01 }
history = "dda"
y = "displacement"
y_over = "closed: ratio"
y_start = 1.0
x_end = 0.025
name = "{step} s"
numbers = { step = { value = "time.step", form = "g" } }
colors = ["#111111"]
[[panel.b.lines]]
where = { "time.step" = 0.01 }
history = "dda"
y = ["displacement", "contact_pressure"]
name = "mean"
[[panel.b.lines]]
data = "curves"
where = { kind = "a" }
each = "kind"
x = "x"
y = "y"
looks = { a = { dash = [1.0, 2.0] } }
name = "{each}"
[[panel.b.lines]]
each = "time.step"
x = "time.step"
y = "dda displacement.static"
note_of.of = "time.step"
looks = { "0.01" = { color = "#222222" } }
name = "at {each}"
"""


def test_parts_become_blocks_in_their_order_and_lines_hold_what_their_queries_name(
    kept, kept_figures, drawn, table, tmp_path, monkeypatch
):
    asked = []

    def frames(hooks, scene, history, steps, solver, height):
        asked.append((scene.time.step, len(history.time), steps, solver, height))
        return Figure()

    monkeypatch.setattr(FigureHooks, "frames", frames)
    (tmp_path / "chapter.toml").write_text(PAGE + MAPS)
    page = Description(tmp_path / "chapter.toml")
    module = SimpleNamespace(
        own=lambda study, directory: [Paragraph(f"{study.manifest['study']} {directory == tmp_path}")]
    )
    kept("written", WrittenChapter(page, table, tmp_path, module).blocks())
    kept_figures("figures-written", drawn)
    assert asked == [(0.002, 3, [0, 2], "dda", 30.0)]


# ---- the chapters of the suite --------------------------------------------------------------------------------------


def test_a_chapter_without_rows_has_no_table_and_no_figure(tmp_path):
    """Of a study without its data, and of one of which no case has finished."""
    results = Results(tmp_path / "results")
    scene = load_scene(get_study("response").scenes[0]).expand()[0]
    kept_study(results, [(scene, made_row("dda", {}, scene.name), None)], study="response")
    run_study(replace(get_study("rocking"), scenes=[], gates=tuple, derived=tuple), results)
    blocks = chapter_of("response")(results, results.whole("response"), tmp_path)
    assert [type(block) for block in blocks] == [Heading, Paragraph, Paragraph]  # what it asks, and its sources
    blocks = chapter_of("rocking")(results, results.manifest("rocking"), tmp_path)
    assert not [block for block in blocks if isinstance(block, FigureBlock)]


def test_closed_forms_of_the_page_of_waves_hold_the_rule_of_ten():
    drawn = {(c["scheme"], c["courant"]): c for c in curves()["curves"]}
    line = drawn["(1/2, 1)", 0.5]
    left = np.interp(np.log(10), np.log(line["blocks"]), line["left"])
    assert left == pytest.approx(0.008969, rel=0.03)
    assert set(drawn["(1/4, 1/2)", 1.0]["left"]) == {1.0}


def queries(folder):
    """Yield the tables of a description that hold expressions, with the query that they stand in."""

    def walk(place, part, query):
        if isinstance(part, dict):
            own = query | part
            yield place, own
            for key, value in part.items():
                yield from walk(f"{place}.{key}", value, {} if key in ("maps", "rows") else own)
        elif isinstance(part, list):
            for value in part:
                yield from walk(place, value, query)

    page = Description(folder.path / "chapter.toml")
    for kind in ("number", "list", "table", "panel"):
        for name, part in page._data.get(kind, {}).items():
            yield from walk(f"{kind}.{name}", part, {})


SHORT = {"waves", "plates", "boxes"}  # studies of few cases


@pytest.mark.parametrize(
    "name", [pytest.param(name, marks=[pytest.mark.long] * (name not in SHORT)) for name in FOLDERS]
)
def test_a_chapter_asks_for_what_its_study_has(name):
    folder = FOLDERS[name]
    study = get_study(name)
    cases = {case.scene.name for case in study.cases()}
    rows = study.derived()
    owners = {*cases, *map(scene_of, cases), *(row.scene for row in rows)}
    names = {row.name for row in rows}
    for place, query in queries(folder):
        for pattern in [query.get("of", [])] if isinstance(query.get("of"), str) else query.get("of", []):
            if isinstance(pattern, str) and not re.search(r"[ .:]", pattern) and place.split(".")[0] != "table":
                assert fnmatch.filter(owners, pattern), (place, pattern)
        for key in ("x", "y", "value", "among"):
            for expression in str(query.get(key, "")).split(" else "):
                row = expression.rpartition(": ")[0].rpartition("/")[2]
                assert not row or row in names, (place, expression)
        if "row" in query:
            pattern = re.compile(re.sub(r"\\\{\w+\\\}", ".+", re.escape(query["row"])))
            assert any(pattern.fullmatch(one) for one in names), (place, query["row"])
