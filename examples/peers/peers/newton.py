"""Newton as a solver of rigid boxes: free bodies over a plane, by one of Newton's solvers on the processor."""

import atexit
import math
import os
import shutil
import tempfile
from pathlib import Path

import numpy as np

from peers.boxes import boxes_of, on_endless_ground, record, substeps
from peers.packages import imported
from peers.programs import ExternalProgram
from peers.spatial import Rotation, check_plane

RECIPE = "pip install newton==1.8.0 warp-lang==1.19.0"
OWN_STEP = (
    1 / 500
)  # s: 100 frames a second of 5 sub-steps, newton.examples.basic.example_basic_shapes; none is built in
FINE_STEP = 1 / 2000  # s: the chosen one
BASE_CORNERS = 4  # points of contact of a box that lies on a plane
# Of the chosen settings; docs/newton.md has what others gave.
ITERATIONS = 10  # of XPBD
CONTACT_FREQUENCY = 0.3  # (stiffness / mass)^(1/2) of a box times the step; 2 is the limit of semi-implicit Euler
FRICTION_RATE = 0.35  # friction per speed, over mass, times the step; 0.8 is the limit of a box that tilts


def program():
    """Import Newton.

    Raises
    ------
    NotImplementedError
        It is not installed.
    """
    warp = imported("warp", "Newton", RECIPE)
    # It reports every module that it compiles, and that there is no graphics processor.
    warp.config.log_level = warp.LOG_ERROR
    # Nobody differentiates: less to compile, and the same numbers.
    warp.config.enable_backward = False
    if warp.config.kernel_cache_dir is None and not _has_writable_cache():
        folder = tempfile.mkdtemp(prefix="warp-")
        atexit.register(shutil.rmtree, folder, ignore_errors=True)
        warp.config.kernel_cache_dir = folder
    return imported("newton", "Newton", RECIPE)


def _has_writable_cache():
    """Whether warp can write what it compiles where it does so by itself."""
    folder = Path(os.environ.get("WARP_CACHE_PATH") or Path.home() / ".cache" / "warp")
    try:
        folder.mkdir(parents=True, exist_ok=True)
        with tempfile.TemporaryFile(dir=folder):
            return True
    except OSError:
        return False


class World:
    """A scene in Newton, in the frame of its ground.

    A ground that moves along itself turns into gravity: over a step, the change of its velocity.
    """

    def __init__(self, scene, material, solver, settings):
        self.newton = program()
        import warp

        self.warp = warp
        self.boxes = on_endless_ground(scene)
        builder = self.newton.ModelBuilder(up_axis=self.newton.Axis.Y, gravity=(*self.boxes.pull, 0.0))
        # Friction and restitution of a pair are the mean of the two; masses are given with the bodies.
        config = self.newton.ModelBuilder.ShapeConfig(
            mu=self.boxes.friction_coefficient, restitution=self.boxes.rebound, density=0.0, **material
        )
        builder.add_ground_plane(cfg=config)
        self.rotations = []
        for box, (x, y, angle) in zip(self.boxes.boxes, self.boxes.starts, strict=True):
            squares = box.width**2, box.height**2, 1.0
            moments = [box.mass * (sum(squares) - square) / 12 for square in squares]
            place = warp.transform(p=warp.vec3(x, y, 0.0), q=warp.quat_from_axis_angle(warp.vec3(0.0, 0.0, 1.0), angle))
            body = builder.add_body(xform=place, mass=box.mass, inertia=warp.mat33(*np.diag(moments).ravel()))
            builder.add_shape_box(body, hx=box.width / 2, hy=box.height / 2, hz=0.5, cfg=config)
            # Both, for a solver starts from the velocities of bodies or from those of joints.
            velocity = (*box.velocity, 0.0, 0.0, 0.0, box.spin)
            builder.body_qd[body] = velocity
            builder.joint_qd[-6:] = velocity
            self.rotations.append(Rotation(angle))
        self.model = builder.finalize(device="cpu")
        self.solver = getattr(self.newton.solvers, solver)(self.model, **settings)
        self.state = self.model.state()
        self.next_state = self.model.state()
        self.control = self.model.control()
        self.collisions = self.newton.CollisionPipeline(self.model)
        self.contacts = self.collisions.contacts()
        self.steps = 0
        self.graphs = [None, None]
        self.end = 0.0
        self.base_velocity = 0.0

    def advance(self, time, step):
        """Make a step."""
        self.end = time + step
        if self.boxes.base_amplitude:
            velocity = (self.boxes.base(self.end)[0] - self.boxes.base(time)[0]) / step
            along, upwards = self.boxes.pull
            self.model.set_gravity((along - (velocity - self.base_velocity) / step, upwards, 0.0))
            self.solver.notify_model_changed(self.newton.ModelFlags.MODEL_PROPERTIES)
            self.base_velocity = velocity
        # The kernels of a step are recorded once from each of the two states to the other, as in Newton's examples: to
        # launch them singly takes forty times as long. What is recorded is not run; the first two steps compile it.
        direction = self.steps % 2
        if self.steps < 2:
            self._step(step)
        else:
            if self.graphs[direction] is None:
                with self.warp.ScopedCapture(device="cpu") as capture:
                    self._step(step)
                self.graphs[direction] = capture.graph
            self.warp.capture_launch(self.graphs[direction])
        self.state, self.next_state = self.next_state, self.state
        self.steps += 1

    def _step(self, step):
        """Find the contacts and make a step, from one state to the other."""
        self.state.clear_forces()
        self.collisions.collide(self.state, self.contacts)
        self.solver.step(self.state, self.next_state, self.control, self.contacts, step)

    def poses(self):
        """Return positions and angles of the boxes."""
        poses = []
        base, _ = self.boxes.base(self.end)
        for place, rotation in zip(self.state.body_q.numpy(), self.rotations, strict=True):
            x, y, _, i, j, k, w = (float(value) for value in place)
            check_plane(1 - 2 * (i * i + j * j))
            angle = math.atan2(2 * (w * k + i * j), 1 - 2 * (j * j + k * k))
            poses.append((x + base, y, rotation.follow(angle) if math.isfinite(angle) else math.nan))
        return poses


