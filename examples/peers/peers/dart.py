"""DART as a solver of rigid boxes: free bodies on a long box whose motion is prescribed, DART's own contact."""

import itertools
import math

from peers.boxes import boxes_of, record
from peers.packages import imported
from peers.programs import ExternalProgram
from peers.spatial import Rotation, check_plane

RECIPE = "pip install dartpy==6.20.0"
OWN_STEP = 1e-3  # s: what World.getTimeStep() is before anybody sets it
FINE_STEP = 2.5e-4  # s: the chosen one; see docs/dart.md for what others gave
LEAST_FRICTION = 1e-3  # at and below it DART leaves the friction of a pair away
LEAST_RESTITUTION = 1e-3  # the same of its restitution
GROUND_DEPTH = 10.0  # m: the boxes are 1 m deep


class World:
    """A scene in DART."""

    def __init__(self, scene, *, sleeps):
        self.dart = imported("dartpy", "DART", RECIPE)
        self.boxes = boxes_of(scene)
        self.world = self.dart.simulation.World()
        self.world.setGravity([*self.boxes.pull, 0.0])
        if not sleeps:
            options = self.world.getDeactivationOptions()
            options.mEnabled = False
            self.world.setDeactivationOptions(options)
        # A box and not a plane: on DART's PlaneShape a box gets fewer than four points of contact and turns about them.
        left, right = boxes_of(scene).ends
        self.ground, _ = self._body("ground", (right - left, 1.0, GROUND_DEPTH))
        self._place(self.ground, ((left + right) / 2, -0.5, 0.0), (0.0, 0.0, 0.0))
        # The velocity is prescribed: contact forces do not move it.
        self.ground.setActuatorType(self.dart.dynamics.ActuatorType.VELOCITY)
        self.bodies = []
        self.rotations = []
        for number, (box, start) in enumerate(zip(self.boxes.boxes, self.boxes.starts, strict=True), 1):
            size = box.width, box.height, 1.0
            joint, body = self._body(f"box_{number}", size)
            moments = self.dart.dynamics.BoxShape(size).computeInertiaFromMass(box.mass)
            body.setInertia(self.dart.dynamics.Inertia(box.mass, [0.0, 0.0, 0.0], moments))
            self._place(joint, start, (*box.velocity, box.spin))
            self.bodies.append(body)
            self.rotations.append(Rotation(start[2]))

    def _body(self, name, size):
        """Add a free body of a box's shape; return its joint to the world, and it.

        Friction of a pair is the smaller coefficient of the two bodies, restitution the product of the two.
        """
        skeleton = self.dart.dynamics.Skeleton(name)
        # No PlanarJoint: the third direction would have no inertia, and friction along it makes DART's Dantzig solver
        # return what is no number at every step, so that a fall-back would answer in its place.
        joint, body = skeleton.createFreeJointAndBodyNodePair()
        node = body.createShapeNode(self.dart.dynamics.BoxShape(size))
        node.createCollisionAspect()
        node.createDynamicsAspect()
        surface = node.getDynamicsAspect()
        surface.setFrictionCoeff(self.boxes.friction_coefficient)
        surface.setRestitutionCoeff(math.sqrt(self.boxes.rebound))
        self.world.addSkeleton(skeleton)
        return joint, body

    @staticmethod
    def _place(joint, pose, velocity):
        """Set pose and velocity: a rotation about each axis first, then a translation along each."""
        x, y, angle = pose
        u, v, spin = velocity
        joint.setPositions([0.0, 0.0, angle, x, y, 0.0])
        joint.setVelocities([0.0, 0.0, spin, u, v, 0.0])

    def advance(self, time, step):
        """Make a step, over which the ground moves as far as it is prescribed."""
        if self.boxes.base_amplitude:
            end, _ = self.boxes.base(time + step)
            start, _ = self.boxes.base(time)
            self.ground.setCommands([0.0, 0.0, 0.0, (end - start) / step, 0.0, 0.0])
        self.world.setTimeStep(step)
        self.world.step()

    def poses(self):
        """Return positions and angles of the boxes."""
        poses = []
        for body, rotation in zip(self.bodies, self.rotations, strict=True):
            transform = body.getWorldTransform().matrix()
            check_plane(float(transform[2, 2]))
            angle = rotation.follow(math.atan2(transform[1, 0], transform[0, 0]))
            poses.append((float(transform[0, 3]), float(transform[1, 3]), angle))
        return poses

    def forces(self):
        """Return the normal force between each box and what is below it."""
        names = ["ground", *(f"box_{number}" for number in range(1, len(self.bodies) + 1))]
        forces = dict.fromkeys(itertools.pairwise(names), 0.0)
        for contact in self.world.getLastCollisionResult().getContacts():
            pair = (_skeleton(contact.collisionObject1), _skeleton(contact.collisionObject2))
            normal = abs(float(contact.force @ contact.normal))
            for key in (pair, pair[::-1]):
                if key in forces:
                    forces[key] += normal
        return list(forces.values())


def _skeleton(collision_object):
    """Return the name of the body that a shape of a contact belongs to."""
    return str(collision_object.getShapeFrame().asShapeNode().getBodyNodePtr().getSkeleton().getName())


class Dart(ExternalProgram):
    """DART with a finer step, and bodies that do not sleep."""

    program = "DART"
    package = "dartpy"
    recipe = RECIPE
    model = "free bodies in space on a long box; rigid contact with impulses, Newton's restitution"
    step = FINE_STEP
    sleeps = False
    settings = "step 0.25 ms, no sleeping; else as it comes: FCL, Dantzig's solver of the boxed LCP, no split impulse"

    def solve(self, scene):
        """Return the columns of a scene.

        Raises
        ------
        NotImplementedError
            DART is not installed, or the scene has what it cannot express.
        """
        boxes = boxes_of(scene)
        if boxes.stiffness is not None:
            raise NotImplementedError("plane.contact.stiffness: DART's contact is rigid, a condition on impulses")
        if 0 < boxes.friction_coefficient <= LEAST_FRICTION:
            raise NotImplementedError(f"plane.contact.friction: DART leaves away up to {LEAST_FRICTION:g}")
        if 0 < boxes.rebound <= LEAST_RESTITUTION:
            raise NotImplementedError(f"plane.contact.restitution: DART leaves away one of up to {LEAST_RESTITUTION:g}")
        world = World(scene, sleeps=self.sleeps)
        # A body that sleeps has no contacts, so that DART tells no force.
        forces = None if self.sleeps else world.forces
        return record(scene, self.step, world.advance, world.poses, forces)


class AsItComes(Dart):
    """DART with every setting as it is."""

    step = OWN_STEP
    sleeps = True
    settings = "all as it comes: step 1 ms, boxes that are slow for half a second sleep"
