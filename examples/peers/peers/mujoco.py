"""MuJoCo as a solver: masses on tendons that are springs, or rigid boxes on a plane with MuJoCo's own contact.

A block of one strain has the mass matrix m diag(1, 1, 1/3, 1/3, 1/3, 1/3) in its centroid's u, v and in what its edges
move beside it, (a/2) ux, (h/2) uy, (a/2) vx, (h/2) vy: six masses on slide joints. Its strain energy and its corner
springs are springs of fixed tendons, which are linear combinations of joints; the dead band of a tendon's spring makes
one that only pushes, its plasticity one that slips, at a yield that follows the normal force from sub-step to sub-step.
"""

import math

import numpy as np

from peers.blocks import push_of
from peers.mujoco_boxes import boxes
from peers.mujoco_column import column
from peers.mujoco_model import FREE, MOST, RECIPE, March, Network, Spring, model_text, parts, refuse
from peers.programs import ExternalProgram
from validation.scenes import features
from validation.scenes.record import base_record

SLIPS = 1e-30  # m: the yield of a corner that is open; zero would be none
FINE, COARSE, MANY = 0.1, 0.7, 60_000  # w dt of RK4, where more sub-steps than that would follow, and what is many
FINE_SLIP, COARSE_SLIP, MANY_SLIP = 0.005, 0.2, 300_000  # of the leapfrog that friction takes
HEAVY = 1e12  # mass of a base that moves as it is told, over the block's
STEADY = 1e-3  # settlement of a block that turns over its lift by the tilt up to which it and its base are rigid
RIGID = 100.0  # stiffness of a block over that of its springs from which a rigid box may stand for it
OF_CONTACT = {
    features.UNILATERAL,
    features.FRICTION,
    features.SLOPE,
    features.ROTATION,
    features.COLUMN,
    features.PLANE,
    features.MOVING_BLOCKS,
}
GLUE = 100.0  # coefficient of friction of a corner that never slips, of a box
TURNING = 1e-4  # sub-step over (h / g)^(1/2) of a block that turns


def sizes(scene):
    """Return width and height of an upright rectangle on its lower edge [m]; other outlines are refused."""
    size = scene.block.rectangle
    refuse("the block is no upright rectangle on its lower edge, and its mass matrix not diagonal", where=size is None)
    return size or (0.0, 0.0)


def loads(scene):
    """Return forces towards +x and upwards of all loads [N], and how far towards +x the pressure acts [m]."""
    q, (a, _), turn = scene.load, sizes(scene), math.radians(scene.load.slope)
    weight, push = scene.block.mass * q.gravity, push_of(scene)
    return q.traction * a + weight * math.sin(turn), -push - weight * math.cos(turn), -push * q.eccentricity


def block_network(scene):
    """Return a block of one strain on its corner springs; tendons 3, 4 are those across the base, 5, 6 along it."""
    b, c, q, (a, h), m = scene.block, scene.contact, scene.load, sizes(scene), scene.block.mass
    E, mu, area = b.young, b.poisson, a * h
    shear = E / (2 * (1 + mu))
    if b.hypothesis == "plane strain":
        E, mu = E / (1 - mu * mu), mu / (1 - mu)
    sum_of, difference = area * E / (1 - mu) / 2, area * E / (1 + mu) / 2  # energies of ex + ey and of ex - ey, halved
    springs = [
        Spring({"px": 2 / a, "py": 2 / h}, sum_of),
        Spring({"px": 2 / a, "py": -2 / h}, difference),
        Spring({"ty": 2 / h, "tx": 2 / a}, area * shear),
    ]
    masses = {"u": m, "v": m, **dict.fromkeys(("px", "ty", "tx", "py"), m / 3)}
    x, y = ({"bx": -1.0}, {"by": -1.0}) if q.base_motion else ({}, {})
    masses |= dict.fromkeys([*x, *y], HEAVY * m)
    opens = c.law == "unilateral"
    springs += [Spring({"v": 1.0, "tx": s, "py": -1.0, **y}, c.stiffness, -c.gap, not opens) for s in (-1.0, 1.0)]
    if c.shear > 0 and not (opens and upright(scene)):
        springs += [Spring({"u": 1.0, "px": s, "ty": -1.0, **x}, c.shear, slips=opens) for s in (-1.0, 1.0)]
    along, up, turning = loads(scene)
    return Network(
        masses, springs, {}, {"u": along, "v": up, "ty": q.traction * a, "tx": turning * 2 / a, "py": -push_of(scene)}
    )


