"""The chapter of the field of engines: the finding, marks, sides, curves and prices of a made table."""

from __future__ import annotations

import itertools
from dataclasses import replace
from pathlib import Path

import matplotlib.colors
from oracles.made_engines import PROBLEMS, PROGRAMS, curve, table

from validation.report.blocks import FigureBlock, Table
from validation.report.chapters import engines
from validation.report.chapters.data import spoken_of
from validation.report.chapters.programs import absent_of
from validation.report.figures.curves import _ENGINE_COLORS, style_of
from validation.report.figures.engines import BACKGROUND, LARGEST, LEAST, engine_figure
from validation.studies.engines.best import best_of_family, reached
from validation.studies.engines.table import EngineCell, EngineTable
from validation.studies.field.programs import KNOWN
from validation.studies.field.table import FAIL, NOT_RUN, PARTIAL, PASS

ENGINES = table()
ROOT = Path(__file__).parents[2]


def changed(problem: str, program: str, **values: object) -> EngineTable:
    """Return the table with another cell."""
    cell = replace(ENGINES.cells[problem, program], **values)
    return replace(ENGINES, cells={**ENGINES.cells, (problem, program): cell})


def rows_of(part: Table) -> dict[str, tuple[str, ...]]:
    return {row[0]: row[1:] for row in part.rows}


# ---- the best -----------------------------------------------------------------------------------------------------


def test_the_band_is_reached_where_all_finer_runs_are_within_it() -> None:
    falling = curve(4, 0.5, 0.01)  # 4, 2, 1, 0.5 at 0.01, 0.02, 0.04, 0.08 s
    assert reached(falling) is falling[2]
    by_chance = (replace(falling[0], error=0.5), *falling[1:])
    assert reached(by_chance) is falling[2]
    stopped = (*falling[:3], replace(falling[3], error=None))
    assert reached(stopped) is None
    assert reached(curve(240, 1, 0.01)) is None
    assert reached(()) is None


def test_the_best_is_the_one_of_least_time_and_those_that_take_nearly_as_little() -> None:
    cells = {program: EngineCell("standing", program, PASS) for program in ("newton-xpbd", "newton-xpbd-default")}
    for price, count in ((0.01 * 1.2, 2), (0.01 * 1.3, 1)):
        points = {"newton-xpbd": curve(0.5, 0.5, 0.01), "newton-xpbd-default": curve(0.5, 0.5, price)}
        own = {("standing", name): replace(cell, points=points[name]) for name, cell in cells.items()}
        best = best_of_family(replace(ENGINES, cells={**ENGINES.cells, **own}), "standing", "robotics")
        assert [program.name for program, _ in best] == ["newton-xpbd", "newton-xpbd-default"][:count]
        assert best[0][1].seconds == 0.01
    assert best_of_family(ENGINES, "standing", "robotics") == []


def test_who_fails_the_problem_is_not_the_best_at_it() -> None:
    (best,) = best_of_family(ENGINES, "standing", "games")
    assert best[0].name == "box2d"
    assert best_of_family(changed("standing", "box2d", verdict=FAIL), "standing", "games") == []


# ---- the figure ---------------------------------------------------------------------------------------------------


def drawn_colors(figure: object, panel: int) -> list[str]:
    axes = figure.axes[panel]
    return [matplotlib.colors.to_hex(line.get_color()) for line in axes.lines if len(line.get_xdata()) == 4]


def test_each_family_has_its_row_before_the_grey_lines_of_the_others() -> None:
    figure = engine_figure(ENGINES, "standing")
    assert len(figure.axes) == 6
    assert [axes.get_title(loc="left") or axes.get_title() for axes in figure.axes[::2]] == [
        "Mechanics",
        "Robotics",
        "Games",
    ]
    siconos = style_of("siconos").color
    assert drawn_colors(figure, 0) == [BACKGROUND, BACKGROUND, siconos, siconos]
    assert drawn_colors(figure, 5) == [BACKGROUND, BACKGROUND, BACKGROUND, style_of("box2d").color]
    for axes, cost in zip(figure.axes[-2:], ("steps", "seconds"), strict=True):
        assert axes.get_xlabel() == cost
    assert engine_figure(ENGINES, "pile") is None


