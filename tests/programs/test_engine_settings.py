"""What is advised for another program, set there: one body on ground, measured against what the advice says."""

import importlib.util
import json
import math
import shutil
import subprocess
from collections.abc import Callable
from pathlib import Path
from typing import Protocol

import numpy as np
import pytest

from validation.advice.engine_settings import EngineAdvice, Landing, Targets, advise_landing
from validation.advice.engine_table import PROGRAMS
from validation.errors import InputError
from validation.theory.soft_contact import PYBULLET_SLOP

GRAVITY = 9.81
PHASES = (0.037, 0.241, 0.463, 0.689, 0.917)  # of a step, where the body lands
SIZE = 0.25  # half of the box, radius of the ball [m]
SAME_STEPS = 1e-6  # of the arithmetic of a program and of the advice, which solve the same steps in other orders
SOLVED = 2e-4  # of a contact solved to the program's own tolerance over several points
PYBULLET_RESIDUAL = math.sqrt(1e-7)  # m/s, at which its solver ends on several points
SINGLE = 8 * 2.0**-24  # m, of Box2D's coordinates below 1 m, in single precision, over a few sums


def needs(module: str) -> pytest.MarkDecorator:
    """Skip where a program is absent."""
    absent = importlib.util.find_spec(module) is None
    return pytest.mark.skipif(absent, reason=f"NOT RUN: {module} is not installed")


def landing(mass: float, speed: float, *, is_box: bool = False) -> Landing:
    """Return the landing of a ball or a cube."""
    sides = (2 * SIZE, 2 * SIZE) if is_box else None
    return Landing(mass, mass * GRAVITY, speed, None, sides)


def assert_rebounds(advice: EngineAdvice, drop: Callable[[float], float]) -> None:
    """Check that the program rebounds within what is stated, wherever in a step the body lands."""
    assert advice.rebound is not None
    measured = np.array([drop(phase) for phase in PHASES])
    # the stated extremes are of 200 phases, and a phase between two of them lies beyond by a grid's share at most
    margin = (advice.rebound["high"] - advice.rebound["low"]) / 20 + SAME_STEPS
    assert measured.min() > advice.rebound["low"] - margin
    assert measured.max() < advice.rebound["high"] + margin


class Program(Protocol):
    """A body on ground in a program."""

    def step(self) -> tuple[float, float]:
        """Return height of the lowest point above the ground [m] and speed upwards [m/s] after a step."""


# ---- MuJoCo ---------------------------------------------------------------------------------------------------------


class MuJoCo:
    """A ball or a cube on a plane."""

    def __init__(self, advice: EngineAdvice, height: float, speed: float, *, is_box: bool = False) -> None:
        import mujoco

        attributes = " ".join(
            f'{name}="{" ".join(repr(number) for number in advice.settings[name])}"' for name in ("solref", "solimp")
        )
        kind = f'type="box" size="{SIZE} {SIZE} {SIZE}"' if is_box else f'type="sphere" size="{SIZE}"'
        self.mujoco = mujoco
        self.model = mujoco.MjModel.from_xml_string(
            f'<mujoco><option timestep="{advice.step!r}" gravity="0 0 {-GRAVITY}"/><worldbody>'
            f'<geom type="plane" size="5 5 1" {attributes}/><body pos="0 0 {SIZE + height!r}"><freejoint/>'
            f'<geom {kind} mass="{advice.mass!r}" {attributes}/></body></worldbody></mujoco>'
        )
        self.data = mujoco.MjData(self.model)
        self.data.qvel[2] = -speed

    def step(self) -> tuple[float, float]:
        self.mujoco.mj_step(self.model, self.data)
        return float(self.data.qpos[2]) - SIZE, float(self.data.qvel[2])


def largest_drift(program: Program, penetration: float, steps: int) -> float:
    """Return how far a body that was put where it shall rest goes from there, over the penetration."""
    heights = [program.step()[0] for _ in range(steps)]
    return max(abs(height + penetration) for height in heights) / penetration


def steps_of_rest(advice: EngineAdvice) -> int:
    """Return steps in which a wrong depth of rest would show: a few periods, and a few times of creep."""
    zeta = advice.damping_ratio or 0.0
    return math.ceil(4 * (math.pi + 2 * zeta) / advice.omega_step) + 20


