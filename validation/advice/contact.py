"""What springs and time step make of a contact that opens, and which of them keep a restitution and a penetration.

All of it is about one landing: an unloaded, unstrained rectangle that comes down on both corners. `theory.landing` has
the block's own landing, exact in time, and that of a time step; the advice is the difference of the two.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import asdict, dataclass
from typing import Any

from validation.scenes.scene import Scene
from validation.solvers import opened
from validation.theory import landing, spectra
from validation.theory.stepping import Stepping

RAISES = 8  # of p, at most, until the exact block stays above the requested penetration
LEAST_RAISE = 1.2  # factor on p
NOTABLE = 0.1  # error of the restitution, and its range over the phase, from which on they are an alarm


@dataclass(frozen=True)
class Needed:
    """Springs and time steps that keep a penetration and a restitution."""

    stiffness: float  # p [N/m]
    depth: float | None  # how deep the exact block goes at that p [m]; None without a probe or where it has no answer
    first_guess: float  # p from the load at rest and one unloaded landing [N/m]
    steps: landing.AllowedSteps | None  # at that p; None where the landing of the scheme is not known
    steps_now: landing.AllowedSteps | None  # at the present p
    restitution: landing.SteppedLanding | None  # at that p and the longest of its steps


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


def restitution(
    scene: Scene, step: float | None = None, stiffness: float | None = None
) -> landing.SteppedLanding | None:
    """Return what the scene's scheme makes of a landing, at its own step and springs or at others; None if unknown."""
    scheme = stepping(scene)
    if scheme is None:
        return None
    ratio = landing.stiffness_ratio(scene, stiffness)
    if step is None:
        step = scene.time.step
    return landing.stepped_landing(scheme, ratio, step, spectra.transit(scene))


def needed(
    scene: Scene, speed: float, error: float, penetration: float, probe: Callable[[float], float | None] | None = None
) -> Needed:
    """Return springs and time steps for a restitution error and a penetration.

    p = max(W / (2 x), D^2 V^2 m / (8 x^2)) holds the load at rest and one unloaded landing, D = 1.47 to 2 by p itself.
    Load and strain at the landing go deeper still, so p is raised, as the square of the depth, until the exact block
    stays above x. The steps are those at which a landing differs from the block's own restitution by no more than y.

    Parameters
    ----------
    scene
        The scene.
    speed
        Greatest speed V at which the base lands [m/s].
    error
        Error y of the restitution of the centre of mass, from that of the block itself [-].
    penetration
        Penetration x [m].
    probe
        Function of p that returns how deep the exact block goes [m], None where there is no answer.
    """
    static = abs(opened.resultant_load(scene)) / (2 * penetration)
    landed = landing.springs_for(scene, speed, penetration) if speed else 0.0
    first_guess = max(static, landed) or scene.contact.stiffness  # without load and speed any springs do
    p = first_guess
    depth = probe(p) if probe else None
    for _ in range(RAISES):
        if probe is None or depth is None or depth <= penetration:
            break
        p *= max(LEAST_RAISE, (depth / penetration) ** 2)
        depth = probe(p)
    steps = allowed_steps(scene, error, p)
    at_longest_step = None
    if steps is not None and steps.longest is not None:
        at_longest_step = restitution(scene, steps.longest, p)
    return Needed(p, depth, first_guess, steps, allowed_steps(scene, error), at_longest_step)


def allowed_steps(scene: Scene, error: float, stiffness: float | None = None) -> landing.AllowedSteps | None:
    """Return the steps that keep a restitution on a scene's or other springs; None if unknown or on a rigid stop."""
    scheme = stepping(scene)
    ratio = landing.stiffness_ratio(scene, stiffness)
    if scheme is None or math.isinf(ratio):
        return None
    return landing.allowed_steps(scheme, ratio, spectra.transit(scene), error)


def as_dict(needs: Needed) -> dict[str, Any]:
    """Return plain data for JSON, with the longest steps by names of their own as well."""
    longest = {"step": needs.steps, "step_now": needs.steps_now}
    return asdict(needs) | {name: None if steps is None else steps.longest for name, steps in longest.items()}
