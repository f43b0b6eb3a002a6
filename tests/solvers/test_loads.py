"""Eccentric, sideways and volume loads and a moving base: DDA, finite elements and closed forms."""

from pathlib import Path

import numpy as np
import pytest
from conftest import SCENE, thinned
from oracles.plain_newmark import stepped

import dda
import fem_reference
from fem_reference.mesh.elasticity import translation
from fem_reference.mesh.model import assemble
from validation import load_scene, solve
from validation.errors import InputError

PENTAGON = [[1, 1], [3.1, 1.7], [2.9, 3.3], [1.5, 4], [0.7, 2]]
TRAPEZIUM = ((0.3, 0.1), (2.3, 0.4), (1.9, 1.6), (0.5, 1.4))
COLUMNS = ("displacement", "contact_pressure", "horizontal_displacement", "rotation")
RECORD = dda.BaseMotion([0.0, 0.011, 0.02, 0.05], [[1e-4, 0.0], [3e-3, 1e-3], [-1e-3, 2e-3], [0.0, 5e-4]])


def textbook_newmark(model, scheme, steps):
    """Return the columns by plain Newmark on absolute accelerations in D, the springs' base ends moving."""
    M, K, F = model.mass, model.stiffness, model.force
    tangent, normal, a = dda.contact.springs.base_directions(model.block, model.base)
    n_rows, t_rows = dda.spring_vectors(model.block, model.base)
    p, ps = model.contact.normal, model.contact.shear
    instants = scheme.step * np.arange(steps + 1)
    moved = model.load.motion.at(instants) if model.load.motion else np.zeros((steps + 1, 2))
    forces = F + np.outer(moved @ normal, p * n_rows.sum(0)) + np.outer(moved @ tangent, ps * t_rows.sum(0))
    D = stepped(M, K, forces, scheme)
    pressure = -p * (D @ n_rows.sum(0) - 2 * moved[1:] @ normal) / a
    return D[:, 1], pressure, D[:, 0], D[:, 2]


@pytest.mark.parametrize("start", ["zero", "consistent"])
@pytest.mark.parametrize(
    "loads",
    [
        {"pressure": 3e6, "eccentricity": 0.2},
        {"pressure": 0.0, "traction": 2e6},
        {"pressure": 0.0, "gravity": 9.81},
        {"pressure": 0.0, "motion": RECORD},
        {"pressure": -1e6, "eccentricity": -0.3, "traction": -2e6, "gravity": 9.81, "motion": RECORD},
    ],
    ids=lambda loads: "+".join(loads),
)
def test_histories_are_those_of_the_six_unknowns(loads, start):
    block = dda.Block(PENTAGON, dda.Material(2400.0, 2e9, 0.2))
    model = dda.TwoBlockModel(block, dda.Contact(3e9, 1e9), base=1, top=3, **loads)
    scheme = dda.Scheme(0.4, 0.7, 0.99, 1.3e-3, start)
    result = dda.solve(model, scheme, 60, COLUMNS)
    expected = textbook_newmark(model, scheme, 60)
    for name, values in zip(COLUMNS, expected, strict=True):
        # the textbook side loses the digits: soft springs, 60 steps, a conditioning of 1e3
        np.testing.assert_allclose(result.columns[name], values, rtol=0, atol=1e-11 * np.abs(values).max())


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


def problem(**changes):
    data = {"density": 2400.0, "young": 2e9, "poisson": 0.2, "hypothesis": "plane strain", "stiffness": 3e9}
    data |= {"shear_stiffness": 1e9, "pressure": 0.0, "foundation": "corner", "elements": 3, "degree": 1}
    return fem_reference.Problem(TRAPEZIUM, 0, 2, **(data | changes))


@pytest.mark.parametrize(
    "loads",
    thinned(
        [
            {"pressure": 3e6, "eccentricity": 0.2},
            {"pressure": 3e6, "eccentricity": -0.5},
            {"traction": 2e6},
            {"gravity": 9.81},
        ],
        3,
    ),
    ids=str,
)
@pytest.mark.parametrize("degree", [1, 2])
def test_loads_of_the_mesh_on_affine_fields_are_those_of_the_block(loads, degree):
    material = dda.Material(2400.0, 2e9, 0.2, "plane strain")
    block = dda.Block(TRAPEZIUM, material)
    model = dda.TwoBlockModel(block, dda.Contact(3e9, 1e9), **({"pressure": 0.0} | loads))
    assembled = assemble(problem(degree=degree, **loads))
    x, y = assembled.basis.doflocs + np.array(TRAPEZIUM[0])[:, None]
    component = translation(assembled.basis)[:, 1].astype(int)
    T = np.array([block.T(*point)[c] for point, c in zip(zip(x, y, strict=True), component, strict=True)])
    np.testing.assert_allclose(T.T @ assembled.F, model.force, rtol=0, atol=1e-13 * np.abs(model.force).max())
    rotation = assembled.observers["rotation"] @ T
    np.testing.assert_allclose(rotation, [0, 0, 1, 0, 0, 0], rtol=0, atol=1e-12)


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
        ("time,x\n0,a\n", "must be a table of numbers"),
        ("time,x\n", "header must begin with time and name every column"),
    ],
)
def test_records_are_checked(tmp_path, record, words):
    scene = load_scene(scene_with(tmp_path, 'base_motion = "quake.csv"', record))
    with pytest.raises(InputError, match=words):
        solve(scene, "dda")
