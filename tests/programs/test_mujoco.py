"""MuJoCo's adapter: what it refuses, that its default integrator is what it is said to be, and how near it comes."""

import sys
from importlib.util import find_spec
from pathlib import Path

import numpy as np
import pytest

from validation.problems.problem import problem

PEERS = Path(__file__).parents[2] / "examples" / "peers"
if str(PEERS) not in sys.path:
    sys.path.insert(0, str(PEERS))

from peers.mujoco import AsItComes  # noqa: E402

# To look for it costs nothing; to import it takes seconds in every process that collects these tests.
installed = pytest.mark.skipif(not find_spec("mujoco"), reason="NOT RUN: mujoco is not installed")


def changed(name, **values):
    """Return a problem's scene with other values, `table__key`."""
    return problem(name).scene.with_values({key.replace("__", "."): value for key, value in values.items()})


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
def test_its_default_diverges_at_the_step_of_the_problem_and_leaves_no_file(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    found = AsItComes().solve(problem("locked").scene)["displacement"]
    assert np.isfinite(found[0])
    assert np.isnan(found[-1])
    assert not list(tmp_path.iterdir())
