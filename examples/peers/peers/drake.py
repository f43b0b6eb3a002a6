"""Drake as a solver of rigid boxes: bodies on planar joints over a half-space, with Drake's compliant contact."""

import itertools
import logging
import math

from peers.boxes import boxes_of, on_endless_ground, record, spring_step, substeps
from peers.packages import imported
from peers.programs import ExternalProgram

RECIPE = "pip install drake==1.51.1"
OWN_STEP = 1e-3  # s: MultibodyPlantConfig.time_step before anybody sets it
MODULUS = 1e11  # Pa of the chosen hydroelastic contact; see docs/drake.md for what others gave
STICTION = 1e-6  # m/s: the speed at which the chosen friction is nearly Coulomb's
SPRING_SHARE = 0.25  # of the step that resolves a given stiffness: Drake is of the first order, and loses energy
BASE_CORNERS = 4  # of a box of 1 m depth
RESOLUTION = 0.5  # m: no box needs one, but Drake asks for it


def program():
    """Import Drake.

    Raises
    ------
    NotImplementedError
        It is not installed.
    """
    drake = imported("pydrake.all", "Drake", RECIPE)
    # It warns that a rigid half-space touches no deformable body, of which there is none.
    logging.getLogger("drake").setLevel(logging.ERROR)
    return drake


class World:
    """A scene in Drake, in the frame of its ground.

    A ground that moves along itself acts as a force on every box, minus mass times acceleration. Over a step that is
    the change of the ground's velocity, so that the positions are those that a moved ground would give.
    """

    def __init__(self, scene, own_step, *, chosen):
        self.drake = program()
        self.boxes = on_endless_ground(scene)
        self.chosen = chosen
        config = self.drake.MultibodyPlantConfig()
        config.time_step = scene.time.step / substeps(scene, own_step)
        if chosen:
            config.stiction_tolerance = STICTION
        builder = self.drake.DiagramBuilder()
        self.plant, _ = self.drake.AddMultibodyPlant(config, builder)
        self.plant.mutable_gravity_field().set_gravity_vector([*self.boxes.pull, 0.0])
        self.numbers = {self._ground(): 0}
        self.joints = []
        for number, box in enumerate(self.boxes.boxes, 1):
            self._box(number, box)
        self.plant.Finalize()
        self.diagram = builder.Build()
        self.simulator = self.drake.Simulator(self.diagram)
        self.context = self.plant.GetMyMutableContextFromRoot(self.simulator.get_mutable_context())
        for joint, box, (x, y, angle) in zip(self.joints, self.boxes.boxes, self.boxes.starts, strict=True):
            joint.set_pose(self.context, [x, y], angle)
            joint.set_translational_velocity(self.context, box.velocity)
            joint.set_angular_velocity(self.context, box.spin)
        self.simulator.Initialize()
        self.end = 0.0
        self.base_velocity = 0.0

    def _ground(self):
        """Add the half-space; return its number of Drake's."""
        stiffness = self.boxes.stiffness
        if self.chosen and stiffness is not None:
            stiffness = stiffness / BASE_CORNERS
        properties = self._material(stiffness)
        if self.chosen and stiffness is None:
            self.drake.AddRigidHydroelasticProperties(properties)
        pose = self.drake.HalfSpace.MakePose([0.0, 1.0, 0.0], [0.0, 0.0, 0.0])
        half_space = self.drake.HalfSpace()
        return self.plant.RegisterCollisionGeometry(self.plant.world_body(), pose, half_space, "ground", properties)

    def _box(self, number, box):
        """Add a box that moves in the plane."""
        inertia = self.drake.SpatialInertia.SolidBoxWithMass(box.mass, box.width, box.height, 1.0)
        body = self.plant.AddRigidBody(f"box_{number}", inertia)
        for name, pose, shape, properties in self._shapes(box):
            identity = self.plant.RegisterCollisionGeometry(body, pose, shape, f"box_{number}{name}", properties)
            self.numbers[identity] = number
        joint = self.drake.PlanarJoint(f"joint_{number}", self.plant.world_frame(), body.body_frame(), [0.0, 0.0, 0.0])
        self.joints.append(self.plant.AddJoint(joint))

    def _shapes(self, box):
        """Yield name, pose, shape and properties of what touches other bodies."""
        if self.chosen and self.boxes.stiffness is not None:
            # Hydroelastic contact loses stiffness with depth, for the pressure falls towards the sides of a box.
            properties = self._material(self.boxes.stiffness / BASE_CORNERS)
            half_size = box.width / 2, box.height / 2, 0.5
            for signs in itertools.product((-1.0, 1.0), repeat=3):
                corner = [sign * half for sign, half in zip(signs, half_size, strict=True)]
                yield str(signs), self.drake.RigidTransform(corner), self.drake.Sphere(0.0), properties
            return
        properties = self._material(self.boxes.stiffness)
        if self.chosen:
            self.drake.AddCompliantHydroelasticProperties(RESOLUTION, MODULUS, properties)
        yield "", self.drake.RigidTransform(), self.drake.Box(box.width, box.height, 1.0), properties

    def _material(self, stiffness):
        """Return friction, and where the scene asks for them dissipation and stiffness, of one of two bodies.

        The friction of two equal bodies is theirs; their stiffness is half of that of each.
        """
        properties = self.drake.ProximityProperties()
        coefficient = self.boxes.friction_coefficient
        friction = self.drake.CoulombFriction(coefficient, coefficient)
        self.drake.AddContactMaterial(friction=friction, properties=properties)
        if self.boxes.rebound == 1:
            properties.AddProperty("material", "hunt_crossley_dissipation", 0.0)
        if stiffness is not None:
            properties.AddProperty("material", "point_contact_stiffness", 2 * stiffness)
        return properties

    def advance(self, time, step):
        """Make a step."""
        self.end = time + step
        if self.boxes.base_amplitude:
            velocity = (self.boxes.base(self.end)[0] - self.boxes.base(time)[0]) / step
            acceleration = (velocity - self.base_velocity) / step
            self.base_velocity = velocity
            self._push(acceleration)
        # The update of a step is made as soon as its beginning has passed: half a step on, rounding cannot miss it.
        self.simulator.AdvanceTo(time + step / 2)

    def _push(self, acceleration):
        """Apply what an acceleration of the ground is in its own frame."""
        forces = []
        for joint, box in zip(self.joints, self.boxes.boxes, strict=True):
            force = self.drake.ExternallyAppliedSpatialForce()
            force.body_index = joint.child_body().index()
            force.F_Bq_W = self.drake.SpatialForce([0.0, 0.0, 0.0], [-box.mass * acceleration, 0.0, 0.0])
            forces.append(force)
        self.plant.get_applied_spatial_force_input_port().FixValue(self.context, forces)

    def poses(self):
        """Return positions and angles of the boxes."""
        poses = []
        base, _ = self.boxes.base(self.end)
        for joint in self.joints:
            x, y = joint.get_translation(self.context)
            poses.append((float(x) + base, float(y), float(joint.get_rotation(self.context))))
        return poses

    def forces(self):
        """Return the normal force between each box and what is below it, across the upper side of the latter."""
        forces = [0.0] * len(self.joints)
        results = self.plant.get_contact_results_output_port().Eval(self.context)
        for number in range(results.num_point_pair_contacts()):
            contact = results.point_pair_contact_info(number)
            pair = contact.point_pair()
            self._add(forces, pair.id_A, pair.id_B, contact.contact_force())
        for number in range(results.num_hydroelastic_contacts()):
            contact = results.hydroelastic_contact_info(number)
            surface = contact.contact_surface()
            self._add(forces, surface.id_M(), surface.id_N(), contact.F_Ac_W().translational())
        return forces

    def _add(self, forces, first, second, force):
        """Add a force between two bodies, where one stands on the other."""
        lower, upper = sorted((self.numbers[first], self.numbers[second]))
        if upper - lower == 1:
            angle = self.joints[lower - 1].get_rotation(self.context) if lower else 0.0
            forces[lower] += abs(math.cos(angle) * float(force[1]) - math.sin(angle) * float(force[0]))


