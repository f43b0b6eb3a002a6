"""What springs and time step make of a landing, and which springs keep a penetration.

The landing is that of an unloaded, unstrained rectangle that comes down on both corners; `theory.landing` has the
block's own, exact in time, and that of a time step.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import NamedTuple

from validation.scenes.scene import Scene
from validation.solvers import opened
from validation.theory import landing, spectra
from validation.theory.stepping import Stepping

RAISES = 8  # of p, at most, until the exact block stays above the requested penetration
LEAST_RAISE = 1.2  # factor on p
NOTABLE = 0.1  # error of the restitution, and its range over the phase, from which on they are an alarm


class Needed(NamedTuple):
    """Springs that keep a penetration."""

    stiffness: float  # p [N/m]
    depth: float | None  # how deep the exact block goes at that p [m]; None without a probe or where it has no answer


def omega(scene: Scene) -> float:
    """Return w_c dt of a scene [-]."""
    return landing.contact_frequency(scene) * scene.time.step


def stepping(scene: Scene) -> Stepping | None:
    """Return the scheme of a landing; None where it is not known.

    Energy-conserving contact is not linear between switches; the map of a landing is that of Newmark's scheme on
    springs without dashpots; a scheme with alpha = 0 has no contact force at the end of its step, and only a rectangle
    lands as one strain.
    """
    scheme = Stepping.of(scene)
    c = scene.contact
    has_map = scheme.scheme == "newmark" and c.rule in ("newmark", "implicit") and not c.has_dashpots
    is_known = has_map and scheme.has_contact_forces and scene.block.rectangle is not None
    return scheme if is_known else None


def restitution(scene: Scene) -> landing.SteppedLanding | None:
    """Return what a scene's scheme makes of a landing; None if unknown, or if its steps are too many to follow."""
    scheme = stepping(scene)
    if scheme is None:
        return None
    return landing.stepped_landing(scheme, landing.stiffness_ratio(scene), scene.time.step, spectra.transit(scene))


def needed(
    scene: Scene, speed: float, penetration: float, probe: Callable[[float], float | None] | None = None
) -> Needed:
    """Return springs for a penetration x [m] of a base that lands at the speed V [m/s] at most.

    p = max(W / (2 x), D^2 V^2 m / (8 x^2)) holds the load at rest and one unloaded landing, D = 1.47 to 2 by p itself.
    Load and strain at the landing go deeper still, so p is raised, as the square of the depth, until the exact block
    stays above x. `probe` returns how deep that goes on springs p [m], None where there is no answer.
    """
    static = abs(opened.resultant_load(scene)) / (2 * penetration)
    landed = landing.springs_for(scene, speed, penetration) if speed else 0.0
    p = max(static, landed) or scene.contact.stiffness  # without load and speed any springs do
    depth = probe(p) if probe else None
    for _ in range(RAISES):
        if probe is None or depth is None or depth <= penetration:
            break
        p *= max(LEAST_RAISE, (depth / penetration) ** 2)
        depth = probe(p)
    return Needed(p, depth)
