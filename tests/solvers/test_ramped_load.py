"""A load that rises in a ramp: who refuses it."""

import math

import pytest

import dda


def test_the_packages_refuse_a_ramp_where_they_do_not_know_it():
    block = dda.Block([(0, 0), (2, 0), (2, 2), (0, 2)], dda.Material(2700.0, 1e9, 0.0))
    load = dda.Load(pressure=1e6, ramp=0.1)
    model = dda.TwoBlockModel(block, dda.Contact(1e9, 1e9), load)
    scheme = dda.Scheme(0.5, 1.0, 1.0, 1e-3)
    average = dda.Scheme(0.25, 0.5, 1.0, 1e-3)
    opens = dda.UnilateralModel(block, dda.Unilateral(1e9, 0.0), load)
    for unknown in (
        lambda: dda.subdivided(model, 2, 2, 1e15),
        lambda: dda.opening_subdivided(opens, 2, 2, 1e15),
        lambda: dda.solve(model, scheme, 5, floor=0.0),
        lambda: dda.solve_textbook(model, scheme, 5),
        lambda: dda.solve_unilateral(opens, average, 5, options=dda.UnilateralOptions("energy-conserving")),
    ):
        with pytest.raises(ValueError, match=r"ramp|once"):
            unknown()
    for ramp in (-1.0, math.nan, math.inf):
        with pytest.raises(ValueError, match="ramp"):
            dda.Load(ramp=ramp)
