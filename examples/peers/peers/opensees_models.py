"""Models of OpenSees: a block of one strain on its contact, and a column, out of the program's own elements.

The displacement of DDA's block is linear, and so is that of a triangle with one strain. Its corners are the two ends of
the base and the middle of the top edge; its area is half of the block's, so that its thickness is 2. The block's
mass matrix in these six unknowns is exactly that of two bars with consistent mass, along the triangle's two legs, each
with half of the block's mass::

    m / 12 [[2, 1], [1, 2]] for each leg:  m / 6 at the ends of the base, m / 3 on top, m / 12 along a leg

so that nothing is approximated but time. Where the block turns far, three bars that turn with it (corotational) stand
in the place of the triangle, and the block is rigid. The contact is a penalty element with Coulomb's friction.
"""

import math
from dataclasses import dataclass

import numpy as np

from peers.blocks import push_of, tangent_of, turn_of
from peers.columns import NEAR, Stretch, stretches
from validation.scenes.drive import motion_at

LEFT, RIGHT, TOP = 1, 2, 3  # nodes of the block
GROUND = 10  # added to a node: what it stands on
SHARES = {LEFT: 0.25, RIGHT: 0.25, TOP: 0.5}  # of the centroid
SPRINGS = {LEFT: 4, RIGHT: 5}  # elements below the ends of the base
GLUED = 1e9  # coefficient of friction of a corner that never slips
FAR = 1_000_000  # from here on are the numbers of springs and held nodes of a column


@dataclass(frozen=True)
class Plan:
    """How a scene is stepped.

    Attributes
    ----------
    count
        Sub-steps in a step.
    chosen
        Whether the start is consistent and the column's mesh follows the sub-step; else all is as it comes.
    """

    count: int
    chosen: bool


# ---- the block ----------------------------------------------------------------------------------------------------


def block(ops, scene):
    """Build the block of a scene on its contact; return how it is looked at."""
    ops.model("basic", "-ndm", 2, "-ndf", 2)
    at = corners(scene)
    for node, point in at.items():
        ops.node(node, *point)
    _body(ops, scene, at)
    _stand(ops, scene, at)
    ops.timeSeries("Constant", 1)
    ops.pattern("Plain", 1, 1)
    for node, force in loads(scene).items():
        ops.load(node, *force)
        ops.setNodeVel(node, 2, scene.block.velocity, "-commit")
    ops.rayleigh(scene.damping.mass, 0.0, scene.damping.stiffness, 0.0)
    return lambda: seen(ops, scene, at)


def corners(scene):
    """Return where the nodes of the block are at t = 0 [m]: turned about the corner that stays down."""
    width, height = scene.block.rectangle or (0.0, 0.0)
    tilt = math.radians(scene.block.tilt)
    turn = turn_of(tilt)
    down = np.array([0.0 if tilt >= 0 else width, 0.0])
    upright = {LEFT: (0.0, 0.0), RIGHT: (width, 0.0), TOP: (width / 2, height)}
    return {node: down + turn @ (np.array(point) - down) for node, point in upright.items()}


def _body(ops, scene, at):
    """Give the block its stiffness and its mass."""
    b, far = scene.block, scene.run.geometry == "updated"
    ops.uniaxialMaterial("Elastic", 1, b.young if far else 0.0)
    if far:
        ops.element("corotTruss", 1, LEFT, RIGHT, b.base_length, 1)
    else:
        ops.nDMaterial("ElasticIsotropic", 2, b.young, b.poisson)
        kind = "PlaneStress" if b.hypothesis == "plane stress" else "PlaneStrain"
        ops.element("tri31", 1, LEFT, RIGHT, TOP, 2.0, kind, 2)
    for element, node in ((2, LEFT), (3, RIGHT)):
        per_length = b.mass / 2 / float(np.linalg.norm(at[TOP] - at[node]))
        bar = "corotTruss" if far else "Truss"
        mass = "-rho", per_length, "-cMass", 1, "-doRayleigh", 1
        ops.element(bar, element, node, TOP, b.base_length if far else 1.0, 1, *mass)


