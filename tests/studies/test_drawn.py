"""What chapters draw by themselves: a column whose contacts open, over time."""

from types import SimpleNamespace

import numpy as np

from validation.runs.history import History
from validation.scenes.scene import load_scene
from validation.studies.columns import chapter


def test_a_column_over_time_is_drawn_from_its_gaps_with_what_its_blocks_carry(monkeypatch, tmp_path):
    scene = load_scene("columns-drop-constant").expand()[0]
    time = np.array([0.5, 1.0])
    columns = {f"displacement_{n}": np.array([0.1 * n, 0.2]) for n in range(1, 6)}
    columns |= {f"force_{n}": np.array([float(n * n), 1.0]) for n in range(6, 11)}
    drawn = chapter.space_time(scene, History(time, columns), "dropped")
    start = -np.array([5.0, 5.5, 6.0, 6.5, 7.0]) * 1e-3  # the lowest gap is larger
    expected = np.array([[0.1, 0.2], [0.2, 0.2], [0.3, 0.2], [0.4, 0.2], [0.5, 0.2]]) - start[:, None]
    np.testing.assert_allclose(drawn.displacements, expected)
    np.testing.assert_allclose(drawn.forces[:, 0], [42.5, 56.5, 72.5, 90.5, 50.0])
    np.testing.assert_allclose(drawn.forces[:, 1], [1.0, 1.0, 1.0, 1.0, 0.5])
    line = SimpleNamespace(
        case=SimpleNamespace(scene=scene, histories=dict.fromkeys(["column-events", "dda"], History(time, columns)))
    )
    caught = []
    monkeypatch.setattr(chapter, "space_time_figure", lambda drawn, height: caught.append((len(drawn), height)))
    monkeypatch.setattr(chapter, "saved", lambda figure, *given: given[:2])
    for lines in ([line, line], [SimpleNamespace(case=None)], []):
        blocks = chapter.dropped(SimpleNamespace(lines=lambda query, lines=lines: lines), tmp_path)
        assert len(blocks) == bool(len(lines) > 1)
    assert caught == [(2, 46.0)]
    assert (drawn.title, drawn.time.tolist(), drawn.faces.tolist()) == ("dropped", [0.5, 1.0], [0, 1, 2, 3, 4, 5])
