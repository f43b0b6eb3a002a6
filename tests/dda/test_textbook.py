"""The printed recursion: what it agrees with, what it loses, what it leaves out."""

import pytest
from oracles import block_in_digits

from dda import Block, Contact, Material, Scheme, TwoBlockModel, solve, solve_textbook, textbook_applicable

PAPER = {"density": 2700.0, "young": 1e9}


def square(ratio, mu=0.0, side=2.0):
    return TwoBlockModel(Block.rectangle(side, side, Material(poisson=mu, **PAPER)), Contact(ratio * 1e9), 5e6)


@pytest.mark.parametrize(
    ("alpha", "delta", "ratio", "low", "high"),
    # an order of magnitude either side of what an independent program measured
    [(0.25, 0.5, 1e15, 0.13, 13.0), pytest.param(0.5, 1.0, 1e0, 0.0, 4e-15, marks=pytest.mark.long)],
)
def test_it_loses_digits_with_stiff_springs(alpha, delta, ratio, low, high):
    model, scheme = square(ratio), Scheme(alpha, delta, 1.0, 1e-3)
    _, exact = block_in_digits.locked_history(model, scheme, 100)
    lost = block_in_digits.lost(solve_textbook(model, scheme, 100).columns["contact_pressure"], exact)
    assert low <= lost < high


def test_it_settles_elsewhere_where_poisson_is_not_zero(held):
    scheme = Scheme(0.5, 1.0, 1.0, 0.002)
    columns = ("displacement", "strain_x")
    printed = solve_textbook(square(1.0, 0.3), scheme, 400, columns).columns
    right = solve(square(1.0, 0.3), scheme, 400, columns).columns
    assert [printed[name][-1] for name in columns] == pytest.approx([-0.01, 1.5e-3], rel=1e-9)
    assert [right[name][-1] for name in columns] == pytest.approx([-0.00985, 1.0e-3], rel=1e-9)
    wide = TwoBlockModel(Block.rectangle(1.3, 0.6, Material(1900.0, 6e9, 0.3)), Contact(2e9, 7e8), 2e6)
    held("printed", solve_textbook(wide, Scheme(0.3025, 0.6, 0.9, 6e-4), 9, columns).columns)


@pytest.mark.parametrize(("start", "shape"), [("zero", (1.3, 0.6)), ("consistent", (0.7, 2.9))])
def test_it_agrees_with_the_robust_form_where_poisson_is_zero(start, shape):
    model = TwoBlockModel(Block.rectangle(*shape, Material(1900.0, 6e9, 0.0)), Contact(2e9, 7e8), 2e6)
    scheme = Scheme(0.3025, 0.6, 0.9, 6e-4, start)
    printed, right = (run(model, scheme, 60).columns for run in (solve_textbook, solve))
    for name, values in right.items():
        assert printed[name] == pytest.approx(values, rel=0, abs=1e-12 * abs(values).max())


def test_where_it_does_not_apply_it_says_why():
    scheme = Scheme(0.5, 1, 1, 1e-3)
    rock = Material(1.0, 1.0, 0.0)
    trapezium = TwoBlockModel(Block([[0, 0], [3, 0], [2, 1], [0, 1]], rock), Contact(1.0), 1.0)
    sideways = TwoBlockModel(Block.rectangle(2, 2, rock), Contact(1.0), 1.0, base=0, top=1)
    rolled = TwoBlockModel(Block([[0, 2], [0, 0], [1, 0], [1, 2]], rock), Contact(1.0), 1.0, 1, 3)
    hanging = TwoBlockModel(Block.rectangle(2, 2, rock), Contact(1.0), 1.0, base=2, top=0)
    assert textbook_applicable(rolled, scheme) is None
    assert "upright rectangle" in textbook_applicable(trapezium, scheme)
    assert "upright rectangle" in textbook_applicable(hanging, scheme)
    assert "opposite" in textbook_applicable(sideways, scheme)
    assert "alpha" in textbook_applicable(square(1.0), Scheme(0.0, 0.5, 1, 1e-3))
    assert "viscous" in textbook_applicable(square(1.0), Scheme(0.5, 1, 1, 1e-3, "zero", 1.0))
