"""Exudyn as a solver of rigid boxes: planar rigid bodies, their corners on triangles by penalty contact.

Exudyn has no contact of a corner with a plane. Nearest to it is `ObjectContactSphereTriangle`: a sphere of radius r
at the corner, on a triangle that lies r below the face. Its gap is then the height of the corner, whatever the tilt of
the box; the friction acts r below the corner, which errs by r in its arm. Two boxes touch by the corners of each on the
face of the other. A ground that moves is at rest in its own frame, in which a box of mass m bears the load -m A''(t).
"""

import math

import numpy as np

from peers.boxes import corners_of, named, on_endless_ground, substeps
from peers.packages import imported
from peers.programs import ExternalProgram

PACKAGE = "exudyn"
RECIPE = "pip install exudyn==1.13.6"
DEFAULT_STEP = 0.01  # s: endTime 1 in numberOfSteps 100, the defaults of its TimeIntegrationSettings
EARTH = 9.81  # m/s2
SINKS = 1e-3  # of its height that a box sinks by its weight on Earth, where nothing else gives a stiffness
ARM = 1e-3  # least radius of a corner's sphere over the height of its box
DEEP = 2.0  # radius over the deepest penetration
BEYOND = 1e-3  # of its width that a face goes beyond its corners, so that boxes of equal width stand on these
WIDE = 1e4  # half the width of the ground over the size of a box
EARLY = 1e-9  # of the interval of rows: rounding of Exudyn's sum of steps


class Exudyn(ExternalProgram):
    """Exudyn with a contact stiffness, a friction and an integrator chosen for accuracy."""

    program = "Exudyn"
    package = PACKAGE
    recipe = RECIPE
    model = "planar rigid bodies; spheres at their corners on triangles: penalty contact, impact model 2"
    own_step = 5e-5  # s
    angle = 0.05  # rad of the vibration of a box on its contact in such a step
    friction_zone: float | None = 1e-6  # m/s of slip below which friction is proportional to it
    settings = (
        "trapezoidal rule (spectral radius 1) at 0.05 ms; boxes on their contacts at 1000 rad/s, its square as 1/step; "
        "friction proportional to slip below 1e-6 m/s; no recommended step sizes, tolerances in units of the weight"
    )

    def solve(self, scene):
        """Return the columns of a scene of rigid boxes.

        Raises
        ------
        NotImplementedError
            The scene is of something else, or Exudyn is not installed.
        """
        pile = on_endless_ground(scene)
        imported("exudyn.itemInterface", "Exudyn", RECIPE)
        exudyn = imported("exudyn", "Exudyn", RECIPE)
        exudyn.config.printToConsole = False
        steps = substeps(scene, self.own_step)
        model = Model(exudyn, pile, self.stiffness(pile, scene.time.step / steps), self.friction_zone)
        settings = exudyn.SimulationSettings()
        settings.solution.file.write = False
        time = settings.timeIntegration
        time.verboseMode = 0
        time.endTime = scene.time.step * scene.time.steps
        time.numberOfSteps = steps * scene.time.steps
        self.choose(time, pile)
        rows = model.rows(settings, scene.time.step * np.arange(1.0, scene.time.steps + 1))
        return named(scene, rows, time.numberOfSteps)

    def stiffness(self, pile, step):
        """Return the stiffness of the contact below each box, where the scene gives none [N/m].

        An impact errs by about the square of the angle of its vibration in a step, (w h)^2, and a box sinks by g / w^2:
        both fall with the step where w^2 is proportional to 1 / h.
        """
        square = (self.angle / self.own_step) ** 2 * self.own_step / step
        return [carried * square for carried in carried_masses(pile)]

    def choose(self, time, pile):
        """Set what differs from Exudyn's defaults in its `TimeIntegrationSettings`."""
        weight = min(box.mass for box in pile.boxes) * acceleration(pile)
        time.generalizedAlpha.spectralRadius = 1.0
        time.newton.absoluteTolerance = 1e-6 * weight
        time.discontinuous.iterationTolerance = 1e-4 * weight
        time.discontinuous.useRecommendedStepSize = False


class AsItComes(Exudyn):
    """Exudyn with every setting that has a default at it."""

    own_step = DEFAULT_STEP
    friction_zone = None
    settings = (
        "generalized alpha, spectral radius 0.9, step 10 ms (endTime 1 in numberOfSteps 100); contact stiffness, which "
        "has no default: a box sinks by 0.1 % of its height under its weight on Earth"
    )

    def stiffness(self, pile, step):
        """Return the stiffness of the contact below each box, where the scene gives none [N/m]."""
        return [carried * EARTH / (SINKS * pile.boxes[0].height) for carried in carried_masses(pile)]

    def choose(self, time, pile):
        """Leave Exudyn's settings as they are."""


