"""pymunk as a solver of rigid polygons: Chipmunk's sequential impulses at the velocities, in the plane."""

import math

from peers.bodies import bodies_of, friction_between, refuse_springs
from peers.boxes import base_velocity, record
from peers.packages import imported
from peers.programs import ExternalProgram
from validation.models.plane.tables import PlaneSection

RECIPE = "pip install pymunk==7.3.1"
USUAL_STEP = 1 / 60  # s: of most of its examples, and the one that the default of collision_bias is worked out for
STEP = 1 / 1920  # s
ITERATIONS = 100
SLOP = 1e-5  # m
CORRECTION_RATE = 60.0  # 1/s: overlap beyond the slop decays as exp(-rate t)


class World:
    """Blocks as bodies of pymunk.

    Raises
    ------
    NotImplementedError
        pymunk is not installed, or the scene has what it cannot express.
    """

    def __init__(self, scene, *, default):
        blocks = bodies_of(scene)
        plane = scene.table(PlaneSection)
        refuse_springs(plane, "pymunk's contacts are impulses")
        self.scene = scene
        self.pymunk = imported("pymunk", "pymunk", RECIPE)
        self.space = self.pymunk.Space()
        self.space.gravity = plane.gravity
        if not default:
            self.space.iterations = ITERATIONS
            self.space.collision_slop = SLOP
            self.space.collision_bias = math.exp(-CORRECTION_RATE)
        self.restitution = plane.contact.restitution or 0.0
        self.moves = any(block.motion for block in plane.block)
        self.boxes = []
        for number, block in enumerate(blocks):
            body = self._add(block, number)
            if block.held:
                self.ground = body
                self.middle = block.place[0]  # of the ground at t = 0 [m]
            else:
                self.boxes.append(body)
        for first in range(len(blocks)):
            for second in range(first):
                self._rub(second, first)

    def _add(self, block, number):
        kinds = self.pymunk.Body
        if block.held:
            body = kinds(body_type=kinds.KINEMATIC if self.moves else kinds.STATIC)
        else:
            body = kinds(block.mass, block.inertia)
            body.velocity = block.velocity
            body.angular_velocity = block.spin
        body.position = block.place
        body.angle = block.angle
        self.space.add(body)
        for part in block.parts:
            shape = self.pymunk.Poly(body, part)
            shape.elasticity = math.sqrt(self.restitution)  # a pair has the product of both
            shape.collision_type = number + 1
            self.space.add(shape)
        return body

    def _rub(self, first, second):
        """Give two blocks the friction between them: a shape's own would be multiplied by the other one's."""
        friction = friction_between(self.scene, first, second)

        def before(arbiter, _space, _data):
            arbiter.friction = friction

        self.space.on_collision(first + 1, second + 1, pre_solve=before)

    def advance(self, start, step):
        """Make one step of pymunk."""
        if self.moves:
            self.ground.velocity = base_velocity(self.scene, start, step, self.ground.position.x - self.middle), 0.0
        self.space.step(step)

    def poses(self):
        """Return position and angle of each block."""
        return [(*body.position, body.angle) for body in self.boxes]

    def forces(self):
        """Return the normal force below each box, the mean of the last step [N]."""
        values = []
        below = self.ground
        for body in self.boxes:
            impulses = []
            body.each_arbiter(_add_impulse, below, impulses)
            values.append(sum(impulses) / self.space.current_time_step)
            below = body
        return values


def _add_impulse(arbiter, below, impulses):
    """Note the normal impulse of a contact if it is one with the body below."""
    if below in arbiter.bodies:
        impulses.append(abs(arbiter.total_impulse.dot(arbiter.normal)))


class Pymunk(ExternalProgram):
    """pymunk with settings chosen for accuracy."""

    program = "pymunk (Chipmunk)"
    package = "pymunk"
    recipe = RECIPE
    model = "polygons in the plane, convex ones or triangles; contact by impulses, sequentially, warm-started"
    default = False
    settings = f"step 1/1920 s, {ITERATIONS} iterations, slop 10 micrometres, overlap corrected at 60 1/s"

    def solve(self, scene):
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