def upright(scene):
    """Whether nothing moves the corners along the base, so that their springs along it stay relaxed."""
    q, record = scene.load, base_record(scene)
    still = record is None or not record.x.any()
    return still and not (q.eccentricity or q.traction or q.slope or scene.block.poisson)


class Corners:
    """What a drive does before each sub-step: the base moves, and corners slip at the normal force that they get."""

    def __init__(self, scene, network, march, instants):
        self.scene, self.march, self.dt = scene, march, float(instants[1])
        self.tan = None if scene.contact.friction is None else math.tan(math.radians(scene.contact.friction))
        self.held = scene.contact.cohesion * sizes(scene)[0] / 2
        rows = [network.vector(spring.factors) for spring in network.springs[3:5]]
        self.normal = np.array(rows)
        self.slips = any(spring.slips for spring in network.springs)
        record = base_record(scene)
        self.path = None
        if record is not None:
            x, y = (np.interp(instants, record.time, part) for part in (record.x, record.y))
            # springs that never let go are relaxed where the record is zero, others where they touch at t = 0
            self.path = x if scene.contact.law == "locked" else x - x[0], y
            march.data.qpos[6:8] = self.path[0][0], y[0]

    @property
    def needed(self):
        """Whether there is anything to do."""
        return self.slips or self.path is not None

    def __call__(self, number):
        """Do it before a sub-step."""
        data = self.march.data
        if self.path is not None:
            data.qpos[6:8] = [x[number] for x in self.path]
            data.qvel[6:8] = [(x[number + 1] - x[number]) / self.dt for x in self.path]
        if self.slips:
            c = self.scene.contact
            ahead = self.normal @ (data.qpos + self.dt * data.qvel) + c.gap  # at the end, where the yield is asked
            for corner, w in enumerate(ahead.tolist()):
                holds = FREE if self.tan is None else (self.tan * c.stiffness * -w + self.held) / c.shear
                self.march.model.tendon_springyield[5 + corner] = max(holds, SLIPS) if w < 0 else SLIPS


def spring_block(scene, *, default):
    """Return the motion of a block of one strain on its corner springs."""
    network, t, width = block_network(scene), scene.time, sizes(scene)[0]
    slips = any(spring.slips for spring in network.springs)
    rule = (FINE_SLIP, COARSE_SLIP, MANY_SLIP) if slips else (FINE, COARSE, MANY)
    each = 1 if default else parts(network.frequency(), t.step, t.steps, *rule)
    dt = t.step / each
    integrator = "" if default else f'integrator="{"Euler" if slips else "RK4"}"'
    march = March(network.text(f'timestep="{dt!r}" {integrator}'), network)
    corners = Corners(scene, network, march, dt * np.arange(each * t.steps + 1.0))
    march.data.qvel[1] = scene.block.velocity
    if slips and not default:
        march.start_between()

    def report():
        w = march.data.qpos @ corners.normal.T + scene.contact.gap
        pressed = -w if scene.contact.law == "locked" else np.maximum(-w, 0.0)
        u, v, _, ty, tx, _ = march.data.qpos[:6]
        turned = tx / width - ty / sizes(scene)[1]
        return np.array([v, scene.contact.stiffness * pressed.sum() / width, u, turned])

    found = march.rows(t.steps, each, report, corners if corners.needed else None)
    return _named(found)


def rigid_box(scene, *, default):
    """Return the motion of a rigid box on a plane with MuJoCo's own contact."""
    (a, h), b, q, t = sizes(scene), scene.block, scene.load, scene.time
    refuse("a rigid box on a plane has no base that moves", where=q.base_motion is not None)
    refuse("MuJoCo's contact has no cohesion", where=scene.contact.cohesion != 0)
    turn, tilt, dt, options = math.radians(q.slope), math.radians(b.tilt), t.step, ""
    if not default:
        scale = math.sqrt(h / q.gravity) if q.gravity else t.step
        dt = t.step / parts(1 / scale, t.step, t.steps, TURNING, TURNING, MOST)
        options = 'integrator="RK4" cone="elliptic" impratio="100"'
    contact = _rubs(scene, default) + ("" if default else _stiff(dt))
    lowest = (abs(math.sin(tilt)) * a + math.cos(tilt) * h) / 2 + scene.contact.gap
    joints = '<joint type="slide" axis="1 0 0"/><joint type="slide" axis="0 0 1"/><joint type="hinge" axis="0 -1 0"/>'
    box = f'<geom type="box" size="{a / 2!r} 0.5 {h / 2!r}" density="{b.density!r}" {contact}/>'
    world = f'<geom type="plane" size="1 1 1" {contact}/><body pos="0 0 {lowest!r}">{joints}{box}</body>'
    gravity = f"{q.gravity * math.sin(turn)!r} 0 {-q.gravity * math.cos(turn)!r}"
    march = March(model_text(f'timestep="{dt!r}" {options}', world, gravity=gravity))
    push = push_of(scene)
    march.data.qfrc_applied[:] = q.traction * a, -push, -push * q.eccentricity - q.traction * a * h / 2
    march.data.qpos[2], march.data.qvel[1] = tilt, b.velocity

    def report():
        march.look()
        x, z, turned = march.data.qpos
        return np.array([z, march.pressing() / a, x, turned - tilt])

    return _named(march.rows(t.steps, round(t.step / dt), report))