class Drake(ExternalProgram):
    """Drake with hydroelastic contact over the whole face of a box, and friction that hardly creeps."""

    program = "Drake"
    package = "drake"
    recipe = RECIPE
    model = "bodies on planar joints over a half-space, with compliant contact"
    chosen = True
    step = OWN_STEP
    settings = "step 1 ms; hydroelastic contact of 100 GPa, given stiffness at the corners; stiction tolerance 1e-6 m/s"

    def solve(self, scene):
        """Return the columns of a scene.

        Raises
        ------
        NotImplementedError
            Drake is not installed, or the scene has what it cannot express.
        """
        boxes = boxes_of(scene)
        if 0 < boxes.rebound < 1:
            raise NotImplementedError(
                "plane.contact.restitution: Drake's contact has a dissipation, whose rebound depends on mass and "
                "speed; 0 (its own dissipation) and 1 (none) only"
            )
        if self.chosen and boxes.stiffness is not None and len(boxes.boxes) > 1:
            raise NotImplementedError(
                "plane.contact.stiffness: of a box alone, whose corners have it; corners of others meet edges"
            )
        own_step = self.step
        if self.chosen:
            own_step = min(own_step, SPRING_SHARE * spring_step(scene))
        world = World(scene, own_step, chosen=self.chosen)
        return record(scene, own_step, world.advance, world.poses, world.forces)


class AsItComes(Drake):
    """Drake with every setting as it is."""

    chosen = False
    settings = "all as it comes: step 1 ms, lagged approximation, a point of contact for each pair of bodies"
