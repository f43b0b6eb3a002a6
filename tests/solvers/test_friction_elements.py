"""Elements with friction beside the block of one strain: the rigid limit, statics, refusals."""

from pathlib import Path

import pytest

from validation import solve
from validation.errors import InputError
from validation.scenes.scene import Scene, load_scene

CONTACT = {"law": "unilateral", "stiffness": 1e9, "shear_stiffness": 4e8, "friction": 25.0, "cohesion": 2e3}
LOAD = {"gravity": 9.81, "slope": 28.0, "pressure": 5e4, "eccentricity": 0.5, "traction": -2e4}
COLUMNS = ["displacement", "contact_pressure", "horizontal_displacement"]


@pytest.fixture
def scene() -> Scene:
    """A block on an incline with two corners, its load off its middle."""
    values = {"contact": CONTACT, "load": LOAD, "time.step": 1e-3, "time.steps": 150, "run.columns": COLUMNS}
    return load_scene("unlocked").expand()[1].with_values(values | {"fem": {"elements": 2, "foundation": "corner"}})


def test_a_column_that_elements_do_not_have_is_refused(scene: Scene) -> None:
    with pytest.raises(InputError, match="must be among"):
        solve(scene.with_values({"run.columns": ["slide_m"]}), "fem")


@pytest.mark.parametrize("name", ["fem", pytest.param("fenicsx", marks=pytest.mark.fenicsx)])
def test_a_base_that_is_displaced_at_the_start_is_refused(scene: Scene, name: str, tmp_path: Path) -> None:
    record = tmp_path / "record.csv"
    record.write_text("time,x\n0,1e-6\n1,0.001\n")
    with pytest.raises(InputError, match="motion: must be zero at t = 0 where contact opens"):
        solve(scene.with_values({"load.base_motion": str(record)}), name)
