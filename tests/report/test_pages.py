"""A report and its figures from results made by hand, word by word: numbers, units, sentences, lines and axes."""

import re
import tomllib
from string import ascii_lowercase

import numpy as np
import pytest
from oracles.made_cases import made_case, made_group, made_history

from validation.metrics.catalogue import CATALOGUE
from validation.report import book
from validation.report.appendix.pages import appendix
from validation.report.blocks import Heading
from validation.report.chapters import budget
from validation.report.chapters.data import groups_of_studies
from validation.report.chapters.scene import scene_page, slide_figure
from validation.report.figures import motion, response
from validation.report.figures.charts import ChartLine, ChartPanel, chart_figure
from validation.report.figures.curves import HistoryPanel
from validation.report.figures.histories import Margins
from validation.report.figures.solution import solution_figure
from validation.report.figures.space_time import SpaceTime, space_time_figure
from validation.report.front import front_pages
from validation.runs.history import DISPLACEMENT, PRESSURE
from validation.scenes.scene import load_scene
from validation.suite.folders import study_folders

STUDIES = ("mine", "two", "solo")


@pytest.mark.parametrize("study", STUDIES)
def test_a_chapter_says_and_draws_what_its_rows_hold(study, made_results, kept, kept_figures, drawn, tmp_path):
    """Of `two`, whose scenes are told as those of the others, what the differences are made of."""
    blocks = book.chapter_blocks(made_results, study, tmp_path)
    kept(f"chapter-{study}", blocks[-3:] if study == "two" else blocks)
    kept_figures(f"figures-{study}", drawn)


def test_the_first_and_the_last_pages_say_what_is_of_all_studies(made_results, kept):
    groups = groups_of_studies(made_results, map(made_results.manifest, STUDIES), drawn=False)
    verdicts = made_results.verdicts()
    passed = [{**verdicts[0], "verdict": "PASS", "id": f"{number}@0.2s", "reason": "so"} for number in range(3)]
    last = appendix(made_results, groups, [*verdicts, *passed], STUDIES, True)
    blocks = [*front_pages(None, groups, verdicts), *last]
    words = blocks.index(Heading("Twelve words", 2))
    kept("report", blocks[:words] + blocks[words + 2 :])
    assert not [name for name in CATALOGUE if name in str(blocks)]  # quantities have words


@pytest.mark.parametrize("name", ["waves-blocks", "beams-squares", "rigid-standing", "slope-base"])
def test_each_kind_of_scene_has_its_page_and_drawing(name, kept, kept_figures, drawn, tmp_path):
    scene = load_scene(name).expand()[0]
    kept(f"scene-{name}", scene_page(made_group(made_case(scene, {"dda": {}})), tmp_path))
    kept_figures(f"drawing-{name}", drawn)


def test_a_budget_says_how_the_discount_is_held_and_how_far_the_frequencies_are_off():
    for floors, rate, gg, told in (
        ((1.05, 1.052), None, 1.0, ["is 1.050 to 1.052 times"]),
        ((None, 1.05), 3.0, 0.9, ["is 1.050 times", "as a rate"]),
        ((None,), None, 0.9, ["gg acts per step"]),
    ):
        budgets = [{"floor": floor, "gg_rate": rate, "gg": gg} for floor in floors]
        said = budget._caption(budgets)
        words = ("is 1.050 to 1.052 times", "is 1.050 times", "as a rate", "gg acts per step")
        assert [word for word in words if word in said] == told


# ---- units ----------------------------------------------------------------------------------------------------------

FACTORS = {  # unit beside a number and that of the metric -> factor
    ("mm", "m"): 1e3, ("MPa", "Pa"): 1e-6, ("kPa", "Pa"): 1e-3, ("ms", "s"): 1e3, ("kN", "N"): 1e-3,
    ("MPa", "N"): 5e-7,  # of a force on the 2 m of the paper's block
}  # fmt: skip


def columns_and_lines(page):
    """Yield title, expression and factor of each column of the tables, and each line of the panels, of a page."""
    for described in page.get("table", {}).values():
        for column in described.get("columns", ()):
            if isinstance(column, dict):
                title = f"{column.get('group', '')} {column.get('title', '')}"
                yield title, column.get("of", ""), column.get("factor", 1.0)
    for described in page.get("panel", {}).values():
        title = f"{described.get('title', '')} {described.get('y_label', '')}"
        for line in described["lines"]:
            yield title, line.get("y", ""), line.get("y_factor", 1.0)


