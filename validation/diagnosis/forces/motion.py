"""The forces of the contact that a recorded motion shows, by the scheme that made it."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

import dda
from validation.runs.history import Array
from validation.scenes.scene import Scene
from validation.scenes.tables import TimeSection
from validation.solvers.dda import model_of
from validation.theory.friction import coefficient
from validation.theory.statics import size

STANDARD = 9.81  # m/s2
INTERNAL = slice(2, 6)  # r, ex, ey, gxy among the six unknowns of a block


@dataclass(frozen=True, eq=False)
class Body:
    """A rectangle on its two corners: M and K of (r, ex, ey, gxy), its loads, and what the corners follow."""

    mass: float  # kg
    inertia: Array  # (4, 4)
    elastic: Array  # (4, 4)
    load: Array  # (2,), on the centroid, along and across the base [N]
    internal: Array  # (4,), of pressure and traction on the internal unknowns [N m]
    x: tuple[float, float]  # of the corners from the centroid [m]
    along: Array  # (2, 4), how the internal unknowns move the corners along the base
    across: Array  # (2, 4), and across it
    stiffness: float  # p [N/m]
    shear: float  # p_s [N/m]
    coefficient: float  # tan(phi) [-]
    cohesion: float  # N a corner

    def heavier(self, weight: float) -> Body:
        """Return it under a share of its own weight as well, which acts across the base."""
        return replace(self, load=self.load - np.array([0.0, weight * STANDARD * self.mass]))

    def softer(self, softness: float) -> Body:
        """Return it on a base that lets the normal springs be stiff by exp(-softness) only."""
        return replace(self, stiffness=self.stiffness * float(np.exp(-softness)))


def body_of(scene: Scene) -> Body:
    """Return the rectangle of a scene, with the matrices of DDA's own model of it."""
    model, c = model_of(scene), scene.contact
    normal, shear = dda.spring_vectors(model.block, 0)
    half = size(scene)[0] / 2
    return Body(
        mass=scene.block.mass,
        inertia=model.mass[INTERNAL, INTERNAL],
        elastic=model.block.elastic()[INTERNAL, INTERNAL],
        load=model.force[:2],
        internal=model.force[INTERNAL],
        x=(-half, half),
        along=shear[:, INTERNAL],
        across=normal[:, INTERNAL],
        stiffness=c.stiffness,
        shear=c.shear,
        coefficient=coefficient(scene),
        cohesion=c.cohesion * half,
    )


@dataclass(frozen=True, eq=False)
class Motion:
    """Displacements of the centroid along and across the base, and its accelerations, (steps, 2)."""

    time: TimeSection  # of the scheme that made it
    place: Array  # m
    acceleration: Array  # m/s2

    def forces(self, body: Body) -> Array:
        """Return the resultants of the contact along and across the base [N], (steps, 2)."""
        return np.asarray(body.mass * self.acceleration - body.load)


def motion_of(place: Array, time: TimeSection, body: Body) -> Motion:
    """Return what a scheme must have had as accelerations for the displacements to be its own.

    A1 = (D1 - D0 - gg dt V0 - dt^2 (1/2 - alpha) A0) / (alpha dt^2), from rest.
    """
    dt, gg, alpha, delta = time.step, time.discount, time.alpha, time.delta
    D, V = np.zeros(2), np.zeros(2)
    A = body.load / body.mass if time.start == "consistent" else np.zeros(2)
    accelerations = np.empty_like(place)
    for n, there in enumerate(place):
        A1 = (there - D - gg * dt * V - dt**2 * (0.5 - alpha) * A) / (alpha * dt**2)
        V = gg * V + dt * ((1 - delta) * A + delta * A1)
        D, A, accelerations[n] = there, A1, A1
    return Motion(time, place, accelerations)
