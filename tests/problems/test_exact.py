"""Exact motions by plain numbers: their values, and what importing and calling them loads."""

import math
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

from validation import exact
from validation.problems.problem import problem
from validation.problems.truth import exact as motion_of
from validation.scenes.drive import motion_at

ROOT = Path(__file__).parents[2]
BLOCK = {"width": 2.0, "height": 2.0, "density": 2700.0, "young": 1e9, "stiffness": 1e9}
CALLED = """
import sys
import numpy as np
from validation import exact
block = dict(width=2.0, height=2.0, density=2700.0, young=1e9, stiffness=1e9)
t = 0.002 * np.arange(1, 6)
exact.locked_block(t, **block, pressure=5e6)
exact.unilateral_block(t, **block, pressure=5e6)
exact.frictional_block(t, **block, shear_stiffness=4e8, friction=15.0, slope=20.0, gravity=9.81)
exact.rigid_slide(t, slope=30.0, friction=20.0)
print(*{name.partition(".")[0] for name in sys.modules})
"""


@pytest.mark.long
def test_the_blocks_ones_load_numpy_and_scipy_only():
    done = subprocess.run([sys.executable, "-c", CALLED], capture_output=True, text=True, check=True, cwd=ROOT)
    third = {"pydantic", "skfem", "meshio", "matplotlib", "mpmath", "typer", "dda"}
    assert "numpy" in done.stdout.split()
    assert not third & set(done.stdout.split())


@pytest.mark.parametrize(
    ("name", "function"),
    [("locked", "locked_block"), pytest.param("opening", "unilateral_block", marks=pytest.mark.long)],
)
def test_a_block_is_that_of_the_scene(name, function):
    asked = problem(name)
    wanted = motion_of(asked.scene, asked.truth)
    found = getattr(exact, function)(wanted.time, **BLOCK, pressure=5e6)
    assert found.displacement == pytest.approx(wanted.displacement, rel=1e-9)
    assert found.contact_pressure == pytest.approx(wanted.contact_pressure, rel=1e-9, abs=1e-3)
    assert bool(found.openings) is (name == "opening")


def test_a_block_slides_as_a_rigid_mass_but_for_its_springs():
    t = np.array([0.05, 0.1])
    found = exact.frictional_block(t, **BLOCK, shear_stiffness=4e8, friction=0.0, slope=30.0, gravity=9.81)
    rigid = exact.rigid_slide(t, slope=30.0, friction=0.0)
    assert found.horizontal_displacement == pytest.approx(rigid, rel=1e-6)
    assert np.all(exact.rigid_slide(t, slope=10.0, friction=20.0) == 0.0)


def test_a_column_lets_a_pulse_pass():
    asked = problem("column")
    wanted, layer = motion_of(asked.scene, asked.truth), asked.scene.column.layer[0]
    made = {"thickness": [layer.thickness], "density": [layer.density], "young": [layer.young]}
    places = {"heights": [3.5, 8.5], "impedance": 2e6}
    t, found = exact.layered_column(0.0005, 200, lambda t: motion_at(asked.scene, t).pressure, **made, **places)
    assert t == pytest.approx(wanted.time)
    assert found[0] == pytest.approx(wanted.columns["displacement_1"], abs=1e-9)


@pytest.mark.parametrize("time", [[-1.0], [0.0], [0.2, 0.1], [math.nan]])
def test_instants_that_do_not_rise_from_zero_are_refused(time):
    with pytest.raises(ValueError, match=r"^time: "):
        exact.locked_block(time, **BLOCK, pressure=5e6)
