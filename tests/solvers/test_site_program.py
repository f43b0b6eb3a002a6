"""A site by another program: pystrata's linear elastic layers against the exact layers and fine columns of blocks.

It is an optional package (`pip install 'dda-validation[site]'`); without it these tests are skipped by name.
"""

import numpy as np
import pytest

from validation import load_scene, response

FREQUENCIES = np.linspace(0.1, 20.0, 200)  # Hz


@pytest.fixture(scope="module")
def program():
    """Return the program, or skip."""
    return pytest.importorskip("pystrata", reason="NOT RUN: pystrata is not installed")


@pytest.fixture(scope="module")
def site():
    return load_scene("waves-site")


def transfer(program, site):
    """Return surface over an outcrop of the rock by the program."""
    gravity, column = program.motion.GRAVITY, site.column

    def layer(density, thickness, speed):
        return program.site.Layer(program.site.SoilType("", density * gravity, None, 0.0), thickness, speed)

    layers = [layer(x.density, x.thickness, (column.modulus(x) / x.density) ** 0.5) for x in reversed(column.layer)]
    profile = program.site.Profile([*layers, layer(column.base_density, 0, column.base_speed)])
    base, surface = profile.location("outcrop", index=-1), profile.location("outcrop", index=0)
    calculator = program.propagation.LinearElasticCalculator()
    calculator(program.motion.Motion(FREQUENCIES), profile, base)
    return np.asarray(calculator.calc_accel_tf(base, surface))


@pytest.mark.filterwarnings("ignore")  # another package's own
def test_surface_over_outcrop(program, site):
    """An outcrop shows twice the wave that comes up."""
    theirs = transfer(program, site)
    ours = response(site, FREQUENCIES, "layers").displacement / 2
    assert np.abs(ours - theirs).max() < 1e-11 * np.abs(theirs).max()
