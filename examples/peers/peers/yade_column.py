"""A column as a lattice of Yade's particles: each bound to the next, a dashpot or a ground below the first."""

import math
from dataclasses import dataclass

import numpy as np

from peers.columns import NEAR, stretches
from peers.yade_bodies import Body, Bond, Drive, Model, Point

MOST_PARTICLES = 2000


def column(scene, solver):
    """Return the motion of a column: a lattice of particles, each bound to the next, per unit of area."""
    from validation.scenes.drive import motion_at

    c, chain = scene.column, lattice(scene)
    held = c.base != "transmitting"
    bodies = tuple(
        Body((0.0, float(i)), m or 1.0, (Point((0.0, 0.0), 0.5, touches=False),), fixed=held and i == 0)
        for i, m in enumerate(chain.masses)
    )
    model = Model(bodies, tuple(Bond((i, i + 1), (0, 0), k, k) for i, k in enumerate(chain.springs)))
    count = solver.cut(scene, model)
    at = motion_at(scene, scene.time.step / count * np.arange(count * scene.time.steps + 2))
    ground, incident = (at.displacement.tolist(), []) if held else ([], at.velocity.tolist())
    axis = 0 if c.motion == "shear" else 1
    drive = Drive(axis, (-at.pressure).tolist(), ground, incident, c.impedance or 0.0)
    found = solver.move(scene, model, drive)
    moved = (found.x if axis == 0 else found.y - found.y[0])[1:]
    pressed = found.force[1:] + held * chain.masses[0] * at.acceleration[count:-1:count]
    rows = {
        f"displacement_{n}": [np.interp(y, chain.heights, row) for row in moved] for n, y in enumerate(c.heights, 1)
    }
    return {"displacement": moved[:, -1], "contact_pressure": pressed} | {k: np.array(v) for k, v in rows.items()}


@dataclass(frozen=True)
class Lattice:
    """Particles from the base upwards."""

    heights: np.ndarray  # [m], shape (particles,)
    masses: np.ndarray  # per unit of area [kg/m2], shape (particles,)
    springs: np.ndarray  # between neighbours, per unit of area [N/m3], shape (particles - 1,)


def lattice(scene):
    """Return a column's particles: the masses of cells that a wave crosses in a hundredth of the pulse's period.

    A cell has half of its mass at each end; where a joint or the springs of the base cut the column, the two ends stay
    apart, and where two cells meet else, they are one particle.
    """
    c = scene.column
    heights, masses, springs = [0.0], [0.0], []
    for one in stretches(c):
        y = one.bottom
        if one.spring is not None:
            springs.append(one.spring)
            heights.append(y + NEAR * c.height)
            masses.append(0.0)
        speed = math.sqrt(one.modulus / one.layer.density)
        cells = max(8, math.ceil(one.length / (speed * shortest(scene))))
        size = one.length / cells
        masses[-1] += one.layer.density * size / 2
        masses += [one.layer.density * size] * (cells - 1) + [one.layer.density * size / 2]
        springs += [one.modulus / size] * cells
        heights += [y + size * (n + 1) for n in range(cells)]
    if len(masses) > MOST_PARTICLES:
        raise NotImplementedError(f"the pulse would need {len(masses)} particles, more than {MOST_PARTICLES}")
    return Lattice(np.array(heights), np.array(masses), np.array(springs))


def shortest(scene):
    """Return the time in which a wave is to cross a cell [s]."""
    if scene.input.record is not None:
        return float(scene.time.step) / 4
    period = 1 / scene.input.frequency if scene.input.shape == "ricker" else scene.input.duration
    return float(period) / 100
