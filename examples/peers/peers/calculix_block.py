"""The block of one strain in CalculiX: one solid element that stays affine, on springs or in penalty contact."""

import math

import numpy as np

from peers.blocks import push_of, tangent_of, turn_of
from peers.calculix_deck import Deck, amplitude, node, number, refuse, row

GLUED = 1e6  # coefficient of friction of a corner that never slips while closed
BALLAST = 1e5  # kinetic energy of the ballast over the greatest of the scene
SPEED = 10.0  # m/s, of the ballast
FACES = {"small": ("S3",), "updated": ("S3", "S4", "S5", "S6")}  # the base; every side of the outline
COLUMNS = {"displacement", "contact_pressure", "horizontal_displacement", "rotation"}


def _constants(block):
    """Return the elastic constants of the plane of the block; across it nothing strains."""
    E, mu = block.young, block.poisson
    shear = E / (2 * (1 + mu))
    if block.hypothesis == "plane strain":
        E, mu = E / (1 - mu * mu), mu / (1 - mu)
    direct = E / (1 - mu * mu)
    values = direct, mu * direct, direct, 0.0, 0.0, direct, shear, shear
    return ["*ELASTIC,TYPE=ORTHO", row(*values) + ",", row(shear, 293.0)]


def _check_block(scene):
    contact, run = scene.contact, scene.run
    refuse(scene.time.discount != 1, "the discount gg on velocities is a damping that CalculiX does not have")
    refuse(contact.cohesion > 0, "contact in CalculiX has friction but no cohesion")
    refuse(run.rotation != "exact", "a rotation of first order is that of older DDA programs")
    refuse(not COLUMNS & set(run.columns), "none of the columns that are asked for is reported")
    outline = "the outline is no upright rectangle on its base, and the element is one"
    refuse(scene.block.rectangle is None, outline)


def block_deck(scene, sub):
    """Return the model of a block under its loads."""
    _check_block(scene)
    b, t = scene.block, scene.time
    width, height = b.rectangle
    deck = Deck(t.step, t.steps, sub, printed=[1, 2, 3, 4], updated=scene.run.geometry == "updated")
    corners = _placed(scene, width, height)
    deck.model += ["*NODE,NSET=ALL", *(node(k + 1 + 4 * z, *corners[k], z) for z in (0, 1) for k in range(4))]
    deck.model += ["*ELEMENT,TYPE=C3D8,ELSET=BLOCK", "1,1,2,3,4,5,6,7,8", "*MATERIAL,NAME=ROCK", *_constants(b)]
    deck.model += ["*DENSITY", number(b.density), "*SOLID SECTION,ELSET=BLOCK,MATERIAL=ROCK"]
    deck.model += ["*BOUNDARY", "ALL,3,3", "*EQUATION"]
    for d in (1, 2):
        for k in range(1, 5):
            deck.model += ["2", f"{k + 4},{d},1.,{k},{d},-1."]
        deck.model += ["4", f"4,{d},1.,1,{d},-1.,2,{d},1.,3,{d},-1."]
    base = _locked(scene, deck, width) if scene.contact.law == "locked" else _contact(scene, deck, width, height)
    if scene.contact.law != "locked":
        _ballast(scene, deck, width, height)
    if b.velocity:
        deck.model += ["*INITIAL CONDITIONS,TYPE=VELOCITY", row("ALL", "2", b.velocity)]
    _loads(scene, deck, width, base)
    return deck


def _placed(scene, width, height):
    """Return the corners at t = 0 [m], turned about the one that stays down and lifted by the gap."""
    corners = np.array([[0.0, 0.0], [width, 0.0], [width, height], [0.0, height]])
    angle = math.radians(scene.block.tilt)
    pivot = np.array([0.0 if angle >= 0 else width, 0.0])
    turn = turn_of(angle)
    return pivot + (corners - pivot) @ turn.T + [0.0, scene.contact.gap]


