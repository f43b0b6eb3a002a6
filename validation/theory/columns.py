r"""Columns whose contacts open or slip: end of the open-close iteration, ring-down of a stack, its static state.

A step under the scheme makes of the contacts of N blocks one problem with a tridiagonal matrix, whose entries beside
the diagonal are at most zero where a block is rigid or

    c dt / h >= 1 / sqrt(6 alpha),

c the speed of its wave and h its height. Then the states change one way only from the second solve on, and the
iteration ends after at most N + 1 solves, whatever the scheme's delta and gg. Below, a push at the foot of a block of
one strain moves its far face the wrong way: the contact above opens before any wave has arrived.
"""

from __future__ import annotations

import itertools
import math
from collections.abc import Sequence

import numpy as np

from validation.models.column.tables import NEAR, ColumnSection
from validation.runs.history import Array
from validation.theory.stepping import Stepping

GRID = 33  # values of w at which a root is looked for at once
OCTAVE = 2.0  # of them; two modes of a column within a thirty-second of one are taken for none
ROUNDING = 1e-9  # by which a column of one mass may have its root below the bound
FAR_FACE = 6.0  # of the Courant number 1 / sqrt(6 alpha): consistent mass of a block of one strain


def greatest_solves(contacts: int) -> int:
    """Return the most solves that the open-close iteration of a step can need, the confirming one included."""
    return contacts + 1


def far_face_step(speed: float, height: float, alpha: float) -> float:
    """Return the step below which a push at one face of a block moves the other face the wrong way [s].

    Zero for a rigid block, infinite for another under alpha = 0; `speed` is that of the block's wave [m/s].
    """
    if math.isinf(speed):
        return 0.0
    if alpha <= 0:
        return math.inf
    return height / speed / math.sqrt(FAR_FACE * alpha)


def lowest_frequency(stiffness: float, mass: float, blocks: int) -> float:
    """Return the lowest natural frequency of equal rigid blocks on each other on a base, all contacts closed [rad/s].

    w1 = 2 sqrt(k / m) sin(pi / (2 (2 N + 1))), the stiffness k of a contact [Pa/m] and the mass m of a block [kg/m2]
    per unit of area.
    """
    return 2 * math.sqrt(stiffness / mass) * math.sin(math.pi / (2 * (2 * blocks + 1)))


def first_frequency(column: ColumnSection) -> float | None:
    """Return the first natural frequency of a column of blocks of one strain, all contacts closed [rad/s].

    The least w at which no stress is left on the top of blocks whose foot stands still. It is at least that of all
    mass on top of all that gives way, from where the root is looked for upwards. None where the base is free or
    transmitting, or nothing gives way.
    """
    from scipy.optimize import brentq

    if column.base in ("free", "transmitting"):
        return None
    mass = sum(layer.density * layer.thickness for layer in column.layer)
    flexibility = sum(layer.thickness / column.modulus(layer) for layer in column.layer)
    flexibility += sum(1 / stiffness for _, stiffness in _springs(column))
    if flexibility == 0:
        return None
    low = 1 / math.sqrt(mass * flexibility)
    high = OCTAVE * low
    while np.all(_top_stress(column, np.geomspace(low, high, GRID)) > 0):
        low, high = high, OCTAVE * high
    grid = np.geomspace(low * (1 - ROUNDING), high, GRID)
    first = int(np.argmax(_top_stress(column, grid) <= 0))
    return float(brentq(lambda w: float(_top_stress(column, np.array(w))), grid[max(first - 1, 0)], grid[first]))


def _springs(column: ColumnSection) -> list[tuple[float, float]]:
    """Return height [m] and stiffness [Pa/m] of each spring across a column, from the base upwards."""
    if column.law != "bonded":
        return [(contact.height, contact.stiffness) for contact in column.contacts]
    springs = [(joint.height, joint.stiffness) for joint in column.springs]
    if column.glue is not None:
        springs += [(face, column.glue) for face in column.plain_faces]
    return sorted(springs)


def _top_stress(column: ColumnSection, frequencies: Array) -> Array:
    """Return the stress on the top where that on the base is 1, at frequencies w [rad/s].

    A block of one strain with the faces' displacements u, U has the stresses s = (M/h)(U - u) + w2 rho h (2u + U)/6
    below and S = s - w2 rho h (u + U)/2 above it.
    """
    springs = _springs(column)
    displacement = np.zeros_like(frequencies)
    stress = np.ones_like(frequencies)
    foot = 0.0
    near = NEAR * column.height
    for layer in column.layer:
        height = layer.thickness / layer.blocks
        flexibility = height / column.modulus(layer)
        inertia = frequencies**2 * layer.density * height
        for _ in range(layer.blocks):
            while springs and springs[0][0] <= foot + near:
                displacement = displacement + stress / springs.pop(0)[1]
            stretch = flexibility * (stress - inertia * displacement / 3)
            upper = (stretch + displacement) / (1 + flexibility * inertia / 6)
            stress = stress - inertia * (displacement + upper) / 2
            displacement = upper
            foot += height
    return stress


def ring_down(omega: float, stepping: Stepping, share: float = 1e-3) -> float:
    """Return the time in which a free vibration falls to a share of its amplitude under a step [s].

    dt ln(1 / share) / -ln |z|, z the largest root of a step at omega [rad/s] times dt. For small w dt that is
    ln(1 / share) / (w^2 (delta - 1/2) dt / 2 + (1 - gg) / (2 dt)) of Newmark's scheme: its algorithmic damping and the
    discount, which is a rate per step. Infinite where neither damps.
    """
    if not stepping.damps and stepping.gg == 1:
        return math.inf
    radius = stepping.spectral_radius(omega * stepping.step)
    if radius >= 1:
        return math.inf
    return 0.0 if radius == 0 else stepping.step * math.log(1 / share) / -math.log(radius)


def static_forces(weights: Sequence[float]) -> list[float]:
    """Return the forces of the contacts of a column at rest [Pa], from the base upwards, of the weights of its blocks.

    Each carries the weights above it [Pa, per unit of area, from the base upwards], whatever happened before.
    """
    return [*itertools.accumulate(reversed(weights))][::-1]
