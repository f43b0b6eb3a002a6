"""Box2D v3 as a solver of rigid boxes: soft contact in sub-steps, in the plane, in single precision."""

from __future__ import annotations

import math

from peers.boxes import Pose, base_velocity, boxes_of, record, substeps
from peers.packages import imported
from peers.programs import ExternalProgram
from validation.runs.history import Array
from validation.scenes.scene import Scene

RECIPE = "pip install pyb2d3==0.11.1"
USUAL_STEP = 1 / 60  # s: that of Box2D's documentation of b2World_Step, as are four sub-steps
SUB_STEPS = 4
STEP = 1 / 960  # s
DAMPING_RATIO = 10.0  # as it comes
PUSH_SPEED = 3.0  # m/s, as it comes
DEPTH = 1.0  # m of the ground below its surface


class World:
    """Boxes and ground as bodies of Box2D.

    Raises
    ------
    NotImplementedError
        Box2D is not installed, or the scene has what it cannot express.
    """

    def __init__(self, scene: Scene, *, default: bool) -> None:
        pile = boxes_of(scene)
        if pile.stiffness is not None:
            raise NotImplementedError(
                "contact of given stiffness: Box2D's hertz correct overlap, its contacts stop a box dead"
            )
        self.scene = scene
        self.box2d = imported("pyb2d3", "Box2D", RECIPE)
        self.world = self.box2d.World(gravity=pile.pull)
        self.moves = bool(pile.base_amplitude)
        self.default = default
        if not default:
            self.world.restitution_threshold = 0.0
            self.world.sleeping_enabled = False
            # The stiffest that Box2D takes: a quarter of the rate of its sub-steps, to which it lowers what is above.
            hertz = SUB_STEPS * substeps(scene, STEP) / scene.time.step / 4
            self.world.set_contact_tuning(hertz, DAMPING_RATIO, PUSH_SPEED)
        material = self.box2d.surface_material(friction=pile.friction_coefficient, restitution=pile.rebound)
        left, right = boxes_of(scene).ends
        corners = [(left, -DEPTH), (right, -DEPTH), (right, 0.0), (left, 0.0)]
        self.ground = self.world.create_kinematic_body() if self.moves else self.world.create_static_body()
        self.ground.create_polygon_shape(self.box2d.shape_def(material=material), self.box2d.polygon(corners))
        self.boxes = []
        self.turns = []
        for box, (x, y, angle) in zip(pile.boxes, pile.starts, strict=True):
            body = self.world.create_dynamic_body(
                position=(x, y),
                rotation=self.box2d.make_rot(angle),
                linear_velocity=box.velocity,
                angular_velocity=box.spin,
            )
            shape = self.box2d.box(box.width / 2, box.height / 2)
            body.create_polygon_shape(self.box2d.shape_def(density=box.density, material=material), shape)
            self.boxes.append(body)
            self.turns.append(angle)

    def advance(self, start: float, step: float) -> None:
        """Make one step of Box2D, and follow the angles, which it folds at pi."""
        if self.moves:
            self.ground.linear_velocity = base_velocity(self.scene, start, step, self.ground.position.x), 0.0
        self.world.step(step, SUB_STEPS)
        for number, body in enumerate(self.boxes):
            self.turns[number] += math.remainder(body.angle - self.turns[number], math.tau)

    def poses(self) -> list[Pose]:
        """Return position and angle of each box."""
        return [(body.position.x, body.position.y, turn) for body, turn in zip(self.boxes, self.turns, strict=True)]


class Box2D(ExternalProgram):
    """Box2D with settings chosen for accuracy."""

    program = "Box2D v3 (pyb2d3)"
    package = "pyb2d3"
    recipe = RECIPE
    model = "boxes in the plane; soft contact, relaxed in every sub-step; single precision"
    default = False
    settings = (
        f"step 1/960 s in {SUB_STEPS} sub-steps; contact of a quarter of their rate, "
        "restitution at every speed, no sleeping"
    )

    def solve(self, scene: Scene) -> dict[str, Array]:
        """Return the columns of a scene.

        Raises
        ------
        NotImplementedError
            Box2D is not installed, or the scene has what it cannot express.
        """
        world = World(scene, default=self.default)
        own_step = USUAL_STEP if self.default else STEP
        return record(scene, own_step, world.advance, world.poses)


class AsItComes(Box2D):
    """Box2D with every setting at its default, at the step and the sub-steps of its documentation."""

    default = True
    settings = "step 1/60 s in 4 sub-steps; contact of 30 Hz, no restitution below 1 m/s, sleeping allowed"