def _stand(ops, scene, at):
    """Put the ends of the base on their springs, whose nodes lie below them by the gap that there is."""
    c = scene.contact
    ops.uniaxialMaterial("Elastic", 3, c.stiffness)
    ops.uniaxialMaterial("Elastic", 4, c.shear)
    slope = tangent_of(scene, GLUED)
    for node, element in SPRINGS.items():
        ground = GROUND + node
        ops.node(ground, at[node][0], -c.gap)
        ops.fix(ground, 1, 1)
        if c.law == "locked":
            ops.element("zeroLength", element, ground, node, "-mat", 4, 3, "-dir", 1, 2, "-doRayleigh", 1)
        else:  # it divides by its shear stiffness: a frictionless corner has one, and no friction
            law = (c.stiffness, c.shear, slope) if c.shear else (c.stiffness, c.stiffness, 0.0)
            ops.element("zeroLengthContactASDimplex", element, ground, node, *law, "-orient", 0.0, 1.0, 0.0)


def loads(scene):
    """Return the forces on the nodes that do the work of a scene's loads [N]."""
    b, q = scene.block, scene.load
    pressed = push_of(scene)
    couple = pressed * q.eccentricity / b.base_length
    weight, slope = b.mass * q.gravity, math.radians(q.slope)
    found = {n: (weight * math.sin(slope) * share, -weight * math.cos(slope) * share) for n, share in SHARES.items()}
    more = {LEFT: (0.0, couple), RIGHT: (0.0, -couple), TOP: (q.traction * b.base_length, -pressed)}
    return {node: (x + more[node][0], y + more[node][1]) for node, (x, y) in found.items()}


def seen(ops, scene, at):
    """Return the block's columns now."""
    moved = {node: np.array(ops.nodeDisp(node)) for node in SHARES}
    centroid = sum(share * moved[node] for node, share in SHARES.items())
    pressed = sum(ops.eleForce(element)[1] for element in SPRINGS.values())
    return {
        "displacement": float(centroid[1]),
        "horizontal_displacement": float(centroid[0]),
        "rotation": _turned(scene, at, moved),
        "contact_pressure": pressed / scene.block.base_length,
    }


def _turned(scene, at, moved):
    """Return the rotation since t = 0 [rad]: of the base where it is large, else (dv/dx - du/dy) / 2."""
    base, apart = at[RIGHT] - at[LEFT], moved[RIGHT] - moved[LEFT]
    if scene.run.geometry == "updated":
        now = base + apart
        return math.atan2(base[0] * now[1] - base[1] * now[0], float(base @ now))
    up = at[TOP] - (at[LEFT] + at[RIGHT]) / 2
    leant = moved[TOP] - (moved[LEFT] + moved[RIGHT]) / 2
    return float(apart[1] / base[0] - leant[0] / up[1]) / 2


# ---- the column ---------------------------------------------------------------------------------------------------


@dataclass(frozen=True)
class Part:
    """A stretch of a column and the trusses in it."""

    stretch: Stretch
    elements: int

    @property
    def levels(self):
        """Where its nodes are [m]."""
        return np.linspace(self.stretch.bottom, self.stretch.top, self.elements + 1)


def parts(scene, plan):
    """Return the parts of a column from the base upwards."""
    found = []
    inner = scene.time.step / plan.count
    for one in stretches(scene.column):
        length = one.layer.thickness / one.layer.blocks
        if plan.chosen:
            length = min(length, math.sqrt(2 * one.modulus / one.layer.density) * inner)
        found.append(Part(one, max(1, math.ceil(one.length / length * (1 - NEAR)))))
    return found


