"""PyBullet as a solver of rigid boxes: sequential impulses in space, on boxes of one metre's depth.

As it comes a box is free in space, and what is read is its motion in the plane. With the chosen settings it moves on
three joints, two that slide and one that turns, which Bullet's multi-bodies keep exactly.
"""

import math

from peers.boxes import base_velocity, boxes_of, correction_rate, record, spring_step, substeps
from peers.packages import imported
from peers.programs import ExternalProgram
from peers.spatial import check_plane

RECIPE = "pip install pybullet==3.2.7"
USUAL_STEP = 1 / 240  # s: Bullet's fixedTimeStep as it comes
STEP = 1 / 960  # s
HALF_DEPTH = 0.5  # m of boxes
THICKNESS = 10.0  # m of the ground, as that of plane.urdf, which is a box too
CARRIER = 1e-9  # mass of a link between two joints, over that of its box
HEAVY = 1e6  # mass of a ground that moves, over that of the boxes
CORNERS = 4  # contact points of a box that lies flat
BASE = -1  # Bullet's number of the link that is a body's base


class World:
    """Boxes and ground as bodies of Bullet, in a server of their own, which ends with them.

    Raises
    ------
    NotImplementedError
        PyBullet is not installed.
    """

    def __init__(self, scene, *, default):
        pile = boxes_of(scene)
        self.scene = scene
        self.default = default
        direct = imported("pybullet", "PyBullet", RECIPE).DIRECT
        self.bullet = imported("pybullet_utils.bullet_client", "PyBullet", RECIPE).BulletClient(direct)
        self.own_step = USUAL_STEP if default else min(STEP, spring_step(scene))
        step = scene.time.step / substeps(scene, self.own_step)
        along, up = pile.pull
        self.bullet.setGravity(along, 0, up)
        self.bullet.setTimeStep(step)
        if not default:
            self.bullet.setPhysicsEngineParameter(
                restitutionVelocityThreshold=0.0,
                contactSlop=0.0,  # 10 micrometres as it comes: over the step, a velocity that a landing loses
                contactERP=step * correction_rate(scene),  # a fifth a step as it comes, however small the step is
            )
        self.ground, self.ground_link = self._ground()
        self.boxes = []
        for box, start in zip(pile.boxes, pile.starts, strict=True):
            body = self._free(box, start) if default else self._planar(box, start)
            self.boxes.append(body)
        self.starts = pile.starts
        self.turns = [start[2] for start in pile.starts]

    def _shape(self, half_width, half_depth, half_height):
        extents = [half_width, half_depth, half_height]
        return self.bullet.createCollisionShape(self.bullet.GEOM_BOX, halfExtents=extents)

    def _linked(self, base, joints, masses, shape):
        """Return a body of links on joints, the last of which has the shape; its base does not move."""
        count = len(joints)
        body = self.bullet.createMultiBody(
            baseMass=0,
            basePosition=base,
            linkMasses=masses,
            linkCollisionShapeIndices=[*[-1] * (count - 1), shape],
            linkVisualShapeIndices=[-1] * count,
            linkPositions=[[0, 0, 0]] * count,
            linkOrientations=[[0, 0, 0, 1]] * count,
            linkInertialFramePositions=[[0, 0, 0]] * count,
            linkInertialFrameOrientations=[[0, 0, 0, 1]] * count,
            linkParentIndices=list(range(count)),
            linkJointTypes=[joint for joint, _ in joints],
            linkJointAxis=[axis for _, axis in joints],
        )
        for joint in range(count):  # which PyBullet gives a motor that holds it
            self.bullet.setJointMotorControl2(body, joint, self.bullet.VELOCITY_CONTROL, force=0)
        return body

    def _ground(self):
        """Return a ground that is a box, and its link; as a multi-body on a joint where it moves."""
        pile = boxes_of(self.scene)
        left, right = boxes_of(self.scene).ends
        shape = self._shape((right - left) / 2, THICKNESS, THICKNESS / 2)
        position = [(left + right) / 2, 0.0, -THICKNESS / 2]
        if pile.base_amplitude:
            mass = HEAVY * sum(box.mass for box in pile.boxes)
            body = self._linked(position, [(self.bullet.JOINT_PRISMATIC, [1, 0, 0])], [mass], shape)
            link = 0
        else:
            body = self.bullet.createMultiBody(0, shape, basePosition=position)
            link = BASE
        self._set(body, link)
        if pile.stiffness is not None:
            # A damping of zero is none; the share of the box's own is set to zero as well.
            self._change(body, link, contactStiffness=pile.stiffness / CORNERS, contactDamping=0.0)
        return body, link

    def _free(self, box, start):
        """Return a box that is free in space."""
        x, y, angle = start
        body = self.bullet.createMultiBody(
            box.mass,
            self._shape(box.width / 2, HALF_DEPTH, box.height / 2),
            basePosition=[x, 0, y],
            baseOrientation=self.bullet.getQuaternionFromEuler([0, -angle, 0]),
        )
        along, up = box.velocity
        self.bullet.resetBaseVelocity(body, [along, 0, up], [0, -box.spin, 0])
        self._set(body, BASE)
        return body

    def _planar(self, box, start):
        """Return a box on joints that leave it the plane."""
        x, y, angle = start
        joints = [
            (self.bullet.JOINT_PRISMATIC, [1, 0, 0]),
            (self.bullet.JOINT_PRISMATIC, [0, 0, 1]),
            (self.bullet.JOINT_REVOLUTE, [0, -1, 0]),
        ]
        masses = [CARRIER * box.mass, CARRIER * box.mass, box.mass]
        shape = self._shape(box.width / 2, HALF_DEPTH, box.height / 2)
        body = self._linked([x, 0, y], joints, masses, shape)
        along, up = box.velocity
        for joint, (value, velocity) in enumerate(((0.0, along), (0.0, up), (angle, box.spin))):
            self.bullet.resetJointState(body, joint, value, velocity)
        self._change(body, BASE, linearDamping=0.0, angularDamping=0.0)
        self._set(body, len(joints) - 1)
        return body

    def _set(self, body, link):
        """Set friction and restitution; a pair has the product of its two coefficients."""
        pile = boxes_of(self.scene)
        restitution = 0.0 if pile.stiffness is not None else pile.rebound  # a spring returns what it took
        self._change(
            body, link, lateralFriction=math.sqrt(pile.friction_coefficient), restitution=math.sqrt(restitution)
        )

    def _change(self, body, link, **values):
        self.bullet.changeDynamics(body, link, **values)

    def advance(self, start, step):
        """Make one step of Bullet, and follow the angles of boxes that are free in space, which are folded at pi."""
        if self.ground_link != BASE:
            position = self.bullet.getJointState(self.ground, 0)[0]
            velocity = base_velocity(self.scene, start, step, position)
            self.bullet.resetJointState(self.ground, 0, position, velocity)
        self.bullet.stepSimulation()
        if self.default:
            for number, (_, _, angle) in enumerate(self._free_poses()):
                self.turns[number] += math.remainder(angle - self.turns[number], math.tau)

    def _free_poses(self):
        poses = []
        for body in self.boxes:
            (x, _, z), orientation = self.bullet.getBasePositionAndOrientation(body)
            matrix = self.bullet.getMatrixFromQuaternion(orientation)
            check_plane(matrix[4])
            poses.append((x, z, math.atan2(matrix[6], matrix[0])))
        return poses

    def poses(self):
        """Return position and angle of each box."""
        if self.default:
            return [(x, y, turn) for (x, y, _), turn in zip(self._free_poses(), self.turns, strict=True)]
        poses = []
        for body, (x, y, _) in zip(self.boxes, self.starts, strict=True):
            along, up, angle = (state[0] for state in self.bullet.getJointStates(body, [0, 1, 2]))
            poses.append((x + along, y + up, angle))
        return poses

    def forces(self):
        """Return the normal force below each box, the mean of the last step [N]."""
        values = []
        below = self.ground
        for body in self.boxes:
            contacts = self.bullet.getContactPoints(body, below) or ()
            values.append(sum(contact[9] for contact in contacts))
            below = body
        return values


class Bullet(ExternalProgram):
    """PyBullet with settings chosen for accuracy."""

    program = "Bullet (PyBullet)"
    package = "pybullet"
    recipe = RECIPE
    default = False
    model = "boxes of 1 m on joints that keep them in the plane, ground a box; contact by sequential impulses"
    settings = (
        "step 1/960 s; no damping, no slop, restitution at every speed, "
        "overlap corrected at 0.2 1/s, of boxes on each other at 20 1/s"
    )

    def solve(self, scene):
        """Return the columns of a scene.

        Raises
        ------
        NotImplementedError
            PyBullet is not installed, or the scene has what it cannot express.
        """
        world = World(scene, default=self.default)
        return record(scene, world.own_step, world.advance, world.poses, world.forces)


class AsItComes(Bullet):
    """PyBullet with every setting at its default, at its own step."""

    default = True
    model = "boxes of 1 m free in space, ground a box; contact by sequential impulses"
    settings = "step 1/240 s; 50 iterations, damping, no restitution below 0.2 m/s, overlap corrected by a fifth"