def test_points_stand_at_their_cost_and_error_inside_the_axes() -> None:
    figure = engine_figure(ENGINES, "standing")
    chosen = figure.axes[1].lines[2]
    assert list(chosen.get_xdata()) == [0.01, 0.02, 0.04, 0.08]
    assert list(chosen.get_ydata()) == [4, 2, 1, 0.5]
    assert list(figure.axes[0].lines[2].get_xdata()) == [100, 200, 400, 800]
    assert set(figure.axes[4].lines[-2].get_ydata()) | set(figure.axes[4].lines[-1].get_ydata()) >= {LEAST}
    assert figure.axes[0].get_ylim()[1] > LARGEST


def test_the_star_is_the_best_of_more_than_one() -> None:
    words = {text.get_text() for axes in engine_figure(ENGINES, "standing").axes for text in axes.texts}
    assert {"Siconos ★", "Siconos, default", "Newton XPBD", "Box2D"} <= words


def test_programs_of_a_family_differ_in_colour_and_have_one_everywhere() -> None:
    boxes = [known for known in KNOWN if known.boxes]
    assert {known.name for known in boxes} == set(_ENGINE_COLORS)
    colors = [(known.family, style_of(known.name).color) for known in boxes]
    assert len(set(colors)) == len(colors)
    for known in boxes:
        default = style_of(f"{known.name}-default")
        assert (default.color, default.dash != ()) == (style_of(known.name).color, True)


# ---- words and tables ---------------------------------------------------------------------------------------------


def test_the_lead_counts_chosen_settings_and_defaults() -> None:
    assert engines.counted(ENGINES) == (
        "3 programs, 4 problems: 5 of 7 answers pass with chosen settings, 0 of 2 answers pass as they come."
    )
    partial = changed("pile", "box2d", verdict=PARTIAL, reason="")
    assert "6 of 8 answers pass with chosen" in engines.counted(partial)
    alone = replace(ENGINES, programs=PROGRAMS[:1])
    assert engines.counted(alone).startswith("No other program is installed here")


def test_the_finding_says_who_stands_and_who_gains_energy() -> None:
    rows = rows_of(engines.findings(ENGINES))
    stands = rows["Who stands still? (standing, pile)"]
    assert stands == ("In all: Siconos. In part: Newton XPBD (pile), Box2D (standing).", "No: Siconos.")
    assert rows["Who gains energy?"] == ("Newton XPBD (12\u00a0%).", "Siconos (31\u00a0times).")
    assert rows["Who bounces as asked? (restitution)"] == ("–", "–")
    calm = changed("bouncing", "newton-xpbd", quantities=ENGINES.cells["bouncing", "siconos"].quantities)
    assert rows_of(engines.findings(calm))["Who gains energy?"][0] == "None."


def test_the_overview_has_a_mark_and_an_error_in_every_cell() -> None:
    overview = engines.overview(ENGINES)
    assert overview.rows == (
        ("Mechanics",),
        ("Siconos", "chosen", "PASS 0.5", "–", "PASS < 0.001", "PASS < 0.001"),
        ("", "as\u00a0it\u00a0comes", "FAIL 240", "–", "FAIL > 1000", "–"),
        ("Robotics",),
        ("Newton XPBD", "chosen", "FAIL 30", "n. a.", "FAIL 12", "PASS 0.1"),
        ("", "as\u00a0it\u00a0comes", "–", "n. a.", "–", "–"),
        ("Games",),
        ("Box2D", "chosen", "PASS < 0.001", "–", "–", "–"),
        ("This suite",),
        ("Exact motion", "", "PASS < 0.001", "–", "–", "–"),
    )
    assert overview.notes[-1] == "Not installed: Drake."


def test_chosen_settings_and_defaults_stand_side_by_side() -> None:
    rows = rows_of(engines.side_by_side(ENGINES, PROBLEMS[0]))
    assert rows["Siconos"] == ("PASS creep 0.1 mm/s", "FAIL creep 48 mm/s")
    assert rows["Box2D"] == ("PASS creep 0 mm/s", "")
    assert rows["Newton XPBD"] == ("FAIL creep 6 mm/s", "–")


