"""Box2D v3 as a solver of rigid polygons: soft contact in sub-steps, in the plane, in single precision."""

import math

from peers.bodies import bodies_of, friction_between, refuse_springs
from peers.boxes import base_velocity, record, substeps
from peers.packages import imported
from peers.programs import ExternalProgram
from validation.models.plane.tables import PlaneSection

RECIPE = "pip install pyb2d3==0.11.1"
USUAL_STEP = 1 / 60  # s: that of Box2D's documentation of b2World_Step, as are four sub-steps
SUB_STEPS = 4
STEP = 1 / 960  # s
DAMPING_RATIO = 10.0  # as it comes
PUSH_SPEED = 3.0  # m/s, as it comes
CORNERS = 8  # at most, of a polygon of Box2D


class World:
    """Blocks as bodies of Box2D.

    Raises
    ------
    NotImplementedError
        Box2D is not installed, or the scene has what it cannot express.
    """

    def __init__(self, scene, *, default):
        blocks = bodies_of(scene)
        plane = scene.table(PlaneSection)
        refuse_springs(plane, "Box2D's hertz correct overlap, its contacts stop a box dead")
        if plane.pair:
            raise NotImplementedError("friction by pair: Box2D makes that of a pair of its two surfaces' own")
        if any(len(part) > CORNERS for block in blocks for part in block.parts):
            raise NotImplementedError(f"a polygon of more than {CORNERS} corners")
        self.scene = scene
        self.box2d = imported("pyb2d3", "Box2D", RECIPE)
        self.world = self.box2d.World(gravity=plane.gravity)
        self.moves = any(block.motion for block in plane.block)
        self.default = default
        if not default:
            self.world.restitution_threshold = 0.0
            self.world.sleeping_enabled = False
            # The stiffest that Box2D takes: a quarter of the rate of its sub-steps, to which it lowers what is above.
            hertz = SUB_STEPS * substeps(scene, STEP) / scene.time.step / 4
            self.world.set_contact_tuning(hertz, DAMPING_RATIO, PUSH_SPEED)
        restitution = (plane.contact.restitution if plane.contact else None) or 0.0
        material = self.box2d.surface_material(friction=friction_between(scene, 0, 1), restitution=restitution)
        self.boxes = []
        self.turns = []
        for block in blocks:
            place = {"position": block.place, "rotation": self.box2d.make_rot(block.angle)}
            if block.held:
                create = self.world.create_kinematic_body if self.moves else self.world.create_static_body
                body = self.ground = create(**place)
                self.middle = block.place[0]  # of the ground at t = 0 [m]
            else:
                moves = {"linear_velocity": block.velocity, "angular_velocity": block.spin}
                body = self.world.create_dynamic_body(**place, **moves)
                self.boxes.append(body)
                self.turns.append(block.angle)
            for part in block.parts:
                shape = self.box2d.shape_def(density=block.density, material=material)
                body.create_polygon_shape(shape, self.box2d.polygon(part))

    def advance(self, start, step):
        """Make one step of Box2D, and follow the angles, which it folds at pi."""
        if self.moves:
            self.ground.linear_velocity = (
                base_velocity(self.scene, start, step, self.ground.position.x - self.middle),
                0.0,
            )
        self.world.step(step, SUB_STEPS)
        for number, body in enumerate(self.boxes):
            self.turns[number] += math.remainder(body.angle - self.turns[number], math.tau)

    def poses(self):
        """Return position and angle of each block."""
        return [(body.position.x, body.position.y, turn) for body, turn in zip(self.boxes, self.turns, strict=True)]


class Box2D(ExternalProgram):
    """Box2D with settings chosen for accuracy."""

    program = "Box2D v3 (pyb2d3)"
    package = "pyb2d3"
    recipe = RECIPE
    model = "polygons in the plane, convex ones or triangles; soft contact, relaxed in every sub-step; single precision"
    default = False
    settings = (
        f"step 1/960 s in {SUB_STEPS} sub-steps; contact of a quarter of their rate, "
        "restitution at every speed, no sleeping"
    )

    def solve(self, scene):
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
