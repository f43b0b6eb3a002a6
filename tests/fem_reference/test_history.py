"""Savings in space change no history; sparse and dense modes agree."""

from dataclasses import replace

import numpy as np
import pytest
from faults import seams
from oracles.elements import make

from fem_reference import Scheme, highest_frequency, modes, solve

CONSTANT = Scheme(0.5, 1.0, 1.0, 1e-3)
AVERAGE = Scheme(0.25, 0.5, 0.97, 7e-4, "consistent")


def errors(result, reference):
    return max(
        np.abs(result.columns[name] - column).max() / np.abs(column).max() for name, column in reference.columns.items()
    )


@pytest.mark.parametrize(
    ("change", "unknowns", "saving"),
    [
        ({}, 5, "one column of elements"),
        ({"poisson": 0.3, "hypothesis": "plane strain", "shear": 4e8}, 25, "half the block"),
    ],
)
def test_savings_change_nothing(change, unknowns, saving):
    problem = make(**change, elements=2)
    saved, whole = solve(problem, AVERAGE, 12), solve(problem, AVERAGE, 12, full=True)
    assert errors(saved, whole) <= 1e-11  # rounding of its solves
    assert (saved.unknowns, whole.unknowns) == (unknowns, 2 * 5**2)
    assert saving in saved.notes and saving not in whole.notes
    assert saved.notes[-1] == "stepped: few steps" and whole.notes[-1] == "stepped: all savings off"
    assert saved.factorisations == 2
    assert saved.solves == 13


def test_sparse_and_dense_modes_agree(monkeypatch):
    problem = make(poisson=0.45, p=2e10, elements=2, degree=1)
    dense = modes(problem, CONSTANT)
    seams.FEM_DENSE.put(monkeypatch, 10)
    sparse = modes(problem, CONSTANT)
    assert sparse[0].frequency == pytest.approx(dense[0].frequency, rel=1e-10)
    assert sparse[0].share == pytest.approx(dense[0].share, rel=1e-8)
    assert highest_frequency(problem) == pytest.approx(highest_frequency(problem, full=True), rel=5e-2)


def test_what_a_discount_that_adapts_has_taken_at_rest_is_half_of_the_load_s_work():
    """Average acceleration takes none of its own: F u of the load at the top, less F u / 2 that is stored."""
    columns = ("displacement", "discount", "kinetic_damping_loss")
    found = solve(make(elements=2), replace(AVERAGE, gg=1.0, step=1e-3), 1500, columns, floor=0.0).columns
    force = 5e6 * 2
    top = force / 2e9 + force * 2 / (1e9 * 2)
    assert found["displacement"][-1] == pytest.approx(-(top + force / 2e9) / 2, rel=1e-9)
    assert found["kinetic_damping_loss"][-1] == pytest.approx(force * top / 2, rel=1e-9)
    assert found["discount"][:7] == pytest.approx([1, 1, 1, 1, 1, 1, 0.87806263], rel=1e-8)
