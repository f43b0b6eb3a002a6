"""Rivals of `dda` where it opens, slips or turns: physics engines with the same box on a plane, as rigid bodies.

MuJoCo and pymunk, each with its step alone in the loop. `fine` takes the settings of `examples/peers` for accuracy: a
contact nearly as stiff as a step bears, no slack; without it the engines run as they come.
"""

from __future__ import annotations

import importlib.util
import math

import numpy as np

ENGINES = ("mujoco", "pymunk")


def absent(engine: str) -> str:
    """Return why an engine cannot run, empty where it can."""
    return "" if importlib.util.find_spec(engine) else f"NOT RUN: {engine} is not installed"


def box(
    engine: str,
    dt: float,
    gravity: np.ndarray,
    size: tuple[float, float] = (2.0, 2.0),
    tilt: float = 0.0,
    gap: float = 0.0,
    speed: float = 0.0,
    friction: float = 0.0,
    fine: bool = False,
) -> np.ndarray:
    """Return x and y of the centroid and the rotation at each step, shape (steps, 3).

    Parameters
    ----------
    engine
        One of `ENGINES`.
    dt
        Time step [s].
    gravity
        Acceleration of each step, that of a base which moves taken off, shape (steps, 2) [m/s2].
    size
        Width and height [m].
    tilt, gap, speed
        Rotation [rad], gap under the lowest corner [m] and velocity upwards [m/s] at t = 0.
    friction
        Coefficient of friction.
    fine
        Settings for accuracy.
    """
    lowest = (abs(math.sin(tilt)) * size[0] + math.cos(tilt) * size[1]) / 2 + gap
    run = _mujoco if engine == "mujoco" else _pymunk
    return run(dt, np.asarray(gravity, float), size, tilt, lowest, speed, friction, fine)


def _mujoco(dt, gravity, size, tilt, lowest, speed, friction, fine):
    import mujoco

    rate = 0.3 / dt
    stiff = f'solref="{-rate * rate!r} {-2 * rate!r}" solimp="0.9999 0.9999 0.001 0.5 2"' if fine else ""
    option = 'integrator="RK4" cone="elliptic" impratio="100"' if fine else ""
    contact = (f'condim="3" friction="{friction!r} 0 0"' if friction else 'condim="1"') + " " + stiff
    joints = '<joint type="slide" axis="1 0 0"/><joint type="slide" axis="0 0 1"/><joint type="hinge" axis="0 -1 0"/>'
    geom = f'<geom type="box" size="{size[0] / 2!r} 0.5 {size[1] / 2!r}" density="2700" {contact}/>'
    model = mujoco.MjModel.from_xml_string(
        f'<mujoco><option timestep="{dt!r}" {option}/><worldbody><geom type="plane" size="1 1 1" {contact}/>'
        f'<body pos="0 0 {lowest!r}">{joints}{geom}</body></worldbody></mujoco>'
    )
    data = mujoco.MjData(model)
    data.qpos[2], data.qvel[1] = tilt, speed
    rows, step = np.empty((len(gravity), 3)), mujoco.mj_step
    varies = np.ptp(gravity, axis=0).any()
    model.opt.gravity[:] = gravity[0, 0], 0.0, gravity[0, 1]
    for n in range(len(gravity)):
        if varies:
            model.opt.gravity[0], model.opt.gravity[2] = gravity[n, 0], gravity[n, 1]
        step(model, data)
        rows[n] = data.qpos
    return rows + np.array([0.0, lowest, 0.0])


def _pymunk(dt, gravity, size, tilt, lowest, speed, friction, fine):
    import pymunk

    space = pymunk.Space()
    if fine:
        space.iterations, space.collision_slop, space.collision_bias = 50, 1e-6, 0.0
    mass = 2700.0 * size[0] * size[1]
    body = pymunk.Body(mass, pymunk.moment_for_box(mass, size))
    body.position, body.angle, body.velocity = (0.0, lowest), tilt, (0.0, speed)
    shape, ground = pymunk.Poly.create_box(body, size), pymunk.Segment(space.static_body, (-1e3, -1), (1e3, -1), 1.0)
    shape.friction = ground.friction = math.sqrt(friction)
    space.add(body, shape, ground)
    rows, varies = np.empty((len(gravity), 3)), np.ptp(gravity, axis=0).any()
    space.gravity = tuple(gravity[0].tolist())
    for n in range(len(gravity)):
        if varies:
            space.gravity = tuple(gravity[n].tolist())
        space.step(dt)
        rows[n, 0], rows[n, 1] = body.position
        rows[n, 2] = body.angle
    return rows
