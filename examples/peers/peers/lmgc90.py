"""LMGC90 as a solver of rigid boxes: polyhedra by the Moreau-Jean scheme, through `compas_lmgc90`.

That package is LMGC90 in one module, `_lmgc90`, which exposes a part of it: materials, contact laws, polyhedra, driven
velocities and forces, a step. Boxes move in x and z; their velocity across the plane and their other two rotations are
driven to zero, which keeps the motion plane. Rotations are those about principal axes; the depth of the boxes is twice
their largest side, with the mass of 1 m, so that the axis across the plane is always one of these. There is no initial
velocity and no gravity but 9.81 m/s2 downwards: both are forces here, the former in one more step before the first, in
which a box gets its momentum.

Contact is sought once, in the first step, between faces that are parallel and within the distance `alert`; its points
then move with both bodies, half with each. Boxes that start tilted, slide far or turn over are refused for this reason.
"""

import math

import numpy as np

from peers.boxes import on_endless_ground, record, substeps
from peers.packages import imported
from peers.programs import ExternalProgram

PACKAGE = "compas_lmgc90"
RECIPE = "pip install compas==2.15.1 && pip install --no-deps compas_lmgc90==0.1.11"
DEFAULT_STEP = 1e-2  # s: dt of compas_lmgc90.Solver
DEFAULT_ALERT = 1e-3  # m: of its contact_law
THETA = 0.5  # its default, the midpoint rule
GRAVITY = 9.81  # m/s2, fixed in the wrapper
DEEP = 2.0  # depth of all boxes over their largest side
POINTS = 4  # of the contact of two rectangles
FOREVER = 1e6  # s
TRIANGLES = (1, 3, 4, 1, 4, 2, 5, 6, 8, 5, 8, 7, 1, 2, 6, 1, 6, 5, 2, 4, 8, 2, 8, 6, 4, 3, 7, 4, 7, 8, 3, 1, 5, 3, 5, 7)
LAW = "iqsc0"  # name of a law that set_see_tables expects


class LMGC90(ExternalProgram):
    """LMGC90 at a step and a distance of detection chosen for accuracy."""

    program = "LMGC90 (compas_lmgc90)"
    package = PACKAGE
    recipe = RECIPE
    model = "polyhedra kept in a plane; IQS_CLB, with restitution RST_CLB, with stiffness ELASTIC_REPELL_CLB"
    own_step = 1e-3  # s
    settings = "theta = 1/2 at 1 ms; contact is sought within twice the lift of the boxes and their size"

    def solve(self, scene):
        """Return the columns of a scene of rigid boxes.

        Raises
        ------
        NotImplementedError
            The scene is not what this part of LMGC90 can express, or compas_lmgc90 is not installed.
        """
        pile = on_endless_ground(scene)
        refuse(pile)
        alert = self.alert(pile)
        program = imported("compas_lmgc90._lmgc90", "LMGC90", RECIPE)
        model = Model(program.LMGC90Solver, pile, scene.time.step / substeps(scene, self.own_step), alert)
        try:
            return record(scene, self.own_step, model.advance, model.poses, model.forces)
        finally:
            model.solver.finalize()

    def alert(self, pile):
        """Return the distance within which contact is sought [m]."""
        return max(2 * box.lift + max(box.width, box.height) for box in pile.boxes)


class AsItComes(LMGC90):
    """LMGC90 with the defaults of compas_lmgc90."""

    own_step = DEFAULT_STEP
    settings = "theta = 1/2 at 10 ms, contact is sought within 1 mm: the defaults of compas_lmgc90.Solver"

    def alert(self, pile):
        """Return the distance within which contact is sought [m]."""
        far = max(box.lift for box in pile.boxes)
        if far > DEFAULT_ALERT:
            why = "as it comes, contact is sought in the first step within 1 mm, and what is further up falls through"
            raise NotImplementedError(f"plane.block.at: {why}, got {far:g} m")
        return DEFAULT_ALERT


def refuse(pile):
    """Refuse what this part of LMGC90 cannot express."""
    tilted = [math.degrees(box.angle) for box in pile.boxes if box.angle]
    if tilted:
        why = "compas_lmgc90 seeks contact between parallel faces only, and a tilted box falls through the ground"
        raise NotImplementedError(f"plane.block.turned: {why}, got {tilted[0]:g} deg")
    lifted = [box.lift for box in pile.boxes if box.lift]
    if lifted and pile.stiffness is None:
        # 0.314 of the impulse again in the step after, where the contact is still closed then: what comes back follows
        # where in a step a box lands, and says nothing of LMGC90's own law.
        why = "through compas_lmgc90 a landing can have a second impulse a step later, and e is not what is set"
        raise NotImplementedError(f"plane.block.at: {why}, got {lifted[0]:g} m")


