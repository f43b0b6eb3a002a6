"""What chapters draw by themselves: a column whose contacts open, over time."""

import numpy as np

from validation.runs.history import History
from validation.scenes.scene import load_scene
from validation.studies.columns.chapter import space_time


def test_a_column_over_time_is_drawn_from_its_gaps_with_what_its_blocks_carry():
    scene = load_scene("columns-drop-constant").expand()[0]
    time = np.array([0.5, 1.0])
    columns = {f"displacement_{n}": np.array([0.1 * n, 0.2]) for n in range(1, 6)}
    columns |= {f"force_{n}": np.array([float(n * n), 1.0]) for n in range(6, 11)}
    drawn = space_time(scene, History(time, columns), "dropped")
    start = -np.array([5.0, 5.5, 6.0, 6.5, 7.0]) * 1e-3  # the lowest gap is larger
    expected = np.array([[0.1, 0.2], [0.2, 0.2], [0.3, 0.2], [0.4, 0.2], [0.5, 0.2]]) - start[:, None]
    np.testing.assert_allclose(drawn.displacements, expected)
    np.testing.assert_allclose(drawn.forces[:, 0], [42.5, 56.5, 72.5, 90.5, 50.0])
    np.testing.assert_allclose(drawn.forces[:, 1], [1.0, 1.0, 1.0, 1.0, 0.5])
    assert (drawn.title, drawn.time.tolist(), drawn.faces.tolist()) == ("dropped", [0.5, 1.0], [0, 1, 2, 3, 4, 5])