def rebound(program: Program, speed: float, level: float = 0.0) -> float:
    """Return the speed with which a body leaves the contact, over that before; 0 if it stays."""
    was_below = has_turned = False
    for _ in range(200_000):
        height, v = program.step()
        was_below |= height < level or v > 0
        has_turned |= was_below and v > 0
        if has_turned and height >= level:
            return v / speed
        if has_turned and v <= 0:
            return 0.0
    raise AssertionError("neither left nor sank back")


MUJOCO = [  # mass, step, penetration, restitution, speed
    (0.37, 1 / 970, 3.3e-4, 0.43, 1.7),
    (13.1, 1 / 520, 2.9e-3, 0.77, 2.3),
    (2900.0, 1 / 1990, 1.3e-5, 0.12, 0.9),
    (310.0, 1 / 61, 9.1e-3, 0.31, 5.3),
    (47.0, 1 / 730, 6.1e-5, 0.95, 3.1),
    (22.0, 1 / 830, 4.1e-4, 1.0, 2.9),
]


@needs("mujoco")
def test_mujoco_hides_no_damping() -> None:
    advice = advise_landing(landing(22.0, 2.9), "mujoco", Targets(4.1e-4, 1.0), step=1 / 830)
    assert advice.hidden == 0.0
    undamped = {**advice.settings, "solref": (-advice.stiffness / advice.mass, 0.0)}
    program = MuJoCo(EngineAdvice("", "", 22.0, 1, 1 / 830, undamped, 0, None, 0), -0.3 * 4.1e-4, 0.0)
    heights = np.array([program.step()[0] for _ in range(4000)])
    early, late = (np.ptp(part) for part in (heights[:400], heights[-400:]))
    assert late == pytest.approx(early, rel=0.01)  # a damping ratio of 1e-5 would take 2 % in 400 radians and more


@needs("mujoco")
@pytest.mark.parametrize("is_box", [False, True])
@pytest.mark.parametrize("numbers", MUJOCO)
def test_mujoco(numbers: tuple[float, ...], is_box: bool) -> None:
    mass, step, penetration, e, speed = numbers
    targets = Targets(penetration, e)
    advice = advise_landing(landing(mass, speed, is_box=is_box), "mujoco", targets, step=step)
    assert advice.penetration == pytest.approx(penetration, rel=1e-9)
    assert advice.rebound["mean"] == pytest.approx(e, abs=5e-3)
    at_rest = MuJoCo(advice, -penetration, 0.0, is_box=is_box)
    assert largest_drift(at_rest, penetration, steps_of_rest(advice)) < SOLVED
    assert_rebounds(advice, lambda x: rebound(MuJoCo(advice, x * speed * step, speed, is_box=is_box), speed))


@needs("mujoco")
def test_mujoco_as_it_comes() -> None:
    import mujoco

    settings = {"solref": (0.02, 1.0), "solimp": (0.9, 0.95, 0.001, 0.5, 2.0)}
    comes = EngineAdvice("", "", 3.7, 1, 0.002, settings, 0, None, 0)
    model = MuJoCo(comes, 0.0, 0.0).model
    plain = mujoco.MjModel.from_xml_string("<mujoco><worldbody><geom size='1'/></worldbody></mujoco>")
    assert plain.opt.timestep == 0.002
    assert np.array_equal(plain.geom_solref[0], model.geom_solref[0])
    assert np.array_equal(plain.geom_solimp[0], model.geom_solimp[0])
    for speed in (1.3, 7.9):
        defaults = advise_landing(landing(3.7, speed), "mujoco", Targets(1e-4)).defaults
        measured = [
            rebound(MuJoCo(comes, x * speed * 0.002, speed), speed) for x in np.linspace(0.05, 0.95, 10).tolist()
        ]
        # ten phases have the mean of rebounds that range over 0.05 to a tenth of that
        assert np.mean(measured) == pytest.approx(defaults["restitution"], abs=0.005)
        depth = defaults["penetration"]
        assert largest_drift(MuJoCo(comes, -depth, 0.0), depth, 500) < SOLVED
    assert defaults["restitution"] > 0.05


