"""Rigid polygons, as prisms one metre deep, on MuJoCo's own contact.

MuJoCo's contact is a law of accelerations: a point that touches is given a = -k r - b v, for its depth r and its
velocity v, as far as its impedance d counters what else pushes. The tangents have a law of their own.

Where boxes rebound, b = (1 + e) / h and d near 1: a step of length h turns an approach v into -e v, Newton's law in one
step, where a spring would need a dozen. Where nothing rebounds a landing is stopped in a few steps, and d is lower:
MuJoCo's cones lift what slides by as much as they stop it, and a contact that counters all of gravity is lost so, found
again and lost again; a box then creeps, at 18 mm/s on 20 degrees with 20.05 of friction. With part of gravity on its
side it stays in touch.

A spring of given stiffness is the other end of the same law: with an impedance near zero the contact hardly counters
what else pushes, and its force is proportional to the depth.
"""

import math

import numpy as np

from peers.bodies import bodies_of, friction_between
from peers.boxes import (
    SLOW_CORRECTION,
    base_velocity,
    boxes_of,
    ground_ends,
    is_pile,
    record,
    spring_step,
    substeps,
)
from peers.mujoco_model import March, model_text, refuse
from peers.spatial import check_plane
from validation.models.plane.tables import PlaneSection

USUAL_STEP = 0.002  # s: MuJoCo's option.timestep as it comes
STEP = 0.00025  # s
TIME_CONSTANT = 0.01  # s: half of that of MuJoCo's contact as it comes
# Impedance: how much of what else pushes a contact counters; MuJoCo takes 0.0001 to 0.9999.
REBOUND_IMPEDANCE = 0.9999
REST_IMPEDANCE = 0.8
COMPLIANT = 0.0001  # of a given stiffness
LANDING = 0.5  # of an approach is stopped in a step, where nothing rebounds
# Depth decays so where nothing rebounds [1/s]: alone a box is thrown up by it, on each other boxes stand less deep.
REST_CORRECTION = 10.0
PILE_CORRECTION = 100.0
CORNERS = 4  # contact points of a box that lies flat
HALF_DEPTH = 0.5  # m of prisms
HEAVY = 1e6  # mass of a ground that moves, over that of the blocks
SAME = 1e-9  # m: corners of one level
STICKS = 100.0  # coefficient of friction where nothing slips
OPTIONS = 'cone="elliptic" impratio="1e6" tolerance="1e-12"'


