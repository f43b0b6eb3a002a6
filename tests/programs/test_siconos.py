"""Siconos as a solver: its schemes against independent predictions, and what is refused by field."""

import functools
import math
import subprocess
import sys

import numpy as np
import pytest
from oracles.box_scenes import box_scene
from peers import siconos
from peers.siconos_column import Chain

from validation import solve
from validation.models.plane.boxes import boxes_of
from validation.problems.problem import problem_of
from validation.problems.truth import exact
from validation.scenes.scene import load_scene
from validation.solvers.registry import get_solver

MOVED = ["displacement", "contact_pressure", "horizontal_displacement", "rotation"]


@functools.cache
def installed():
    try:
        return subprocess.run([siconos.PYTHON, "-c", "import siconos.kernel"], capture_output=True).returncode == 0
    except OSError:
        return False


@pytest.fixture
def program():
    if not installed():
        pytest.skip("NOT RUN: siconos is not installed")


def test_a_python_without_numpy_has_no_siconos():
    """Debian's own Python where the package is absent: -S leaves out what is installed beside the standard library."""
    done = subprocess.run([sys.executable, "-I", "-S", str(siconos.PROGRAM), "none", "none"], capture_output=True)
    assert done.returncode == siconos.ABSENT, done.stderr


def scene(name, **values):
    return load_scene(f"field-{name}").with_values({key.replace("__", "."): value for key, value in values.items()})


def differences(given, solver):
    """Relative L2 differences of the answer's columns from the exact motion."""
    posed = problem_of(given)
    truth, found = exact(posed.scene, posed.truth), solver.solve(given)
    size = len(truth.time)
    return {
        name: np.linalg.norm(found[name][:size] - truth.columns[name]) / np.linalg.norm(truth.columns[name])
        for name in given.run.columns
        if name in found
    }


@pytest.mark.long
def test_the_default_integrator_is_the_suites_newmark_with_a_quarter_and_a_half(program):
    """With theta = 1/2: average acceleration, from an acceleration that balances the loads at t = 0."""
    given = scene("locked", block__poisson=0.2, load__eccentricity=0.3, load__traction=1e6, run__columns=MOVED)
    scheme = {"time.alpha": 0.25, "time.delta": 0.5, "time.start": "consistent"}
    predicted, found = solve(given.with_values(scheme), "dda").history, siconos.AsItComes().solve(given)
    for name in MOVED:
        np.testing.assert_allclose(found[name], predicted.columns[name], rtol=0, atol=1e-9 * np.abs(found[name]).max())


SLOWER = [
    (scene("opening", time__steps=30, contact__gap=0.01, block__velocity=-1.0), 2e-3),
    (scene("opening", time__steps=30, load__traction=1e6, run__columns=MOVED), 2e-2),
    (scene("opening", time__steps=30, load__eccentricity=0.3, contact__friction=30.0, run__columns=MOVED), 2e-3),
    (scene("creep", time__steps=30), 2e-3),
    (scene("rocking", time__step=0.02, time__steps=30, block__tilt=-10.0), 1e-3),
    (scene("column", time__step=0.002, time__steps=40), 1e-3),
]


@pytest.mark.parametrize(
    ("given", "below"),
    [
        (scene("locked", time__steps=20), 2e-3),
        pytest.param(scene("opening", time__steps=30), 2e-3, marks=pytest.mark.long),
        *(pytest.param(*given, marks=pytest.mark.long) for given in SLOWER),
    ],
    ids=["locked", "opening", "gap", "glued", "off-centre", "creep", "rocking", "column"],
)
def test_settings_for_accuracy_come_near_to_the_exact_motion(program, given, below):
    found = differences(given, siconos.Siconos())
    assert found
    assert max(found.values()) < below, found


@pytest.mark.long
def test_its_own_rigid_contact_rocks(program):
    assert differences(scene("rocking"), siconos.AsItComes())["rotation"] < 1e-2


@pytest.mark.long
def test_cohesion_is_refused_where_a_corner_opens_and_taken_where_none_does(program):
    with pytest.raises(NotImplementedError, match=r"contact\.cohesion: is lost"):
        siconos.Siconos().solve(scene("sliding", time__steps=2, contact__gap=0.1, contact__cohesion=1e3))


def test_the_springs_matrices_hold_the_suites_static_solution():
    given = scene("locked", block__poisson=0.2, load__eccentricity=0.3, load__gravity=9.81, load__slope=10.0)
    of, p = siconos.matrices(given, 2.0, 2.0), 1e9
    q = np.linalg.solve(of["K"] + p * of["gap"].T @ of["gap"] + p * of["slide"].T @ of["slide"], of["F"])
    static = get_solver("dda").static(given)
    assert -p * (of["gap"] @ q).sum() / 2 == pytest.approx(static["contact_pressure"], rel=1e-9)
    assert q[1] == pytest.approx(static["displacement"], rel=1e-9)