def carried_masses(pile):
    """Return the mass that stands on the contact below each box [kg]."""
    masses = [box.mass for box in pile.boxes]
    return [sum(masses[number:]) for number in range(len(masses))]


def fastest(pile):
    """Return the speed with which a corner may hit the ground, if nothing is gained [m/s]."""
    squares = []
    for box in pile.boxes:
        level = not (box.angle or box.spin) and pile.friction_coefficient * box.height < box.width
        if level:
            squares.append(box.velocity[1] ** 2 + 2 * pile.gravity * box.lift)
        else:
            size = math.hypot(box.width, box.height)
            rotating = (box.spin * size / 2) ** 2
            squares.append(math.hypot(*box.velocity) ** 2 + rotating + 2 * pile.gravity * (box.lift + size))
    return math.sqrt(max(squares))


def acceleration(pile):
    """Return gravity, or where there is none what stops the fastest corner within the height of a box [m/s2]."""
    return pile.gravity or fastest(pile) ** 2 / pile.boxes[0].height or 1.0


def corner_law(pile, stiffness, mass):
    """Return Exudyn's parameters of one of two corners, from stiffness [N/m] and mass [kg] of what stands on both.

    A stiffness that the scene gives is that of an elastic spring. Restitution 0 is critical damping of a flat landing,
    and more than that of a corner alone. Between 0 and 1 stands the impact model 2: its restitution depends on no mass.
    """
    law = {"contactStiffness": stiffness / 2, "dynamicFriction": pile.friction_coefficient}
    if pile.stiffness is not None or pile.rebound == 1:
        return law
    if pile.rebound == 0:
        return law | {"contactDamping": math.sqrt(stiffness * mass)}
    return law | {"impactModel": 2, "restitutionCoefficient": pile.rebound}


