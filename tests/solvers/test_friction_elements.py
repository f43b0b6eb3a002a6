"""Elements with friction beside the block of one strain: the rigid limit, statics, refusals."""

from pathlib import Path

import numpy as np
import pytest

from validation import solve
from validation.errors import InputError
from validation.scenes.scene import Scene, load_scene
from validation.solvers.registry import get_solver

CONTACT = {"law": "unilateral", "stiffness": 1e9, "shear_stiffness": 4e8, "friction": 25.0, "cohesion": 2e3}
LOAD = {"gravity": 9.81, "slope": 28.0, "pressure": 5e4, "eccentricity": 0.5, "traction": -2e4}
COLUMNS = ["displacement", "contact_pressure", "horizontal_displacement"]


@pytest.fixture
def scene() -> Scene:
    """A block on an incline with two corners, its load off its middle."""
    values = {"contact": CONTACT, "load": LOAD, "time.step": 1e-3, "time.steps": 150, "run.columns": COLUMNS}
    return load_scene("unlocked").expand()[1].with_values(values | {"fem": {"elements": 2, "foundation": "corner"}})


def test_a_block_at_rest_on_its_incline_bears_its_weight_in_two_parts(scene: Scene) -> None:
    """Statics of both models: N = W cos b and T = -W sin b, whatever has slid before."""
    at_rest = {"load": {"gravity": 9.81, "slope": 20.0}, "contact.friction": 30.0, "time.step": 0.02, "time.gg": 0.5}
    weight, angle = 10800 * 9.81, np.radians(20.0)
    case = scene.with_values({**at_rest, "run.columns": [*COLUMNS[1:2], "base_shear"], "fem.foundation": "distributed"})
    found = solve(case, "fem").history
    assert 2.0 * found.columns["contact_pressure"][-1] == pytest.approx(weight * np.cos(angle), rel=1e-6)
    assert 2.0 * found.columns["base_shear"][-1] == pytest.approx(-weight * np.sin(angle), rel=1e-6)
    case = scene.with_values({**at_rest, "run.columns": ["contact_pressure", "shear_force_m", "shear_force_n"]})
    block = solve(case, "dda").history
    assert 2.0 * block.columns["contact_pressure"][-1] == pytest.approx(weight * np.cos(angle), rel=1e-6)
    shear = block.columns["shear_force_m"][-1] + block.columns["shear_force_n"][-1]
    assert shear == pytest.approx(-weight * np.sin(angle), rel=1e-6)


def test_a_column_that_elements_do_not_have_is_refused(scene: Scene) -> None:
    with pytest.raises(InputError, match="must be among"):
        solve(scene.with_values({"run.columns": ["slide_m"]}), "fem")


def test_without_friction_no_slip_is_reported(scene: Scene) -> None:
    glued = {key: value for key, value in CONTACT.items() if key not in ("friction", "cohesion")}
    prepared = get_solver("fem").prepare(scene.with_values({"contact": glued, "time.steps": 5}))
    prepared.run()
    assert prepared.contact_record().slip is None


@pytest.mark.parametrize("name", ["fem", pytest.param("fenicsx", marks=pytest.mark.fenicsx)])
def test_a_base_that_is_displaced_at_the_start_is_refused(scene: Scene, name: str, tmp_path: Path) -> None:
    record = tmp_path / "record.csv"
    record.write_text("time,x\n0,1e-6\n1,0.001\n")
    with pytest.raises(InputError, match="motion: must be zero at t = 0 where contact opens"):
        solve(scene.with_values({"load.base_motion": str(record)}), name)
