"""OpenSees as a solver: its model is the block of one strain, its integrator is the suite's with 1/4 and 1/2."""

import numpy as np
import pytest
from peers import opensees, opensees_models
from peers.opensees import AsItComes, NotConverged, OpenSees

from validation.scenes.scene import load_scene

PUSHED = {"block.poisson": 0.25, "load.eccentricity": 0.3, "load.traction": 2e5, "load.gravity": 15.0}
SIZES = {"block.width": 3.0, "block.height": 1.25}


class Told:
    """A program that does nothing but keep what it was told, and does not converge."""

    def __init__(self):
        self.said = []

    def __getattr__(self, name):
        return lambda *given: self.said.append((name, *given))

    def analyze(self, *_given):
        return -3

    def getTime(self):
        return 0.25

    def all(self, name, kind=None):
        """Return what a command was told, of elements those of a kind."""
        return [given for said, *given in self.said if said == name and kind in (None, given[0])]


# ---- without the program ------------------------------------------------------------------------------------------


def linear_fields(told):
    """Return the six linear fields at the nodes: u = 1, X, Y and v = 1, X, Y from the centroid, shape (6, 6)."""
    at = {node: np.array(point) for node, *point in told.all("node")}
    nodes = [at[node] for node in opensees_models.SHARES]
    centroid = sum(share * at[node] for node, share in opensees_models.SHARES.items())
    columns = []
    for axis in (0, 1):
        for field in (lambda p: 1.0, lambda p: p[0], lambda p: p[1]):
            values = np.zeros((3, 2))
            values[:, axis] = [field(point - centroid) for point in nodes]
            columns.append(values.ravel())
    return np.array(columns).T


@pytest.mark.parametrize("values", [{}, SIZES])
def test_the_mass_of_two_legs_is_that_of_the_block(values):
    scene, told = load_scene("field-locked").with_values(values), Told()
    opensees_models.block(told, scene)
    at = {node: np.array(point) for node, *point in told.all("node")}
    mass = np.zeros((6, 6))
    for _, _, one, other, _, _, _, per_length, *consistent in told.all("element", "Truss"):
        assert consistent[:2] == ["-cMass", 1]
        part = per_length * np.linalg.norm(at[one] - at[other]) / 6
        for i, j, share in ((one, one, 2), (other, other, 2), (one, other, 1), (other, one, 1)):
            for axis in (0, 1):
                mass[2 * i - 2 + axis, 2 * j - 2 + axis] += share * part
    fields = linear_fields(told)
    (w, h), m = np.ptp(scene.block.outline, axis=0), scene.block.mass
    expected = np.diag(2 * [m, m * w**2 / 12, m * h**2 / 12])
    np.testing.assert_allclose(fields.T @ mass @ fields, expected, atol=1e-12 * m)


def test_the_forces_do_the_work_of_the_loads():
    scene = load_scene("field-locked").with_values(
        {**PUSHED, "load.slope": 20.0, "block.width": 3.0, "block.height": 1.25}
    )
    told, q, (w, h) = Told(), scene.load, (3.0, 1.25)
    opensees_models.block(told, scene)
    forces = np.zeros(6)
    for node, x, y in told.all("load"):
        forces[2 * node - 2 : 2 * node] = x, y
    weight, slope, pressed = scene.block.mass * q.gravity, np.radians(q.slope), q.pressure * (w - 2 * q.eccentricity)
    across, down = q.traction * w, weight * np.cos(slope) + pressed
    expected = [across + weight * np.sin(slope), 0, across * h / 2, -down, -pressed * q.eccentricity, -pressed * h / 2]
    np.testing.assert_allclose(linear_fields(told).T @ forces, expected, atol=1e-12 * down)


@pytest.mark.parametrize("solver", [OpenSees, AsItComes])
def test_newtons_iteration_that_ends_nowhere_has_a_name(monkeypatch, solver):
    monkeypatch.setattr(opensees, "program", Told)
    with pytest.raises(NotConverged, match=r"0\.25 s"):
        solver().solve(load_scene("field-creep"))


# ---- with it ------------------------------------------------------------------------------------------------------
