"""The forces of the contact that a recorded motion shows, by the scheme that made it."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from validation.runs.history import Array
from validation.scenes.scene import Scene
from validation.theory.friction import across, along, coefficient
from validation.theory.statics import moduli, size

STANDARD = 9.81  # m/s2


@dataclass(frozen=True, eq=False)
class Body:
    """A rectangle on its two corners: M and K of (r, ex, ey, gxy), its loads, and what the corners follow."""

    mass: float  # kg
    inertia: Array  # (4, 4)
    elastic: Array  # (4, 4)
    load: Array  # (2,), on the centroid, along and across the base [N]
    internal: Array  # (4,), of pressure and traction on the internal unknowns [N m]
    x: tuple[float, float]  # of the corners from the centroid [m]
    height: float  # m
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

    def row(self, c: int) -> tuple[Array, Array]:
        """Return how the internal unknowns move a corner along and across the base [m]."""
        x, y = self.x[c], -self.height / 2
        return np.array([-y, x, 0.0, y / 2]), np.array([x, 0.0, y, x / 2])


def body_of(scene: Scene) -> Body:
    """Return the rectangle of a scene."""
    width, height = size(scene)
    m, q, c = scene.block.mass, scene.load, scene.contact
    x2, y2 = m * width**2 / 12, m * height**2 / 12
    inertia = np.diag([x2 + y2, x2, y2, (x2 + y2) / 4])
    inertia[0, 3] = inertia[3, 0] = (x2 - y2) / 2
    E, mu = moduli(scene)
    elastic = np.zeros((4, 4))
    elastic[1:, 1:] = width * height * E / (1 - mu * mu) * np.array([[1, mu, 0], [mu, 1, 0], [0, 0, (1 - mu) / 2]])
    pressed = q.pressure * (width - 2 * abs(q.eccentricity))
    pulled = q.traction * width
    load = np.array([m * along(scene) + pulled, -m * across(scene) - pressed])
    e, h = q.eccentricity, height / 2
    internal = -pressed * np.array([e, 0.0, h, e / 2]) + pulled * np.array([-h, 0.0, 0.0, h / 2])
    cohesion_force = c.cohesion * width / 2
    corners = -width / 2, width / 2
    return Body(
        m, inertia, elastic, load, internal, corners, height, c.stiffness, c.shear, coefficient(scene), cohesion_force
    )


@dataclass(frozen=True)
class Scheme:
    """Newmark's numbers of a program."""

    alpha: float
    delta: float
    gg: float
    step: float  # s
    consistent: bool

    @classmethod
    def of(cls, scene: Scene, step: float) -> Scheme:
        """Return those of a scene at a program's step."""
        t = scene.time
        return cls(t.alpha, t.delta, t.discount, step, t.start == "consistent")


@dataclass(frozen=True, eq=False)
class Motion:
    """Displacements of the centroid along and across the base, and its accelerations, (steps, 2)."""

    scheme: Scheme
    place: Array  # m
    acceleration: Array  # m/s2

    def forces(self, body: Body) -> Array:
        """Return the resultants of the contact along and across the base [N], (steps, 2)."""
        return np.asarray(body.mass * self.acceleration - body.load)


def motion_of(place: Array, scheme: Scheme, body: Body) -> Motion:
    """Return what a scheme must have had as accelerations for the displacements to be its own.

    A1 = (D1 - D0 - gg dt V0 - dt^2 (1/2 - alpha) A0) / (alpha dt^2), from rest.
    """
    s, dt = scheme, scheme.step
    D, V = np.zeros(2), np.zeros(2)
    A = body.load / body.mass if s.consistent else np.zeros(2)
    accelerations = np.empty_like(place)
    for n, there in enumerate(place):
        A1 = (there - D - s.gg * dt * V - dt**2 * (0.5 - s.alpha) * A) / (s.alpha * dt**2)
        V = s.gg * V + dt * ((1 - s.delta) * A + s.delta * A1)
        D, A, accelerations[n] = there, A1, A1
    return Motion(scheme, place, accelerations)
