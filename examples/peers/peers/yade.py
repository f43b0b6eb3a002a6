"""Yade (discrete elements) as a solver: a block as one or two rigid bodies on contact points over a floor.

`yade_column` has the columns; `yade_program` is the script that the program `yade` runs, which knows nothing of scenes.

The block of one strain e with mu = 0 is two bodies of it. Base point w = v - h e / 2 and centroid v have the masses
m / 3 (of w - v) and m; in w and y = v - (w - v) / 3 the mass matrix is diagonal::

    M = diag(m / 4, 3 m / 4),    v = (w + 3 y) / 4,    strain energy 9 E a / (8 h) (w - y)^2

so that a lower body of m / 4 at the base and an upper one of 3 m / 4 at 2 h / 3 above it, on a spring of 9 E a / (4 h),
move as the block does, not approximately. Sideways the same holds with G for E, if the lower body has the moment of
inertia m a^2 / 12; a force F on the top edge is -F / 2 on the lower and 3 F / 2 on the upper body. What is left out is
the strain along the base, which nothing but a difference of the two shear forces at the corners drives.
"""

from __future__ import annotations

import math
from dataclasses import asdict
from functools import cached_property
from typing import TYPE_CHECKING, Any

import numpy as np

from peers.yade_bodies import RECIPE, Body, Bond, Drive, Floor, Model, Motion, Point, run, version
from peers.yade_column import column

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from validation.scenes.scene import Scene

    Array = NDArray[np.float64]

RIGID = 1e3  # Young's modulus times width over height, over the stiffness of the contact, beyond which a block is rigid
FINE, COARSE = 0.05, 1.6  # time step times the highest frequency: chosen, and 0.8 of the critical 2 (Yade's own factor)
MOST_STEPS = 20_000_000  # explicit steps of a run, some minutes


class Yade:
    """Yade with settings chosen for accuracy: no damping of its own, steps well below the critical one."""

    handles = frozenset(
        {
            *("off-centre load", "own weight", "unilateral contact", "friction", "slope", "large rotation", "column"),
            *("implicit contact", "energy-conserving contact"),  # rules of DDA's steps, which no other program has
        }
    )
    damping = 0.0
    fraction = FINE
    staggered = True  # whether the velocities at t = 0 are taken half a step back, where leapfrog has them
    settings = (
        "NewtonIntegrator(damping=0); step times highest frequency at most 0.05; velocities start half a step back, "
        "where the leapfrog has them"
    )

    @cached_property
    def about(self) -> dict[str, str]:
        """What the solver says of itself."""
        return {
            "program": "Yade",
            "version": version(),
            "recipe": RECIPE,
            "model": "rigid bodies and penalty springs: a deformable block is two of them, m/4 at the base and 3m/4 "
            "above, on a bond 9Ea/4h (exact for one strain, rigid along the base); a stiff or turning one is a clump; "
            "a column is a lattice of particles, its transmitting base a dashpot of the script",
            "settings": self.settings,
        }

    def solve(self, scene: Scene) -> dict[str, Array]:
        """Return the columns of a scene that Yade can report."""
        if scene.time.discount != 1:
            raise NotImplementedError("time.gg, DDA's discount of velocities, is no part of the program")
        if scene.damping.present or scene.damping.kinetic != "constant":
            raise NotImplementedError("the damping tables of the scene have no counterpart in the program")
        found = column(scene, self) if scene.column is not None else block(scene, self)
        asked = {name: values for name, values in found.items() if name in scene.run.columns}
        if not asked:
            raise NotImplementedError(f"none of the columns {', '.join(scene.run.columns)} is reported")
        return asked

    def cut(self, scene: Scene, model: Model) -> int:
        """Return the number of explicit steps in a step of the scene."""
        count = math.ceil(scene.time.step * model.highest() / self.fraction)
        if count * scene.time.steps > MOST_STEPS:
            raise NotImplementedError(
                f"the explicit scheme would need {count * scene.time.steps:.1e} steps, more than {MOST_STEPS:.0e}"
            )
        return count

    def move(self, scene: Scene, model: Model, drive: Drive | None = None) -> Motion:
        """Run the program on a model."""
        request = {
            **asdict(model),
            "drive": None if drive is None else asdict(drive),
            "cut": self.cut(scene, model),
            "steps": scene.time.steps,
            "dt": scene.time.step / self.cut(scene, model),
            "damping": self.damping,
            "staggered": self.staggered,
        }
        answer = run(request)
        return Motion(**{name: np.asarray(values, float) for name, values in answer.items()})


