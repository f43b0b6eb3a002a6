"""ntdda's histories as a solver: the rows of its files, for the scenes whose problems they are and no others."""

from pathlib import Path

import numpy as np
import pytest
from peers import ntdda
from peers.ntdda import Histories

from validation.scenes.scene import load_scene

EXAMPLES = Path(__file__).resolve().parents[2] / "docs" / "examples" / "ntdda"


def rows(name):
    """Return the numbers of a measured-point file: step, time, dt, x, y, way, vx, vy, v."""
    text = (EXAMPLES / name).read_text().partition("[")[2].partition("]")[0]
    return np.array(text.split(), float).reshape(-1, 9)


def test_a_history_is_the_first_rows_of_its_file() -> None:
    found, told = Histories().solve(load_scene("field-opening")), rows("ntdda-p1E-dt2ms_meas.m")[:50]
    assert found["displacement"].shape == (50,)
    np.testing.assert_allclose(found["displacement"], told[:, 4] - 3, atol=1e-6)  # printed with seven digits


def test_a_block_on_a_slope_moves_sideways() -> None:
    found, told = Histories().solve(load_scene("field-creep")), rows("ntdda-phi22-slope20-dt2ms_meas.m")[:100]
    np.testing.assert_allclose(found["displacement"], told[:, 4] - 3, atol=2e-6)
    np.testing.assert_allclose(found["horizontal_displacement"], told[:, 3] - 5, atol=2e-6)


@pytest.mark.parametrize(
    ("name", "values", "field"),
    [
        ("field-opening", {"block.young": 2e9}, "block.young = 1e.09, not 2e.09"),
        ("field-opening", {"block.width": 2.0, "block.height": 2.1}, "block.outline"),
        ("field-opening", {"block.velocity": -0.1}, "block.velocity"),
        ("field-opening", {"contact.stiffness": 2e9}, "contact.stiffness"),
        ("field-opening", {"contact.gap": 1e-3}, "contact.gap"),
        ("field-opening", {"load.pressure": 4e6}, "load.pressure"),
        ("field-opening", {"load.eccentricity": 0.1}, "load.eccentricity"),
        ("field-opening", {"time.step": 1e-3}, "time.step"),
        ("field-opening", {"time.gg": 0.99}, "time.gg"),
        ("field-opening", {"time.steps": 201}, "200 steps, not 201"),
        ("field-creep", {"load.slope": 21.0}, "load.slope"),
        ("field-creep", {"contact.friction": 23.0}, "contact.friction"),
        ("field-creep", {"contact.shear_stiffness": 1e9}, "contact.shear_stiffness"),
        ("field-locked", {}, "contact.law = unilateral, not locked"),
        ("field-column", {}, "column"),
    ],
)
def test_another_problem_has_no_history(name, values, field) -> None:
    with pytest.raises(NotImplementedError, match=f"a history is data: .*{field}"):
        Histories().solve(load_scene(name).with_values(values))


def test_how_dda_steps_makes_no_other_problem() -> None:
    scene = load_scene("field-opening").with_values({"time.alpha": 0.25, "time.delta": 0.5, "time.steps": 200})
    assert len(Histories().solve(scene)["displacement"]) == 200


def test_away_from_the_repository_it_says_where_the_histories_are(monkeypatch) -> None:
    monkeypatch.setattr(ntdda, "PLACE", Path("nowhere"))
    with pytest.raises(NotImplementedError, match="docs/examples/ntdda of the repository"):
        Histories().solve(load_scene("field-opening"))
