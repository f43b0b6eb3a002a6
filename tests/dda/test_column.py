"""Bonded columns: moduli of plane waves, the system of blocks, and what is refused."""

import numpy as np
import pytest

import dda
from dda.bodies.column import Column, Layer, Spring
from dda.bodies.column_history import solve_column
from dda.bodies.column_march import Drive

DENSITY, YOUNG = 2000.0, 1.8e9


def test_the_moduli_are_those_of_plane_waves():
    layer = Layer(1.0, 1.0, 1.0, 0.25)
    assert layer.modulus("shear") == pytest.approx(0.4)
    assert layer.modulus("pressure") == pytest.approx(1.2)
    assert Layer(1.0, 1.0, 1.0).modulus("pressure") == 1.0


def test_a_column_is_the_system_of_blocks_on_its_springs():
    """Five squares under a pressure: the two-dimensional blocks, whose two end springs of p make 2 p / a a joint."""
    a, p, glue, pressure, step, steps = 2.0, 3e9, 5e9, 1e6, 2e-4, 60
    block = dda.Block([(0, 0), (a, 0), (a, 5 * a), (0, 5 * a)], dda.Material(2700.0, 1e9, 0.0, "plane stress"))
    model = dda.TwoBlockModel(block, dda.Contact(p, p), pressure)
    scheme = dda.Scheme(0.4, 0.7, 0.98, step)
    system = dda.solve_system(dda.subdivided(model, 1, 5, glue), scheme, steps)
    column = Column([Layer(5 * a, 2700.0, 1e9, 0.0, 5)], "pressure", 2 * glue / a, [Spring(0.0, 2 * p / a)])
    still = np.zeros(steps + 1)
    drive = Drive(still, still, still, np.full(steps + 1, pressure))
    found = solve_column(column, scheme, drive, ("displacement_1", "contact_pressure"), [2.5 * a])
    for mine, other in (("displacement_1", "displacement"), ("contact_pressure", "contact_pressure")):
        size = np.abs(system.columns[other]).max()
        assert np.abs(found.columns[mine] - system.columns[other]).max() < 1e-10 * size