@needs("mujoco")
def test_mujoco_takes_another_timeconst_below_two_steps() -> None:
    """What the impedance is raised for: refsafe, at whose edge the advice stays."""
    advice = advise_landing(landing(1.0, 1.0), "mujoco", Targets(1e-6), step=0.002)
    timeconst = advice.settings["solref"][0]
    assert advice.settings["solimp"][0] > 0.95
    assert timeconst == pytest.approx(0.004, rel=1e-6)
    shorter = {**advice.settings, "solref": (timeconst / 2, advice.settings["solref"][1])}
    changed = EngineAdvice("", "", 1.0, 1, 0.002, shorter, 0, None, 0)
    assert largest_drift(MuJoCo(changed, -1e-6, 0.0), 1e-6, 500) < SOLVED


# ---- PyBullet -------------------------------------------------------------------------------------------------------


class PyBullet:
    """A ball or a cube on a large box."""

    def __init__(self, advice: EngineAdvice, height: float, speed: float, *, is_box: bool = False) -> None:
        import pybullet

        self.p = pybullet
        self.client = pybullet.connect(pybullet.DIRECT)
        at = {"physicsClientId": self.client}
        pybullet.setTimeStep(advice.step, **at)
        pybullet.setGravity(0, 0, -GRAVITY, **at)
        ground = pybullet.createCollisionShape(pybullet.GEOM_BOX, halfExtents=[5, 5, 1], **at)
        floor = pybullet.createMultiBody(0, ground, basePosition=[0, 0, -1], **at)
        ball = pybullet.createCollisionShape(pybullet.GEOM_SPHERE, radius=SIZE, **at)
        cube = pybullet.createCollisionShape(pybullet.GEOM_BOX, halfExtents=[SIZE] * 3, **at)
        shape = cube if is_box else ball
        self.body = pybullet.createMultiBody(advice.mass, shape, basePosition=[0, 0, SIZE + height], **at)
        pybullet.changeDynamics(floor, -1, contactStiffness=1e18, contactDamping=0, **at)
        pybullet.changeDynamics(
            self.body,
            -1,
            linearDamping=0,
            angularDamping=0,
            contactStiffness=advice.settings["contact_stiffness"],
            contactDamping=advice.settings["contact_damping"],
            **at,
        )
        pybullet.resetBaseVelocity(self.body, [0, 0, -speed], **at)

    def step(self) -> tuple[float, float]:
        self.p.stepSimulation(physicsClientId=self.client)
        position, _ = self.p.getBasePositionAndOrientation(self.body, physicsClientId=self.client)
        velocity, _ = self.p.getBaseVelocity(self.body, physicsClientId=self.client)
        return position[2] - SIZE, velocity[2]

    def __del__(self) -> None:
        self.p.disconnect(self.client)


PYBULLET = [
    (0.37, 1 / 970, 3.3e-4, 0.43, 1.7),
    (13.1, 1 / 520, 2.9e-3, 0.61, 2.3),
    (2900.0, 1 / 1990, 2.3e-5, 0.12, 0.9),
    (310.0, 1 / 241, 9.1e-3, 0.21, 1.1),
    (47.0, 1 / 1730, 7.3e-3, 0.95, 3.1),
]


@needs("pybullet")
@pytest.mark.parametrize(
    ("numbers", "is_box"),
    [(numbers, is_box) for numbers in PYBULLET for is_box in (False, True)]
    + [((310.0, 1 / 61, 9.1e-3, 0.07, 5.3), True)],  # a ball would pass what PyBullet looks ahead in such a step
)
def test_pybullet(numbers: tuple[float, ...], is_box: bool) -> None:
    mass, step, penetration, e, speed = numbers
    targets = Targets(penetration, e)
    advice = advise_landing(landing(mass, speed, is_box=is_box), "pybullet", targets, step=step)
    assert advice.penetration == pytest.approx(penetration, rel=1e-9)
    assert advice.rebound["mean"] == pytest.approx(e, abs=1e-4)
    at_rest = PyBullet(advice, -penetration, 0.0, is_box=is_box)
    unsolved = PYBULLET_RESIDUAL * step / penetration if is_box else 0.0
    assert largest_drift(at_rest, penetration, steps_of_rest(advice)) < SOLVED + unsolved
    drops = lambda x: PyBullet(advice, x * speed * step - PYBULLET_SLOP, speed, is_box=is_box)  # noqa: E731
    assert_rebounds(advice, lambda x: rebound(drops(x), speed, -PYBULLET_SLOP))