def _named(rows):
    names = ("displacement", "contact_pressure", "horizontal_displacement", "rotation")
    return dict(zip(names, rows.T, strict=True))


def _rubs(scene, default):
    """Return the attributes of a geom with the scene's friction, the same for box and plane."""
    c = scene.contact
    tangent = math.tan(math.radians(c.friction or 0.0))
    if c.friction is None and c.shear > 0:
        pushed = scene.load.traction or scene.load.eccentricity or scene.load.slope or scene.block.tilt
        refuse("MuJoCo's contact has no glue; give contact.friction", where=default and pushed != 0)
        if default:
            return ""  # nothing pushes along the base: MuJoCo's own friction, which is never asked
        tangent = GLUE
    return f'condim="3" friction="{tangent!r} 0 0"' if tangent else 'condim="1"'


def _stiff(dt):
    """Return the attributes of a contact nearly as stiff as a step bears, critically damped."""
    rate = 0.3 / dt
    return f' solref="{-rate * rate!r} {-2 * rate!r}" solimp="0.9999 0.9999 0.001 0.5 2"'


class MuJoCo(ExternalProgram):
    """MuJoCo with models and sub-steps chosen for accuracy."""

    program = "MuJoCo"
    package = "mujoco"
    recipe = RECIPE
    handles = features.LOADS | features.RULES | OF_CONTACT
    default = False
    model = "block of one strain by masses on slide joints, springs by tendons; a rigid box where it turns"
    settings = (
        "RK4, with friction the leapfrog, at fine steps; a rigid box of a block: elliptic cones, stiff contact; "
        "rigid boxes: semi-implicit Euler at 0.25 ms, elliptic cones, an approach turned in one step"
    )

    def solve(self, scene):
        """Return the columns of a scene.

        Raises
        ------
        NotImplementedError
            MuJoCo is not installed, or the scene has what it cannot express.
        """
        if "plane" in scene.tables():
            return boxes(scene, default=self.default)
        if scene.column is not None:
            return column(scene, default=self.default)
        refuse("gg below 1 discounts the velocity of DDA's steps, which MuJoCo has not", where=scene.time.discount != 1)
        old = scene.run.rotation != "exact"
        refuse("run.rotation = first-order is that of older block codes, which MuJoCo has not", where=old)
        if self.boxed(scene):
            return rigid_box(scene, default=self.default)
        return spring_block(scene, default=self.default)

    def boxed(self, scene):
        """Whether a rigid box on a plane is the scene's model: where it turns far, if it is nearly rigid."""
        if scene.run.geometry == "small":
            return False
        (a, h), q, b = sizes(scene), scene.load, scene.block
        refuse("a pressure or traction on a block that turns far", where=_pushed(scene))
        lands = scene.contact.gap != 0 or b.velocity != 0
        refuse("a block that turns far stands on rigid ground, which returns nothing of a landing", where=lands)
        soft = 1 / (2 * scene.contact.stiffness) + h / (b.young * a)
        settles = b.mass * q.gravity * soft > STEADY * a * abs(math.sin(math.radians(b.tilt or 45.0)))
        refuse("a block that turns far is a rigid box, but this one or its springs are soft", where=settles)
        return True


class AsItComes(MuJoCo):
    """MuJoCo with its default integrator, contact and solver, at the step of the scene."""

    default = True
    model = "where a corner can open, a rigid box on MuJoCo's own contact; else masses on slide joints"
    settings = (
        "semi-implicit Euler at the step of the scene, rigid boxes at 2 ms; solref, solimp and cones as they come"
    )

    def boxed(self, scene):
        """Whether a rigid box on a plane is the scene's model."""
        (a, h), c = sizes(scene), scene.contact
        turns, pile = scene.run.geometry == "updated", scene.block.young * a / h >= RIGID * 2 * c.stiffness
        refuse("a pressure or traction on a block that turns far", where=turns and _pushed(scene))
        return c.law == "unilateral" and (turns or pile or c.friction is not None)


def _pushed(scene):
    return scene.load.pressure != 0 or scene.load.traction != 0