class Model:
    """The multibody system of a scene.

    Parameters
    ----------
    exudyn
        The program.
    pile
        The boxes.
    stiffness
        Of the contact below each box, where the scene gives none [N/m].
    friction_zone
        Slip below which friction is proportional to it [m/s]; None is Exudyn's own.
    """

    def __init__(self, exudyn, pile, stiffness, friction_zone):
        self.exudyn = exudyn
        self.items = exudyn.itemInterface
        self.pile = pile
        self.container = exudyn.SystemContainer()
        self.system = self.container.AddSystem()
        carried = carried_masses(pile)
        if pile.stiffness is not None:
            stiffness = [pile.stiffness] * len(carried)
        softest = min(k / mass for k, mass in zip(stiffness, carried, strict=True))
        deepest = fastest(pile) / math.sqrt(softest) + pile.gravity / softest
        self.radius = max(ARM * min(box.height for box in pile.boxes), DEEP * deepest)
        laws = [corner_law(pile, k, mass) for k, mass in zip(stiffness, carried, strict=True)]
        if friction_zone is not None:
            laws = [{**law, "frictionProportionalZone": friction_zone} for law in laws]
        self.nodes = []
        self.bodies = []
        for box, start in zip(pile.boxes, pile.starts, strict=True):
            self.add_box(box, start)
        ground = self.system.AddObject(self.items.ObjectGround())
        size = max(math.hypot(box.width, box.height) for box in pile.boxes)
        on_ground = self.touch(self.bodies[0], corners_of(pile.boxes[0]), ground, (0.0, 1.0), WIDE * size, laws[0])
        self.contacts = [on_ground]  # of each box with what is below it
        for number, box in enumerate(pile.boxes[1:], start=1):
            lower = pile.boxes[number - 1]
            upper_body = self.bodies[number]
            lower_body = self.bodies[number - 1]
            top = (lower.height / 2, 1.0)
            bottom = (-box.height / 2, -1.0)
            on_lower = self.touch(upper_body, corners_of(box)[:2], lower_body, top, lower.width / 2, laws[number])
            on_upper = self.touch(lower_body, corners_of(lower)[2:], upper_body, bottom, box.width / 2, laws[number])
            self.contacts.append(on_lower + on_upper)
        self.system.Assemble()

    def add_box(self, box, start):
        """Add a planar rigid body, its weight, and the inertial load of a ground that moves."""
        items = self.items
        initial = [*box.velocity, box.spin]
        node = self.system.AddNode(items.NodeRigidBody2D(referenceCoordinates=list(start), initialVelocities=initial))
        body = self.system.AddObject(items.ObjectRigidBody2D(mass=box.mass, inertia=box.inertia, nodeNumber=node))
        marker = self.system.AddMarker(items.MarkerBodyMass(bodyNumber=body))
        pull = [*self.pile.pull, 0.0]
        load = items.LoadMassProportional(markerNumber=marker, loadVector=pull)
        if self.pile.base_amplitude:
            rate = 2 * math.pi * self.pile.base_frequency
            peak = self.pile.base_amplitude * rate**2
            load.loadVectorUserFunction = lambda system, time, vector: [
                pull[0] - peak * math.cos(rate * time),
                pull[1],
                0.0,
            ]
        self.system.AddLoad(load)
        self.nodes.append(node)
        self.bodies.append(body)

    def touch(
        self,
        body,
        points,
        other,
        face,
        half_width,
        law,
    ):
        """Add contact of corners of one body with a face of another; the face has a level and an outward direction."""
        items = self.items
        level, outward = face
        depth = level - outward * self.radius
        reach = half_width * (1 + 2 * BEYOND)
        # Bodies stay in the plane z = 0, in which this triangle is the line from -reach to reach.
        triangle = [[-reach, depth, 0.0], [reach, depth, outward * reach], [reach, depth, -outward * reach]]
        face_marker = self.system.AddMarker(items.MarkerBodyRigid(bodyNumber=other))
        contacts = []
        for x, y in points:
            corner_marker = self.system.AddMarker(items.MarkerBodyRigid(bodyNumber=body, localPosition=[x, y, 0.0]))
            # The state of a contact that is open: its gap, slip and impact velocity.
            state = items.NodeGenericData(initialCoordinates=[reach, 0.0, 0.0, 0.0], numberOfDataCoordinates=4)
            contact = items.ObjectContactSphereTriangle(
                markerNumbers=[corner_marker, face_marker],
                nodeNumber=self.system.AddNode(state),
                trianglePoints=self.exudyn.Vector3DList(triangle),
                includeEdges=0,
                sphereRadius=self.radius,
                **law,
            )
            contacts.append(self.system.AddObject(contact))
        return contacts

    def rows(self, settings, instants):
        """Run and return x, y, angle and normal force of each box at instants, shape (instants, boxes, 4).

        Exudyn shortens steps where contact switches, so that its own instants are others: positions between them are
        those of the cubic that has positions and velocities of both ends. Rows after a failure are NaN.
        """
        output = self.exudyn.OutputVariableType
        rows = np.full((len(instants), len(self.nodes), 4), np.nan)
        done = 0
        previous = self.state(0.0)

        def after_step(system, time):
            nonlocal done, previous
            # Rows at the end of a step, but for rounding, are that state itself.
            state = self.state(time)
            while done < len(instants) and instants[done] <= time + EARLY * instants[0]:
                rows[done, :, :3] = between(previous, state, float(instants[done]))
                for number, contacts in enumerate(self.contacts):
                    forces = [system.GetObjectOutput(contact, output.Force)[1] for contact in contacts]
                    rows[done, number, 3] = np.abs(forces).sum()
                done += 1
            previous = state
            return True

        self.system.SetPostStepUserFunction(after_step)
        try:
            self.system.SolveDynamic(settings, showHints=False)
        except (SystemError, RuntimeError, ValueError):
            rows[done:] = np.nan
        for row, instant in enumerate(instants):
            rows[row, :, 0] += self.pile.base(float(instant))[0]
        return rows

    def state(self, time):
        """Return time, positions and velocities of the boxes, shape (boxes, 3)."""
        data = self.system.systemData
        reference = data.GetODE2Coordinates(self.exudyn.ConfigurationType.Reference)
        shape = (len(self.nodes), 3)
        return time, (data.GetODE2Coordinates() + reference).reshape(shape), data.GetODE2Coordinates_t().reshape(shape)


def between(first, last, time):
    """Return positions at an instant, from positions and velocities at two instants."""
    start, x0, v0 = first
    end, x1, v1 = last
    step = end - start
    s = min(1.0, (time - start) / step)
    h00 = (1 + 2 * s) * (1 - s) ** 2
    h01 = s * s * (3 - 2 * s)
    return np.asarray(h00 * x0 + h01 * x1 + step * (s * (1 - s) ** 2 * v0 - s * s * (1 - s) * v1))
