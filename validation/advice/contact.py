"""What springs and time step make of a contact that opens, and which of them give an accuracy asked for.

The block of one strain meets its springs with a quarter of its mass: the base moves with 1/m of the translation and
3/m of the strain. With p at either corner

    w_c = sqrt(8 p / m),   Omega = w_c dt

decide how a contact ends: Omega << 1 follows the motion, Omega > 2 returns a speed that depends on where in the step
the block has landed.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import asdict, dataclass
from typing import Any

import numpy as np

from validation.gates import closed_forms
from validation.scenes.scene import Scene
from validation.solvers import opened
from validation.solvers.rigid.impacts import impact_statistics

RAISES, LEAST_RAISE = 8, 1.2  # of p, until the exact block stays above the penetration asked for
WRONG, ARBITRARY = 0.3, 2.0  # Omega beyond which the restitution is off by a fifth, and depends on the phase alone


@dataclass(frozen=True)
class Restitution:
    """Restitution of a contact over its phase [-]."""

    mean: float
    low: float
    high: float
    energy: float  # mean of e^2, the share of the energy that is left


@dataclass(frozen=True)
class Needed:
    """Springs and time step that give an accuracy asked for."""

    stiffness: float  # p [N/m]
    step: float  # dt at that p [s]
    depth: float | None  # how deep the exact block goes at that p [m]; None where that was not asked or has no answer
    first_guess: float  # p from the load at rest and one landing at the speed V, as in the formula [N/m]
    step_now: float  # dt at the present p [s]
    omega: float  # w_c dt of both [-]
    restitution: Restitution | None  # what the scheme then really returns


def contact_frequency(scene: Scene, stiffness: float | None = None) -> float:
    """Return w_c = sqrt(8 p / m) of a scene, or of other springs [rad/s]."""
    return math.sqrt(8 * (scene.contact.stiffness if stiffness is None else stiffness) / scene.block.mass)


def omega(scene: Scene) -> float:
    """Return Omega = w_c dt of a scene [-]."""
    return contact_frequency(scene) * scene.time.step


def restitution(scene: Scene, at: float) -> Restitution | None:
    """Return what the scene's scheme makes of a contact at Omega; None where the map of the scheme is not defined.

    A contact force that is fully implicit acts as constant acceleration does; energy-conserving contact returns all.
    """
    t, rule = scene.time, scene.contact.rule
    if rule == "energy-conserving" and t.discount == 1:
        return Restitution(1.0, 1.0, 1.0, 1.0)
    scheme = (0.5, 1.0) if rule == "implicit" else (t.alpha, t.delta)
    try:
        return Restitution(*impact_statistics(*scheme, t.discount, at))
    except ValueError:
        return None


def hidden_from(scene: Scene) -> float | None:
    """Return the time step beyond which a block under a pressure that is switched on does not leave its springs [s].

    The free block's base rises in the first step, from A0 = 0, if

        dt^2 < h^2 / (6 alpha c^2) (1 - r/2) / (1 + r),   r = rho g h / q

    whatever p and gg. None where it does not rise at all, or does not start on its springs at rest.
    """
    b, q, t = scene.block, scene.load, scene.time
    height = float(np.ptp([y for _, y in b.outline]))
    weight = b.density * q.gravity * height / q.pressure if q.pressure > 0 else 2.0
    from_zero = t.alpha > 0 and (t.start == "zero" or t.alpha == 0.5)
    if not (from_zero and scene.contact.gap == 0 == b.velocity and weight < 2):
        return None
    modulus, _ = closed_forms.moduli(scene)
    free = height * math.sqrt(b.density / modulus / (6 * t.alpha))
    return free * math.sqrt((1 - weight / 2) / (1 + weight))


def impact_force(scene: Scene, speed: float) -> float:
    """Return the force V sqrt(p m / 2) with which the block of one strain lands on its springs at a speed [N]."""
    return abs(speed) * math.sqrt(scene.contact.stiffness * scene.block.mass / 2)


def wave_force(scene: Scene, speed: float) -> float:
    """Return the force rho c V a with which a bar lands on a rigid wall [N]."""
    modulus, _ = closed_forms.moduli(scene)
    return abs(speed) * math.sqrt(modulus * scene.block.density) * scene.block.base_length


def largest_omega(scene: Scene, error: float) -> float:
    """Return the Omega at which the restitution differs from 1 by an error.

    4 y / (pi (2 delta - 1)) of algorithmic damping, and sqrt(8 y) of the phase; the smaller of the two.
    """
    over = 1.0 if scene.contact.rule == "implicit" else 2 * scene.time.delta - 1
    phase = math.sqrt(8 * error)
    return min(phase, 4 * error / (math.pi * over)) if over > 0 else phase


def needed(
    scene: Scene, speed: float, error: float, penetration: float, probe: Callable[[float], float | None] | None = None
) -> Needed:
    """Return springs and time step for a restitution error and a penetration.

    p = max(W / (2 x), V^2 m / (8 x^2)) holds the load at rest and one landing; the strain of the block and the second
    of two impacts in a row go deeper. So p is raised, as the square of the depth, until the exact block stays above x;
    and dt = Omega / w_c with the Omega of `largest_omega`.

    Parameters
    ----------
    scene
        The scene.
    speed
        Greatest speed V at which the base lands [m/s].
    error
        Error y of the restitution [-].
    penetration
        Penetration x [m].
    probe
        Function of p that returns how deep the exact block goes [m], None where there is no answer.
    """
    static = abs(opened.pushing(scene)) / (2 * penetration)
    landing = speed**2 * scene.block.mass / (8 * penetration**2)
    p = max(static, landing) or scene.contact.stiffness  # without load and speed any springs do
    limit = largest_omega(scene, error)
    enough, depth = p, probe(p) if probe else None
    for _ in range(RAISES):
        if probe is None or depth is None or depth <= penetration:
            break
        enough *= max(LEAST_RAISE, (depth / penetration) ** 2)
        depth = probe(enough)
    steps = limit / contact_frequency(scene, enough), limit / contact_frequency(scene)
    return Needed(enough, steps[0], depth, p, steps[1], limit, restitution(scene, limit))


def as_dict(found: Needed) -> dict[str, Any]:
    """Return plain data for JSON."""
    return asdict(found)
