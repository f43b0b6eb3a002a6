"""Figures: nothing is lost by thinning, names never overlap, the same data give the same bytes."""

import numpy as np
import pytest

from validation.report.figures import curves, motion
from validation.report.figures import histories as figures
from validation.report.figures.space_time import SpaceTime
from validation.runs.history import History

SOLVERS = ("dda", "dda-textbook", "fem", "bar", "continuum", "somebody's own")


def test_thin_keeps_ends_and_every_spike():
    x = np.arange(20_000.0)
    y = np.sin(x / 50)
    y[[3, 7777, 19_990]] = 9.0, -9.0, 8.0
    tx, ty = curves.thin(x, y, 800)
    assert tx.size <= 802
    assert {3.0, 7777.0, 19_990.0, 0.0, 19_999.0} <= set(tx)
    assert np.all(np.diff(tx) > 0)
    assert np.array_equal(ty, y[tx.astype(int)])


def test_each_solver_has_one_style_and_no_two_share_it():
    styles = [curves.style_of(name) for name in SOLVERS]
    assert len({(s.color, s.dash) for s in styles}) == len(SOLVERS)
    others = [curves.style_of(f"solver {number}") for number in range(200)]
    assert {style.dash for style in others} == {(6.0, 2.0), (3.0, 1.5, 1.0, 1.5), (1.5, 1.0)}
    assert len({style.color for style in others}) == 6 and {(style.width, style.layer) for style in others} == {
        (1.0, 2)
    }
    assert curves.style_of("exact") == curves.LineStyle("#444444", (), 0.8, 1)
    assert curves.style_of("abaqus") == curves.LineStyle("#cc79a7", (1.5, 1.0), 1.0, 2)  # depends on the name alone


@pytest.mark.parametrize(("lift", "times"), [(0.0, 1.0), (50.0, 1.0), (1e-3, 500.0)])
def test_gaps_are_magnified_to_a_part_of_the_lowest_block(lift, times):
    time, faces = np.linspace(0.0, 0.1, 11), np.array([0.0, 1.0, 3.0])
    assert SpaceTime("", time, faces, np.array([0 * time, lift * time / 0.1]), np.zeros((2, 11))).magnification == times
    with pytest.raises(ValueError, match="shape"):
        SpaceTime("", time, faces, np.zeros((3, 11)), np.zeros((2, 11)))


def test_the_same_data_give_the_same_bytes(tmp_path):
    time = 0.001 * np.arange(1, 31)
    course = {solver: History(time, {"displacement": np.cos(30 * time + i)}) for i, solver in enumerate(SOLVERS)}
    panel = curves.HistoryPanel("dt = 0.001 s", course, {"displacement": -0.01}, "bar")
    first, second = (
        figures.save(motion.history_figure([panel], "displacement"), tmp_path / f"{name}.svg") for name in "ab"
    )
    assert first.read_bytes() == second.read_bytes()
    assert b"<text" not in first.read_bytes()  # letters are paths: no font is needed to show them