def test_prices_are_those_of_the_best_of_each_family() -> None:
    prices = engines.prices(ENGINES)
    assert [column.title for column in prices.columns] == ["Problem", "Mechanics", "Robotics", "Games"]
    assert prices.rows == (
        (
            "standing",
            "Siconos: 0.04\u00a0s, 400\u00a0steps",
            "none",
            "Box2D: 0.002\u00a0s, 100\u00a0steps",
        ),
    )


def test_curves_of_one_finding_stand_in_one_line() -> None:
    rows = rows_of(engines.curve_findings(ENGINES, PROBLEMS[0]))
    falls = "The error falls at each of 3 halvings of the step, order 1.0"
    assert rows[falls] == ("Siconos (0.04\u00a0s); Newton XPBD",)
    assert rows["No error at any step"] == ("Box2D (0.002\u00a0s)",)


def test_bands_are_told_once_with_their_reason() -> None:
    part = engines.bands(ENGINES, PROBLEMS[0])
    assert part.rows == (("Creep [mm/s]", "friction 22 deg", "0", "0 to 0.2", "one per cent of the width"),)
    assert [column.title for column in engines.bands(ENGINES, PROBLEMS[2]).columns] == [
        "Asked",
        "Exact",
        "Allowed",
        "Why",
    ]


def test_what_has_no_verdict_says_why() -> None:
    rows = absent_of(ENGINES, engines.installed_programs(ENGINES)).rows
    assert ("Newton XPBD", "restitution", "it has no restitution") in rows
    assert ("", "pile", "no answer: Stopped: no memory") in rows
    assert not any("Drake" in row[0] for row in rows)


def test_programs_say_what_they_are_and_where_their_adapters_are() -> None:
    *_, paragraph, part = engines.programs(ENGINES)
    assert paragraph.text == engines.INVITATION
    assert part.rows[:3] == (
        ("Siconos", "1.5", "impulses", "settings of Siconos", "siconos.py"),
        ("Siconos, as it comes", "", "the same", "its defaults", ""),
        ("Newton XPBD", "1.5", "impulses", "settings of Newton XPBD", "newton.py"),
    )
    assert part.rows[-1][-1] == ""


def test_the_chapter_has_a_section_and_a_figure_for_each_problem(tmp_path: Path, monkeypatch: object) -> None:
    monkeypatch.setattr(engines, "read", lambda results: ENGINES)

    class Nothing:
        def verdicts(self, study: str) -> list[object]:
            return []

    blocks = engines.chapter(Nothing(), {"study": "engines", "title": "Engines"}, tmp_path)
    figures = [block for block in blocks if isinstance(block, FigureBlock)]
    assert [figure.file for figure in figures] == ["engines-standing.svg"]
    assert (tmp_path / "engines-standing.svg").is_file()
    headings = [block.text for block in blocks if type(block).__name__ == "Heading"]
    assert [text for text in headings if ": made" in text] == [
        f"{problem.name.capitalize()}: {problem.title}" for problem in PROBLEMS
    ]
    monkeypatch.setattr(engines, "read", lambda results: None)
    assert "run it again" in engines.chapter(Nothing(), {"study": "engines"}, tmp_path)[-1].text


def test_pages_speak_of_the_scenes_of_the_problems_only() -> None:
    own = {"title": "", "solver": "box2d", "key": "", "definition": {}}
    records = [own | {"scene": name} for name in ("rigid-pile", "rigid-pile[curve, step halved 1 times]")]
    data = {"programs": [], "problems": [{"scene": "rigid-pile"}]}
    shown = spoken_of({"study": "engines", "cases": records, "data": data})
    assert [record["scene"] for record in shown] == ["rigid-pile"]


def test_no_word_is_of_a_failed_answer_alone() -> None:
    """A verdict without a number, such as that of a run that overflowed, is shown with what it says."""
    wrong = changed("standing", "box2d", verdict=FAIL, says="overflow", error=None)
    assert rows_of(engines.side_by_side(wrong, PROBLEMS[0]))["Box2D"][0] == "FAIL overflow"
    assert dict(itertools.pairwise(rows_of(engines.overview(wrong))["Box2D"]))["chosen"] == "FAIL"
    assert NOT_RUN not in itertools.chain(*engines.overview(wrong).rows)
