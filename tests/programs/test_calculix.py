"""CalculiX as a solver: what it refuses, what it is told, its integrator by theory, its contact by exact motions."""

import numpy as np
import pytest
from peers.calculix_block import block_deck
from peers.calculix_column import acceleration, column_deck, parts_of
from peers.calculix_deck import parsed

from validation.problems.problem import problem


def column_scene(**column):
    scene = problem("column").scene
    return scene.with_values({f"column.{key}": value for key, value in column.items()})


@pytest.mark.parametrize(("name", "deck"), [("creep", block_deck), ("rocking", block_deck), ("column", column_deck)])
def test_every_number_fits_the_twenty_characters_that_ccx_reads(name, deck):
    for line in deck(problem(name).scene, 3).text(accurate=True).splitlines():
        assert line.startswith("*") or max(map(len, line.split(","))) <= 20, line


def test_rows_with_three_digits_of_an_exponent_are_read():
    text = " displacements (vx,vy,vz) for set OUT and time 0.1E-1\n\n         7  1.5-101 -2.500000E-03  0.000000E+00\n"
    times, found = parsed(text, 1)
    assert times.tolist() == [0.01] and found.tolist() == [[[1.5e-101, -2.5e-3, 0.0]]]


def test_a_column_is_cut_at_layers_joints_and_heights():
    column = column_scene(joint=[{"height": 6.0, "stiffness": 1e9}]).column
    parts = parts_of(column)
    assert [part.stretch.bottom for part in parts] == [0.0, 3.5, 6.0, 8.5]
    assert [part.stretch.spring for part in parts] == [None, None, 1e9, None]
    assert parts[1].levels[0] == parts[0].levels[-1] and parts[2].levels[0] == parts[1].levels[-1] + 1


@pytest.mark.parametrize("moved", [lambda t: 0.1 * t, lambda t: t**2])
def test_the_momentum_of_a_base_is_kept_though_it_start_with_a_jump(moved):
    t = np.linspace(0.0, 1.0, 101)
    reached = np.trapezoid(acceleration(t, moved(t)), t)
    assert abs(reached - (moved(1.0) - moved(0.98)) / 0.02) < 0.02 * abs(reached)
