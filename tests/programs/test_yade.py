"""Yade as a solver: what it refuses, that its bodies are the scene's block, and its own integrator."""

import numpy as np
import pytest
from peers import yade_block, yade_column

from validation.scenes.scene import load_scene, parse_scene


def scene_of(name, **tables):
    """A problem's scene with keys of tables changed."""
    data = load_scene(f"field-{name}").definition()
    for table, values in tables.items():
        data.setdefault(table, {}).update(values)
    return parse_scene(data, name)


def test_two_bodies_have_the_frequencies_of_the_block_of_one_strain():
    """M = diag(m, m h^2 / 12), K = E a h e^2 and the springs 2 p below the base point v - h e / 2."""
    scene = scene_of("locked", block={"side": 3.0, "young": 4e8})
    a = h = 3.0
    m, E, p = scene.block.mass, scene.block.young, scene.contact.stiffness
    base = np.array([1.0, -h / 2])
    block = np.linalg.inv(np.diag([m, m * h**2 / 12])) @ (np.diag([0, E * a * h]) + 2 * p * np.outer(base, base))
    model = yade_block.two_bodies(scene)
    k = model.bonds[0].normal
    masses = np.diag([body.mass for body in model.bodies])
    bodies = np.linalg.inv(masses) @ (k * np.array([[1, -1], [-1, 1]]) + np.diag([2 * p, 0]))
    np.testing.assert_allclose(np.sort(np.linalg.eigvals(bodies)), np.sort(np.linalg.eigvals(block)), rtol=1e-12)


def test_a_lattice_has_the_mass_and_the_softness_of_its_layers_and_joints():
    layers = [
        {"thickness": 3.0, "density": 2000.0, "young": 2e9},
        {"thickness": 5.0, "density": 2500.0, "young": 4e9},
    ]
    joints = [{"height": 3.0, "stiffness": 1e9}, {"height": 0.0, "stiffness": 5e9}]
    chain = yade_column.lattice(scene_of("column", column={"layer": layers, "joint": joints, "heights": []}))
    assert chain.masses.sum() == pytest.approx(3 * 2000 + 5 * 2500)
    assert (1 / chain.springs).sum() == pytest.approx(3 / 2e9 + 5 / 4e9 + 1 / 1e9 + 1 / 5e9)
    assert chain.heights[[0, -1]] == pytest.approx([0.0, 8.0])
    assert np.all(np.diff(chain.heights) > 0)