# ---- Box2D ----------------------------------------------------------------------------------------------------------


class Box2D:
    """A circle or a square on a large box."""

    def __init__(self, advice: EngineAdvice, height: float, speed: float, *, is_box: bool = False) -> None:
        import pyb2d3

        self.world = pyb2d3.World(gravity=(0, -GRAVITY))
        self.world.sleeping_enabled = False
        settings = advice.settings
        if "hertz" in settings:
            self.world.set_contact_tuning(settings["hertz"], settings["damping_ratio"], 3.0)
        if "restitution_threshold" in settings:
            self.world.restitution_threshold = settings["restitution_threshold"]
        shape = pyb2d3.shape_def()
        material = shape.material
        material.restitution = settings.get("restitution", 0.0)
        shape.material = material
        self.world.create_static_body(position=(0, -1)).create_polygon_shape(shape, pyb2d3.box(5, 1))
        self.body = self.world.create_dynamic_body(position=(0, SIZE + height), linear_velocity=(0, -speed))
        shape.density = advice.mass / (4 * SIZE**2 if is_box else math.pi * SIZE**2)
        if is_box:
            self.body.create_polygon_shape(shape, pyb2d3.box(SIZE, SIZE))
        else:
            self.body.create_circle_shape(shape, pyb2d3.circle(radius=SIZE))
        self.dt = 4 * advice.step

    def step(self) -> tuple[float, float]:
        self.world.step(self.dt, 4)
        return float(self.body.position[1]) - SIZE, float(self.body.linear_velocity[1])


BOX2D = [  # mass, sub-step, penetration, restitution, speed
    (0.37, 1 / 970, 3.3e-4, 0.43, 1.7),
    (13.1, 1 / 240, 2.9e-3, 0.77, 2.3),
    (2900.0, 1 / 1990, 5.3e-5, 0.05, 0.9),
    (310.0, 1 / 61, 9.1e-3, 0.31, 5.3),
]


@needs("pyb2d3")
@pytest.mark.parametrize("is_box", [False, True])
@pytest.mark.parametrize("numbers", BOX2D)
def test_box2d(numbers: tuple[float, ...], is_box: bool) -> None:
    mass, step, penetration, e, speed = numbers
    targets = Targets(penetration, e)
    advice = advise_landing(landing(mass, speed, is_box=is_box), "box2d", targets, step=step)
    assert advice.penetration == pytest.approx(penetration, rel=1e-9)
    at_rest = Box2D(advice, -penetration, 0.0, is_box=is_box)
    steps = steps_of_rest(advice)
    largest_drift(at_rest, penetration, 3 * steps)  # its corners share the load one after the other, step by step
    assert largest_drift(at_rest, penetration, steps) < SINGLE / penetration
    if is_box:
        assert advice.rebound is None
        return
    for phase in PHASES:
        gap = (1 + phase) * speed * 4 * step
        program = Box2D(advice, gap, speed)
        left = max(program.step()[1] for _ in range(5))
        landed = math.sqrt(speed**2 + 2 * GRAVITY * gap)
        assert advice.rebound["low"] < left / landed < advice.rebound["high"]


@needs("pyb2d3")
def test_box2d_solves_a_contact_at_an_eighth_of_its_substeps() -> None:
    step = 1 / 240
    least = GRAVITY / (2 * math.pi * 2 * 0.125 / step) ** 2
    with pytest.raises(InputError) as refusal:
        advise_landing(landing(1.0, 1.0), "box2d", Targets(0.97 * least), step=step)
    assert refusal.value.field == "--penetration"
    advice = advise_landing(landing(1.0, 1.0), "box2d", Targets(least), step=step)
    assert advice.settings["hertz"] == pytest.approx(30.0)
    twice = EngineAdvice("", "", 1.0, 1, step, {"hertz": 60.0, "damping_ratio": 10.0}, 0, None, 0)
    assert largest_drift(Box2D(twice, -least, 0.0), least, 500) < SINGLE / least


