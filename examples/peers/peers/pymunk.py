"""pymunk as a solver of rigid boxes: Chipmunk's sequential impulses at the velocities, in the plane."""

from __future__ import annotations

import math
from typing import Any

from peers.boxes import Pose, base_velocity, boxes_of, corners_of, record
from peers.packages import imported
from peers.programs import ExternalProgram
from validation.runs.history import Array
from validation.scenes.scene import Scene

RECIPE = "pip install pymunk==7.3.1"
USUAL_STEP = 1 / 60  # s: of most of its examples, and the one that the default of collision_bias is worked out for
STEP = 1 / 1920  # s
ITERATIONS = 100
SLOP = 1e-5  # m
CORRECTION_RATE = 60.0  # 1/s: overlap beyond the slop decays as exp(-rate t)
DEPTH = 1.0  # m of the ground below its surface


class World:
    """Boxes and ground as bodies of pymunk.

    Raises
    ------
    NotImplementedError
        pymunk is not installed, or the scene has what it cannot express.
    """

    def __init__(self, scene: Scene, *, default: bool) -> None:
        pile = boxes_of(scene)
        if pile.stiffness is not None:
            raise NotImplementedError("contact of given stiffness: pymunk's contacts are impulses")
        self.scene = scene
        self.pymunk = imported("pymunk", "pymunk", RECIPE)
        self.space = self.pymunk.Space()
        self.space.gravity = pile.pull
        if not default:
            self.space.iterations = ITERATIONS
            self.space.collision_slop = SLOP
            self.space.collision_bias = math.exp(-CORRECTION_RATE)
        self.ground = self.space.static_body
        if pile.base_amplitude:
            self.ground = self.pymunk.Body(body_type=self.pymunk.Body.KINEMATIC)
            self.space.add(self.ground)
        left, right = boxes_of(scene).ends
        corners = [(left, -DEPTH), (right, -DEPTH), (right, 0.0), (left, 0.0)]
        self._add_shape(self.ground, corners)
        self.boxes = []
        for box, (x, y, angle) in zip(pile.boxes, pile.starts, strict=True):
            body = self.pymunk.Body(box.mass, box.inertia)
            body.position = x, y
            body.angle = angle
            body.velocity = box.velocity
            body.angular_velocity = box.spin
            self.space.add(body)
            self._add_shape(body, corners_of(box))
            self.boxes.append(body)

    def _add_shape(self, body: Any, corners: list[tuple[float, float]]) -> None:
        pile = boxes_of(self.scene)
        shape = self.pymunk.Poly(body, corners)
        # A pair has the product of the two shapes' coefficients.
        shape.friction = math.sqrt(pile.friction_coefficient)
        shape.elasticity = math.sqrt(pile.rebound)
        self.space.add(shape)

    def advance(self, start: float, step: float) -> None:
        """Make one step of pymunk."""
        if self.ground is not self.space.static_body:
            self.ground.velocity = base_velocity(self.scene, start, step, self.ground.position.x), 0.0
        self.space.step(step)

    def poses(self) -> list[Pose]:
        """Return position and angle of each box."""
        return [(*body.position, body.angle) for body in self.boxes]

    def forces(self) -> list[float]:
        """Return the normal force below each box, the mean of the last step [N]."""
        values = []
        below = self.ground
        for body in self.boxes:
            impulses: list[float] = []
            body.each_arbiter(_add_impulse, below, impulses)
            values.append(sum(impulses) / self.space.current_time_step)
            below = body
        return values


def _add_impulse(arbiter: Any, below: Any, impulses: list[float]) -> None:
    """Note the normal impulse of a contact if it is one with the body below."""
    if below in arbiter.bodies:
        impulses.append(abs(arbiter.total_impulse.dot(arbiter.normal)))


class Pymunk(ExternalProgram):
    """pymunk with settings chosen for accuracy."""

    program = "pymunk (Chipmunk)"
    package = "pymunk"
    recipe = RECIPE
    model = "boxes in the plane; contact by impulses, sequentially, warm-started"
    default = False
    settings = f"step 1/1920 s, {ITERATIONS} iterations, slop 10 micrometres, overlap corrected at 60 1/s"

    def solve(self, scene: Scene) -> dict[str, Array]:
        """Return the columns of a scene.

        Raises
        ------
        NotImplementedError
            pymunk is not installed, or the scene has what it cannot express.
        """
        world = World(scene, default=self.default)
        own_step = USUAL_STEP if self.default else STEP
        return record(scene, own_step, world.advance, world.poses, world.forces)


class AsItComes(Pymunk):
    """pymunk with every setting at its default, at the step of its examples."""

    default = True
    settings = "step 1/60 s; 10 iterations, slop 0.1 m, overlap corrected by a tenth in 1/60 s; no sleeping"
