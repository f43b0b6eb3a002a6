"""Columns of `column_motions` as `dda` takes them, and how far their histories are from those numbers."""

import math
from typing import NamedTuple

import numpy as np
from flint import arb
from oracles.column_motions import COLUMNS

from dda import Scheme
from dda.bodies.column import Column, Layer, Spring
from dda.bodies.column_history import ColumnOptions, solve_column
from dda.bodies.column_march import Drive
from fem_reference.events.column_model import ColumnProblem

# instants at which they are known [s]
UNTIL = {"A1": 0.04, "A2": 0.06, "A3": 0.01, "A4": 0.03, "A5": 0.1, "A6": 0.65, "A7": 0.01, "A8": 0.05}
UNTIL |= {"S1": 0.4, "S2": 0.05, "S3": 0.25}


class ColumnCase(NamedTuple):
    """A column and what its blocks' middles (and joints) have done at an instant."""

    problem: ColumnProblem
    until: float
    exact: dict[str, float]  # a column of a history to its value at `until`; at a height by its number in `heights`
    heights: list[float]

    @property
    def column(self):
        return column_of(self.problem)


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


def case_of(name):
    """Return a known column with the displacements, velocities and slips that were printed at its instant."""
    problem, until = COLUMNS[name].problem, UNTIL[name]
    thicknesses = [block.height for block in problem.blocks]
    feet = feet_of(thicknesses)
    middles = [foot + height / 2 for foot, height in zip(feet, thicknesses, strict=True)]
    exact = {}
    for instant, part, numbers in COLUMNS[name].values:
        if instant == until and part != "force":
            first = len(feet) * (part == "slip") + 1
            exact |= {f"{part}_{first + k}": float(x) for k, x in enumerate(numbers.split()) if x != "-"}
    return ColumnCase(problem, until, exact, [*middles, *feet])


CASES = {name: case_of(name) for name in UNTIL}


def course(drive, times):
    """Return a drive and its first two derivatives at times, shape (3, times)."""
    pieces = drive()
    series = [pieces.piece_at(t).series(arb(t), 1.0, 3) for t in times.tolist()]
    return np.array([[float(c) for c in row] for row in series]).T * [[1], [1], [2]]


def error_of(case, weights, steps):
    """Return the largest error at the end over the largest value, of each kind of column."""
    problem = case.problem
    times = case.until / steps * np.arange(steps + 1)
    drive = Drive(*course(problem.base_motion, times), course(problem.pressure, times)[0])
    scheme = Scheme(*weights, 1.0, case.until / steps, "consistent")
    options = ColumnOptions(settled=problem.at_rest)
    result = solve_column(column_of(problem), scheme, drive, list(case.exact), case.heights, options)
    assert result.outcome == "completed"
    errors = []
    for part in {name.rpartition("_")[0] for name in case.exact}:
        names = [name for name in case.exact if name.startswith(part)]
        exact = np.array([case.exact[name] for name in names])
        stepped = np.array([result.columns[name][-1] for name in names])
        errors.append(np.abs(stepped - exact).max() / np.abs(exact).max())
    return float(max(errors))
