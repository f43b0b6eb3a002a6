"""The closed forms behind the gates, as identities at data that are not the paper's."""

import math

import numpy as np
import pytest

from validation.scenes.scene import load_scene
from validation.theory import spectra, statics

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
    E, mu = statics.moduli(s)
    w, h = statics.size(s)
    p, ps, q = s.contact.stiffness, s.contact.shear, s.load.pressure
    plate = w * h * E / (1 - mu * mu)
    K = np.array(
        [[2 * p, 0, -p * h], [0, plate + ps * w * w / 2, mu * plate], [-p * h, mu * plate, plate + p * h * h / 2]]
    )
    assert np.linalg.solve(K, [-w * q, 0, -w * h * q / 2])[0] == pytest.approx(
        statics.static_displacement(s), rel=1e-12
    )


def test_numbers_of_the_independent_computation():
    cases = load_scene("figures-5-6").expand()
    assert [round(spectra.dda_frequency(c), 3) for c in cases] == [344.561, 498.812, 524.096]
    assert [round(spectra.bar_frequency(c), 3) for c in cases] == [327.682, 455.258, 475.600]
    ratios = [spectra.dda_frequency(c) / spectra.bar_frequency(c) for c in cases]
    assert [round(r, 4) for r in ratios] == [1.0515, 1.0957, 1.1020]
    stiff = cases[0].with_values({"contact.stiffness": 1e18})
    assert spectra.dda_frequency(stiff) / spectra.bar_frequency(stiff) == pytest.approx(
        math.sqrt(3) / (math.pi / 2), rel=1e-8
    )
    light = load_scene("figure-9").expand()[1]
    values = [(2e-3, 0.0152), (1e-3, 0.0296), (1e-4, 0.293)]
    for dt, xi in values:
        assert spectra.damping_ratio(
            light.with_values({"time.step": dt}), spectra.dda_frequency(light)
        ) == pytest.approx(xi, rel=5e-3)