@needs("pyb2d3")
@pytest.mark.parametrize("ratio", [0.1, 10.0])
def test_box2d_returns_nothing_of_its_spring(ratio: float) -> None:
    comes = EngineAdvice("", "", 1.0, 1, 1 / 240, {"hertz": 30.0, "damping_ratio": ratio}, 0, None, 0)
    program = Box2D(comes, 0.3, 2.0)
    assert max(program.step()[1] for _ in range(60)) < 1e-6


@needs("pyb2d3")
def test_box2d_falls_asleep_before_a_slow_contact_is_at_rest() -> None:
    advice = advise_landing(landing(1.0, 0.0), "box2d", Targets(7e-3))
    assert any("sleep" in note for note in advice.notes)
    awake = Box2D(advice, 0.0, 0.0)
    tired = Box2D(advice, 0.0, 0.0)
    tired.world.sleeping_enabled = True
    heights = [[program.step()[0] for _ in range(1200)][-1] for program in (awake, tired)]
    assert heights[0] == pytest.approx(-7e-3, rel=1e-3)
    assert heights[1] > -0.9 * 7e-3


@needs("pyb2d3")
def test_box2d_as_it_comes() -> None:
    import pyb2d3

    comes = pyb2d3.WorldDef()
    assert (comes.contact_hertz, comes.contact_damping_ratio, comes.restitution_threshold) == (30.0, 10.0, 1.0)
    assert pyb2d3.shape_def().material.restitution == 0.0


@needs("pybullet")
def test_pybullet_as_it_comes() -> None:
    """Rigid: it stands at the slop, and does not rebound, by a coefficient of restitution neither."""
    import pybullet

    advice = advise_landing(landing(1.0, 1.0), "pybullet", Targets(1e-3))
    assert advice.defaults["penetration"] == PYBULLET_SLOP
    for coefficient in (0.0, 0.5):
        client = pybullet.connect(pybullet.DIRECT)
        pybullet.setGravity(0, 0, -GRAVITY)
        ground = pybullet.createMultiBody(0, pybullet.createCollisionShape(pybullet.GEOM_PLANE))
        ball = pybullet.createCollisionShape(pybullet.GEOM_SPHERE, radius=0.5)
        body = pybullet.createMultiBody(1.0, ball, basePosition=[0, 0, 0.51])
        for one, value in ((ground, 1.0), (body, coefficient)):
            pybullet.changeDynamics(one, -1, restitution=value)
        pybullet.resetBaseVelocity(body, [0, 0, -1.0])
        speeds = []
        for _ in range(480):
            pybullet.stepSimulation()
            speeds.append(pybullet.getBaseVelocity(body)[0][2])
        height = pybullet.getBasePositionAndOrientation(body)[0][2] - 0.5
        pybullet.disconnect(client)
        assert max(speeds) < 0.05
        assert -height == pytest.approx(PYBULLET_SLOP, rel=1e-3)


@needs("pybullet")
@pytest.mark.parametrize("hidden", [0.003, 0.031, 0.11])
def test_pybullet_hides_no_more_damping_than_asked(hidden: float) -> None:
    advice = advise_landing(landing(7.3, 1.0), "pybullet", Targets(1.7e-3, hidden=hidden), step=None)
    settings = {**advice.settings, "contact_damping": 0.0}
    undamped = EngineAdvice("", "", 7.3, 1, advice.step, settings, 0, None, 0)
    program = PyBullet(undamped, -1.5 * advice.penetration, 0.0)
    assert decay(program, advice.penetration) == pytest.approx(advice.hidden, rel=1e-3)
    assert advice.hidden <= hidden * (1 + 1e-9)


