"""Eccentric, sideways and volume loads and a moving base: DDA, finite elements and closed forms."""

from pathlib import Path

import numpy as np
import pytest
from conftest import SCENE

import dda
from validation import load_scene, solve
from validation.errors import InputError

COLUMNS = ("displacement", "contact_pressure", "horizontal_displacement", "rotation")


def test_a_base_that_moves_as_a_whole_carries_the_block_however_stiff_the_springs():
    block = dda.Block.rectangle(2.0, 2.0, dda.Material(2700.0, 1e9, 0.0))
    ramp = dda.BaseMotion([0.0, 1.0], [[0.0, 0.0], [0.0, 1e-3]])
    # From the first step on the ramp moves the base at 1e-3 m/s: the springs hold what accelerates the mass.
    scheme = dda.Scheme(0.5, 1.0, 1.0, 1e-3)
    pressures = []
    for p in (1e17, 1e20):
        model = dda.TwoBlockModel(block, dda.Contact(p), 0.0, motion=ramp)
        pressures.append(dda.solve(model, scheme, 500, ("contact_pressure",)).columns["contact_pressure"])
    # The contact mode's root is -1 + 8 / Omega^2, Omega^2 = 2e7 at the softer: 2e-4 over 500 steps. Digits lost in
    # p times a difference of displacements would be 5e6 Pa.
    assert np.max(np.abs(pressures[0] - pressures[1])) < 5e-4 * np.max(np.abs(pressures[1]))


def scene_with(tmp_path: Path, load: str, record: str | None = None) -> Path:
    text = SCENE.replace("pressure = 5.0e6", load) + '[run]\nsolvers = ["dda", "fem"]\n'
    text += f"columns = {list(COLUMNS)!r}\n"
    path = tmp_path / "loads.toml"
    path.write_text(text)
    if record is not None:
        (tmp_path / "quake.csv").write_text(record)
    return path


LOADS = ("pressure = 1e6\neccentricity = 0.2", "traction = 2e5", "gravity = 9.81", 'base_motion = "quake.csv"')
QUAKE = "time,x,y\n0,0,0\n0.01,1e-3,2e-4\n0.5,0,0\n"


@pytest.mark.parametrize("solver", ["dda", "fem"])
def test_a_scene_hands_every_load_to_the_solver_and_their_effects_add_up(tmp_path, solver):
    alone, together = (
        [solve(load_scene(scene_with(tmp_path, load, QUAKE)), solver).history for load in loads]
        for loads in (LOADS, ("\n".join(LOADS),))
    )
    for name in COLUMNS:
        values = np.array([history.columns[name] for history in alone])
        scale = np.abs(values).max()
        np.testing.assert_allclose(values.sum(0), together[0].columns[name], rtol=0, atol=1e-10 * scale)
    moved = np.array([[np.abs(h.columns[name]).max() for name in COLUMNS] for h in alone])
    # weight moves nothing sideways and nothing turns; a traction leaves the mean pressure alone
    seen = moved > 1e-9 * moved.max(axis=0)
    assert seen.tolist() == [[True] * 4, [False, False, True, True], [True, True, False, False], [True] * 4]


@pytest.mark.parametrize(
    ("record", "words"),
    [
        (None, "cannot be read"),
        ("time,z\n0,0\n", "header must be time,x or time,y or time,x,y"),
        ("time,x\n0,0\n0,1\n", "time must increase from row to row, got 0 after 0"),
        ("time,x\n0,nan\n", "must hold finite numbers"),
        ("time,x\n0,a\n", ":2:3: must be a number, got 'a'"),
        ("time,x\n", "must hold rows of numbers under the header"),
    ],
)
def test_records_are_checked(tmp_path, record, words):
    scene = load_scene(scene_with(tmp_path, 'base_motion = "quake.csv"', record))
    with pytest.raises(InputError, match=words):
        solve(scene, "dda")
