"""A block as Yade's rigid bodies on contact points over a floor: one where it is stiff or turns, else two or five.

The block of one strain e with mu = 0 is two bodies of Yade's. Its centroid v and its base point w = v - h e / 2 have
the masses m and, for w - v, m / 3; in w and y = v - (w - v) / 3 the mass matrix is diagonal::

    M = diag(m / 4, 3 m / 4),    v = (w + 3 y) / 4,    strain energy 9 E a / (8 h) (w - y)^2

so that a lower body of m / 4 at the base and an upper one of 3 m / 4 at 2 h / 3 above it, on a spring of 9 E a / (4 h),
move as the block does, not approximately; a force F on the top edge is -F / 2 on the lower and 3 F / 2 on the upper.

Sideways the same holds with G for E. There the lower body is two feet, which a spring draws together (the strain along
the base) and hard bonds keep from all else but moving apart. Against that they have less inertia than the block, m / 3
for half of it; two rotors, turned by it against each other, add what is missing. The sums are the block's::

    masses: feet 2 m / 16, rotors 2 m / 16, upper 3 m / 4;    feet and rotors turning: m a^2 / 12
"""

import math

import numpy as np

from peers.blocks import push_of, turn_of
from peers.yade_bodies import Body, Bond, Floor, Model, Point

RIGID = 1e3  # Young's modulus times width over height, over the stiffness of the contact, beyond which a block is rigid
STIFF = 3e3  # stiffness of what is to be rigid, over the greatest other one


def block(scene, solver):
    """Return the motion of a block."""
    refuse(scene)
    model = one_body(scene) if is_rigid(scene) else linkage(scene) if leans(scene) else two_bodies(scene)
    found = solver.move(scene, model)
    x, y, turn = found.x - found.x[0], found.y - found.y[0], np.unwrap(found.turn, axis=0)
    columns = {"contact_pressure": found.force / scene.block.base_length}
    if len(model.bodies) == 1:
        columns |= {"displacement": y[:, 0], "horizontal_displacement": x[:, 0], "rotation": turn[:, 0] - turn[0, 0]}
    else:
        feet, (a, h) = min(2, len(model.bodies) - 1), scene.block.rectangle
        low_x, low_y = x[:, :feet].mean(axis=1), y[:, :feet].mean(axis=1)
        tipped = (y[:, feet - 1] - y[:, 0]) / a
        columns["displacement"] = (low_y + 3 * y[:, -1]) / 4
        columns["horizontal_displacement"] = (low_x + 3 * x[:, -1]) / 4
        columns["rotation"] = (tipped - (x[:, -1] - low_x) / (2 * h / 3)) / 2
    return {name: values[1:] for name, values in columns.items()}


def refuse(scene):
    """Refuse what the bodies cannot carry, by the name of its field."""
    b, c, load = scene.block, scene.contact, scene.load
    updated = scene.run.geometry == "updated"
    if scene.block.rectangle is None:
        raise NotImplementedError("block.vertices: the block is no upright rectangle on its lower edge")
    if b.subdivide is not None:
        raise NotImplementedError("block.subdivide: sub-blocks of one strain each cannot be made of rigid bodies")
    if math.isinf(c.stiffness):
        raise NotImplementedError("contact.stiffness: a rigid contact has no penalty stiffness")
    if any(c.band) or c.rules == "lagged" or load.base_motion is not None:
        raise NotImplementedError("contact.band, contact.rules and load.base_motion are not taken")
    if updated and (load.pressure or load.traction):
        raise NotImplementedError("run.geometry: loads on the top of a block that turns are not taken")
    if updated and c.cohesion:
        raise NotImplementedError("contact.cohesion: is not taken of a block that turns")
    if not is_rigid(scene) and b.poisson:
        raise NotImplementedError("block.poisson: the bodies and bonds of a deformable block have Poisson's ratio 0")
    if updated and b.mass * load.gravity / b.young > 1e-3 * b.base_length:
        raise NotImplementedError("block.young: the block deforms under its weight, and one that turns is rigid here")


def is_rigid(scene):
    """Whether a block is one rigid body: it turns, or its own ratio is nothing beside that of the contact."""
    (width, height), c = scene.block.rectangle, scene.contact
    ratio = scene.block.young * width / height / (2 * max(c.stiffness, c.shear))
    return scene.run.geometry == "updated" or ratio >= RIGID


def floor_of(scene, height=0.0):
    """Return the floor of a scene below points whose lowest line stands at some height.

    Without shear stiffness the springs are those of no friction; without friction a closed contact never slips.
    """
    c = scene.contact
    angle = 0.0 if c.shear == 0 else math.atan(1e9) if c.friction is None else math.radians(c.friction)
    cohesion = c.cohesion * scene.block.base_length / 2
    return Floor(height - c.gap, c.stiffness, c.shear or c.stiffness, angle, cohesion, c.law == "locked")


def gravity_of(scene):
    """Return gravity, turned by the slope [m/s2]."""
    slope = math.radians(scene.load.slope)
    return scene.load.gravity * math.sin(slope), -scene.load.gravity * math.cos(slope)


def top_load(scene):
    """Return the force on the top edge [N] and its moment about the middle of that edge [N m]."""
    load, (width, _) = scene.load, scene.block.rectangle
    push = push_of(scene)
    return (load.traction * width, -push), -push * load.eccentricity


