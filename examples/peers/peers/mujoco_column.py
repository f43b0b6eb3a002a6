"""Columns of MuJoCo: masses on a line with springs between them, half of each cell's mass at either end."""

import math

import numpy as np

from peers.columns import NEAR, stretches
from peers.mujoco_model import MOST, March, Network, Spring, parts, refuse
from validation.scenes.drive import motion_at

CELLS, MOST_CELLS = 8, 2000  # cells in what a wave passes in a step, and all masses of a column
RESOLVED = 0.7  # w dt of RK4


class Chain:
    """A column as masses on a line, from the base upwards.

    Attributes
    ----------
    masses, heights
        Of the masses that move [kg/m2], [m].
    ground
        Stiffness between base and lowest mass [Pa/m], or impedance of a transmitting base [Pa s/m].
    carried
        Mass that moves with a rigid base [kg/m2].
    """

    def __init__(self, scene, *, default):
        self.column = _column(scene)
        cut = stretches(self.column)
        self.masses, self.heights, self.springs = list[float](), list[float](), list[Spring]()
        self.ground, self.carried = 0.0, 0.0
        self._stand(cut[0].spring)
        for number, one in enumerate(cut):
            if number and one.spring is not None:  # the next mass stands at the same height
                self._link(one.spring)
                self.masses.append(0.0)
                self.heights.append(self.heights[-1])
            passed = math.sqrt(one.modulus / one.layer.density) * scene.time.step
            self._pile(one, one.layer.thickness / one.layer.blocks if default else passed / CELLS)

    def _stand(self, foot):
        """Place a mass on the springs, or on the dampers, of a base that is not rigid."""
        impedance = self.column.impedance
        if foot is not None:
            self.ground = foot
            self.springs.append(Spring({"0": 1.0}, foot))
        elif impedance is not None:
            self.ground = impedance
        else:
            return
        self.masses.append(0.0)
        self.heights.append(0.0)

    def _pile(self, one, cell):
        """Set cells upon each other."""
        low, length = one.bottom, one.length
        count = max(math.ceil(length / cell * (1 - NEAR)), 1)
        refuse(f"it would take more than {MOST_CELLS} masses", where=len(self.masses) + count > MOST_CELLS)
        half, stiffness = one.layer.density * length / count / 2, one.modulus * count / length
        for number in range(count):
            if self.masses:
                self.masses[-1] += half
                self._link(stiffness)
            else:
                self.ground, self.carried = stiffness, half
                self.springs.append(Spring({"0": 1.0}, stiffness))
            self.masses.append(half)
            self.heights.append(low + length * (number + 1) / count)

    def _link(self, stiffness):
        upper = len(self.masses)
        self.springs.append(Spring({str(upper - 1): -1.0, str(upper): 1.0}, stiffness))

    def network(self, rate):
        """Return the masses and springs; `rate` is that of a damping of the masses [1/s]."""
        masses = {str(number): mass for number, mass in enumerate(self.masses)}
        damping = {name: rate * mass for name, mass in masses.items()}
        if self.column.base == "transmitting":
            damping["0"] += self.ground
        return Network(masses, self.springs, damping)


def _column(scene):
    """Return the column of a scene; one with joints that a chain has not is refused."""
    c = scene.column
    heights = sorted(spring.height for spring in c.springs)
    near = NEAR * c.height
    refuse("a joint on the top carries nothing", where=any(height >= c.height - near for height in heights))
    below = c.base == "transmitting" and any(height <= near for height in heights)
    refuse("a joint between column and transmitting base has no mass below it", where=below)
    refuse("two joints at one height", where=any(np.diff(heights) <= near))
    return c


def column(scene, *, default):
    """Return the motion of a column of masses: displacements, and the pressure on the base."""
    t = scene.time
    refuse("gg = 0 has no rate -ln(gg) / dt", where=t.discount == 0)
    chain = Chain(scene, default=default)
    network = chain.network(-math.log(t.discount) / t.step)
    each = 1 if default else parts(network.frequency(), t.step, t.steps, RESOLVED, RESOLVED, MOST)
    dt = t.step / each
    march = March(network.text(f'timestep="{dt!r}"' + ("" if default else ' integrator="RK4"')), network)
    middle = motion_at(scene, np.asarray(dt * (np.arange(each * t.steps) + 0.5), np.float64))
    passes = chain.column.base == "transmitting"
    below = chain.ground * (2 * middle.velocity if passes else middle.displacement)

    def drive(number):
        force = march.data.qfrc_applied
        force[:] = 0.0
        force[0] += below[number]
        force[-1] -= middle.pressure[number]

    rows = march.rows(t.steps, each, lambda: np.array([march.data.qvel[0], *march.data.qpos]), drive)
    base = motion_at(scene, np.asarray(t.step * np.arange(1.0, t.steps + 1), np.float64))
    return _reported(chain, base, rows[:, 0], rows[:, 1:])


def _reported(chain, base, rate, x):
    """Return the columns from the rate of the lowest mass, shape (steps,), and all displacements, (steps, masses)."""
    if chain.column.base == "transmitting":
        pressure = chain.ground * (2 * base.velocity - rate)
    else:
        pressure = chain.ground * (base.displacement - x[:, 0]) + chain.carried * base.acceleration
    columns = {"displacement": x[:, -1], "contact_pressure": pressure}
    levels = np.array(chain.heights)
    if levels[0] > 0:
        levels, x = np.array([0.0, *levels]), np.column_stack([base.displacement, x])
    for number, height in enumerate(chain.column.heights):
        at = height - NEAR * chain.column.height  # below a joint
        columns[f"displacement_{number + 1}"] = np.array([np.interp(at, levels, row) for row in x])
    return columns