class AsItComes(Yade):
    """Yade with its default damping of 0.2 and the step at 0.8 of the critical one, which its own time stepper takes."""

    damping = 0.2
    fraction = COARSE
    staggered = False
    settings = (
        "NewtonIntegrator as it comes (non-viscous damping 0.2); the problem's step, or the largest fraction of it that "
        "is below 0.8 of the critical one, as its GlobalStiffnessTimeStepper has it"
    )


def block(scene: Scene, solver: Yade) -> dict[str, Array]:
    """Return the motion of a block."""
    refuse(scene)
    model = one_body(scene) if is_rigid(scene) else two_bodies(scene)
    found = solver.move(scene, model)
    x, y, turn = found.x - found.x[0], found.y - found.y[0], np.unwrap(found.turn, axis=0)
    pressed = found.force[1:] / scene.block.base_length
    if len(model.bodies) == 1:
        across, up, rotation = x[1:, 0], y[1:, 0], turn[1:, 0]
    else:
        across, up = (x[1:, 0] + 3 * x[1:, 1]) / 4, (y[1:, 0] + 3 * y[1:, 1]) / 4
        rotation = (turn[1:, 0] - (x[1:, 1] - x[1:, 0]) / (2 * sizes(scene)[1] / 3)) / 2
    return {"displacement": up, "contact_pressure": pressed, "horizontal_displacement": across, "rotation": rotation}


def refuse(scene: Scene) -> None:
    """Refuse what the bodies cannot carry, by the name of its field."""
    b, c, load = scene.block, scene.contact, scene.load
    updated = scene.run.geometry == "updated"
    if sizes(scene) is None:
        raise NotImplementedError("block.vertices: the block is no upright rectangle on its lower edge")
    if b.subdivide is not None:
        raise NotImplementedError("block.subdivide: sub-blocks of one strain each cannot be made of rigid bodies")
    if math.isinf(c.stiffness):
        raise NotImplementedError("contact.stiffness: a rigid contact has no penalty stiffness")
    if any(c.band) or c.rules == "lagged" or load.base_motion is not None:
        raise NotImplementedError("contact.band, contact.rules and load.base_motion are not taken")
    if updated and (load.pressure or load.traction):
        raise NotImplementedError("run.geometry: loads on the top of a block that turns are not taken")
    if updated and c.cohesion:
        raise NotImplementedError("contact.cohesion: is not taken of a block that turns")
    if not is_rigid(scene) and b.poisson:
        raise NotImplementedError("block.poisson: strain along the base, which a deformable block has, is left out")
    if updated and b.mass * load.gravity / b.young > 1e-3 * b.base_length:
        raise NotImplementedError("block.young: the block deforms under its weight, and one that turns is rigid here")


def sizes(scene: Scene) -> Any:
    """Return width and height of an upright rectangle on its lower edge [m], None for another outline."""
    points = np.asarray(scene.block.outline)
    if len(points) != 4 or (scene.block.base, scene.block.top) != (0, 2):
        return None
    (width, height), corners = points[2] - points[0], [(0, 0), (1, 0), (1, 1), (0, 1)]
    return (width, height) if np.array_equal(points - points[0], np.multiply(corners, (width, height))) else None


def is_rigid(scene: Scene) -> bool:
    """Whether a block is one rigid body: it turns, or its own softness is nothing beside that of the contact."""
    width, height = sizes(scene)
    return scene.run.geometry == "updated" or scene.block.young * width / height >= RIGID * 2 * scene.contact.stiffness


