"""Figures: nothing is lost by thinning, names never overlap, the same data give the same bytes."""

from dataclasses import replace

import numpy as np
import pytest
from matplotlib.figure import Figure
from oracles.made_cases import made_history

from validation.report.figures import curves, motion
from validation.report.figures import histories as figures
from validation.report.figures.drawing import FigureHooks
from validation.report.figures.space_time import SpaceTime
from validation.report.scene.hooks import ShowingHooks
from validation.scenes.scene import load_scene

SOLVERS = ("dda", "dda-textbook", "fem", "bar", "continuum", "somebody's own")


def test_a_kind_of_scene_that_nobody_draws_is_an_empty_sheet():
    axes = Figure().add_subplot()
    FigureHooks().draw(axes, None)
    assert not axes.axison and not axes.lines
    across, rows = ShowingHooks().drawing(load_scene("rigid-impact").expand()[0], None)
    assert across == 0 and [words.split()[0] for _, words in rows] == ["young", "density", "gravity"]


def test_rows_are_filled_evenly():
    assert [motion._columns(count) for count in (5, 6, 11)] == [5, 3, 4]


def test_a_solver_lies_on_another_that_it_equals_in_every_panel():
    x, off = np.arange(1.0, 5.0), np.array([0.0, 0.01, 0.0, 0.0])
    columns = {
        "dda": (x, x),
        "bar": (x + off / 10, x),
        "fem": (x, x + off),
        "layers": (x,),
        "continuum": (np.inf * x, x),
    }
    columns |= {"block-events": (x[:3], x[:3]), "bar-events": (x, x + off)}
    histories = {name: made_history(0.1, *own) for name, own in columns.items()}
    first = curves.HistoryPanel("", histories, {"displacement": 100.0}, None)
    second = replace(first, histories={"dda": histories["layers"], "bar-events": histories["fem"]})
    found = motion.twins([first, second], ["displacement", "contact_pressure", "slip"])
    assert found.pop("dda") == {"bar": pytest.approx(1e-5)} and len(found) == 5 and not any(found.values())
    assert {*motion.twins([first], ["displacement"])["dda"]} == {"bar", "fem", "layers", "bar-events"}


def test_thin_keeps_ends_and_every_spike():
    x = np.arange(20_000.0)
    y = np.sin(x / 50)
    y[[3, 7777, 19_990]] = 9.0, -9.0, 8.0
    tx, ty = curves.thin(x, y, 800)
    assert tx.size == 800
    assert {3.0, 7777.0, 19_990.0, 0.0, 19_999.0} <= set(tx)
    assert np.all(np.diff(tx) > 0)
    assert np.array_equal(ty, y[tx.astype(int)])


def test_each_solver_has_one_style_and_no_two_share_it():
    styles = [curves.style_of(name) for name in (*SOLVERS, *(f"solver {number}" for number in range(99)))]
    assert len({(style.color, style.dash) for style in styles[: len(SOLVERS)]}) == len(SOLVERS)
    assert len({(style.color, style.dash) for style in styles[len(SOLVERS) :]}) == 18  # six colours, three dashes
    assert curves.style_of("exact") == curves.LineStyle("#444444", (), 0.8, 1)
    assert curves.style_of("abaqus") == curves.LineStyle("#cc79a7", (1.5, 1.0), 1.0, 2)  # depends on the name alone


@pytest.mark.parametrize(("lift", "times"), [(0.0, 1.0), (2e-3, 200.0), (50.0, 1.0), (1e-3, 500.0)])
def test_gaps_are_magnified_to_a_part_of_the_lowest_block(lift, times):
    time, faces = np.linspace(0.0, 0.1, 11), np.array([0.0, 1.0, 3.0])
    assert SpaceTime("", time, faces, np.array([0 * time, lift * time / 0.1]), np.zeros((2, 11))).magnification == times
    with pytest.raises(ValueError, match="shape"):
        SpaceTime("", time, faces, np.zeros((3, 11)), np.zeros((2, 11)))


def test_the_same_data_give_the_same_bytes(tmp_path):
    """Letters are paths: no font is needed to show them."""
    drawn = []
    for name in ("a.svg", "b.svg"):
        figure = Figure(figsize=(1.0, 1.0))
        figure.text(0.5, 0.5, "x")
        drawn.append(figures.save(figure, tmp_path / name).read_bytes())
    assert drawn[0] == drawn[1] and b"<use" in drawn[0] and b"<text" not in drawn[0]
