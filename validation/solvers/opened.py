"""What the adapters of unilateral contact share: the scales of a scene, and what its contact did at each step."""

from __future__ import annotations

import itertools
import math
import operator
from typing import Any

import numpy as np

from validation.runs.contact import ContactRecord, Rebound, rebounds_of_steps
from validation.runs.history import Array
from validation.scenes.scene import Scene
from validation.theory.restitution import damping_ratio


def resultant_load(scene: Scene) -> float:
    """Resultant of pressure and weight, downwards, of the weight on a slope across it [N]."""
    (x1, y1), (x2, y2) = scene.block.edge(scene.block.top)
    length = float(np.hypot(x2 - x1, y2 - y1)) - 2 * abs(scene.load.eccentricity)
    weight = scene.block.mass * scene.load.gravity * math.cos(math.radians(scene.load.slope))
    return scene.load.pressure * length + weight


def dashpot_of(scene: Scene) -> float:
    """Return the dashpot of a corner [N s/m]: half of c = 2 zeta sqrt(2 p m) of the rigid block on both; 0 without."""
    c = scene.contact
    if not c.has_dashpots:
        return 0.0
    ratio = c.damping_ratio
    if c.restitution is not None:
        ratio = damping_ratio(c.restitution)
    return ratio * math.sqrt(2 * c.stiffness * scene.block.mass)


def start_energy(scene: Scene) -> float:
    """Kinetic energy at t = 0 [J]."""
    return scene.block.mass * scene.block.velocity**2 / 2


def energy_input(scene: Scene) -> float:
    """Kinetic energy at t = 0, and what the loads put in until they stand still: springs, strain and gap [J].

    m V^2 / 2 + F g0 + F^2 / (4 p) + F^2 h / (2 E a), with F their resultant and h the height of the block; on a slope
    the weight's part along it adds H^2 / (4 p_s).
    """
    F = resultant_load(scene)
    b = scene.block
    along = scene.block.mass * scene.load.gravity * math.sin(math.radians(scene.load.slope))
    shear_energy = along**2 / (4 * scene.contact.shear) if scene.contact.shear else 0.0
    compliance = 1 / (4 * scene.contact.stiffness) + b.extent[1] / (2 * b.young * b.base_length)
    return start_energy(scene) + abs(F) * scene.contact.gap + F**2 * compliance + shear_energy


def record(scene: Scene, **parts: Any) -> ContactRecord:
    """Return what a contact did, with the scene's own velocity and energies at the start."""
    speed = scene.block.velocity
    energy = start_energy(scene)
    input_energy = energy_input(scene)
    return ContactRecord(start_velocity=speed, start_energy=energy, input_energy=input_energy, **parts)


def end_weight(scene: Scene) -> float | None:
    """Return the weight of the contact force at a step's end in the step's impulse; None where it is no such sum.

    It is delta of Newmark's scheme, and 1 of a contact force that is fully implicit or an impact's impulse over dt. The
    conserving rule and the other schemes take forces between the steps, or forces of several.
    """
    if scene.time.scheme != "newmark":
        return None
    weights = {"newmark": scene.time.delta, "augmented": scene.time.delta, "implicit": 1.0, "impact": 1.0}
    return weights.get(scene.contact.rule)


def end_weight_of_column(scene: Scene) -> float:
    """Return the weight of a column's contact force at a step's end: delta, or 1/2, true to second order of others.

    The momentum of the column does not give the impulse at its foot: there is no exact sum to take instead.
    """
    return scene.time.delta if scene.time.scheme == "newmark" else 0.5


def impulse_of_contact(scene: Scene, force: Array, velocity: Array) -> Array:
    """Return the impulse of a contact from t = 0 on [N s]: of its force where that is a sum over the steps' ends.

    Contact force [N] and velocity of the centre of mass, upwards [m/s], are at the end of each step, shape (steps,).
    """
    weight = end_weight(scene)
    if weight is None:
        return impulse_of_momentum(scene, velocity)
    return impulse_of_force(force, scene.time.step, weight)


def impulse_of_force(force: Array, step: float, late: float) -> Array:
    """Return the impulse of a stepped force, dt sum((1 - late) N_n + late N_(n+1)) from N_0 = 0 on [N s].

    N is the force at the end of each step [N], shape (steps,), dt the step [s], late as of `end_weight`.
    """
    before = np.concatenate(([0.0], force[:-1]))
    return np.asarray(step * np.cumsum((1 - late) * before + late * force), dtype=np.float64)


def impulse_of_momentum(scene: Scene, velocity: Array) -> Array:
    """Return the impulse that changes the momentum under the loads, m sum(V1 - gg V0) + integral F from t = 0 on [N s].

    V is the velocity of the centre of mass at the end of each step, upwards [m/s], shape (steps,).
    """
    before = np.concatenate(([scene.block.velocity], velocity[:-1]))
    gained = scene.block.mass * np.cumsum(velocity - scene.time.discount * before)
    time = scene.load.acted(scene.time.step * np.arange(1.0, len(velocity) + 1))
    return np.asarray(gained + resultant_load(scene) * time, dtype=np.float64)


def rebounds(gaps: Array, step: float) -> tuple[Rebound, ...]:
    """Return the contacts of all corners between steps, in the order of their beginning.

    Gaps [m], shape (corners, steps), are negative where a corner is closed; the time step is in s.
    """
    timed_rebounds = itertools.chain.from_iterable(rebounds_of_steps(gap, step) for gap in gaps)
    return tuple(rebound for _, rebound in sorted(timed_rebounds, key=operator.itemgetter(0)))
