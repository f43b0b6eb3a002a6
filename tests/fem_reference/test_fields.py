"""What ParaView shows: files read back, against strains times moduli, the history."""

from itertools import product
from typing import NamedTuple

import meshio
import numpy as np
import pytest
from conftest import thinned
from oracles.elements import make

import fem_reference
from fem_reference.problem.problem import Array

COLUMNS = ("displacement", "contact_pressure", "horizontal_displacement")
AWAY = ((3.0, -1.0), (5.0, -1.0), (5.0, 1.5), (3.0, 1.5))  # 2 m x 2.5 m, its base off the origin
TAU, G = 2e5, 9.81


class Frame(NamedTuple):
    """One instant of a file."""

    time: float  # s
    points: Array  # (points, 2) m
    cells: np.ndarray  # corners of each cell
    displacement: Array  # (points, 2) m
    stress: Array  # (cells, 3) Pa: sxx, syy, sxy


def read(path):
    """Return the instants of a file; a .vtu has one without a time."""
    if path.suffix == ".vtu":
        mesh = meshio.read(path)
        return [_frame(float("nan"), mesh.points, mesh.cells, mesh.point_data, mesh.cell_data)]
    with meshio.xdmf.TimeSeriesReader(str(path)) as reader:
        points, cells = reader.read_points_cells()
        return [_frame(time, points, cells, *data) for time, *data in map(reader.read_data, range(reader.num_steps))]


def _frame(time, points, cells, point_data, cell_data):
    assert len(cells) == 1 and not points[:, 2].any() and not point_data["displacement"][:, 2].any()
    assert set(point_data) == {"displacement"} and set(cell_data) == {"stress"}
    return Frame(time, points[:, :2], cells[0].data, point_data["displacement"][:, :2], cell_data["stress"][0])


def hooke(problem, exx, eyy, gxy):
    """Return (sxx, syy, sxy) of strains by the printed elasticity matrix, gxy = du/dy + dv/dx."""
    E, mu = problem.young, problem.poisson
    if problem.hypothesis == "plane strain":
        E, mu = E / (1 - mu**2), mu / (1 - mu)
    plate = E / (1 - mu**2)
    return np.column_stack([plate * (exx + mu * eyy), plate * (eyy + mu * exx), plate * (1 - mu) / 2 * gxy])


def strains(frame):
    """Return strains at the middle of each linear cell: of a bilinear one the least squares' plane through its corners.

    On a parallelogram the bilinear map's gradient at the middle is that of this plane.
    """
    found = []
    for cell in frame.cells:
        x = frame.points[cell]
        slope = np.linalg.lstsq(x - x.mean(axis=0), frame.displacement[cell], rcond=None)[0]
        found.append([slope[0, 0], slope[1, 1], slope[0, 1] + slope[1, 0]])
    exx, eyy, gxy = np.array(found).T
    return exx, eyy, gxy


LOADS = {"pressure": {}, "sideways": {"traction": TAU}, "weight": {"gravity": G}}
SHAPES = {
    "column": {},
    "half": {"poisson": 0.3, "elements": 4},
    "whole, plane strain": {"poisson": 0.25, "hypothesis": "plane strain", "elements": 3, "vertices": AWAY},
    "triangles": {"poisson": 0.3, "cells": "triangles", "vertices": AWAY},
}


@pytest.mark.parametrize(("shape", "load", "suffix"), thinned(product(SHAPES, LOADS, [".vtu", ".xdmf"]), 7))
def test_stress_is_the_deformation_times_the_moduli(tmp_path, shape, load, suffix):
    """In every cell of every frame of linear elements, read from the file alone."""
    problem = make(**({"elements": 4, "degree": 1, "shear": 7e8} | SHAPES[shape] | LOADS[load]))
    path = tmp_path / f"block{suffix}"
    scheme = fem_reference.Scheme(0.25, 0.5, 1.0, 1e-3)
    fem_reference.solve(problem, scheme, 8, COLUMNS, fields=path)
    frames = read(path)
    assert len(frames) == (1 if suffix == ".vtu" else 8)
    fem_reference.solve(problem, scheme, 8, COLUMNS, full=True, fields=tmp_path / "full.vtu")
    (full,) = read(tmp_path / "full.vtu")
    size = np.abs(full.displacement).max()
    np.testing.assert_allclose(frames[-1].displacement, full.displacement, rtol=0, atol=1e-11 * size)
    for frame in frames:
        expected = hooke(problem, *strains(frame))
        # E times rounding of differences of displacements that are 1e2 times the strain's share of a cell
        scale = np.abs(expected).max()
        np.testing.assert_allclose(frame.stress, expected, rtol=0, atol=1e-9 * scale)
        if load == "sideways":
            assert np.abs(frame.stress[:, 2]).max() > 1e-4 * scale  # there is shear to be seen


@pytest.mark.parametrize(("steps", "stride"), thinned([(403, 3), (1, 1), (399, 2), (201, 2), (400, 2), (200, 1)], 6))
def test_a_series_has_every_stride_and_the_last_step(tmp_path, steps, stride):
    path = tmp_path / "block.xdmf"
    fem_reference.solve(make(elements=1, degree=1), fem_reference.Scheme(0.5, 1.0, 1.0, 1e-3), steps, fields=path)
    with meshio.xdmf.TimeSeriesReader(str(path)) as reader:
        reader.read_points_cells()
        times = [reader.read_data(k)[0] for k in range(reader.num_steps)]
    numbers = sorted({*range(stride, steps + 1, stride), steps})
    assert times == pytest.approx([1e-3 * n for n in numbers], rel=1e-12)
