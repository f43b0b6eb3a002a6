"""Blocks in the plane that touch nothing: momentum, loads, and the strain of a block that spins."""

import math

import numpy as np
import pytest
from oracles.plane_scenes import AVERAGE, rectangle, scheme

from dda import BaseMotion, PlaneBlock, PlaneLoad, PlaneModel, solve_plane


def test_a_rectangle_that_spins_swings_about_the_strain_of_its_spin(held):
    """As d'' = w^2 (1 + d) - A d for small strains, which the moments of a rectangle make two oscillators."""
    sides, nu, rate, spin = np.array([2.0, 1.0]), 0.25, 1e8 / (1 - 0.25**2), 0.2
    inertia = np.diag(2700.0 * sides**2 / 12)
    A = np.linalg.solve(inertia, rate * np.array([[1.0, nu], [nu, 1.0]]))
    squares, shapes = np.linalg.eig(A)
    rest = np.linalg.solve(shapes, np.linalg.solve(A, np.full(2, spin**2)))
    block = PlaneBlock(rectangle(-1, -0.5, *sides), 2700.0, 1e8, nu, spin=spin)
    result = solve_plane(PlaneModel([block]), scheme(AVERAGE, 2e-5), 120, every=20)
    held("spin", result)
    exact = (rest * (1 - np.cos(np.outer(result.time, np.sqrt(squares))))) @ shapes.T
    assert result.strain[:, 0, :2] == pytest.approx(exact, abs=1e-4 * np.abs(exact).max())
    assert result.angle[:, 0] == pytest.approx(spin * result.time, rel=1e-6)


@pytest.mark.parametrize("young", [math.inf, 1e8])
def test_dead_loads_do_their_work_however_far_the_block_turns(young, held):
    block = PlaneBlock(rectangle(-1, -0.5, 2, 1), 1000.0, young, 0.2, spin=3.0)
    loads = [
        PlaneLoad(0, (300.0, 200.0), place=(1.0, 0.5)),
        PlaneLoad(0, (0.0, -400.0), edge=((0.0, 0.5), (-1.0, 0.5)), ramp=0.3),
        PlaneLoad(0, (50.0, 0.0), ramp=0.1),
    ]
    model = PlaneModel([block], loads=loads, gravity=(0.0, -9.81))
    errors = []
    for steps in (25, 50):
        result = solve_plane(model, scheme(AVERAGE, 1.0 / steps), steps)
        total = result.energy["kinetic"] + result.energy["strain"]
        size = total.max()
        assert np.abs(result.energy["balance"]).max() <= 1e-12 * size
        errors.append(abs(result.energy["algorithmic"][-1]) / size)
    held(f"dead loads {young}", result)
    assert errors[1] < 2e-3 and (math.isfinite(young) or errors[1] < 0.3 * errors[0])


def test_a_driven_block_follows_its_record(held):
    time = np.linspace(0, 1, 21)
    motion = BaseMotion(time, np.column_stack([np.sin(3 * time), 0.1 * time]))
    blocks = [
        PlaneBlock(rectangle(0, 0, 1, 1), 1.0, motion=motion),
        PlaneBlock(rectangle(5, 0, 1, 1), 1.0),
        PlaneBlock(rectangle(9, 0, 1, 1), 1.0, fixed=True),
    ]
    result = solve_plane(PlaneModel(blocks), scheme(AVERAGE, 0.05), 20, every=2)
    held("driven blocks", result)
    assert result.displacement[:, 0] == pytest.approx(motion.at(result.time), abs=1e-15)
    assert not np.any(result.displacement[:, 1:]) and len(result.time) == 11
    steps = np.diff(motion.at(0.05 * np.arange(21)), axis=0)
    assert result.velocity[1:, 0, :2] == pytest.approx(steps[1::2] / 0.05, abs=1e-12)
