"""Columns of MuJoCo: masses on a line with springs between them, half of each cell's mass at either end."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from peers.mujoco_model import MOST, Columns, March, Network, Spring, parts, refuse
from validation.scenes.drive import motion_at
from validation.scenes.scene import Scene

CELLS, MOST_CELLS = 8, 2000  # elements of a column in what a wave passes in a step, and all of them
PER_RADIAN = 0.7  # w dt of RK4
NEAR = 1e-9  # of a column's height: what counts as one height


@dataclass
class Chain:
    """A column as masses on a line: what holds it below, and where its masses are."""

    network: Network
    heights: list[float]  # of the masses, from the base upwards [m]
    ground: float  # stiffness between base and lowest mass, or impedance of a transmitting base [N/m, N s/m]
    carried: float  # mass that moves with the base itself [kg]


def chain(scene: Scene, *, default: bool) -> Chain:
    """Return the column of a scene, each cell half its mass at either end; by default a cell for each block of DDA."""
    c = scene.column
    assert c is not None
    top, joints = c.height, {spring.height: spring.stiffness for spring in c.springs}
    foot = [height for height in joints if height <= NEAR * top]
    refuse("a joint on the top carries nothing", where=any(height >= top * (1 - NEAR) for height in joints))
    refuse("a joint between column and transmitting base", where=bool(foot) and c.base == "transmitting")
    refuse("two joints at one height", where=len(joints) < len(c.springs))
    masses, heights, springs, level, carried = dict[str, float](), list[float](), list[Spring](), 0.0, 0.0
    ground = joints[foot[0]] if foot else c.impedance or 0.0
    if foot or c.base == "transmitting":
        masses["0"], heights = 0.0, [0.0]
    if foot:
        springs.append(Spring({"0": 1.0}, ground))
    for layer in c.layer:
        end, modulus = level + layer.thickness, c.modulus(layer)
        cell = layer.thickness / layer.blocks if default else math.sqrt(modulus / layer.density) * scene.time.step / CELLS
        stops = sorted(height for height in joints if level + NEAR * top < height < end - NEAR * top)
        for low, high in zip([level, *stops], [*stops, end], strict=True):
            if heights and any(abs(low - height) <= NEAR * top for height in joints if low > 0):
                masses[str(len(masses))] = 0.0
                heights.append(heights[-1])
                at = min(joints, key=lambda height: abs(height - low))
                springs.append(_between(len(masses) - 2, joints[at]))
            count = max(math.ceil((high - low) / cell * (1 - NEAR)), 1)
            refuse(f"it would take more than {MOST_CELLS} masses", where=len(masses) + count > MOST_CELLS)
            half, stiffness = layer.density * (high - low) / count / 2, modulus * count / (high - low)
            for number in range(count):
                if masses:
                    masses[str(len(masses) - 1)] += half
                    springs.append(_between(len(masses) - 1, stiffness))
                else:
                    springs.append(Spring({"0": 1.0}, stiffness))
                    ground, carried = stiffness, half
                masses[str(len(masses))] = half
                heights.append(low + (high - low) * (number + 1) / count)
        level = end
    rate = -math.log(scene.time.discount) / scene.time.step
    damping = {name: rate * mass for name, mass in masses.items()}
    if c.base == "transmitting":
        damping["0"] += ground
    return Chain(Network(masses, springs, damping), heights, ground, carried)


def _between(lower: int, stiffness: float) -> Spring:
    return Spring({str(lower): -1.0, str(lower + 1): 1.0}, stiffness)


def column(scene: Scene, *, default: bool) -> Columns:
    """Return the motion of a column of masses."""
    c, t = scene.column, scene.time
    assert c is not None
    refuse("a discount of 0 has no rate", where=t.discount == 0)
    found = chain(scene, default=default)
    each = 1 if default else parts(found.network.frequency(), t.step, t.steps, PER_RADIAN, PER_RADIAN, MOST)
    dt, passes = t.step / each, c.base == "transmitting"
    march = March(found.network.text(f'timestep="{dt!r}"' + ("" if default else ' integrator="RK4"')), found.network)
    middle = motion_at(scene, dt * (np.arange(each * t.steps) + 0.5))
    below = found.ground * (2 * middle.velocity if passes else middle.displacement)

    def drive(number: int) -> None:
        force = march.data.qfrc_applied
        force[:] = 0.0
        force[0] += below[number]
        force[-1] -= middle.pressure[number]

    rows = march.rows(t.steps, each, lambda: np.array([*march.data.qpos, march.data.qvel[0]]), drive)
    base, x = motion_at(scene, t.step * np.arange(1.0, t.steps + 1)), rows[:, :-1]
    if passes:
        pressure = found.ground * (2 * base.velocity - rows[:, -1])
    else:
        pressure = found.ground * (base.displacement - x[:, 0]) + found.carried * base.acceleration
    columns = {"displacement": x[:, -1], "contact_pressure": pressure}
    levels = np.array([*([] if found.heights[0] == 0 else [0.0]), *found.heights])
    x = x if found.heights[0] == 0 else np.column_stack([base.displacement, x])
    for number, height in enumerate(c.heights):
        columns[f"displacement_{number + 1}"] = np.array([np.interp(height - NEAR * c.height, levels, row) for row in x])
    return columns
