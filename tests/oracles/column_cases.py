"""Columns of the exact motions as `dda` takes them."""

import math

import numpy as np
from flint import arb

from dda.bodies.column import Column, Layer, Spring


def layers(heights, density, young, velocity):
    return [Layer(h, rho, E, 0.0, 1, v) for h, rho, E, v in zip(heights, density, young, velocity, strict=True)]


def feet_of(thicknesses):
    return [float(x) for x in np.cumsum([0.0, *thicknesses])[:-1]]


def unilateral(blocks, stiffness, gaps, gravity=9.81):
    """Return a column on contacts from the base upwards; one contact fewer than blocks: nothing is below."""
    feet = feet_of([layer.thickness for layer in blocks])
    free = len(stiffness) < len(blocks)
    joints = [Spring(x, k, g) for x, k, g in zip(feet[int(free) :], stiffness, gaps, strict=True)]
    return Column(blocks, law="unilateral", joints=joints, gravity=gravity, unsupported=free)


def column_of(problem):
    """Return a column of the elements' own terms; a modulus in shear is half of Young's where nothing contracts."""
    slips = problem.law == "frictional"
    blocks = [Layer(b.height, b.density, b.modulus * (1 + slips), 0.0, 1, b.velocity) for b in problem.blocks]
    joints = []
    for x, joint in zip(feet_of([b.height for b in problem.blocks]), problem.joints, strict=True):
        if joint is not None:
            strength = {"strength": joint.strength or math.inf} if slips else {}
            joints.append(Spring(x, joint.stiffness, joint.gap, **strength))
    return Column(
        blocks,
        "shear" if slips else "pressure",
        law=problem.law,
        joints=joints,
        impedance=problem.impedance or None,
        gravity=problem.gravity,
        unsupported=problem.base == "free",
    )


def course(drive, times):
    """Return a drive and its first two derivatives at times, shape (3, times)."""
    pieces = drive()
    series = [pieces.piece_at(t).series(arb(t), 1.0, 3) for t in times.tolist()]
    return np.array([[float(c) for c in row] for row in series]).T * [[1], [1], [2]]
