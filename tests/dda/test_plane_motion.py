"""Blocks in the plane that touch nothing: momentum, loads, and the strain of a block that spins."""

import math

import numpy as np
import pytest
from oracles.plane_scenes import AVERAGE, rectangle, scheme
from scipy.integrate import solve_ivp

from dda import BaseMotion, PlaneBlock, PlaneLoad, PlaneModel, solve_plane

SPIN = 20.0
QUADRILATERAL = [(0, 0), (2, 0), (2.5, 1), (0.3, 1.7)]


def test_a_rectangle_that_spins_has_the_motion_of_its_deformation_gradient():
    a, b, nu = 2.0, 1.0, 0.25
    moments = 2700.0 * a * b / 12 * np.diag([a * a, b * b])
    turn = np.array([[0.0, -1.0], [1.0, 0.0]])
    elastic = a * b * 1e8 / (1 - nu**2) * np.array([[1, nu, 0], [nu, 1, 0], [0, 0, (1 - nu) / 2]])

    def polar(F):
        angle = math.atan2(F[1, 0] - F[0, 1], F[0, 0] + F[1, 1])
        Q = np.array([[math.cos(angle), -math.sin(angle)], [math.sin(angle), math.cos(angle)]])
        return angle, Q, Q.T @ F

    def rates(_, state):
        F, V = state.reshape(2, 2, 2)
        _, Q, U = polar(F)
        sx, sy, sxy = elastic @ (U[0, 0] - 1, U[1, 1] - 1, 2 * U[0, 1])
        T = np.array([[sx, sxy], [sxy, sy]])
        T = T - np.trace(T.T @ turn @ U) / np.trace(turn.T @ turn @ U) * turn  # Biot's stress does no work in a turn
        return np.concatenate([V.ravel(), (-Q @ T @ np.linalg.inv(moments)).ravel()])

    start = np.concatenate([np.eye(2).ravel(), (SPIN * turn).ravel()])
    end = solve_ivp(rates, (0, 0.02), start, method="DOP853", rtol=1e-12, atol=1e-14).y[:4, -1]
    angle, _, U = polar(end.reshape(2, 2))
    exact = np.array([U[0, 0] - 1, U[1, 1] - 1, 2 * U[0, 1], angle])
    errors = []
    for steps in (50, 100):
        block = PlaneBlock(rectangle(-a / 2, -b / 2, a, b), 2700.0, 1e8, nu, spin=SPIN)
        result = solve_plane(PlaneModel([block]), scheme(AVERAGE, 0.02 / steps), steps)
        errors.append([*result.strain[-1, 0], result.angle[-1, 0]] - exact)
    left = (4 * errors[1] - errors[0]) / 3  # what is not of second order
    assert np.all(np.abs(left) < 0.05 * np.abs(errors[1]))


@pytest.mark.parametrize("young", [math.inf, 1e8])
def test_dead_loads_do_their_work_however_far_the_block_turns(young):
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
    assert errors[1] < 2e-3 and (math.isfinite(young) or errors[1] < 0.3 * errors[0])


def test_a_load_in_the_plane_moves_a_block_as_its_closed_form_says():
    block = PlaneBlock(rectangle(0, 0, 2, 1), 1000.0)
    loads = [PlaneLoad(0, (4000.0, 0.0), ramp=1.0), PlaneLoad(0, (0.0, 1000.0), edge=((0, 0), (1.0, 0)))]
    result = solve_plane(PlaneModel([block], loads=loads), scheme(AVERAGE, 1e-2), 100)
    assert result.displacement[-1, 0, 0] == pytest.approx(1 / 3, rel=1e-4)  # t^3/6 of the ramp to 2 m/s^2
    inertia = 2000.0 * 5 / 12
    assert result.velocity[1, 0, 2] == pytest.approx(-1000.0 * 0.5 / inertia * 1e-2, rel=1e-4)


def test_a_driven_block_follows_its_record():
    time = np.linspace(0, 1, 21)
    motion = BaseMotion(time, np.column_stack([np.sin(3 * time), 0.1 * time]))
    blocks = [
        PlaneBlock(rectangle(0, 0, 1, 1), 1.0, motion=motion),
        PlaneBlock(rectangle(5, 0, 1, 1), 1.0),
        PlaneBlock(rectangle(9, 0, 1, 1), 1.0, fixed=True),
    ]
    result = solve_plane(PlaneModel(blocks), scheme(AVERAGE, 0.05), 20, every=2)
    assert result.displacement[:, 0] == pytest.approx(motion.at(result.time), abs=1e-15)
    assert not np.any(result.displacement[:, 1:]) and len(result.time) == 11
    steps = np.diff(motion.at(0.05 * np.arange(21)), axis=0)
    assert result.velocity[1:, 0, :2] == pytest.approx(steps[1::2] / 0.05, abs=1e-12)
