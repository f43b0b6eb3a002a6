"""The picture of a column over time: bands of blocks, gaps between them, and how much displacements are magnified."""

import numpy as np
import pytest
from matplotlib.collections import QuadMesh

from validation.report.figures.space_time import MOST_INSTANTS, SpaceTime, space_time_figure

TIME = np.linspace(0.0, 0.1, 1001)
FACES = np.array([0.0, 1.0, 3.0])


def column(lift=1e-3, force=2e6, title="two blocks"):
    moved = np.array([np.zeros_like(TIME), lift * TIME / TIME[-1]])
    forces = np.array([np.full_like(TIME, force), np.zeros_like(TIME)])
    return SpaceTime(title, TIME, FACES, moved, forces)


def test_every_block_is_a_band_between_its_faces_with_the_gap_magnified():
    one = column()
    figure = space_time_figure([one], 46.0)
    lower, upper = (mesh for mesh in figure.axes[0].collections if isinstance(mesh, QuadMesh))
    assert one.magnification == 500.0  # the widest gap, 1 mm, is at most 0.6 of the lowest block's 1 m
    edges = np.asarray(upper.get_coordinates())[..., 1]
    assert edges[0, 0] == 1.0 and edges[0, -1] == pytest.approx(1.5) and edges[1, -1] == pytest.approx(3.5)
    assert edges.shape[1] <= MOST_INSTANTS
    assert np.ptp(np.asarray(lower.get_coordinates())[0, :, 1]) == 0
    assert np.all(np.asarray(lower.get_array()) == 2.0) and np.all(np.asarray(upper.get_array()) == 0.0)  # MPa


@pytest.mark.parametrize(("force", "unit"), [(2e6, "MPa"), (2e3, "kPa")])
def test_the_bar_of_colours_has_a_unit_that_suits_the_forces(force, unit):
    figure = space_time_figure([column(force=force), column(force=force)], 46.0)
    labels = [axes.get_ylabel() for axes in figure.axes]
    assert labels.count(f"force [{unit}]") == 2 and labels.count("height [m]") == 1


def test_a_column_that_does_not_open_is_drawn_as_it_is():
    assert column(lift=0.0).magnification == 1.0
    assert column(lift=50.0).magnification == 1.0  # never made smaller


def test_arrays_that_do_not_belong_together_are_refused():
    with pytest.raises(ValueError, match="must be of shape"):
        SpaceTime("", TIME, FACES, np.zeros((3, len(TIME))), np.zeros((2, len(TIME))))