def _locked(scene, deck, width):
    """Put springs that push and pull under the corners; return the set of their feet."""
    deck.model += ["*NODE,NSET=FEET", node(11, 0.0, -1.0, 0.0), node(12, width, -1.0, 0.0)]
    for name, dof, stiffness in (("NORMAL", 2, scene.contact.stiffness), ("SHEAR", 1, scene.contact.shear)):
        first = 10 * dof
        deck.model += [f"*ELEMENT,TYPE=SPRING2,ELSET={name}", f"{first + 1},1,11", f"{first + 2},2,12"]
        deck.model += [f"*SPRING,ELSET={name}", f"{dof},{dof}", number(stiffness)]
    return "FEET"


def _contact(scene, deck, width, height):
    """Let the corners touch the upper face of an element that moves as the base does; return the set of its nodes."""
    c, faces = scene.contact, FACES[scene.run.geometry]
    length = width if len(faces) == 1 else width + height  # a corner carries half of the faces that meet there
    reach = _travel(scene, width, height)
    upper = [(-reach, 0.0), (width + reach, 0.0)]
    lower = [(x, -reach) for x, _ in upper]
    ring = [*lower, upper[1], upper[0]]
    deck.model += ["*NODE,NSET=GROUND"]
    deck.model += [node(101 + k + 4 * (z > 0), x, y, z) for z in (-1.0, 2.0) for k, (x, y) in enumerate(ring)]
    deck.model += ["*ELEMENT,TYPE=C3D8,ELSET=FIXED", "2," + ",".join(str(101 + k) for k in range(8))]
    deck.model += ["*SOLID SECTION,ELSET=FIXED,MATERIAL=ROCK"]
    deck.model += ["*SURFACE,NAME=SLAVE", *(f"1,{face}" for face in faces), "*SURFACE,NAME=MASTER", "2,S5"]
    tension = 1e-12 * c.stiffness  # at infinity, as ccx rounds the corner of its law
    deck.model += ["*SURFACE INTERACTION,NAME=TOUCH", "*SURFACE BEHAVIOR,PRESSURE-OVERCLOSURE=LINEAR"]
    deck.model += [row(2 * c.stiffness / length, tension)]
    friction = tangent_of(scene, GLUED)
    if c.shear and friction:
        deck.model += ["*FRICTION", row(friction, 2 * c.shear / length)]
    deck.model += ["*CONTACT PAIR,INTERACTION=TOUCH,TYPE=NODE TO SURFACE", "SLAVE,MASTER"]
    return "GROUND"


def _record(scene):
    """Return instants [s] and displacements [m] of the base, to be read linearly and held beyond the ends."""
    from validation.scenes.record import base_record

    record = base_record(scene)
    if record is None:
        return np.zeros(1), np.zeros(1), np.zeros(1)
    return record.time, record.x, record.y


def _pull(scene, width):
    """Return a bound of the forces of all loads [N]."""
    load = scene.load
    return scene.block.mass * load.gravity + width * (abs(load.pressure) + abs(load.traction))


def _travel(scene, width, height):
    """Return a length that the block does not slide beyond [m]."""
    T, (_, x, y) = scene.time.duration, _record(scene)
    free = abs(scene.block.velocity) * T + _pull(scene, width) / scene.block.mass * T * T
    moved = float(np.max(np.abs(x)) + np.max(np.abs(y)))
    return 2 * (width + height + scene.contact.gap + free + moved)