def test_a_chain_has_the_columns_mass_and_compliance():
    joints = [{"height": 0.0, "stiffness": 2e8}, {"height": 6.0, "stiffness": 1e8}]
    given = scene("column", column__joint=joints)
    for fine in (True, False):
        chain = Chain.of(given, fine)
        assert chain.M.sum() == pytest.approx(12.0 * 2000.0, rel=1e-12)
        moved = np.linalg.solve(chain.K[1:, 1:], np.eye(len(chain.K) - 1)[-1])
        assert moved[-1] == pytest.approx(12.0 / 2e9 + 1 / 2e8 + 1 / 1e8, rel=1e-9)
        assert chain.row_at(8.5)[1:] @ moved == pytest.approx(8.5 / 2e9 + 1 / 2e8 + 1 / 1e8, rel=1e-9)
        assert chain.row_at(6.0)[1:] @ moved == pytest.approx(6.0 / 2e9 + 1 / 2e8, rel=1e-9)


both = pytest.mark.parametrize("solver", [siconos.Siconos(), siconos.AsItComes()], ids=["chosen", "default"])
SLOPE = math.radians(20.0)
GAUSS_SEIDEL = 1e-3  # ten times the tolerance of Siconos' own iteration; pivots leave rounding


def tolerance(solver):
    """Return how far a contact impulse may be from what it should be, relative."""
    return 1e-9 if solver.fine else GAUSS_SEIDEL


def test_springs_of_a_box_that_turns_or_rubs_are_refused():
    with pytest.raises(NotImplementedError, match=r"plane\.contact\.stiffness"):
        siconos.Siconos().solve(box_scene(stiffness=1e6, friction=10.0))


@both
def test_a_box_flies_and_spins_as_the_midpoint_rule_does(program, solver):
    scene = box_scene({"lift": 50.0, "tilt": 30.0, "velocity": (3.0, 1.0), "spin": 9.0}, slope=20.0, steps=20)
    _, height, angle = boxes_of(scene).starts[0]
    t = scene.time.step * np.arange(1, scene.time.steps + 1)
    columns = solver.solve(scene)
    np.testing.assert_allclose(columns["box_1.x"], 3 * t + 9.81 * math.sin(SLOPE) * t**2 / 2, atol=1e-9)
    np.testing.assert_allclose(columns["box_1.y"], height + t - 9.81 * math.cos(SLOPE) * t**2 / 2, atol=1e-9)
    np.testing.assert_allclose(columns["box_1.angle"], angle + 9 * t, atol=1e-9)


@both
@pytest.mark.parametrize(("friction", "density"), [(0.0, 1000.0), (15.0, 1000.0), (15.0, 10.0)])
def test_a_box_slides_as_the_midpoint_rule_does_whatever_its_mass(program, solver, friction, density):
    scene = box_scene({"density": density}, slope=20.0, friction=friction, steps=20)
    held = math.tan(math.radians(friction)) * 9.81 * math.cos(SLOPE)
    t = scene.time.step * np.arange(1, scene.time.steps + 1)
    columns = solver.solve(scene)
    expected = (9.81 * math.sin(SLOPE) - held) * t**2 / 2
    np.testing.assert_allclose(columns["box_1.x"], expected, atol=tolerance(solver) * held * t[-1] ** 2 / 2 + 1e-9)
    assert columns["box_1-ground.normal"][-1] == pytest.approx(density * 9.81 * math.cos(SLOPE), rel=GAUSS_SEIDEL)


@both
@pytest.mark.parametrize("restitution", [0.0, 0.5, 1.0])
def test_a_box_comes_back_at_e_times_the_speed_it_came_with(program, solver, restitution):
    box = {"velocity": (0.0, -2.0), "lift": 0.01}
    scene = box_scene(box, gravity=0.0, restitution=restitution, steps=4)
    rebound = np.diff(solver.solve(scene)["box_1.y"])[-1] / scene.time.step
    assert rebound == pytest.approx(2 * restitution, abs=4 * tolerance(solver))


@both
def test_a_ground_that_moves_takes_a_box_along(program, solver):
    """From t to t + h the box bears what changes the velocity of its frame as that of the ground, exactly.

    Not at 45 degrees, where the arms of friction and weight of a cube are equal: there the pivots go astray.
    """
    scene = box_scene(friction=40.0, base=(0.1, 1.0), steps=50)
    t = scene.time.step * np.arange(1, scene.time.steps + 1)
    expected = [boxes_of(scene).base(time)[0] for time in t]
    np.testing.assert_allclose(solver.solve(scene)["box_1.x"], expected, atol=0.1 * tolerance(solver))


@both
def test_the_peak_force_is_that_of_a_mass_on_the_stiffness_of_the_scene(program, solver):
    scene = box_scene({"lift": 0.1}, stiffness=1e6, step=0.001, steps=200)
    expected = 9810.0 + math.sqrt(9810.0**2 + 2 * 9810.0 * 0.1 * 1e6)
    assert solver.solve(scene)["box_1-ground.normal"].max() == pytest.approx(expected, rel=1e-3)


def test_forces_of_a_pile_are_the_weights_above(program):
    boxes = ({}, {"density": 500.0, "width": 0.5, "x": 0.1}, {"density": 2000.0, "height": 0.3})
    scene = box_scene(*boxes, friction=30.0, steps=10)
    columns = siconos.Siconos().solve(scene)
    forces = [columns[name][-1] for name in boxes_of(scene).force_columns]
    assert forces == pytest.approx([9.81 * 1850.0, 9.81 * 850.0, 9.81 * 600.0], rel=GAUSS_SEIDEL)
