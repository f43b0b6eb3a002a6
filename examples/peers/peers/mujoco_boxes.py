"""Rigid boxes on MuJoCo's own contact.

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

from __future__ import annotations

import math
from collections.abc import Iterator

import numpy as np

from peers.boxes import Pose, base_velocity, boxes_of, correction_rate, on_endless_ground, record, spring_step, substeps
from peers.mujoco_model import Columns, March, model_text, refuse
from peers.spatial import check_plane
from validation.scenes.scene import Scene

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
HALF_DEPTH = 0.5  # m of boxes
THICKNESS = 1.0  # m of a ground that moves
HEAVY = 1e6  # mass of a ground that moves, over that of the boxes
OPTIONS = 'cone="elliptic" impratio="1e6" tolerance="1e-12"'
GROUND = "ground"


class World:
    """Boxes and ground as bodies of MuJoCo: free in space as they come, else on joints that keep them in the plane."""

    def __init__(self, scene: Scene, *, default: bool) -> None:
        pile = on_endless_ground(scene)
        self.scene = scene
        self.default = default
        self.moves = bool(pile.base_amplitude)
        self.own_step = USUAL_STEP if default else STEP
        if default:
            refuse("MuJoCo's contact has no coefficient of restitution", where=pile.rebound != 0)
            refuse("MuJoCo's stiffness is no default of its own", where=pile.stiffness is not None)
        if pile.stiffness is not None:
            refuse(
                "contact of given stiffness below several boxes: MuJoCo's is one over mass", where=len(pile.boxes) > 1
            )
            soft = "contact of given stiffness with friction: MuJoCo softens both together"
            refuse(soft, where=pile.friction != 0)
            self.own_step = min(self.own_step, spring_step(scene))
        step = scene.time.step / substeps(scene, self.own_step)
        along, up = pile.pull
        options = f'timestep="{step!r}"' if default else f'timestep="{step!r}" {OPTIONS}'
        bodies = "".join(self._bodies())
        pairs = "" if default else f"<contact>{''.join(self._pairs(step))}</contact>"
        text = model_text(options, bodies, gravity=f"{along!r} 0 {up!r}", contact=pairs)
        self.march = March(text)
        self.geoms = [self.march.model.geom(GROUND).id]
        self.first = 1 if self.moves else 0  # coordinate at which those of the boxes begin
        self.turns = [angle for _, _, angle in pile.starts]
        self._start()
        if pile.stiffness is not None:
            self._soften(pile.stiffness)

    def _surface(self) -> str:
        """Return the attributes of a geom: its friction, of a pair the greater of the two; else pairs state it."""
        if not self.default:
            return 'contype="0" conaffinity="0"'
        friction = boxes_of(self.scene).friction_coefficient
        return f'condim="3" friction="{friction!r} 0 0"' if friction else 'condim="1"'

    def _bodies(self) -> Iterator[str]:
        pile = boxes_of(self.scene)
        surface = self._surface()
        if self.moves:
            left, right = boxes_of(self.scene).ends
            mass = HEAVY * sum(box.mass for box in pile.boxes)
            size = f"{(right - left) / 2!r} {HALF_DEPTH + THICKNESS!r} {THICKNESS / 2!r}"
            joint = '<joint type="slide" axis="1 0 0"/>'
            geom = f'<geom name="{GROUND}" type="box" size="{size}" mass="{mass!r}" {surface}/>'
            position = f"{(left + right) / 2!r} 0 {-THICKNESS / 2!r}"
            yield f'<body pos="{position}">{joint}{geom}</body>'
        else:
            yield f'<geom name="{GROUND}" type="plane" size="1 1 1" {surface}/>'
        slides = '<joint type="slide" axis="1 0 0"/><joint type="slide" axis="0 0 1"/>'
        joints = "<freejoint/>" if self.default else f'{slides}<joint type="hinge" axis="0 -1 0"/>'
        for number, (box, (x, y, _)) in enumerate(zip(pile.boxes, pile.starts, strict=True)):
            size = f"{box.width / 2!r} {HALF_DEPTH!r} {box.height / 2!r}"
            geom = f'<geom name="{number}" type="box" size="{size}" density="{box.density!r}" {surface}/>'
            yield f'<body pos="{x!r} 0 {y!r}">{joints}{geom}</body>'

    def _pairs(self, step: float) -> Iterator[str]:
        pile = boxes_of(self.scene)
        if pile.rebound:
            impedance = REBOUND_IMPEDANCE
            rate = impedance * (1 + pile.rebound) / step  # MuJoCo divides by the impedance
            stiffness = correction_rate(self.scene) / step
        else:
            impedance = REST_IMPEDANCE
            rate = LANDING / step
            stiffness = rate * (PILE_CORRECTION if len(pile.boxes) > 1 else REST_CORRECTION)
        stop = math.sqrt(step * TIME_CONSTANT)
        law = f'solref="{-stiffness!r} {-rate!r}" solreffriction="0 {-1 / stop!r}"'
        law += f' solimp="{impedance} {impedance} 0.001 0.5 2"'
        friction = pile.friction_coefficient
        law += f' condim="3" friction="{friction!r} {friction!r} 0 0 0"' if friction else ' condim="1"'
        names = [GROUND, *map(str, range(len(pile.boxes)))]
        for upper, name in enumerate(names):
            for below in names[:upper]:
                yield f'<pair geom1="{below}" geom2="{name}" {law}/>'

    def _start(self) -> None:
        """Set angles and velocities, and note the boxes' geoms."""
        pile = boxes_of(self.scene)
        data = self.march.data
        for number, (box, (_, _, angle)) in enumerate(zip(pile.boxes, pile.starts, strict=True)):
            self.geoms.append(self.march.model.geom(str(number)).id)
            along, up = box.velocity
            if self.default:
                place = self.first + 7 * number
                data.qpos[place + 3 : place + 7] = math.cos(angle / 2), 0, -math.sin(angle / 2), 0
                place = self.first + 6 * number
                data.qvel[place : place + 6] = along, 0, up, 0, -box.spin, 0
            else:
                place = self.first + 3 * number
                data.qpos[place + 2] = angle
                data.qvel[place : place + 3] = along, up, box.spin

    def _soften(self, stiffness: float) -> None:
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

    def advance(self, start: float, step: float) -> None:
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

    def poses(self) -> list[Pose]:
        """Return position and angle of each box; what is no number after a breakdown."""
        data = self.march.data
        pile = boxes_of(self.scene)
        if data.warning.number.any():
            return [(math.nan, math.nan, math.nan)] * len(pile.boxes)
        poses = []
        for number, (x, y, _) in enumerate(pile.starts):
            if self.default:
                place = self.first + 7 * number
                poses.append((float(data.qpos[place]), float(data.qpos[place + 2]), self.turns[number]))
            else:
                along, up, angle = data.qpos[self.first + 3 * number : self.first + 3 * number + 3].tolist()
                poses.append((x + along, y + up, angle))
        return poses

    def forces(self) -> list[float]:
        """Return the normal force below each box in the present state [N]."""
        self.march.look()
        data = self.march.data
        values = dict.fromkeys(range(1, len(self.geoms)), 0.0)
        force = np.zeros(6)
        for number in range(data.ncon):
            geoms = sorted(self.geoms.index(geom) for geom in data.contact[number].geom)
            self.march.mujoco.mj_contactForce(self.march.model, data, number, force)
            if geoms[1] == geoms[0] + 1:
                values[geoms[1]] += float(force[0])
        return list(values.values())


def boxes(scene: Scene, *, default: bool) -> Columns:
    """Return the motion of rigid boxes.

    Raises
    ------
    NotImplementedError
        MuJoCo is not installed, or the scene has what it cannot express.
    """
    world = World(scene, default=default)
    with world.march.silent():
        return record(scene, world.own_step, world.advance, world.poses, world.forces)
