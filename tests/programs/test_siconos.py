"""Siconos as a solver: its schemes against independent predictions, and what is refused by field."""

import math
import subprocess
import sys

import numpy as np
import pytest
from oracles.absent import answer_of
from oracles.box_scenes import box_scene
from peers import siconos
from peers.siconos_column import Chain

from validation.scenes.scene import load_scene
from validation.solvers.registry import get_solver

MOVED = ["displacement", "contact_pressure", "horizontal_displacement", "rotation"]


def test_a_python_without_numpy_has_no_siconos():
    """Debian's own Python where the package is absent: -S leaves out what is installed beside the standard library."""
    done = subprocess.run([sys.executable, "-I", "-S", str(siconos.PROGRAM), "none", "none"], capture_output=True)
    assert done.returncode == siconos.ABSENT, done.stderr


def scene(name, **values):
    return load_scene(f"field-{name}").with_values({key.replace("__", "."): value for key, value in values.items()})


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


def test_springs_of_a_box_that_turns_or_rubs_are_refused():
    with pytest.raises(NotImplementedError, match=r"plane\.contact\.stiffness"):
        siconos.Siconos().solve(box_scene(stiffness=1e6, friction=10.0))


@pytest.mark.long
@both
def test_the_peak_force_is_that_of_a_mass_on_the_stiffness_of_the_scene(solver):
    scene = box_scene({"lift": 0.1}, stiffness=1e6, step=0.001, steps=200)
    expected = 9810.0 + math.sqrt(9810.0**2 + 2 * 9810.0 * 0.1 * 1e6)
    assert answer_of(solver, scene)["box_1-ground.normal"].max() == pytest.approx(expected, rel=1e-3)
