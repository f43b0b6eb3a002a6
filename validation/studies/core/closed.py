"""What a step damps, in closed form: over the time step of a scene, and the step for a ratio."""

from __future__ import annotations

from collections.abc import Iterable
from typing import Any

import numpy as np

from validation.runs.history import Array
from validation.scenes.scene import Scene
from validation.theory import spectra, statics
from validation.theory.stepping import Stepping

LOWEST = 1e-3  # w dt from which on a ratio is looked for
HIGHEST = 8.0  # w dt up to which it is
POINTS = 100  # a ratio changes smoothly with the step; where it is crossed is solved for between two


def timed(scene: Scene, **values: Any) -> Scene:
    """Return a scene with other values of time, known to be allowed; weights are Newmark's."""
    weights = {name: values.pop(name) for name in ("alpha", "delta") if name in values}
    if weights:
        values |= {"scheme": "newmark", "rho_inf": None, "split": None}
        values |= {f"stated_{name}": value for name, value in weights.items()}
    return scene.model_copy(update={"time": scene.time.model_copy(update=values)})


def constant(scene: Scene, **values: Any) -> Scene:
    """Return a scene under constant acceleration without a discount."""
    return timed(scene, alpha=0.5, delta=1.0, gg=1.0, **values)


def average(scene: Scene, gg: float = 1.0) -> Scene:
    """Return a scene under average acceleration and a discount per step."""
    return timed(scene, alpha=0.25, delta=0.5, gg=gg)


def stiffer(scene: Scene, ratio: float) -> Scene:
    """Return the scene with springs of p = ratio E."""
    contact = scene.contact.model_copy(update={"stiffness": ratio * scene.block.young})
    return scene.model_copy(update={"stated_contact": contact})


def ratio_of(scene: Scene) -> float:
    """Return p/E of a scene [-]."""
    return scene.contact.stiffness / scene.block.young


def first_damping(scene: Scene) -> float:
    """Return xi of the DDA block's first axial mode [-]: at least 1 where it creeps, NaN for a negative root."""
    return float(over_steps(scene, np.array([scene.time.step]))[0])


def over_steps(scene: Scene, steps: Array) -> Array:
    """Return xi of the first axial mode over time steps [s]; a discount that is a rate stays one."""
    frequency = spectra.dda_frequency(scene)
    stepping = Stepping.of(scene)
    return np.array([stepping.at(float(step)).damping_ratio(frequency * float(step)) for step in steps])


def steps_for(scene: Scene, ratios: Iterable[float]) -> list[float | None]:
    """Return the least time step [s] that damps the first axial mode by each ratio, or None."""
    from scipy.optimize import brentq

    steps = np.geomspace(LOWEST, HIGHEST, POINTS) / spectra.dda_frequency(scene)
    damping = over_steps(scene, steps)
    least = []
    for ratio in ratios:
        with np.errstate(invalid="ignore"):
            crossed = np.flatnonzero((damping[:-1] < ratio) & (damping[1:] >= ratio))[:1]
        bracket = [(steps[i], steps[i + 1]) for i in crossed]
        found = [brentq(lambda step, by=ratio: over_steps(scene, np.array([step]))[0] - by, *ends) for ends in bracket]
        least.append(float(found[0]) if found else None)
    return least


def most_damped(scene: Scene) -> float:
    """Return w dt at which (1/2, 1) damps the first axial mode most, by its ratio."""
    frequency = spectra.dda_frequency(scene)
    turns = np.linspace(LOWEST, 4.0, 4 * POINTS)
    return float(turns[np.nanargmax(over_steps(scene, turns / frequency))])


def rate_for(scene: Scene, ratio: float) -> float:
    """Return the rate c [1/s] of gg = exp(-c dt) that damps the first axial mode by a ratio as dt tends to 0."""
    return 2 * spectra.dda_frequency(scene) * ratio


def overdamped_below(scene: Scene) -> float | None:
    """Return the step [s] below which a discount per step overdamps the first axial mode, or None."""
    from scipy.optimize import brentq

    if scene.time.discount >= 1 or scene.time.gg_rate is not None:
        return None
    # w dt of two equal roots lies near (1 - gg) / 2
    middle = (1 - scene.time.discount) / 2 / spectra.dda_frequency(scene)
    return float(brentq(lambda step: first_damping(timed(scene, step=step)) - 1, middle / 4, 4 * middle))


def contact_radius(scene: Scene) -> float:
    """Return |lambda| of the contact mode over one step."""
    return spectra.spectral_radius(scene, spectra.contact_frequency(scene))


def spring_share(scene: Scene) -> float:
    """Return how far the springs deflect at rest over the block's own shortening to its centroid [1].

    (a q / 2p) / (h q / 2E') = (w / h) E' / p: a rule on p alone holds for one slenderness.
    """
    E, _ = statics.moduli(scene)
    width, height = statics.size(scene)
    return width / height * E / scene.contact.stiffness


def sign_change_step(scene: Scene) -> float:
    """Return the step [s] beyond which (1/2, 1) has two negative roots for the contact mode: 4 / w.

    The contact force then changes sign in each step.
    """
    return 4 / spectra.contact_frequency(scene)


def penetration(scene: Scene) -> float:
    """Return how far the springs deflect at rest [m]: a q / (2 p)."""
    return statics.size(scene)[0] * scene.load.pressure / (2 * scene.contact.stiffness)