def decay(program: Program, depth: float) -> float:
    """Return the damping ratio of a vibration about a depth, from its positions at the first steps (two roots)."""
    x = np.array([program.step()[0] + depth for _ in range(8)])
    table = np.array([x[1:-1], x[:-2]]).T
    a, b = np.linalg.lstsq(table, x[2:], rcond=None)[0]
    root = np.roots([1.0, -a, -b])[0]
    exponent = np.log(complex(root))
    return float(-exponent.real / abs(exponent))


# ---- OpenSees -------------------------------------------------------------------------------------------------------


class OpenSees:
    """A mass on a spring that pushes only."""

    def __init__(self, advice: EngineAdvice, height: float, speed: float, gravity: float = GRAVITY) -> None:
        import openseespy.opensees as ops

        self.ops = ops
        self.advice = advice
        ops.wipe()
        ops.model("basic", "-ndm", 1, "-ndf", 1)
        for node in range(1, advice.points + 1):  # of the ground
            ops.node(node, 0.0)
            ops.fix(node, 1)
        self.body = advice.points + 1
        ops.node(self.body, 0.0)
        ops.mass(self.body, advice.mass)
        ops.uniaxialMaterial("ElasticPPGap", 1, advice.settings["penalty"], -1e20, -1e-12)
        for node in range(1, advice.points + 1):
            ops.element("zeroLength", node, node, self.body, "-mat", 1, "-dir", 1)
        ops.setNodeDisp(self.body, 1, height, "-commit")
        ops.setNodeVel(self.body, 1, -speed, "-commit")
        ops.timeSeries("Constant", 1)
        ops.pattern("Plain", 1, 1)
        ops.load(self.body, -advice.mass * gravity)
        ops.constraints("Plain")
        ops.numberer("Plain")
        ops.system("BandGeneral")
        ops.test("NormDispIncr", 1e-15, 50)
        ops.algorithm("Newton")
        ops.integrator("Newmark", advice.settings["gamma"], advice.settings["beta"])
        ops.analysis("Transient")

    def step(self) -> tuple[float, float]:
        assert self.ops.analyze(1, self.advice.step) == 0
        return self.ops.nodeDisp(self.body, 1), self.ops.nodeVel(self.body, 1)


OPENSEES = [(0.37, 1 / 970, 3.3e-4, 1.7), (2900.0, 1 / 1990, 1.3e-5, 0.9), (310.0, 1 / 61, 9.1e-3, 5.3)]


@needs("openseespy")
@pytest.mark.parametrize("is_box", [False, True])
@pytest.mark.parametrize("numbers", OPENSEES)
def test_opensees(numbers: tuple[float, ...], is_box: bool) -> None:
    mass, step, penetration, speed = numbers
    advice = advise_landing(landing(mass, speed, is_box=is_box), "opensees", Targets(penetration, 1.0), step=step)
    assert advice.points == (2 if is_box else 1)
    heights = [height for program in [OpenSees(advice, 0.0, 0.0)] for height, _ in (program.step() for _ in range(999))]
    # undamped, it swings from the surface to twice the depth and back, and passes the depth on the average
    assert np.mean(heights) == pytest.approx(-penetration, rel=0.02)
    assert min(heights[-300:]) == pytest.approx(min(heights[:300]), rel=0.01)  # and as far as ever: nothing is hidden
    drop = lambda x: rebound_speed(OpenSees(advice, (1 + x) * speed * step, speed, 0.0), speed)  # noqa: E731
    assert_rebounds(advice, drop)


def rebound_speed(program: Program, speed: float) -> float:
    """Return the speed of a body without weight after its landing."""
    speeds = [program.step()[1] for _ in range(2000)]
    return speeds[-1] / speed


# ---- Yade -----------------------------------------------------------------------------------------------------------