class Newton(ExternalProgram):
    """What all solvers of Newton share."""

    package = "newton"
    recipe = RECIPE
    model = "free bodies in space over a plane, in single precision"
    solver = ""
    step = OWN_STEP

    def check(self, boxes):
        """Refuse what the solver cannot express.

        Raises
        ------
        NotImplementedError
            The scene asks for it.
        """

    def material(self, boxes, step):
        """Return what bodies are made of beside their friction and restitution, by the names of Newton."""
        return {}

    def options(self, boxes):
        """Return the arguments of the solver."""
        return {}

    def solve(self, scene):
        """Return the columns of a scene.

        Raises
        ------
        NotImplementedError
            Newton is not installed, or the scene has what the solver cannot express.
        """
        boxes = boxes_of(scene)
        self.check(boxes)
        material = self.material(boxes, scene.time.step / substeps(scene, self.step))
        world = World(scene, material, self.solver, self.options(boxes))
        return record(scene, self.step, world.advance, world.poses)


class XPBDAsItComes(Newton):
    """SolverXPBD with every setting as it is."""

    program = "Newton, SolverXPBD"
    solver = "SolverXPBD"
    settings = "all as it comes, restitution enabled where a scene has one; 1/500 s as in Newton's example of shapes"

    def check(self, boxes):
        """Refuse a stiffness."""
        if boxes.stiffness is not None:
            raise NotImplementedError(
                "plane.contact.stiffness: XPBD's contact is a condition on positions, and has none"
            )

    def options(self, boxes):
        """Enable restitution, which Newton leaves away otherwise."""
        return {"enable_restitution": True} if boxes.rebound else {}


class SemiImplicitAsItComes(Newton):
    """SolverSemiImplicit with every setting as it is."""

    program = "Newton, SolverSemiImplicit"
    solver = "SolverSemiImplicit"
    settings = "all as it comes: 2.5 kN/m and 100 N s/m a contact point; 1/500 s as in Newton's example of shapes"

    def check(self, boxes):
        """Refuse a restitution that dampers do not have."""
        if 0 < boxes.rebound < 1:
            raise NotImplementedError(
                "plane.contact.restitution: contact is a spring and a damper, whose rebound depends on the mass; "
                "0 (its own damper) and 1 (none) only"
            )

    def material(self, boxes, step):
        """Return the stiffness of a corner, and no damper where nothing is to be lost."""
        material = {}
        if boxes.stiffness is not None:
            material["ke"] = boxes.stiffness / BASE_CORNERS
        if boxes.rebound == 1:
            material["kd"] = 0.0
        return material


class XPBD(XPBDAsItComes):
    """SolverXPBD with more iterations, and without friction of rolling and drilling."""

    step = FINE_STEP
    settings = "step 1/2000 s, ten iterations (two as it comes), no rolling or torsional friction"

    def material(self, boxes, step):
        """Return Coulomb's friction alone."""
        return {"mu_torsional": 0.0, "mu_rolling": 0.0}

    def options(self, boxes):
        """Return more iterations."""
        return {"iterations": ITERATIONS, **super().options(boxes)}


class SemiImplicit(SemiImplicitAsItComes):
    """SolverSemiImplicit with contact as stiff and friction as steep as its step bears."""

    step = FINE_STEP
    settings = "1/2000 s; contact as stiff and friction as steep as the step bears, critical damper, no angular damping"

    def material(self, boxes, step):
        """Return the springs and dampers of a corner, from the mass of the lightest box."""
        mass = min(box.mass for box in boxes.boxes)
        frequency = CONTACT_FREQUENCY / step
        material = {
            "ke": mass * frequency**2 / BASE_CORNERS,
            "kd": 2 * mass * frequency / BASE_CORNERS,
            "kf": FRICTION_RATE * mass / step / BASE_CORNERS,
        }
        if boxes.stiffness is not None:
            material["kd"] = 2 * math.sqrt(mass * boxes.stiffness) / BASE_CORNERS
        return material | super().material(boxes, step)

    def options(self, boxes):
        """Take the damping of rotation away."""
        return {"angular_damping": 0.0}