def _ballast(scene, deck, width, height):
    """Add a heavy element that flies by itself, far away, at a constant speed.

    ccx gives up an increment of a dynamic contact whose energy changes by 0.8 % (at rebounds 0.25 %) of the greatest
    kinetic, strain or external energy that it has seen; at the start from rest that is next to nothing, and what
    friction dissipates counts as a loss. The ballast makes the measure large, and touches nothing else.
    """
    c, m, T = scene.contact, scene.block.mass, scene.time.duration
    force, (_, x, y) = _pull(scene, width), _record(scene)
    speed = abs(scene.block.velocity) + force / m * T
    moved = float(np.max(np.abs(x)) + np.max(np.abs(y)))
    energy = (m * speed**2 + force**2 / c.stiffness + c.stiffness * moved**2) or 1.0
    away = 10 * _travel(scene, width, height)
    cube = [(0.0, 0.0), (1.0, 0.0), (1.0, 1.0), (0.0, 1.0)]
    deck.model += ["*NODE,NSET=BALLAST"]
    deck.model += [node(201 + k + 4 * z, x, y + away, z) for z in (0, 1) for k, (x, y) in enumerate(cube)]
    deck.model += ["*ELEMENT,TYPE=C3D8,ELSET=BALLAST", "3," + ",".join(str(201 + k) for k in range(8))]
    deck.model += ["*MATERIAL,NAME=HEAVY", "*ELASTIC", row(scene.block.young, 0.0)]
    deck.model += ["*DENSITY", number(2 * BALLAST * energy / SPEED**2)]
    deck.model += ["*SOLID SECTION,ELSET=BALLAST,MATERIAL=HEAVY", "*BOUNDARY", "BALLAST,1,1", "BALLAST,3,3"]
    deck.model += ["*INITIAL CONDITIONS,TYPE=VELOCITY", row("BALLAST", "2", SPEED)]


def _loads(scene, deck, width, base):
    """Put pressure, traction and weight on the block, and the record on its base."""
    load = scene.load
    time, x, y = _record(scene)
    if load.base_motion is None:
        deck.model += ["*BOUNDARY", f"{base},1,3"]
    else:
        deck.model += [*amplitude("ALONG", time, x), *amplitude("UP", time, y), "*BOUNDARY", f"{base},3,3"]
        for dof, name in ((1, "ALONG"), (2, "UP")):
            deck.loads += [f"*BOUNDARY,AMPLITUDE={name}", f"{base},{dof},{dof},1."]
    push, e = push_of(scene), load.eccentricity / width
    for corner, share in ((3, 0.5 + e), (4, 0.5 - e)):
        deck.loads += ["*CLOAD", row(str(corner), "2", -push * share)]
        deck.loads += ["*CLOAD", row(str(corner), "1", load.traction * width / 2)]
    if load.gravity:
        turn = math.radians(load.slope)
        deck.loads += ["*DLOAD", row("BLOCK", "GRAV", load.gravity, math.sin(turn), -math.cos(turn), 0.0)]


def block_columns(scene, found):
    """Return the columns of a block from the displacements of its four corners, shape (steps, 4, 2)."""
    width, height = scene.block.rectangle
    time, _, y = _record(scene)
    corners, c = _placed(scene, width, height), scene.contact
    base = np.interp(scene.time.step * np.arange(1, scene.time.steps + 1), time, y)
    if c.law == "locked":
        forces = -c.stiffness * (found[:, :2, 1] - base[:, None])
    else:
        touching = 4 if scene.run.geometry == "updated" else 2
        forces = c.stiffness * np.maximum(0.0, base[:, None] - corners[:touching, 1] - found[:, :touching, 1])
    along, up = found[:, 1] - found[:, 0], found[:, 3] - found[:, 0]
    if scene.run.geometry == "small":
        rotation = (along[:, 1] / width - up[:, 0] / height) / 2
    else:
        along, up = (along + corners[1] - corners[0]) / width, (up + corners[3] - corners[0]) / height
        turned = np.arctan2(along[:, 1] - up[:, 0], along[:, 0] + up[:, 1]) - math.radians(scene.block.tilt)
        rotation = np.unwrap(np.append(0.0, turned))[1:]
    middle = found.mean(axis=1)
    return {
        "displacement": middle[:, 1],
        "horizontal_displacement": middle[:, 0],
        "contact_pressure": forces.sum(axis=1) / width,
        "rotation": rotation,
    }