def floor_of(scene: Scene, height: float = 0.0) -> Floor:
    """Return the floor of a scene below points whose lowest line stands at some height."""
    c = scene.contact
    angle = math.radians(c.friction) if c.friction is not None else math.atan(1e9) if c.shear else 0.0
    cohesion = c.cohesion * scene.block.base_length / 2
    return Floor(height - c.gap, c.stiffness, c.shear, angle, cohesion, c.law == "locked")


def gravity_of(scene: Scene) -> tuple[float, float]:
    """Return gravity, turned by the slope [m/s2]."""
    slope = math.radians(scene.load.slope)
    return scene.load.gravity * math.sin(slope), -scene.load.gravity * math.cos(slope)


def top_load(scene: Scene) -> tuple[tuple[float, float], float]:
    """Return the force on the top edge [N] and its moment about the middle of that edge [N m]."""
    load, (width, _) = scene.load, sizes(scene)
    push = load.pressure * (width - 2 * abs(load.eccentricity))
    return (load.traction * width, -push), -push * load.eccentricity


def two_bodies(scene: Scene) -> Model:
    """Return the block of one strain as two bodies, see the head of the module."""
    (a, h), b, ((along, down), torque) = sizes(scene), scene.block, top_load(scene)
    joint = Point((0.0, h / 3), h / 3, touches=False)
    feet = tuple(Point((x, h / 4), h / 4) for x in (-a / 2, a / 2))
    lower, upper = (-along / 2, -down / 2), (3 * along / 2, 3 * down / 2)
    bodies = (
        Body((0.0, 0.0), b.mass / 4, (joint, *feet), b.mass * a**2 / 12, b.velocity, lower, torque),
        Body((0.0, h), 3 * b.mass / 4, (Point((0.0, 0.0), h / 3, touches=False),), 0.0, b.velocity, upper),
    )
    stiff = 9 * a / (4 * h) * b.young
    return Model(
        bodies, (Bond((0, 1), (0, 0), stiff, stiff / (2 * (1 + b.poisson))),), floor_of(scene), gravity_of(scene)
    )


def one_body(scene: Scene) -> Model:
    """Return a rigid block; one that turns stands on small spheres at its corners, else on wide ones above them."""
    (a, h), b, (force, torque) = sizes(scene), scene.block, top_load(scene)
    inertia, moment = b.mass * (a**2 + h**2) / 12, torque - force[0] * h / 2
    if scene.run.geometry != "updated":
        feet = tuple(Point((x, -h / 4), h / 4) for x in (-a / 2, a / 2))
        body = Body((0.0, h / 2), b.mass, feet, inertia, b.velocity, force, moment)
        return Model((body,), (), floor_of(scene), gravity_of(scene))
    tilt, radius = math.radians(b.tilt), deepest(scene)
    turn = np.array([[math.cos(tilt), -math.sin(tilt)], [math.sin(tilt), math.cos(tilt)]])
    corners = [turn @ (x, y) for y in (-h / 2, h / 2) for x in (-a / 2, a / 2)]
    x, y = -corners[0 if tilt >= 0 else 1]
    body = Body((x, y), b.mass, tuple(Point(tuple(map(float, at)), radius) for at in corners), inertia, b.velocity)
    return Model((body,), (), floor_of(scene, -radius), gravity_of(scene))


def deepest(scene: Scene) -> float:
    """Return a bound of how deep a corner of a rigid block is pressed into its springs [m].

    The mass falls by the gap and by what the tilt has lifted it, and lands with all its energy on one spring.
    """
    (a, h), b, p = sizes(scene), scene.block, scene.contact.stiffness
    tilt = abs(math.radians(b.tilt))
    lifted = max(0.0, (a * math.sin(tilt) + h * math.cos(tilt) - h) / 2)
    weight = b.mass * abs(scene.load.gravity)
    energy = b.mass * b.velocity**2 / 2 + weight * (scene.contact.gap + lifted)
    return 1.2 * (2 * weight / p + math.sqrt(2 * energy / p))