def leans(scene):
    """Whether anything but a centred load across the base acts on a block."""
    load = scene.load
    return bool(load.eccentricity or load.traction or (load.slope and load.gravity))


def two_bodies(scene):
    """Return the block of one strain under a centred load as two bodies, see the head of the module."""
    (a, h), b, ((_, down), _) = scene.block.rectangle, scene.block, top_load(scene)
    sole, stiff = wide(scene), 9 * a / (4 * h) * b.young
    low = (Point((0.0, h / 3), h / 3, touches=False), *(Point((x, sole), sole) for x in (-a / 2, a / 2)))
    high = (Point((0.0, 0.0), h / 3, touches=False),)
    lower = Body((0.0, 0.0), b.mass / 4, low, 0.0, b.velocity, (0.0, -down / 2))
    upper = Body((0.0, h), 3 * b.mass / 4, high, 0.0, b.velocity, (0.0, 3 * down / 2))
    return Model((lower, upper), (Bond((0, 1), (0, 0), stiff, stiff / 2),), floor_of(scene), gravity_of(scene))


def linkage(scene):
    """Return the block of one strain as an upper body, two feet and two rotors, see the head of the module."""
    (a, h), b, ((along, down), torque) = scene.block.rectangle, scene.block, top_load(scene)
    m, arm, out = b.mass, a / 4, a / 8
    push = {"force": (-along / 4, -down / 4), "torque": torque / 2}
    feet = [
        Body((side * a / 2, 0.0), m / 16, foot(scene, side, arm, out), 5 * m * a**2 / 256, b.velocity, **push)
        for side in (-1, 1)
    ]
    rotors = [Body((0.0, 0.0), m / 16, rotor(way, arm, out), 5 * m * a**2 / 768, b.velocity) for way in (1, -1)]
    head = Point((0.0, 0.0), h / 3, touches=False)
    upper = Body((0.0, h), 3 * m / 4, (head,), 0.0, b.velocity, (3 * along / 2, 3 * down / 2))
    stiff = 9 * a / (4 * h) * b.young
    hard = STIFF * max(stiff, b.young * h / a, scene.contact.stiffness, scene.contact.shear)
    along_base = b.young * h / a - stiff / 8  # the bonds to the upper body resist, too, what draws the feet apart
    bonds = (
        Bond((0, 1), (1, 1), along_base, hard, hard * a**2 / 12),
        *(Bond((side, 4), (0, 0), stiff / 2, stiff / 4) for side in (0, 1)),
        *(Bond((side, 2 + n), (3 + (side == n), side), hard, hard) for n in (0, 1) for side in (0, 1)),
    )
    return Model((*feet, *rotors, upper), bonds, floor_of(scene), gravity_of(scene))


def foot(scene, side, arm, out):
    """Return the points of the left (-1) or right (1) foot: to upper body, other foot, floor and rotors."""
    (a, h), sole = scene.block.rectangle, wide(scene)
    return (
        Point((-side * a / 2, h / 3), h / 3, touches=False),
        Point((0.0, 0.0), a / 2, touches=False),
        Point((0.0, sole), sole),
        *(Point((side * (out - a / 2), at), out, touches=False) for at in (arm, -arm)),
    )


def rotor(way, arm, out):
    """Return the points of a rotor to the left and the right foot: below and above its centre, or the other way."""
    return tuple(Point((-side * out, way * side * arm), out, touches=False) for side in (-1, 1))


def one_body(scene):
    """Return a rigid block; one that turns stands on small spheres at its corners, else on wide ones above them."""
    (a, h), b, (force, torque) = scene.block.rectangle, scene.block, top_load(scene)
    inertia, moment = b.mass * (a**2 + h**2) / 12, torque - force[0] * h / 2
    if scene.run.geometry != "updated":
        sole = wide(scene)
        feet = tuple(Point((x, sole - h / 2), sole) for x in (-a / 2, a / 2))
        body = Body((0.0, h / 2), b.mass, feet, inertia, b.velocity, force, moment)
        return Model((body,), (), floor_of(scene), gravity_of(scene))
    tilt, radius = math.radians(b.tilt), deepest(scene)
    turn = turn_of(tilt)
    corners = [turn @ (x, y) for y in (-h / 2, h / 2) for x in (-a / 2, a / 2)]
    x, y = -corners[0 if tilt >= 0 else 1]
    body = Body((x, y), b.mass, tuple(Point(tuple(map(float, at)), radius) for at in corners), inertia, b.velocity)
    return Model((body,), (), floor_of(scene, -radius), gravity_of(scene))


def wide(scene):
    """Return the radius of the spheres that a block stands on which does not turn: more than they go in [m]."""
    return float(max(scene.block.rectangle[1] / 4, deepest(scene)))


def deepest(scene):
    """Return a bound of how deep a corner of a rigid block is pressed into its springs [m].

    The mass falls by the gap and by what the tilt has lifted it, and lands with all its energy on one spring.
    """
    (a, h), b, p = scene.block.rectangle, scene.block, scene.contact.stiffness
    tilt = abs(math.radians(b.tilt))
    lifted = max(0.0, (a * math.sin(tilt) + h * math.cos(tilt) - h) / 2)
    weight = b.mass * abs(scene.load.gravity) + (abs(scene.load.pressure) + abs(scene.load.traction)) * a
    energy = b.mass * b.velocity**2 / 2 + weight * (scene.contact.gap + lifted)
    return 1.2 * (2 * weight / p + math.sqrt(2 * energy / p))
