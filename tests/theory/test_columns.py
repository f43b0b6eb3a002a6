"""Closed forms of columns whose contacts open or slip, against eigenvalues and a mass matrix."""

import math

import numpy as np
import pytest
from scipy.linalg import eigh

from validation.scenes.scene import Scene
from validation.theory import columns
from validation.theory.stepping import Stepping


@pytest.mark.parametrize("blocks", [1, 2, 7])
def test_the_lowest_frequency_is_that_of_a_chain_of_masses(blocks):
    chain = 2 * np.eye(blocks) - np.eye(blocks, k=1) - np.eye(blocks, k=-1)
    chain[-1, -1] = 1.0  # nothing above the top
    lowest = math.sqrt(3e9 / 2500 * np.linalg.eigvalsh(chain)[0])
    assert columns.lowest_frequency(3e9, 2500, blocks) == pytest.approx(lowest, rel=1e-12)


@pytest.mark.parametrize("alpha", [0.25, 0.5])
def test_the_far_face_of_a_block_turns_at_its_step(alpha):
    height, density, modulus = 2.0, 2600.0, 3e9
    mass = density * height / 6 * np.array([[2.0, 1.0], [1.0, 2.0]])
    stiffness = modulus / height * np.array([[1.0, -1.0], [-1.0, 1.0]])
    turns = columns.far_face_step(math.sqrt(modulus / density), height, alpha)
    for step, sign in ((0.99 * turns, -1), (1.01 * turns, 1)):
        answer = np.linalg.solve(mass + alpha * step**2 * stiffness, [1.0, 0.0])
        assert np.sign(answer[1]) == sign
    assert columns.far_face_step(math.inf, height, alpha) == 0
    assert columns.far_face_step(1.0, height, 0.0) == math.inf


def test_a_stack_rings_down_by_what_the_scheme_and_the_discount_take():
    omega, step = 40.0, 1e-4
    rate = omega**2 * (0.8 - 0.5) * step / 2 + (1 - 0.999) / (2 * step)
    damped = Stepping(step, 0.45, 0.8, 0.999)
    assert columns.ring_down(omega, damped, 0.02) == pytest.approx(math.log(50) / rate, rel=2e-3)
    assert columns.ring_down(0.0, damped) == columns.ring_down(omega, Stepping(step, 0.25, 0.5)) == math.inf
    assert columns.ring_down(1e9, Stepping(1.0, 0.5, 1.0, 0.0)) == 0


@pytest.mark.parametrize("base", [{}, {"base": "springs", "base_stiffness": 3e7}, {"glue": 7e8}])
def test_the_first_frequency_of_a_column_is_that_of_its_faces(base):
    """Blocks of one strain, two layers of them: the lowest eigenvalue of their faces, assembled."""
    glued = "glue" in base
    layers = [(3.0, 2000.0, 2e9, 2), (2.0, 1700.0, 5e8, 3)]
    tables = [dict(zip(("thickness", "density", "young", "blocks"), layer, strict=True)) for layer in layers]
    column = {"motion": "shear", "layer": tables} | base
    course = {"input": {"shape": "ricker", "velocity": 0.1, "frequency": 2.0}, "time": {"step": 1e-3, "steps": 9}}
    M, K = np.zeros((2, 10 if glued else 6, 10 if glued else 6))
    K[0, 0] = base.get("base_stiffness", base.get("glue", 1e18))
    foot = 0
    for thickness, density, young, blocks in layers:
        for _ in range(blocks):
            part = slice(foot, foot + 2)
            M[part, part] += density * thickness / blocks / 6 * np.array([[2, 1], [1, 2]])
            K[part, part] += young / 2 / (thickness / blocks) * np.array([[1, -1], [-1, 1]])
            if glued and foot:
                joint = slice(foot - 1, foot + 1)
                K[joint, joint] += 7e8 * np.array([[1, -1], [-1, 1]])
            foot += 1 + glued
    lowest = math.sqrt(eigh(K, M, eigvals_only=True)[0])
    section = Scene.model_validate({"name": "two layers", "column": column} | course).column
    assert columns.first_frequency(section) == pytest.approx(lowest, rel=1e-6)
