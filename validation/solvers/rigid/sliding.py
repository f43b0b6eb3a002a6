"""Newmark's sliding block for scenes and for plain numbers: the limit of stiff springs without their errors."""

from __future__ import annotations

import functools
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from validation.errors import InputError
from validation.runs.history import Array
from validation.scenes.record import base_record
from validation.scenes.scene import Scene

if TYPE_CHECKING:
    from fem_reference.exact.sliding_block import Segment, SlidingBlock, SlidingMotion


@dataclass(frozen=True)
class Slide:
    """Motion of a rigid mass over its base."""

    time: Array  # instants [s], shape (times,)
    slide: Array  # slide towards +x, down a slope [m], shape (times,)
    velocity: Array  # its rate [m/s], shape (times,)
    slip: float  # length of the way until the last instant, in both directions [m]
    switches: tuple[tuple[float, int], ...]  # instants [s]; 1 and -1: it begins to slide towards +x or -x, 0: it sticks


def rigid_slide(scene: Scene, smooth: bool = False) -> Slide:
    """Return how the mass of `rigid_motion` slides, at the end of each step."""
    return _reported(rigid_motion(scene, smooth), scene.time.step * np.arange(1.0, scene.time.steps + 1))


def rigid_motion(scene: Scene, smooth: bool = False) -> SlidingMotion:
    """Return the motion of a rigid mass in the place of a scene's block.

    Its base follows the scene's record, linear between rows; what presses it down is its weight. Such a base jumps in
    velocity at every row, which springs do not pass on: a smooth one has the accelerations of the rows' second
    differences, linear between them.

    Raises
    ------
    InputError
        The scene has no friction, other loads than weight and base motion, or a base that moves upwards.
    """
    from fem_reference.exact.sliding_block import moved, recorded

    record = base_record(scene)
    load = scene.load
    if scene.contact.friction is None:
        raise InputError("contact.friction is required for a sliding block", source=scene.name, value="none")
    if load.pressure or load.traction:
        raise InputError(
            "load must be weight and base motion for a sliding block", source=scene.name, value="another one"
        )
    if record is not None and np.any(record.y):
        raise InputError(
            "load.base_motion must be along x for a sliding block", source=scene.name, value="a motion in y"
        )
    if record is None:
        base = moved([0.0], [0.0])
    else:
        time, x = _from_start(record.time, record.x)
        base = recorded(time, _accelerations(time, x)) if smooth else moved(time, x)
    return _motion(block_of(scene), base, scene.time.duration)


@functools.lru_cache(maxsize=4)
def _motion(block: SlidingBlock, base: tuple[Segment, ...], end: float) -> SlidingMotion:
    """Return the motion of a rigid mass, one for scenes that differ in springs only."""
    from fem_reference.exact.sliding_block import solve

    return solve(block, base, end)


def _from_start(time: Array, x: Array) -> tuple[Array, Array]:
    """Return a record from t = 0 on, held before its first row."""
    later = time > 0
    start = np.interp(0.0, time, x)
    return np.concatenate([[0.0], time[later]]), np.concatenate([[start], x[later]])


def _accelerations(time: Array, x: Array) -> Array:
    """Return the second differences of a record [m/s2], none at its ends."""
    speeds = np.diff(x) / np.diff(time)
    middles = (time[1:] + time[:-1]) / 2
    return np.concatenate([[0.0], np.diff(speeds) / np.diff(middles), [0.0]])


def block_of(scene: Scene) -> SlidingBlock:
    """Return the rigid mass of a scene with friction."""
    from fem_reference.exact.sliding_block import SlidingBlock

    c = scene.contact
    load = scene.load
    return SlidingBlock(
        slope=load.slope,
        friction=c.friction or 0.0,
        gravity=load.gravity,
        cohesion=c.cohesion * scene.block.base_length / scene.block.mass,
    )


def _reported(motion: SlidingMotion, time: Array) -> Slide:
    slide, velocity = motion.at(time)
    return Slide(time, slide, velocity, motion.slip, motion.switches)
