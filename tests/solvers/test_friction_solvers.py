"""Scenes with friction, slopes and a moving base, as the solver dda takes them."""

import numpy as np
import pytest

from validation.errors import InputError
from validation.scenes.scene import Scene, parse_scene
from validation.solvers.dda import DDA

COLUMNS = ["displacement", "horizontal_displacement", "state_m", "state_n", "slide_m", "slide_n", "shear_force_n"]


def scene(contact=None, load=None, block=None, columns=COLUMNS, steps=120) -> Scene:
    """Return a block of 2 m on an incline of 20 degrees."""
    return parse_scene(
        {
            "title": "incline",
            "block": {"side": 2.0, "density": 2700.0, "young": 1e9} | (block or {}),
            "contact": {"law": "unilateral", "stiffness": 1e9, "shear_stiffness": 4e8, "friction": 30.0}
            | (contact or {}),
            "load": {"gravity": 9.81, "slope": 20.0} | (load or {}),
            "time": {"step": 2e-4, "steps": steps},
            "run": {"columns": columns},
        },
        "incline.toml",
    )


def record(given: Scene):
    """Return the history's columns and the contact's record."""
    prepared = DDA().build(given, False)
    return prepared.run().history.columns, prepared.contact_record()


def test_lagged_friction_and_its_bands_are_taken():
    lagged = scene({"rules": "lagged", "band": [1e-3, 1e-6]})
    assert not np.array_equal(record(lagged)[0]["displacement"], record(scene())[0]["displacement"])
    with pytest.raises(InputError, match="is frictional under lagged rules only"):
        DDA().build(scene({"band": [0.0, 1e-6]}), False)