def contact_law(pile):
    """Return the name of the contact law, and its parameters."""
    if pile.stiffness is not None:
        return "ELASTIC_REPELL_CLB", [pile.stiffness / POINTS, pile.friction_coefficient]
    if pile.rebound:
        return "RST_CLB", [pile.rebound, 0.0, pile.friction_coefficient]  # normal, tangential, friction
    return "IQS_CLB", [pile.friction_coefficient]


class Model:
    """LMGC90's model of a scene; the ground is its first body.

    Parameters
    ----------
    program
        Class of LMGC90 in the wrapper.
    pile
        The boxes.
    step
        Of LMGC90 [s].
    alert
        Distance within which contact is sought [m].
    """

    def __init__(self, program, pile, step, alert):
        self.solver = program()
        self.pile = pile
        self.step = step
        # Rotations are those about the principal axes of a box, whose order LMGC90 tells once it has the boxes.
        self.axes = [np.eye(3)] * len(pile.boxes)
        self.axes = self.build(alert)
        if any(box.spin for box in pile.boxes):
            self.solver.finalize()  # there is one simulation in a process
            self.solver = program()
            self.axes = self.build(alert)
        self.angles = np.zeros(len(pile.boxes))
        self.touched = [False] * len(pile.boxes)  # whether a box was ever borne
        self.result = self.solver.compute_one_step()  # in which boxes get their momentum

    def build(self, alert):
        """Give LMGC90 the scene; return the principal axes of the boxes, a row an axis."""
        solver = self.solver
        pile = self.pile
        solver.initialize(self.step, THETA, False)
        solver.add_one_tact_behav(LAW, *contact_law(pile))
        self.depth = DEEP * max(max(box.width, box.height) for box in pile.boxes)
        densities = sorted({box.density / self.depth for box in pile.boxes})
        self.materials = {density: f"s{number:04d}" for number, density in enumerate(densities, start=1)}
        solver.set_materials(densities)
        solver.set_see_tables(alert)
        solver.set_nb_bodies(1 + len(pile.boxes))
        self.ground_centre = 0.0
        self.add_ground()
        for number, (box, start) in enumerate(zip(pile.boxes, pile.starts, strict=True), start=2):
            self.add_box(number, box, start)
        solver.close_before_computing()
        frames = solver.get_initial_state().body_frames[1:]
        return [np.array(frame).reshape(3, 3) for frame in frames]

    def add_ground(self):
        """Add a slab whose velocity is driven, wide enough for all boxes."""
        left = min(box.x - box.width for box in self.pile.boxes)
        right = max(box.x + box.width for box in self.pile.boxes)
        height = self.pile.boxes[0].height
        vertices, faces = cuboid(right - left, 2 * self.depth, height)
        density = self.pile.boxes[0].density / self.depth
        self.ground_centre = (left + right) / 2
        centre = [self.ground_centre, 0.0, -height / 2]
        self.solver.set_one_polyr(self.materials[density], centre, faces, vertices, 6, 0)
        rate = 2 * math.pi * self.pile.base_frequency
        # A driven velocity is (v0 + v1 cos(v2 t + v3)) min(1, v4 + v5 t); t = 0 of the scene is the end of a step.
        along = [0.0, self.pile.base_amplitude * rate, rate, -math.pi / 2 - rate * self.step, 1.0, 0.0]
        for freedom in range(1, 7):
            self.solver.set_drvdof(1, freedom, along if freedom == 1 else [0.0] * 6, True, False)

    def add_box(self, number, box, start):
        """Add a box where a step with its velocities leads to its start."""
        back = self.step * THETA  # this step goes from rest to the velocity
        x = start[0] - back * box.velocity[0]
        z = start[1] - back * box.velocity[1]
        vertices, faces = cuboid(box.width, self.depth, box.height, -back * box.spin)
        material = self.materials[box.density / self.depth]
        axes = self.axes[number - 2]
        across = int(np.argmax(np.abs(axes[:, 1])))  # the principal axis along y
        rotation = 4 + across
        leaving = [2, *(freedom for freedom in (4, 5, 6) if freedom != rotation)]
        self.solver.set_one_polyr(material, [x, 0.0, z], faces, vertices, len(leaving), 3)
        for freedom in leaving:
            self.solver.set_drvdof(number, freedom, [0.0] * 6, True, False)
        pull = self.pile.pull
        # A rotation about y is one from z to x, that is clockwise.
        angular = -box.inertia * box.spin * axes[across, 1]
        momenta = (box.mass * box.velocity[0], box.mass * box.velocity[1], angular)
        weight = box.mass * GRAVITY
        forces = (box.mass * pull[0], box.mass * pull[1] + weight, 0.0)
        for freedom, momentum, force in zip((1, 3, rotation), momenta, forces, strict=True):
            balanced = momentum / self.step + (weight if freedom == 3 else 0.0)
            # Of a step it is (1 - theta) times the force at its start and theta times that at its end.
            first = (balanced - THETA * force) / (1 - THETA)
            instants = [0.0, self.step, FOREVER]
            self.solver.set_drvdof(number, freedom, [*instants, first, force, force], False, True)

    def advance(self, time, step):
        """Make a step."""
        self.result = self.solver.compute_one_step()
        for bodies, local in zip(self.result.interaction_bodies, self.result.interaction_rloc, strict=True):
            self.touched[max(bodies) - 2] |= local[1] > 0

    def poses(self):
        """Return x, y and angle of each box.

        Raises
        ------
        NotImplementedError
            A box slid or turned so far that the points of its contact are no longer right.
        """
        poses = []
        offset_below = self.result.bodies[0][0] - self.ground_centre
        for number, box in enumerate(self.pile.boxes):
            x, _, z = self.result.bodies[number + 1]
            frame = np.array(self.result.body_frames[number + 1]).reshape(3, 3)
            rotation = frame.T @ self.axes[number]
            angle = math.atan2(rotation[2, 0], rotation[0, 0]) - THETA * self.step * box.spin
            # The nearest to the last one of the angles that differ by full turns.
            angle += 2 * math.pi * round((self.angles[number] - angle) / (2 * math.pi))
            self.angles[number] = angle
            # What slides is the corner that the box turns about.
            side = -1.0 if angle > 0 else 1.0
            corner = (side * box.width / 2, -box.height / 2)
            pivot = x + corner[0] * math.cos(angle) - corner[1] * math.sin(angle)
            offset = pivot - box.x - corner[0]
            if self.touched[number]:
                self.refuse_far(number, abs(offset - offset_below), abs(angle))
            offset_below = offset
            poses.append((x, z, angle))
        return poses

    def refuse_far(self, number, slip, angle):
        """Refuse what the points of a contact do not follow.

        They move by half the slip s. Friction mu N at the base of what stands there, of height H and width w, puts the
        normal force mu H/2 off the middle; it is within the points as long as s/2 + mu H/2 < w/2.
        """
        box = self.pile.boxes[number]
        height = sum(above.height for above in self.pile.boxes[number:])
        reach = max(box.width / 4, box.width - self.pile.friction_coefficient * height)
        why = "compas_lmgc90 seeks contact in the first step only, and its points do not follow"
        if slip > reach:
            raise NotImplementedError(f"{why} box {number + 1}, which slides by more than {reach:g} m")
        if angle > math.pi / 2:
            raise NotImplementedError(f"{why} box {number + 1}, which turns over")

    def forces(self):
        """Return the normal force below each box."""
        forces = [0.0] * len(self.pile.boxes)
        for bodies, local in zip(self.result.interaction_bodies, self.result.interaction_rloc, strict=True):
            forces[max(bodies) - 2] += local[1]
        return forces


def cuboid(width, depth, height, angle=0.0):
    """Return the vertices of a box about its centre, turned from x to z, and its triangles counted from 1."""
    signs = [(x, y, z) for z in (-1, 1) for y in (-1, 1) for x in (-1, 1)]
    corners = np.array(signs) * (width / 2, depth / 2, height / 2)
    cosine = math.cos(angle)
    sine = math.sin(angle)
    rotation = np.array([[cosine, 0.0, -sine], [0.0, 1.0, 0.0], [sine, 0.0, cosine]])
    return (corners @ rotation.T).ravel().tolist(), list(TRIANGLES)
