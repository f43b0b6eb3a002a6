"""The closed forms behind the gates, as identities at data that are not the paper's."""

import numpy as np
import pytest

from validation.scenes.scene import load_scene
from validation.theory import statics

BASE = load_scene("poisson-statics").with_values({"contact.stiffness": 1e9})
DATA = [
    {"block.side": 1.3, "block.density": 1900.0, "block.young": 7e8, "contact.stiffness": 3e9, "block.poisson": 0.0},
    {
        "block.width": 0.7,
        "block.height": 3.1,
        "contact.stiffness": 4e8,
        "contact.shear_stiffness": 9e8,
        "block.poisson": 0.2,
    },
    {"block.side": 3.0, "block.hypothesis": "plane strain", "block.poisson": 0.45, "load.pressure": -2e6},
]


def scene(values):
    return BASE.with_values({"block.height": 1.0} | values if "block.width" in values else values)


@pytest.mark.parametrize("values", DATA)
def test_static_displacement_balances_the_three_equations(values):
    s = scene(values)
    (w, h), E, mu = s.block.rectangle, s.block.young, s.block.poisson
    if s.block.hypothesis == "plane strain":
        E, mu = E / (1 - mu * mu), mu / (1 - mu)
    p, ps, q = s.contact.stiffness, s.contact.shear, s.load.pressure
    plate = w * h * E / (1 - mu * mu)
    K = [[2 * p, 0, -p * h], [0, plate + ps * w * w / 2, mu * plate], [-p * h, mu * plate, plate + p * h * h / 2]]
    found = np.linalg.solve(K, [-w * q, 0, -w * h * q / 2])[0]
    assert found == pytest.approx(statics.static_displacement(s), rel=1e-12)