class World:
    """Blocks as bodies of MuJoCo: free in space as they come, else on joints that keep them in the plane."""

    def __init__(self, scene, *, default):
        self.scene = scene
        self.default = default
        self.blocks = bodies_of(scene)
        self.moving = [block for block in self.blocks if not block.held]
        plane = scene.table(PlaneSection)
        self.moves = any(block.motion for block in plane.block)
        self.rebound = (plane.contact.restitution if plane.contact else None) or 0.0
        self.own_step = USUAL_STEP if default else STEP
        given = any(math.isfinite(law.stiffness) for law in (plane.contact, *plane.pair) if law and law.stiffness)
        if default:
            refuse("MuJoCo's contact has no coefficient of restitution", where=self.rebound != 0)
            refuse("MuJoCo's stiffness is no default of its own", where=given)
            refuse("friction by pair: MuJoCo takes the greater one of its two bodies'", where=bool(plane.pair))
        if given:
            lone = is_pile(scene) and len(self.moving) == 1
            refuse("contact of given stiffness below several boxes: MuJoCo's is one over mass", where=not lone)
            soft = "contact of given stiffness with friction: MuJoCo softens both together"
            refuse(soft, where=boxes_of(scene).friction != 0)
            self.own_step = min(self.own_step, spring_step(scene))
        step = scene.time.step / substeps(scene, self.own_step)
        along, up = plane.gravity
        options = f'timestep="{step!r}"' if default else f'timestep="{step!r}" {OPTIONS}'
        # A plane without end is the ground that one takes as it comes; held prisms are it elsewhere.
        self.flat = default and not self.moves and is_pile(scene) and not ground_ends(scene)
        self.meshes = []
        bodies = "".join(map(self._body, range(len(self.blocks))))
        pairs = "" if default else f"<contact>{''.join(self._pairs(step))}</contact>"
        more = f"<asset>{''.join(self.meshes)}</asset>{pairs}"
        self.march = March(model_text(options, bodies, gravity=f"{along!r} 0 {up!r}", contact=more))
        self.first = 1 if self.moves else 0  # coordinate at which those of the blocks begin
        self.turns = [block.angle for block in self.moving]
        self._start()
        if given:
            self._soften(boxes_of(scene).stiffness or 0.0)

    def _body(self, number):
        block = self.blocks[number]
        x, y = block.place
        density = block.density
        slides = '<joint type="slide" axis="1 0 0"/><joint type="slide" axis="0 0 1"/>'
        joints = "<freejoint/>" if self.default else f'{slides}<joint type="hinge" axis="0 -1 0"/>'
        turned = ""
        if block.held:
            joints = '<joint type="slide" axis="1 0 0"/>' if self.moves else ""
            turned = f'quat="{math.cos(block.angle / 2)!r} 0 {-math.sin(block.angle / 2)!r} 0"'
            density = float(HEAVY * sum(moving.mass for moving in self.moving) / block.mass * density)
        shapes = list(map(self._shape, block.parts))
        if block.held and self.flat:
            shapes = [f'type="plane" size="1 1 1" pos="0 0 {-y!r}"']
        geoms = "".join(
            f'<geom name="{number}.{place}" density="{density!r}" {self._surface()} {shape}/>'
            for place, shape in enumerate(shapes)
        )
        return f'<body pos="{x!r} 0 {y!r}" {turned}>{joints}{geoms}</body>'

    def _surface(self):
        """Return the attributes of a geom: its friction, of a pair the greater of the two; else pairs state it."""
        if not self.default:
            return 'contype="0" conaffinity="0"'
        friction = self._friction(0, 1)
        return f'condim="3" friction="{friction!r} 0 0"' if friction else 'condim="1"'

    def _shape(self, part):
        """Return a convex part: a box where it is a level rectangle, of exact contacts in MuJoCo, else a mesh."""
        xs, ys = ([point[axis] for point in part] for axis in (0, 1))
        levels = [{round(value / SAME) for value in values} for values in (xs, ys)]
        if len(part) == CORNERS and [len(level) for level in levels] == [2, 2]:
            size = f"{(max(xs) - min(xs)) / 2!r} {HALF_DEPTH!r} {(max(ys) - min(ys)) / 2!r}"
            return f'type="box" size="{size}" pos="{(max(xs) + min(xs)) / 2!r} 0 {(max(ys) + min(ys)) / 2!r}"'
        name = f"mesh{len(self.meshes)}"
        vertices = " ".join(f"{x!r} {depth!r} {y!r}" for depth in (-HALF_DEPTH, HALF_DEPTH) for x, y in part)
        self.meshes.append(f'<mesh name="{name}" vertex="{vertices}"/>')
        return f'type="mesh" mesh="{name}"'

    def _friction(self, first, second):
        return min(friction_between(self.scene, first, second), STICKS)

    def _pairs(self, step):
        piled = len(self.moving) > 1
        if self.rebound:
            impedance = REBOUND_IMPEDANCE
            rate = impedance * (1 + self.rebound) / step  # MuJoCo divides by the impedance
            stiffness = SLOW_CORRECTION / step
        else:
            impedance = REST_IMPEDANCE
            rate = LANDING / step
            stiffness = rate * (PILE_CORRECTION if piled else REST_CORRECTION)
        stop = math.sqrt(step * TIME_CONSTANT)
        law = f'solref="{-stiffness!r} {-rate!r}" solreffriction="0 {-1 / stop!r}"'
        law += f' solimp="{impedance} {impedance} 0.001 0.5 2"'
        for upper, block in enumerate(self.blocks):
            for below in range(upper):
                if not (block.held and self.blocks[below].held):
                    yield from self._pair(below, upper, law)

    def _pair(self, first, second, law):
        friction = self._friction(first, second)
        slides = f'condim="3" friction="{friction!r} {friction!r} 0 0 0"' if friction else 'condim="1"'
        for part in range(len(self.blocks[first].parts)):
            for other in range(len(self.blocks[second].parts)):
                yield f'<pair geom1="{first}.{part}" geom2="{second}.{other}" {law} {slides}/>'

    def _start(self):
        """Set angles and velocities."""
        data = self.march.data
        for number, block in enumerate(self.moving):
            along, up = block.velocity
            if self.default:
                place = self.first + 7 * number
                data.qpos[place + 3 : place + 7] = math.cos(block.angle / 2), 0, -math.sin(block.angle / 2), 0
                place = self.first + 6 * number
                data.qvel[place : place + 6] = along, 0, up, 0, -block.spin, 0
            else:
                place = self.first + 3 * number
                data.qpos[place + 2] = block.angle
                data.qvel[place : place + 3] = along, up, block.spin

    def _soften(self, stiffness):
        """Make the contact of a box with the ground a spring.

        A contact's force is k' r / R with k' = K / d of `solref`, d the impedance, and R the regularisation that MuJoCo
        works out from d and an inverse mass; R is read from the box as it would lie flat, a micrometre deep.
        """
        model = self.march.model
        data = self.march.data
        box = boxes_of(self.scene).boxes[0]
        start = data.qpos.copy()
        model.pair_solimp[:, :2] = COMPLIANT
        data.qpos[self.first + 1] = box.height / 2 - boxes_of(self.scene).starts[0][1] - 1e-6
        data.qpos[self.first + 2] = 0.0
        self.march.look()
        regularisation = float(data.efc_R[0])
        data.qpos[:] = start
        model.pair_solref[:] = -stiffness / CORNERS * COMPLIANT * regularisation, 0.0

    def advance(self, start, step):
        """Make one step of MuJoCo, and follow the angles of boxes that are free in space, which are folded at pi."""
        data = self.march.data
        if self.moves:
            data.qvel[0] = base_velocity(self.scene, start, step, data.qpos[0])
        self.march.mujoco.mj_step(self.march.model, data)
        if self.default:
            for number, turn in enumerate(self.turns):
                w, x, y, z = data.qpos[self.first + 7 * number + 3 : self.first + 7 * number + 7]
                check_plane(1 - 2 * (x * x + z * z))
                self.turns[number] = turn + math.remainder(-2 * math.atan2(y, w) - turn, math.tau)

    def poses(self):
        """Return position and angle of each block; what is no number after a breakdown."""
        data = self.march.data
        if data.warning.number.any():
            return [(math.nan, math.nan, math.nan)] * len(self.moving)
        poses = []
        for number, block in enumerate(self.moving):
            x, y = block.place
            if self.default:
                place = self.first + 7 * number
                poses.append((float(data.qpos[place]), float(data.qpos[place + 2]), self.turns[number]))
            else:
                along, up, angle = data.qpos[self.first + 3 * number : self.first + 3 * number + 3].tolist()
                poses.append((x + along, y + up, angle))
        return poses

    def forces(self):
        """Return the normal force below each box in the present state [N]."""
        self.march.look()
        data = self.march.data
        order = [block.name for block in (*(held for held in self.blocks if held.held), *self.moving)]
        values = dict.fromkeys(order[1:], 0.0)
        force = np.zeros(6)
        for number in range(data.ncon):
            names = [self.march.model.geom(geom).name.partition(".")[0] for geom in data.contact[number].geom]
            below, above = sorted(order.index(self.blocks[int(name)].name) for name in names)
            self.march.mujoco.mj_contactForce(self.march.model, data, number, force)
            if above == below + 1:
                values[order[above]] += float(force[0])
        return list(values.values())


def boxes(scene, *, default):
    """Return the motion of rigid polygons.

    Raises
    ------
    NotImplementedError
        MuJoCo is not installed, or the scene has what it cannot express.
    """
    world = World(scene, default=default)
    with world.march.silent():
        return record(scene, world.own_step, world.advance, world.poses, world.forces)