def test_a_metric_is_printed_in_the_unit_that_stands_beside_it():
    checked = 0
    for folder in study_folders().values():
        for path in folder.path.glob("*.toml"):
            if path.name in ("chapter.toml", "front.toml"):
                for title, expression, factor in columns_and_lines(tomllib.loads(path.read_text("utf-8"))):
                    metric = str(expression).partition(" else ")[0].rpartition(" ")[2]
                    unit = re.search(r"\[(mm|MPa|kPa|ms|kN|m|Pa|s|N)\]", title)
                    if unit and metric in CATALOGUE and ":" not in str(expression):
                        base = CATALOGUE[metric].unit
                        wanted = FACTORS[unit[1], base] if unit[1] != base else 1.0
                        assert abs(factor) == pytest.approx(wanted), (folder.name, title, expression)
                        checked += 1
    assert checked > 10


# ---- figures of their own -------------------------------------------------------------------------------------------

TIME = np.linspace(0.0, 0.1, 101)


def answers(*names):
    curves = []
    for number, name in enumerate(names, start=1):
        size, phase = np.array([4.0, 8.0, 2.0]) / number, np.array([0.1, -0.5 * number, 3.0])
        columns = {DISPLACEMENT: (1e-3 * size, phase), PRESSURE: (2e6 * size, phase)}
        curves.append(
            response.ResponseCurve(f"{name} as stepped", name, number > 1, np.array([1.0, 2.0, 4.0]), columns)
        )
    return curves


def panel(**values):
    histories = {name: made_history(0.1, v, 0 * v) for name, v in values.items()}
    return HistoryPanel(" ".join(2 * ascii_lowercase), histories, {"displacement": 1.0}, "bar")


def charts():
    x = np.array([1.0, 10.0, 20.0])
    run = ChartLine("dda", x, 2 * x, "#d55e00", shaded=(x, 3 * x), note=" (own)")
    other = ChartLine("program", x, 3 * x, "#000000", width=0, dots=3.2, hollow=True, notes=("1", "2", "3"))
    stated = {"marks": {"a/c": 12.0, "beyond": 99.0}, "levels": {"5 %": 5.0}}
    return [
        ChartPanel("Slip", "t [s]", "slip [mm]", (run, other), names="upper left", x_ticks=4, **stated),
        ChartPanel("Error", "n", "", (other, run), (0.5, 30.0), (1.0, 45.0), (True, True)),
        ChartPanel("", "", "", (run,), logarithmic=(False, True), x_ticks={1.0: "one"}, names="beside"),
        ChartPanel("Nothing", "t [s]", "", (), names="lower left"),
    ]


def figures(group):
    """Return figures that no chapter above draws."""
    moved, forces = np.array([0 * TIME, 1e-2 * TIME]), np.array([2e6 + 0 * TIME, 0 * TIME])
    weak = SpaceTime("weak", TIME, np.array([0.0, 1.0]), 0 * moved[:1], forces[:1] / 1e3)
    column = SpaceTime("two blocks", TIME, np.array([0.0, 1.0, 3.0]), moved, forces)
    steps = np.arange(1, 20_001)
    blown = panel(dda=np.where(steps > 9, 1e300, 1.0)[:20], bar=np.linspace(0, 1, 20), fem=np.linspace(0, 1.001, 20))
    fast = panel(dda=1 - np.cos(0.5 * steps))
    three = charts()
    slide = slide_figure(group)
    assert slide is not None
    return {
        "response": response.response_figure(answers("dda", "bar"), False),
        "response per metre": response.response_figure(answers("dda"), True, per_metre=True),
        "column": space_time_figure([column, weak], 46.0),
        "blown up": motion.history_figure([blown], "displacement", "contact_pressure", apart=True),
        "fast": motion.history_figure([fast], "displacement", apart=True),
        "slide": slide,
        "charts": chart_figure(three[3:]),
        "rows": chart_figure(three, [(30.0, 4.0), (20.0, 0.0)], Margins(top=12.0)),
        "shared": chart_figure([*three[:1] * 2, None], 40.0, Margins(), shared=True),
        "solution": solution_figure(
            made_history(0.1, [1.0, 2.0], [3.0, 4.0]), ["displacement", "contact_pressure"], "dda"
        ),
    }


def test_figures_hold_lines_names_and_axes(made_results, kept_figures):
    group = groups_of_studies(made_results, [made_results.manifest("mine")])["figures-3-4"]
    kept_figures("figures", figures(group))
