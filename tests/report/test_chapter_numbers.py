"""The numbers in the chapters of the paper, of stiff contacts and of extremes, from results made by hand."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from matplotlib.colors import to_hex
from matplotlib.figure import Figure
from oracles.made_cases import lines_of, made_case, made_group, made_history, names_at, rules_of

from validation.report.blocks import Heading, Table
from validation.report.figures.curves import style_of
from validation.runs.results import Results
from validation.scenes.scene import load_scene
from validation.studies.paper import chapter as chapters_paper
from validation.studies.paper.chapter import PaperFigure

BASE = load_scene("figures-3-4").with_values({"time.step": 0.002, "time.steps": 40})
GREY = "#6b6b6b"


# ---- the paper's figures ------------------------------------------------------------------------------------------

PAPER_METRICS = {
    "displacement.static": -0.01,
    "pressure.static": 5e6,
    "displacement.settling_step": 12.0,
    "pressure.settling_step": 17.0,
    "displacement.fine_settling_step": 22.0,
    "pressure.fine_settling_step": 27.0,
}


@pytest.mark.parametrize(
    ("quantity", "relative", "value", "level", "settled", "unit"),
    [
        ("displacement", False, -12.0, -10.0, 12.0, "[mm]"),
        ("pressure", False, 6.5, 5.0, 17.0, "[MPa]"),
        ("displacement", True, 20.0, 0.0, None, "[%]"),
    ],
)
def test_the_papers_figures_are_in_their_units(
    quantity: str,
    relative: bool,
    value: float,
    level: float,
    settled: float | None,
    unit: str,
    drawn: dict[str, Figure],
    tmp_path: Path,
) -> None:
    history = made_history(0.002, np.full(40, -0.012), np.full(40, 6.5e6))
    group = made_group(made_case(BASE, {"dda": PAPER_METRICS}, {"dda": history}))
    figure = PaperFigure(3, "s", quantity, 30, "Caption", relative)
    caption = chapters_paper.figure_block(figure, group, tmp_path).caption
    assert ("Dashed: step from which DDA stays" in caption) == (settled is not None)
    (axes,) = drawn["figure-3.svg"].axes
    orange = to_hex(style_of("dda").color)
    (line,) = [y for own, x, y in lines_of(axes) if own == orange and x.size == 30]
    assert np.allclose(line, value) and axes.get_ylabel().endswith(unit)
    assert rules_of(axes, GREY) == ([pytest.approx(level)], [] if settled is None else [settled])


def test_each_figure_of_the_paper_shows_what_its_caption_says() -> None:
    assert [figure.number for figure in chapters_paper.FIGURES] == [3, 4, 5, 6, 7, 8, 9]
    for figure in chapters_paper.FIGURES:
        assert figure.quantity in figure.caption.lower() and figure.relative == ("Relative error" in figure.caption)


def test_the_continuum_is_left_out_where_its_period_has_too_few_steps(drawn: dict[str, Figure], tmp_path: Path) -> None:
    """A period of 2 pi / 300 = 21 ms has ten steps of 2 ms and five of 4 ms."""
    history = made_history(0.002, np.full(40, -0.012), np.full(40, 6.5e6))
    captions = []
    for step in (0.002, 0.004):
        rows = {"dda": PAPER_METRICS, "bar": {"mode1.frequency": 300.0}, "continuum": {}}
        case = made_case(BASE.with_values({"time.step": step}), rows, {"dda": history, "continuum": history})
        figure = PaperFigure(3 if step == 0.002 else 4, "s", "displacement", 30, "Caption")
        captions.append(chapters_paper.figure_block(figure, made_group(case), tmp_path).caption)
    assert ["continuum is left out" in caption for caption in captions] == [False, True]
    assert [set(names_at(figure.axes[0])) for figure in drawn.values()] == [{"dda", "continuum"}, {"dda"}]


def test_statements_and_slips_stand_under_their_own_headings(tmp_path: Path) -> None:
    told = [{"id": name, "says": "it", "place": "p. 1", "why": "so", "condition": ""} for name in ("S1", "C1", "C2")]
    blocks = chapters_paper.chapter(Results(tmp_path), {"study": "paper", "data": {"claims": told}}, tmp_path)
    at = [block.text if isinstance(block, Heading) else [row[0] for row in block.rows]
          for block in blocks if isinstance(block, Heading | Table)]  # fmt: skip
    assert at == ["paper", "Statements", ["C1", "C2"], "Slips of the equations", ["S1"], "The figures"]


def test_the_operators_of_figure_1_lie_at_w_dt() -> None:
    metrics = {
        "mode1.frequency": 300.0,
        "mode1.spectral_radius": 0.8,
        "contact.frequency": 900.0,
        "contact.spectral_radius": 0.5,
    }
    cases = [made_case(BASE.with_values({"time.step": step}), {"dda": metrics}) for step in (0.002, 1e-4)]
    assert chapters_paper._points(cases) == [
        (pytest.approx(0.6), 0.8), (pytest.approx(1.8), 0.5),
    ]  # fmt: skip  # w dt = 0.03 and 0.09 lie outside the figure


def test_the_register_counts_and_words_each_verdict() -> None:
    rows = {name: {"verdict": verdict} for name, verdict in
            (("a", 0.0), ("b", 0.0), ("c", 1.0), ("d", 2.0), ("e", 2.0), ("f", 2.0))}  # fmt: skip
    assert chapters_paper.conclusion(rows) == (
        "Of 6 statements and equations of the paper @feng2017 that were tested, 3 are confirmed, 1 holds under a "
        "condition that the paper does not name, 2 are refuted."
    )
    claim = {"id": "a", "says": "It is so", "place": "page 1", "why": "it is not", "condition": "never"}
    table = chapters_paper.claims_table([claim], {"a": {"verdict": 0.0, "steps": 44.0, "share": "undefined"}})
    assert table.rows == (
        ("a", "refuted", "It is so (page 1)", "It is not.", "steps 44; share undefined"),
    )  # fmt: skip


# ---- stiff contacts -----------------------------------------------------------------------------------------------


# ---- extremes -----------------------------------------------------------------------------------------------------
