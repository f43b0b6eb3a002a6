"""MuJoCo's adapter: what it refuses, that its default integrator is what it is said to be, and how near it comes."""

import sys
from importlib.util import find_spec
from pathlib import Path

import numpy as np
import pytest
from conftest import thinned

from validation.problems.problem import problem, problem_of
from validation.problems.truth import exact
from validation.scenes.scene import Scene, parse_scene

PEERS = Path(__file__).parents[2] / "examples" / "peers"
if str(PEERS) not in sys.path:
    sys.path.insert(0, str(PEERS))

from peers.mujoco import AsItComes, MuJoCo  # noqa: E402

# To look for it costs nothing; to import it takes seconds in every process that collects these tests.
installed = pytest.mark.skipif(not find_spec("mujoco"), reason="NOT RUN: mujoco is not installed")
ALL = ["displacement", "contact_pressure", "horizontal_displacement", "rotation"]


def changed(name, **values):
    """Return a problem's scene with other values, `table__key`."""
    return problem(name).scene.with_values({key.replace("__", "."): value for key, value in values.items()})


def error(found, truth, column):
    """Return the relative L2 difference of a column."""
    sound = truth[column]
    return float(np.linalg.norm(found[column][: len(sound)] - sound) / np.linalg.norm(sound))


def worst(scene, solver=None):
    """Return the greatest error of a scene's columns."""
    posed = problem_of(scene)
    truth, found = exact(scene, posed.truth).columns, (solver or MuJoCo()).solve(scene)
    return max(error(found, truth, column) for column in scene.run.columns)


def layered(**column):
    """Return two layers with a joint between them, driven from below."""
    layers = [
        {"thickness": 4.0, "density": 2000.0, "young": 2e9, "poisson": 0.2, "blocks": 4},
        {"thickness": 6.0, "density": 2500.0, "young": 5e9, "blocks": 3},
    ]
    given = {"motion": "shear", "layer": layers, "joint": [{"height": 4.0, "stiffness": 2e9}], "heights": [4.0, 6.3]}
    drive = {"at": "base", "shape": "ricker", "velocity": 0.1, "frequency": 40.0}
    run = {"columns": ["displacement", "contact_pressure", "displacement_1", "displacement_2"]}
    time = {"step": 0.001, "steps": 80}
    return parse_scene({"column": {**given, **column}, "input": drive, "time": time, "run": run}, "layers")


@installed
def test_its_default_integrator_is_semi_implicit_euler():
    """v1 = v0 + dt a(x0), x1 = x0 + dt v1 in centroid and strain: M = m diag(1, h^2/12), K of springs and strain."""
    scene = changed("locked", time__step=2e-4)
    a = h = 2.0
    m, p, E, q = 10800.0, 1e9, 1e9, 5e6
    K = 2 * p * np.array([[1, -h / 2], [-h / 2, h * h / 4]]) + np.diag([0.0, E * a * h])
    mass, load = np.array([m, m * h * h / 12]), -q * a * np.array([1.0, h / 2])
    x, v, expected = np.zeros(2), np.zeros(2), []
    for _ in range(scene.time.steps):
        v = v + scene.time.step * (load - K @ x) / mass
        x = x + scene.time.step * v
        expected.append(x[0])
    found = AsItComes().solve(scene)["displacement"]
    np.testing.assert_allclose(found, expected, rtol=0, atol=1e-9 * np.max(np.abs(expected)))


@installed
def test_its_default_box_slides_without_friction_as_semi_implicit_euler_falls():
    scene = changed("sliding", contact__friction=0.0)
    n = np.arange(1.0, scene.time.steps + 1)
    expected = 9.81 * np.sin(np.radians(28.9)) * scene.time.step**2 * n * (n + 1) / 2
    np.testing.assert_allclose(AsItComes().solve(scene)["horizontal_displacement"], expected, rtol=1e-9)


@installed
def test_its_default_diverges_at_the_step_of_the_problem_and_leaves_no_file(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    found = AsItComes().solve(problem("locked").scene)["displacement"]
    assert np.isfinite(found[0])
    assert np.isnan(found[-1])
    assert not list(tmp_path.iterdir())


@installed
def test_its_default_box_lands_and_does_not_bounce():
    scene = changed("rebound", time__steps=300)
    found = AsItComes().solve(scene)
    landed = found["displacement"][50:]
    assert -0.03 < np.min(landed) <= np.max(landed) < -scene.contact.gap + 1e-3
    weight = scene.block.mass * scene.load.gravity / scene.block.base_length
    assert found["contact_pressure"][-1] == pytest.approx(weight, rel=1e-2)


@installed
@pytest.mark.parametrize(
    ("scene", "within"),
    thinned(
        [
            (problem("locked").scene, 1e-5),
            (problem("opening").scene, 2e-4),
            (changed("rebound", time__steps=150), 1e-5),
            (changed("sliding", time__steps=10), 1e-5),
            (changed("creep", time__steps=25), 1e-4),
            (changed("rocking"), 1e-4),
            (problem("column").scene, 5e-4),
        ],
        4,
    ),
    ids=lambda value: value.name if isinstance(value, Scene) else "",
)
def test_comes_near_to_the_exact_motion(scene, within):
    assert worst(scene) < within


LEANING = {"block__poisson": 0.3, "load__eccentricity": 0.3, "run__columns": ALL}
MORE = {
    "every load on locked springs": changed(
        "locked", **LEANING, block__hypothesis="plane strain", load__traction=1e6, contact__shear_stiffness=3e8
    ),
    "glued corners that open": changed("opening", **LEANING, time__steps=15),
    "cohesion": changed("creep", load__slope=30.0, contact__cohesion=1e4, time__steps=15, run__columns=ALL),
    "a landing aslant": changed(
        "creep", contact__gap=1e-3, block__velocity=-0.1, load__slope=-30.0, time__steps=15, run__columns=ALL
    ),
    "layers and a joint": layered(),
    "springs below": layered(base="springs", base_stiffness=1e9),
    "a half-space below": layered(base="transmitting", base_density=2200.0, base_speed=1364.0),
    "a tilt to the right": changed("rocking", block__tilt=-10.0, block__width=1.5, load__gravity=3.0),
}


@installed
@pytest.mark.parametrize("name", thinned(MORE, 4))
def test_takes_what_the_problems_of_the_suite_do_not_ask(name):
    assert worst(MORE[name]) < 5e-3


@installed
def test_follows_a_base_that_moves_from_anywhere(tmp_path):
    t = np.arange(0, 0.05, 0.005)
    rows = [f"{a},{0.3 + 0.02 * np.sin(60 * a)},{0.002 * np.sin(80 * a)}" for a in t]
    (tmp_path / "base.csv").write_text("time,x,y\n" + "\n".join(rows) + "\n")
    moved = {"load__base_motion": str(tmp_path / "base.csv"), "time__steps": 40, "run__columns": ALL}
    assert worst(changed("locked", **moved, load__pressure=0.0)) < 1e-3
    assert worst(changed("creep", **moved, time__step=1e-3)) < 5e-3