def column(ops, scene, plan):
    """Build the column of a scene; return how it is looked at."""
    ops.model("basic", "-ndm", 1, "-ndf", 1)
    levels, nodes = _trusses(ops, parts(scene, plan), consistent=plan.chosen)
    foot = _foot(ops, scene, nodes[0])
    inner = scene.time.step / plan.count
    instants = inner * np.arange(scene.time.steps * plan.count + 2)
    drive = motion_at(scene, instants)
    carried = 0.0
    if scene.input.at == "top":
        _push(ops, nodes[-1], -drive.pressure, inner)
    elif scene.column.base == "transmitting":
        _push(ops, foot, 2 * (scene.column.impedance or 0.0) * drive.velocity, inner)
    elif scene.column.base == "springs":
        _push(ops, nodes[0], (scene.column.base_stiffness or 0.0) * drive.displacement, inner)
    else:
        _shake(ops, scene, instants, inner)
        carried = 1.0

    def look():
        base = carried * float(np.interp(ops.getTime(), instants, drive.displacement))
        moved = base + np.array([ops.nodeDisp(node, 1) for node in nodes])
        seen_at = np.interp(scene.column.heights, levels, moved).tolist()
        return {"displacement": float(moved[-1])} | {f"displacement_{i}": x for i, x in enumerate(seen_at, start=1)}

    return look


def _trusses(ops, made_of, consistent):
    """Stack trusses, with springs where the column has joints; return levels [m] and nodes from the base upwards."""
    levels, nodes = [0.0], [1]
    ops.node(1, 0.0)
    for number, part in enumerate(made_of, start=1):
        ops.uniaxialMaterial("Elastic", number, part.stretch.modulus)
        spring = part.stretch.spring
        if spring is not None and number > 1:
            _tie(ops, nodes[-1], _node(ops, levels, nodes, part.stretch.bottom), spring, 0.0)
        for level in part.levels[1:]:
            below, above = nodes[-1], _node(ops, levels, nodes, float(level))
            mass = ("-rho", part.stretch.layer.density, *(("-cMass", 1) if consistent else ()))
            ops.element("Truss", above, below, above, 1.0, number, *mass)
    return np.array(levels), nodes


def _node(ops, levels, nodes, level):
    nodes.append(nodes[-1] + 1)
    levels.append(level)
    ops.node(nodes[-1], level)
    return nodes[-1]


def _tie(ops, one, other, stiffness, viscosity):
    """Put a spring and a dashpot between two nodes at one place; its number is that of no truss."""
    tag = FAR + other
    ops.uniaxialMaterial("Elastic", tag, stiffness, viscosity)
    ops.element("zeroLength", tag, one, other, "-mat", tag, "-dir", 1)


def _foot(ops, scene, base):
    """Hold the column's base; return the node on which the wave from below acts."""
    stiffness = [joint.stiffness for joint in scene.column.springs if joint.height == 0]
    foot, held = base, 2 * FAR
    if stiffness:
        foot = 2 * FAR + 1
        ops.node(foot, 0.0)
        _tie(ops, foot, base, stiffness[0], 0.0)
    if scene.column.impedance is None:
        ops.fix(foot, 1)
        return foot
    ops.node(held, 0.0)
    ops.fix(held, 1)
    _tie(ops, held, foot, 0.0, scene.column.impedance)
    return foot


def _push(ops, node, force, inner):
    """Let a force act on a node, given at the ends of the sub-steps [N for a unit of area]."""
    ops.timeSeries("Path", 1, "-dt", inner, "-values", *map(float, force))
    ops.pattern("Plain", 1, 1)
    ops.load(node, 1.0)


def _shake(ops, scene, instants, inner):
    """Move the base by inertia in the base's frame: mean accelerations over sub-steps, which have its velocities."""
    ahead, behind = (motion_at(scene, np.maximum(0.0, instants + part * inner)).velocity for part in (0.5, -0.5))
    lengths = np.where(instants > 0, inner, inner / 2)
    ops.timeSeries("Path", 1, "-dt", inner, "-values", *map(float, (ahead - behind) / lengths))
    ops.pattern("UniformExcitation", 1, 1, "-accel", 1)
    for node in ops.getNodeTags():
        ops.setNodeVel(node, 1, -float(behind[0]), "-commit")