YADE = [  # mass, penetration, restitution, speed
    (0.37, 3.3e-4, 0.43, 1.7),
    (13.1, 2.9e-3, 0.77, 2.3),
    (2900.0, 1.3e-5, 0.12, 0.9),
    (310.0, 9.1e-3, 0.95, 5.3),
]
YADE_SCRIPT = """
from yade import *
import json
runs = json.loads({runs!r})
answers = []
for radius, mass, k, alpha, dt, height, speed, gravity, steps in runs:
    O.reset()
    density = mass / (4 / 3 * 3.141592653589793 * radius**3)
    O.materials.append(FrictMat(young=k / radius, poisson=0.25, density=density))
    O.bodies.append([utils.wall(0.0, axis=2), utils.sphere((0, 0, radius + height), radius)])
    body = O.bodies[1]
    body.state.vel = (0, 0, -speed)
    O.engines = [
        ForceResetter(),
        InsertionSortCollider([Bo1_Sphere_Aabb(), Bo1_Wall_Aabb()], verletDist=0.1),
        InteractionLoop(
            [Ig2_Wall_Sphere_ScGeom()],
            [Ip2_FrictMat_FrictMat_FrictPhys()],
            [Law2_ScGeom_FrictPhys_CundallStrack()],
        ),
        NewtonIntegrator(damping=alpha, gravity=(0, 0, -gravity)),
    ]
    O.dt = dt
    answers.append([])
    for _ in range(steps):
        O.step()
        answers[-1].append((body.state.pos[2] - radius, body.state.vel[2]))
answers.append([NewtonIntegrator().damping, 0.0])
open({out!r}, "w").write(json.dumps(answers))
"""


def yade(runs: list[tuple[float, ...]], folder: Path) -> list[np.ndarray]:
    """Return height and speed after every step of every run, and Yade's default damping."""
    script = folder / "runs.py"
    out = folder / "answers.json"
    script.write_text(YADE_SCRIPT.format(runs=json.dumps(runs), out=str(out)))
    subprocess.run(["yade", "-n", "-x", str(script)], cwd=folder, check=True, capture_output=True, timeout=300)
    return [np.array(answer) for answer in json.loads(out.read_text())]


@pytest.mark.long
@pytest.mark.skipif(shutil.which("yade") is None, reason="NOT RUN: yade is not installed")
def test_yade(tmp_path: Path) -> None:
    advised = [
        advise_landing(landing(mass, speed), "yade", Targets(penetration, e)) for mass, penetration, e, speed in YADE
    ]
    runs = []
    for advice, (mass, _, _, speed) in zip(advised, YADE, strict=True):
        numbers = (SIZE, mass, advice.settings["normal_stiffness"], advice.settings["local_damping"], advice.step)
        swing = math.ceil(2 / (advice.omega_step * max(advice.hidden, 1e-3)))
        runs.append((*numbers, -0.9 * advice.penetration, 0.0, GRAVITY, 10 * swing))
        runs += [(*numbers, x * speed * advice.step, speed, GRAVITY, 400) for x in PHASES]
    *answers, default = yade(runs, tmp_path)
    checked = 0
    assert default[0] == PROGRAMS["yade"].default("local_damping")[0]
    for advice, (_, penetration, _, speed) in zip(advised, YADE, strict=True):
        settled, *landings = [answers.pop(0) for _ in range(1 + len(PHASES))]
        assert -settled[-1, 0] == pytest.approx(penetration, rel=1e-3)
        swings = 1 + settled[:, 0] / penetration
        peaks = swings[1:-1][(swings[1:-1] > swings[:-2]) & (swings[1:-1] > swings[2:]) & (swings[1:-1] > 0.003)]
        alpha = advice.settings["local_damping"]
        if alpha < 0.3:
            cycles = len(peaks) - 1
            decayed = math.log(peaks[0] / peaks[-1]) / (2 * math.pi * cycles)
            # A sampled peak is short by up to (w dt / 2)^2 / 2. The sign of the damping changes four times a cycle,
            # late by up to half a step, in which force or velocity is w dt / 2 of its amplitude.
            W = advice.omega_step
            late = 2 * alpha * W**2
            assert decayed == pytest.approx(advice.hidden, abs=(late + W**2 / 8 / cycles) / (2 * math.pi))
            checked += 1
        histories = dict(zip(PHASES, landings, strict=True))
        assert_rebounds(advice, lambda x, h=histories, v=speed: rebound(Recorded(h[x]), v))
    assert checked >= 1


class Recorded:
    """Steps of a run that is over."""

    def __init__(self, rows: np.ndarray) -> None:
        self.rows = iter(rows)

    def step(self) -> tuple[float, float]:
        height, speed = next(self.rows)
        return float(height), float(speed)
