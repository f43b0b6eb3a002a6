"""Which mode a load excites most, how many are looked for, and what one step's diagnostics measure."""

import itertools
from dataclasses import replace

import numpy as np
import pytest
from conftest import thinned
from faults import seams
from oracles.elements import make
from scipy.linalg import eigh

import dda
import fem_reference

A, E, RHO = 2.0, 1e9, 2700.0
SCHEME, SAME = dda.Scheme(0.5, 1.0, 1.0, 1e-3), fem_reference.Scheme(0.5, 1.0, 1.0, 1e-3)
RECORDS = {"x": ((0.0, 1e-3), (0.0, 0.0)), "y": ((0.0, 0.0), (0.0, 1e-3)), "xy": ((0.0, 2e-3), (0.0, 1e-3))}


def carried(mass, stiffness, rigid):
    """Return frequencies and shares (phi' M R)^2 / (w^2 R' M K^-1 M R), the largest share first."""
    squares, shapes = eigh(stiffness, mass)
    inertia = mass @ rigid
    shares = (shapes.T @ inertia) ** 2 / squares / (inertia @ np.linalg.solve(stiffness, inertia))
    order = np.argsort(-shares)
    return np.sqrt(squares[order]), shares[order]


def upright(n, p):
    """Return M, K and R of n linear elements on the spring 2 p; n = 1 is (v, ey) of the DDA block as well."""
    h = A / n
    M, K = np.zeros((2, n + 1, n + 1))
    for i in range(n):
        M[i : i + 2, i : i + 2] += RHO * A * h / 6 * np.array([[2, 1], [1, 2]])
        K[i : i + 2, i : i + 2] += E * A / h * np.array([[1, -1], [-1, 1]])
    K[0, 0] += 2 * p
    return M, K, np.ones(n + 1)


def model(p, way):
    motion = dda.BaseMotion([0.0, 0.01], np.transpose(RECORDS[way]))
    block = dda.Block.rectangle(A, A, dda.Material(RHO, E, 0.0))
    return dda.TwoBlockModel(block, dda.Contact(p), 0.0, motion=motion)


def problem(n, p, way, **changes):
    motion = fem_reference.Motion((0.0, 0.01), *RECORDS[way])
    return replace(make(p=p, elements=n, degree=1), pressure=0.0, motion=motion, **changes)


def agree(found, expected):
    """Compare the modes that have a share worth the name; dense solvers and glue leave 1e-8 of the others."""
    seen = [mode for mode in found if mode.share > 1e-4]
    kept = expected[1] > 1e-4
    assert [mode.frequency for mode in seen] == pytest.approx(expected[0][kept].tolist(), rel=1e-7)
    assert [mode.share for mode in seen] == pytest.approx(expected[1][kept].tolist(), rel=1e-6)


@pytest.mark.parametrize(
    ("p", "n", "solver"), thinned(itertools.product([1e9, 1e11], [1, 5], ["fem", "whole fem", "sub-blocks"]), 5)
)
def test_shares_of_a_column_under_a_moving_base(p, n, solver):
    if solver == "sub-blocks":
        found = dda.modes(dda.subdivided(model(p, "y"), 1, n, 1e17), SCHEME)
    else:
        found = fem_reference.modes(problem(n, p, "y"), SAME, count=60, full=solver == "whole fem")
    agree(found, carried(*upright(n, p)))


@pytest.mark.parametrize("dense", thinned([1, 10**6], 2))
def test_the_highest_frequency_of_many_sub_blocks(monkeypatch, dense):
    """Of a long chain, all blocks breathing against their joints: w^2 = 12 (E w h + 2 g h^2) / (m h^2).

    Blocks w x h with joints of 2 g; the ends of n blocks spoil it by pi^2 / n^2 at most.
    """
    seams.SYSTEM_DENSE.put(monkeypatch, dense)
    n, width, h, g = 60, 0.5, 0.1, 3e9
    block = dda.Block.rectangle(width, n * h, dda.Material(RHO, E, 0.0))
    system = dda.subdivided(dda.TwoBlockModel(block, dda.Contact(g), 5e6), 1, n, g)
    expected = np.sqrt(12 * (E * width * h + 2 * g * h * h) / (RHO * width * h * h * h))
    assert dda.highest_frequency(system) == pytest.approx(expected, rel=np.pi**2 / n**2)
